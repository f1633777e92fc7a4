//! Table 4: the whole construction.

use serde_json::json;

use super::stages::{FIRST_COLUMNS, with_resolutions};
use super::{View, cell, resolution_key, seconds};
use crate::args::interior_argument;
use crate::bench::construction::paper::{RESOLUTIONS, TABLE_4, time};
use crate::bench::section::{Section, row};

const ABOUT: &str = "Table 4 of the paper: the whole construction. The paper's rows are with culling, and its last is of Sintorn et al. 2014.";

pub fn section(view: &View<'_>) -> Section {
    let mut section = with_resolutions("Table 4: the whole construction", ABOUT, &FIRST_COLUMNS, view, &RESOLUTIONS);
    for series in view.series() {
        let interior = interior_argument(series.interior);
        let mut row =
            row(json!({ "scene": series.subject.name, "interior": interior, "method": series.technique.name() }));
        let value = |n: u32, value| (resolution_key(n), value);
        row.extend(view.of_series(&series).map(|m| value(m.combination.resolution.texels(), cell(Some(m), seconds))));
        section.rows.push(row);
    }
    for (scene, interior, method, seconds) in TABLE_4 {
        let mut row = row(json!({ "scene": scene, "interior": interior, "method": method }));
        row.extend(RESOLUTIONS.iter().zip(seconds).map(|(n, seconds)| (resolution_key(*n), seconds.map(time).into())));
        section.rows.push(row);
    }
    section
}
