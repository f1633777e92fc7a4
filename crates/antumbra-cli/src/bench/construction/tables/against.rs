//! The papers' methods against the columns.

use serde_json::json;

use super::{View, bytes, row_at, seconds, times};
use crate::bench::construction::plan::Technique;
use crate::bench::section::{Column, Section, Shown};

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
        let Some(columns) = view.at(&other.combination, Technique::Columns) else { continue };
        let (other, columns) = (Some(other), Some(columns));
        section.rows.extend(other.map(|measurement| {
            row_at(
                &measurement.combination,
                json!({
                    "method": measurement.combination.technique.name(),
                    "seconds": times(other, columns, seconds),
                    "cpu_seconds": times(other, columns, |figures| figures.cpu_seconds),
                    "peak_bytes": times(other, columns, |figures| figures.peak_bytes.map(|bytes| bytes as f64)),
                    "bytes": times(other, columns, bytes),
                }),
            )
        }));
    }
    section
}
