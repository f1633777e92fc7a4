//! Linear functions over a light's texels: edges, by their signs, and planes, by their values.

use antumbra::format::silhouette::Form;

use crate::columns::BuildTriangle;
use crate::light_space::{Resolution, Slices};

/// An edge's ends on the lattice, the lesser first: one edge has one key, whichever triangles share it.
pub(crate) type EdgeKey = [[i32; 2]; 2];

/// Which of a triangle's depths a plane stands for, as a transition.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[repr(u8)]
pub(crate) enum Side {
    /// Just behind the surface, exactly.
    Behind,
    /// Just behind the surface, and a hair more.
    Past,
    /// Half a slice before the surface.
    Before,
}

/// A plane: a triangle's, on one side of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct PlaneKey {
    pub triangle: u32,
    pub side: Side,
    /// What is made of it: [`AS_IT_IS`], [`DEEP`], or a wedge with a triangle where rays leave the solid.
    pub back: u32,
}

/// The plane itself.
pub(crate) const AS_IT_IS: u32 = u32::MAX;
/// Half a slice behind the deepest point that the plane has in each texel: where faces are not quite flat, one plane will do.
pub(crate) const DEEP: u32 = u32::MAX - 1;

impl PlaneKey {
    pub fn new(triangle: u32, side: Side) -> Self {
        Self { triangle, side, back: AS_IT_IS }
    }

    pub fn deep(triangle: u32, side: Side) -> Self {
        Self { triangle, side, back: DEEP }
    }

    pub fn wedge(triangle: u32, back: u32) -> Self {
        Self { triangle, side: Side::Past, back }
    }
}

/// Bits of a plane's slopes.
const SLOPE_BITS: i32 = 30;
/// Most bits behind a plane's binary point.
const MOST_SHIFT: i32 = 30;
/// Bits of a slice that a hair is.
const HAIR_BITS: u32 = 12;

/// The form whose sign is an edge's side: not negative to the left of the way from the key's first end to its second, by the
/// rasteriser's own rule for points on the edge.
pub(crate) fn edge_form([a, b]: EdgeKey, resolution: Resolution) -> Form {
    let [ax, ay, bx, by] = [a[0], a[1], b[0], b[1]].map(i64::from);
    let normal = [ay - by, bx - ax];
    let is_inclusive = normal[0] > 0 || (normal[0] == 0 && normal[1] > 0);
    let steps = resolution.texel_steps();
    // The edge function is normal * (centre - a), centre = (texel + 1/2) * steps.
    let at_first = normal[0] * (steps / 2 - ax) + normal[1] * (steps / 2 - ay) - i64::from(!is_inclusive);
    Form { a: normal[0] as i32, b: normal[1] as i32, c: at_first.div_euclid(steps), shift: 0 }
}

/// The power of two at or below a number; of very small ones less.
fn exponent(number: f64) -> i32 {
    (number.to_bits() >> 52) as i32 - 1023
}

/// A triangle's plane in slices, where those are even and the plane is not too steep.
pub(crate) fn plane_form(triangle: &BuildTriangle, side: Side, slices: &Slices) -> Option<Form> {
    if !slices.are_even() || triangle.is_edge_on() {
        return None;
    }
    let resolution = slices.resolution();
    let steps = resolution.texel_steps();
    let slope = triangle.slope.map(|s| s * steps as f64);
    let steepest = slope[0].abs().max(slope[1].abs());
    let shift = if steepest > 0.0 { SLOPE_BITS - 1 - exponent(steepest) } else { MOST_SHIFT };
    let shift = shift.min(MOST_SHIFT);
    if shift < HAIR_BITS as i32 {
        return None;
    }
    let shift = shift as u32;
    let one = (1i64 << shift) as f64;
    let [a, b] = slope.map(|s| (s * one).round_ties_even() as i64);
    let half = steps / 2;
    let [dx, dy] = [i64::from(triangle.x[0]) - half, i64::from(triangle.y[0]) - half];
    let at_corner = (i64::from(triangle.z[0]) << shift) >> resolution.slice_shift();
    let surface = at_corner - (a * dx + b * dy).div_euclid(steps);
    let (hair, half_slice) = (1i64 << (shift - HAIR_BITS), 1i64 << (shift - 1));
    let c = match side {
        Side::Behind => surface + (1 << shift),
        Side::Past => surface + (1 << shift) + hair,
        Side::Before => surface - half_slice,
    };
    Some(Form { a: a as i32, b: b as i32, c, shift })
}
