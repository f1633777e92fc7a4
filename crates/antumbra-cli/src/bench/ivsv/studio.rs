//! One view of a scene in the light of area lights, drawn and timed in all ways.

use std::sync::Arc;

use antumbra_render::area::{AreaLight, AreaLighting, AreaTechnique, VoxelResolution};
use antumbra_render::gpu::{Gpu, GpuRenderer, Lookup, PassTime, Setting};
use antumbra_render::{Fog, Picture, RenderOptions, Renderer, ShadowSource, Time};
use antumbra_scene::{Camera, Scene};
use anyhow::{Result, ensure};

use super::Study;
use crate::progress::Progress;

/// The view, and what it truly looks like.
pub struct Studio {
    gpu: Gpu,
    scene: Arc<Scene>,
    renderer: GpuRenderer,
    camera: Camera,
    options: RenderOptions,
    truth: Picture,
    most_vpls: u32,
    /// Of the truth.
    rays: u32,
    about: String,
}

/// A frame that was drawn and timed.
pub struct Measured {
    times: Vec<PassTime>,
    /// Root mean square of differences to the truth, of 255.
    pub rmse: f64,
}

impl Measured {
    /// Milliseconds of some passes.
    pub fn ms(&self, passes: &[&str]) -> f64 {
        self.times.iter().filter(|time| passes.contains(&time.name)).map(|time| time.ms).sum()
    }
}

/// Frames of which the fastest counts: others were disturbed.
const FRAMES: u32 = 3;

impl Studio {
    /// Opens the card and traces the truth.
    pub fn new(study: &Study, progress: &Progress) -> Result<Self> {
        progress.stage("opening the graphics card");
        let gpu = Gpu::open()?;
        let [width, height] = study.size.unwrap_or(if gpu.is_software() { [256, 144] } else { [1024, 1024] });
        let mut scene = study.scene.clone();
        // All light comes from the area lights.
        scene.lights.clear();
        let scene = Arc::new(scene);
        progress.stage("preparing the scene");
        let rays = Renderer::new(&scene);
        let setting = Setting {
            time: Some(Time::Night),
            area: &study.lights,
            top_grid: true,
            rays: Some(&rays),
            ..Setting::default()
        };
        let renderer = GpuRenderer::new(&gpu, Arc::clone(&scene), setting)?;
        let traced = AreaLighting {
            technique: AreaTechnique::Traced,
            vpls: study.truth,
            ..AreaLighting::new(study.lights.clone())
        };
        let fog = (study.fog > 0.0).then_some(Fog { density_per_m: study.fog, anisotropy: 0.5 });
        let mut options = RenderOptions {
            width,
            height,
            samples: 1,
            ao_samples: 0,
            time: Some(Time::Night),
            fog,
            area: Some(traced),
            ..RenderOptions::default()
        };
        progress.count("tracing the truth", u64::from(height), "rows");
        let step = |done: usize, all: usize| progress.set(done as u64, all as u64);
        let truth = rays.render(&study.camera, &options, ShadowSource::None, &step)?;
        options.exposure = Some(truth.exposure());
        let about = format!("{width} x {height} pixels of {} on {}", study.name, gpu.name());
        drop(rays);
        Ok(Self {
            gpu,
            scene,
            renderer,
            camera: study.camera.clone(),
            options,
            truth,
            most_vpls: study.most_vpls,
            rays: study.truth,
            about,
        })
    }

    /// What is drawn where, for people.
    pub fn about(&self) -> &str {
        &self.about
    }

    pub fn card(&self) -> String {
        self.gpu.name()
    }

    /// Pixels across and down.
    pub fn size(&self) -> [u32; 2] {
        [self.options.width, self.options.height]
    }

    /// The lights with as many VPLs as are asked for, everything else as usual.
    pub fn base(&self, lights: &[AreaLight]) -> AreaLighting {
        AreaLighting { vpls: self.most_vpls, voxels: VoxelResolution::cube(128), ..AreaLighting::new(lights.to_vec()) }
    }

    /// Draws and times a frame.
    pub fn measure(&mut self, how: &AreaLighting) -> Result<Measured> {
        let options = self.with(how.clone(), true);
        let picture = self.renderer.render(&self.camera, &options, Lookup::None)?;
        let times = self.times(&options)?;
        let rmse = rmse(&picture, &self.truth);
        Ok(Measured { times, rmse })
    }

    /// Milliseconds that a gather without fog takes.
    pub fn clear_gather_ms(&mut self, how: &AreaLighting) -> Result<f64> {
        let options = self.with(how.clone(), false);
        let times = self.times(&options)?;
        Ok(times.iter().filter(|time| time.name == "gather").map(|time| time.ms).sum())
    }

    /// A picture, in fog or in clear air.
    pub fn picture(&mut self, how: &AreaLighting, in_fog: bool) -> Result<Picture> {
        let options = self.with(how.clone(), in_fog);
        Ok(self.renderer.render(&self.camera, &options, Lookup::None)?)
    }

    /// The same lights, traced.
    pub fn traced(&self, how: &AreaLighting, in_fog: bool) -> Result<Picture> {
        let traced = AreaLighting { technique: AreaTechnique::Traced, vpls: self.rays, ..how.clone() };
        let options = self.with(traced, in_fog);
        Ok(Renderer::new(&self.scene).render(&self.camera, &options, ShadowSource::None, &|_, _| {})?)
    }

    fn with(&self, how: AreaLighting, in_fog: bool) -> RenderOptions {
        let fog = self.options.fog.filter(|_| in_fog);
        RenderOptions { area: Some(how), fog, ..self.options.clone() }
    }

    /// Times of the passes of a frame, after one that warms up: each pass at its fastest.
    fn times(&mut self, options: &RenderOptions) -> Result<Vec<PassTime>> {
        let mut fastest: Vec<PassTime> = Vec::new();
        for frame in 0..=FRAMES {
            self.renderer.render(&self.camera, options, Lookup::None)?;
            let times = self.renderer.times()?;
            ensure!(!times.is_empty(), "this graphics card has no clock to time passes with");
            match frame {
                0 => {}
                1 => fastest = times,
                _ => fastest.iter_mut().zip(times).for_each(|(known, time)| known.ms = known.ms.min(time.ms)),
            }
        }
        Ok(fastest)
    }
}

/// Root mean square of differences over pixels and colours, of 255.
pub fn rmse(a: &Picture, b: &Picture) -> f64 {
    let squares = a.rgb().iter().zip(b.rgb()).map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2));
    (squares.sum::<f64>() / a.rgb().len().max(1) as f64).sqrt()
}
