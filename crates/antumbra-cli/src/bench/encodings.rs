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
const PASSES: usize = 7;
/// Graphs that take longer to bake are baked once, seconds; others as often as fits into it.
const LONG_ENOUGH_S: f64 = 5.0;

const ENCODINGS: [Encoding; 2] = [Encoding::Dag8, Encoding::Silhouette];

/// Measures both encodings of every scene at every resolution.
pub fn run(subjects: &[Subject], study: &Study, progress: &Progress) -> Result<Report> {
    let about = format!(
        "Policy {}. Growth: bytes of the file at N over those at N / 2. In memory: the node pool, as it is looked up. Built in: the whole bake, \
on all threads, the fastest of up to seven. Lookups of one thread at {} random points of surfaces, as they come and in the order of \
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
        progress.stage(&format!("{} at {}", subject.name, resolution.texels()));
        let measured = measured(subject, study, *resolution, &points)?;
        let graph = &measured[0];
        for ((encoding, own), before) in ENCODINGS.into_iter().zip(&measured).zip(&mut before) {
            let of_graph = |f: fn(&Measured) -> f64| (encoding != ENCODINGS[0]).then(|| f(own) / f(graph));
            let off = graph.answers.iter().zip(&own.answers).filter(|(a, b)| a != b).count();
            let differing = (encoding != ENCODINGS[0]).then(|| off as f64 / own.answers.len() as f64);
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

/// Both bakes. They take turns, since whatever else runs slows them down; of each the fastest pass counts.
fn measured(subject: &Subject, study: &Study, resolution: Resolution, points: &[DVec3]) -> Result<[Measured; 2]> {
    let baked = |encoding| {
        let options = BakeOptions {
            interior: study.interior,
            encoding: Some(encoding),
            resolution: ResolutionRequest::Texels(resolution),
            ..BakeOptions::default()
        };
        let start = Instant::now();
        let baked = bake(&subject.scene, std::slice::from_ref(&subject.sun), &options, &Silent)?;
        anyhow::Ok((baked.bytes, start.elapsed().as_secs_f64()))
    };
    let [first, second] = ENCODINGS.map(baked);
    let bakes = [first?, second?];
    let mut build_seconds = bakes.each_ref().map(|(_, seconds)| *seconds);
    let more = (LONG_ENOUGH_S / build_seconds[0]) as usize;
    for _ in 0..more.min(PASSES - 1) {
        for (encoding, least) in ENCODINGS.into_iter().zip(&mut build_seconds) {
            *least = least.min(baked(encoding)?.1);
        }
    }
    let [first, second] = bakes.each_ref().map(|(bytes, _)| ShadowFile::from_bytes(bytes));
    let files = [first?, second?];
    let [first, second] = files.each_ref().map(|file| file.lights().next().context("the bake has no light"));
    let lights = [first?, second?];
    let mut coherent = points.to_vec();
    coherent.sort_by_cached_key(|point| place_in_order(lights[0], *point));
    let filter = Filter::new_tent(9)?;
    let mut rates = [[0.0f64; 3]; 2];
    for _ in 0..PASSES {
        for (light, rates) in lights.iter().zip(&mut rates) {
            let of_pass = [
                rate(points, |point| light.visibility(point)),
                rate(&coherent, |point| light.visibility(point)),
                rate(&coherent, |point| light.filtered(point, None, filter)),
            ];
            rates.iter_mut().zip(of_pass).for_each(|(best, rate)| *best = best.max(rate));
        }
    }
    Ok([0, 1].map(|i| Measured {
        file_bytes: bakes[i].0.len() as u64,
        pool_bytes: 4 * files[i].pool().len() as u64,
        build_seconds: build_seconds[i],
        rates: rates[i],
        answers: points.iter().map(|point| lights[i].visibility(*point) > 0.5).collect(),
    }))
}

/// Calls per microsecond.
fn rate(points: &[DVec3], each: impl Fn(DVec3) -> f32) -> f64 {
    let start = Instant::now();
    points.iter().for_each(|point| _ = std::hint::black_box(each(*point)));
    points.len() as f64 / start.elapsed().as_secs_f64().max(1e-9) * 1e-6
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
