//! What more than one command tells of a bake, as JSON and as text. The JSON's keys are an interface: scripts rely on
//! them.

use antumbra::Interior;
use antumbra::format::dag8::NodeCounts;
use antumbra::format::stat::BakeStats;
use antumbra_bake::Stage;
use anyhow::Result;
use serde_json::{Value, json};

use crate::output;
use crate::table::{Table, bytes, count};

/// What bake and info tell of a light.
pub struct LightSummary<'a> {
    pub name: &'a str,
    pub kind: &'static str,
    pub resolution: u32,
    pub texel_size_m: f64,
    /// Of nodes that no earlier light of the file has.
    pub bytes: u64,
    /// Known to the bake alone.
    pub build_seconds: Option<f64>,
    /// Known to the bake alone.
    pub stages: Option<&'a [Stage]>,
    pub nodes: NodeCounts,
}

impl LightSummary<'_> {
    /// A member of `lights`.
    #[must_use]
    pub fn json(&self) -> Value {
        json!({
            "name": self.name,
            "kind": self.kind,
            "resolution": self.resolution,
            "texel_size_m": self.texel_size_m,
            "bytes": self.bytes,
            "build_seconds": self.build_seconds,
            "stages": self.stages.map(stages),
            "nodes": nodes(self.nodes),
        })
    }

    /// The same for people.
    #[must_use]
    pub fn table(&self) -> Table {
        let (nodes, n) = (self.nodes, self.resolution);
        let mut table = Table::default();
        table.row("resolution", format!("{n} x {n} x {n}"));
        table.row("texel size", metres(self.texel_size_m));
        // Slices and cuts are of one encoding each.
        let (leaves, name) = if nodes.cuts > 0 { (nodes.cuts, "cuts") } else { (nodes.slices, "slices") };
        let [inner, leaves, masks] = [nodes.inner, leaves, nodes.masks].map(count);
        table.row("nodes", format!("{inner} inner, {leaves} {name}, {masks} masks"));
        table.row("bytes", format!("{} ({})", bytes(self.bytes), count(self.bytes)));
        table
    }
}

/// A length, with as many digits as it deserves.
#[must_use]
pub fn metres(length: f64) -> String {
    if (1e-3..1e6).contains(&length) { format!("{length:.4} m") } else { format!("{length:.3e} m") }
}

/// Triangles by what became of them, for people.
#[must_use]
pub fn triangles_text(stats: &BakeStats) -> String {
    format!(
        "{}: {} closed (of which {} cavity), {} open ({} alpha-masked), {} left out; {} broken ones dropped",
        count(stats.triangles_total),
        count(stats.triangles_closed),
        count(stats.triangles_cavity),
        count(stats.triangles_open),
        count(stats.triangles_alpha_masked),
        count(stats.triangles_left_out),
        count(stats.triangles_dropped),
    )
}

/// Nodes by kind.
#[must_use]
pub fn nodes(counts: NodeCounts) -> Value {
    json!({ "inner": counts.inner, "slices": counts.slices, "masks": counts.masks, "cuts": counts.cuts })
}

/// Parts of the work, with their wall time.
#[must_use]
pub fn stages(stages: &[Stage]) -> Value {
    stages.iter().map(|stage| json!({ "name": stage.name, "seconds": stage.seconds })).collect()
}

/// Triangles by what became of them.
#[must_use]
pub fn triangles(stats: &BakeStats) -> Value {
    json!({
        "total": stats.triangles_total,
        "closed": stats.triangles_closed,
        "open": stats.triangles_open,
        "alpha_masked": stats.triangles_alpha_masked,
        "dropped": stats.triangles_dropped,
        "cavity": stats.triangles_cavity,
        "left_out": stats.triangles_left_out,
    })
}

/// A policy and its parameter.
#[must_use]
pub fn interior(policy: Interior) -> Value {
    let metres = match policy {
        Interior::Thickness(metres) | Interior::Static(metres) => Some(metres),
        Interior::Auto | Interior::Closed | Interior::Open => None,
    };
    json!({ "policy": policy.name(), "parameter_m": metres })
}

/// A policy and its parameter, for people.
#[must_use]
pub fn interior_text(policy: Interior) -> String {
    match policy {
        Interior::Thickness(m) | Interior::Static(m) => format!("{}={m} m", policy.name()),
        Interior::Auto | Interior::Closed | Interior::Open => policy.name().to_owned(),
    }
}

/// Prints a value on stdout.
pub fn print(value: &Value) -> Result<()> {
    output::print(&format!("{value:#}\n"))
}
