//! Table 1: with and without culling identical nodes.

use serde_json::json;

use super::{View, cell, row_at, seconds, times};
use crate::bench::construction::measure::Figures;
use crate::bench::construction::paper::{Culling, RESOLUTIONS, TABLE_1, time};
use crate::bench::construction::plan::Technique;
use crate::bench::section::{Column, Row, Section, Shown, row};

const COLUMNS: &[Column<'_>] = &[
    ("scene", "scene", Shown::Plain),
    ("interior", "policy", Shown::Plain),
    ("resolution", "N", Shown::Plain),
    ("without", "2015, no culling", Shown::Seconds),
    ("without_part", "insert/merge", Shown::Seconds),
    ("with", "2015", Shown::Seconds),
    ("with_part", "insert/merge", Shown::Seconds),
    ("saved", "no culling / culling", Shown::Decimal),
    ("columns", "columns", Shown::Seconds),
    ("columns_part", "building columns", Shown::Seconds),
];

const ABOUT: &str = "Table 1 of Kämpe et al. 2015: how long the construction takes with and without culling identical nodes, and \
what of it inserting and merging nodes take. Ours is the wall time of all stages, from the scene in memory to the file's bytes in memory, on \
the CPU alone; theirs (the last rows) makes depth maps and masks on a GTX Titan and nodes on an i5 2500K.";

pub fn section(view: &View<'_>) -> Section {
    let mut section = Section::new("Table 1: culling identical nodes", ABOUT, COLUMNS);
    for point in view.points() {
        let [without, with] = [Technique::Kampe2015WithoutCulling, Technique::Kampe2015].map(|t| view.at(&point, t));
        if without.is_none() && with.is_none() {
            continue;
        }
        let columns = view.at(&point, Technique::Columns);
        let part = |technique: Technique| move |figures: &Figures| figures.insert_merge_seconds(technique);
        section.rows.push(row_at(
            &point,
            json!({
                "without": cell(without, seconds),
                "without_part": cell(without, part(Technique::Kampe2015)),
                "with": cell(with, seconds),
                "with_part": cell(with, part(Technique::Kampe2015)),
                "saved": times(without, with, seconds),
                "columns": cell(columns, seconds),
                "columns_part": cell(columns, part(Technique::Columns)),
            }),
        ));
    }
    if !section.rows.is_empty() {
        section.rows.extend(paper_rows("open").chain(paper_rows("closed")));
    }
    section
}

fn paper_rows(interior: &'static str) -> impl Iterator<Item = Row> {
    let of = move |culling| TABLE_1.iter().find(move |row| row.interior == interior && row.culling == culling);
    let (without, with) = (of(false), of(true));
    let total = |culling: Option<&Culling>, i: usize| culling.map(|row| row.total[i]);
    let part = |culling: Option<&Culling>, i: usize| culling.map(|row| row.insert_merge[i]);
    RESOLUTIONS.iter().enumerate().map(move |(i, n)| {
        row(json!({
            "scene": "Closed City (2015)",
            "interior": interior,
            "resolution": n,
            "without": total(without, i).map(time),
            "without_part": part(without, i).map(time),
            "with": total(with, i).map(time),
            "with_part": part(with, i).map(time),
            "saved": total(without, i).zip(total(with, i)).map(|(without, with)| without / with),
        }))
    })
}
