//! The papers' methods against the columns.

use serde_json::json;

use super::{View, bytes, peak_bytes, row_at, seconds, times};
use crate::bench::construction::measure::{Figures, Measurement};
use crate::bench::construction::plan::Technique;
use crate::bench::section::{Column, Row, Section, Shown};

const COLUMNS: &[Column<'_>] = &[
    ("scene", "scene", Shown::Plain),
    ("interior", "policy", Shown::Plain),
    ("resolution", "N", Shown::Plain),
    ("method", "method", Shown::Plain),
    ("seconds", "seconds", Shown::Decimal),
    ("cpu_seconds", "CPU seconds", Shown::Decimal),
    ("peak_bytes", "peak memory", Shown::Decimal),
    ("bytes", "bytes", Shown::Decimal),
];

const ABOUT: &str = "How many times what the columns take each of the papers' methods takes, measured in this one run. CPU seconds and peak \
memory are the whole process's, with reading the scene, which is the same for all.";

pub fn section(view: &View<'_>) -> Section {
    let mut section = Section::new("The papers' methods against the columns", ABOUT, COLUMNS);
    for other in view.all().filter(|m| m.combination.technique != Technique::Columns && m.figures.is_ok()) {
        section.rows.extend(view.at(&other.combination, Technique::Columns).map(|columns| against(other, columns)));
    }
    section
}

fn against(other: &Measurement<'_>, columns: &Measurement<'_>) -> Row {
    let times = |figure: fn(&Figures) -> Option<f64>| times(Some(other), Some(columns), figure);
    row_at(
        &other.combination,
        json!({
            "method": other.combination.technique.name(),
            "seconds": times(seconds),
            "cpu_seconds": times(|figures| figures.cpu_seconds),
            "peak_bytes": times(peak_bytes),
            "bytes": times(bytes),
        }),
    )
}
