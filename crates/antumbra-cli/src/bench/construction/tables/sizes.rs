//! Table 2: bytes by the rules for undefined regions.

use serde_json::json;

use super::{View, bytes, cell, row_at, times};
use crate::bench::construction::paper::{RESOLUTIONS, Size, TABLE_2};
use crate::bench::construction::plan::Technique;
use crate::bench::section::{Column, Row, Section, Shown, row};

const COLUMNS: &[Column<'_>] = &[
    ("scene", "scene", Shown::Plain),
    ("interior", "policy", Shown::Plain),
    ("resolution", "N", Shown::Plain),
    ("old", "2014", Shown::Megabytes),
    ("new", "2015", Shown::Megabytes),
    ("columns", "columns", Shown::Megabytes),
    ("old_over_new", "2014 / 2015", Shown::Decimal),
    ("new_over_columns", "2015 / columns", Shown::Decimal),
    ("old_over_columns", "2014 / columns", Shown::Decimal),
];

const ABOUT: &str = "Table 2 of the paper: millions of bytes of the light's nodes, by the methods' rules for what is undefined. Where nothing \
is (open), the rules have nothing to choose. The paper's rows are closed.";

pub fn section(view: &View<'_>) -> Section {
    let mut section = Section::new("Table 2: bytes", ABOUT, COLUMNS);
    for point in view.points() {
        let old = view.at(&point, Technique::Sintorn2014);
        let with_or_without = [Technique::Kampe2015, Technique::Kampe2015WithoutCulling];
        let new = with_or_without.into_iter().find_map(|technique| view.at(&point, technique));
        if old.is_none() && new.is_none() {
            continue;
        }
        let columns = view.at(&point, Technique::Columns);
        section.rows.push(row_at(
            &point,
            json!({
                "old": cell(old, bytes),
                "new": cell(new, bytes),
                "columns": cell(columns, bytes),
                "old_over_new": times(old, new, bytes),
                "new_over_columns": times(new, columns, bytes),
                "old_over_columns": times(old, columns, bytes),
            }),
        ));
    }
    if !section.rows.is_empty() {
        section.rows.extend(TABLE_2.iter().flat_map(paper_rows));
    }
    section
}

fn paper_rows(size: &'static Size) -> impl Iterator<Item = Row> {
    RESOLUTIONS.iter().enumerate().map(|(i, n)| {
        row(json!({
            "scene": format!("{} (2015)", size.scene),
            "interior": "closed",
            "resolution": n,
            "old": 1e6 * size.old[i],
            "new": 1e6 * size.new[i],
            "old_over_new": size.ratio[i],
        }))
    })
}
