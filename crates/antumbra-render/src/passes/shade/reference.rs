//! Shading, on the CPU.

use glam::Vec3;
use std::f32::consts::PI;

use crate::{
    camera::View,
    light::luminance,
    passes::{
        Lighting, World,
        ambient::Gathered,
        fog::Veil,
        gbuffer::Texel,
        ivsv::AreaLit,
        shadow::{Beam, Beams},
    },
    surface::Surface,
};

/// Optical depth at which haze hides all but 2 % of a surface.
const HIDDEN: f64 = 3.9;
/// Haze hides what is this many diagonals of the scene away: enough to tell near from far.
const VISIBLE_DIAGONALS: f64 = 15.0;
/// But never what is nearer than this, metres: rooms and squares are clear.
const VISIBLE_AT_LEAST_M: f64 = 3000.0;

/// Light of the haze relative to the horizon's: it does not reach all the way to the sky behind.
const HAZE_LIGHT: f32 = 0.8;

/// A pixel's light.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Shaded {
    pub radiance: Vec3,
    /// Brightness of what surfaces reflect, without what they give off: what an exposure is measured by. 0 for the sky.
    pub metered: f32,
}

/// What a row is shaded from.
pub(crate) struct Inputs<'a> {
    pub texels: &'a [Texel],
    /// The lights on each texel.
    pub beams: &'a Beams,
    /// Gathered light of the whole picture; empty where nothing was gathered.
    pub gathered: &'a [Gathered],
    /// Fog before each texel; empty where there is none.
    pub veils: &'a [Veil],
    /// What area lights do to each texel; empty where there are none.
    pub area: &'a [AreaLit],
    pub samples: u32,
}

/// One row of pixels: the mean of their samples.
pub(crate) fn row(world: &World<'_>, view: &View, y: u32, inputs: &Inputs<'_>) -> Vec<Shaded> {
    let mut beams = inputs.beams.by_sample();
    let pixel = |(x, texels): (usize, &[Texel])| {
        let mut sum = Shaded::default();
        for (sample, (texel, beams)) in texels.iter().zip(beams.by_ref()).enumerate() {
            let index = x * inputs.samples as usize + sample;
            let area = inputs.area.get(index).copied().unwrap_or_default();
            let mut veil = inputs.veils.get(index).copied().unwrap_or(Veil::NONE);
            veil.light += area.airlight;
            let Some(surface) = &texel.surface else {
                let sky = world.lighting.sky.radiance_with_disc(texel.direction);
                sum.radiance += veil.over(sky + world.around(texel.direction));
                continue;
            };
            let ambient = ambient(world, view, inputs.gathered, [x as u32, y], surface);
            let glow = surface.emissive * world.lighting.glow;
            let light = lit(world, surface, beams, ambient, glow) + area.reflected(surface);
            sum.radiance += veil.over(hazy(world, texel, surface, light));
            sum.metered += luminance(light - glow);
        }
        let samples = inputs.samples as f32;
        Shaded { radiance: sum.radiance / samples, metered: sum.metered / samples }
    };
    inputs.texels.chunks(inputs.samples as usize).enumerate().map(pixel).collect()
}

/// What a surface sends to the eye, with what it gives off by itself.
fn lit(world: &World<'_>, surface: &Surface, beams: &[Beam], ambient: Vec3, glow: Vec3) -> Vec3 {
    let diffuse = surface.albedo * (1.0 - surface.metallic);
    let mut light = diffuse * ambient + reflected_sky(world, surface, ambient) + glow;
    for &Beam { towards, irradiance, visible } in beams {
        light += reflected(surface, towards, irradiance * visible);
    }
    light
}

/// What a surface sends to the eye of a light's irradiance.
pub(crate) fn reflected(surface: &Surface, towards: Vec3, irradiance: Vec3) -> Vec3 {
    let diffuse = surface.albedo * (1.0 - surface.metallic) / PI;
    (diffuse + highlight(surface, towards)) * irradiance * incidence(surface, towards)
}

/// Cosine of a light to the shading normal, taken to zero where the triangle itself turns away.
///
/// Chiang, Li and Burley (2019), "Taming the Shadow Terminator": without it coarse smooth meshes end the light in
/// facets.
pub(crate) fn incidence(surface: &Surface, towards: Vec3) -> f32 {
    let (smooth, face) = (surface.normal.dot(towards).max(0.0), surface.face_normal.dot(towards).max(0.0));
    let between = surface.normal.dot(surface.face_normal).max(1e-3);
    let g = (face / (smooth * between).max(1e-6)).min(1.0);
    smooth * (-g * g * g + g * g + g)
}

/// A light's microfacet reflection.
pub(crate) fn highlight(surface: &Surface, towards: Vec3) -> Vec3 {
    let (n, v, l) = (surface.normal, surface.towards_eye, towards);
    let h = (v + l).normalize_or_zero();
    let (nv, nl) = (n.dot(v).max(1e-3), n.dot(l).max(1e-3));
    // A sharper mirror would show a light as a handful of blinding samples.
    let alpha = surface.roughness.max(0.15).powi(2);
    let alpha_2 = alpha * alpha;
    let peak = n.dot(h).powi(2) * (alpha_2 - 1.0) + 1.0;
    let distribution = alpha_2 / (PI * peak * peak);
    let smith = nl * (nv * nv * (1.0 - alpha_2) + alpha_2).sqrt() + nv * (nl * nl * (1.0 - alpha_2) + alpha_2).sqrt();
    let fresnel = head_on(surface) + (Vec3::ONE - head_on(surface)) * (1.0 - v.dot(h).clamp(0.0, 1.0)).powi(5);
    fresnel * (distribution * 0.5 / smith)
}

/// Reflectance at right angles: 4 % for all but metals.
fn head_on(surface: &Surface) -> Vec3 {
    Vec3::splat(0.04).lerp(surface.albedo, surface.metallic)
}

/// The sky in a surface, as far as the surroundings let it be seen. The split sum's second factor is Karis's (2014)
/// fit, "Physically Based Shading on Mobile".
fn reflected_sky(world: &World<'_>, surface: &Surface, ambient: Vec3) -> Vec3 {
    let n_v = surface.normal.dot(surface.towards_eye).clamp(0.0, 1.0);
    let rough = surface.roughness;
    let a = ((1.0 - rough).powi(2)).min((-9.28 * n_v).exp2()) * (1.0 - rough) + (0.0425 - 0.0275 * rough);
    let (scale, bias) = (a * -1.04 + 1.04 - 0.572 * rough, a * 1.04 - 0.04 + 0.022 * rough);
    let mirror = 2.0 * n_v * surface.normal - surface.towards_eye;
    let blurred = world.lighting.sky.radiance(mirror).lerp(world.lighting.sky.ambient(surface.normal), rough);
    let open = (ambient.element_sum() / world.lighting.sky.ambient(surface.normal).element_sum()).clamp(0.0, 1.0);
    blurred * open * (head_on(surface) * scale + bias).max(Vec3::ZERO)
}

/// The light gathered for a surface: of the pixel itself or, at edges, of the neighbours that show the same surface.
fn ambient(world: &World<'_>, view: &View, gathered: &[Gathered], [x, y]: [u32; 2], surface: &Surface) -> Vec3 {
    if gathered.is_empty() {
        return world.lighting.sky.ambient(surface.normal);
    }
    let position = (surface.position - view.eye).as_vec3();
    let at = |x: u32, y: u32| &gathered[(y * view.width + x) as usize];
    if at(x, y).affinity(position, surface.normal) > 0.5 {
        return at(x, y).light;
    }
    let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
    for (x, y) in around(view, x, y) {
        // A trace of weight for any surface at all: thin leaves take the light of those around them.
        let weight = at(x, y).affinity(position, surface.normal) + if at(x, y).pixel_m > 0.0 { 1e-4 } else { 0.0 };
        sum += at(x, y).light * weight;
        weights += weight;
    }
    if weights > 0.0 { sum / weights } else { world.lighting.sky.ambient(surface.normal) }
}

fn around(view: &View, x: u32, y: u32) -> impl Iterator<Item = (u32, u32)> {
    let (right, below) = ((x + 1).min(view.width - 1), (y + 1).min(view.height - 1));
    (y.saturating_sub(1)..=below).flat_map(move |y| (x.saturating_sub(1)..=right).map(move |x| (x, y)))
}

/// Distance at which haze hides all but 2 % of a surface, metres.
pub(crate) fn visible_m(lighting: &Lighting) -> f64 {
    (lighting.diagonal_m * VISIBLE_DIAGONALS).max(VISIBLE_AT_LEAST_M)
}

/// Aerial perspective: the farther, the more of the horizon's light and the less of the surface's.
fn hazy(world: &World<'_>, texel: &Texel, surface: &Surface, light: Vec3) -> Vec3 {
    let clear = (-HIDDEN * surface.distance / visible_m(&world.lighting)).exp() as f32;
    let flat = Vec3::new(texel.direction.x, 0.0, texel.direction.z).try_normalize().unwrap_or(Vec3::X);
    (world.lighting.sky.radiance(flat) * HAZE_LIGHT).lerp(light, clear)
}
