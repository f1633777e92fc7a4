//! Undefined regions by the rules of 2014 and of 2015 (Kämpe et al. 2015, sections 3.3 and 3.4).

use antumbra::Interior;
use antumbra_bake::ablation::undefined::{Kampe2015, Sintorn2014};
use antumbra_bake::ablation::{Graph, Intervals, octree};
use antumbra_scene::Light;
use anyhow::{Context, Result, ensure};
use serde_json::json;

use super::{Subject, Wish, baked};
use crate::bench::ratio;
use crate::bench::section::{Column, Row, Section, Shown, row};

const COLUMNS: &[Column<'_>] = &[
    ("scene", "scene", Shown::Plain),
    ("resolution", "N", Shown::Plain),
    ("old_bytes", "2014", Shown::Bytes),
    ("new_bytes", "2015", Shown::Bytes),
    ("columns_bytes", "columns (ours)", Shown::Bytes),
    ("old_over_new", "2014 / 2015", Shown::Decimal),
    ("new_over_columns", "2015 / columns", Shown::Decimal),
    ("old_masks", "masks, 2014", Shown::Count),
    ("new_masks", "2015", Shown::Count),
    ("columns_masks", "columns", Shown::Count),
];

const ABOUT: &str = "From the exact enter and exit slices of every texel (the inside of solids is undefined), three ways, in the same \
encoding. 2014: top down; a node without voxels that must be lit is shadowed, one without voxels that must be shadowed is lit, \
so too an 8 x 8 mask; what is undefined in any other mask is shadowed. 2015: each 8 x 8 tile first gets the fewest masks, by \
stabbing at the closest exit. Columns: what the baker makes, which stabs likewise, but first narrows the intervals of lit surfaces so that \
they need no bias. The first two graphs were held against the \
intervals at every voxel. Kämpe et al. 2015, table 2, 2014 / 2015: Closed City 1.43 at 4K, 1.49, 1.58, 1.67, 1.78, 1.90, 2.08 at 256K; \
Fractal Landscape 1.72 at 4K, 1.90, 2.08, 2.29, 2.49, 2.70, 3.00 at 256K.";

const LARGEST: u32 = 4096;

pub fn section() -> Section {
    Section::new("Undefined regions, the old way and the new", ABOUT, COLUMNS)
}

pub fn rows(subject: &Subject, sun: &Light, wish: &Wish) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    for resolution in wish.resolutions(256, LARGEST) {
        let faces = Intervals::of_light(&subject.scene, sun, resolution, Interior::Auto)?;
        let intervals = faces.into_iter().next().context("the light has no face")?;
        let old = checked(octree::build(&Sintorn2014 { intervals: &intervals }, resolution.log2())?, &intervals)?;
        let new = checked(octree::build(&Kampe2015::new(&intervals), resolution.log2())?, &intervals)?;
        let columns = baked(&subject.scene, std::slice::from_ref(sun), Interior::Auto, resolution)?;
        let ours = &columns.lights[0];
        rows.push(row(json!({
            "scene": subject.name,
            "ablation": "undefined",
            "light": sun.name,
            "resolution": resolution.texels(),
            "old_bytes": old.bytes(),
            "new_bytes": new.bytes(),
            "columns_bytes": ours.bytes,
            "old_over_new": ratio(old.bytes(), new.bytes()),
            "new_over_columns": ratio(new.bytes(), ours.bytes),
            "old_masks": old.nodes().masks,
            "new_masks": new.nodes().masks,
            "columns_masks": ours.nodes.masks,
        })));
    }
    Ok(rows)
}

fn checked(graph: Graph, intervals: &Intervals) -> Result<Graph> {
    ensure!(intervals.allow(&graph), "a rule broke an interval: please report it");
    Ok(graph)
}
