//! Cutouts: triangles that are there only where their alpha mask says so, tested at each texel's own ray.
//!
//! The point that a texel's ray shows of a triangle has barycentric weights that are linear functions of the lattice
//! coordinates, over their sum; so has everything that is interpolated. That holds in perspective too, and for what is left
//! of a triangle that was clipped.

use antumbra_scene::AlphaTest;
use glam::DVec3;

use crate::light_space::Resolution;

/// A masked triangle of one face of a light.
#[derive(Clone, Copy, Debug)]
pub struct Cutout<'a> {
    test: AlphaTest<'a>,
    /// Lattice point from which coordinates count, so that they are small.
    origin: [i64; 2],
    /// Numerators of u, v and the vertices' alpha, and their denominator: coefficients of x, y and 1.
    u: DVec3,
    v: DVec3,
    alpha: DVec3,
    denominator: DVec3,
}

/// What a masked triangle interpolates: per corner.
#[derive(Clone, Copy, Debug)]
pub struct CutoutCorners {
    /// The corner times its weight: (w x, w y, w) in lattice coordinates, where w is its depth along the face's axis (1
    /// for a directional light).
    pub homogeneous: [DVec3; 3],
    /// Texture coordinates.
    pub texcoords: [[f64; 2]; 3],
    /// Vertex alpha, 1 where there is none.
    pub alpha: [f64; 3],
}

impl<'a> Cutout<'a> {
    /// Prepares a triangle's test.
    #[must_use]
    pub fn new(test: AlphaTest<'a>, corners: &CutoutCorners) -> Self {
        let [a, b, c] = corners.homogeneous;
        let first = if a.z > 0.0 { [a.x / a.z, a.y / a.z] } else { [0.0; 2] };
        // A cast saturates; far off the lattice any origin will do.
        let origin = first.map(|v| (v as i64).clamp(-(1 << 28), 1 << 28));
        let shift = DVec3::new(origin[0] as f64, origin[1] as f64, 0.0);
        let [a, b, c] = [a, b, c].map(|p| p - shift * p.z);
        let weights = [b.cross(c), c.cross(a), a.cross(b)];
        let sum = |values: [f64; 3]| weights[0] * values[0] + weights[1] * values[1] + weights[2] * values[2];
        Self {
            test,
            origin,
            u: sum(corners.texcoords.map(|t| t[0])),
            v: sum(corners.texcoords.map(|t| t[1])),
            alpha: sum(corners.alpha),
            denominator: sum([1.0; 3]),
        }
    }

    /// Whether the triangle is there, at a lattice point that it covers.
    #[must_use]
    pub fn keeps(&self, [x, y]: [i64; 2]) -> bool {
        let at = DVec3::new((x - self.origin[0]) as f64, (y - self.origin[1]) as f64, 1.0);
        let share = 1.0 / self.denominator.dot(at);
        let uv = [self.u.dot(at) * share, self.v.dot(at) * share];
        self.test.keeps(uv, self.alpha.dot(at) * share)
    }

    /// Those of a leaf's 64 texels, of which `covered` are covered, at which the triangle is there.
    pub(super) fn kept(&self, first: [i64; 2], covered: u64, resolution: Resolution) -> u64 {
        let mut kept = covered;
        let mut rest = covered;
        while rest != 0 {
            let texel = rest.trailing_zeros() as usize;
            if !self.keeps(super::triangle::leaf_center(first, texel, resolution)) {
                kept &= !(1 << texel);
            }
            rest &= rest - 1;
        }
        kept
    }
}
