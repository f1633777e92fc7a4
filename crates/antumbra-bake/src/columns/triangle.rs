//! Triangles as the builder wants them: one cache line each.

use super::lanes::{Lanes, TEXELS, any, bits, map2, mask};
use crate::light_space::{LatticeTriangle, Resolution, Slices};

/// A triangle with its plane in depth units ([`Slices`]); counter-clockwise on the lattice.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct BuildTriangle {
    pub(crate) x: [i32; 3],
    pub(crate) y: [i32; 3],
    pub(crate) z: [u32; 3],
    flags: u32,
    /// Depth units per lattice step along x and y; zero for an edge-on triangle.
    pub(crate) slope: [f64; 2],
    /// Bound on the rounding error of a depth computed at a texel centre that the triangle covers, in depth units.
    error: f32,
    /// Index of the triangle's cutout, or [`NO_CUTOUT`].
    cutout: u32,
}

/// The triangle is there wherever it covers.
const NO_CUTOUT: u32 = u32::MAX;

const SOLID: u32 = 1;
const FACES_LIGHT: u32 = 2;
const EDGE_ON: u32 = 4;
const SOLID_FACING: u32 = SOLID | FACES_LIGHT;

/// Relative bound on the rounding of a depth, of the greatest term in it: 2^-49.
const ROUNDING: f64 = 1.0 / (1u64 << 49) as f64;

/// 1.5 * 2^52: doubles near it are whole numbers, those a little below it too.
const ROUNDER: f64 = (3u64 << 51) as f64;

impl BuildTriangle {
    /// `None` for a triangle that can neither cover a texel nor bound a solid.
    #[must_use]
    pub fn new(t: &LatticeTriangle, slices: &Slices) -> Option<Self> {
        let area = t.doubled_area();
        if area == 0 && !t.solid {
            return None;
        }
        let mut flags = if t.solid { SOLID } else { 0 };
        let mut corners = [0, 1, 2];
        if area < 0 {
            flags |= FACES_LIGHT;
            corners.swap(1, 2);
        } else if area == 0 {
            flags |= EDGE_ON;
        }
        let mut triangle = Self {
            x: corners.map(|i| t.x[i]),
            y: corners.map(|i| t.y[i]),
            z: corners.map(|i| t.z[i]),
            flags,
            slope: [0.0; 2],
            error: 0.0,
            cutout: NO_CUTOUT,
        };
        if area != 0 {
            triangle.set_plane(slices);
        }
        Some(triangle)
    }

    /// The same triangle, there only where a cutout keeps it: an index into the build's cutouts.
    #[must_use]
    pub fn with_cutout(self, cutout: u32) -> Self {
        Self { cutout, ..self }
    }

    /// Index of its cutout.
    #[inline(always)]
    pub(crate) fn cutout(&self) -> Option<usize> {
        (self.cutout != NO_CUTOUT).then_some(self.cutout as usize)
    }

    fn set_plane(&mut self, slices: &Slices) {
        let (numerators, area) = self.gradient();
        self.slope = numerators.map(|n| n as f64 / area as f64 * slices.units_per_step());
        let reach = |c: [i32; 3]| f64::from(c[0].max(c[1]).max(c[2]) - c[0].min(c[1]).min(c[2]));
        let span = self.slope[0].abs() * reach(self.x) + self.slope[1].abs() * reach(self.y);
        // A handful of roundings of terms no greater than the span, and of a sum no greater than the volume's depth.
        self.error = (span * ROUNDING + slices.rounding()) as f32;
    }

    /// Exact depth gradient on the lattice: numerators along x and y, and their common denominator, the doubled area.
    fn gradient(&self) -> ([i64; 2], i64) {
        let [x, y, z] = [self.x.map(i64::from), self.y.map(i64::from), self.z.map(i64::from)];
        let [dx1, dy1, dz1] = [x[1] - x[0], y[1] - y[0], z[1] - z[0]];
        let [dx2, dy2, dz2] = [x[2] - x[0], y[2] - y[0], z[2] - z[0]];
        ([dz1 * dy2 - dz2 * dy1, dz2 * dx1 - dz1 * dx2], dx1 * dy2 - dx2 * dy1)
    }

    /// Whether it bounds a solid.
    #[inline(always)]
    pub(crate) fn is_solid(&self) -> bool {
        self.flags & SOLID != 0
    }

    /// Whether it is a line as the light sees it: it covers nothing, but may lie across a gap.
    #[inline(always)]
    pub(crate) fn is_edge_on(&self) -> bool {
        self.flags & EDGE_ON != 0
    }

    /// What a crossing adds to the winding number.
    #[inline(always)]
    pub(crate) fn winding(&self) -> i32 {
        match self.flags {
            SOLID_FACING => 1,
            SOLID => -1,
            _ => 0,
        }
    }

    /// Edge `i` as (normal x, normal y, corner): the edge function at p is the normal's dot product with p - corner.
    #[inline(always)]
    pub(crate) fn edge(&self, i: usize) -> Edge {
        let j = if i == 2 { 0 } else { i + 1 };
        Edge {
            normal: [i64::from(self.y[i] - self.y[j]), i64::from(self.x[j] - self.x[i])],
            corner: [i64::from(self.x[i]), i64::from(self.y[i])],
        }
    }

    /// Whether it is the same triangle twice, whichever way it is turned.
    pub(crate) fn has_corners_of(&self, other: &Self) -> bool {
        (self.x, self.y, self.z, self.slope) == (other.x, other.y, other.z, other.slope)
    }

    /// First and last texel along each axis whose centre its box may hold; texels may lie off the grid. `None` for one that
    /// covers nothing.
    pub(crate) fn texels(&self, resolution: Resolution) -> Option<[[i64; 2]; 2]> {
        let steps = resolution.texel_steps();
        let span = |c: [i32; 3]| {
            let [low, high] = [c[0].min(c[1]).min(c[2]), c[0].max(c[1]).max(c[2])].map(i64::from);
            [low, high].map(|c| (c - steps / 2) >> resolution.texel_shift())
        };
        (!self.is_edge_on()).then(|| [span(self.x), span(self.y)])
    }

    /// Ends of edge `i` on the lattice, in the triangle's order of turning.
    #[inline(always)]
    pub(crate) fn edge_ends(&self, i: usize) -> [[i32; 2]; 2] {
        let j = if i == 2 { 0 } else { i + 1 };
        [[self.x[i], self.y[i]], [self.x[j], self.y[j]]]
    }

    /// Depth of the plane at a lattice point, in units; exact but for rounding.
    #[inline(always)]
    pub(crate) fn depth(&self, p: [f64; 2], units_per_step: f64) -> f64 {
        let x = p[0] - f64::from(self.x[0]);
        let y = p[1] - f64::from(self.y[0]);
        f64::from(self.z[0]) * units_per_step + (x * self.slope[0] + y * self.slope[1])
    }

    /// How far behind its depth at a texel's centre a plane lies at most within the texel, in units.
    pub(crate) fn rise(&self, texel_steps: f64, slices: &Slices) -> f64 {
        0.5 * texel_steps * (self.slope[0].abs() + self.slope[1].abs()) + slices.widening()
    }

    /// By how much a depth may lie off that is computed within so far of a lattice point, along each axis: rounding, and a
    /// little more so that it opens no gap between neighbours. In units.
    #[inline(always)]
    pub(crate) fn widening(&self, p: [f64; 2], reach: f64, slices: &Slices) -> f64 {
        let x = (p[0] - f64::from(self.x[0])).abs() + reach;
        let y = (p[1] - f64::from(self.y[0])).abs() + reach;
        slices.widening() + (x * self.slope[0].abs() + y * self.slope[1].abs()) * ROUNDING
    }

    /// The plane's depth over a leaf, given its first texel centre: depth there and steps along x and y, in units.
    #[inline(always)]
    fn leaf_plane(&self, first: [i64; 2], slices: &Slices) -> LeafPlane {
        let texel = slices.resolution().texel_steps() as f64;
        let corner = self.depth([first[0] as f64, first[1] as f64], slices.units_per_step());
        let step = [self.slope[0] * texel, self.slope[1] * texel];
        // The triangle covers some of the centres, so the leaf's first lies within eight texels of it.
        let error = f64::from(self.error) + (step[0].abs() + step[1].abs()) * 16.0 * ROUNDING;
        LeafPlane { corner, step, error }
    }

    /// The slices of a leaf's 64 texel centres; exact where the triangle covers them and the mask says so.
    #[inline(always)]
    pub(crate) fn leaf_slices(&self, first: [i64; 2], covered: &Lanes, slices: &Slices) -> Lanes {
        let plane = self.leaf_plane(first, slices);
        let (mut of_texel, doubtful) = plane.slices(slices, covered);
        let doubtful = map2(&doubtful, covered, |doubtful, covered| doubtful & covered);
        if any(&doubtful) {
            self.settle_doubts(&mut of_texel, bits(&doubtful), first, slices);
        }
        of_texel
    }

    #[cold]
    fn settle_doubts(&self, of_texel: &mut Lanes, mut doubtful: u64, first: [i64; 2], slices: &Slices) {
        while doubtful != 0 {
            let i = doubtful.trailing_zeros() as usize;
            of_texel[i] = self.exact_slice(leaf_center(first, i, slices.resolution()), slices);
            doubtful &= doubtful - 1;
        }
    }

    /// The slices of the plane's deepest points in a leaf's 64 texels, where the mask says so; a hair too deep does no harm.
    #[inline(always)]
    pub(crate) fn leaf_deepest(&self, first: [i64; 2], covered: &Lanes, slices: &Slices) -> Lanes {
        self.leaf_plane(first, slices).lowered(slices).slices(slices, covered).0
    }

    /// The slice at a lattice point, in exact integers.
    #[cold]
    pub(crate) fn exact_slice(&self, p: [i64; 2], slices: &Slices) -> u32 {
        let (numerators, area) = self.gradient();
        let along = |n: i64, d: i64| i128::from(n) * i128::from(d);
        let sum = along(numerators[0], p[0] - i64::from(self.x[0])) + along(numerators[1], p[1] - i64::from(self.y[0]));
        let depth = i128::from(self.z[0]) + sum.div_euclid(i128::from(area));
        slices.of_step(depth as u32)
    }
}

/// Lattice point of a leaf's texel centre.
pub(crate) fn leaf_center(first: [i64; 2], texel: usize, resolution: Resolution) -> [i64; 2] {
    let steps = resolution.texel_steps();
    [first[0] + (texel as i64 & 7) * steps, first[1] + (texel as i64 >> 3) * steps]
}

/// A plane over the 8 x 8 texels of a leaf, in depth units.
struct LeafPlane {
    /// Depth at the first texel centre.
    corner: f64,
    /// From one texel to the next along x and y.
    step: [f64; 2],
    /// Bound on rounding errors.
    error: f64,
}

impl LeafPlane {
    /// The plane through the deepest points of the texels' squares.
    #[inline(always)]
    fn lowered(mut self, slices: &Slices) -> Self {
        let rise = 0.5 * (self.step[0].abs() + self.step[1].abs()) + slices.widening();
        self.corner += rise.min(slices.end_units());
        self
    }

    /// Depths at the 64 texel centres.
    #[inline(always)]
    fn depths(&self) -> [f64; TEXELS] {
        let mut depths = [0.0; TEXELS];
        for y in 0..8 {
            for x in 0..8 {
                depths[8 * y + x] = self.corner + (x as f64 * self.step[0] + y as f64 * self.step[1]);
            }
        }
        depths
    }

    /// The slices of those of the 64 texels that a mask holds, at least, and a mask of those that rounding may have made
    /// wrong.
    #[inline(always)]
    fn slices(&self, slices: &Slices, covered: &Lanes) -> (Lanes, Lanes) {
        if slices.are_even() {
            self.even_slices()
        } else {
            slices.of_depths_within(&self.depths(), self.error, covered)
        }
    }

    /// All 64, where a depth unit is a slice.
    #[inline(always)]
    fn even_slices(&self) -> (Lanes, Lanes) {
        let depths = self.depths();
        let (mut slices, mut doubtful) = ([0; TEXELS], [0; TEXELS]);
        for i in 0..TEXELS {
            // Adding so much rounds to a whole number and leaves it in the low bits.
            let rounded = (depths[i] - 0.5) + ROUNDER;
            let share = depths[i] - (rounded - ROUNDER);
            slices[i] = rounded.to_bits() as u32;
            doubtful[i] = mask(!(share > self.error && share < 1.0 - self.error));
        }
        (slices, doubtful)
    }
}

/// A directed edge of a counter-clockwise triangle.
#[derive(Clone, Copy)]
pub(crate) struct Edge {
    pub normal: [i64; 2],
    corner: [i64; 2],
}

impl Edge {
    /// Edge function: positive to the left, where the triangle is. Fits: |normal|, |p - corner| <= 3 * 2^26.
    #[inline(always)]
    pub fn at(&self, p: [i64; 2]) -> i64 {
        self.normal[0] * (p[0] - self.corner[0]) + self.normal[1] * (p[1] - self.corner[1])
    }

    /// Least edge function that counts as covered: a point on the edge is covered where moving it by (d, d^2), d > 0
    /// infinitesimal, brings it inside, so that of two triangles that share an edge exactly one covers it.
    #[inline(always)]
    pub fn threshold(&self) -> i64 {
        let inclusive = self.normal[0] > 0 || (self.normal[0] == 0 && self.normal[1] > 0);
        i64::from(!inclusive)
    }
}
