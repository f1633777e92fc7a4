//! Tiles of a quadtree over the shadow map, and which triangles touch them.

use pulp::{Arch, Simd, WithSimd};

use super::build::{Build, PAUSE_TRIANGLES};
use super::lanes::mask;
use super::triangle::BuildTriangle;
use crate::light_space::{Resolution, Slices};

/// A square of 2^log2 texels per side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Tile {
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

impl Tile {
    /// Corners of the rectangle of its texel centres, on the lattice: x fastest.
    pub fn corners(self, resolution: Resolution) -> [[f64; 2]; 4] {
        let [x, y] = [resolution.texel_center(self.x) as f64, resolution.texel_center(self.y) as f64];
        let side = (((1i64 << self.log2) - 1) * resolution.texel_steps()) as f64;
        [[x, y], [x + side, y], [x, y + side], [x + side, y + side]]
    }
}

/// A triangle in a tile's list.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Entry {
    pub triangle: u32,
    pub flags: u32,
    /// No part of the triangle within the tile's rectangle of texel centres lies before this slice.
    pub first: u32,
    /// No part of the triangle within the tile's texels lies behind this slice.
    pub last: u32,
}

/// Covers every texel centre of the tile.
pub(crate) const COVERS: u32 = 1;
/// Covers the tile's first texel centre.
pub(crate) const COVERS_FIRST: u32 = 2;
/// Bounds a solid.
pub(crate) const SOLID: u32 = 4;
/// Bounds a solid that rays enter through it. Edge-on triangles neither enter nor leave.
pub(crate) const ENTERS: u32 = 8;
/// Bounds a solid that rays leave through it.
pub(crate) const EXITS: u32 = 16;
/// There only where its cutout keeps it: it may miss any texel.
pub(crate) const CUTOUT: u32 = 32;

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

/// Appends to each child's list those of a tile's entries that touch it: the rectangle of its texel centres.
pub(crate) fn split(arch: Arch, build: &Build<'_>, tile: Tile, entries: &[Entry], lists: &mut [Vec<Entry>; 4]) {
    let split = Split::new(tile, build.slices);
    for (i, entries) in entries.chunks(PAUSE_TRIANGLES).enumerate() {
        if i > 0 {
            (build.pause)();
        }
        arch.dispatch(SplitList { split: &split, triangles: build.triangles, entries, lists });
    }
}

struct SplitList<'a> {
    split: &'a Split<'a>,
    triangles: &'a [BuildTriangle],
    entries: &'a [Entry],
    lists: &'a mut [Vec<Entry>; 4],
}

impl WithSimd for SplitList<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for entry in self.entries {
            let in_children = self.split.classify(&self.triangles[entry.triangle as usize], *entry);
            for (list, entry) in self.lists.iter_mut().zip(in_children) {
                if entry.flags & TOUCHES != 0 {
                    list.push(Entry { flags: entry.flags & !TOUCHES, ..entry });
                }
            }
        }
    }
}

/// A tile's four children on the lattice, ready to be held against many triangles: always all four at once.
struct Split<'a> {
    /// First texel centre of child 0; the others' lie `step` further along x, y or both.
    first: [i64; 2],
    step: i64,
    /// Side of a child's rectangle of texel centres.
    side: i64,
    /// Middle of child 0.
    middle: [f64; 2],
    slices: &'a Slices,
}

/// Touches the child.
const TOUCHES: u32 = 1 << 31;

impl<'a> Split<'a> {
    fn new(parent: Tile, slices: &'a Slices) -> Self {
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

    /// The entry in each child, with [`TOUCHES`] where the triangle touches it at all.
    #[inline(always)]
    fn classify(&self, triangle: &BuildTriangle, parent: Entry) -> [Entry; 4] {
        let coverage = if parent.has(COVERS) {
            [TOUCHES | COVERS | COVERS_FIRST; 4]
        } else {
            let whole = if triangle.is_edge_on() || parent.has(CUTOUT) { TOUCHES } else { !0 };
            let [a, b, c, d] = self.coverage(triangle);
            [a & whole, b & whole, c & whole, d & whole]
        };
        let spans = self.depths(triangle).of_children(self.slices);
        let flags = parent.flags & !(COVERS | COVERS_FIRST);
        let mut children = [parent; 4];
        for (i, child) in children.iter_mut().enumerate() {
            child.flags = flags | coverage[i];
            child.first = spans[i][0].max(parent.first);
            child.last = spans[i][1].min(parent.last);
        }
        children
    }

    /// Per child [`TOUCHES`], [`COVERS`] and [`COVERS_FIRST`].
    #[inline(always)]
    fn coverage(&self, t: &BuildTriangle) -> [u32; 4] {
        let mut touches = self.boxes(t);
        let mut covers = [u32::MAX; 4];
        let mut covers_first = [u32::MAX; 4];
        for i in 0..3 {
            let edge = t.edge(i);
            let at = edge.at(self.first);
            let [dx, dy] = [edge.normal[0] * self.step, edge.normal[1] * self.step];
            let [x, y] = [edge.normal[0] * self.side, edge.normal[1] * self.side];
            let [greatest, least] = [x.max(0) + y.max(0), x.min(0) + y.min(0) - edge.threshold()];
            let at = [at, at + dx, at + dy, at + dx + dy];
            for child in 0..4 {
                touches[child] &= mask(at[child] + greatest >= 0);
                covers[child] &= mask(at[child] + least >= 0);
                covers_first[child] &= mask(at[child] - edge.threshold() >= 0);
            }
        }
        for child in 0..4 {
            let covers = covers[child] & (COVERS | COVERS_FIRST);
            touches[child] &= TOUCHES | covers | (covers_first[child] & COVERS_FIRST);
        }
        touches
    }

    /// Mask of the children that the triangle's box touches.
    #[inline(always)]
    fn boxes(&self, t: &BuildTriangle) -> [u32; 4] {
        let halves = |c: [i32; 3], axis: usize| {
            let (low, high) = (i64::from(c[0].min(c[1]).min(c[2])), i64::from(c[0].max(c[1]).max(c[2])));
            let begin = self.first[axis];
            let touches = |from: i64| mask(high >= from) & mask(low <= from + self.side);
            [touches(begin), touches(begin + self.step)]
        };
        let (columns, rows) = (halves(t.x, 0), halves(t.y, 1));
        [columns[0] & rows[0], columns[1] & rows[0], columns[0] & rows[1], columns[1] & rows[1]]
    }

    #[inline(always)]
    fn depths(&self, t: &BuildTriangle) -> Depths {
        if t.is_edge_on() {
            // All that its corners allow.
            return Depths { at_middle: 0.0, step: [0.0; 2], low: 0.0, high: self.slices.end_units() };
        }
        let [sx, sy] = [t.slope[0].abs(), t.slope[1].abs()];
        let step = self.step as f64;
        let widen = t.widening(self.middle, step, self.slices);
        let steepness = 0.5 * (sx + sy);
        Depths {
            at_middle: t.depth(self.middle, self.slices.units_per_step()),
            step: [t.slope[0] * step, t.slope[1] * step],
            low: steepness * self.side as f64 + widen,
            high: steepness * step + widen,
        }
    }
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
    /// Conservative first and last slice in each child, the corners' own apart: see [`Entry`].
    #[inline(always)]
    fn of_children(&self, slices: &Slices) -> [[u32; 2]; 4] {
        let [x, y] = self.step;
        let middles = [self.at_middle, self.at_middle + x, self.at_middle + y, self.at_middle + x + y];
        let mut spans = [[0; 2]; 4];
        for (span, depth) in spans.iter_mut().zip(middles) {
            *span = [slices.of_units(depth - self.low), slices.of_units(depth + self.high)];
        }
        spans
    }
}

/// The entry of a triangle in the root tile's list; `None` for one that lies behind the last slice. Its slices are those of
/// its corners, which hold for every tile below.
pub(crate) fn root_entry(index: u32, t: &BuildTriangle, slices: &Slices) -> Option<Entry> {
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
