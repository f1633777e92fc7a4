//! `antumbra info`: what a shadow file holds.

use std::path::PathBuf;

use antumbra::format::dag8::NodeCounts;
use antumbra::format::reach;
use antumbra::format::{VERSION_MAJOR, VERSION_MINOR};
use antumbra::{DepthDistribution, Encoding, LightKind, LightRecord, LightShadow, ShadowFile};
use anyhow::Result;
use serde_json::{Value, json};

use crate::describe::{self, LightSummary};
use crate::table::{Table, bytes, count, printable};
use crate::{inputs, output};

/// Shows what a shadow file holds: lights, transforms, nodes by kind, bytes by section.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  antumbra info city.antumbra --json")]
pub struct Args {
    /// The shadow file
    file: PathBuf,
    /// Print JSON alone
    #[arg(long)]
    json: bool,
}

/// Shows.
pub fn run(args: &Args) -> Result<()> {
    let (file, file_bytes) = inputs::shadows(&args.file)?;
    let (shares, (_, levels_words)) = reach::shares(&file);
    let lights: Vec<_> = file.lights().zip(shares).map(|(light, share)| (light, summary(light, share))).collect();
    if args.json {
        let mut json = as_json(&file, file_bytes, &lights);
        json["levels_bytes"] = (4 * levels_words).into();
        describe::print(&json)
    } else {
        output::print(&as_text(args, &file, file_bytes, &lights))
    }
}

/// A light and what is told of it.
type Described<'a> = (LightShadow<'a>, LightSummary<'a>);

fn summary(light: LightShadow<'_>, (nodes, words): (NodeCounts, u64)) -> LightSummary<'_> {
    let record = light.record();
    LightSummary {
        name: light.name(),
        kind: light.kind().name(),
        resolution: record.resolution(),
        texel_size_m: record.texel_size_m,
        bytes: 4 * words,
        build_seconds: None,
        stages: None,
        nodes,
    }
}

fn as_json(file: &ShadowFile, file_bytes: u64, lights: &[Described<'_>]) -> Value {
    let sections = file.sections().iter().map(|(kind, bytes)| json!({ "kind": kind_text(*kind), "bytes": bytes }));
    json!({
        "lights": lights.iter().map(light_json).collect::<Vec<_>>(),
        "file_bytes": file_bytes,
        // Known to the bake alone.
        "peak_rss_bytes": null,
        "threads": null,
        "triangles": file.stats().as_ref().map(describe::triangles),
        "format_version": format!("{VERSION_MAJOR}.{VERSION_MINOR}"),
        "nodes": describe::nodes(file.node_counts()),
        "sections": sections.collect::<Vec<_>>(),
    })
}

fn light_json((light, summary): &Described<'_>) -> Value {
    let record = light.record();
    let mut json = summary.json();
    json["interior"] = describe::interior(light.interior());
    json["encoding"] = encoding(*light).into();
    json["faces"] = record.faces.into();
    json["levels"] = light.has_levels().into();
    json["enter_depths"] = light.has_enter_depths().into();
    json["direction_world"] = json!(record.direction_world);
    if light.kind() == LightKind::Directional {
        json["slice_size_m"] = record.slice_size_m.into();
        json["voxel_from_world"] = json!({
            "origin": record.origin_world,
            "linear": record.linear,
            "offset": record.voxel_of_origin,
        });
    } else {
        json["position_world"] = json!(record.origin_world);
        json["near_m"] = record.near_m.into();
        json["far_m"] = record.far_m.into();
        json["depth"] = depth_text(record).into();
        json["texels_per_tangent"] = record.texels_per_tangent.into();
        json["axes"] = json!(record.linear);
        json["cone_degrees"] =
            if light.kind() == LightKind::Spot { json!(record.cone_cosine.acos().to_degrees()) } else { Value::Null };
    }
    json
}

fn depth_text(record: &LightRecord) -> &'static str {
    match record.depth_distribution() {
        Some(DepthDistribution::Logarithmic) => "logarithmic",
        Some(DepthDistribution::Ndc) => "ndc",
        Some(DepthDistribution::Linear) | None => "linear",
    }
}

fn encoding(light: LightShadow<'_>) -> &'static str {
    light.record().node_encoding().map_or("unknown", Encoding::name)
}

fn as_text(args: &Args, file: &ShadowFile, file_bytes: u64, lights: &[Described<'_>]) -> String {
    let mut table = Table::default();
    table.row("bytes", format!("{} ({})", bytes(file_bytes), count(file_bytes)));
    for (kind, size) in file.sections() {
        table.row(format!("section {}", kind_text(*kind)), format!("{} bytes", count(*size)));
    }
    if let Some(stats) = file.stats() {
        table.row("triangles", describe::triangles_text(&stats));
    }
    let text = table.text(&args.file.display().to_string());
    if lights.len() > LIGHTS_IN_FULL {
        return text + &list_text(lights);
    }
    lights.iter().fold(text, |text, light| text + &light_text(light))
}

/// More lights than this get a line each.
const LIGHTS_IN_FULL: usize = 8;

fn list_text(lights: &[Described<'_>]) -> String {
    let mut table = Table::default();
    for (light, summary) in lights {
        let n = summary.resolution;
        let faces = if light.faces() == 1 { String::new() } else { format!("{} x ", light.faces()) };
        let policy = describe::interior_text(light.interior());
        table.row(
            printable(light.name()),
            format!("{}, {faces}{n} x {n} x {n}, {policy}, {}", summary.kind, bytes(summary.bytes)),
        );
    }
    table.text("lights (--json has all of them in full)")
}

fn light_text((light, summary): &Described<'_>) -> String {
    let record = light.record();
    let [dx, dy, dz] = record.direction_world;
    let [ox, oy, oz] = record.origin_world;
    let mut table = summary.table();
    table.row("interior", describe::interior_text(light.interior()));
    table.row("encoding", encoding(*light));
    table.row("coarse levels", if light.has_levels() { "yes" } else { "no" });
    table.row("enter depths", if light.has_enter_depths() { "yes" } else { "no" });
    if light.kind() != LightKind::Directional {
        place_rows(light, &mut table);
        return table.text(&format!("{} ({})", printable(light.name()), summary.kind));
    }
    table.row("slice size", describe::metres(record.slice_size_m));
    table.row("direction", format!("{dx:.6}, {dy:.6}, {dz:.6}"));
    table.row("voxel =", format!("linear * (world - origin) + offset, origin {ox:.3}, {oy:.3}, {oz:.3}"));
    for (row, offset) in record.linear.iter().zip(record.voxel_of_origin) {
        // Adding zero turns -0 into 0.
        let [x, y, z] = row.map(|v| v + 0.0);
        table.row("", format!("[{x:14.6e} {y:14.6e} {z:14.6e}] + {offset:.3}"));
    }
    table.text(&format!("{} ({})", printable(light.name()), summary.kind))
}

/// Where a local light stands and what it reaches.
fn place_rows(light: &LightShadow<'_>, table: &mut Table) {
    let record = light.record();
    let [x, y, z] = record.origin_world;
    table.row("position", format!("{x:.4}, {y:.4}, {z:.4}"));
    if light.kind() == LightKind::Spot {
        let [dx, dy, dz] = record.direction_world.map(|v| v + 0.0);
        table.row("direction", format!("{dx:.6}, {dy:.6}, {dz:.6}"));
        table.row("cone", format!("{:.2} degrees to either side", record.cone_cosine.acos().to_degrees()));
    }
    table.row("faces", record.faces.to_string());
    table.row("reaches from", format!("{} to {}", describe::metres(record.near_m), describe::metres(record.far_m)));
    table.row("slices", depth_text(record));
}

fn kind_text(kind: [u8; 4]) -> String {
    printable(&String::from_utf8_lossy(&kind))
}
