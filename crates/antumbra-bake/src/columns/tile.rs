//! Tiles of a quadtree over the shadow map, and which triangles touch them.

use super::triangle::{BuildTriangle, ROUNDING};
use crate::light_space::{Resolution, Slices};

/// A square of 2^log2 texels per side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Tile {
    /// First texel.
    pub x: u32,
    /// First texel.
    pub y: u32,
    pub log2: u32,
}

impl Tile {
    pub fn root(resolution: Resolution) -> Self {
        Self { x: 0, y: 0, log2: resolution.log2() }
    }

    /// Child `i`, x fastest.
    pub fn child(self, i: u32) -> Self {
        let log2 = self.log2 - 1;
        Self { x: self.x + ((i & 1) << log2), y: self.y + ((i >> 1) << log2), log2 }
    }
}

/// A triangle in a tile's list.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub triangle: u32,
    pub flags: u32,
    /// No part of the triangle within the tile's rectangle of texel centres lies before this slice.
    pub first: u32,
    /// No part of the triangle within the tile's texels lies behind this slice.
    pub last: u32,
}

/// Covers every texel centre of the tile.
pub(super) const COVERS: u32 = 1;
/// Covers the tile's first texel centre.
pub(super) const COVERS_FIRST: u32 = 2;
/// Bounds a solid.
pub(super) const SOLID: u32 = 4;
/// Bounds a solid that rays enter through it. Edge-on triangles neither enter nor leave.
pub(super) const ENTERS: u32 = 8;
/// Bounds a solid that rays leave through it.
pub(super) const EXITS: u32 = 16;
/// There only where its cutout keeps it: it may miss any texel.
pub(super) const CUTOUT: u32 = 32;

impl Entry {
    /// Whether all of the given flags are set.
    #[inline(always)]
    pub fn has(&self, flags: u32) -> bool {
        self.flags & flags == flags
    }

    /// What the triangle adds to the winding number along the first texel's ray.
    #[inline(always)]
    pub fn winding_at_first(&self) -> i32 {
        i32::from(self.has(COVERS_FIRST | ENTERS)) - i32::from(self.has(COVERS_FIRST | EXITS))
    }
}

/// A tile's four children on the lattice, ready to be held against many triangles.
pub(super) struct Split<'a> {
    /// First texel centre of child 0; the others' lie `step` further along x, y or both.
    first: [i64; 2],
    step: i64,
    /// Side of a child's rectangle of texel centres.
    side: i64,
    /// Middle of child 0.
    middle: [f64; 2],
    slices: &'a Slices,
}

impl<'a> Split<'a> {
    pub fn new(parent: Tile, slices: &'a Slices) -> Self {
        let resolution = slices.resolution();
        let texel = resolution.texel_steps();
        let step = texel << (parent.log2 - 1);
        let first = [resolution.texel_center(parent.x), resolution.texel_center(parent.y)];
        let side = step - texel;
        Self {
            first,
            step,
            side,
            middle: [first[0] as f64 + 0.5 * side as f64, first[1] as f64 + 0.5 * side as f64],
            slices,
        }
    }

    /// Calls `keep` with each child whose rectangle of texel centres the triangle touches, and its entry there.
    #[inline(always)]
    pub fn classify(&self, triangle: &BuildTriangle, parent: Entry, mut keep: impl FnMut(usize, Entry)) {
        let mut coverage = [Some(COVERS | COVERS_FIRST); 4];
        if !parent.has(COVERS) {
            coverage = self.coverage(triangle);
        }
        let depths = self.depths(triangle);
        for (child, coverage) in coverage.into_iter().enumerate() {
            if let Some(coverage) = coverage {
                let (first, last) = depths.of_child(child, self.slices);
                let flags = (parent.flags & !(COVERS | COVERS_FIRST)) | coverage;
                let (first, last) = (first.max(parent.first), last.min(parent.last));
                keep(child, Entry { triangle: parent.triangle, flags, first, last });
            }
        }
    }

    /// Per child [`COVERS`] and [`COVERS_FIRST`] as they are; `None` where the triangle does not touch the rectangle.
    #[inline(always)]
    fn coverage(&self, t: &BuildTriangle) -> [Option<u32>; 4] {
        // Which halves of the parent the triangle's box touches, along an axis: bit 0 the lesser, bit 1 the greater.
        let halves = |c: [i32; 3], a: usize| {
            let (low, high) = (i64::from(c[0].min(c[1]).min(c[2])), i64::from(c[0].max(c[1]).max(c[2])));
            let begin = self.first[a];
            let touches = |from: i64| u32::from(high >= from && low <= from + self.side);
            touches(begin) | (touches(begin + self.step) << 1)
        };
        let (columns, rows) = (halves(t.x, 0), halves(t.y, 1));
        let whole = if t.is_edge_on() || t.cutout().is_some() { 0 } else { COVERS | COVERS_FIRST };
        let mut coverage = [None; 4];
        if columns == 0 || rows == 0 {
            return coverage;
        }
        let edges = [self.edge_in_children(t, 0), self.edge_in_children(t, 1), self.edge_in_children(t, 2)];
        for (child, coverage) in coverage.iter_mut().enumerate() {
            let in_box = (columns >> (child & 1)) & (rows >> (child >> 1)) & 1 != 0;
            let touches = |e: &EdgeInChildren| e.at_first[child] + e.to_greatest >= 0;
            if in_box && edges.iter().all(touches) {
                let covers = edges.iter().all(|e| e.at_first[child] + e.to_least >= e.threshold);
                let covers_first = edges.iter().all(|e| e.at_first[child] >= e.threshold);
                let all = if covers { COVERS | COVERS_FIRST } else { 0 };
                *coverage = Some((all | if covers_first { COVERS_FIRST } else { 0 }) & whole);
            }
        }
        coverage
    }

    #[inline(always)]
    fn edge_in_children(&self, t: &BuildTriangle, i: usize) -> EdgeInChildren {
        let edge = t.edge(i);
        let at = edge.at(self.first);
        let [dx, dy] = [edge.normal[0] * self.step, edge.normal[1] * self.step];
        let [x, y] = [edge.normal[0] * self.side, edge.normal[1] * self.side];
        EdgeInChildren {
            at_first: [at, at + dx, at + dy, at + dx + dy],
            to_greatest: x.max(0) + y.max(0),
            to_least: x.min(0) + y.min(0),
            threshold: edge.threshold(),
        }
    }

    #[inline(always)]
    fn depths(&self, t: &BuildTriangle) -> Depths {
        if t.is_edge_on() {
            // All that its corners allow.
            return Depths { at_middle: 0.0, step: [0.0; 2], low: 0.0, high: self.slices.end_units() };
        }
        let [sx, sy] = [t.slope[0].abs(), t.slope[1].abs()];
        let step = self.step as f64;
        let reach =
            [(self.middle[0] - f64::from(t.x[0])).abs() + step, (self.middle[1] - f64::from(t.y[0])).abs() + step];
        let widen = self.slices.widening() + (reach[0] * sx + reach[1] * sy) * ROUNDING;
        let steepness = 0.5 * (sx + sy);
        Depths {
            at_middle: t.depth(self.middle, self.slices.units_per_step()),
            step: [t.slope[0] * step, t.slope[1] * step],
            low: steepness * self.side as f64 + widen,
            high: steepness * step + widen,
        }
    }
}

/// An edge function over the four children's rectangles.
struct EdgeInChildren {
    at_first: [i64; 4],
    /// From a child's first centre to its greatest and least value over the child's centres.
    to_greatest: i64,
    to_least: i64,
    threshold: i64,
}

/// A triangle's plane over the four children, in depth units.
struct Depths {
    at_middle: f64,
    step: [f64; 2],
    /// How far the plane may lie before and behind its depth at a child's middle.
    low: f64,
    high: f64,
}

impl Depths {
    /// Conservative first and last slice in a child, the corners' own apart: see [`Entry`].
    #[inline(always)]
    fn of_child(&self, child: usize, slices: &Slices) -> (u32, u32) {
        let mut depth = self.at_middle;
        depth += if child & 1 != 0 { self.step[0] } else { 0.0 };
        depth += if child & 2 != 0 { self.step[1] } else { 0.0 };
        (slices.of_units(depth - self.low), slices.of_units(depth + self.high))
    }
}

/// The entry of a triangle in the root tile's list; `None` for one that lies behind the last slice. Its slices are those of
/// its corners, which hold for every tile below.
pub(super) fn root_entry(index: u32, t: &BuildTriangle, slices: &Slices) -> Option<Entry> {
    let [near, far] = [t.z[0].min(t.z[1]).min(t.z[2]), t.z[0].max(t.z[1]).max(t.z[2])];
    let mut flags = if t.is_solid() { SOLID } else { 0 };
    flags |= match t.winding() {
        1 => ENTERS,
        -1 => EXITS,
        _ => 0,
    };
    flags |= if t.cutout().is_some() { CUTOUT } else { 0 };
    let [first, last] = [near, far].map(|step| slices.of_step(step));
    (first < slices.resolution().texels()).then_some(Entry { triangle: index, flags, first, last })
}
