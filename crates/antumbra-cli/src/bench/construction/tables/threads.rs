//! Numbers of threads against each other.

use serde_json::json;

use super::{cell, is_same_place, row_at, seconds, times};
use crate::bench::construction::measure::Measurement;
use crate::bench::construction::plan::Technique;
use crate::bench::section::{Column, Section, Shown};

const COLUMNS: &[Column<'_>] = &[
    ("scene", "scene", Shown::Plain),
    ("interior", "policy", Shown::Plain),
    ("resolution", "N", Shown::Plain),
    ("threads", "threads", Shown::Plain),
    ("seconds", "construction", Shown::Seconds),
    ("faster", "times as fast", Shown::Decimal),
    ("peak_bytes", "peak memory", Shown::Bytes),
];

const ABOUT: &str = "Columns alone. Times as fast: as with the first number of threads. The bytes are the same.";

/// Of columns that were measured with each of these numbers of threads.
pub fn section(measured: &[Measurement<'_>], threads_list: &[usize]) -> Section {
    let mut section = Section::new("Threads", ABOUT, COLUMNS);
    let (Some(first), true) = (threads_list.first(), threads_list.len() > 1) else { return section };
    let of_columns = |m: &&Measurement<'_>| m.combination.technique == Technique::Columns;
    let columns: Vec<&Measurement<'_>> = measured.iter().filter(of_columns).collect();
    for base in columns.iter().filter(|m| m.combination.threads == *first) {
        for threads in threads_list {
            let (b, base) = (&base.combination, Some(*base));
            let this = columns.iter().copied().find(|m| {
                let c = &m.combination;
                is_same_place(c, b) && c.resolution == b.resolution && c.threads == *threads
            });
            section.rows.push(row_at(
                b,
                json!({
                    "threads": threads,
                    "seconds": cell(this, seconds),
                    "faster": times(base, this, seconds),
                    "peak_bytes": this.and_then(|m| m.figures.as_ref().ok()?.peak_bytes),
                }),
            ));
        }
    }
    section
}
