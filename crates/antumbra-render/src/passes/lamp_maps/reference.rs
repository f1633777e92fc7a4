//! Lamps' maps on the CPU: each texel that a lookup reads is traced.

use glam::DVec3;

use super::{LampMaps, ROUNDING, Shape};
use crate::camera::View;
use crate::light::Lamp;
use crate::passes::World;
use crate::surface::Surfaces;
use crate::trace::{Hit, Ray, Tracer};

/// The maps of lamps, as lookups see them.
pub(crate) struct Maps<'w> {
    tracer: &'w Tracer,
    surfaces: &'w Surfaces<'w>,
    how: LampMaps,
    eye: DVec3,
    pixel_size: f64,
    least: f32,
}

impl<'w> Maps<'w> {
    pub fn new(how: &LampMaps, world: &'w World<'_>, view: &View) -> Self {
        let World { tracer, surfaces, lighting, .. } = world;
        let least = lighting.lamps.least;
        Self { tracer, surfaces, how: how.clone(), eye: view.eye, pixel_size: view.pixel_size, least }
    }

    /// How much of a lamp reaches a point of a surface: 0 to 1. Of `is_of_movers`, shadows of what moves alone count.
    pub fn visibility(&self, lamp: &Lamp, position: DVec3, normal: DVec3, is_of_movers: bool) -> f32 {
        let from_light = position - lamp.position_world;
        let shape = self.shape(lamp);
        let moved = from_light + normal * shape.offset_m(from_light, normal);
        let here = shape.map(moved);
        let filter = self.how.filter;
        let radius = filter.radius() as i32;
        let mut sum = 0.0;
        for y in -radius..=radius {
            for x in -radius..=radius {
                let texel = [here.at.x as i32 + x, here.at.y as i32 + y].map(|t| t.max(0) as u32);
                let ray = Ray::new(lamp.position_world, shape.ray(here.side, texel));
                // What lies before the near plane casts no shadow, and what is looked up there is lit.
                let ray = ray.between(lamp.near_m, here.depth_m / (1.0 + ROUNDING));
                let is_lit = here.depth_m <= lamp.near_m || !self.is_met(&ray, is_of_movers);
                let weight = filter.weight(x.unsigned_abs()) * filter.weight(y.unsigned_abs());
                sum += weight as f32 * f32::from(is_lit);
            }
        }
        sum / (filter.axis_weight() * filter.axis_weight()) as f32
    }

    fn shape(&self, lamp: &Lamp) -> Shape {
        let distance_m = (lamp.position_world - self.eye).length();
        self.how.shape(lamp.reach_m(self.least), distance_m, self.pixel_size)
    }

    fn is_met(&self, ray: &Ray, is_of_movers: bool) -> bool {
        let counts = |hit: &Hit| !is_of_movers || self.surfaces.moves(self.tracer, hit);
        self.tracer.occluded_if(ray, |hit| counts(hit) && self.surfaces.casts_shadow(self.tracer, hit))
    }
}
