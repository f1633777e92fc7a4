//! The struct `Frame` of `frame.wgsl`, and the lights beside it.

use bytemuck::{Pod, Zeroable};
use glam::{DVec2, DVec3, Vec3};

use crate::camera::View;
use crate::light::{Lamp, Sun};
use crate::passes::Lighting;
use crate::passes::shade::reference::visible_m;

/// What every pass knows; see `frame.wgsl`, with whose struct a test compares it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Frame {
    pub right: [f32; 4],
    pub up: [f32; 4],
    pub forward: [f32; 4],
    pub size: [u32; 2],
    pub sample: u32,
    pub samples: u32,
    pub jitter: [f32; 2],
    pub footprint: f32,
    pub near: f32,
    pub visible_m: f32,
    pub glow: f32,
    pub suns: u32,
    pub stars: f32,
    pub towards_sun: [f32; 4],
    pub sun_azimuth: [f32; 4],
    pub plain: [f32; 4],
    pub overhead: [f32; 4],
    pub disc: [f32; 4],
    pub exposure: f32,
    pub lamps: u32,
    pub radius: u32,
    pub kernel: u32,
    pub sun_tangent: f32,
    pub tile: u32,
    pub tiles_x: u32,
    pub layers: u32,
    pub list_words: u32,
    pub first_layer_m: f32,
    pub layer_ratio: f32,
    pub cascades: u32,
    pub fog_per_m: f32,
    pub fog_end_m: f32,
    pub fog_anisotropy: f32,
    pub area_lights: u32,
}

/// Three numbers and a 0.
pub(crate) fn four(v: Vec3) -> [f32; 4] {
    v.extend(0.0).to_array()
}

impl Frame {
    /// One sample of a picture.
    pub fn new(view: &View, lighting: &Lighting, sample: u32, samples: u32, jitter: DVec2) -> Self {
        let sky = &lighting.sky;
        Self {
            right: four(view.half_right.as_vec3()),
            up: four(view.half_up.as_vec3()),
            forward: four(view.forward.as_vec3()),
            size: [view.width, view.height],
            sample,
            samples,
            jitter: jitter.as_vec2().to_array(),
            footprint: (view.pixel_size / f64::from(samples).sqrt()) as f32,
            // Depth is as fine near as far: it may begin right before the eye.
            near: (lighting.diagonal_m * 1e-6).clamp(1e-4, 0.1) as f32,
            visible_m: visible_m(lighting) as f32,
            glow: lighting.glow,
            suns: lighting.suns.len() as u32,
            towards_sun: four(sky.towards_sun),
            sun_azimuth: four(sky.sun_azimuth),
            plain: four(sky.plain),
            overhead: four(sky.overhead),
            disc: four(sky.disc),
            stars: sky.stars,
            exposure: 1.0,
            lamps: lighting.lamps.all().len() as u32,
            list_words: (lighting.lamps.all().len() as u32).div_ceil(32).max(1),
            ..Self::default()
        }
    }
}

/// The struct `SunLight`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct SunLight {
    towards: [f32; 4],
    irradiance: [f32; 4],
}

impl SunLight {
    pub fn new(sun: &Sun) -> Self {
        Self { towards: four(sun.towards_world.as_vec3()), irradiance: four(sun.irradiance) }
    }
}

/// The struct `Lamp` of `lamp.wgsl`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct GpuLamp {
    pub position: [f32; 4],
    pub intensity: [f32; 4],
    pub axis: [f32; 4],
    pub range_m: f32,
    pub core_m: f32,
    pub reach_m: f32,
    pub cos_outer: f32,
    pub per_cosine: f32,
    pub light: u32,
    pub is_mapped: u32,
    pub is_lambertian: u32,
}

/// Instead of the number of a baked light.
pub(crate) const NOT_BAKED: u32 = u32::MAX;

impl GpuLamp {
    /// A lamp as seen from the eye; `light` is its number among the baked lights, if it is one of them, `least` the irradiance
    /// that counts.
    pub fn new(lamp: &Lamp, eye: DVec3, light: Option<u32>, least: f32, is_mapped: bool) -> Self {
        let (axis, cos_outer, per_cosine) = lamp.cone_parts().unwrap_or((DVec3::ZERO, -2.0, 0.0));
        Self {
            position: four((lamp.position_world - eye).as_vec3()),
            intensity: four(lamp.intensity),
            axis: four(axis.as_vec3()),
            // Infinity is no number that shaders promise to know.
            range_m: lamp.range_m.min(1e18) as f32,
            core_m: lamp.core_m as f32,
            reach_m: lamp.reach_m(least).min(1e18) as f32,
            cos_outer: cos_outer as f32,
            per_cosine: per_cosine as f32,
            light: light.unwrap_or(NOT_BAKED),
            is_mapped: is_mapped.into(),
            is_lambertian: lamp.is_virtual().into(),
        }
    }
}
