//! `antumbra bench encodings`: bytes, time to build and lookups per second of both encodings over resolution.

use std::time::Instant;

use antumbra::{Filter, Interior, LightShadow, ShadowFile};
use antumbra_bake::light_space::Resolution;
use antumbra_bake::{BakeOptions, Encoding, ResolutionRequest, Silent, bake};
use antumbra_render::Tracer;
use antumbra_scene::{AlphaMode, Light, Scene};
use anyhow::{Context, Result, ensure};
use glam::DVec3;
use serde_json::{Value, json};

use super::plot::{Axis, Curve, GREY, ORANGE, Panel, Plot, file_name};
use super::report::Report;
use super::section::{Column, Row, Section, Shown, row};
use crate::compare::Kind;
use crate::compare::sampling::Sampler;
use crate::progress::Progress;

/// A scene and its sun.
pub struct Subject {
    /// Its name in tables.
    pub name: String,
    pub scene: Scene,
    pub sun: Light,
}

/// What to measure.
pub struct Study {
    pub interior: Interior,
    /// Coarsest first.
    pub resolutions: Vec<Resolution>,
    /// Points of surfaces that are looked up.
    pub points: u64,
}

const COLUMNS: &[Column<'_>] = &[
    ("scene", "scene", Shown::Plain),
    ("resolution", "N", Shown::Plain),
    ("encoding", "encoding", Shown::Plain),
    ("file_bytes", "file", Shown::Megabytes),
    ("bytes_ratio", "of dag8", Shown::Percent),
    ("growth", "growth", Shown::Decimal),
    ("pool_bytes", "in memory", Shown::Megabytes),
    ("pool_ratio", "of dag8", Shown::Percent),
    ("build_seconds", "built in", Shown::Seconds),
    ("build_ratio", "times dag8's", Shown::Decimal),
    ("random_per_us", "random points, million per s", Shown::Decimal),
    ("coherent_per_us", "coherent", Shown::Decimal),
    ("filtered_per_us", "9 x 9 tent, coherent", Shown::Decimal),
    ("differing_share", "answers that differ", Shown::Percent),
];

/// Passes over all points, and bakes, of which the fastest counts.
const PASSES: usize = 5;
/// Bakes that take longer are not done again, seconds; shorter ones while they do not together.
const LONG_ENOUGH_S: f64 = 5.0;

const ENCODINGS: [Encoding; 2] = [Encoding::Dag8, Encoding::Silhouette];

/// Measures both encodings of every scene at every resolution.
pub fn run(subjects: &[Subject], study: &Study, progress: &Progress) -> Result<Report> {
    let about = format!(
        "Policy {}. Growth: bytes of the file at N over those at N / 2. In memory: the node pool, as it is looked up. Built in: the whole bake, \
on all threads, the fastest of up to five. Lookups of one thread at {} random points of surfaces, as they come and in the order of \
their texels; what differs lies inside solids or on edges, where a policy leaves the choice.",
        study.interior.name(),
        study.points
    );
    let mut section = Section::new("Encodings", about, COLUMNS);
    let mut plots = Vec::new();
    for subject in subjects {
        let rows = rows(subject, study, progress).with_context(|| format!("cannot measure {}", subject.name))?;
        plots.push(plot(&subject.name, &rows)?);
        section.rows.extend(rows);
    }
    Ok(Report {
        table: "encodings",
        title: "Encodings",
        rows: section.rows.clone(),
        sections: vec![section],
        summary: Row::new(),
        plots,
        images: Vec::new(),
        gpu: None,
    })
}

fn rows(subject: &Subject, study: &Study, progress: &Progress) -> Result<Vec<Row>> {
    let tracer = Tracer::new(&subject.scene, |node, m| !node.dynamic && m.alpha_mode != AlphaMode::Blend);
    let sampler = Sampler::everywhere(&tracer);
    let points: Vec<DVec3> = (0..study.points).map(|i| sampler.sample(1, Kind::Surface, i).point_world).collect();
    ensure!(!points.is_empty(), "there are no points to look up; give --points a number above 0");
    let mut rows = Vec::new();
    let mut before = [None; 2];
    for resolution in &study.resolutions {
        let mut graph: Option<Measured> = None;
        for (encoding, before) in ENCODINGS.into_iter().zip(&mut before) {
            progress.stage(&format!("{}: {} at {}", subject.name, encoding.name(), resolution.texels()));
            let own = Measured::new(subject, study, encoding, *resolution, &points)?;
            let of_graph = |f: fn(&Measured) -> f64| graph.as_ref().map(|graph| f(&own) / f(graph));
            let differing = graph.as_ref().map(|graph| {
                let off = graph.answers.iter().zip(&own.answers).filter(|(a, b)| a != b).count();
                off as f64 / own.answers.len() as f64
            });
            rows.push(row(json!({
                "scene": subject.name, "light": subject.sun.name, "interior": study.interior.name(),
                "resolution": resolution.texels(), "encoding": encoding.name(),
                "file_bytes": own.file_bytes,
                "bytes_ratio": of_graph(|m| m.file_bytes as f64),
                "growth": before.map(|before: u64| own.file_bytes as f64 / before as f64),
                "pool_bytes": own.pool_bytes,
                "pool_ratio": of_graph(|m| m.pool_bytes as f64),
                "build_seconds": own.build_seconds,
                "build_ratio": of_graph(|m| m.build_seconds),
                "random_per_us": own.rates[0], "coherent_per_us": own.rates[1], "filtered_per_us": own.rates[2],
                "differing_share": differing,
            })));
            *before = Some(own.file_bytes);
            graph.get_or_insert(own);
        }
    }
    Ok(rows)
}

/// One bake.
struct Measured {
    file_bytes: u64,
    pool_bytes: u64,
    build_seconds: f64,
    /// Lookups per microsecond: of points as they come, in the order of their texels, and filtered.
    rates: [f64; 3],
    /// Of the points as they come.
    answers: Vec<bool>,
}

impl Measured {
    fn new(
        subject: &Subject,
        study: &Study,
        encoding: Encoding,
        resolution: Resolution,
        points: &[DVec3],
    ) -> Result<Self> {
        let options = BakeOptions {
            interior: study.interior,
            encoding: Some(encoding),
            resolution: ResolutionRequest::Texels(resolution),
            ..BakeOptions::default()
        };
        let timed = || {
            let start = Instant::now();
            let baked = bake(&subject.scene, std::slice::from_ref(&subject.sun), &options, &Silent)?;
            anyhow::Ok((baked, start.elapsed().as_secs_f64()))
        };
        let (baked, mut build_seconds) = timed()?;
        let more = (LONG_ENOUGH_S / build_seconds) as usize;
        for _ in 0..more.min(PASSES - 1) {
            build_seconds = build_seconds.min(timed()?.1);
        }
        let file = ShadowFile::from_bytes(&baked.bytes)?;
        let light = file.lights().next().context("the bake has no light")?;
        let mut coherent = points.to_vec();
        coherent.sort_by_cached_key(|point| place_in_order(light, *point));
        let filter = Filter::new_tent(9)?;
        let answers = points.iter().map(|point| light.visibility(*point) > 0.5).collect();
        let rates = [
            rate(points, |point| light.visibility(point)),
            rate(&coherent, |point| light.visibility(point)),
            rate(&coherent, |point| light.filtered(point, None, filter)),
        ];
        let (file_bytes, pool_bytes) = (baked.bytes.len() as u64, 4 * file.pool().len() as u64);
        Ok(Self { file_bytes, pool_bytes, build_seconds, rates, answers })
    }
}

/// Calls per microsecond: of the fastest of some passes, since whatever else runs only slows them down.
fn rate(points: &[DVec3], each: impl Fn(DVec3) -> f32) -> f64 {
    let pass = || {
        let start = Instant::now();
        points.iter().for_each(|point| _ = std::hint::black_box(each(*point)));
        start.elapsed().as_secs_f64()
    };
    let least = (0..PASSES).map(|_| pass()).fold(f64::INFINITY, f64::min);
    points.len() as f64 / least.max(1e-9) * 1e-6
}

/// Place of a point's texel on a Z-shaped curve through all texels.
fn place_in_order(light: LightShadow<'_>, point: DVec3) -> u64 {
    let voxel = light.project(point).voxel;
    let spread = |c: f64| (0..20).fold(0u64, |all, bit| all | ((c.max(0.0) as u64 >> bit & 1) << (2 * bit)));
    spread(voxel.x) | (spread(voxel.y) << 1)
}

/// Bytes over resolution.
fn plot(scene: &str, rows: &[Row]) -> Result<Plot> {
    let curve = |name, color, encoding: &str| {
        let own = rows.iter().filter(|row| row.get("encoding").and_then(Value::as_str) == Some(encoding));
        let value = |row: &Row, key: &str| row.get(key).and_then(Value::as_f64).unwrap_or(0.0);
        Curve { name, color, points: own.map(|row| (value(row, "resolution"), value(row, "file_bytes"))).collect() }
    };
    let curves = vec![curve("dag8", GREY, "dag8"), curve("silhouette", ORANGE, "silhouette")];
    let of: Vec<&Curve> = curves.iter().collect();
    let (x, y) = (Axis::resolutions(&of), Axis::bytes("bytes", &of));
    Plot::new(
        file_name("encodings", scene, "bytes"),
        &[Panel { title: format!("{scene}: bytes over resolution"), x, y, curves }],
    )
}
