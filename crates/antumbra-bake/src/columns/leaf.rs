//! Leaves: the exact interval of each of 8 x 8 rays, and the least number of masks that satisfies them.
//!
//! Kämpe et al. 2015, sections 3.3 and 3.4: enter and exit depths, and visibility masks by the closest exit. There the
//! depths come from peeled depth maps; here from the triangles that touch the tile ([`super::rays`]). All 64 rays go side
//! by side, in vector instructions where the processor has them; results are the same everywhere.

use pulp::{Arch, Simd, WithSimd};

use super::build::Build;
use super::column::{ColumnWriter, Run, multiples, roundest};
use super::lanes::{Lanes, any, bits, least, map2, mask, spread};
use super::rays::{Rays, Row, insert};
use super::tile::{COVERS, ENTERS, EXITS, Entry, SOLID, Tile};
use super::triangle::BuildTriangle;
use crate::dag::{Id, LIT, SHADOWED, Tables};

/// log2 of a leaf's texels per side.
pub(super) const LEAF_LOG2: u32 = 3;

/// Rays turn from lit to shadowed at any one slice from `first` to `last`; `lit` are the rays still lit behind it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Transition {
    first: u32,
    last: u32,
    lit: u64,
}

/// What solving a leaf needs, kept between leaves.
#[derive(Default)]
pub(super) struct LeafScratch {
    arch: Arch,
    /// Crossings of a cluster.
    rows: Vec<Row>,
    transitions: Vec<Transition>,
}

/// A leaf and its surroundings.
#[derive(Clone, Copy)]
pub(super) struct Leaf<'a> {
    pub build: &'a Build<'a>,
    pub tile: Tile,
    /// See [`super::settle`].
    pub clamp: u32,
}

/// Solves a leaf: from its list to its transitions.
struct Solve<'a> {
    leaf: Leaf<'a>,
    entries: &'a [Entry],
    rows: &'a mut Vec<Row>,
    transitions: &'a mut Vec<Transition>,
}

impl LeafScratch {
    /// Appends the leaf's column of 8 x 8 x 8 blocks. `entries` are sorted by their first slices.
    pub fn push_column(&mut self, leaf: Leaf<'_>, entries: &[Entry], runs: &mut Vec<Run>) {
        self.transitions.clear();
        self.arch.dispatch(Solve { leaf, entries, rows: &mut self.rows, transitions: &mut self.transitions });
        let blocks = leaf.build.resolution().texels() >> LEAF_LOG2;
        push_blocks(&self.transitions, blocks, leaf.build.tables, runs);
    }
}

impl WithSimd for Solve<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) {
        let leaf = self.leaf;
        let mut rays = self.rays();
        if leaf.build.enters.is_some() {
            leaf.record_enters(&rays.enter);
        }
        let slices = leaf.build.resolution().texels();
        rays.finish(leaf.build.freedom, leaf.clamp, slices);
        self.stab(&mut rays, slices);
    }
}

impl Solve<'_> {
    #[inline(always)]
    fn rays(&mut self) -> Rays {
        let mut rays = Rays::new();
        let mut rest = self.entries;
        let mut open = rays.open();
        while !rest.is_empty() && any(&open) {
            let (cluster, later) = rest.split_at(cluster_length(rest));
            self.meet(&mut rays, &open, cluster);
            open = rays.open();
            rest = later;
        }
        rays
    }

    /// Meets triangles of which none lies wholly behind the others.
    #[inline(always)]
    fn meet(&mut self, rays: &mut Rays, open: &Lanes, cluster: &[Entry]) {
        let leaf = self.leaf;
        self.rows.clear();
        for entry in cluster {
            let triangle = &leaf.build.triangles[entry.triangle as usize];
            let covered = leaf.coverage(triangle, *entry, open);
            if !any(&covered) || (cluster.len() == 1 && rays.only_count(&covered, triangle.winding())) {
                continue;
            }
            insert(self.rows, leaf.crossings(triangle, &covered, rays));
        }
        rays.meet(self.rows, leaf.build.freedom);
    }

    /// Stabs the intervals greedily by the closest exit: the fewest transitions that satisfy every ray.
    #[inline(always)]
    fn stab(&mut self, rays: &mut Rays, slices: u32) {
        let mut lit = u64::MAX;
        loop {
            let last = least(&rays.exit);
            if last >= slices {
                return;
            }
            let turning = rays.enter.map(|enter| mask(enter <= last));
            let first = rays.enter.iter().fold(0, |first, enter| first.max(if *enter <= last { *enter } else { 0 }));
            debug_assert!(any(&turning), "a ray enters behind its exit");
            rays.enter = map2(&turning, &rays.enter, |turning, enter| enter | turning);
            rays.exit = map2(&turning, &rays.exit, |turning, exit| exit | turning);
            lit &= !bits(&turning);
            self.transitions.push(Transition { first, last, lit });
        }
    }
}

/// How many of the sorted entries have depth intervals that overlap, directly or through one another.
#[inline(always)]
fn cluster_length(sorted: &[Entry]) -> usize {
    let mut last = sorted[0].last;
    let mut length = 1;
    while let Some(entry) = sorted.get(length).filter(|e| e.first <= last) {
        last = last.max(entry.last);
        length += 1;
    }
    length
}

impl Leaf<'_> {
    #[inline(always)]
    pub fn first_center(&self) -> [i64; 2] {
        let resolution = self.build.resolution();
        [resolution.texel_center(self.tile.x), resolution.texel_center(self.tile.y)]
    }

    #[inline(always)]
    fn record_enters(&self, enter: &Lanes) {
        if let Some(grid) = self.build.enters {
            grid.insert(self.tile, [least(enter), enter.iter().fold(0, |greatest, enter| greatest.max(*enter))]);
        }
    }

    /// A triangle's crossings with the rays that it covers.
    #[inline(always)]
    fn crossings(&self, triangle: &BuildTriangle, covered: &Lanes, rays: &Rays) -> Row {
        let (first, slices) = (self.first_center(), self.build.slices);
        let winding = triangle.winding();
        let enters = (winding > 0 || self.build.freedom.is_behind_open()) && rays.meet_first(covered);
        let deepest = enters.then(|| triangle.leaf_deepest(first, covered, slices));
        Row::new(covered, &triangle.leaf_slices(first, covered, slices), deepest.as_ref(), winding)
    }

    /// Mask of the texels whose centres the triangle covers, where it is there, of those that are `wanted`.
    #[inline(always)]
    fn coverage(&self, triangle: &BuildTriangle, entry: Entry, wanted: &Lanes) -> Lanes {
        let covered = self.covered_centers(triangle, entry, wanted);
        match triangle.cutout() {
            None => covered,
            Some(cutout) => {
                let cutout = &self.build.cutouts[cutout];
                spread(cutout.kept(self.first_center(), bits(&covered), self.build.resolution()))
            }
        }
    }

    #[inline(always)]
    fn covered_centers(&self, triangle: &BuildTriangle, entry: Entry, wanted: &Lanes) -> Lanes {
        if entry.has(COVERS) {
            return *wanted;
        }
        if !entry.has(ENTERS) && !entry.has(EXITS) && entry.has(SOLID) {
            return [0; 64];
        }
        let first = self.first_center();
        let steps = self.build.resolution().texel_steps();
        let mut covered = *wanted;
        for i in 0..3 {
            let edge = triangle.edge(i);
            let at = edge.at(first) - edge.threshold();
            let [dx, dy] = [edge.normal[0] * steps, edge.normal[1] * steps];
            if at + 7 * (dx.min(0) + dy.min(0)) < 0 {
                keep_left_of_edge(&mut covered, at, dx, dy);
            }
        }
        covered
    }
}

/// Keeps those of 8 x 8 points at which a linear function is not negative, given its first value and its steps.
#[inline(always)]
fn keep_left_of_edge(covered: &mut Lanes, at: i64, dx: i64, dy: i64) {
    for (y, row) in (0..8).zip(covered.chunks_exact_mut(8)) {
        let first = at + y * dy;
        for (x, covered) in (0..8).zip(row) {
            *covered &= !(((first + x * dx) >> 63) as u32);
        }
    }
}

/// Appends the transitions' column of 8 x 8 x 8 blocks.
fn push_blocks(transitions: &[Transition], blocks: u32, tables: &Tables, runs: &mut Vec<Run>) {
    let mut column = ColumnWriter::new(runs);
    let mut lit = u64::MAX;
    let mut i = 0;
    while let Some(t) = transitions.get(i) {
        if let Some(boundary) = multiples([t.first, t.last], LEAF_LOG2) {
            column.push(boundary, || constant_mask(tables, lit));
            lit = t.lit;
            i += 1;
            continue;
        }
        // Commit every transition that no block boundary can hold to a slice within its block.
        let block = t.last >> LEAF_LOG2;
        column.push([block; 2], || constant_mask(tables, lit));
        let mut slices = [tables.mask(lit); 8];
        while let Some(t) = transitions.get(i).filter(|t| is_within(t, block)) {
            slices[(roundest(t.first, t.last) & 7) as usize..].fill(tables.mask(t.lit));
            lit = t.lit;
            i += 1;
        }
        column.push([block + 1; 2], || tables.slice_node(slices));
    }
    column.push([blocks; 2], || constant_mask(tables, lit));
}

/// Whether a transition must happen inside a block.
fn is_within(t: &Transition, block: u32) -> bool {
    multiples([t.first, t.last], LEAF_LOG2).is_none() && t.last >> LEAF_LOG2 == block
}

/// The block all of whose slices are one mask.
fn constant_mask(tables: &Tables, lit: u64) -> Id {
    match lit {
        u64::MAX => LIT,
        0 => SHADOWED,
        _ => tables.slice_node([tables.mask(lit); 8]),
    }
}
