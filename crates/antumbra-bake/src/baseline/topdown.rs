//! Top-down construction in z-order, and the upper levels of a graph.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use antumbra::format::dag8::SLICE_LEVEL;

use super::graph::{Graph, Reference};
use super::raster::NEVER;
use crate::dag::{LIT, SHADOWED};
use crate::pause::Pause;

/// A cube of 2^level voxels per side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cube {
    pub level: u32,
    /// In cubes of this size, from the map tile's corner.
    pub x: u32,
    /// The same.
    pub y: u32,
    /// First slice.
    pub z: u32,
}

impl Cube {
    /// First slice behind the cube.
    pub fn end(self) -> u32 {
        self.z + (1 << self.level)
    }

    fn child(self, i: u32) -> Self {
        let level = self.level - 1;
        Self { level, x: 2 * self.x + (i & 1), y: 2 * self.y + ((i >> 1) & 1), z: self.z + ((i >> 2) << level) }
    }
}

/// A map tile's voxels, each resolved to lit or shadowed.
pub(super) trait Voxels: Sync {
    /// Whether a cube is lit or shadowed throughout; and the first slice behind its beginning in which any of its rays
    /// changes.
    fn homogeneous(&self, cube: Cube) -> Option<(bool, u32)>;

    /// A slice from which on cubes of this size over these texels are shadowed throughout.
    fn shadowed_from(&self, cube: Cube) -> u32;

    /// The eight masks of a cube of 8 voxels per side, and the first slice behind its beginning in which a ray changes.
    fn slices(&self, cube: Cube) -> ([u64; 8], u32);
}

/// What constructions side by side may take together.
pub(super) struct Limit<'a> {
    pub bytes: u64,
    pub taken: AtomicU64,
    pub reached: AtomicBool,
    pub pause: Pause<'a>,
}

/// Inserts the nodes of one square column of cubes.
pub(super) struct TopDown<'a, V> {
    voxels: &'a V,
    limit: &'a Limit<'a>,
    /// Whether a node is used again where the one in front of it is identical.
    culls: bool,
    /// Level by level, the last node that each square of texels has completed.
    last: Vec<Vec<Last>>,
    /// Square in which the column stands, in squares of its size.
    origin: [u32; 2],
    log2: u32,
    graph: Graph,
    counted: u64,
}

/// A completed node, and how far behind it is the same.
#[derive(Clone, Copy)]
struct Last {
    end: u32,
    /// First slice in which a ray changes, from the node's beginning on.
    first: u32,
    node: Reference,
}

impl<'a, V: Voxels> TopDown<'a, V> {
    /// The column over one square of 2^log2 texels per side: its cubes from front to back, and their nodes.
    pub fn column(
        voxels: &'a V,
        limit: &'a Limit<'a>,
        culls: bool,
        origin: [u32; 2],
        log2: u32,
        slices: u32,
    ) -> (Graph, Vec<Reference>) {
        let nothing = Last { end: NEVER, first: 0, node: LIT };
        let squares = |level: u32| vec![nothing; if culls { 1 << (2 * (log2 - level)) } else { 0 }];
        let last = (0..=log2).map(|level| if level < SLICE_LEVEL { Vec::new() } else { squares(level) }).collect();
        let mut column = Self { voxels, limit, culls, last, origin, log2, graph: Graph::new(log2), counted: 0 };
        let cube = |z: u32| Cube { level: log2, x: origin[0], y: origin[1], z };
        let roots = (0..slices).step_by(1 << log2).map(|z| column.node(cube(z)).0).collect();
        column.look_at_limit();
        (column.graph, roots)
    }

    /// A cube's node, and the first slice behind the cube's beginning in which a ray changes.
    fn node(&mut self, cube: Cube) -> (Reference, u32) {
        if let Some((lit, first)) = self.voxels.homogeneous(cube) {
            return (if lit { LIT } else { SHADOWED }, first);
        }
        let place = self.place(cube);
        if self.culls {
            let last = &mut self.last[cube.level as usize][place];
            if last.end == cube.z && last.first >= cube.end() {
                last.end = cube.end();
                return (last.node, last.first);
            }
        }
        let (node, first) = if cube.level == SLICE_LEVEL { self.leaf(cube) } else { self.inner(cube) };
        let first = first.min(self.voxels.shadowed_from(cube));
        if self.culls {
            self.last[cube.level as usize][place] = Last { end: cube.end(), first, node };
        }
        (node, first)
    }

    fn leaf(&mut self, cube: Cube) -> (Reference, u32) {
        let (masks, first) = self.voxels.slices(cube);
        let mut children = [LIT; 8];
        for z in 0..8 {
            // Runs of one mask are one mask.
            children[z] = if z > 0 && masks[z] == masks[z - 1] { children[z - 1] } else { self.graph.mask(masks[z]) };
        }
        (self.graph.node(SLICE_LEVEL, children), first)
    }

    fn inner(&mut self, cube: Cube) -> (Reference, u32) {
        if cube.level == SLICE_LEVEL + 3 {
            self.look_at_limit();
        }
        if self.limit.reached.load(Ordering::Relaxed) {
            return (LIT, NEVER);
        }
        let (mut children, mut first) = ([LIT; 8], NEVER);
        for (i, child) in (0..).zip(&mut children) {
            let (node, child_first) = self.node(cube.child(i));
            *child = node;
            // A near child's rays are the cube's.
            first = if i < 4 { first.min(child_first) } else { first };
        }
        (self.graph.node(cube.level, children), first)
    }

    fn place(&self, cube: Cube) -> usize {
        let log2 = self.log2 - cube.level;
        let [x, y] = [cube.x - (self.origin[0] << log2), cube.y - (self.origin[1] << log2)];
        ((y << log2) + x) as usize
    }

    fn look_at_limit(&mut self) {
        let bytes = self.graph.bytes();
        let taken = self.limit.taken.fetch_add(bytes - self.counted, Ordering::Relaxed) + bytes - self.counted;
        self.counted = bytes;
        // Merging takes as much again, and a little more.
        if taken.saturating_mul(5) / 2 > self.limit.bytes || !(self.limit.pause)() {
            self.limit.reached.store(true, Ordering::Relaxed);
        }
    }
}

/// Adds the levels above a grid of cubes of 2^level voxels per side; `roots` are the cubes of each square, front to back,
/// squares row by row. Returns the root.
pub(super) fn upper_levels(graph: &mut Graph, roots: &[Vec<Reference>], mut level: u32) -> Reference {
    let mut side = roots[0].len();
    let at = |side: usize, x: usize, y: usize, z: usize| (y * side + x) * side + z;
    let mut cubes: Vec<Reference> = roots.concat();
    while side > 1 {
        let half = side / 2;
        level += 1;
        let mut coarser = vec![LIT; half * half * half];
        for (x, y, z) in (0..half * half * half).map(|i| (i / half % half, i / (half * half), i % half)) {
            let child = |i: usize| cubes[at(side, 2 * x + (i & 1), 2 * y + ((i >> 1) & 1), 2 * z + (i >> 2))];
            coarser[at(half, x, y, z)] = graph.node(level, [0, 1, 2, 3, 4, 5, 6, 7].map(child));
        }
        (cubes, side) = (coarser, half);
    }
    cubes[0]
}
