//! The truth about area lights: a shadow ray for each of many points of light, surface and fog.

use std::f64::consts::FRAC_PI_2;

use glam::{DVec2, DVec3, Vec3};

use super::AreaLit;
use super::reference::fog_end_m;
use crate::area::{AreaLight, AreaLighting, LightPoint};
use crate::passes::World;
use crate::passes::fog::{Fog, reference::henyey_greenstein};
use crate::passes::gbuffer::Texel;
use crate::sampling::{self, r2};
use crate::surface::Surface;
use crate::trace::Ray;

/// What the lights do to one row's samples, by `vpls` rays to the light from each sample's surface and as many from its
/// fog. Neighbouring pixels ask other points: what is left of noise has no pattern.
pub(crate) fn row(
    world: &World<'_>,
    eye: DVec3,
    fog: Option<&Fog>,
    lighting: &AreaLighting,
    y: u32,
    samples: u32,
    texels: &[Texel],
) -> Vec<AreaLit> {
    let sample = |(i, texel): (usize, &Texel)| {
        let (x, sample) = (i as u32 / samples, i as u32 % samples);
        let mut out = AreaLit::default();
        for (number, light) in (0..).zip(&lighting.lights) {
            let shift = DVec2::new(
                f64::from(sampling::unit(x, y, 8 * sample + 2 * number)),
                f64::from(sampling::unit(x, y, 8 * sample + 2 * number + 1)),
            );
            let truth = Truth { world, eye, fog, light, rays: lighting.vpls, shift };
            out.airlight += truth.airlight(texel);
            if let Some(surface) = &texel.surface {
                truth.add(surface, &mut out);
            }
        }
        out
    };
    texels.iter().enumerate().map(sample).collect()
}

/// One light and one sample.
struct Truth<'t> {
    world: &'t World<'t>,
    eye: DVec3,
    fog: Option<&'t Fog>,
    light: &'t AreaLight,
    rays: u32,
    shift: DVec2,
}

impl Truth<'_> {
    fn point(&self, index: u32) -> LightPoint {
        self.light.point((r2(index) + self.shift).fract(), &self.world.tracer.bounds())
    }

    fn is_lit(&self, ray: &Ray) -> bool {
        let World { tracer, surfaces, .. } = self.world;
        !tracer.occluded_if(ray, |hit| surfaces.casts_shadow(tracer, hit))
    }

    fn clear(&self, way_m: f64) -> f64 {
        self.fog.map_or(1.0, |fog| (-fog.density_per_m * way_m).exp())
    }

    fn add(&self, surface: &Surface, lit: &mut AreaLit) {
        for index in 0..self.rays {
            let point = self.point(index);
            let way = point.position_world - surface.position;
            let r = way.length();
            let towards = way / r;
            let emitted = -point.normal_world.dot(towards);
            let near = towards.as_vec3();
            if emitted <= 0.0 || surface.face_normal.dot(near) <= 0.0 || surface.normal.dot(near) <= 0.0 {
                continue;
            }
            let ray = self.world.leaving(surface.position, surface.face_normal, towards).between(0.0, r * (1.0 - 1e-6));
            if self.is_lit(&ray) {
                let share = emitted * self.clear(r - point.start_m) * point.area_m2 / (r * r) / f64::from(self.rays);
                lit.receive(surface, near, point.radiance * share as f32);
            }
        }
    }

    /// Single scattering, at points of the ray that lie evenly as seen from the light (Kulla and Fajardo 2012, "Importance
    /// Sampling Techniques for Path Tracing in Participating Media").
    fn airlight(&self, texel: &Texel) -> Vec3 {
        let Some(fog) = self.fog else { return Vec3::ZERO };
        let direction = texel.direction.as_dvec3().normalize();
        let end_m = fog_end_m(self.world);
        let end = texel.surface.as_ref().map_or(end_m, |surface| surface.distance.min(end_m));
        let mut sum = Vec3::ZERO;
        for index in 0..self.rays {
            let point = self.point(index);
            let from_eye = point.position_world - self.eye;
            let foot = from_eye.dot(direction);
            let h = (from_eye - direction * foot).length().max(1e-9);
            let (first, last) = ((-foot / h).atan(), ((end - foot) / h).atan());
            // A third number, as even as the two that chose the light's point.
            let share = (0.5 + 0.618_033_988_75 * f64::from(index) + self.shift.x + 3.0 * self.shift.y).fract();
            let theta = (first + (last - first) * share).clamp(-FRAC_PI_2 + 1e-12, FRAC_PI_2 - 1e-12);
            let t = foot + h * theta.tan();
            let way = point.position_world - (self.eye + direction * t);
            let r = way.length();
            let towards = way / r;
            let emitted = -point.normal_world.dot(towards);
            if emitted <= 0.0 {
                continue;
            }
            let ray = Ray::new(self.eye + direction * t, towards).between(0.0, r * (1.0 - 1e-6));
            if self.is_lit(&ray) {
                let phase = henyey_greenstein(fog.anisotropy, direction.dot(towards));
                let clear = self.clear(t + r - point.start_m);
                let weight = fog.density_per_m * phase * emitted * clear * (last - first) / h;
                sum += point.radiance * (weight * point.area_m2 / f64::from(self.rays)) as f32;
            }
        }
        sum
    }
}
