//! Table 3: wall time by stage.

use serde_json::{Value, json};

use super::{OUT_OF_MEMORY, View, resolution_key};
use crate::args::interior_argument;
use crate::bench::construction::measure::{Figures, Measurement};
use crate::bench::construction::paper::{TABLE_3, TABLE_3_RESOLUTIONS, WHOLE, time};
use crate::bench::construction::plan::Combination;
use crate::bench::section::{Column, Row, Section, Shown, row};

const ABOUT: &str = "Table 3 of the paper: wall time by stage; of work that threads do side by side, their sum over the number of threads. The \
paper's rows are with culling.";

/// Columns before those of resolutions.
pub const FIRST_COLUMNS: [Column<'_>; 3] =
    [("scene", "scene", Shown::Plain), ("interior", "policy", Shown::Plain), ("method", "method", Shown::Plain)];

/// The given columns, and one of seconds per resolution.
pub fn with_resolutions(
    title: &'static str,
    about: &'static str,
    first: &[Column<'_>],
    view: &View<'_>,
    further: &[u32],
) -> Section {
    let mut resolutions: Vec<u32> = view.all().map(|m| m.combination.resolution.texels()).collect();
    resolutions.extend(further);
    resolutions.sort_unstable();
    resolutions.dedup();
    let keys: Vec<String> = resolutions.into_iter().map(resolution_key).collect();
    let mut columns = first.to_vec();
    columns.extend(keys.iter().map(|key| (key.as_str(), key.as_str(), Shown::Seconds)));
    Section::new(title, about, &columns)
}

pub fn section(view: &View<'_>) -> Section {
    let mut first = FIRST_COLUMNS.to_vec();
    first.push(("stage", "stage", Shown::Plain));
    let mut section = with_resolutions("Table 3: stages", ABOUT, &first, view, &TABLE_3_RESOLUTIONS);
    section.rows = view.series().iter().flat_map(|series| rows(view, series)).collect();
    section.rows.extend(TABLE_3.iter().map(|(interior, stage, seconds)| {
        let mut row = first_cells("Closed City (2015)", interior, "2015", stage);
        row.extend(TABLE_3_RESOLUTIONS.iter().zip(seconds).map(|(n, s)| (resolution_key(*n), time(*s).into())));
        row
    }));
    section
}

fn first_cells(scene: &str, interior: &str, method: &str, stage: &str) -> Row {
    row(json!({ "scene": scene, "interior": interior, "method": method, "stage": stage }))
}

fn rows<'a>(view: &View<'a>, series: &Combination<'a>) -> Vec<Row> {
    let measured: Vec<&Measurement<'_>> = view.of_series(series).collect();
    let mut stages = vec![WHOLE];
    let figures = measured.iter().filter_map(|m| m.figures.as_ref().ok());
    for (name, _) in figures.flat_map(|figures| &figures.stages) {
        if !stages.contains(&name.as_str()) {
            stages.push(name);
        }
    }
    let row = |stage: &str| {
        let (scene, interior) = (&series.subject.name, interior_argument(series.interior));
        let mut row = first_cells(scene, &interior, series.technique.name(), stage);
        row.extend(measured.iter().map(|m| (resolution_key(m.combination.resolution.texels()), seconds(m, stage))));
        row
    };
    stages.into_iter().map(row).collect()
}

fn seconds(measurement: &Measurement<'_>, stage: &str) -> Value {
    let of_stage = |figures: &Figures| {
        if stage == WHOLE {
            return Some(figures.seconds);
        }
        // A stage that several lights have is told once per light.
        let of_lights: Vec<f64> = figures.stages.iter().filter(|(name, _)| name == stage).map(|(_, s)| *s).collect();
        if of_lights.is_empty() { None } else { Some(of_lights.iter().sum()) }
    };
    match &measurement.figures {
        Ok(figures) => of_stage(figures).into(),
        Err(_) if stage == WHOLE => OUT_OF_MEMORY.into(),
        Err(_) => Value::Null,
    }
}
