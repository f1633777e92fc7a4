//! The truth of a point and a light: a ray between them, and what the bake's policy leaves undefined.

use antumbra::{Interior, LightShadow};
use antumbra_bake::casters::OpenedParts;
use antumbra_render::{Ray, TriangleId};
use glam::DVec3;

use super::beam::{Beam, Path, Way};
use super::grid::Grid;
use super::ground::Ground;

/// What is true of a point and a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Truth {
    /// Nothing lies on the ray towards the light.
    Lit,
    /// Something does, or the point lies outside a spot light's cone.
    Shadowed,
    /// The point lies inside a closed part, so that nobody sees what the bake answers.
    Inside,
    /// It lies behind a surface, where the bake's policy promises nothing.
    Undefined,
}

impl Truth {
    /// Whether the bake may answer what it likes.
    pub fn is_free(self) -> bool {
        matches!(self, Self::Inside | Self::Undefined)
    }
}

/// One light and what its rays meet.
pub struct Sight<'a> {
    light: LightShadow<'a>,
    ground: &'a Ground<'a>,
    beam: Beam,
    policy: Interior,
    opened: OpenedParts,
}

impl<'a> Sight<'a> {
    pub fn new(light: LightShadow<'a>, ground: &'a Ground<'a>) -> Self {
        let beam = Beam::new(light.record());
        let opened = match &beam {
            Beam::Sun { .. } => OpenedParts::default(),
            Beam::Lamp(lamp) => {
                let half_side_m = lamp.near_m * lamp.grid_tangent.max(1.0);
                ground.casters().opened_parts(lamp.position_world, lamp.axes, half_side_m)
            }
        };
        Self { light, ground, beam, policy: light.interior(), opened }
    }

    pub fn light(&self) -> LightShadow<'a> {
        self.light
    }

    pub fn ground(&self) -> &'a Ground<'a> {
        self.ground
    }

    pub fn beam(&self) -> &Beam {
        &self.beam
    }

    /// The truth at a point, to the letter: a hair behind a surface is in its shadow. A point of a triangle (`own`) is
    /// seen from outside: the triangle casts nothing on itself, and where it faces away from the light, its own solid
    /// does.
    pub fn truth(&self, point_world: DVec3, own: Option<TriangleId>) -> Truth {
        if self.beam.is_outside_cone(point_world) { Truth::Shadowed } else { self.cast(point_world, own) }
    }

    /// The same by what casts alone: a spot light's cone does not count.
    pub fn cast(&self, point_world: DVec3, own: Option<TriangleId>) -> Truth {
        let mut path = match self.beam.way(point_world) {
            Way::Bright => return Truth::Lit,
            Way::Path(path) => path,
        };
        if own.is_some() {
            path.ray.t_min = path.ray.t_min.max(self.ground.near_m());
        }
        if !self.ground.is_occluded(&path.ray, own) {
            return Truth::Lit;
        }
        if self.policy == Interior::Open {
            return Truth::Shadowed;
        }
        if self.ground.winding(&path.ray, own, &self.opened) > 0 {
            return Truth::Inside;
        }
        if self.is_undefined(&path, own) { Truth::Undefined } else { Truth::Shadowed }
    }

    fn is_undefined(&self, path: &Path, own: Option<TriangleId>) -> bool {
        match self.policy {
            Interior::Open | Interior::Closed | Interior::Auto => false,
            Interior::Thickness(m) => self.is_within(m, path, own),
            Interior::Static(m) => self.is_before_second(m, path, own),
        }
    }

    /// Whether the ray's first surface, seen from the light, lies no farther than so many metres before the point.
    fn is_within(&self, thickness_m: f64, path: &Path, own: Option<TriangleId>) -> bool {
        let ray = path.ray;
        !self.ground.is_occluded(&ray.between(ray.t_min + thickness_m, ray.t_max), own)
    }

    /// Whether the ray's second surface, seen from the light, lies farther behind the point than a margin of depth. What
    /// lies within a slice of the first surface counts as the first.
    fn is_before_second(&self, margin_m: f64, path: &Path, own: Option<TriangleId>) -> bool {
        let ray = path.ray;
        let Some(first) = self.ground.last_hit(&ray, own) else { return false };
        let first_ends = first - self.slice_m(ray.at(first));
        // A point of a triangle has a surface: its own.
        let is_own_second = own.is_some() && first_ends > ray.t_min;
        if is_own_second || self.ground.is_occluded(&ray.between(ray.t_min, first_ends), own) {
            return false;
        }
        let behind_m = (margin_m * path.stretch).min(path.to_far_m);
        let onwards = Ray::new(ray.at(ray.t_min), -ray.direction).between((ray.t_min - first_ends).max(0.0), behind_m);
        !self.ground.is_occluded(&onwards, own)
    }

    /// Length of the ray through a point behind it, as long as a slice at most.
    fn slice_m(&self, point_world: DVec3) -> f64 {
        let grid = Grid::new(self.light, point_world);
        (grid.point([0.0; 2], grid.slice_and_slack()) - point_world).length()
    }
}
