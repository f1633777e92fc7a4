//! The papers' own pipelines, to measure ours against: [`Method::Sintorn2014`] and [`Method::Kampe2015`].
//!
//! Both start from depth maps, made tile by tile on the CPU ([`raster`]) with the care that our own builder gets: all threads,
//! vector code, work in proportion to what is in sight. Both then build top-down ([`topdown`]) and merge equal nodes by
//! sorting ([`graph`]). They know open and closed geometry; policies that look behind first surfaces came later.
//!
//! ```text
//! triangles -> bins -> enter (and exit) depths of 8192 x 8192 texels        per map tile
//!                   -> masks, min-max hierarchy                             Kampe2015 (Sintorn2014: hierarchy)
//!                   -> columns of cubes, side by side -> nodes -> merged    squares of the map tile
//! all squares' nodes -> upper levels -> merged -> the tables that all lights of a file share
//! ```

mod graph;
mod kampe2015;
mod pyramid;
mod raster;
mod sintorn2014;
mod topdown;

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use rayon::prelude::*;

use crate::bake::{Method, Stage, Stopwatch};
use crate::columns::{Build, BuildError};
use crate::dag::Id;
use graph::{Graph, Reference};
use kampe2015::{Kampe2015, Masks};
use raster::{Bins, DepthMaps, MapTile};
use sintorn2014::Sintorn2014;
use topdown::{Limit, TopDown, Voxels, upper_levels};

/// log2 of a map tile's texels per side: 2015, section 3, has tiles of 8K x 8K.
const MAP_LOG2: u32 = 13;
/// log2 of the texels per side of squares that threads build side by side.
const SQUARE_LOG2: u32 = 10;
/// Squares per side of the light, as a power of two, at most: the levels above them are complete.
const MOST_SQUARES_LOG2: u32 = 6;

/// What a method is asked to do.
#[derive(Clone, Copy)]
pub(crate) struct Request<'a> {
    pub build: &'a Build<'a>,
    pub method: Method,
    /// See [`crate::BakeOptions::cull_identical`].
    pub cull_identical: bool,
    /// Whether any triangle bounds a solid.
    pub has_solids: bool,
}

impl<'a> Request<'a> {
    pub fn new(build: &'a Build<'a>, method: Method, cull_identical: bool) -> Self {
        let has_solids = build.triangles.iter().any(|t| t.winding() != 0);
        Self { build, method, cull_identical, has_solids }
    }
}

/// Constructs a face's graph; its root in the build's tables, and the time by stages.
///
/// # Errors
/// [`BuildError`]; memory is judged by an estimate before it is taken, and while nodes are inserted.
pub(crate) fn build(request: Request<'_>) -> Result<(Id, Vec<Stage>), BuildError> {
    let log2 = request.build.resolution().log2();
    let map_log2 = MAP_LOG2.min(log2);
    let square_log2 = SQUARE_LOG2.max(log2.saturating_sub(MOST_SQUARES_LOG2)).min(map_log2);
    let mut clock = Stopwatch::start();
    let mut graph = Graph::new(log2);
    let squares_per_side = 1usize << (log2 - square_log2);
    let mut roots: Vec<Vec<Reference>> = vec![Vec::new(); squares_per_side * squares_per_side];
    let maps = 1u32 << (log2 - map_log2);
    for (x, y) in (0..maps * maps).map(|i| (i % maps, i / maps)) {
        let tile = MapTile { x: x << map_log2, y: y << map_log2, side: 1 << map_log2 };
        map_tile(request, tile, square_log2, &mut graph, &mut roots, &mut clock)?;
        (request.build.progress)(f64::from(y * maps + x + 1) / f64::from(maps * maps));
    }
    let mut root = [upper_levels(&mut graph, &roots, square_log2)];
    clock.lap("inserting nodes");
    // Merging sorts a copy of one level's nodes with their places; handing over makes them a second time.
    let tables = request.build.tables;
    if tables.bytes() + 5 * (graph.bytes() / 2) > request.build.memory_limit {
        return Err(BuildError::MemoryLimit);
    }
    graph.merge(&mut root, log2);
    clock.lap("merging nodes");
    let root = graph.hand_over(tables, root[0], log2);
    clock.lap("handing over");
    if tables.are_full() { Err(BuildError::TooManyNodes) } else { Ok((root, clock.stages)) }
}

/// Adds a map tile's squares to the graph.
fn map_tile(
    request: Request<'_>,
    tile: MapTile,
    square_log2: u32,
    graph: &mut Graph,
    roots: &mut [Vec<Reference>],
    clock: &mut Stopwatch,
) -> Result<(), BuildError> {
    let Request { build, has_solids, .. } = request;
    let limit = build.memory_limit.saturating_sub(graph.bytes() + build.tables.bytes());
    let maps_bytes = DepthMaps::bytes(tile.side, has_solids);
    let left = limit.checked_sub(maps_bytes).ok_or(BuildError::MemoryLimit)?;
    let bins = Bins::new(build, tile, left).ok_or(BuildError::MemoryLimit)?;
    let mut maps = DepthMaps::draw_enter(build, tile, &bins);
    let is_2014 = request.method == Method::Sintorn2014;
    clock.lap(if is_2014 { "depth map" } else { "enter depth map" });
    if has_solids {
        maps.peel_exit(build, &bins);
        clock.lap(if is_2014 { "depth map" } else { "exit depth map" });
    }
    drop(bins);
    let slices = build.resolution().texels();
    if is_2014 {
        let voxels = Sintorn2014::new(maps);
        clock.lap("min-max");
        return squares(request, &voxels, tile, square_log2, left, graph, roots, clock);
    }
    let masks = Masks::new(&maps, slices, left).ok_or(BuildError::MemoryLimit)?;
    clock.lap("visibility masks");
    let voxels = Kampe2015::new(masks, maps.pyramid());
    drop(maps);
    clock.lap("min-max");
    let left = (left + maps_bytes).checked_sub(voxels.bytes()).ok_or(BuildError::MemoryLimit)?;
    squares(request, &voxels, tile, square_log2, left, graph, roots, clock)
}

/// Builds a map tile's squares side by side, merges each one's nodes, and adds them.
fn squares(
    request: Request<'_>,
    voxels: &impl Voxels,
    tile: MapTile,
    square_log2: u32,
    limit: u64,
    graph: &mut Graph,
    roots: &mut [Vec<Reference>],
    clock: &mut Stopwatch,
) -> Result<(), BuildError> {
    let build = request.build;
    let culls = request.method == Method::Kampe2015 && request.cull_identical;
    let slices = build.resolution().texels();
    let limit = Limit { bytes: limit, taken: AtomicU64::new(0), reached: AtomicBool::new(false), pause: build.pause };
    let side = tile.side >> square_log2;
    let built: Vec<(Graph, Vec<Reference>)> = (0..side * side)
        .into_par_iter()
        .map(|i| TopDown::column(voxels, &limit, culls, [i % side, i / side], square_log2, slices))
        .collect();
    clock.lap("inserting nodes");
    if limit.reached.load(Ordering::Relaxed) {
        return Err(if (build.pause)() { BuildError::MemoryLimit } else { BuildError::Cancelled });
    }
    let merged: Vec<(Graph, Vec<Reference>)> = built
        .into_par_iter()
        .map(|(mut graph, mut roots)| {
            graph.merge(&mut roots, square_log2);
            (graph, roots)
        })
        .collect();
    let per_side = slices >> square_log2;
    for (i, (square, mut cubes)) in (0..).zip(merged) {
        let (x, y) = ((tile.x >> square_log2) + i % side, (tile.y >> square_log2) + i / side);
        graph.append(square, &mut cubes, square_log2);
        roots[(y * per_side + x) as usize] = cubes;
    }
    clock.lap("merging nodes");
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::pause::never_pause;

    const LOG2: u32 = 6;
    const SIDE: u32 = 1 << LOG2;

    /// Depths that jump, slope, repeat, lie at both ends or behind the last slice.
    fn depths(seed: u32) -> Vec<u32> {
        let random = |i: u32| (i ^ seed).wrapping_mul(0x9e37_79b9).rotate_left(15).wrapping_mul(0x85eb_ca6b) >> 8;
        let depth = |x: u32, y: u32| match random((x / 8) + 64 * (y / 16)) % 5 {
            0 => random(x + SIDE * y) % (SIDE + 4),
            1 => (x + y) / 2 % SIDE,
            2 => random(x / 8) % SIDE,
            3 => [0, SIDE, u32::MAX][(random(y / 8) % 3) as usize],
            _ => 8 * (x / 3 % 8),
        };
        (0..SIDE * SIDE).map(|i| depth(i % SIDE, i / SIDE)).collect()
    }

    /// The distinct mixed cubes of each size, voxel by voxel.
    fn cubes(depths: &[u32]) -> Vec<usize> {
        let voxel = |x: u32, y: u32, z: u32| z < depths[(y * SIDE + x) as usize];
        let distinct = |level: u32| {
            let (side, count) = (1u32 << level, SIDE >> level);
            let starts = (0..count * count * count).map(|i| [i % count, i / count % count, i / (count * count)]);
            let cube = |[x, y, z]: [u32; 3]| -> Vec<bool> {
                let voxels = (0..side * side * side).map(|i| [i % side, i / side % side, i / (side * side)]);
                voxels.map(|[dx, dy, dz]| voxel(x * side + dx, y * side + dy, z * side + dz)).collect()
            };
            let mixed = |cube: &Vec<bool>| cube.iter().any(|v| *v != cube[0]);
            starts.map(cube).filter(mixed).collect::<BTreeSet<_>>().len()
        };
        (3..=LOG2).map(distinct).collect()
    }

    #[test]
    fn the_same_depths_give_the_same_nodes() {
        for seed in 0..6 {
            let depths = depths(seed);
            let block = |i: u32| {
                let texel = |j: usize| ((i / 8 * 8 + j as u32 / 8) * SIDE + i % 8 * 8 + j as u32 % 8) as usize;
                core::array::from_fn(|j| depths[texel(j)])
            };
            let maps = || DepthMaps { enter: (0..64).map(block).collect(), exit: None, log2_blocks: 3 };
            let expected = cubes(&depths);
            let kampe = Kampe2015::new(Masks::new(&maps(), SIDE, u64::MAX).expect("no limit"), maps().pyramid());
            assert_eq!(counts(&kampe, true), expected, "culled, seed {seed}");
            assert_eq!(counts(&kampe, false), expected, "not culled, seed {seed}");
            assert_eq!(counts(&Sintorn2014::new(maps()), false), expected, "2014, seed {seed}");
        }
    }

    /// Nodes by level, built in squares of 16 texels.
    fn counts(voxels: &impl Voxels, culls: bool) -> Vec<usize> {
        let (reached, taken) = (AtomicBool::new(false), AtomicU64::new(0));
        let limit = Limit { bytes: u64::MAX, taken, reached, pause: &never_pause };
        let (mut graph, mut roots) = (Graph::new(LOG2), Vec::new());
        for i in 0..16 {
            let (square, mut cubes) = TopDown::column(voxels, &limit, culls, [i % 4, i / 4], 4, SIDE);
            graph.append(square, &mut cubes, 4);
            roots.push(cubes);
        }
        let mut root = [upper_levels(&mut graph, &roots, 4)];
        graph.merge(&mut root, LOG2);
        graph.counts()
    }
}
