//! Every bake, and how it grows with the resolution.

use serde_json::json;

use super::{View, bytes, cell, row_at, seconds, times};
use crate::bench::construction::measure::{Figures, Measurement};
use crate::bench::section::{Column, Row, Section, Shown};

const COLUMNS: &[Column<'_>] = &[
    ("scene", "scene", Shown::Plain),
    ("interior", "policy", Shown::Plain),
    ("method", "method", Shown::Plain),
    ("resolution", "N", Shown::Plain),
    ("seconds", "construction", Shown::Seconds),
    ("seconds_growth", "growth", Shown::Decimal),
    ("bytes", "bytes", Shown::Bytes),
    ("bytes_growth", "growth", Shown::Decimal),
    ("peak_bytes", "peak memory", Shown::Bytes),
    ("peak_growth", "growth", Shown::Decimal),
    ("cpu_seconds", "CPU", Shown::Seconds),
    ("wall_seconds", "with files", Shown::Seconds),
];

const ABOUT: &str = "Every bake, each a process of its own. Growth: at N over at N / 2; 4 is an area's, 2 a silhouette's. Peak memory is the \
process's by the system's own accounting, CPU is all its threads', and with files is the wall time of all of `antumbra bake`, which reads \
the scene and writes the shadows.";

pub fn section(view: &View<'_>) -> Section {
    let mut section = Section::new("Growth per doubling, and memory", ABOUT, COLUMNS);
    for series in view.series() {
        let mut before: Option<&Measurement<'_>> = None;
        for measurement in view.of_series(&series) {
            section.rows.push(measured(measurement, before));
            before = Some(measurement);
        }
    }
    section
}

fn measured(measurement: &Measurement<'_>, before: Option<&Measurement<'_>>) -> Row {
    let this = Some(measurement);
    let peak = |figures: &Figures| figures.peak_bytes.map(|bytes| bytes as f64);
    let whole_bytes = |figure: fn(&Figures) -> Option<u64>| match measurement.figures.as_ref() {
        Ok(figures) => figure(figures).into(),
        Err(_) => serde_json::Value::Null,
    };
    row_at(
        &measurement.combination,
        json!({
            "method": measurement.combination.technique.name(),
            "seconds": cell(this, seconds),
            "seconds_growth": times(this, before, seconds),
            "bytes": whole_bytes(|figures| Some(figures.bytes)),
            "bytes_growth": times(this, before, bytes),
            "peak_bytes": whole_bytes(|figures| figures.peak_bytes),
            "peak_growth": times(this, before, peak),
            "cpu_seconds": measurement.figures.as_ref().ok().and_then(|figures| figures.cpu_seconds),
            "wall_seconds": measurement.figures.as_ref().ok().map(|figures| figures.wall_seconds),
        }),
    )
}
