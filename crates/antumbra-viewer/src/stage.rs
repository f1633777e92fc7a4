//! A scene with its lights and bake on the graphics card.

use std::sync::Arc;

use antumbra::ShadowFile;
use antumbra_bake::light_space::Resolution;
use antumbra_bake::{BakeOptions, ResolutionRequest};
use antumbra_render::gpu::{Gpu, GpuRenderer, LampLists, Setting};
use antumbra_render::light::LightTracing;
use antumbra_render::{RenderError, Renderer, Time};
use antumbra_scene::{Camera, Light, Scene};
use glam::{DAffine3, DVec3};

use crate::rebuild::Rebuild;
use crate::settings::{Settings, Technique};

/// What is drawn.
pub(crate) struct Stage {
    pub renderer: GpuRenderer,
    pub scene: Arc<Scene>,
    /// The newest bake, and the lights that it is of.
    pub bake: Option<(Arc<ShadowFile>, Vec<Light>)>,
    pub rebuild: Rebuild,
    /// What the card shows now, and what bakes are wanted for.
    lit_by: LitBy,
    wanted: Vec<Light>,
    exposure: f32,
    /// Whether dynamic nodes are not where the scene has them.
    has_walked: bool,
}

/// What decides the light on the card.
#[derive(Clone, Debug, Default, PartialEq)]
struct LitBy {
    time: Option<Time>,
    top_grid: bool,
    is_baked: bool,
    has_area: bool,
    has_lamp_maps: bool,
    virtual_lights: u32,
    /// Directions and names of the lights, and which bake.
    lights: Vec<(String, [u64; 3])>,
    bake: usize,
}

/// Those that are baked.
fn still(lights: &[Light]) -> Vec<Light> {
    lights.iter().filter(|light| !light.dynamic).cloned().collect()
}

fn key(lights: &[Light]) -> Vec<(String, [u64; 3])> {
    lights.iter().map(|light| (light.name.clone(), light.direction_world.to_array().map(f64::to_bits))).collect()
}

impl Stage {
    /// A scene; without a bake its lights are baked in the background.
    pub fn new(
        gpu: &Gpu,
        scene: Scene,
        bake: Option<ShadowFile>,
        resolution: u32,
        settings: &Settings,
    ) -> Result<Self, RenderError> {
        let scene = Arc::new(scene);
        let resolution = Resolution::new(resolution).map_or(ResolutionRequest::Default, ResolutionRequest::Texels);
        let options = BakeOptions { resolution, levels: true, enter_depths: true, ..BakeOptions::default() };
        let rebuild = Rebuild::new(Arc::clone(&scene), options);
        let all = settings.lights(&scene.lights);
        let lights = still(&all);
        if bake.is_none() && !lights.is_empty() {
            rebuild.start(lights.clone());
        }
        let setting = Setting { lights: all, time: settings.time, top_grid: true, ..Setting::default() };
        Ok(Self {
            renderer: GpuRenderer::new(gpu, Arc::clone(&scene), setting)?,
            bake: bake.map(|file| (Arc::new(file), lights.clone())),
            rebuild,
            lit_by: LitBy::default(),
            wanted: lights,
            exposure: 1.0,
            has_walked: false,
            scene,
        })
    }

    /// Draws a frame as the settings say.
    pub fn frame(&mut self, camera: &Camera, size: [u32; 2], settings: &Settings) -> Result<(), RenderError> {
        self.follow(settings)?;
        let file = self.bake.as_ref().map(|(file, _)| Arc::clone(file));
        self.renderer.lamp_lists = if settings.is_clustered { LampLists::Clustered } else { LampLists::Tiled };
        self.renderer.fog = settings.fog();
        self.renderer.area_lights = settings.area.lighting(settings.video_s);
        self.renderer.lamp_maps = settings.lamps.maps(settings.filter()).filter(|_| self.has_lamp_maps(settings));
        self.walk(settings);
        let exposure = self.exposure * settings.exposure_stops.exp2();
        self.renderer.frame(camera, size, settings.samples, settings.lookup(file.as_deref()), exposure)
    }

    /// Whether lamps' maps are drawn: while a bake is still to come lamps wait for that.
    fn has_lamp_maps(&self, settings: &Settings) -> bool {
        let has_baked = self.bake.is_some() || self.wanted.is_empty();
        settings.lamps.is_on
            && match settings.technique {
                Technique::Baked => has_baked,
                Technique::Maps => true,
                Technique::None => false,
            }
    }

    /// Moves what is dynamic: a metre and a half to and fro, each in its own time. A light goes with the node of its name.
    fn walk(&mut self, settings: &Settings) {
        if !settings.is_moving && !self.has_walked {
            return;
        }
        self.has_walked = settings.is_moving;
        for (i, node) in self.scene.nodes.iter().enumerate().filter(|(_, node)| node.dynamic) {
            let phase = settings.video_s + i as f64;
            let by = if settings.is_moving { DVec3::Z * (1.5 * phase.sin()) } else { DVec3::ZERO };
            self.renderer.move_node(i, node.world_from_mesh * DAffine3::from_translation(by));
            let moved = node.world_from_mesh.transform_vector3(by);
            for light in self.scene.lights.iter().filter(|light| light.dynamic && light.name == node.name) {
                self.renderer.move_lamp(&light.name, light.position_world + moved);
            }
        }
    }

    /// Eases the exposure towards what suits the last frame: all the way at once, or by a share.
    pub fn expose(&mut self, share: f32) -> Result<(), RenderError> {
        let suitable = self.renderer.suitable_exposure()?;
        if suitable.is_finite() && suitable > 0.0 {
            self.exposure *= (suitable / self.exposure).powf(share);
        }
        Ok(())
    }

    /// Takes a bake as the scene's own.
    pub fn take_bake(&mut self, file: ShadowFile) {
        self.bake = Some((Arc::new(file), self.wanted.clone()));
    }

    /// Bakes that are done replace older ones; `Err` says why one failed.
    pub fn swap_in(&mut self) -> Result<(), String> {
        match self.rebuild.take() {
            Some(Ok(rebuilt)) => self.bake = Some((Arc::new(rebuilt.file), rebuilt.lights)),
            Some(Err(reason)) => return Err(reason),
            None => {}
        }
        Ok(())
    }

    /// Lights the scene by what is chosen. A sun that was dragged is baked anew, and stays where it was until that is done;
    /// shadow maps follow at once.
    fn follow(&mut self, settings: &Settings) -> Result<(), RenderError> {
        let all = settings.lights(&self.scene.lights);
        let lights = still(&all);
        if key(&lights) != key(&self.wanted) {
            self.wanted.clone_from(&lights);
            self.rebuild.start(lights);
        }
        let (bake, lights) = match &self.bake {
            Some((file, baked)) if settings.technique == Technique::Baked => {
                let moving = all.into_iter().filter(|light| light.dynamic);
                (Some(Arc::clone(file)), baked.iter().cloned().chain(moving).collect())
            }
            _ => (None, all),
        };
        let lit_by = LitBy {
            time: settings.time,
            top_grid: settings.has_top_grid,
            is_baked: bake.is_some(),
            has_area: settings.area.is_on,
            has_lamp_maps: self.has_lamp_maps(settings),
            virtual_lights: settings.lamps.virtual_lights,
            lights: key(&lights),
            bake: bake.as_ref().map_or(0, |file| Arc::as_ptr(file) as usize),
        };
        if lit_by == self.lit_by {
            return Ok(());
        }
        let area = settings.area.lighting(settings.video_s).map_or(Vec::new(), |area| area.lights);
        let suiting = || if area.is_empty() { Time::suiting(&lights) } else { Time::Night };
        let night = settings.time.unwrap_or_else(suiting) == Time::Night;
        let rays = night.then(|| Renderer::new(&self.scene));
        let how = LightTracing { lights: settings.lamps.virtual_lights, ..LightTracing::default() };
        let virtual_lights = match &rays {
            Some(rays) if how.lights > 0 && lit_by.has_lamp_maps => rays.virtual_lights(&how, &area),
            _ => Vec::new(),
        };
        let setting = Setting {
            lights,
            time: settings.time,
            bake,
            top_grid: settings.has_top_grid,
            area: &area,
            rays: rays.as_ref(),
            has_lamp_maps: lit_by.has_lamp_maps,
            virtual_lights: &virtual_lights,
        };
        self.renderer.relight(setting)?;
        self.lit_by = lit_by;
        Ok(())
    }
}
