//! `antumbra bench ivsv`: soft shadows of area lights in fog. The comparisons of Wyman and Dai 2013, *Imperfect Voxelized
//! Shadow Volumes*: tables 1 and 2, the cost over resolution, and its figures.

mod figures;
mod studio;

use antumbra_render::area::{
    Airlight, AreaLight, AreaLighting, AreaTechnique, Gathering, Interpolation, VoxelResolution,
};
use antumbra_scene::{Camera, Scene};
use anyhow::Result;
use serde_json::json;

use self::studio::{Measured, Studio};
use super::plot::{AMBER, Axis, BLUE, Curve, GREY, ORANGE, Panel, Plot, file_name};
use super::report::Report;
use super::section::{Column, Row, Section, Shown, row};
use crate::progress::Progress;

/// What to measure.
pub struct Study {
    /// The scene's name in tables.
    pub name: String,
    pub scene: Scene,
    pub camera: Camera,
    pub lights: Vec<AreaLight>,
    /// Extinction per metre.
    pub fog: f64,
    pub most_vpls: u32,
    pub most_voxels: u32,
    /// `None` for what suits the card.
    pub size: Option<[u32; 2]>,
    /// Rays per pixel of the truth.
    pub truth: u32,
    pub has_figures: bool,
}

/// Steps of the paper's table 1, and the passes that they are here.
const STEPS: [(&str, &[&str]); 5] = [
    ("shadow maps", &["points", "VPL maps"]),
    ("voxelization", &["rectify"]),
    ("scan", &["scan"]),
    ("gather", &["gather", "area light"]),
    ("total", &["points", "VPL maps", "rectify", "scan", "gather", "area light"]),
];
/// All of them.
const TOTAL: usize = STEPS.len() - 1;

/// The paper's figures for 256 VPLs (its table 1): how many times as fast as one by one each step is.
const THEIRS: [f64; 5] = [18.6, 16.6, 25.8, 2.0, 5.6];

/// Measures everything.
pub fn run(study: Study, progress: &Progress) -> Result<Report> {
    let mut studio = Studio::new(&study, progress)?;
    let base = studio.base(&study.lights);
    let mut rows = Vec::new();
    let (mut sections, mut plots, mut images) = (Vec::new(), Vec::new(), Vec::new());
    let tables: [Table; 5] = [one_by_one, ways, interpolations, resolutions, single];
    for measure in tables {
        let (section, plot) = measure(&mut studio, &base, &study, progress)?;
        rows.extend(section.rows.iter().cloned());
        sections.push(section);
        plots.extend(plot);
    }
    if study.has_figures {
        let (section, drawn) = figures::draw(&mut studio, &base, &study, progress)?;
        rows.extend(section.rows.iter().cloned());
        sections.push(section);
        images = drawn;
    }
    Ok(Report {
        table: "ivsv",
        title: "Soft shadows of area lights in fog",
        rows,
        sections,
        summary: Row::new(),
        plots,
        images,
        gpu: Some(studio.card()),
    })
}

type Measure = (Section, Option<Plot>);
type Table = fn(&mut Studio, &AreaLighting, &Study, &Progress) -> Result<Measure>;

/// Numbers of VPLs: 1, 4, 16, ... up to a largest.
fn vpl_counts(most: u32) -> Vec<u32> {
    let mut counts: Vec<u32> = (0..).map(|i| 4_u32.pow(i)).take_while(|count| *count <= most).collect();
    if counts.last() != Some(&most) {
        counts.push(most);
    }
    counts
}

const STEP_COLUMNS: &[Column<'_>] = &[
    ("vpls", "VPLs", Shown::Count),
    ("step", "step", Shown::Plain),
    ("naive_ms", "one by one, ms", Shown::Decimal),
    ("ours_ms", "all at once, ms", Shown::Decimal),
    ("ratio", "times as fast", Shown::Decimal),
    ("theirs", "the paper's", Shown::Decimal),
    ("rmse", "error", Shown::Decimal),
];

/// Table 1: each step for more and more VPLs, one VPL after the other and all at once.
fn one_by_one(studio: &mut Studio, base: &AreaLighting, study: &Study, progress: &Progress) -> Result<Measure> {
    let about = format!(
        "{}, 128 samples along each axis, every pixel gathers all. One by one, each VPL has passes of its own, and its scan runs in \
steps over memory; otherwise all have passes together. Errors are root mean squares of 255 against {} traced rays. The \
paper's ratios (its table 1) are of 256 VPLs on a Quadro K5000.",
        studio.about(),
        study.truth,
    );
    let mut section = Section::new("Steps, one VPL after the other and all at once", about, STEP_COLUMNS);
    let counts = vpl_counts(study.most_vpls);
    progress.count("one by one", counts.len() as u64, "numbers of VPLs");
    for (i, vpls) in counts.iter().enumerate() {
        let of = |technique| AreaLighting { technique, vpls: *vpls, ..base.clone() };
        let ours = studio.measure(&of(AreaTechnique::Voxels))?;
        let naive = studio.measure(&of(AreaTechnique::OneByOne))?;
        for (step, (name, passes)) in STEPS.iter().enumerate() {
            let (naive, ms) = (naive.ms(passes), ours.ms(passes));
            let mut row = row(json!({
                "table": "steps", "scene": study.name, "vpls": vpls, "step": name, "naive_ms": naive, "ours_ms": ms,
                "ratio": naive / ms.max(1e-6),
            }));
            if *vpls == 256 {
                row.insert("theirs".to_owned(), THEIRS[step].into());
            }
            if step == TOTAL {
                row.insert("rmse".to_owned(), ours.rmse.into());
            }
            section.rows.push(row);
        }
        progress.set(i as u64 + 1, counts.len() as u64);
    }
    let curve = |name, step: &str, key: &str, color| {
        let own = section.rows.iter().filter(|row| row["step"] == step);
        let point = |row: &Row| (number(row, "vpls"), number(row, key).max(1e-3));
        Curve { name, color, points: own.map(point).collect() }
    };
    let steps = vec![
        curve("maps", "shadow maps", "ratio", GREY),
        curve("voxelization", "voxelization", "ratio", AMBER),
        curve("scan", "scan", "ratio", ORANGE),
        curve("gather", "gather", "ratio", BLUE),
    ];
    let totals = vec![curve("one by one", "total", "naive_ms", ORANGE), curve("all at once", "total", "ours_ms", BLUE)];
    let panel = |title: &str, curves: Vec<Curve>, unit| {
        let all: Vec<&Curve> = curves.iter().collect();
        let x = across(&curves, "VPLs");
        Panel { title: format!("{}: {title}", study.name), x, y: Axis::logarithmic(unit, &all), curves }
    };
    let panels = [panel("all steps", totals, "ms"), panel("one by one beside all at once", steps, "times as fast")];
    let plot = Plot::new(file_name("ivsv", &study.name, "vpls"), &panels)?;
    Ok((section, Some(plot)))
}

/// An axis over what curves have for x.
fn across(curves: &[Curve], name: &'static str) -> Axis {
    let turn = |curve: &Curve| Curve { points: curve.points.iter().map(|(x, y)| (*y, *x)).collect(), ..curve.clone() };
    let turned: Vec<Curve> = curves.iter().map(turn).collect();
    Axis::logarithmic(name, &turned.iter().collect::<Vec<_>>())
}

fn number(row: &Row, key: &str) -> f64 {
    row.get(key).and_then(serde_json::Value::as_f64).unwrap_or(0.0)
}

const WAY_COLUMNS: &[Column<'_>] = &[
    ("name", "", Shown::Plain),
    ("shadows_ms", "shadows, ms", Shown::Decimal),
    ("gather_ms", "gather, ms", Shown::Decimal),
    ("total_ms", "sum, ms", Shown::Decimal),
    ("ratio", "one by one takes times", Shown::Decimal),
    ("rmse", "error", Shown::Decimal),
];

fn way_row(study: &Study, table: &str, name: &str, measured: &Measured) -> Row {
    let (gather, total) = (measured.ms(STEPS[3].1), measured.ms(STEPS[TOTAL].1));
    row(json!({
        "table": table, "scene": study.name, "name": name, "shadows_ms": total - gather, "gather_ms": gather,
        "total_ms": total, "rmse": measured.rmse,
    }))
}

/// Table 2: the ways to gather, beside all other ways to have such shadows.
fn ways(studio: &mut Studio, base: &AreaLighting, study: &Study, progress: &Progress) -> Result<Measure> {
    let about = format!(
        "{}, {} VPLs, 128 samples along each axis. Marched maps look up each VPL's map 128 times along each view ray. The paper's \
(its table 2, 256 VPLs): interleaved 21 times as fast as one by one.",
        studio.about(),
        study.most_vpls,
    );
    let mut section = Section::new("Ways to gather", about, WAY_COLUMNS);
    let of = |technique, gathering| AreaLighting { technique, gathering, ..base.clone() };
    let ways = [
        ("one by one", of(AreaTechnique::OneByOne, Gathering::Full)),
        ("marched maps", of(AreaTechnique::MarchedMaps, Gathering::Full)),
        ("all at once, full", of(AreaTechnique::Voxels, Gathering::Full)),
        ("all at once, 3 x 3 interleaved", of(AreaTechnique::Voxels, Gathering::Interleaved)),
        ("all at once, half width x half height", of(AreaTechnique::Voxels, Gathering::Half)),
        ("no shadows", of(AreaTechnique::None, Gathering::Full)),
    ];
    progress.count("ways to gather", ways.len() as u64, "ways");
    for (i, (name, how)) in ways.iter().enumerate() {
        let row = way_row(study, "ways", name, &studio.measure(how)?);
        section.rows.push(row);
        progress.set(i as u64 + 1, ways.len() as u64);
    }
    let slowest = number(&section.rows[0], "total_ms");
    for row in &mut section.rows {
        row.insert("ratio".to_owned(), (slowest / number(row, "total_ms").max(1e-6)).into());
    }
    Ok((section, None))
}

const INTERPOLATION_COLUMNS: &[Column<'_>] = &[
    ("name", "", Shown::Plain),
    ("gather_ms", "gather in fog, ms", Shown::Decimal),
    ("clear_ms", "in clear air, ms", Shown::Decimal),
    ("rmse", "error in fog", Shown::Decimal),
];

/// Interpolation as one would write it and by few instructions; airlight exactly and by the average.
fn interpolations(studio: &mut Studio, base: &AreaLighting, study: &Study, progress: &Progress) -> Result<Measure> {
    let about =
        format!("{}, {} VPLs, 128 samples along each axis, every pixel gathers all.", studio.about(), base.vpls);
    let mut section = Section::new("Interpolation, and airlight", about, INTERPOLATION_COLUMNS);
    let of = |interpolation, airlight| AreaLighting { interpolation, airlight, ..base.clone() };
    let ways = [
        ("nearest voxel", of(Interpolation::None, Airlight::Exact)),
        ("interpolated bit by bit", of(Interpolation::Plain, Airlight::Exact)),
        ("interpolated four bits at once", of(Interpolation::Fast, Airlight::Exact)),
        ("the same, average airlight", of(Interpolation::Fast, Airlight::Average)),
    ];
    progress.count("interpolation", ways.len() as u64, "ways");
    for (i, (name, how)) in ways.iter().enumerate() {
        let mut row = way_row(study, "interpolation", name, &studio.measure(how)?);
        row.insert("clear_ms".to_owned(), studio.clear_gather_ms(how)?.into());
        section.rows.push(row);
        progress.set(i as u64 + 1, ways.len() as u64);
    }
    Ok((section, None))
}

const RESOLUTION_COLUMNS: &[Column<'_>] = &[
    ("axis", "axis", Shown::Plain),
    ("samples", "samples", Shown::Count),
    ("shadows_ms", "shadows, ms", Shown::Decimal),
    ("gather_ms", "gather, ms", Shown::Decimal),
    ("total_ms", "sum, ms", Shown::Decimal),
    ("rmse", "error", Shown::Decimal),
];

/// Gives an axis another number of samples.
type Change = fn(VoxelResolution, u32) -> VoxelResolution;

/// Figures 6 and 8: cost and error over the resolution of all axes, and of each alone.
fn resolutions(studio: &mut Studio, base: &AreaLighting, study: &Study, progress: &Progress) -> Result<Measure> {
    let vpls = study.most_vpls.min(128);
    let about = format!(
        "{}, {vpls} VPLs. All axes together, then one alone with 128 samples of the others. The paper's, all axes at 32, 64, 128 and \
256 x 128: 19.5, 19.7, 26.8, 43.8 ms.",
        studio.about(),
    );
    let mut section = Section::new("Resolution", about, RESOLUTION_COLUMNS);
    let sides = [32, 64, 128, 256, 512].into_iter().filter(|side| *side <= study.most_voxels);
    let sides: Vec<u32> = sides.collect();
    let size = VoxelResolution::cube(128);
    let axes: [(&str, Change); 5] = [
        ("all", |_, side| VoxelResolution::cube(side)),
        ("map", |size, map| VoxelResolution { map, points: map * map / 2, ..size }),
        ("alpha", |size, alpha| VoxelResolution { alpha, ..size }),
        ("theta", |size, theta| VoxelResolution { theta, ..size }),
        ("phi", |size, phi| VoxelResolution { phi, ..size }),
    ];
    let all = (axes.len() * sides.len()) as u64;
    progress.count("resolutions", all, "resolutions");
    for (name, change) in axes {
        for side in &sides {
            let how = AreaLighting { vpls, voxels: change(size, *side), ..base.clone() };
            let mut row = way_row(study, "resolution", name, &studio.measure(&how)?);
            row.insert("axis".to_owned(), name.into());
            row.insert("samples".to_owned(), (*side).into());
            section.rows.push(row);
            progress.set(section.rows.len() as u64, all);
        }
    }
    let curve = |name: &'static str, color, key: &str| {
        let own = section.rows.iter().filter(|row| row["axis"] == name);
        let point = |row: &Row| (number(row, "samples"), number(row, key).max(1e-3));
        Curve { name, color, points: own.map(point).collect() }
    };
    let panel = |title: &str, key: &str, unit| {
        let colors = [("all", BLUE), ("map", ORANGE), ("alpha", AMBER), ("theta", GREY), ("phi", super::plot::GREEN)];
        let curves: Vec<Curve> = colors.map(|(name, color)| curve(name, color, key)).to_vec();
        let all: Vec<&Curve> = curves.iter().collect();
        let (x, y) = (across(&curves, "samples"), Axis::logarithmic(unit, &all));
        Panel { title: format!("{}: {title}", study.name), x, y, curves }
    };
    let panels = [panel("error over resolution", "rmse", "error, of 255"), panel("time", "total_ms", "ms")];
    let plot = Plot::new(file_name("ivsv", &study.name, "resolution"), &panels)?;
    Ok((section, Some(plot)))
}

/// All VPLs beside one shadow volume of full quality.
fn single(studio: &mut Studio, base: &AreaLighting, study: &Study, progress: &Progress) -> Result<Measure> {
    progress.stage("one shadow volume");
    let about = format!(
        "{}. One point of light with 512 samples along each axis, and {} of 128 samples that are gathered interleaved; the paper's \
256 take less than 4 times as long as one.",
        studio.about(),
        study.most_vpls,
    );
    let mut section = Section::new("One shadow volume of full quality", about, WAY_COLUMNS);
    let one = AreaLighting { vpls: 1, voxels: VoxelResolution::cube(512), ..base.clone() };
    let many = AreaLighting { gathering: Gathering::Interleaved, ..base.clone() };
    for (name, how) in [("1 VPL, 512 samples", one), ("all VPLs, 128 samples, interleaved", many)] {
        let row = way_row(study, "single", name, &studio.measure(&how)?);
        section.rows.push(row);
    }
    let first = number(&section.rows[0], "total_ms");
    for row in &mut section.rows {
        row.insert("ratio".to_owned(), (first / number(row, "total_ms").max(1e-6)).into());
    }
    Ok((section, None))
}
