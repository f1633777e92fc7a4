//! Area lights on the graphics card: their VPLs' shadows, batch after batch, and what the light does to each sample.

use antumbra_scene::{Bounds, Scene};
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, Vec3};

use super::frame::{Frame, four};
use super::passes::{AreaGather, AreaPasses, GatherWay};
use super::scene::SceneBuffers;
use super::targets::Targets;
use super::timing::{Recorder, Step};
use super::{Gpu, Kernel};
use crate::RenderError;
use crate::area::{Airlight, AreaLight, AreaLighting, AreaShape, AreaTechnique, Gathering, Interpolation};
use crate::area::{VoxelResolution, Vpl, sampled};
use crate::camera::View;
use crate::light::LUX;
use crate::passes::ivsv::airlight;
use crate::passes::ivsv::cloud::Cloud;
use crate::passes::ivsv::epipolar::Epipolar;
use crate::passes::ivsv::filter::Grid;
use crate::passes::ivsv::reference::{CLOUD, far_from};
use crate::passes::ivsv::splat::Paraboloid;

/// The struct `Vpl` of `vpl.wgsl`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct GpuVpl {
    pub position: [f32; 3],
    pub radius_m: f32,
    pub normal: [f32; 3],
    pub start_m: f32,
    pub intensity: [f32; 3],
    pub per_spread: f32,
    pub x: [f32; 3],
    pub distance: f32,
    pub y: [f32; 3],
    pub alpha_min: f32,
    pub axis: [f32; 3],
    pub theta_min: f32,
    pub across: [f32; 3],
    pub alpha_scale: f32,
    pub along: [f32; 3],
    pub theta_scale: f32,
    pub phi_scale: f32,
    pub wraps: u32,
    pub pad_0: u32,
    pub pad_1: u32,
}

impl GpuVpl {
    fn new(vpl: &Vpl, space: &Epipolar) -> Self {
        let paraboloid = Paraboloid::new(vpl, space.size.map);
        Self {
            position: vpl.position.to_array(),
            radius_m: vpl.radius_m,
            normal: vpl.normal.to_array(),
            start_m: vpl.start_m,
            intensity: vpl.intensity.to_array(),
            per_spread: 1.0 / vpl.spread,
            x: paraboloid.x.to_array(),
            distance: space.distance,
            y: paraboloid.y.to_array(),
            alpha_min: space.alpha_min,
            axis: space.axis.to_array(),
            theta_min: space.theta_min,
            across: space.across.to_array(),
            alpha_scale: space.alpha_scale,
            along: space.along.to_array(),
            theta_scale: space.theta_scale,
            phi_scale: space.phi_scale,
            wraps: space.wraps.into(),
            pad_0: 0,
            pad_1: 0,
        }
    }
}

/// The struct `Batch` of `vpl.wgsl`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Batch {
    pub first: u32,
    pub count: u32,
    pub map: u32,
    pub alpha: u32,
    pub theta: u32,
    pub phi: u32,
    pub quads: u32,
    pub points: u32,
    pub cloud: u32,
    pub pad_0: u32,
    pub pad_1: u32,
    pub pad_2: u32,
}

/// The struct `CloudPoint` of `place.wgsl`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct CloudPoint {
    position: [f32; 3],
    node: u32,
    normal: [f32; 3],
    pad: u32,
}

/// The struct `AreaLight` of `lights.wgsl`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct GpuAreaLight {
    pub position: [f32; 3],
    pub shape: u32,
    pub direction: [f32; 3],
    pub width_m: f32,
    pub up: [f32; 3],
    pub height_m: f32,
    pub left: [f32; 3],
    pub texels: u32,
    pub radiance: [f32; 3],
    pub picture: u32,
}

impl GpuAreaLight {
    /// A light as seen from the eye, whose picture's texels begin at a place.
    fn new(light: &AreaLight, eye: DVec3, texels: usize) -> Self {
        let (shape, width_m, height_m) = match light.shape {
            AreaShape::Rectangle { width_m, height_m } => (0, width_m, height_m),
            AreaShape::Disc { radius_m } => (1, radius_m, 0.0),
            AreaShape::Sphere { radius_m } => (2, radius_m, 0.0),
            AreaShape::Environment => (3, 0.0, 0.0),
        };
        Self {
            position: (light.position_world - eye).as_vec3().to_array(),
            shape,
            direction: light.direction_world.as_vec3().to_array(),
            width_m: width_m as f32,
            up: light.up_world.as_vec3().to_array(),
            height_m: height_m as f32,
            left: light.left().as_vec3().to_array(),
            texels: texels as u32,
            radiance: (Vec3::from(light.luminance) * LUX).to_array(),
            picture: light.emission.as_ref().map_or(0, |emission| {
                let [width, height] = emission.size();
                width | height << 16
            }),
        }
    }
}

/// What area lights need on the card.
#[derive(Debug)]
pub(crate) struct Area {
    passes: AreaPasses,
    gathers: Vec<(GatherWay, AreaGather)>,
    cloud: Cloud,
    points: wgpu::Buffer,
    placed: wgpu::Buffer,
    /// Tails of airlight, for one anisotropy.
    tails: (f32, wgpu::Buffer),
    room: Option<Room>,
    frame: Option<Lights>,
}

/// Buffers for one number of VPLs, resolution and budget.
#[derive(Debug)]
struct Room {
    of: (u32, VoxelResolution, AreaTechnique, u32),
    batches: Vec<(Batch, wgpu::Buffer)>,
    maps: wgpu::Buffer,
    thresholds: wgpu::Buffer,
    /// The second is for the slow scan.
    voxels: [wgpu::Buffer; 2],
    /// Of the slow scan's steps.
    strides: Vec<(u32, wgpu::Buffer)>,
}

/// What changes with the eye and the lights.
#[derive(Debug)]
struct Lights {
    vpls: wgpu::Buffer,
    shares: wgpu::Buffer,
    lights: wgpu::Buffer,
    pictures: wgpu::Buffer,
}

/// Most lookups of maps by one ray in one pass: more would take a card's patience, and software cards end loops.
const MOST_LOOKUPS: u32 = 8192;

/// Texels of 128 bits along phi.
fn quads(size: &VoxelResolution) -> u32 {
    size.phi.div_ceil(128)
}

fn way(how: &AreaLighting, grid: Gathering) -> GatherWay {
    let shadows = match how.technique {
        AreaTechnique::None | AreaTechnique::Traced => 0,
        AreaTechnique::Voxels | AreaTechnique::OneByOne => 1,
        AreaTechnique::MarchedMaps => 2,
    };
    GatherWay {
        shadows,
        gathering: grid,
        interpolation: how.interpolation,
        is_exact: how.airlight == Airlight::Exact,
        quads: quads(&how.voxels),
    }
}

impl Area {
    /// For a scene.
    pub fn new(gpu: &Gpu, scene: &Scene) -> Self {
        let cloud = Cloud::new(scene, CLOUD);
        let point = |(position, node, normal)| CloudPoint { position, node, normal, pad: 0 };
        let points: Vec<CloudPoint> = cloud.points().map(point).collect();
        let any = GatherWay {
            shadows: 0,
            gathering: Gathering::Full,
            interpolation: Interpolation::None,
            is_exact: false,
            quads: 1,
        };
        Self {
            passes: AreaPasses::new(gpu, any),
            gathers: Vec::new(),
            points: gpu.buffer("cloud", &points),
            placed: gpu.zeros("placed cloud", 32 * points.len() as u64),
            tails: (f32::NAN, gpu.zeros("airlight", 0)),
            room: None,
            frame: None,
            cloud,
        }
    }

    /// Makes programs and room for a picture of so many pixels.
    fn prepare(&mut self, gpu: &Gpu, how: &AreaLighting, way: GatherWay, anisotropy: f32) -> Result<(), RenderError> {
        if !self.gathers.iter().any(|(known, _)| *known == way) {
            self.gathers.push((way, AreaGather::new(gpu, way)));
        }
        if self.tails.0 != anisotropy {
            let table = airlight::Airlight::new(f64::from(anisotropy)).table;
            let tails: Vec<[f32; 2]> = table.iter().map(|tail| tail.to_array()).collect();
            self.tails = (anisotropy, gpu.buffer("airlight", &tails));
        }
        let size = how.voxels;
        let [map, alpha, theta, phi] = [size.map, size.alpha, size.theta, size.phi].map(u64::from);
        let bytes = [4 * map * map, 4 * theta * phi, 16 * alpha * theta * u64::from(quads(&size))];
        for (what, bytes) in ["a light's shadow map", "a light's thresholds", "a light's voxels"].into_iter().zip(bytes)
        {
            gpu.check_size(what, bytes)?;
        }
        let largest = bytes.into_iter().max().unwrap_or(1);
        let mut batch = how.batch().min((gpu.most_bytes() / largest) as u32);
        if how.technique == AreaTechnique::MarchedMaps {
            batch = batch.min((MOST_LOOKUPS / size.phi).max(1));
        }
        let of = (how.vpls, size, how.technique, batch);
        if self.room.as_ref().is_some_and(|room| room.of == of) {
            return Ok(());
        }
        self.room = None;
        let of_batch = |first: u32| {
            let count = batch.min(how.vpls - first);
            let params = Batch {
                first,
                count,
                map: size.map,
                alpha: size.alpha,
                theta: size.theta,
                phi: size.phi,
                quads: quads(&size),
                points: size.points,
                cloud: self.cloud.len(),
                ..Batch::default()
            };
            (params, gpu.buffer("batch", &[[params; 6]]))
        };
        let is_slow = how.technique == AreaTechnique::OneByOne;
        let [maps, thresholds, voxels] = bytes.map(|bytes| bytes * u64::from(batch));
        let strides = (0..).map(|step| 1 << step).take_while(|stride| is_slow && *stride < size.alpha);
        self.room = Some(Room {
            of,
            batches: (0..how.vpls).step_by(batch as usize).map(of_batch).collect(),
            maps: gpu.zeros("shadow maps", maps),
            thresholds: gpu.zeros("thresholds", thresholds),
            voxels: [gpu.zeros("voxels", voxels), gpu.zeros("voxels", if is_slow { voxels } else { 0 })],
            strides: strides.map(|stride| (stride, gpu.buffer("stride", &[[stride; 64]]))).collect(),
        });
        Ok(())
    }

    /// Samples the lights for an eye, and says how many VPLs there are.
    fn see(&mut self, gpu: &Gpu, how: &AreaLighting, seen: &Seen<'_>) {
        let eye = seen.view.eye;
        let vpls = sampled(&how.lights, how.vpls, seen.bounds, eye);
        let far_m = far_from(eye, seen.bounds, seen.fog_end_m);
        let spaces = vpls.iter().map(|vpl| GpuVpl::new(vpl, &Epipolar::new(vpl, seen.view, far_m, how.voxels)));
        let spaces: Vec<GpuVpl> = spaces.collect();
        let shares = self.cloud.shares(seen.nodes, eye, &vpls, how.voxels.points);
        let (mut lights, mut pictures) = (Vec::new(), Vec::new());
        for light in &how.lights {
            lights.push(GpuAreaLight::new(light, eye, pictures.len()));
            pictures.extend(light.emission.iter().flat_map(|emission| emission.texels()).map(|texel| four(*texel)));
        }
        self.frame = Some(Lights {
            vpls: gpu.buffer("VPLs", &spaces),
            shares: gpu.buffer("shares", &shares),
            lights: gpu.buffer("area lights", &lights),
            pictures: gpu.buffer("area lights' pictures", &pictures),
        });
    }
}

/// What the lights' shadows are seen from.
pub(crate) struct Seen<'s> {
    pub view: &'s View,
    pub bounds: &'s Bounds,
    pub nodes: &'s [antumbra_scene::Node],
    pub fog_end_m: f64,
}

/// One sample of a picture, being recorded.
pub(crate) struct Sample<'s> {
    pub gpu: &'s Gpu,
    pub how: &'s AreaLighting,
    pub frame: &'s Frame,
    pub frame_buffer: &'s wgpu::Buffer,
    pub targets: &'s Targets,
    pub scene: &'s SceneBuffers,
}

impl Area {
    /// Before a picture's first sample: room, programs, and the lights as seen from its eye.
    pub fn begin(&mut self, gpu: &Gpu, how: &AreaLighting, frame: &Frame, seen: &Seen<'_>) -> Result<(), RenderError> {
        self.prepare(gpu, how, way(how, gathering(how, frame)), frame.fog_anisotropy)?;
        self.see(gpu, how, seen);
        Ok(())
    }

    /// Puts the lights' surfaces into the G-buffer.
    pub fn show(&self, recorder: &mut Recorder<'_>, sample: &Sample<'_>) {
        let Some(lights) = &self.frame else { return };
        let buffers = [sample.frame_buffer, &lights.lights, &lights.pictures, &sample.targets.gbuffer];
        let group = bind(sample.gpu, &self.passes.show, &buffers);
        recorder.compute("light surfaces", &self.passes.show, &[&group], over(sample.frame.size));
    }

    /// Makes the VPLs' shadows and gathers their light, batch after batch; then samples share it.
    pub fn light(&self, recorder: &mut Recorder<'_>, sample: &Sample<'_>) {
        let way = way(sample.how, gathering(sample.how, sample.frame));
        let Some((_, programs)) = self.gathers.iter().find(|(known, _)| *known == way) else { return };
        let (Some(room), Some(lights)) = (&self.room, &self.frame) else { return };
        let (gpu, passes, targets) = (sample.gpu, &self.passes, sample.targets);
        // All samples of a picture see the same shadows, if they are there at once.
        let is_new = sample.frame.sample == 0 || room.batches.len() > 1;
        let has_shadows = way.shadows > 0 && self.cloud.len() > 0;
        if is_new && has_shadows && sample.frame.sample == 0 {
            let buffers = [&room.batches[0].1, &self.points, &sample.scene.nodes, &self.placed];
            let group = bind(gpu, &passes.place, &buffers);
            recorder.compute("points", &passes.place, &[&group], [self.cloud.len().div_ceil(64), 1, 1]);
        }
        for (batch, params) in &room.batches {
            let mut voxels = &room.voxels[0];
            if is_new && has_shadows {
                self.draw_maps(recorder, gpu, (batch, params), room, lights);
                if way.shadows == 1 {
                    voxels = self.make_voxels(recorder, gpu, (batch, params), room, lights);
                }
            }
            let own = [
                sample.frame_buffer,
                params,
                &targets.gbuffer,
                &lights.vpls,
                voxels,
                &room.maps,
                &self.tails.1,
                &targets.gathered,
            ];
            let group = bind(gpu, &programs.gather, &own);
            let [x, y] = sample.frame.size;
            let workgroups = match way.gathering {
                Gathering::Full => over([x, y]),
                Gathering::Half => over([x.div_ceil(2), y.div_ceil(2)]),
                Gathering::Interleaved => {
                    let [x, y, _] = over([x.div_ceil(3), y.div_ceil(3)]);
                    [x, y, 9]
                }
            };
            recorder.compute("gather", &programs.gather, &[&group], workgroups);
        }
        let own =
            [sample.frame_buffer, &targets.gbuffer, &targets.gathered, &lights.lights, &lights.pictures, &targets.area];
        let group = bind(gpu, &programs.share, &own);
        recorder.compute("area light", &programs.share, &[&group], over(sample.frame.size));
    }

    fn draw_maps(
        &self,
        recorder: &mut Recorder<'_>,
        gpu: &Gpu,
        (batch, params): (&Batch, &wgpu::Buffer),
        room: &Room,
        lights: &Lights,
    ) {
        let AreaPasses { clear, splat, .. } = &self.passes;
        let cleared = bind(gpu, clear, &[params, &room.maps]);
        let drawn = bind(gpu, splat, &[params, &lights.vpls, &lights.shares, &self.placed, &room.maps]);
        recorder.computes(
            "VPL maps",
            &[
                step(clear, &[&cleared], [(batch.map * batch.map).div_ceil(64), batch.count, 1]),
                step(splat, &[&drawn], [batch.points.div_ceil(64), batch.count, 1]),
            ],
        );
    }

    /// Rectifies the maps and extrudes shadows; says where the voxels are.
    fn make_voxels<'r>(
        &self,
        recorder: &mut Recorder<'_>,
        gpu: &Gpu,
        (batch, params): (&Batch, &wgpu::Buffer),
        room: &'r Room,
        lights: &Lights,
    ) -> &'r wgpu::Buffer {
        let AreaPasses { rectify, scan, begin, extrude, .. } = &self.passes;
        let Room { maps, thresholds, voxels: [voxels, others], strides, .. } = room;
        let rays = [(batch.theta * batch.phi).div_ceil(64), batch.count, 1];
        let rectified = bind(gpu, rectify, &[params, &lights.vpls, maps, thresholds]);
        if strides.is_empty() {
            recorder.compute("rectify", rectify, &[&rectified], rays);
            let group = bind(gpu, scan, &[params, thresholds, voxels]);
            recorder.compute("scan", scan, &[&group], [batch.theta, batch.count, batch.quads]);
            return voxels;
        }
        let begun = bind(gpu, begin, &[params, thresholds, voxels]);
        recorder.clear(voxels);
        recorder.computes("rectify", &[step(rectify, &[&rectified], rays), step(begin, &[&begun], rays)]);
        let texels = [(batch.theta * batch.alpha * batch.quads).div_ceil(64), batch.count, 1];
        let (mut from, mut to) = (voxels, others);
        let mut groups = Vec::new();
        for (_, stride) in strides {
            groups.push(bind(gpu, extrude, &[params, from, to, stride]));
            (from, to) = (to, from);
        }
        let groups: Vec<[&wgpu::BindGroup; 1]> = groups.iter().map(|group| [group]).collect();
        recorder.computes("scan", &groups.iter().map(|own| step(extrude, own, texels)).collect::<Vec<_>>());
        from
    }

    /// Maps, thresholds and voxels of the last batch: for tests.
    #[cfg(test)]
    pub fn last(&self, gpu: &Gpu) -> Result<[Vec<u32>; 3], RenderError> {
        let Some(room) = &self.room else { return Ok(Default::default()) };
        let voxels = &room.voxels[room.strides.len() % 2];
        Ok([gpu.read(&room.maps)?, gpu.read(&room.thresholds)?, gpu.read(voxels)?])
    }
}

/// How a picture is gathered: one too small to share, in full.
fn gathering(how: &AreaLighting, frame: &Frame) -> Gathering {
    Grid::new(how.gathering, frame.size.into()).gathering
}

fn step<'a>(kernel: &'a Kernel, groups: &'a [&'a wgpu::BindGroup], workgroups: [u32; 3]) -> Step<'a> {
    Step { kernel, groups, workgroups }
}

fn bind(gpu: &Gpu, kernel: &Kernel, buffers: &[&wgpu::Buffer]) -> wgpu::BindGroup {
    let resources: Vec<_> = buffers.iter().map(|buffer| buffer.as_entire_binding()).collect();
    gpu.group(&kernel.layouts[0], &resources)
}

/// Workgroups of 8 x 8.
fn over([width, height]: [u32; 2]) -> [u32; 3] {
    [width.div_ceil(8), height.div_ceil(8), 1]
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::gpu::{GpuRenderer, Lookup, Setting};
    use crate::passes::ivsv::splat::Map;
    use crate::passes::ivsv::tests::wall_and_floor;
    use crate::passes::ivsv::{rectify, scan};
    use crate::{RenderOptions, Time, look_at};

    /// Maps, thresholds and voxels of a batch on the card are those of the CPU, but for rounding; and from thresholds to voxels
    /// there is none.
    #[test]
    fn shadows_are_those_of_the_processor() {
        let scene = Arc::new(wall_and_floor());
        let gpu = Gpu::open().expect("a graphics card, if only a software one");
        let camera = look_at(DVec3::new(12.0, 1.0, -4.0), DVec3::new(0.0, 0.0, -3.0), 1.2).expect("a camera");
        let view = View::new(&camera, 64, 36).expect("a view");
        let bounds = scene.bounds(|_| true);
        let shape = AreaShape::Disc { radius_m: 0.5 };
        let light = AreaLight::towards(shape, DVec3::ZERO, DVec3::NEG_Z, [1e3; 3]).expect("a light");
        let size = VoxelResolution { map: 64, alpha: 96, theta: 64, phi: 160, points: 4096 };
        for technique in [AreaTechnique::Voxels, AreaTechnique::OneByOne] {
            let how = AreaLighting { technique, voxels: size, vpls: 20, ..AreaLighting::new(vec![light.clone()]) };
            let setting = Setting { time: Some(Time::Night), area: &how.lights, top_grid: true, ..Setting::default() };
            let mut renderer = GpuRenderer::new(&gpu, Arc::clone(&scene), setting).expect("a renderer");
            let options =
                RenderOptions { width: 64, height: 36, samples: 1, area: Some(how.clone()), ..Default::default() };
            renderer.render(&camera, &options, Lookup::None).expect("a picture");
            let area = renderer.area.as_ref().expect("area lights");
            let [maps, thresholds, voxels] = area.last(&gpu).expect("buffers");
            let vpls = sampled(&how.lights, how.vpls, &bounds, view.eye);
            let cast = Cloud::new(&scene, CLOUD).cast(&scene.nodes, view.eye, &vpls, size.points);
            let first = if technique == AreaTechnique::OneByOne { 19 } else { 0 };
            let [mut off, mut all] = [[0; 2]; 2];
            for (slot, (number, vpl)) in vpls.iter().enumerate().skip(first).enumerate() {
                let map = Map::draw(vpl, number as u32, &cast, size.map, size.points);
                let space = Epipolar::new(vpl, &view, far_from(view.eye, &bounds, bounds.diagonal()), size);
                let own = |all: &[u32], count: usize| all[slot * count..(slot + 1) * count].to_vec();
                let there = own(&maps, (size.map * size.map) as usize);
                let differs = |(a, b): &(&u32, &u32)| {
                    let [a, b] = [**a, **b].map(f32::from_bits);
                    !(a.is_nan() && b.is_nan() || (a / b - 1.0).abs() < 1e-3)
                };
                off[0] += map.texels.iter().zip(&there).filter(differs).count();
                all[0] += there.len();
                // From the card's own map on.
                let map = Map { side: size.map, texels: there };
                let rays = own(&thresholds, (size.theta * size.phi) as usize);
                let expected = rectify::thresholds(vpl, &space, &map);
                off[1] += rays.iter().zip(&expected).filter(|(a, b)| a.abs_diff(**b) > 1).count();
                all[1] += rays.len();
                let texels = (size.theta * size.alpha) as usize;
                let words: Vec<u32> =
                    own(&voxels, 8 * texels).chunks(8).flat_map(|texel| texel[..5].to_vec()).collect();
                assert!(words == scan::voxels(size, &rays), "{technique:?}: VPL {number}'s voxels");
            }
            println!("{technique:?}: texels, light rays that differ: {off:?} of {all:?}");
            assert!(off[0] * 200 < all[0] && off[1] * 200 < all[1], "{technique:?}: {off:?} of {all:?} differ");
            assert!(maps.iter().filter(|bits| **bits != u32::MAX).count() > 1000);
        }
    }
}
