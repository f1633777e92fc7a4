//! Light space against world space (Sintorn et al. 2014).

use antumbra::Interior;
use antumbra_bake::ablation::undefined::Sintorn2014;
use antumbra_bake::ablation::world::{WorldGrid, WorldVolume};
use antumbra_bake::ablation::{Graph, Intervals, octree};
use antumbra_bake::light_space::Resolution;
use antumbra_scene::Light;
use anyhow::{Context, Result};
use serde_json::json;

use super::{INTERIORS, Subject, Wish, baked, shadows};
use crate::bench::ratio;
use crate::bench::section::{Column, Row, Section, Shown, row};

const COLUMNS: &[Column<'_>] = &[
    ("scene", "scene", Shown::Plain),
    ("interior", "policy", Shown::Plain),
    ("resolution", "N", Shown::Plain),
    ("world_bytes", "world space", Shown::Bytes),
    ("light_bytes", "light space", Shown::Bytes),
    ("bytes_ratio", "ratio", Shown::Decimal),
    ("world_nodes", "nodes, world", Shown::Count),
    ("light_nodes", "nodes, light", Shown::Count),
    ("columns_bytes", "light space, columns", Shown::Bytes),
];

const ABOUT: &str = "The same visibility as an octree over a cube along the world's axes and over the light's own grid, N \
voxels per side each, built by the same code with the same nodes and by the rule of 2014 for what is undefined. A world voxel \
is what the light's voxel at its middle is, at 2N. A cube of world voxels is not looked into where the box that it spans in \
light space may be homogeneous. The last column is what the baker makes of the light's grid. Sintorn et al. 2014 give no \
figures for it in the talk, but the reason: in light space nodes repeat along the light.";

/// Largest resolution, unless less is wished for.
const LARGEST: u32 = 1024;

pub fn section() -> Section {
    Section::new("Light space and world space", ABOUT, COLUMNS)
}

pub fn rows(subject: &Subject, sun: &Light, wish: &Wish) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    for interior in INTERIORS {
        for resolution in wish.resolutions(64, LARGEST) {
            rows.push(measured(subject, sun, interior, resolution)?);
        }
    }
    Ok(rows)
}

fn measured(subject: &Subject, sun: &Light, interior: Interior, resolution: Resolution) -> Result<Row> {
    let twice = Resolution::new(2 * resolution.texels()).context("there is no finer resolution")?;
    let suns = std::slice::from_ref(sun);
    let source = baked(&subject.scene, suns, interior, twice)?;
    let file = shadows(&source)?;
    let light = file.lights().next().context("the bake has no light")?;
    let grid = WorldGrid::about(subject.scene.bounds(|node| !node.dynamic), resolution.log2());
    let volume = WorldVolume { grid, light, intervals: &intervals(subject, sun, interior, twice)? };
    let world = octree::build(&volume, grid.log2)?;
    let intervals = intervals(subject, sun, interior, resolution)?;
    let in_light = octree::build(&Sintorn2014 { intervals: &intervals }, resolution.log2())?;
    let columns = baked(&subject.scene, suns, interior, resolution)?;
    Ok(row(json!({
        "scene": subject.name,
        "ablation": "space",
        "light": sun.name,
        "interior": interior.name(),
        "resolution": resolution.texels(),
        "source_resolution": twice.texels(),
        "world_voxel_m": grid.voxel_m,
        "world_bytes": world.bytes(),
        "light_bytes": in_light.bytes(),
        "bytes_ratio": ratio(world.bytes(), in_light.bytes()),
        "world_nodes": nodes(&world),
        "light_nodes": nodes(&in_light),
        "columns_bytes": columns.lights[0].bytes,
    })))
}

fn intervals(subject: &Subject, sun: &Light, interior: Interior, resolution: Resolution) -> Result<Intervals> {
    let faces = Intervals::of_light(&subject.scene, sun, resolution, interior)?;
    faces.into_iter().next().context("the light has no face")
}

fn nodes(graph: &Graph) -> u64 {
    let counts = graph.nodes();
    counts.inner + counts.slices + counts.masks
}
