//! A comparison in words and as JSON.

use serde_json::{Value, json};

use super::{CLASSIFIED_EVERY, Comparison, FARTHEST_TEXELS, LightComparison, Tally, Worst};
use crate::table::{Table, count, percent, printable};

/// More lights than this are summed up.
const LIGHTS_IN_FULL: usize = 8;

impl Comparison {
    /// For people: a table per light, or one of all where there are many.
    #[must_use]
    pub fn text(&self) -> String {
        if self.lights.len() > LIGHTS_IN_FULL {
            return self.summary();
        }
        let tables = self.lights.iter().flat_map(|light| {
            let name = printable(&light.name);
            light.kinds().map(|(tally, place)| tally.table().text(&format!("{name}, {place}")))
        });
        tables.collect::<String>() + &self.verdict() + "\n"
    }

    /// All lights together, kind by kind of points, and those that are not as they should be.
    fn summary(&self) -> String {
        let lights = count(self.lights.len() as u64);
        let tables = [0, 1, 2].map(|kind| {
            let of_kind = self.lights.iter().map(|light| light.kinds()[kind].0.clone());
            let all = of_kind.fold(Tally::default(), Tally::merge);
            let place = self.lights[0].kinds()[kind].1;
            all.table().text(&format!("{lights} lights, {place}"))
        });
        let wrong = self.lights.iter().filter(|light| light.kinds().iter().any(|(tally, _)| tally.too_far > 0));
        let names: Vec<String> = wrong.map(|light| printable(&light.name)).collect();
        let wrong =
            if names.is_empty() { String::new() } else { format!("not as they should be: {}\n", names.join(", ")) };
        tables.concat() + &wrong + &self.verdict() + "\n"
    }

    /// One sentence.
    #[must_use]
    pub fn verdict(&self) -> String {
        let total = self.total();
        let shares = format!(
            "{} of {} points agree, {} differ inside solids{}, {} near edges",
            count(total.agreeing),
            count(total.samples),
            count(total.undefined),
            if total.left_open > 0 {
                format!(", {} where the policy leaves it open", count(total.left_open))
            } else {
                String::new()
            },
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
            "left_open": total.left_open,
            "disagreeing": total.disagreeing,
            "too_far": total.too_far,
            "farthest_texels": texels_json(total.farthest_texels),
            "classified_every": CLASSIFIED_EVERY,
        })
    }
}

impl LightComparison {
    /// Its tallies, each with where its points lie.
    fn kinds(&self) -> [(&Tally, &'static str); 3] {
        [
            (&self.air, "in the air"),
            (&self.surfaces, "on surfaces"),
            (&self.off_surfaces, "on surfaces, moved off them as a filtered lookup is"),
        ]
    }

    fn json(&self) -> Value {
        json!({
            "name": self.name,
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
        table.row("differ inside a solid", count(self.undefined));
        table.row("differ where the policy leaves it open", count(self.left_open));
        table.row("differ elsewhere", count(self.disagreeing));
        table.row("farthest from an edge", texels_text(self.farthest_texels));
        table.row("lit", percent(self.lit, self.samples));
        let of = format!("of every {CLASSIFIED_EVERY}th point");
        let share = |part| format!("{} {of}", percent(part, self.classified));
        table.row("robust", share(self.robust));
        table.row("near an edge", share(self.near_edge));
        table.row("inside a solid", share(self.inside));
        table.row("left open by the policy", share(self.open));
        for worst in &self.worst {
            table.row("too far", worst.text());
        }
        table
    }

    fn json(&self) -> Value {
        let share = |part: u64| part as f64 / self.classified.max(1) as f64;
        json!({
            "samples": self.samples,
            "agreeing": self.agreeing,
            "undefined": self.undefined,
            "disagreeing": self.disagreeing,
            "too_far": self.too_far,
            "farthest_texels": texels_json(self.farthest_texels),
            "lit_share": self.lit as f64 / self.samples.max(1) as f64,
            "classified": self.classified,
            "robust_share": share(self.robust),
            "near_edge_share": share(self.near_edge),
            "inside_share": share(self.inside),
            "left_open": self.left_open,
            "left_open_share": share(self.open),
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
