//! Tiles of a quadtree over the shadow map, and which triangles touch them.

use super::triangle::BuildTriangle;
use crate::light_space::Resolution;

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

/// A tile on the lattice, ready to be held against many triangles.
#[derive(Clone, Copy)]
pub(super) struct TileFrame {
    /// First and last texel centre.
    first: [i64; 2],
    last: [i64; 2],
    /// Middle of the tile.
    middle: [f64; 2],
    /// Half the side of the rectangle of centres, and of the tile itself.
    half_centers: f64,
    half_tile: f64,
    slices_per_step: f64,
    shift: u32,
    max_slice: f64,
}

/// Depth intervals are widened by this many slices, so that rounding opens no gap between neighbours.
const WIDEN_SLICES: f64 = 1.0 / 256.0;

impl TileFrame {
    pub fn new(tile: Tile, resolution: Resolution) -> Self {
        let texels = 1u32 << tile.log2;
        let [first, last] = [0, texels - 1].map(|t| [tile.x + t, tile.y + t].map(|c| resolution.texel_center(c)));
        let steps = resolution.texel_steps() as f64;
        Self {
            first,
            last,
            middle: [0, 1].map(|a| 0.5 * (first[a] + last[a]) as f64),
            half_centers: 0.5 * (last[0] - first[0]) as f64,
            half_tile: 0.5 * f64::from(texels) * steps,
            slices_per_step: 1.0 / (1u64 << resolution.slice_shift()) as f64,
            shift: resolution.slice_shift(),
            max_slice: f64::from(resolution.texels()),
        }
    }

    /// The triangle's entry in the tile's list, given that of the parent's; `None` if it does not touch the rectangle
    /// of texel centres.
    #[inline(always)]
    pub fn classify(&self, triangle: &BuildTriangle, parent: Entry) -> Option<Entry> {
        let mut flags = parent.flags;
        if !parent.has(COVERS) {
            flags = (flags & !COVERS_FIRST) | self.coverage(triangle)?;
        }
        let (first, last) = self.depth_range(triangle);
        Some(Entry { triangle: parent.triangle, flags, first: first.max(parent.first), last: last.min(parent.last) })
    }

    /// [`COVERS`] and [`COVERS_FIRST`] as they are; `None` if the triangle does not touch the rectangle.
    #[inline(always)]
    fn coverage(&self, t: &BuildTriangle) -> Option<u32> {
        let outside = |c: [i32; 3], a: usize| {
            i64::from(c[0].max(c[1]).max(c[2])) < self.first[a] || i64::from(c[0].min(c[1]).min(c[2])) > self.last[a]
        };
        if outside(t.x, 0) || outside(t.y, 1) {
            return None;
        }
        let side = self.last[0] - self.first[0];
        let (mut covers, mut covers_first) = (!t.is_edge_on(), !t.is_edge_on());
        for i in 0..3 {
            let edge = t.edge(i);
            let at_first = edge.at(self.first);
            let [x, y] = edge.normal.map(|n| n * side);
            if at_first + x.max(0) + y.max(0) < 0 {
                return None;
            }
            let threshold = edge.threshold();
            covers &= at_first + x.min(0) + y.min(0) >= threshold;
            covers_first &= at_first >= threshold;
        }
        Some(if covers {
            COVERS | COVERS_FIRST
        } else if covers_first {
            COVERS_FIRST
        } else {
            0
        })
    }

    /// Conservative first and last slice: see [`Entry`].
    #[inline(always)]
    fn depth_range(&self, t: &BuildTriangle) -> (u32, u32) {
        let [near, far] = [t.z[0].min(t.z[1]).min(t.z[2]), t.z[0].max(t.z[1]).max(t.z[2])].map(|z| z >> self.shift);
        if t.is_edge_on() {
            return (near, far);
        }
        let depth = t.depth(self.middle, self.slices_per_step);
        let steepness = t.slope[0].abs() + t.slope[1].abs();
        let reach = (self.middle[0] - f64::from(t.x[0])).abs() * t.slope[0].abs()
            + (self.middle[1] - f64::from(t.y[0])).abs() * t.slope[1].abs();
        let widen = WIDEN_SLICES + (reach + steepness * self.half_tile) * 2.0f64.powi(-49);
        let low = (depth - steepness * self.half_centers - widen).clamp(0.0, self.max_slice) as u32;
        let high = (depth + steepness * self.half_tile + widen).clamp(0.0, self.max_slice) as u32;
        (low.max(near), high.min(far))
    }
}

/// The entry of a triangle in the root tile's list.
pub(super) fn root_entry(index: u32, t: &BuildTriangle, resolution: Resolution) -> Entry {
    let [near, far] = [t.z[0].min(t.z[1]).min(t.z[2]), t.z[0].max(t.z[1]).max(t.z[2])];
    let mut flags = if t.is_solid() { SOLID } else { 0 };
    flags |= match t.winding() {
        1 => ENTERS,
        -1 => EXITS,
        _ => 0,
    };
    let shift = resolution.slice_shift();
    Entry { triangle: index, flags, first: near >> shift, last: far >> shift }
}
