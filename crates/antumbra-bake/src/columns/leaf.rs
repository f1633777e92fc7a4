//! Leaves: the exact interval of each of 8 x 8 rays, and the least number of masks that satisfies them.
//!
//! Kämpe et al. 2015, sections 3.3 and 3.4: enter and exit depths, and visibility masks by the closest exit. There the
//! depths come from peeled depth maps; here from the triangles that touch the tile. They are met in *clusters*, sets
//! whose depth intervals overlap: clusters follow one another along every ray alike, so a cluster of one triangle is
//! met by whole masks of rays, and only larger ones are sorted ray by ray.

use super::build::Build;
use super::column::{ColumnWriter, Run, multiples, roundest};
use super::freedom::Freedom;
use super::plane::PlaneMemo;
use super::tile::{COVERS, ENTERS, EXITS, Entry, SOLID, Tile};
use super::triangle::BuildTriangle;
use crate::dag::{Id, LIT, SHADOWED, Tables};

/// log2 of a leaf's texels per side.
pub(super) const LEAF_LOG2: u32 = 3;
const TEXELS: usize = 64;
/// Fewer rays than this are computed one by one, more of them all 64 at once.
const FEW_RAYS: u32 = 12;
/// First shadowed slice of a ray without casters.
const NEVER: u32 = u32::MAX;

/// Rays turn from lit to shadowed at any one slice from `first` to `last`; `lit` are the rays still lit behind it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Transition {
    first: u32,
    last: u32,
    lit: u64,
}

/// A ray's meeting with a triangle.
#[derive(Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord)]
struct Crossing {
    slice: u32,
    /// The slice of the plane's deepest point in the whole texel, if the ray may enter a solid here first; else 0.
    deepest: u32,
    winding: i32,
}

/// What solving a leaf needs, kept between leaves.
#[derive(Default)]
pub(super) struct LeafScratch {
    /// Crossings of a cluster: ray i's are at place i of the first so many rows.
    crossings: Vec<[Crossing; TEXELS]>,
    /// Crossings of one ray.
    along_ray: Vec<Crossing>,
    transitions: Vec<Transition>,
    planes: PlaneMemo,
}

/// The rays of a leaf while clusters are met one after the other.
struct Rays {
    /// First shadowed slice.
    enter: [u32; TEXELS],
    /// First slice that must be shadowed.
    exit: [u32; TEXELS],
    /// Slice of the second surface, where that counts.
    second: [u32; TEXELS],
    /// First slice behind the entering surface's deepest point in the whole texel.
    deepest: [u32; TEXELS],
    winding: [i32; TEXELS],
    /// Rays that have met nothing, rays inside a solid that they met first, and rays that look for their second surface.
    /// The others are done.
    outside: u64,
    inside: u64,
    seeking: u64,
}

/// A leaf and its surroundings.
#[derive(Clone, Copy)]
pub(super) struct Leaf<'a> {
    pub build: &'a Build<'a>,
    pub tile: Tile,
    /// See [`super::settle`].
    pub clamp: u32,
}

impl LeafScratch {
    /// Appends the leaf's column of 8 x 8 x 8 blocks. `entries` are sorted by their first slices.
    pub fn push_column(&mut self, leaf: Leaf<'_>, entries: &[Entry], runs: &mut Vec<Run>) {
        let blocks = leaf.build.resolution().texels() >> LEAF_LOG2;
        let Some(remembered) = PlaneMemo::recognise(&leaf, entries) else {
            return self.make_column(leaf, entries, blocks, runs);
        };
        leaf.record_enters(remembered.enters());
        let mut planes = std::mem::take(&mut self.planes);
        planes.push_column(remembered, blocks, runs, |runs| self.make_column(leaf, entries, blocks, runs));
        self.planes = planes;
    }

    fn make_column(&mut self, leaf: Leaf<'_>, entries: &[Entry], blocks: u32, runs: &mut Vec<Run>) {
        let rays = self.solve(leaf, entries);
        self.stab(&rays, leaf.build.resolution().texels());
        push_blocks(&self.transitions, blocks, leaf.build.tables, runs);
    }

    fn solve(&mut self, leaf: Leaf<'_>, entries: &[Entry]) -> Rays {
        let mut rays = Rays::new();
        let mut rest = entries;
        while !rest.is_empty() && rays.open() != 0 {
            let (cluster, later) = rest.split_at(cluster_length(rest));
            match cluster {
                [entry] => rays.meet_one(leaf, *entry),
                _ => self.meet_many(&mut rays, leaf, cluster),
            }
            rest = later;
        }
        if leaf.build.enters.is_some() {
            let (least, greatest) = rays.enter.iter().fold((NEVER, 0), |(l, g), &e| (l.min(e), g.max(e)));
            leaf.record_enters([least, greatest]);
        }
        rays.finish(leaf);
        rays
    }

    /// Meets triangles whose order differs from ray to ray.
    fn meet_many(&mut self, rays: &mut Rays, leaf: Leaf<'_>, cluster: &[Entry]) {
        let mut counts = [0u32; TEXELS];
        let mut touched = 0;
        for entry in cluster {
            let triangle = &leaf.build.triangles[entry.triangle as usize];
            let covered = leaf.coverage(triangle, *entry, rays.open());
            touched |= covered;
            leaf.for_each_crossing(triangle, covered, rays.outside, |texel, crossing| {
                let row = counts[texel] as usize;
                if row == self.crossings.len() {
                    self.crossings.push([Crossing::default(); TEXELS]);
                }
                self.crossings[row][texel] = crossing;
                counts[texel] += 1;
            });
        }
        for_each_bit(touched, |texel| {
            self.along_ray.clear();
            self.along_ray.extend(self.crossings[..counts[texel] as usize].iter().map(|row| row[texel]));
            self.along_ray.sort_unstable();
            for same_slice in self.along_ray.chunk_by(|a, b| a.slice == b.slice) {
                if (rays.open() >> texel) & 1 != 0 {
                    rays.meet_slice(texel, same_slice, leaf.build.freedom);
                }
            }
        });
    }

    /// Stabs the intervals greedily by the closest exit: the fewest transitions that satisfy every ray.
    fn stab(&mut self, rays: &Rays, slices: u32) {
        self.transitions.clear();
        let mut lit = u64::MAX;
        loop {
            let mut last = NEVER;
            for_each_bit(lit, |texel| last = last.min(rays.exit[texel]));
            if last >= slices {
                return;
            }
            let (mut first, mut turning) = (0, 0u64);
            for_each_bit(lit, |texel| {
                if rays.enter[texel] <= last {
                    turning |= 1 << texel;
                    first = first.max(rays.enter[texel]);
                }
            });
            debug_assert!(turning != 0, "a ray enters behind its exit");
            lit &= !turning;
            self.transitions.push(Transition { first, last, lit });
        }
    }
}

/// How many of the sorted entries have depth intervals that overlap, directly or through one another.
fn cluster_length(sorted: &[Entry]) -> usize {
    let mut last = sorted[0].last;
    let mut length = 1;
    while let Some(entry) = sorted.get(length).filter(|e| e.first <= last) {
        last = last.max(entry.last);
        length += 1;
    }
    length
}

impl Rays {
    fn new() -> Self {
        Self {
            enter: [NEVER; TEXELS],
            exit: [NEVER; TEXELS],
            second: [NEVER; TEXELS],
            deepest: [0; TEXELS],
            winding: [0; TEXELS],
            outside: u64::MAX,
            inside: 0,
            seeking: 0,
        }
    }

    /// Rays for which further triangles matter.
    #[inline(always)]
    fn open(&self) -> u64 {
        self.outside | self.inside | self.seeking
    }

    /// Meets a triangle that lies alone in its depth interval.
    fn meet_one(&mut self, leaf: Leaf<'_>, entry: Entry) {
        let triangle = &leaf.build.triangles[entry.triangle as usize];
        let covered = leaf.coverage(triangle, entry, self.open());
        if (self.outside | self.seeking) & covered == 0 {
            // Only counts change, but where the last solid is left.
            let leaving = if entry.has(SOLID) { self.count(covered, triangle.winding()) } else { 0 };
            leaf.for_each_crossing(triangle, leaving, 0, |texel, crossing| {
                self.leave(texel, crossing.slice);
            });
        } else {
            let outside = self.outside;
            leaf.for_each_crossing(triangle, covered, outside, |texel, crossing| {
                self.meet_slice(texel, &[crossing], leaf.build.freedom);
            });
        }
    }

    /// Adds to rays' winding numbers; returns those that are out of all solids.
    fn count(&mut self, covered: u64, winding: i32) -> u64 {
        let mut leaving = 0;
        for_each_bit(covered, |texel| {
            self.winding[texel] += winding;
            leaving |= u64::from(self.winding[texel] <= 0) << texel;
        });
        leaving
    }

    /// Meets all that a ray meets within one slice. Within a slice entries come before exits, so touching solids leave
    /// no slit: only the sum counts.
    #[inline]
    fn meet_slice(&mut self, texel: usize, crossings: &[Crossing], freedom: &Freedom) {
        let slice = crossings[0].slice;
        let bit = 1 << texel;
        let winding = &mut self.winding[texel];
        *winding += crossings.iter().map(|c| c.winding).sum::<i32>();
        if self.outside & bit != 0 {
            self.outside &= !bit;
            self.inside |= bit;
            self.enter[texel] = slice + 1;
            self.deepest[texel] = crossings.iter().map(|c| c.deepest).max().map_or(0, |d| d.saturating_add(1));
            self.seeking |= if freedom.is_static() { bit } else { 0 };
        } else if self.seeking & bit != 0 {
            self.seeking &= !bit;
            self.second[texel] = slice;
        }
        if self.inside & bit != 0 && *winding <= 0 {
            self.leave(texel, slice);
        }
    }

    /// Ends a ray's freedom inside a solid at a slice.
    #[inline(always)]
    fn leave(&mut self, texel: usize, slice: u32) {
        self.inside &= !(1 << texel);
        self.exit[texel] = slice.max(self.enter[texel]);
    }

    /// Rays still inside a solid leave it no earlier than at the clamp, and what they would meet next lies no nearer. What
    /// then lies between enter and exit is the interval of every policy. Where there is slack, the whole texel's lit
    /// surface is left lit: shadows without acne and without bias.
    fn finish(&mut self, Leaf { build, clamp, .. }: Leaf<'_>) {
        let freedom = build.freedom;
        // Surfaces behind the last slice do not count; nothing was dropped where the clamp lies there.
        let slices = build.resolution().texels();
        let second = |texel: usize| match self.second[texel].min(clamp) {
            behind if behind >= slices => NEVER,
            second => second,
        };
        for texel in 0..TEXELS {
            let enter = self.enter[texel];
            let mut exit = self.exit[texel].min(clamp.max(enter));
            if freedom.is_behind_open() && enter != NEVER {
                exit = exit.max(freedom.exit(enter, second(texel)));
            }
            self.exit[texel] = exit;
            if (enter..=exit).contains(&self.deepest[texel]) {
                self.enter[texel] = self.deepest[texel];
            }
        }
    }
}

#[inline(always)]
fn for_each_bit(mut bits: u64, mut each: impl FnMut(usize)) {
    while bits != 0 {
        each(bits.trailing_zeros() as usize);
        bits &= bits - 1;
    }
}

impl Leaf<'_> {
    #[inline(always)]
    pub fn first_center(&self) -> [i64; 2] {
        let resolution = self.build.resolution();
        [resolution.texel_center(self.tile.x), resolution.texel_center(self.tile.y)]
    }

    fn record_enters(&self, span: [u32; 2]) {
        if let Some(grid) = self.build.enters {
            grid.insert(self.tile, span);
        }
    }

    /// Calls `each` with the crossings of the rays in `covered`, all of which the triangle covers.
    #[inline]
    fn for_each_crossing(
        &self,
        triangle: &BuildTriangle,
        covered: u64,
        outside: u64,
        mut each: impl FnMut(usize, Crossing),
    ) {
        let (first, slices) = (self.first_center(), self.build.slices);
        let winding = triangle.winding();
        let enters = (winding > 0 || self.build.freedom.is_behind_open()) && covered & outside != 0;
        if covered.count_ones() < FEW_RAYS {
            for_each_bit(covered, |texel| {
                let slice = triangle.leaf_slice(first, texel, slices);
                let deepest = if enters { triangle.leaf_deepest_at(first, texel, slices) } else { 0 };
                each(texel, Crossing { slice, deepest, winding });
            });
        } else if enters {
            let of_texel = triangle.leaf_slices(first, covered, slices);
            let deepest = triangle.leaf_deepest(first, covered, slices);
            for_each_bit(covered, |texel| {
                each(texel, Crossing { slice: of_texel[texel], deepest: deepest[texel], winding });
            });
        } else {
            let of_texel = triangle.leaf_slices(first, covered, slices);
            for_each_bit(covered, |texel| each(texel, Crossing { slice: of_texel[texel], deepest: 0, winding }));
        }
    }

    /// Bit 8*y + x is set where the triangle covers the texel's centre, is there, and the texel is one of those `wanted`.
    #[inline]
    fn coverage(&self, triangle: &BuildTriangle, entry: Entry, wanted: u64) -> u64 {
        let covered = self.covered_centers(triangle, entry) & wanted;
        match triangle.cutout() {
            None => covered,
            Some(cutout) => self.build.cutouts[cutout].kept(self.first_center(), covered, self.build.resolution()),
        }
    }

    #[inline]
    fn covered_centers(&self, triangle: &BuildTriangle, entry: Entry) -> u64 {
        if entry.has(COVERS) {
            return u64::MAX;
        }
        if !entry.has(ENTERS) && !entry.has(EXITS) && entry.has(SOLID) {
            return 0;
        }
        let first = self.first_center();
        let steps = self.build.resolution().texel_steps();
        let mut covered = u64::MAX;
        for i in 0..3 {
            let edge = triangle.edge(i);
            let at = edge.at(first) - edge.threshold();
            let [dx, dy] = [edge.normal[0] * steps, edge.normal[1] * steps];
            if at + 7 * (dx.min(0) + dy.min(0)) < 0 {
                covered &= left_of_edge(at, dx, dy);
            }
        }
        covered
    }
}

/// The 8 x 8 points at which a linear function is not negative, given its first value and its steps.
#[inline]
fn left_of_edge(at: i64, dx: i64, dy: i64) -> u64 {
    let mut left = 0;
    for y in 0..8 {
        let row = at + y * dy;
        let mut bits = 0;
        for x in 0..8 {
            bits |= u64::from(row + x * dx >= 0) << x;
        }
        left |= bits << (8 * y);
    }
    left
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
