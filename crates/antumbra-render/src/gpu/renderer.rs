//! Runs the passes on the graphics card.

use std::sync::Arc;

use antumbra::{Filter, Kernel as FilterKernel, LightShadow, Prefilter, ShadowFile};
use antumbra_scene::{Bounds, Camera, Light, Node, Scene};
use glam::{DAffine3, DVec2, DVec3, Vec3};

use super::area::{Area, Sample, Seen};
use super::baked::Baked;
use super::blit::Blit;
use super::csm::Maps;
use super::frame::{Frame, GpuLamp, SunLight, four};
use super::lamp_maps::{Chosen, Mapper, Stage, chosen};
use super::passes::{Lookups, Passes, Raster, Way};
use super::scene::SceneBuffers;
use super::targets::Targets;
use super::timing::{PassTime, Recorder, Timer};
use super::{Gpu, Kernel};
use crate::area::{AreaLight, AreaLighting, AreaTechnique};
use crate::camera::View;
use crate::light::Lamp;
use crate::light::VirtualLight;
use crate::passes::csm::Casters;
use crate::passes::shade::reference::Shaded;
use crate::passes::tonemap;
use crate::passes::{Lighting, baked_light};
use crate::render::RenderOptions;
use crate::sampling::r2;
use crate::{Cascades, Fog, LampMaps, MapFilter, Picture, RenderError, Renderer, ShadowSource, Time};

/// How lamps are found that may reach a pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LampLists {
    /// For each tile of 8 x 8 pixels, those whose light touches the box about what it shows.
    #[default]
    Tiled,
    /// For each tile of 64 x 64 pixels and each of 24 layers of depth, whatever there is to see.
    Clustered,
}

/// How a picture's shadows are looked up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lookup {
    /// Not at all: everything is lit.
    None,
    /// Filtered by so many taps.
    Filter(Filter),
    /// Averaged over what a pixel covers.
    Prefiltered(Prefilter),
    /// In cascaded shadow maps of everything, drawn anew for each frame; lamps are not shadowed, but by a bake's filter.
    Maps(Cascades, MapFilter),
    /// With penumbrae of a sun whose radius is seen under an angle of this tangent; lamps by the filter.
    Penumbra(f64, Filter),
}

/// A scene on the graphics card, ready to be drawn from anywhere in the light of one time.
#[derive(Debug)]
pub struct GpuRenderer {
    gpu: Gpu,
    scene: Arc<Scene>,
    buffers: SceneBuffers,
    passes: Passes,
    lit: Lit,
    frame: wgpu::Buffer,
    targets: Option<Targets>,
    lists: Option<Lists>,
    timer: Timer,
    blit: Option<Blit>,
    maps: Maps,
    bounds: Bounds,
    /// How lamps are found.
    pub lamp_lists: LampLists,
    /// Fog in the air.
    pub fog: Option<Fog>,
    /// Lights with a surface, and how their shadows are found; traced ones are drawn without.
    pub area_lights: Option<AreaLighting>,
    pub(super) area: Option<Area>,
    /// Shadow maps of the lamps that the bake lacks, and over it of what moves; without them those lamps cast no shadows.
    pub lamp_maps: Option<LampMaps>,
    pub(super) mapper: Option<Mapper>,
    /// The scene's, where they are now.
    nodes: Vec<Node>,
}

/// The light of a scene, and its shadows, on the card.
#[derive(Debug)]
struct Lit {
    lighting: Lighting,
    bake: Option<Arc<ShadowFile>>,
    baked: Baked,
    /// Programs by the way shadows are looked up: each made when it is first needed.
    lookups: Vec<(Way, Lookups)>,
    /// By lamp: its number among the baked lights, if it is one of them.
    numbers: Vec<Option<u32>>,
    suns: wgpu::Buffer,
    sky: wgpu::Buffer,
    lamps: wgpu::Buffer,
}

/// Lists of lamps for one size of picture.
#[derive(Debug)]
struct Lists {
    /// What they are for: size, tile, layers, words of a list.
    of: ([u32; 2], u32, u32, u32),
    boxes: wgpu::Buffer,
    lists: wgpu::Buffer,
    count: u32,
}

const CLUSTER_TILE: u32 = 64;
const CLUSTER_LAYERS: u32 = 24;

impl Lit {
    fn new(gpu: &Gpu, lighting: Lighting, bake: Option<Arc<ShadowFile>>, top_grid: bool) -> Result<Self, RenderError> {
        let baked = match &bake {
            Some(file) => Baked::new(gpu, file, &baked_lights(&lighting, file), top_grid)?,
            None => Baked::none(gpu),
        };
        let suns: Vec<SunLight> = lighting.suns.iter().map(SunLight::new).collect();
        let sky: Vec<[f32; 4]> = lighting.sky.radiance.iter().map(|radiance| four(*radiance)).collect();
        let lamps = lighting.lamps.all().len();
        Ok(Self {
            lookups: Vec::new(),
            numbers: numbers(&lighting, bake.as_deref()),
            suns: gpu.buffer("suns", &suns),
            sky: gpu.buffer("sky", &sky),
            lamps: gpu.zeros("lamps", (lamps * size_of::<GpuLamp>()) as u64),
            lighting,
            bake,
            baked,
        })
    }

    /// Makes the programs of a way, unless they are there.
    fn prepare(&mut self, gpu: &Gpu, way: Way) {
        if !self.lookups.iter().any(|(known, _)| *known == way) {
            self.lookups.push((way, Lookups::new(gpu, &self.baked.lookups, &self.baked.slots, way)));
        }
    }

    /// Moves the reference point of lamps and baked lights to the eye.
    fn see_from(&self, gpu: &Gpu, eye: DVec3, is_mapped: &[bool]) {
        if let Some(file) = &self.bake {
            self.baked.see_from(gpu, file, eye);
        }
        let least = self.lighting.lamps.least;
        let lamps = self.lighting.lamps.all().iter().zip(&self.numbers).zip(is_mapped);
        let lamps: Vec<_> =
            lamps.map(|((lamp, light), is_mapped)| GpuLamp::new(lamp, eye, *light, least, *is_mapped)).collect();
        if !lamps.is_empty() {
            gpu.queue.write_buffer(&self.lamps, 0, bytemuck::cast_slice(&lamps));
        }
    }
}

/// What lights a picture, and casts shadows in it.
#[derive(Clone, Default)]
pub struct Setting<'r> {
    /// The lights; those that the bake lacks stay dark, but for lamps with maps.
    pub lights: Vec<Light>,
    /// Day or night; `None` for what suits the lights.
    pub time: Option<Time>,
    /// Lights with a surface: how bright they make the scene. See [`GpuRenderer::area_lights`].
    pub area: &'r [AreaLight],
    /// The bake, if there is one.
    pub bake: Option<Arc<ShadowFile>>,
    /// Whether lamps that the bake lacks are lit: their shadows are in maps ([`GpuRenderer::lamp_maps`]).
    pub has_lamp_maps: bool,
    /// Virtual point lights: see [`Renderer::virtual_lights`].
    pub virtual_lights: &'r [VirtualLight],
    /// Whether lookups begin at the top grid: faster, the same answers.
    pub top_grid: bool,
    /// Asked for rays at night, to see how bright lamps make the scene; without it that is a guess.
    pub rays: Option<&'r Renderer<'r>>,
}

impl GpuRenderer {
    /// Brings a scene to the card and lights it.
    ///
    /// # Errors
    /// [`RenderError`] when something does not fit the card, or the bake lacks all of the lights.
    pub fn new(gpu: &Gpu, scene: Arc<Scene>, setting: Setting<'_>) -> Result<Self, RenderError> {
        Ok(Self {
            buffers: SceneBuffers::new(gpu, &scene)?,
            passes: Passes::new(gpu),
            lit: lit(gpu, &scene, setting)?,
            frame: gpu.zeros("frame", size_of::<Frame>() as u64),
            targets: None,
            lists: None,
            timer: Timer::new(gpu),
            blit: None,
            maps: Maps::none(gpu),
            bounds: scene.bounds(|_| true),
            lamp_lists: LampLists::default(),
            fog: None,
            area_lights: None,
            area: None,
            lamp_maps: None,
            mapper: None,
            nodes: scene.nodes.clone(),
            gpu: gpu.clone(),
            scene,
        })
    }

    /// Lights the scene anew, with another bake for instance. When it fails all stays as it was.
    ///
    /// # Errors
    /// As [`GpuRenderer::new`].
    pub fn relight(&mut self, setting: Setting<'_>) -> Result<(), RenderError> {
        self.lit = lit(&self.gpu, &self.scene, setting)?;
        self.lists = None;
        self.mapper.iter_mut().for_each(Mapper::forget);
        Ok(())
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// The graphics card.
    #[must_use]
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// Draws one frame of so many samples per pixel into the screen buffer, without waiting for it: for windows.
    ///
    /// # Errors
    /// [`RenderError`] when the camera or the size make no sense.
    pub fn frame(
        &mut self,
        camera: &Camera,
        size: [u32; 2],
        samples: u32,
        lookup: Lookup,
        exposure: f32,
    ) -> Result<(), RenderError> {
        let view = View::new(camera, size[0], size[1])?;
        self.light(&view, samples.max(1), lookup)?;
        self.develop(&view, samples.max(1), exposure);
        Ok(())
    }

    /// Waits for the last frame and says which exposure suits it; 1 before the first.
    ///
    /// # Errors
    /// [`RenderError::GpuLost`].
    pub fn suitable_exposure(&mut self) -> Result<f32, RenderError> {
        let Some(targets) = &self.targets else { return Ok(1.0) };
        let samples = self.gpu.zeros("meter", 16 * 64 * 36);
        let buffers = [&self.frame, &targets.hdr, &samples].map(|b| b.as_entire_binding());
        let group = self.gpu.group(&self.passes.meter.layouts[0], &buffers);
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        self.passes.meter.run(&mut encoder, None, &[&group], [8, 5, 1]);
        self.gpu.queue.submit([encoder.finish()]);
        let seen: Vec<[f32; 4]> = self.gpu.read(&samples)?;
        Ok(tonemap::reference::exposure(&self.lit.lighting, &shaded(seen, 1.0)))
    }

    /// Records a copy of the screen buffer to a window's texture of the same size.
    pub fn blit(&mut self, encoder: &mut wgpu::CommandEncoder, to: &wgpu::TextureView, format: wgpu::TextureFormat) {
        let Some(targets) = &self.targets else { return };
        let blit = match self.blit.take().filter(|blit| blit.format == format) {
            Some(blit) => blit,
            None => Blit::new(&self.gpu, format),
        };
        blit.run(&self.gpu, encoder, [&self.frame, &targets.screen], to);
        self.blit = Some(blit);
    }

    /// Draws the scene, as [`Renderer::render`] does without gathered light (`ao_samples` of 0).
    ///
    /// # Errors
    /// [`RenderError`] when the camera or the options make no sense or ask for traced area lights, or the card is lost.
    pub fn render(&mut self, camera: &Camera, options: &RenderOptions, lookup: Lookup) -> Result<Picture, RenderError> {
        options.check()?;
        if options.area.as_ref().is_some_and(|area| area.technique == AreaTechnique::Traced) {
            return Err(RenderError::AreaLight("the processor alone traces area lights".to_owned()));
        }
        self.fog = options.fog;
        self.area_lights.clone_from(&options.area);
        self.lamp_maps.clone_from(&options.lamp_maps);
        let view = View::new(camera, options.width, options.height)?;
        self.light(&view, options.samples, lookup)?;
        let exposure = match options.exposure {
            Some(exposure) => exposure,
            None => tonemap::reference::exposure(&self.lit.lighting, &self.shaded(options.samples)?),
        };
        self.develop(&view, options.samples, exposure);
        self.picture(options.samples, exposure)
    }

    /// Renders a camera's view into the HDR buffer; nothing is read back.
    pub(crate) fn light(&mut self, view: &View, samples: u32, lookup: Lookup) -> Result<(), RenderError> {
        self.timer.begin_frame();
        self.buffers.place(&self.gpu, &self.nodes, view.eye);
        self.lit.see_from(&self.gpu, view.eye, &self.is_mapped(view));
        for sample in 0..samples {
            let mut frame = Frame::new(view, &self.lit.lighting, sample, samples, r2(sample));
            set_lookup(&mut frame, lookup);
            if let Some(fog) = self.fog {
                frame.fog_per_m = fog.density_per_m as f32;
                frame.fog_anisotropy = fog.anisotropy as f32;
            }
            frame.fog_end_m = self.lit.lighting.diagonal_m as f32;
            frame.area_lights = self.area_lights.as_ref().map_or(0, |how| how.lights.len() as u32);
            self.set_lists(&mut frame);
            if !self.targets.as_ref().is_some_and(|targets| targets.suit(&frame)) {
                self.targets = Some(Targets::new(&self.gpu, &frame));
            }
            let maps = self.choose_maps(lookup);
            frame.cascades = maps.map_or(0, |(cascades, _)| cascades.count);
            let way = Way { shadow: code(lookup), has_maps: maps.is_some() };
            self.lit.prepare(&self.gpu, way);
            if frame.area_lights > 0 && sample == 0 {
                self.begin_area(view, &frame)?;
            }
            if sample == 0 {
                self.begin_mapper(view, way)?;
            }
            self.gpu.queue.write_buffer(&self.frame, 0, bytemuck::bytes_of(&frame));
            let mut timer = std::mem::replace(&mut self.timer, Timer::off());
            let mut mapper = self.mapper.take();
            let mut recorder = Recorder::new(&self.gpu, &mut timer);
            if let Some((_, casters)) = maps.filter(|_| sample == 0) {
                self.draw_maps(&mut recorder, view, casters);
            }
            self.draw(&mut recorder, &frame, way);
            if let Some(mapper) = &mut mapper {
                self.draw_mapped(&mut recorder, mapper, view, way);
            }
            recorder.submit();
            (self.timer, self.mapper) = (timer, mapper);
        }
        Ok(())
    }

    /// By lamp: whether its shadows come from a map.
    fn is_mapped(&self, view: &View) -> Vec<bool> {
        let mut is_mapped = vec![false; self.lit.numbers.len()];
        self.chosen(view).iter().for_each(|own| is_mapped[own.index as usize] = true);
        is_mapped
    }

    /// The lamps that maps are drawn of.
    fn chosen(&self, view: &View) -> Vec<Chosen<'_>> {
        let Some(how) = &self.lamp_maps else { return Vec::new() };
        let Lit { lighting, numbers, .. } = &self.lit;
        chosen(lighting.lamps.all(), |lamp| numbers[lamp].is_some(), lighting.lamps.least, &self.buffers, (how, view))
    }

    /// Gets ready for lamps' maps, as a view sees them.
    fn begin_mapper(&mut self, view: &View, way: Way) -> Result<(), RenderError> {
        let count = self.chosen(view).len();
        let Some(how) = self.lamp_maps.as_ref().filter(|_| count > 0) else { return Ok(()) };
        if !self.mapper.as_mut().is_some_and(|mapper| mapper.turn_to(how)) {
            self.mapper = None;
            self.mapper = Some(Mapper::new(&self.gpu, how, &self.buffers, &self.bounds)?);
        }
        let mut mapper = self.mapper.take();
        let result = match (&mut mapper, self.stage(view, way)) {
            (Some(mapper), Some(stage)) => mapper.begin(&stage, count),
            _ => Ok(()),
        };
        self.mapper = mapper;
        result
    }

    /// What lamps' maps are drawn with; `None` without lamps.
    fn stage<'s>(&'s self, view: &'s View, way: Way) -> Option<Stage<'s>> {
        let Self { gpu, buffers, frame, targets, lists, lit, .. } = self;
        let (baked, lamps) = (&lit.baked, &lit.lamps);
        let (targets, lists) = (targets.as_ref()?, &lists.as_ref()?.lists);
        Some(Stage { gpu, view, scene: buffers, frame, targets, way, baked, lamps, lists })
    }

    /// Records a sample's light of the lamps that have maps.
    fn draw_mapped(&self, recorder: &mut Recorder<'_>, mapper: &mut Mapper, view: &View, way: Way) {
        let chosen = self.chosen(view);
        if let Some(stage) = self.stage(view, way).filter(|_| !chosen.is_empty()) {
            mapper.draw(recorder, &stage, &chosen);
        }
    }

    /// Triangles drawn into all lamps' maps in the last sample, a triangle of several sides as often.
    ///
    /// # Errors
    /// [`RenderError::GpuLost`].
    pub fn map_triangles(&self) -> Result<u64, RenderError> {
        self.mapper.as_ref().map_or(Ok(0), |mapper| mapper.triangles(&self.gpu))
    }

    /// Gets ready for area lights, as a view sees them.
    fn begin_area(&mut self, view: &View, frame: &Frame) -> Result<(), RenderError> {
        let Some(how) = &self.area_lights else { return Ok(()) };
        let area = self.area.get_or_insert_with(|| Area::new(&self.gpu, &self.scene));
        let fog_end_m = self.lit.lighting.diagonal_m;
        let seen = Seen { view, bounds: &self.bounds, nodes: &self.nodes, fog_end_m };
        area.begin(&self.gpu, how, frame, &seen)
    }

    /// Moves a node of the scene: from the next frame on it is drawn and casts area lights' shadows where it is then.
    /// Baked shadows move only with nodes that are dynamic.
    pub fn move_node(&mut self, node: usize, world_from_mesh: DAffine3) {
        if let Some(moved) = self.nodes.get_mut(node) {
            if moved.world_from_mesh == world_from_mesh {
                return;
            }
            moved.world_from_mesh = world_from_mesh;
            for boxes in self.buffers.moved(&self.scene, node, moved) {
                self.mapper.iter_mut().for_each(|mapper| mapper.moved(boxes));
            }
        }
    }

    /// Moves a spot or point light by its name: from the next frame on it shines from there. A baked one has baked shadows no more.
    pub fn move_lamp(&mut self, name: &str, position_world: DVec3) {
        let Lit { lighting, numbers, .. } = &mut self.lit;
        let Some(index) = lighting.lamps.all().iter().position(|lamp| lamp.name == name && !lamp.is_virtual()) else {
            return;
        };
        if lighting.lamps.all()[index].position_world != position_world {
            lighting.lamps.move_to(index, position_world);
            numbers[index] = None;
        }
    }

    /// Tone maps the HDR buffer into the screen buffer.
    pub(crate) fn develop(&mut self, view: &View, samples: u32, exposure: f32) {
        let frame = Frame { exposure, ..Frame::new(view, &self.lit.lighting, 0, samples, DVec2::ZERO) };
        self.gpu.queue.write_buffer(&self.frame, 0, bytemuck::bytes_of(&frame));
        let Some(targets) = &self.targets else { return };
        let mut recorder = Recorder::new(&self.gpu, &mut self.timer);
        let buffers = [&self.frame, &targets.hdr, &targets.screen];
        run(&self.gpu, &mut recorder, &self.passes.tonemap, "tone mapping", &buffers, &[], frame.size);
        recorder.submit();
    }

    /// Chooses the lamps' lists, and makes room for them.
    fn set_lists(&mut self, frame: &mut Frame) {
        (frame.tile, frame.layers) = match self.lamp_lists {
            LampLists::Tiled => (8, 0),
            LampLists::Clustered => (CLUSTER_TILE, CLUSTER_LAYERS),
        };
        // Layers grow from a hundredth of the scene's size to all of it.
        frame.first_layer_m = (self.lit.lighting.diagonal_m * 0.002).max(0.5) as f32;
        frame.layer_ratio = 1.4;
        frame.tiles_x = frame.size[0].div_ceil(frame.tile);
        let of = (frame.size, frame.tile, frame.layers, frame.list_words);
        if frame.lamps == 0 || self.lists.as_ref().is_some_and(|lists| lists.of == of) {
            return;
        }
        let count = frame.tiles_x * frame.size[1].div_ceil(frame.tile) * frame.layers.max(1);
        self.lists = Some(Lists {
            of,
            boxes: self.gpu.zeros("boxes", 32 * u64::from(count)),
            lists: self.gpu.zeros("light lists", 4 * u64::from(count) * u64::from(frame.list_words)),
            count,
        });
    }

    /// Which maps a lookup needs, with room for them: of everything, or of what moves.
    fn choose_maps(&mut self, lookup: Lookup) -> Option<(Cascades, Casters)> {
        let suns = self.lit.lighting.suns.len();
        let moves = || self.buffers.parts.iter().any(|part| part.is_dynamic);
        let (cascades, casters) = match lookup {
            _ if suns == 0 => return None,
            Lookup::Maps(cascades, _) => (cascades, Casters::All),
            Lookup::None => return None,
            _ if moves() => (Cascades::for_dynamic(), Casters::Dynamic),
            _ => return None,
        };
        if !self.maps.suit(&cascades, suns) {
            self.maps = Maps::new(&self.gpu, cascades, suns);
        }
        Some((cascades, casters))
    }

    fn draw_maps(&self, recorder: &mut Recorder<'_>, view: &View, casters: Casters) {
        let Self { gpu, passes, buffers, frame, lit, bounds, .. } = self;
        let seen = (view, &lit.lighting.suns[..], bounds);
        self.maps.draw(gpu, recorder, &passes.shadow_map, buffers, frame, casters, seen);
    }

    /// Records one sample.
    fn draw(&self, recorder: &mut Recorder<'_>, values: &Frame, way: Way) {
        let Self { gpu, passes, buffers, targets, lists, lit, maps, frame, .. } = self;
        let Lit { baked, lookups, suns, sky, lamps, .. } = lit;
        let lookups = lookups.iter().find(|(known, _)| *known == way);
        let (Some(targets), Some((_, lookups))) = (targets, lookups) else { return };
        let Targets { gbuffer, sunlit, hdr, counts, veils, size, .. } = targets;
        raster(gpu, recorder, &passes.raster, buffers, frame, targets);
        let geometry = gpu.group(&passes.resolve.layouts[0], &buffers.resources(frame));
        let seen = [wgpu::BindingResource::TextureView(&targets.visible_part), gbuffer.as_entire_binding()];
        let seen = gpu.group(&passes.resolve.layouts[1], &seen);
        recorder.compute("resolve", &passes.resolve, &[&geometry, &seen], tiles(*size));
        let by_area = self.area_lights.as_ref().zip(self.area.as_ref()).filter(|_| values.area_lights > 0);
        if let Some((how, area)) = by_area {
            let sample = Sample { gpu, how, frame: values, frame_buffer: frame, targets, scene: buffers };
            area.show(recorder, &sample);
            area.light(recorder, &sample);
        }
        let (baked, maps) = (baked.resources(), maps.resources());
        if values.fog_per_m > 0.0 {
            let own = [frame, gbuffer, suns, veils];
            run(gpu, recorder, &lookups.fog, "fog", &own, &[&baked, &maps], *size);
        }
        if values.suns > 0 {
            let own = [frame, gbuffer, suns, sunlit];
            run(gpu, recorder, &lookups.sun, "sun shadows", &own, &[&baked, &maps], *size);
        }
        let own = [frame, gbuffer, sky, suns, sunlit, hdr, veils, &targets.area];
        run(gpu, recorder, &passes.shade, "shading", &own, &[], *size);
        let Some(lists) = lists.as_ref().filter(|_| values.lamps > 0) else { return };
        if values.layers == 0 {
            run(gpu, recorder, &passes.boxes, "tile boxes", &[frame, gbuffer, &lists.boxes], &[], *size);
        } else {
            let group = gpu.group(&passes.clusters.layouts[0], &[frame, &lists.boxes].map(|b| b.as_entire_binding()));
            recorder.compute("tile boxes", &passes.clusters, &[&group], [lists.count.div_ceil(64), 1, 1]);
        }
        let own = [frame, lamps, &lists.boxes, &lists.lists].map(|b| b.as_entire_binding());
        let group = gpu.group(&passes.lists.layouts[0], &own);
        let groups = (lists.count * values.list_words).div_ceil(64);
        let rows = groups.div_ceil(MOST_GROUPS);
        recorder.compute("light lists", &passes.lists, &[&group], [groups.div_ceil(rows), rows, 1]);
        let own = [frame, gbuffer, lamps, &lists.lists, hdr, counts, veils];
        run(gpu, recorder, &lookups.lamps, "lamps", &own, &[&baked], *size);
    }

    /// Waits for the last frame and says how long its passes took: empty where the card has no clock.
    ///
    /// # Errors
    /// [`RenderError::GpuLost`].
    pub fn times(&self) -> Result<Vec<PassTime>, RenderError> {
        self.timer.read(&self.gpu)
    }

    /// How many lamps each pixel's shading looked at in the last frame; empty before the first.
    ///
    /// # Errors
    /// [`RenderError::GpuLost`].
    pub fn lamps_per_pixel(&self) -> Result<Vec<u32>, RenderError> {
        self.targets.as_ref().map_or(Ok(Vec::new()), |targets| self.gpu.read(&targets.counts))
    }

    /// Bytes of the bake on the card.
    #[must_use]
    pub fn baked_bytes(&self) -> u64 {
        self.lit.baked.bytes()
    }

    fn shaded(&self, samples: u32) -> Result<Vec<Shaded>, RenderError> {
        let Some(targets) = &self.targets else { return Ok(Vec::new()) };
        Ok(shaded(self.gpu.read(&targets.hdr)?, 1.0 / samples as f32))
    }

    fn picture(&self, samples: u32, exposure: f32) -> Result<Picture, RenderError> {
        let Some(targets) = &self.targets else { return Err(RenderError::GpuLost) };
        let screen: Vec<[u8; 4]> = self.gpu.read(&targets.screen)?;
        Ok(Picture {
            width: targets.size[0],
            height: targets.size[1],
            rgb: screen.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect(),
            hdr: self.shaded(samples)?.iter().map(|s| s.radiance.to_array()).collect(),
            exposure,
        })
    }
}

/// A scene's lights, those of them whose shadows are known.
fn lit(gpu: &Gpu, scene: &Scene, setting: Setting<'_>) -> Result<Lit, RenderError> {
    let Setting { lights, time, area, bake, has_lamp_maps, virtual_lights, top_grid, rays } = setting;
    let known = bake.as_deref().map_or(ShadowSource::None, ShadowSource::of_file).known(&lights, has_lamp_maps)?;
    let suiting = || if area.is_empty() { Time::suiting(&known) } else { Time::Night };
    let time = time.unwrap_or_else(suiting);
    let diagonal_m = scene.bounds(|_| true).diagonal();
    let lighting = Lighting::new(&known, virtual_lights, time, diagonal_m, |lamps| rays?.lamplit(lamps, area));
    Lit::new(gpu, lighting, bake, top_grid)
}

/// The HDR buffer's contents, times a share.
fn shaded(hdr: Vec<[f32; 4]>, share: f32) -> Vec<Shaded> {
    let one = |[r, g, b, metered]: [f32; 4]| Shaded { radiance: Vec3::new(r, g, b) * share, metered: metered * share };
    hdr.into_iter().map(one).collect()
}

/// Most workgroups to a side of a dispatch that every card takes.
const MOST_GROUPS: u32 = 65535;

/// Workgroups of 8 x 8 pixels.
fn tiles([width, height]: [u32; 2]) -> [u32; 3] {
    [width.div_ceil(8), height.div_ceil(8), 1]
}

/// Records a pass over all pixels: its own buffers, then those of further groups.
fn run(
    gpu: &Gpu,
    recorder: &mut Recorder<'_>,
    kernel: &Kernel,
    name: &'static str,
    own: &[&wgpu::Buffer],
    others: &[&[wgpu::BindingResource<'_>]],
    size: [u32; 2],
) {
    let own: Vec<_> = own.iter().map(|buffer| buffer.as_entire_binding()).collect();
    let resources = std::iter::once(&own[..]).chain(others.iter().copied());
    let groups: Vec<_> =
        kernel.layouts.iter().zip(resources).map(|(layout, resources)| gpu.group(layout, resources)).collect();
    recorder.compute(name, kernel, &groups.iter().collect::<Vec<_>>(), tiles(size));
}

fn raster(
    gpu: &Gpu,
    recorder: &mut Recorder<'_>,
    raster: &Raster,
    buffers: &SceneBuffers,
    frame: &wgpu::Buffer,
    targets: &Targets,
) {
    let group = gpu.group(&raster.layout, &buffers.resources(frame));
    recorder.draw("raster", Some(&targets.visible_part), (&targets.depth, wgpu::LoadOp::Clear(0.0)), |pass| {
        pass.set_bind_group(0, &group, &[]);
        for (pipeline, cut_out) in [(&raster.opaque, false), (&raster.cut_out, true)] {
            pass.set_pipeline(pipeline);
            for (part, drawn) in (0..).zip(&buffers.parts) {
                if drawn.is_cut_out == cut_out && drawn.vertices > 0 {
                    pass.draw(0..drawn.vertices, part..part + 1);
                }
            }
        }
    });
}

/// The way a lookup goes: see [`Way`].
fn code(lookup: Lookup) -> u32 {
    match lookup {
        Lookup::None => 0,
        Lookup::Filter(_) => 1,
        Lookup::Prefiltered(Prefilter::Mean) => 2,
        Lookup::Prefiltered(Prefilter::Levels(_)) => 3,
        Lookup::Penumbra(..) => 4,
        Lookup::Maps(..) => 5,
    }
}

fn set_lookup(frame: &mut Frame, lookup: Lookup) {
    if let Lookup::Penumbra(tangent, _) = lookup {
        frame.sun_tangent = tangent as f32;
    }
    let filter = match lookup {
        Lookup::Filter(filter)
        | Lookup::Prefiltered(Prefilter::Levels(filter))
        | Lookup::Penumbra(_, filter)
        | Lookup::Maps(_, MapFilter::Taps(filter)) => filter,
        Lookup::None | Lookup::Prefiltered(Prefilter::Mean) | Lookup::Maps(_, MapFilter::Bilinear) => Filter::default(),
    };
    frame.radius = filter.radius();
    frame.kernel = match filter.kernel() {
        _ if matches!(lookup, Lookup::Maps(_, MapFilter::Bilinear)) => 2,
        FilterKernel::Tent => 1,
        FilterKernel::Continuous => 3,
        FilterKernel::Box => 0,
    };
}

/// By lamp, its number among the baked lights ([`baked_lights`]), if it is one of them.
fn numbers(lighting: &Lighting, bake: Option<&ShadowFile>) -> Vec<Option<u32>> {
    let mut next = lighting.suns.len() as u32;
    let number = |lamp: &Lamp| {
        let bake = bake.filter(|_| !lamp.is_virtual())?;
        baked_light(bake, Some(&lamp.name), true)?;
        next += 1;
        Some(next - 1)
    };
    lighting.lamps.all().iter().map(number).collect()
}

/// The baked lights that passes know: suns, all of which are there, then the lamps that are.
fn baked_lights<'f>(lighting: &Lighting, file: &'f ShadowFile) -> Vec<LightShadow<'f>> {
    let suns = lighting.suns.iter().map(|sun| baked_light(file, sun.name.as_deref(), false));
    let lamps = lighting.lamps.all().iter().map(|lamp| baked_light(file, Some(&lamp.name), true));
    suns.chain(lamps).flatten().collect()
}
