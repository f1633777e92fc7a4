//! How far a point lies from a true shadow edge: the truth is asked at points aside, in texels across the light and
//! slices along its rays.

use antumbra::{FacePoint, Filter, LightKind, VoxelFrame};
use glam::DVec3;

use super::ground::{Sight, Truth};

/// Where the search ends, texels.
pub const FARTHEST_TEXELS: f64 = 16.0;
/// Rings that count as one texel.
const NEAR_RINGS: [f64; 4] = [0.25, 0.5, 0.75, 1.0];
/// Rings further out, each that far.
const FAR_RINGS: [f64; 6] = [1.5, 2.0, 3.0, 4.0, 8.0, FARTHEST_TEXELS];
/// Points per ring.
const DIRECTIONS: u32 = 16;
/// Slices beyond one that still count as one. A bake rounds depths to 2^-32 of its volume: at the finest resolution that is
/// 2^-12 slices of a directional light; a local light's grow along the ray, and are finer than even ones near the light.
const SLACK: f64 = 1.0 / 2048.0;
const LOCAL_SLACK: f64 = 1.0 / 32.0;
/// log2 of the steps per side of the lattice on which a bake's vertices lie, across the light: see `docs/format.md`.
const LATTICE_LOG2: u32 = 26;

/// Looks for edges about points of one light.
pub struct Edge<'a> {
    sight: &'a Sight<'a>,
    /// Slices along the light at which rings lie.
    slices: [f64; 3],
}

impl<'a> Edge<'a> {
    pub fn new(sight: &'a Sight<'a>) -> Self {
        let local = sight.light().kind() != LightKind::Directional;
        let step = 1.0 + if local { LOCAL_SLACK } else { SLACK };
        Self { sight, slices: [0.0, -step, step] }
    }

    /// Whether the truth changes within a texel and a slice.
    pub fn is_near(&self, point_world: DVec3) -> bool {
        let truth = self.sight.truth(point_world);
        let rings = std::iter::once(0.0).chain(NEAR_RINGS);
        rings.flat_map(|radius| self.ring(point_world, radius)).any(|p| self.sight.truth(p) != truth)
    }

    /// A point of a surface, moved off it as far as a lookup with a filter of three taps moves it, and two slices more:
    /// a plane then has no edge within a texel and a slice of it.
    pub fn lifted(&self, point_world: DVec3, outward: DVec3) -> DVec3 {
        let light = self.sight.light();
        let bias_m = Filter::new_box(3).map_or(0.0, |filter| light.bias_m(point_world, outward, filter));
        point_world + outward * (bias_m + 2.0 * light.frame(point_world).slice_m)
    }

    /// Distance of the nearest point at which the truth is what the bake says (or free to be so), texels: the radius of
    /// the first ring that has one, infinite if none has.
    pub fn distance_texels(&self, point_world: DVec3, bake_lit: bool) -> f64 {
        let explains = |p: DVec3| match self.sight.truth(p) {
            truth if truth.is_free() => true,
            truth => bake_lit == (truth == Truth::Lit),
        };
        let ring_explains = |radius: &f64| self.ring(point_world, *radius).any(explains);
        if let Some(radius) = std::iter::once(0.0).chain(NEAR_RINGS).find(ring_explains) {
            return radius;
        }
        // Rings miss what is thinner than the gaps in them. The bake looked at its texel's middle: look there too, and a
        // lattice step or two about it.
        if self.about_texel_center(point_world).any(explains) {
            return 1.0;
        }
        FAR_RINGS.into_iter().find(|radius| ring_explains(radius)).unwrap_or(f64::INFINITY)
    }

    /// Points of a circle across the light, each at the point's own depth, a slice before it and a slice behind it. In
    /// perspective a slice lies along the ray, so that a texel stays itself.
    fn ring(&self, center: DVec3, radius: f64) -> impl Iterator<Item = DVec3> {
        let VoxelFrame { right, down, along, towards_light, texel_m, slice_m } = self.sight.light().frame(center);
        let step = -towards_light * (slice_m / along.dot(-towards_light).max(1e-3));
        let (right, down) = (right * texel_m, down * texel_m);
        let directions = if radius == 0.0 { 1 } else { DIRECTIONS };
        let slices = self.slices;
        (0..directions).flat_map(move |i| {
            // Turned a little, so that no direction runs along the axes of a scene.
            let angle = std::f64::consts::TAU * (f64::from(i) + 0.137) / f64::from(directions);
            let (sin, cos) = angle.sin_cos();
            let aside = center + (right * cos + down * sin) * radius;
            slices.map(|slices| aside + step * slices)
        })
    }

    /// The middle of the texel that holds the point, at the point's depth, and points two lattice steps about it. All lie
    /// within a texel of the point.
    fn about_texel_center(&self, point_world: DVec3) -> impl Iterator<Item = DVec3> {
        let light = self.sight.light();
        let FacePoint { face, voxel } = light.project(point_world);
        let middle = DVec3::new(voxel.x.floor() + 0.5, voxel.y.floor() + 0.5, voxel.z);
        let center = light.unproject(FacePoint { face, voxel: middle }).unwrap_or(point_world);
        let step_texels = 2_f64.powi(light.record().log2_resolution as i32 - LATTICE_LOG2 as i32);
        [0.0, 1.0, 2.0].into_iter().flat_map(move |steps| self.ring(center, steps * step_texels))
    }
}
