//! A comparison in words and as JSON.

use serde_json::{Value, json};

use super::{CLASSIFIED_EVERY, Comparison, FARTHEST_TEXELS, LightComparison, Tally, Worst};
use crate::table::{Table, count, percent, printable};

/// Lights that get tables of their own.
const MOST_TABLES: usize = 8;

impl Comparison {
    /// For people: tables for each light, or one for all where there are many, and a line for each that is wrong.
    #[must_use]
    pub fn text(&self) -> String {
        let tables: String = if self.lights.len() <= MOST_TABLES {
            self.lights.iter().map(LightComparison::text).collect()
        } else {
            let heading = format!("{} lights, in the air, on surfaces and moved off them", self.lights.len());
            let wrong = self.lights.iter().filter_map(LightComparison::complaint);
            self.total().table().text(&heading) + &wrong.collect::<String>()
        };
        tables + &self.verdict() + "\n"
    }

    /// One sentence.
    #[must_use]
    pub fn verdict(&self) -> String {
        let total = self.total();
        let shares = format!(
            "{} of {} points agree, {} differ where the bake was free, {} near edges",
            count(total.agreeing),
            count(total.samples),
            count(total.undefined),
            count(total.disagreeing - total.too_far)
        );
        match total.too_far {
            0 => {
                format!("ok: {shares}; no disagreement lies farther than one texel and one slice from a shadow's edge")
            }
            n => format!("not ok: {shares}, and {} disagree far from any edge", count(n)),
        }
    }

    /// For scripts.
    #[must_use]
    pub fn json(&self) -> Value {
        let total = self.total();
        json!({
            "ok": total.too_far == 0,
            "lights": self.lights.iter().map(LightComparison::json).collect::<Vec<_>>(),
            "samples": total.samples,
            "agreeing": total.agreeing,
            "undefined": total.undefined,
            "free": total.free,
            "disagreeing": total.disagreeing,
            "too_far": total.too_far,
            "farthest_texels": texels_json(total.farthest_texels),
            "classified_every": CLASSIFIED_EVERY,
        })
    }
}

impl LightComparison {
    fn text(&self) -> String {
        let kinds = [
            (&self.air, "in the air"),
            (&self.surfaces, "on surfaces"),
            (&self.off_surfaces, "on surfaces, moved off them as a filtered lookup is"),
        ];
        let name = printable(&self.name);
        let table = |(tally, place): (&Tally, &str)| {
            let mut table = tally.table();
            tally.worst.iter().for_each(|worst| {
                table.row("too far", worst.text());
            });
            table.text(&format!("{name}, {place}"))
        };
        kinds.map(table).concat()
    }

    /// A line, if some of its points disagree too far from any edge.
    fn complaint(&self) -> Option<String> {
        let total = self.total();
        let worst = total.worst.first()?;
        let (name, too_far) = (printable(&self.name), count(total.too_far));
        Some(format!("not ok: {name} ({}): {too_far} point(s) too far, at {}\n", self.kind.name(), worst.text()))
    }

    fn json(&self) -> Value {
        json!({
            "name": self.name,
            "kind": self.kind.name(),
            "interior": self.policy.name(),
            "ok": self.total().too_far == 0,
            "air": self.air.json(),
            "surfaces": self.surfaces.json(),
            "off_surfaces": self.off_surfaces.json(),
        })
    }
}

impl Tally {
    fn table(&self) -> Table {
        let mut table = Table::default();
        table.row("points", count(self.samples));
        table.row("agree", format!("{} ({})", count(self.agreeing), percent(self.agreeing, self.samples)));
        table.row("differ where the bake was free", count(self.undefined));
        table.row("differ elsewhere", count(self.disagreeing));
        table.row("farthest from an edge", texels_text(self.farthest_texels));
        table.row("lit", percent(self.lit, self.samples));
        table.row("free by the policy", percent(self.free, self.samples));
        let of = format!("of every {CLASSIFIED_EVERY}th point");
        let share = |part| format!("{} {of}", percent(part, self.classified));
        table.row("robust", share(self.robust));
        table.row("near an edge", share(self.near_edge));
        table.row("inside a solid", share(self.inside));
        table.row("behind a surface, undefined", share(self.behind));
        table
    }

    fn json(&self) -> Value {
        let share = |part: u64| part as f64 / self.classified.max(1) as f64;
        json!({
            "samples": self.samples,
            "agreeing": self.agreeing,
            "undefined": self.undefined,
            "free": self.free,
            "disagreeing": self.disagreeing,
            "too_far": self.too_far,
            "farthest_texels": texels_json(self.farthest_texels),
            "lit_share": self.lit as f64 / self.samples.max(1) as f64,
            "classified": self.classified,
            "robust_share": share(self.robust),
            "near_edge_share": share(self.near_edge),
            "inside_share": share(self.inside),
            "behind_share": share(self.behind),
            "worst": self.worst.iter().map(Worst::json).collect::<Vec<_>>(),
        })
    }
}

impl Worst {
    fn text(&self) -> String {
        let [x, y, z] = self.point_world.to_array();
        let said = if self.bake_lit { "lit" } else { "shadowed" };
        format!("{x:.6}, {y:.6}, {z:.6}: baked as {said}, {} from an edge", texels_text(self.texels))
    }

    fn json(&self) -> Value {
        let point = self.point_world.to_array();
        json!({ "point": point, "bake_lit": self.bake_lit, "texels": texels_json(self.texels) })
    }
}

/// JSON has no infinity: `null` is farther than was looked for.
fn texels_json(texels: f64) -> Value {
    if texels.is_finite() { texels.into() } else { Value::Null }
}

fn texels_text(texels: f64) -> String {
    if texels.is_finite() { format!("{texels} texels") } else { format!("more than {FARTHEST_TEXELS} texels") }
}
