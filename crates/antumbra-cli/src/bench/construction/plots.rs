//! Seconds, peak memory and bytes over resolution: a file per scene and figure, a panel per policy.

use anyhow::Result;

use super::Wish;
use super::measure::{Figures, Measurement};
use super::plan::Technique;
use crate::args::interior_argument;
use crate::bench::plot::{AMBER, Axis, BLUE, Curve, GREY, ORANGE, Panel, Plot, file_name};

/// What is drawn: its file's name, its title, its value and its axis.
struct Figure {
    name: &'static str,
    title: &'static str,
    value: fn(&Figures) -> Option<f64>,
    axis: fn(&[&Curve]) -> Axis,
    /// Whether culling identical nodes changes it.
    culling_matters: bool,
}

const FIGURES: [Figure; 3] = [
    Figure {
        name: "seconds",
        title: "construction",
        value: |figures| Some(figures.seconds),
        axis: |curves| Axis::logarithmic("seconds", curves),
        culling_matters: true,
    },
    Figure {
        name: "memory",
        title: "peak memory",
        value: |figures| figures.peak_bytes.map(|bytes| bytes as f64),
        axis: |curves| Axis::bytes("peak memory of the process", curves),
        culling_matters: true,
    },
    Figure {
        name: "bytes",
        title: "bytes",
        value: |figures| Some(figures.bytes as f64),
        axis: |curves| Axis::bytes("bytes of nodes", curves),
        culling_matters: false,
    },
];

/// Three for each scene.
pub fn plots(measured: &[Measurement<'_>], wish: &Wish) -> Result<Vec<Plot>> {
    let mut scenes: Vec<&str> = measured.iter().map(|m| m.combination.subject.name.as_str()).collect();
    scenes.dedup();
    let mut plots = Vec::new();
    for scene in scenes {
        let of_scene =
            |m: &&Measurement<'_>| m.combination.subject.name == scene && m.combination.threads == wish.threads;
        let of_scene: Vec<&Measurement<'_>> = measured.iter().filter(of_scene).collect();
        for figure in &FIGURES {
            let name = file_name("construction", scene, figure.name);
            plots.push(Plot::new(name, &panels(scene, &of_scene, wish, figure))?);
        }
    }
    Ok(plots)
}

/// One per policy, all over the same axes.
fn panels(scene: &str, measured: &[&Measurement<'_>], wish: &Wish, figure: &Figure) -> Vec<Panel> {
    let curves: Vec<Vec<Curve>> = wish.interiors.iter().map(|i| curves(measured, *i, wish, figure)).collect();
    let all: Vec<&Curve> = curves.iter().flatten().collect();
    let (x, y) = (Axis::resolutions(&all), (figure.axis)(&all));
    let panel = |(interior, curves)| Panel {
        title: format!("{scene}, {}: {}", interior_argument(interior), figure.title),
        curves,
        x: x.clone(),
        y: y.clone(),
    };
    wish.interiors.iter().copied().zip(curves).map(panel).collect()
}

/// One per technique that has a point.
fn curves(measured: &[&Measurement<'_>], interior: antumbra::Interior, wish: &Wish, figure: &Figure) -> Vec<Curve> {
    let curve = |technique: &Technique| {
        let of_curve =
            |m: &&&Measurement<'_>| m.combination.interior == interior && m.combination.technique == *technique;
        let point = |m: &&Measurement<'_>| {
            let value = (figure.value)(m.figures.as_ref().ok()?)?;
            Some((f64::from(m.combination.resolution.texels()), value))
        };
        let points = measured.iter().filter(of_curve).filter_map(point).collect();
        Curve { name: technique.name(), color: color(*technique), points }
    };
    let is_repetition = |technique: &&Technique| {
        let with_culling = wish.techniques.contains(&Technique::Kampe2015);
        with_culling && !figure.culling_matters && **technique == Technique::Kampe2015WithoutCulling
    };
    let techniques = wish.techniques.iter().filter(|technique| !is_repetition(technique));
    techniques.map(curve).filter(|curve| !curve.points.is_empty()).collect()
}

fn color(technique: Technique) -> plotters::style::RGBColor {
    match technique {
        Technique::Columns => BLUE,
        Technique::Kampe2015 => ORANGE,
        Technique::Kampe2015WithoutCulling => AMBER,
        Technique::Sintorn2014 => GREY,
    }
}
