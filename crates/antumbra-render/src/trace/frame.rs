//! The hierarchy's own space, and the bounds that make its `f32` arithmetic safe.
//!
//! obvhs keeps boxes and rays in `f32`, ends boxes at an absolute distance of 1e-4 and clamps direction components at
//! 1.2e-7. So its space is the scene moved to its centre and scaled by a power of two to half a side of 512 to 1024
//! units: every absolute constant becomes a relative one. A ray is clipped to the scene's box in `f64` first, so that
//! no `f32` number is ever larger than the scene, and every box is padded by more than all roundings together:
//!
//! ```text
//! rounding of a corner, of an origin (1024 * 2^-24 each)       1.3e-4
//! rounding of the direction, over the diagonal of 3547         2.2e-4
//! its clamp at 1.2e-7, over the diagonal                       4.3e-4
//! the slab test's two multiplications and three additions      1.3e-3
//! the tree's quantisation (floor and ceil of rounded numbers)  2.5e-4
//!                                                      total   2.4e-3 < PAD = 2^-7 = 7.8e-3
//! ```

use antumbra_scene::Bounds;
use glam::{DVec3, Vec3A};
use obvhs::{aabb::Aabb, ray::Ray as TreeRay};

use super::Ray;

/// Largest half side of a scene in the hierarchy's units.
const HALF_SIDE: f64 = 1024.0;
/// Padding of every box, in the hierarchy's units: 7.6e-6 of the scene's half side.
const PAD: f64 = 1.0 / 128.0;

/// World space to the hierarchy's space and back.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    center_world: DVec3,
    /// A power of two: multiplying is exact.
    units_per_metre: f64,
    /// Half the scene's box, padded, in units.
    half: DVec3,
}

/// A clipped ray in the hierarchy's space.
pub(super) struct Clipped {
    pub ray: TreeRay,
    /// Units of the tree's ray per unit of the world ray's parameter.
    units_per_t: f64,
    /// The tree ray's origin, in units along the world ray.
    start: f64,
}

impl Frame {
    /// The frame of a scene; an empty or a point-like box gives a valid frame too.
    pub(super) fn new(bounds: Bounds) -> Self {
        let (center_world, half_world) = if bounds.is_empty() {
            (DVec3::ZERO, DVec3::ZERO)
        } else {
            // Halves first: the sum of two huge corners could overflow.
            let center = bounds.min * 0.5 + bounds.max * 0.5;
            (center, (bounds.max - center).max(center - bounds.min))
        };
        let largest = half_world.max_element().clamp(1e-280, 1e280);
        let units_per_metre = (HALF_SIDE / largest).log2().floor().exp2();
        Self { center_world, units_per_metre, half: half_world * units_per_metre + 2.0 * PAD }
    }

    /// The padded box of a triangle. `index` spreads the padding a little: PLOC pairs boxes of equal cost one pair at
    /// a time, so that thousands of coinciding triangles would take quadratic time and make a tree as deep.
    pub(super) fn padded_box(&self, corners: &[DVec3; 3], index: usize) -> Aabb {
        let [a, b, c] = corners.map(|p| (p - self.center_world) * self.units_per_metre);
        let spread = (index as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40;
        let pad = DVec3::splat(PAD * (1.0 + spread as f64 / 16_777_216.0));
        Aabb::new((a.min(b).min(c) - pad).as_vec3a(), (a.max(b).max(c) + pad).as_vec3a())
    }

    /// Clips a ray to the scene's box: `None` where they do not meet.
    pub(super) fn clip(&self, ray: &Ray) -> Option<Clipped> {
        // Scaled first: the square of a very long or short direction would not fit.
        let largest = ray.direction.abs().max_element();
        let length = (ray.direction / largest).length() * largest;
        let units_per_t = length * self.units_per_metre;
        let direction = ray.direction / length;
        let origin = (ray.origin - self.center_world) * self.units_per_metre;
        if !(origin.is_finite() && direction.is_finite() && units_per_t.is_finite()) {
            return None;
        }
        let (mut start, mut end) = (ray.t_min * units_per_t, ray.t_max * units_per_t);
        for axis in 0..3 {
            let (o, d, half) = (origin[axis], direction[axis], self.half[axis]);
            if d == 0.0 {
                if o.abs() > half {
                    return None;
                }
                continue;
            }
            let (t0, t1) = ((-half - o) / d, (half - o) / d);
            start = start.max(t0.min(t1));
            end = end.min(t0.max(t1));
        }
        // Seen from very far, the clip itself rounds: the slack grows with the distance.
        let slack = PAD + origin.abs().max_element() * 1e-14;
        if start > end + slack {
            return None;
        }
        // The tree ends boxes less than 1e-4 past its ray's origin: start one slack early.
        let start = start - slack;
        Some(Clipped { ray: tree_ray(origin + direction * start, direction, end + slack - start), units_per_t, start })
    }
}

impl Clipped {
    /// A parameter of the world ray as one of the tree's, rounded so that boxes that hold it are still visited.
    #[inline(always)]
    pub(super) fn tree_t(&self, t: f64) -> f32 {
        (t * self.units_per_t - self.start + PAD) as f32
    }
}

fn tree_ray(origin: DVec3, direction: DVec3, length: f64) -> TreeRay {
    // Adding zero turns -0 into +0: obvhs would take the reciprocal's sign from the one and the box's order from the
    // other.
    let direction = direction.as_vec3a() + Vec3A::ZERO;
    TreeRay::new(origin.as_vec3a(), direction, 0.0, length as f32)
}
