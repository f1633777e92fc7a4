//! Leaves: the exact interval of each of 8 x 8 rays, and the least number of masks that satisfies them.
//!
//! Kämpe et al. 2015, sections 3.3 and 3.4: enter and exit depths, and visibility masks by the closest exit. There the
//! depths come from peeled depth maps; here from the triangles that touch the tile ([`super::rays`]). All 64 rays go side
//! by side, in vector instructions where the processor has them; results are the same everywhere.

use pulp::{Arch, Simd, WithSimd};

use super::build::Build;
use super::column::{ColumnWriter, Run, multiples, roundest};
use super::faces::{FaceMemo, Known, LeafKey};
use super::lanes::{Lanes, TEXELS, any, bits, greatest, least, map, map2, mask, spread};
use super::rays::{Rays, Row, insert};
use super::tile::{COVERS, ENTERS, EXITS, Entry, SOLID, Tile};
use super::triangle::BuildTriangle;
use crate::dag::{Id, Interner, LIT, SHADOWED};

/// log2 of a leaf's texels per side.
pub(crate) const LEAF_LOG2: u32 = 3;

/// Rays turn from lit to shadowed at any one slice from `first` to `last`; `lit` are the rays still lit behind it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Transition {
    pub first: u32,
    pub last: u32,
    pub lit: u64,
}

/// What solving a leaf needs, kept between leaves.
pub(crate) struct LeafScratch {
    arch: Arch,
    /// Crossings of a cluster.
    rows: Vec<Row>,
    transitions: Vec<Transition>,
}

/// A leaf and its surroundings.
#[derive(Clone, Copy)]
pub(crate) struct Leaf<'a> {
    pub build: &'a Build<'a>,
    pub tile: Tile,
}

/// Solves a leaf: from its list to its transitions.
struct Solve<'a> {
    leaf: Leaf<'a>,
    entries: &'a [Entry],
    /// See [`super::settle`].
    clamp: u32,
    rows: &'a mut Vec<Row>,
    transitions: &'a mut Vec<Transition>,
}

impl LeafScratch {
    pub fn new(arch: Arch) -> Self {
        Self { arch, rows: Vec::new(), transitions: Vec::new() }
    }

    /// What vector instructions to use.
    pub fn arch(&self) -> Arch {
        self.arch
    }

    /// Appends the leaf's column of 8 x 8 x 8 blocks. `entries` are sorted by their first slices.
    pub(in crate::columns) fn push_column(
        &mut self,
        leaf: Leaf<'_>,
        entries: &[Entry],
        clamp: u32,
        nodes: &mut Interner<'_>,
        runs: &mut Vec<Run>,
    ) {
        self.transitions.clear();
        let (rows, transitions) = (&mut self.rows, &mut self.transitions);
        self.arch.dispatch(Solve { leaf, entries, clamp, rows, transitions });
        push_blocks(&self.transitions, leaf.build.blocks(LEAF_LOG2), nodes, runs);
    }

    /// First shadowed slices of the leaf's rays, and first slices that must be shadowed; where a whole texel's surface is left lit, they
    /// differ by one at least. `entries` are sorted by their first slices.
    pub fn intervals(&mut self, leaf: Leaf<'_>, entries: &[Entry], clamp: u32) -> [Lanes; 2] {
        self.transitions.clear();
        let (rows, transitions) = (&mut self.rows, &mut self.transitions);
        self.arch.dispatch(Intervals(Solve { leaf, entries, clamp, rows, transitions }))
    }

    /// The fewest transitions that satisfy every ray.
    pub fn transitions(&mut self, enter: &Lanes, exit: &Lanes, slices: u32) -> &[Transition] {
        self.transitions.clear();
        let mut enter = *enter;
        self.arch.dispatch(Stab { enter: &mut enter, exit: *exit, slices, transitions: &mut self.transitions });
        &self.transitions
    }

    /// The column of a leaf that one open face hides; appended, with `None`, where it cannot be remembered.
    pub(in crate::columns) fn face(
        &mut self,
        leaf: Leaf<'_>,
        triangle: u32,
        faces: &mut FaceMemo,
        nodes: &mut Interner<'_>,
        runs: &mut Vec<Run>,
    ) -> Option<Known> {
        let triangle = &leaf.build.triangles[triangle as usize];
        let (mut enter, key) = self.arch.dispatch(FacePattern { leaf, triangle });
        let blocks = leaf.build.blocks(LEAF_LOG2);
        if let Some(known) = key.as_ref().and_then(|key| faces.leaf(key, blocks)) {
            return Some(known);
        }
        self.transitions.clear();
        let (exit, slices) = (enter, leaf.build.resolution().texels());
        self.arch.dispatch(Stab { enter: &mut enter, exit, slices, transitions: &mut self.transitions });
        let base = runs.len();
        push_blocks(&self.transitions, blocks, nodes, runs);
        let known = faces.insert_leaf(&key?, &runs[base..])?;
        runs.truncate(base);
        Some(known)
    }
}

impl WithSimd for Solve<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) {
        let slices = self.leaf.build.resolution().texels();
        let mut rays = self.finished(0);
        Stab { enter: &mut rays.enter, exit: rays.exit, slices, transitions: self.transitions }.all();
    }
}

/// A leaf's intervals alone.
struct Intervals<'a>(Solve<'a>);

impl WithSimd for Intervals<'_> {
    type Output = [Lanes; 2];

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) -> [Lanes; 2] {
        let rays = self.0.finished(1);
        [rays.enter, rays.exit]
    }
}

/// The first shadowed slices of a leaf under an open face, and what they are remembered by.
struct FacePattern<'a> {
    leaf: Leaf<'a>,
    triangle: &'a BuildTriangle,
}

impl WithSimd for FacePattern<'_> {
    type Output = (Lanes, Option<LeafKey>);

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let Self { leaf, triangle } = self;
        let (enter, span) = leaf.enters_of_face(triangle);
        let key = LeafKey::new(&enter, span, leaf.build.resolution().texels());
        (enter, key)
    }
}

/// Stabs the intervals of 64 rays greedily by the closest exit: the fewest transitions that satisfy every ray.
pub(crate) struct Stab<'a> {
    pub enter: &'a mut Lanes,
    pub exit: Lanes,
    pub slices: u32,
    pub transitions: &'a mut Vec<Transition>,
}

impl WithSimd for Stab<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        self.all();
    }
}

impl Stab<'_> {
    #[inline(always)]
    fn all(mut self) {
        let mut lit = u64::MAX;
        loop {
            let last = least(&self.exit);
            if last >= self.slices {
                return;
            }
            let turning = map(self.enter, |enter| mask(enter <= last));
            let first = greatest(&map2(&turning, self.enter, |turning, enter| turning & enter));
            debug_assert!(any(&turning), "a ray enters behind its exit");
            *self.enter = map2(&turning, self.enter, |turning, enter| enter | turning);
            self.exit = map2(&turning, &self.exit, |turning, exit| exit | turning);
            lit &= !bits(&turning);
            self.transitions.push(Transition { first, last, lit });
        }
    }
}

impl Solve<'_> {
    #[inline(always)]
    fn finished(&mut self, spare: u32) -> Rays {
        let leaf = self.leaf;
        let mut rays = self.rays();
        if leaf.build.enters.is_some() {
            leaf.record_enters(&rays.enter);
        }
        rays.finish(leaf.build.freedom, self.clamp, leaf.build.resolution().texels(), spare);
        rays
    }

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
        // Open surfaces end what is to be known of a ray, unless something is free behind them.
        let is_open = !leaf.build.freedom.is_behind_open() && cluster.iter().all(|entry| !entry.has(SOLID));
        let most = if is_open { 1 } else { usize::MAX };
        for entry in cluster {
            let triangle = &leaf.build.triangles[entry.triangle as usize];
            let covered = leaf.coverage(triangle, *entry, open);
            if !any(&covered) || (cluster.len() == 1 && rays.only_count(&covered, triangle.winding())) {
                continue;
            }
            insert(self.rows, leaf.crossings(triangle, &covered, rays), most);
        }
        rays.meet(self.rows, leaf.build.freedom);
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

    /// First shadowed slices of a leaf that one open face hides; the least and the greatest, which are noted where that is wanted.
    #[inline(always)]
    pub fn enters_of_face(&self, face: &BuildTriangle) -> (Lanes, [u32; 2]) {
        let surface = face.leaf_slices(self.first_center(), &[u32::MAX; TEXELS], self.build.slices);
        let enter = map(&surface, |slice| slice + 1);
        let span = self.record_enters(&enter);
        (enter, span)
    }

    /// Least and greatest first shadowed slice, noted where that is wanted.
    #[inline(always)]
    fn record_enters(&self, enter: &Lanes) -> [u32; 2] {
        let span = [least(enter), greatest(enter)];
        if let Some(grid) = self.build.enters {
            grid.insert(self.tile, span);
        }
        span
    }

    /// A triangle's crossings with the rays that it covers.
    #[inline(always)]
    fn crossings(&self, triangle: &BuildTriangle, covered: &Lanes, rays: &Rays) -> Row {
        let (first, slices) = (self.first_center(), self.build.slices);
        let winding = triangle.winding();
        let enters = (winding > 0 || self.build.freedom.is_behind_open()) && rays.meet_first(covered);
        let deepest = if enters { Some(triangle.leaf_deepest(first, covered, slices)) } else { None };
        Row::new(covered, &triangle.leaf_slices(first, covered, slices), deepest.as_ref(), winding)
    }

    /// Mask of the texels whose centres the triangle covers, where it is there, of those that are `wanted`.
    #[inline(always)]
    pub fn coverage(&self, triangle: &BuildTriangle, entry: Entry, wanted: &Lanes) -> Lanes {
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
fn push_blocks(transitions: &[Transition], blocks: u32, nodes: &mut Interner<'_>, runs: &mut Vec<Run>) {
    let mut column = ColumnWriter::new(runs);
    let mut lit = u64::MAX;
    let mut i = 0;
    while let Some(t) = transitions.get(i) {
        if let Some(boundary) = multiples([t.first, t.last], LEAF_LOG2) {
            column.push(boundary, || constant_mask(nodes, lit));
            lit = t.lit;
            i += 1;
            continue;
        }
        // Commit every transition that no block boundary can hold to a slice within its block.
        let block = t.last >> LEAF_LOG2;
        column.push([block; 2], || constant_mask(nodes, lit));
        let mut slices = [nodes.mask(lit); 8];
        while let Some(t) = transitions.get(i).filter(|t| is_within(t, block)) {
            slices[(roundest(t.first, t.last) & 7) as usize..].fill(nodes.mask(t.lit));
            lit = t.lit;
            i += 1;
        }
        column.push([block + 1; 2], || nodes.slice_node(slices));
    }
    column.push([blocks; 2], || constant_mask(nodes, lit));
}

/// Whether a transition must happen inside a block.
fn is_within(t: &Transition, block: u32) -> bool {
    multiples([t.first, t.last], LEAF_LOG2).is_none() && t.last >> LEAF_LOG2 == block
}

/// The block all of whose slices are one mask.
fn constant_mask(nodes: &mut Interner<'_>, lit: u64) -> Id {
    match lit {
        u64::MAX => LIT,
        0 => SHADOWED,
        _ => {
            let mask = nodes.mask(lit);
            nodes.slice_node([mask; 8])
        }
    }
}
