//! How far a point lies from a true shadow edge: the truth is asked at points aside, in texels across the light and
//! slices along it.

use antumbra::{Filter, Interior, LightShadow};
use glam::DVec3;

use super::ground::{Ground, Truth};

/// Where the search ends, texels.
pub const FARTHEST_TEXELS: f64 = 16.0;
/// Rings that count as one texel.
const NEAR_RINGS: [f64; 4] = [0.25, 0.5, 0.75, 1.0];
/// Rings further out, each that far.
const FAR_RINGS: [f64; 6] = [1.5, 2.0, 3.0, 4.0, 8.0, FARTHEST_TEXELS];
/// Points per ring.
const DIRECTIONS: u32 = 16;
/// Slices along the light. A bake rounds depths to 2^-32 of its volume: at the finest resolution that is 2^-12 slices.
const SLICES: [f64; 3] = [0.0, -(1.0 + SLACK), 1.0 + SLACK];
const SLACK: f64 = 1.0 / 2048.0;
/// log2 of the steps per side of the lattice on which a bake's vertices lie, across the light: see `docs/format.md`.
const LATTICE_LOG2: u32 = 26;

/// Looks for edges about points of one light.
pub struct Edge<'a> {
    light: LightShadow<'a>,
    ground: &'a Ground,
    towards_light: DVec3,
    /// One texel to either side, and one slice along, world metres.
    right: DVec3,
    down: DVec3,
    along: DVec3,
}

impl<'a> Edge<'a> {
    pub fn new(light: LightShadow<'a>, ground: &'a Ground) -> Self {
        let record = light.record();
        let along = light.direction_world();
        let right = along.any_orthonormal_vector();
        Self {
            light,
            ground,
            towards_light: -along,
            right: right * record.texel_size_m,
            down: right.cross(along) * record.texel_size_m,
            along: along * record.slice_size_m,
        }
    }

    pub fn towards_light(&self) -> DVec3 {
        self.towards_light
    }

    /// Whether the bake was free to choose inside solids.
    pub fn solids_are_free(&self) -> bool {
        self.light.interior() != Interior::Open
    }

    /// Whether the truth changes within a texel and a slice.
    pub fn is_near(&self, point_world: DVec3) -> bool {
        let truth = self.truth(point_world);
        let rings = std::iter::once(0.0).chain(NEAR_RINGS);
        rings.flat_map(|radius| self.ring(point_world, radius)).any(|p| self.truth(p) != truth)
    }

    /// A point of a surface, moved off it as far as a lookup with a filter of three taps moves it, and two slices more:
    /// a plane then has no edge within a texel and a slice of it.
    pub fn lifted(&self, point_world: DVec3, outward: DVec3) -> DVec3 {
        let bias_m = Filter::new_box(3).map_or(0.0, |filter| self.light.bias_m(point_world, outward, filter));
        point_world + outward * (bias_m + 2.0 * self.light.record().slice_size_m)
    }

    /// Distance of the nearest point at which the truth is what the bake says (or free to be so), texels: the radius of
    /// the first ring that has one, infinite if none has.
    pub fn distance_texels(&self, point_world: DVec3, bake_lit: bool) -> f64 {
        let explains = |p: DVec3| match self.truth(p) {
            Truth::Inside => true,
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

    fn truth(&self, point_world: DVec3) -> Truth {
        self.ground.truth(point_world, self.towards_light, self.solids_are_free())
    }

    /// Points of a circle across the light, each at the point's own depth, a slice before it and a slice behind it.
    fn ring(&self, center: DVec3, radius: f64) -> impl Iterator<Item = DVec3> {
        let directions = if radius == 0.0 { 1 } else { DIRECTIONS };
        (0..directions).flat_map(move |i| {
            // Turned a little, so that no direction runs along the axes of a scene.
            let angle = std::f64::consts::TAU * (f64::from(i) + 0.137) / f64::from(directions);
            let (sin, cos) = angle.sin_cos();
            let aside = center + (self.right * cos + self.down * sin) * radius;
            SLICES.map(|slices| aside + self.along * slices)
        })
    }

    /// The middle of the texel that holds the point, at the point's depth, and points two lattice steps about it. All lie
    /// within a texel of the point.
    fn about_texel_center(&self, point_world: DVec3) -> impl Iterator<Item = DVec3> {
        let record = self.light.record();
        let voxel = self.light.project(point_world).voxel;
        let to_center = |v: f64| v.floor() + 0.5 - v;
        let [row_x, row_y] = [0, 1].map(|axis| {
            let row = DVec3::from_array(record.linear[axis]);
            row / row.length_squared()
        });
        let center = point_world + row_x * to_center(voxel.x) + row_y * to_center(voxel.y);
        let step_texels = 2_f64.powi(record.log2_resolution as i32 - LATTICE_LOG2 as i32);
        [0.0, 1.0, 2.0].into_iter().flat_map(move |steps| self.ring(center, steps * step_texels))
    }
}
