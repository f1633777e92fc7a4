//! The renderer's passes, in the order the data flows: what is seen, which sun reaches it, how much of the rest of
//! the world's light does, what that looks like, and what a screen makes of it.
//!
//! Each pass has a folder: its data in `mod.rs`, and `reference.rs`, which computes it on the CPU one row of pixels
//! at a time. Rows depend on nothing but earlier passes, so that any number of threads makes the same picture.

pub(crate) mod ambient;
pub(crate) mod gbuffer;
pub(crate) mod shade;
pub(crate) mod shadow;
pub(crate) mod tonemap;

use antumbra_scene::Scene;
use glam::{DVec3, Vec3};
use std::f32::consts::PI;

use crate::{
    light::{Sky, Sun},
    surface::Surfaces,
    trace::{Ray, Tracer},
};

/// Everything that passes read: the scene, ready to trace and to look up.
pub(crate) struct World<'a> {
    pub tracer: Tracer,
    pub surfaces: Surfaces<'a>,
    pub suns: Vec<Sun>,
    pub sky: Sky,
    /// What white ground in the open reflects of the suns and the sky; under a low sun it is tilted towards it.
    pub outdoors: Vec3,
    /// Length of the scene's diagonal, metres.
    pub diagonal_m: f64,
}

impl<'a> World<'a> {
    pub(crate) fn new(scene: &'a Scene) -> Self {
        let tracer = Tracer::new(scene, |_, _| true);
        let suns = Sun::of_scene(scene);
        let sky = Sky::new(&suns[0]);
        let from_suns: Vec3 = suns.iter().map(|s| s.irradiance * (s.towards_world.y as f32).max(0.35)).sum();
        let outdoors = from_suns / PI + sky.overhead();
        Self { outdoors, diagonal_m: tracer.bounds().diagonal(), tracer, surfaces: Surfaces::new(scene), suns, sky }
    }

    /// A ray that leaves a surface. It starts a little off it: modelled surfaces lie on one another (decals, panes,
    /// doubled walls) more loosely than the tracer computes.
    pub(crate) fn leaving(&self, position: DVec3, face_normal: Vec3, direction: DVec3) -> Ray {
        let offset_m = self.diagonal_m * 1e-6 + position.abs().max_element() * 1e-14;
        Ray::new(position + face_normal.as_dvec3() * offset_m, direction)
    }
}
