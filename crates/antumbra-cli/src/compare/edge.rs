//! How far a point lies from a true shadow edge: the truth is asked at points aside, in texels across the light and
//! slices along it.

use antumbra::Filter;
use glam::DVec3;

use super::grid::Grid;
use super::sight::{Sight, Truth};

/// Where the search ends, texels.
pub const FARTHEST_TEXELS: f64 = 16.0;
/// Rings that count as one texel.
const NEAR_RINGS: [f64; 4] = [0.25, 0.5, 0.75, 1.0];
/// Rings further out, each that far.
const FAR_RINGS: [f64; 6] = [1.5, 2.0, 3.0, 4.0, 8.0, FARTHEST_TEXELS];
/// Points per ring.
const DIRECTIONS: u32 = 16;

/// Looks for edges about points of one light.
pub struct Edge<'a> {
    sight: &'a Sight<'a>,
}

impl<'a> Edge<'a> {
    pub fn new(sight: &'a Sight<'a>) -> Self {
        Self { sight }
    }

    /// Whether the truth changes within a texel and a slice.
    pub fn is_near(&self, point_world: DVec3) -> bool {
        let truth = self.sight.truth(point_world, None);
        let grid = self.grid(point_world);
        let rings = std::iter::once(0.0).chain(NEAR_RINGS);
        rings.flat_map(|radius| ring(&grid, [0.0; 2], radius)).any(|p| self.sight.truth(p, None) != truth)
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
        let grid = self.grid(point_world);
        // A bake knows of no cone: a point inside it has its texel's shadow, whose middle may lie outside.
        let is_cut_off = self.sight.beam().is_outside_cone(point_world);
        let explains = |p: DVec3| {
            let truth = if is_cut_off { self.sight.truth(p, None) } else { self.sight.cast(p, None) };
            truth.is_free() || bake_lit == (truth == Truth::Lit)
        };
        let ring_explains = |radius: &f64| ring(&grid, [0.0; 2], *radius).any(explains);
        if let Some(radius) = std::iter::once(0.0).chain(NEAR_RINGS).find(ring_explains) {
            return radius;
        }
        // Rings miss what is thinner than the gaps in them. The bake looked at its texel's middle: look there too, and a
        // lattice step or two about it.
        if about_texel_center(&grid).any(explains) {
            return 1.0;
        }
        FAR_RINGS.into_iter().find(|radius| ring_explains(radius)).unwrap_or(f64::INFINITY)
    }

    /// The grid about a point. What lies beyond the light's range has the answers of its end, and its edges.
    fn grid(&self, point_world: DVec3) -> Grid {
        Grid::new(self.sight.light(), self.sight.beam().within_range(point_world))
    }
}

/// Points of a circle across the light about a point so many texels aside, each at the point's own depth, a slice before
/// it and a slice behind it.
fn ring(grid: &Grid, [right, down]: [f64; 2], radius: f64) -> impl Iterator<Item = DVec3> {
    let directions = if radius == 0.0 { 1 } else { DIRECTIONS };
    let slice = grid.slice_and_slack();
    (0..directions).flat_map(move |i| {
        // Turned a little, so that no direction runs along the axes of a scene.
        let angle = std::f64::consts::TAU * (f64::from(i) + 0.137) / f64::from(directions);
        let (sin, cos) = angle.sin_cos();
        [0.0, -slice, slice].map(|slices| grid.point([right + radius * cos, down + radius * sin], slices))
    })
}

/// The middle of the texel that holds the point, at the point's depth, and points two lattice steps about it. All lie
/// within a texel of the point.
fn about_texel_center(grid: &Grid) -> impl Iterator<Item = DVec3> {
    let step_texels = grid.lattice_step_texels();
    [0.0, 1.0, 2.0].into_iter().flat_map(move |steps| ring(grid, grid.to_texel_center(), steps * step_texels))
}
