//! Where a local light's rays start: closed parts that its near plane cuts, and solids that hold it, count as open.
//!
//! Along a ray the winding number is counted from 0 at the near plane. That is right where the near planes cut no closed
//! part and the light stands in no solid: then every ray starts outside. Parts that are cut are opened; if those that are
//! left wind about the light, so are the ones that do.

use antumbra_scene::Bounds;
use glam::DVec3;
use rustc_hash::FxHashSet;

use super::{CasterTriangle, Casters};

/// Closed parts that bound no solid for a light.
#[derive(Clone, Debug, Default)]
pub struct OpenedParts {
    parts: FxHashSet<u32>,
}

impl OpenedParts {
    /// Whether a part counts as open.
    #[must_use]
    pub fn contains(&self, part: u32) -> bool {
        self.parts.contains(&part)
    }

    /// How many there are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.parts.len()
    }
}

impl Casters<'_> {
    /// The closed parts that a light's rays do not start outside of. The light's near planes lie within a box, of
    /// `half_side_m` along the given unit axes to either side.
    #[must_use]
    pub fn opened_parts(&self, position_world: DVec3, axes: [DVec3; 3], half_side_m: f64) -> OpenedParts {
        let reach = DVec3::splat(half_side_m * 3f64.sqrt());
        let near = Bounds { min: position_world - reach, max: position_world + reach };
        let is_near = |b: &Bounds| b.min.cmple(near.max).all() && near.min.cmple(b.max).all();
        let candidates: FxHashSet<u32> =
            (0..).zip(&self.part_bounds).filter(|(_, bounds)| is_near(bounds)).map(|(part, _)| part).collect();
        let mut opened = OpenedParts::default();
        if candidates.is_empty() {
            return opened;
        }
        let candidate = |triangle: &CasterTriangle<'_>| triangle.part.filter(|part| candidates.contains(part));
        self.for_each_near(&near, |triangle| {
            let Some(part) = candidate(&triangle) else { return };
            let in_light = triangle.corners.map(|c| axes.map(|axis| axis.dot(c - position_world)));
            if touches_box(&in_light, half_side_m) {
                opened.parts.insert(part);
            }
        });
        // Along x, from the light to behind all candidates.
        let mut ray = Bounds { min: position_world, max: position_world };
        candidates.iter().for_each(|part| ray.max.x = ray.max.x.max(self.part_bounds[*part as usize].max.x));
        let mut windings: Vec<(u32, i32)> = Vec::new();
        self.for_each_near(&ray, |triangle| {
            let Some(part) = candidate(&triangle) else { return };
            let winding = crossing(&triangle.corners.map(|c| c - position_world));
            if winding != 0 {
                windings.push((part, winding));
            }
        });
        windings.sort_unstable();
        let whole = windings.chunk_by(|a, b| a.0 == b.0).filter(|same| !opened.contains(same[0].0));
        let sums: Vec<(u32, i32)> = whole.map(|same| (same[0].0, same.iter().map(|(_, w)| w).sum())).collect();
        if sums.iter().map(|(_, winding)| winding).sum::<i32>() != 0 {
            opened.parts.extend(sums.iter().filter(|(_, winding)| *winding != 0).map(|(part, _)| part));
        }
        opened
    }
}

/// Whether a triangle may touch the box of a half side about the origin: never no where it does.
fn touches_box(corners: &[[f64; 3]; 3], half: f64) -> bool {
    let beside = (0..3).any(|axis| corners.iter().all(|c| c[axis] > half) || corners.iter().all(|c| c[axis] < -half));
    let [a, b, c] = corners.map(DVec3::from_array);
    let normal = (b - a).cross(c - a);
    let reach = normal.abs().element_sum() * half;
    !beside && normal.dot(a).abs() <= reach * (1.0 + 1e-9)
}

/// +1 where the ray from the origin along +x leaves through the triangle's outside, -1 where it enters, else 0. A ray
/// through an edge or a corner counts as moved by infinitesimals in y and z, so that closed parts come out whole.
fn crossing(corners: &[DVec3; 3]) -> i32 {
    let sides = [[1, 2], [2, 0], [0, 1]].map(|[i, j]| side(corners[i], corners[j]));
    if sides.contains(&0) || sides[0] != sides[1] || sides[1] != sides[2] {
        return 0;
    }
    let weight = |a: DVec3, b: DVec3| a.y * b.z - a.z * b.y;
    let weights = [weight(corners[1], corners[2]), weight(corners[2], corners[0]), weight(corners[0], corners[1])];
    let sum: f64 = weights.iter().sum();
    let x: f64 = corners.iter().zip(weights).map(|(c, w)| c.x * w).sum::<f64>() / sum;
    if sum != 0.0 && x > 0.0 { sides[0] } else { 0 }
}

/// On which side of the edge from a to b the origin lies, seen along x, as exactly for (b, a) reversed. Ends on the ray's
/// own line, or on its plane, are told apart by moving the ray.
fn side(a: DVec3, b: DVec3) -> i32 {
    let swapped = (a.y, a.z) > (b.y, b.z);
    let (a, b) = if swapped { (b, a) } else { (a, b) };
    let at = a.y * b.z - a.z * b.y;
    // The same at (d, d^2) instead of (0, 0).
    let moved = [at, -(b.z - a.z), b.y - a.y].into_iter().find(|v| *v != 0.0);
    let sign = moved.map_or(0, |v| if v > 0.0 { 1 } else { -1 });
    if swapped { -sign } else { sign }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cube about a point.
    fn cube(center: DVec3, half: f64) -> Vec<[DVec3; 3]> {
        let corner = |i: usize| {
            let sign = |bit: usize| if i & bit == 0 { -half } else { half };
            center + DVec3::new(sign(1), sign(2), sign(4))
        };
        let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).map(|t| t.map(corner)).collect()
    }

    #[test]
    fn rays_through_corners_and_edges_count_once() {
        let winding = |center: DVec3| cube(center, 1.0).iter().map(crossing).sum::<i32>();
        let steps = [-1.5, -1.0, -0.5, 0.0, 0.5, 1.0, 1.5];
        for x in [-3.0, 0.25, 3.0] {
            for y in steps {
                for z in steps {
                    let center = DVec3::new(x, y, z);
                    let strictly_inside = center.abs().max_element() < 1.0;
                    let outside = center.abs().max_element() > 1.0;
                    let w = winding(center);
                    assert!(w == 1 || !strictly_inside, "{center}: {w}");
                    assert!(w == 0 || !outside, "{center}: {w}");
                }
            }
        }
    }

    #[test]
    fn boxes_are_touched_or_not() {
        let t = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| [a, b, c];
        assert!(touches_box(&t([-5.0, 0.1, -5.0], [5.0, 0.1, -5.0], [0.0, 0.1, 9.0]), 0.2));
        assert!(!touches_box(&t([-5.0, 0.3, -5.0], [5.0, 0.3, -5.0], [0.0, 0.3, 9.0]), 0.2));
        // A slanted plane that passes the box's corner, whose own box holds it.
        assert!(!touches_box(&t([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]), 0.3));
        assert!(touches_box(&t([1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]), 0.34));
    }
}
