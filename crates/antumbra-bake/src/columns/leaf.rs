//! Leaves: the exact interval of each of 8 x 8 rays, and the least number of masks that satisfies them.
//!
//! Kämpe et al. 2015, sections 3.3 and 3.4: enter and exit depths, and visibility masks by the closest exit. There the
//! depths come from peeled depth maps; here from the triangles that touch the tile.

use super::column::{ColumnWriter, Run, multiples, roundest};
use super::tile::{COVERS, Entry, Tile};
use super::triangle::BuildTriangle;
use crate::dag::{Id, LIT, SHADOWED, Tables};
use crate::light_space::Resolution;

/// log2 of a leaf's texels per side.
pub(super) const LEAF_LOG2: u32 = 3;
const TEXELS: usize = 64;
/// First shadowed slice of a ray without casters.
const NEVER: u32 = u32::MAX;

/// A triangle's meeting with a ray.
#[derive(Clone, Copy, Default)]
struct Crossing {
    slice: u32,
    /// The slice of the triangle's deepest point over the texel's whole square.
    deepest: u32,
    winding: i32,
}

/// What solving a leaf needs, kept between leaves.
#[derive(Default)]
pub(super) struct LeafScratch {
    /// Crossings of texel i: places i, 64 + i, 128 + i, ...
    crossings: Vec<[Crossing; TEXELS]>,
    transitions: Vec<Transition>,
}

/// Rays turn from lit to shadowed at any one slice from `first` to `last`; `lit` are the rays still lit behind it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Transition {
    first: u32,
    last: u32,
    lit: u64,
}

/// First shadowed slice and first slice that must be shadowed, per ray.
struct Intervals {
    enter: [u32; TEXELS],
    exit: [u32; TEXELS],
}

impl LeafScratch {
    /// Appends the leaf's column of 8 x 8 x 8 blocks.
    pub fn push_column(
        &mut self,
        triangles: &[BuildTriangle],
        entries: &[Entry],
        tile: Tile,
        clamp: u32,
        resolution: Resolution,
        tables: &Tables,
        runs: &mut Vec<Run>,
    ) {
        let intervals = self.solve(triangles, entries, tile, clamp, resolution);
        self.stab(&intervals, resolution.texels());
        push_blocks(&self.transitions, resolution.texels() >> LEAF_LOG2, tables, runs);
    }

    /// Each ray's interval.
    fn solve(
        &mut self,
        triangles: &[BuildTriangle],
        entries: &[Entry],
        tile: Tile,
        clamp: u32,
        resolution: Resolution,
    ) -> Intervals {
        let mut counts = [0u32; TEXELS];
        self.crossings.resize(entries.len(), [Crossing::default(); TEXELS]);
        for entry in entries {
            let triangle = &triangles[entry.triangle as usize];
            let covered = if entry.has(COVERS) { u64::MAX } else { coverage(triangle, tile, resolution) };
            for_each_bit(covered, |texel| {
                let place = counts[texel] as usize;
                self.crossings[place][texel] = crossing(triangle, tile, texel, resolution);
                counts[texel] += 1;
            });
        }
        let mut intervals = Intervals { enter: [NEVER; TEXELS], exit: [NEVER; TEXELS] };
        for texel in 0..TEXELS {
            if counts[texel] > 0 {
                let (enter, exit) = self.interval(texel, counts[texel] as usize, clamp);
                intervals.enter[texel] = enter;
                intervals.exit[texel] = exit;
            }
        }
        intervals
    }

    /// The interval of a ray with `count` crossings.
    fn interval(&mut self, texel: usize, count: usize, clamp: u32) -> (u32, u32) {
        self.sort(texel, count);
        let crossings = &self.crossings[..count];
        let first = crossings[0][texel].slice;
        let enter = first + 1;
        let exit = self.last_inside(texel, count).max(enter).min(clamp.max(enter));
        // Where there is slack, leave the whole texel's lit surface lit: shadows without acne and without bias.
        let surface = crossings.iter().map(|c| c[texel]).take_while(|c| c.slice == first);
        let deepest = surface.filter(|c| c.winding > 0).map(|c| c.deepest + 1).max();
        (deepest.filter(|d| (enter..=exit).contains(d)).unwrap_or(enter), exit)
    }

    /// The first slice behind which the ray is out of all solids. Within a slice entries come before exits, so
    /// touching solids leave no slit.
    fn last_inside(&self, texel: usize, count: usize) -> u32 {
        let mut winding = 0;
        for i in 0..count {
            let crossing = self.crossings[i][texel];
            winding += crossing.winding;
            let slice_ends = i + 1 == count || self.crossings[i + 1][texel].slice != crossing.slice;
            if slice_ends && winding <= 0 {
                return crossing.slice;
            }
        }
        NEVER
    }

    /// Insertion sort: rays have few crossings, and lists come nearly sorted.
    fn sort(&mut self, texel: usize, count: usize) {
        for i in 1..count {
            let moving = self.crossings[i][texel];
            let mut place = i;
            while place > 0 && self.crossings[place - 1][texel].slice > moving.slice {
                self.crossings[place][texel] = self.crossings[place - 1][texel];
                place -= 1;
            }
            self.crossings[place][texel] = moving;
        }
    }

    /// Stabs the intervals greedily by the closest exit: the fewest transitions that satisfy every ray.
    fn stab(&mut self, intervals: &Intervals, slices: u32) {
        self.transitions.clear();
        let mut lit = u64::MAX;
        loop {
            let mut last = NEVER;
            for_each_bit(lit, |texel| last = last.min(intervals.exit[texel]));
            if last >= slices {
                return;
            }
            let (mut first, mut turning) = (0, 0u64);
            for_each_bit(lit, |texel| {
                if intervals.enter[texel] <= last {
                    turning |= 1 << texel;
                    first = first.max(intervals.enter[texel]);
                }
            });
            lit &= !turning;
            self.transitions.push(Transition { first, last, lit });
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

/// Bit 8*y + x is set where the triangle covers the texel's centre.
fn coverage(triangle: &BuildTriangle, tile: Tile, resolution: Resolution) -> u64 {
    let steps = resolution.texel_steps();
    let first = [tile.x, tile.y].map(|c| resolution.texel_center(c));
    let edges = [0, 1, 2].map(|i| {
        let edge = triangle.edge(i);
        (edge.at(first) - edge.threshold(), edge.normal.map(|n| n * steps))
    });
    let mut covered = 0;
    for y in 0..8 {
        for x in 0..8 {
            // Negative, and so with its top bit set, where any edge has the centre on its right.
            let outside = edges.iter().fold(0, |all, (at, n)| all | (at + n[0] * x + n[1] * y));
            covered |= u64::from(outside >= 0) << (8 * y + x);
        }
    }
    covered
}

fn crossing(triangle: &BuildTriangle, tile: Tile, texel: usize, resolution: Resolution) -> Crossing {
    let center = [tile.x + (texel as u32 & 7), tile.y + (texel as u32 >> 3)].map(|c| resolution.texel_center(c));
    let slices_per_step = 1.0 / (1u64 << resolution.slice_shift()) as f64;
    let depth = triangle.depth(center.map(|c| c as f64), slices_per_step);
    let steepness = triangle.slope[0].abs() + triangle.slope[1].abs();
    Crossing {
        slice: triangle.slice(depth, center, resolution),
        // Half a texel on; a hair more than exact does no harm. The cast saturates.
        deepest: (depth + 0.5 * steepness * resolution.texel_steps() as f64 + 1.0 / 256.0) as u32,
        winding: triangle.winding(),
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
