//! Fog, on the CPU.

use glam::{DVec3, Vec3};
use std::f64::consts::PI;

use super::{Fog, Veil};
use crate::passes::{World, gbuffer::Texel, shadow::Shadows};

/// The fog before one row's samples.
pub(crate) fn row(world: &World<'_>, shadows: &Shadows<'_>, fog: &Fog, eye: DVec3, texels: &[Texel]) -> Vec<Veil> {
    texels.iter().map(|texel| veil(world, shadows, fog, eye, texel)).collect()
}

fn veil(world: &World<'_>, shadows: &Shadows<'_>, fog: &Fog, eye: DVec3, texel: &Texel) -> Veil {
    let direction = texel.direction.as_dvec3();
    // Behind the scene there is none.
    let end_m = world.lighting.diagonal_m;
    let distance = texel.surface.as_ref().map_or(end_m, |surface| surface.distance.min(end_m));
    let optical_depth = fog.density_per_m * distance;
    let clear = (-optical_depth).exp();
    // The sky lights fog from all sides.
    let mut light = world.lighting.sky.overhead() * (1.0 - clear) as f32;
    for (index, sun) in world.lighting.suns.iter().enumerate() {
        let lit = shadows.through_fog(index, eye, eye + direction * distance, optical_depth);
        let phase = henyey_greenstein(fog.anisotropy, direction.dot(sun.towards_world));
        light += sun.irradiance * (phase * lit) as f32;
    }
    Veil { light: if optical_depth > 0.0 { light } else { Vec3::ZERO }, clear: clear as f32 }
}

/// Henyey, Greenstein (1941): share of scattered light per steradian that turns by an angle.
pub(crate) fn henyey_greenstein(g: f64, cos: f64) -> f64 {
    (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * cos).powf(1.5))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_scattered_adds_up_to_one() {
        for g in [-0.3, 0.0, 0.5, 0.8] {
            let n = 20_000;
            let ring = |i: i32| henyey_greenstein(g, 2.0 * (f64::from(i) + 0.5) / f64::from(n) - 1.0);
            let sum: f64 = (0..n).map(ring).sum::<f64>() * 4.0 * PI / f64::from(n);
            assert!((sum - 1.0).abs() < 1e-6, "{g}: {sum}");
        }
    }
}
