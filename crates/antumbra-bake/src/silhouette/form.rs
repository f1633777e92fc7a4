//! Linear functions over a light's texels: edges, by their signs, and planes, by their values.

use antumbra::format::silhouette::{Form, MOST_LOCAL_SHIFT};

use crate::columns::BuildTriangle;
use crate::light_space::{Resolution, Slices};

/// An edge's ends on the lattice, the lesser first: one edge has one key, whichever triangles share it.
pub(crate) type EdgeKey = [[i32; 2]; 2];

/// Edge `i` of a triangle, and whether the triangle lies to its left.
#[inline(always)]
pub(crate) fn edge_of(triangle: &BuildTriangle, i: usize) -> (EdgeKey, bool) {
    let [from, to] = triangle.edge_ends(i);
    if from < to { ([from, to], true) } else { ([to, from], false) }
}

/// Which of a triangle's depths a plane stands for, as a transition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    /// Just behind the surface, exactly.
    Behind,
    /// Just behind the surface, and a hair more.
    Past,
    /// Half a slice before the surface.
    Before,
}

/// A plane: a triangle's, on one side of it, perhaps the deep one. Bits 1 and 0 are the side, bit 2 is set for deep ones, the rest is the
/// triangle.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Plane(u32);

impl Plane {
    /// Triangles behind this one have no planes.
    pub const MOST_TRIANGLES: u32 = (1 << 29) - 1;

    pub fn new(triangle: u32, side: Side) -> Self {
        Self((triangle << 3) | side as u32)
    }

    /// Half a slice behind the deepest point that the plane has in each texel: where faces are not quite flat, one plane will do.
    pub fn deep(self) -> Self {
        Self(self.0 | 4)
    }

    pub fn is_deep(self) -> bool {
        self.0 & 4 != 0
    }

    fn triangle(self) -> usize {
        (self.0 >> 3) as usize
    }

    fn side(self) -> Side {
        match self.0 & 3 {
            0 => Side::Behind,
            1 => Side::Past,
            _ => Side::Before,
        }
    }

    /// Its form, unless it is too steep; deep planes are made of it when they are looked up.
    pub fn form(self, triangles: &[BuildTriangle], slices: &Slices) -> Option<Form> {
        plane_form(&triangles[self.triangle()], self.side(), slices)
    }
}

/// What a region's depth follows: a plane, or two.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Surface {
    pub first: Plane,
    second: Plane,
}

/// What two planes are to each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Second {
    /// There is one alone.
    None,
    /// Where the first one's solid ends: max(first, min(first's deep one, back)).
    Back(Plane),
    /// Another surface: the depth is the nearer one's, or the farther one's.
    Nearer(Plane),
    Farther(Plane),
}

impl Surface {
    const NO_PLANE: Plane = Plane(u32::MAX);
    /// None.
    pub const NONE: Self = Self { first: Self::NO_PLANE, second: Self::NO_PLANE };

    pub fn plane(plane: Plane) -> Self {
        Self { first: plane, second: Self::NO_PLANE }
    }

    /// Between a triangle where rays enter a solid and one where they leave it.
    pub fn wedge(front: u32, back: u32) -> Self {
        Self { first: Plane::new(front, Side::Past), second: Plane::new(back, Side::Before) }
    }

    /// The nearer one of two planes, none of which lies before its triangle: the lesser is the first.
    pub fn nearer(a: Plane, b: Plane) -> Self {
        Self { first: a.min(b), second: a.max(b) }
    }

    /// The farther one of two: the greater is the first.
    pub fn farther(a: Plane, b: Plane) -> Self {
        Self { first: a.max(b), second: a.min(b) }
    }

    pub fn second(self) -> Second {
        match self.second {
            Self::NO_PLANE => Second::None,
            back if back.side() == Side::Before => Second::Back(back),
            other if other > self.first => Second::Nearer(other),
            other => Second::Farther(other),
        }
    }
}

/// Bits of a plane's slopes.
const SLOPE_BITS: i32 = 30;
/// Most bits behind the binary point of planes that count in slices.
pub(super) const FRACTION_BITS: u32 = 30;
/// Those, and of planes that count in lattice steps.
const MOST_SHIFT: [i32; 2] = [FRACTION_BITS as i32, MOST_LOCAL_SHIFT as i32];
/// 1.5 * 2^52: doubles near it are whole numbers.
pub(super) const ROUNDER: f64 = (3u64 << 51) as f64;
/// Bits of a slice that a hair is.
const HAIR_BITS: u32 = 12;
/// A hair in lattice steps.
const HAIR_STEPS: i64 = 8;

/// The form whose sign is an edge's side: not negative to the left of the way from the key's first end to its second, by the
/// rasteriser's own rule for points on the edge.
pub(crate) fn edge_form([a, b]: EdgeKey, resolution: Resolution) -> Form {
    let [ax, ay, bx, by] = [a[0], a[1], b[0], b[1]].map(i64::from);
    let normal = [ay - by, bx - ax];
    let is_inclusive = normal[0] > 0 || (normal[0] == 0 && normal[1] > 0);
    let steps = resolution.texel_steps();
    // The edge function is normal * (centre - a), centre = (texel + 1/2) * steps.
    let at_first = normal[0] * (steps / 2 - ax) + normal[1] * (steps / 2 - ay) - i64::from(!is_inclusive);
    Form { a: normal[0] as i32, b: normal[1] as i32, c: at_first >> resolution.texel_shift(), shift: 0 }
}

/// The power of two at or below a number; of very small ones less.
fn exponent(number: f64) -> i32 {
    (number.to_bits() >> 52) as i32 - 1023
}

/// A triangle's plane, unless it is too steep: in slices where those are even, else in lattice steps.
fn plane_form(triangle: &BuildTriangle, side: Side, slices: &Slices) -> Option<Form> {
    if triangle.is_edge_on() {
        return None;
    }
    if slices.are_even() { plane_in_slices(triangle, side, slices) } else { plane_in_steps(triangle, side, slices) }
}

/// A plane's slopes from one texel to the next, and the bits behind their binary point, at least so many.
fn rounded_slopes(slope: [f64; 2], least_shift: u32, most_shift: i32) -> Option<([i64; 2], u32)> {
    let steepest = slope[0].abs().max(slope[1].abs());
    let shift = if steepest > 0.0 { SLOPE_BITS - 1 - exponent(steepest) } else { most_shift };
    let shift = u32::try_from(shift.min(most_shift)).ok().filter(|shift| *shift >= least_shift)?;
    let one = (1i64 << shift) as f64;
    // Adding so much rounds to a whole number.
    Some((slope.map(|s| ((s * one + ROUNDER) - ROUNDER) as i64), shift))
}

fn plane_in_slices(triangle: &BuildTriangle, side: Side, slices: &Slices) -> Option<Form> {
    let resolution = slices.resolution();
    let steps = resolution.texel_steps();
    let ([a, b], shift) = rounded_slopes(triangle.slope.map(|s| s * steps as f64), HAIR_BITS, MOST_SHIFT[0])?;
    let at_corner = (i64::from(triangle.z[0]) << shift) >> resolution.slice_shift();
    let surface = at_first_texel(triangle, [a, b], at_corner, resolution);
    let (hair, half_slice) = (1i64 << (shift - HAIR_BITS), 1i64 << (shift - 1));
    let c = match side {
        Side::Behind => surface + (1 << shift),
        Side::Past => surface + (1 << shift) + hair,
        Side::Before => surface - half_slice,
    };
    Some(Form { a: a as i32, b: b as i32, c, shift })
}

fn plane_in_steps(triangle: &BuildTriangle, side: Side, slices: &Slices) -> Option<Form> {
    let resolution = slices.resolution();
    let steps = resolution.texel_steps();
    let moved = if side == Side::Before { slices.value_before() } else { slices.value_of(true) };
    let ([a, b], shift) = rounded_slopes(triangle.slope.map(|s| s * steps as f64 * moved.share), 0, MOST_SHIFT[1])?;
    let at_corner = (moved.of(f64::from(triangle.z[0])) * (1i64 << shift) as f64) as i64;
    let hair = if side == Side::Past { HAIR_STEPS << shift } else { 0 };
    Some(Form { a: a as i32, b: b as i32, c: at_first_texel(triangle, [a, b], at_corner, resolution) + hair, shift })
}

/// A plane's value at the first texel's centre, given that at the triangle's first corner.
fn at_first_texel(triangle: &BuildTriangle, [a, b]: [i64; 2], at_corner: i64, resolution: Resolution) -> i64 {
    let [dx, dy] = [triangle.x[0], triangle.y[0]].map(|c| i64::from(c) - resolution.texel_steps() / 2);
    at_corner - ((a * dx + b * dy) >> resolution.texel_shift())
}
