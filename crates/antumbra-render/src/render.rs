//! Runs the passes and puts a picture together.

use std::sync::atomic::{AtomicUsize, Ordering};

use antumbra_scene::{Camera, Light, Scene};
use rayon::prelude::*;

use crate::{
    LampMaps, Picture, RenderError, ShadowSource, Time, Tracer,
    area::{AreaLight, AreaLighting, AreaTechnique},
    camera::View,
    light::{LightTracing, VirtualLight},
    passes::{
        World,
        ambient::{self, Gathered},
        fog::{self, Fog},
        gbuffer, ivsv,
        shade::{
            self,
            reference::{Inputs, Shaded},
        },
        shadow::{self, Shadows},
        tonemap,
    },
    sampling,
    surface::Surfaces,
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
    /// Day or night; `None` for what suits the lights ([`Time::suiting`]).
    pub time: Option<Time>,
    /// Fog in the air, with shafts of sunlight.
    pub fog: Option<Fog>,
    /// Lights with a surface, and how their shadows are found. At night, unless [`RenderOptions::time`] says otherwise.
    pub area: Option<AreaLighting>,
    /// Shadow maps of the lamps that a bake does not hold, and over it of what moves; `None` for rays, or no shadows.
    pub lamp_maps: Option<LampMaps>,
    /// Virtual point lights, which stand for light that surfaces send on: see [`Renderer::virtual_lights`].
    pub virtual_lights: Vec<VirtualLight>,
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self {
            width: 1280,
            height: 720,
            samples: 4,
            ao_samples: 12,
            exposure: None,
            time: None,
            fog: None,
            area: None,
            lamp_maps: None,
            virtual_lights: Vec::new(),
        }
    }
}

impl RenderOptions {
    /// Whether a picture can be made so.
    ///
    /// # Errors
    /// [`RenderError`], which names the option that makes no sense.
    pub fn check(&self) -> Result<(), RenderError> {
        within("samples", self.samples, 1, 1024)?;
        within("ao_samples", self.ao_samples, 0, 4096)?;
        self.fog.map_or(Ok(()), |fog| fog.check())?;
        self.area.as_ref().map_or(Ok(()), AreaLighting::check)?;
        self.lamp_maps.as_ref().map_or(Ok(()), LampMaps::check)?;
        match self.exposure {
            Some(e) if !(e.is_finite() && e > 0.0) => Err(RenderError::Exposure(e)),
            _ => Ok(()),
        }
    }
}

impl RenderOptions {
    /// The time that suits these lights and the area lights: night, if there are any of those.
    #[must_use]
    pub fn suiting(&self, lights: &[Light]) -> Time {
        let has_area = self.area.as_ref().is_some_and(|area| !area.lights.is_empty());
        if has_area { Time::Night } else { Time::suiting(lights) }
    }
}

fn within(name: &'static str, value: u32, least: u32, most: u32) -> Result<(), RenderError> {
    if (least..=most).contains(&value) { Ok(()) } else { Err(RenderError::Samples { name, value, least, most }) }
}

/// A scene, ready to be drawn from anywhere: holds its ray tracer and textures.
pub struct Renderer<'a> {
    scene: &'a Scene,
    tracer: Tracer,
    surfaces: Surfaces<'a>,
}

impl<'a> Renderer<'a> {
    /// Prepares a scene: about a second per million triangles.
    #[must_use]
    pub fn new(scene: &'a Scene) -> Self {
        Self { scene, tracer: Tracer::new(scene, |_, _| true), surfaces: Surfaces::new(scene) }
    }

    /// The tracer over all triangles of the scene.
    #[must_use]
    pub fn tracer(&self) -> &Tracer {
        &self.tracer
    }

    /// Virtual point lights that stand for the light which the scene's surfaces send on: light of its lamps, and of area lights,
    /// is traced along paths (Keller 1997, *Instant radiosity*).
    #[must_use]
    pub fn virtual_lights(&self, how: &LightTracing, area: &[AreaLight]) -> Vec<VirtualLight> {
        how.trace(self.scene, &self.tracer, &self.surfaces, area)
    }

    /// Irradiance of a typical place that lamps and area lights light, by rays from them.
    #[cfg(feature = "gpu")]
    pub(crate) fn lamplit(&self, lamps: &[crate::light::Lamp], area: &[crate::area::AreaLight]) -> Option<f32> {
        crate::passes::lamplit(&self.tracer, &self.surfaces, lamps, area)
    }

    /// Names of the scene's lights that give no light with this source of shadows, because the bake lacks them; in the
    /// scene's order.
    #[must_use]
    pub fn left_dark(&self, shadows: ShadowSource<'_>) -> Vec<&str> {
        self.scene.lights.iter().filter(|light| !shadows.knows(light)).map(|light| light.name.as_str()).collect()
    }

    /// Draws the scene. The same arguments give the same picture to the bit, whatever the number of threads.
    ///
    /// # Errors
    /// [`RenderError`] when the camera or the options make no sense, or the shadows lack all lights of the scene.
    pub fn render(
        &self,
        camera: &Camera,
        options: &RenderOptions,
        shadows: ShadowSource<'_>,
        progress: Progress<'_>,
    ) -> Result<Picture, RenderError> {
        options.check()?;
        let view = View::new(camera, options.width, options.height)?;
        let lights = shadows.known(&self.scene.lights, options.lamp_maps.is_some())?;
        let area = options.area.as_ref().map_or(&[][..], |area| &area.lights);
        let time = options.time.unwrap_or_else(|| options.suiting(&lights));
        let world = World::new(&self.tracer, &self.surfaces, &lights, &options.virtual_lights, area, time);
        let shadows = Shadows::new(&world, shadows, options.lamp_maps.as_ref(), &view);
        let job = Job { world: &world, view, shadows, options, progress, done: AtomicUsize::new(0) };
        let gathered = job.gather();
        let shaded = job.shade(&gathered);
        Ok(job.develop(&shaded))
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
    shadows: Shadows<'a>,
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

    /// What makes the light of area lights, where that is not traced.
    fn area(&self) -> Option<ivsv::reference::Job<'_>> {
        let lighting = self.options.area.as_ref().filter(|area| area.technique != AreaTechnique::Traced)?;
        let Self { world, view, options, .. } = self;
        Some(ivsv::reference::Job { world, view, fog: options.fog.as_ref(), lighting, samples: options.samples })
    }

    fn shade(&self, gathered: &[Gathered]) -> Vec<Shaded> {
        let area = self.area().map(|job| (job.gather(&|| self.step()), job));
        self.rows(|y| {
            let texels = gbuffer::reference::row(self.world, &self.view, y, self.options.samples);
            let beams = shadow::reference::row(self.world, &self.shadows, &texels);
            let veils = match &self.options.fog {
                Some(fog) => fog::reference::row(self.world, &self.shadows, fog, self.view.eye, &texels),
                None => Vec::new(),
            };
            let area = match (&area, &self.options.area) {
                (Some((gathered, job)), _) => job.row(gathered, y, &texels),
                (None, Some(area)) => ivsv::traced::row(
                    self.world,
                    self.view.eye,
                    self.options.fog.as_ref(),
                    area,
                    y,
                    self.options.samples,
                    &texels,
                ),
                (None, None) => Vec::new(),
            };
            let samples = self.options.samples;
            let inputs = Inputs { texels: &texels, beams: &beams, gathered, veils: &veils, area: &area, samples };
            let row = shade::reference::row(self.world, &self.view, y, &inputs);
            self.step();
            row
        })
    }

    fn develop(&self, shaded: &[Shaded]) -> Picture {
        let exposure =
            self.options.exposure.unwrap_or_else(|| tonemap::reference::exposure(&self.world.lighting, shaded));
        Picture {
            width: self.view.width,
            height: self.view.height,
            rgb: self.rows(|y| self.develop_row(shaded, y, exposure)),
            hdr: shaded.iter().map(|s| s.radiance.to_array()).collect(),
            exposure,
        }
    }

    fn develop_row(&self, shaded: &[Shaded], y: u32, exposure: f32) -> Vec<u8> {
        let start = (y * self.view.width) as usize;
        let pixel = |x: u32| {
            let dither = sampling::unit(x, y, 0);
            tonemap::reference::pixel(shaded[start + x as usize].radiance * exposure, dither)
        };
        (0..self.view.width).flat_map(pixel).collect()
    }

    /// Runs a pass over all rows of the picture, on all threads.
    fn rows<T: Send>(&self, row: impl Fn(u32) -> Vec<T> + Sync + Send) -> Vec<T> {
        (0..self.view.height).into_par_iter().flat_map_iter(row).collect()
    }

    fn step(&self) {
        let of_area = self.area().map_or(0, |job| job.rows());
        let passes = if self.options.ao_samples == 0 { 1 } else { 2 };
        let done = self.done.fetch_add(1, Ordering::Relaxed) + 1;
        (self.progress)(done, passes * self.view.height as usize + of_area);
    }
}
