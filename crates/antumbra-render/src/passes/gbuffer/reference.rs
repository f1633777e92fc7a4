//! Primary rays, on the CPU.

use glam::DVec2;

use super::Texel;
use crate::{camera::View, passes::World, sampling};

/// The samples of one row of pixels, pixel by pixel.
pub(crate) fn row(world: &World<'_>, view: &View, y: u32, samples: u32) -> Vec<Texel> {
    (0..view.width).flat_map(|x| (0..samples).map(move |s| texel(world, view, x, y, s, samples))).collect()
}

fn texel(world: &World<'_>, view: &View, x: u32, y: u32, sample: u32, samples: u32) -> Texel {
    // The same points in every pixel: edges stay straight.
    let within = sampling::r2(sample);
    let ray = view.ray(DVec2::new(f64::from(x), f64::from(y)) + within);
    // Translucent layers are there or not, sample by sample: each triangle gets its own numbers, and a pixel's
    // samples share them out evenly.
    let unit = |hit: &crate::trace::Hit| {
        let layer = sampling::unit(x, y, world.tracer.number(hit.triangle));
        (layer + sample as f32 / samples as f32).fract()
    };
    let hit = world.tracer.closest_if(&ray, |hit| world.surfaces.is_seen(world.tracer, hit, unit));
    let surface = world.light_surface(&ray, hit.map_or(f64::INFINITY, |hit| hit.t)).or_else(|| {
        let hit = hit?;
        let footprint_m = hit.t * view.pixel_size / f64::from(samples).sqrt();
        Some(world.surfaces.at(world.tracer, &ray, &hit, footprint_m))
    });
    Texel { direction: ray.direction.as_vec3(), surface }
}
