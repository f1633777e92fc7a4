//! Runs one bake, and reads what it took.

use anyhow::{Context, Result};
use serde_json::{Value, json};

use super::Wish;
use super::plan::{Combination, Technique};
use crate::args::interior_argument;
use crate::bench::child::{Outcome, Workshop};
use crate::bench::section::{Row, row};

/// What one bake took.
pub struct Figures {
    /// All stages of the construction, without reading and writing.
    pub seconds: f64,
    /// The light's own stages.
    pub build_seconds: f64,
    pub stages: Vec<(String, f64)>,
    pub read_seconds: f64,
    pub write_seconds: f64,
    pub wall_seconds: f64,
    /// Of the whole process.
    pub cpu_seconds: Option<f64>,
    /// Of the whole process.
    pub peak_bytes: Option<u64>,
    /// Of the light's nodes.
    pub bytes: u64,
    pub file_bytes: u64,
}

/// A bake and what came of it.
pub struct Measurement<'a> {
    pub combination: Combination<'a>,
    /// Or why it ran out of memory.
    pub figures: Result<Figures, String>,
}

/// Measures a bake: the quickest of so many as are wished for. What ran out of memory at a lower resolution is not tried.
pub fn measure<'a>(
    workshop: &Workshop,
    combination: Combination<'a>,
    wish: &Wish,
    before: &[Measurement<'a>],
) -> Result<Measurement<'a>> {
    let failed = before.iter().find(|m| m.figures.is_err() && m.combination.is_series_of(&combination));
    if let Some(failed) = failed {
        let n = failed.combination.resolution.texels();
        return Ok(Measurement { combination, figures: Err(format!("not tried: out of memory at {n}")) });
    }
    let mut best: Option<Figures> = None;
    for _ in 0..wish.repeat {
        match workshop.bake(&combination.subject.path, &combination.arguments(wish.memory_limit))? {
            Outcome::OutOfMemory(words) => return Ok(Measurement { combination, figures: Err(words) }),
            Outcome::Baked(json) => {
                let figures = Figures::read(&json).context("the child's JSON lacks what it should have")?;
                best = best.filter(|best| best.seconds <= figures.seconds).or(Some(figures));
            }
        }
    }
    let figures = Ok(best.context("nothing was measured")?);
    Ok(Measurement { combination, figures })
}

impl Figures {
    /// From what `antumbra bake --json` prints.
    fn read(json: &Value) -> Option<Self> {
        let lights = json["lights"].as_array()?;
        let mut stages = read_stages(&json["stages"])?;
        // The encoding, the last that lights share, comes after all of theirs.
        let place = stages.len().saturating_sub(1);
        let of_lights = lights.iter().map(|light| read_stages(&light["stages"])).collect::<Option<Vec<_>>>()?;
        stages.splice(place..place, of_lights.into_iter().flatten());
        Some(Self {
            seconds: stages.iter().map(|(_, seconds)| seconds).sum(),
            build_seconds: lights.iter().map(|light| light["build_seconds"].as_f64()).sum::<Option<f64>>()?,
            stages,
            read_seconds: json["read_seconds"].as_f64()?,
            write_seconds: json["write_seconds"].as_f64()?,
            wall_seconds: json["wall_seconds"].as_f64()?,
            cpu_seconds: json["cpu_seconds"].as_f64(),
            peak_bytes: json["peak_rss_bytes"].as_u64(),
            bytes: lights.iter().map(|light| light["bytes"].as_u64()).sum::<Option<u64>>()?,
            file_bytes: json["file_bytes"].as_u64()?,
        })
    }

    /// What the paper calls inserting and merging nodes; of the columns, building them.
    pub fn insert_merge_seconds(&self, technique: Technique) -> Option<f64> {
        let signs: &[&str] = if technique == Technique::Columns { &["columns"] } else { &["insert", "merg"] };
        let matches = |name: &str| signs.iter().any(|sign| name.contains(sign));
        let seconds: Vec<f64> = self.stages.iter().filter(|(name, _)| matches(name)).map(|(_, s)| *s).collect();
        if seconds.is_empty() { None } else { Some(seconds.iter().sum()) }
    }
}

fn read_stages(json: &Value) -> Option<Vec<(String, f64)>> {
    let stage = |stage: &Value| Some((stage["name"].as_str()?.to_owned(), stage["seconds"].as_f64()?));
    json.as_array()?.iter().map(stage).collect()
}

impl Measurement<'_> {
    /// For scripts.
    pub fn row(&self) -> Row {
        let Combination { subject, technique, interior, resolution, threads } = self.combination;
        let mut all = row(json!({
            "scene": subject.name,
            "light": subject.light,
            "method": technique.method(),
            "culling": technique.culling(),
            "interior": interior_argument(interior),
            "resolution": resolution.texels(),
            "threads": threads,
        }));
        all.append(&mut match &self.figures {
            Err(words) => row(json!({ "error": words })),
            Ok(figures) => figures.row(),
        });
        all
    }
}

impl Figures {
    fn row(&self) -> Row {
        let stage = |(name, seconds): &(String, f64)| json!({ "name": name, "seconds": seconds });
        row(json!({
            "seconds": self.seconds,
            "build_seconds": self.build_seconds,
            "stages": self.stages.iter().map(stage).collect::<Vec<_>>(),
            "read_seconds": self.read_seconds,
            "write_seconds": self.write_seconds,
            "wall_seconds": self.wall_seconds,
            "cpu_seconds": self.cpu_seconds,
            "peak_bytes": self.peak_bytes,
            "bytes": self.bytes,
            "file_bytes": self.file_bytes,
        }))
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;

    /// What a bake of so many bytes prints.
    pub fn bake_json(bytes: u64) -> Value {
        let stage = |name: &str, seconds: f64| json!({ "name": name, "seconds": seconds });
        let of_light = [stage("inserting", 1.0), stage("merging", 2.0), stage("building columns", 4.0)];
        json!({
            "lights": [{ "bytes": bytes, "build_seconds": 7.0, "stages": of_light }],
            "stages": [stage("finding closed parts", 0.5), stage("encoding", 0.25)],
            "read_seconds": 0.1, "write_seconds": 0.2, "wall_seconds": 8.1, "cpu_seconds": null,
            "peak_rss_bytes": 1000, "file_bytes": bytes + 100,
        })
    }

    pub fn figures(bytes: u64) -> Figures {
        Figures::read(&bake_json(bytes)).expect("all keys")
    }

    #[test]
    fn a_bakes_json_is_read_in_full() {
        let figures = figures(5);
        let names: Vec<&str> = figures.stages.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["finding closed parts", "inserting", "merging", "building columns", "encoding"]);
        assert_eq!((figures.seconds, figures.build_seconds, figures.bytes), (7.75, 7.0, 5));
        assert_eq!((figures.cpu_seconds, figures.peak_bytes), (None, Some(1000)));
        assert_eq!(figures.insert_merge_seconds(Technique::Kampe2015), Some(3.0));
        assert_eq!(figures.insert_merge_seconds(Technique::Columns), Some(4.0));
        let mut lacking = bake_json(5);
        lacking["lights"][0]["bytes"] = Value::Null;
        assert!(Figures::read(&lacking).is_none());
    }
}
