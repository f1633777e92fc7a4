//! Runs the passes and puts a picture together.

use std::sync::atomic::{AtomicUsize, Ordering};

use antumbra_scene::{Camera, Scene};
use glam::Vec3;
use rayon::prelude::*;

use crate::{
    Picture, RenderError, ShadowSource, Tracer,
    camera::View,
    passes::{
        World,
        ambient::{self, Gathered},
        gbuffer,
        shade::{self, reference::Inputs},
        shadow::{self, SunVisibilities},
        tonemap,
    },
    sampling,
};

/// Called as a picture grows, from any thread: steps done and steps in all.
pub type Progress<'a> = &'a (dyn Fn(usize, usize) + Sync);

/// How a picture is made.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderOptions {
    /// Pixels per row, 1 to 16384.
    pub width: u32,
    /// Rows, 1 to 16384.
    pub height: u32,
    /// Rays through each pixel, 1 to 1024.
    pub samples: u32,
    /// Rays per pixel that gather light from the sky and from other surfaces, up to 4096. 0 for plain ambient light
    /// without any occlusion.
    pub ao_samples: u32,
    /// What radiance is multiplied by before tone mapping; `None` to expose for the scene's lights.
    pub exposure: Option<f32>,
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self { width: 1280, height: 720, samples: 4, ao_samples: 12, exposure: None }
    }
}

impl RenderOptions {
    fn check(&self) -> Result<(), RenderError> {
        within("samples", self.samples, 1, 1024)?;
        within("ao_samples", self.ao_samples, 0, 4096)?;
        match self.exposure {
            Some(e) if !(e.is_finite() && e > 0.0) => Err(RenderError::Exposure(e)),
            _ => Ok(()),
        }
    }
}

fn within(name: &'static str, value: u32, least: u32, most: u32) -> Result<(), RenderError> {
    if (least..=most).contains(&value) { Ok(()) } else { Err(RenderError::Samples { name, value, least, most }) }
}

/// A scene, ready to be drawn from anywhere: holds its ray tracer, textures, suns and sky.
pub struct Renderer<'a> {
    world: World<'a>,
}

impl<'a> Renderer<'a> {
    /// Prepares a scene: about a second per million triangles.
    #[must_use]
    pub fn new(scene: &'a Scene) -> Self {
        Self { world: World::new(scene) }
    }

    /// The tracer over all triangles of the scene.
    #[must_use]
    pub fn tracer(&self) -> &Tracer {
        &self.world.tracer
    }

    /// Draws the scene. The same arguments give the same picture to the bit, whatever the number of threads.
    ///
    /// # Errors
    /// [`RenderError`] when the camera or the options make no sense, or the shadows lack a light of the scene.
    pub fn render(
        &self,
        camera: &Camera,
        options: &RenderOptions,
        shadows: ShadowSource<'_>,
        progress: Progress<'_>,
    ) -> Result<Picture, RenderError> {
        options.check()?;
        let view = View::new(camera, options.width, options.height)?;
        let shadows = shadows.visibilities(&self.world)?;
        let job = Job { world: &self.world, view, shadows, options, progress, done: AtomicUsize::new(0) };
        let gathered = job.gather();
        let radiance = job.shade(&gathered);
        Ok(job.develop(&radiance))
    }
}

/// Draws a scene once; see [`Renderer::render`].
///
/// # Errors
/// As [`Renderer::render`].
pub fn render(
    scene: &Scene,
    camera: &Camera,
    options: &RenderOptions,
    shadows: ShadowSource<'_>,
    progress: Progress<'_>,
) -> Result<Picture, RenderError> {
    Renderer::new(scene).render(camera, options, shadows, progress)
}

/// One picture in the making.
struct Job<'a> {
    world: &'a World<'a>,
    view: View,
    shadows: SunVisibilities<'a>,
    options: &'a RenderOptions,
    progress: Progress<'a>,
    done: AtomicUsize,
}

impl Job<'_> {
    fn gather(&self) -> Vec<Gathered> {
        let rays = self.options.ao_samples;
        if rays == 0 {
            return Vec::new();
        }
        let mut gathered = self.rows(|y| {
            let row = ambient::reference::row(self.world, &self.shadows, &self.view, y, rays);
            self.step();
            row
        });
        for step in 0..ambient::smoothing_steps(rays) {
            gathered = self.rows(|y| ambient::reference::smooth_row(&gathered, self.view.width, y, 1 << step));
        }
        gathered
    }

    fn shade(&self, gathered: &[Gathered]) -> Vec<Vec3> {
        self.rows(|y| {
            let texels = gbuffer::reference::row(self.world, &self.view, y, self.options.samples);
            let shadows = shadow::reference::row(self.world, &self.shadows, &texels);
            let inputs = Inputs { texels: &texels, shadows: &shadows, gathered, samples: self.options.samples };
            let row = shade::reference::row(self.world, &self.view, y, &inputs);
            self.step();
            row
        })
    }

    fn develop(&self, radiance: &[Vec3]) -> Picture {
        let exposure = self.options.exposure.unwrap_or_else(|| tonemap::reference::exposure(self.world, radiance));
        Picture {
            width: self.view.width,
            height: self.view.height,
            rgb: self.rows(|y| self.develop_row(radiance, y, exposure)),
            hdr: radiance.iter().map(|c| c.to_array()).collect(),
            exposure,
        }
    }

    fn develop_row(&self, radiance: &[Vec3], y: u32, exposure: f32) -> Vec<u8> {
        let start = (y * self.view.width) as usize;
        let pixel = |x: u32| {
            let dither = sampling::unit(x, y, 0);
            tonemap::reference::pixel(radiance[start + x as usize] * exposure, dither)
        };
        (0..self.view.width).flat_map(pixel).collect()
    }

    /// Runs a pass over all rows of the picture, on all threads.
    fn rows<T: Send>(&self, row: impl Fn(u32) -> Vec<T> + Sync + Send) -> Vec<T> {
        (0..self.view.height).into_par_iter().flat_map_iter(row).collect()
    }

    fn step(&self) {
        let passes = if self.options.ao_samples == 0 { 1 } else { 2 };
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        (self.progress)(done, passes * self.view.height as usize);
    }
}
