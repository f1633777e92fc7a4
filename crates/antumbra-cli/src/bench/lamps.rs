//! `antumbra bench lamps`: what every spot and point light of a scene takes, as in figure 3 of Kämpe, Sintorn, Assarsson 2015, "Fast,
//! memory-efficient construction of voxelized shadows".

use std::path::PathBuf;

use antumbra_bake::light_space::Resolution;
use anyhow::{Context, Result, bail};
use serde_json::{Value, json};

use super::child::{Outcome, Workshop};
use super::plot::{Axis, BLUE, Curve, ORANGE, Panel, Plot, file_name};
use super::report::Report;
use super::section::{Column, Row, Section, Shown, row};
use crate::progress::Progress;

/// A scene's file, and its lights to measure.
pub struct Subject {
    /// The scene's name in tables.
    pub name: String,
    pub path: PathBuf,
    pub lights: Vec<String>,
}

/// What one light took.
struct Lamp {
    name: String,
    kind: String,
    bytes: u64,
    seconds: f64,
}

impl Lamp {
    /// A point light's shadow map has six faces.
    fn faces(&self) -> u64 {
        if self.kind == "point" { 6 } else { 1 }
    }
}

/// A bake of all lights together.
struct Bake {
    lamps: Vec<Lamp>,
    /// Wall time without reading and writing.
    seconds: f64,
    threads: u64,
    file_bytes: u64,
    peak_bytes: Option<u64>,
}

const COLUMNS: &[Column<'_>] =
    &[("what", "", Shown::Plain), ("ours", "ours", Shown::Plain), ("paper", "Kämpe et al. 2015", Shown::Plain)];

const ABOUT: &str = "Beside section 5.3 and figure 3 of Kämpe et al. 2015: 165 spot lights in Closed City at 8192, GTX Titan and i5. Lights are \
built side by side; a light's own time is from a second bake on one thread, so that no light waits for another. Its bytes are of nodes \
that no light before it in the file has. A 16-bit shadow map takes 2 N^2 bytes, a point light's six of them.";

/// Bakes a scene's local lights on all threads, then on one.
pub fn run(
    workshop: &Workshop,
    subject: &Subject,
    resolution: Resolution,
    threads: usize,
    progress: &Progress,
) -> Result<Report> {
    progress.stage(&format!("baking {} lights", subject.lights.len()));
    let together = bake(workshop, subject, resolution, threads)?;
    let alone = if together.threads > 1 {
        progress.stage(&format!("baking {} lights on one thread", subject.lights.len()));
        Some(bake(workshop, subject, resolution, 1)?)
    } else {
        None
    };
    let alone = alone.as_ref().unwrap_or(&together);
    let result = Lamps { subject, resolution, together: &together, alone };
    let mut section = Section::new("Spot and point lights", ABOUT, COLUMNS);
    section.rows = result.for_people();
    Ok(Report {
        table: "lamps",
        title: "Many local lights",
        sections: vec![section],
        rows: result.rows(),
        summary: result.summary(),
        plots: vec![result.plot()?],
        images: Vec::new(),
        gpu: None,
    })
}

fn bake(workshop: &Workshop, subject: &Subject, resolution: Resolution, threads: usize) -> Result<Bake> {
    let mut arguments: Vec<String> = subject.lights.iter().map(|name| format!("--light={name}")).collect();
    arguments.push(format!("--resolution={}", resolution.texels()));
    if threads > 0 {
        arguments.push(format!("--threads={threads}"));
    }
    match workshop.bake(&subject.path, &arguments)? {
        Outcome::Baked(json) => read(&json).context("the child's JSON lacks what it should have"),
        Outcome::OutOfMemory(words) => bail!("out of memory: {words}; lower --resolution"),
    }
}

/// From what `antumbra bake --json` prints.
fn read(json: &Value) -> Option<Bake> {
    let lights = json["lights"].as_array()?;
    let is_lamp = |light: &&Value| light["kind"] != "directional";
    let lamps = lights.iter().filter(is_lamp).map(read_lamp).collect::<Option<Vec<Lamp>>>()?;
    Some(Bake {
        seconds: json["wall_seconds"].as_f64()? - json["read_seconds"].as_f64()? - json["write_seconds"].as_f64()?,
        threads: json["threads"].as_u64()?,
        file_bytes: json["file_bytes"].as_u64()?,
        peak_bytes: json["peak_rss_bytes"].as_u64(),
        lamps,
    })
}

fn read_lamp(light: &Value) -> Option<Lamp> {
    Some(Lamp {
        name: light["name"].as_str()?.to_owned(),
        kind: light["kind"].as_str()?.to_owned(),
        bytes: light["bytes"].as_u64()?,
        seconds: light["build_seconds"].as_f64()?,
    })
}

/// The least, the middle and the greatest of some values, and their sum.
struct Spread {
    sorted: Vec<f64>,
}

impl Spread {
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let mut sorted: Vec<f64> = values.collect();
        sorted.sort_by(f64::total_cmp);
        Self { sorted }
    }

    fn sum(&self) -> f64 {
        self.sorted.iter().sum()
    }

    fn mean(&self) -> f64 {
        self.sum() / self.sorted.len().max(1) as f64
    }

    /// Of an even number, the mean of the middle two.
    fn median(&self) -> f64 {
        let n = self.sorted.len();
        let at = |i: usize| self.sorted.get(i).copied().unwrap_or(0.0);
        0.5 * (at(n.saturating_sub(1) / 2) + at(n / 2))
    }

    fn least(&self) -> f64 {
        self.sorted.first().copied().unwrap_or(0.0)
    }

    fn greatest(&self) -> f64 {
        self.sorted.last().copied().unwrap_or(0.0)
    }

    fn json(&self) -> Value {
        json!({
            "mean": self.mean(),
            "median": self.median(),
            "least": self.least(),
            "greatest": self.greatest(),
        })
    }

    /// Ranks from 1 on, and values.
    fn points(&self) -> Vec<(f64, f64)> {
        self.sorted.iter().enumerate().map(|(i, value)| (i as f64 + 1.0, *value)).collect()
    }
}

/// What was measured.
struct Lamps<'a> {
    subject: &'a Subject,
    resolution: Resolution,
    /// On all threads.
    together: &'a Bake,
    /// On one, where each light's time is its own.
    alone: &'a Bake,
}

impl Lamps<'_> {
    fn milliseconds(&self) -> Spread {
        Spread::of(self.alone.lamps.iter().map(|lamp| 1e3 * lamp.seconds))
    }

    fn megabytes(&self) -> Spread {
        Spread::of(self.alone.lamps.iter().map(|lamp| 1e-6 * lamp.bytes as f64))
    }

    fn shadow_map_bytes(&self, lamp: &Lamp) -> u64 {
        let n = u64::from(self.resolution.texels());
        2 * n * n * lamp.faces()
    }

    fn rows(&self) -> Vec<Row> {
        let of_lamp = |lamp: &Lamp| {
            row(json!({
                "scene": self.subject.name,
                "light": lamp.name,
                "kind": lamp.kind,
                "resolution": self.resolution.texels(),
                "bytes": lamp.bytes,
                "build_seconds": lamp.seconds,
                "shadow_map_bytes": self.shadow_map_bytes(lamp),
            }))
        };
        self.alone.lamps.iter().map(of_lamp).collect()
    }

    fn summary(&self) -> Row {
        let (ms, mb) = (self.milliseconds(), self.megabytes());
        row(json!({
            "scene": self.subject.name,
            "lights": self.alone.lamps.len(),
            "resolution": self.resolution.texels(),
            "threads": self.together.threads,
            "seconds": self.together.seconds,
            "seconds_on_one_thread": self.alone.seconds,
            "peak_bytes": self.together.peak_bytes,
            "bytes": self.alone.lamps.iter().map(|lamp| lamp.bytes).sum::<u64>(),
            "file_bytes": self.together.file_bytes,
            "shadow_map_bytes": self.alone.lamps.iter().map(|lamp| self.shadow_map_bytes(lamp)).sum::<u64>(),
            "light_ms": ms.json(),
            "light_megabytes": mb.json(),
        }))
    }

    fn for_people(&self) -> Vec<Row> {
        let (ms, mb) = (self.milliseconds(), self.megabytes());
        let (together, alone) = (self.together, self.alone);
        let lamps = alone.lamps.len();
        let shadow_maps: u64 = alone.lamps.iter().map(|lamp| self.shadow_map_bytes(lamp)).sum();
        let each = shadow_maps as f64 / lamps.max(1) as f64;
        let time = |ms: f64| Shown::Seconds.text(&(1e-3 * ms).into());
        let size = |mb: f64| Shown::Megabytes.text(&(1e6 * mb).into());
        let mut rows = vec![
            ("scene", self.subject.name.clone(), "Closed City"),
            ("lights", lamps.to_string(), "165"),
            ("N", self.resolution.texels().to_string(), "8192"),
            ("construction of all", on_threads(together), "19 s"),
        ];
        if together.threads > 1 {
            rows.push(("construction of all", on_threads(alone), ""));
        }
        rows.extend([
            ("a light: mean", time(ms.mean()), "115 ms (19 s / 165)"),
            ("a light: median", time(ms.median()), ""),
            ("a light: least", time(ms.least()), ""),
            ("a light: greatest", time(ms.greatest()), ""),
            ("bytes of all", size(mb.sum()), "96 MB"),
            ("bytes of a light: mean", size(mb.mean()), "0.58 MB (96 MB / 165)"),
            ("bytes of a light: median", size(mb.median()), ""),
            ("bytes of a light: least", size(mb.least()), "0.3 MB"),
            ("bytes of a light: greatest", size(mb.greatest()), "1.7 MB"),
            ("16-bit shadow map of a light", size(1e-6 * each), "134.22 MB"),
            ("shadow map / bytes of a light", format!("{:.0}", each / (1e6 * mb.mean()).max(1.0)), "231"),
        ]);
        if let Some(peak) = together.peak_bytes {
            rows.push(("peak memory", crate::table::bytes(peak), ""));
        }
        rows.into_iter().map(|(what, ours, paper)| row(json!({ "what": what, "ours": ours, "paper": paper }))).collect()
    }

    /// Both distributions, sorted, as in figure 3.
    fn plot(&self) -> Result<Plot> {
        let (ms, mb) = (self.milliseconds(), self.megabytes());
        let panel = |title: &str, unit, spread: &Spread, color| {
            let curve = Curve { name: "", color, points: spread.points() };
            let (digits, mean) = (digits(spread.mean()), spread.mean());
            Panel {
                title: format!("{}: {title}, {mean:.digits$} {unit} on average", self.subject.name),
                x: Axis::ranks("lights, sorted", spread.sorted.len()),
                y: Axis::logarithmic(unit, &[&curve]),
                curves: vec![curve],
            }
        };
        let panels = [panel("time of a light", "ms", &ms, ORANGE), panel("size of a light", "MB", &mb, BLUE)];
        Plot::new(file_name("lamps", &self.subject.name, "distribution"), &panels)
    }
}

/// Behind the point, so that two or more digits count.
fn digits(value: f64) -> usize {
    if value < 10.0 { 2 } else { 0 }
}

fn on_threads(bake: &Bake) -> String {
    format!("{} on {} thread(s)", Shown::Seconds.text(&bake.seconds.into()), bake.threads)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bake(threads: u64) -> Bake {
        let light =
            |i: u64| json!({ "name": format!("l{i}"), "kind": "spot", "bytes": i, "build_seconds": 0.001 * i as f64 });
        let sun = json!({ "name": "sun", "kind": "directional", "bytes": 9, "build_seconds": 9.0 });
        let json = json!({
            "lights": [light(3), sun, light(1), light(2), light(10)],
            "wall_seconds": 3.0, "read_seconds": 0.75, "write_seconds": 0.25, "threads": threads,
            "file_bytes": 100, "peak_rss_bytes": null,
        });
        read(&json).expect("all keys")
    }

    #[test]
    fn lamps_are_summed_up_without_the_sun() {
        let subject = Subject { name: "city".to_owned(), path: PathBuf::new(), lights: Vec::new() };
        let resolution = Resolution::new(8192).expect("a power of two");
        let (together, alone) = (bake(2), bake(1));
        let lamps = Lamps { subject: &subject, resolution, together: &together, alone: &alone };
        let ms = lamps.milliseconds();
        assert_eq!((ms.least(), ms.median(), ms.mean(), ms.greatest()), (1.0, 2.5, 4.0, 10.0));
        assert_eq!((lamps.rows().len(), lamps.summary()["bytes"].clone()), (4, json!(16)));
        assert_eq!(lamps.rows()[0]["shadow_map_bytes"], 134_217_728);
        let shown = lamps.for_people();
        assert!(shown.contains(&row(
            json!({ "what": "construction of all", "ours": "2.00 s on 2 thread(s)", "paper": "19 s" })
        )));
        assert!(lamps.plot().expect("a plot").svg.contains("lights, sorted"));
    }

    #[test]
    fn medians() {
        let median = |values: &[f64]| Spread::of(values.iter().copied()).median();
        assert_eq!([median(&[]), median(&[5.0]), median(&[9.0, 1.0]), median(&[1.0, 9.0, 2.0])], [0.0, 5.0, 5.0, 2.0]);
    }
}
