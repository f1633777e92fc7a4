//! Every bake, and how it grows with the resolution.

use serde_json::json;

use super::{View, bytes, cell, peak_bytes, row_at, seconds, times};
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
    let figures = measurement.figures.as_ref().ok();
    let growth = |figure: fn(&Figures) -> Option<f64>| times(Some(measurement), before, figure);
    row_at(
        &measurement.combination,
        json!({
            "method": measurement.combination.technique.name(),
            "seconds": cell(Some(measurement), seconds),
            "seconds_growth": growth(seconds),
            "bytes": figures.map(|figures| figures.bytes),
            "bytes_growth": growth(bytes),
            "peak_bytes": figures.and_then(|figures| figures.peak_bytes),
            "peak_growth": growth(peak_bytes),
            "cpu_seconds": figures.and_then(|figures| figures.cpu_seconds),
            "wall_seconds": figures.map(|figures| figures.wall_seconds),
        }),
    )
}
