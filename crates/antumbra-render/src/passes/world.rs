//! What passes read: the scene, ready to trace and to look up, and its light at one time.

use antumbra_scene::Light;
use glam::{DVec3, Vec3};
use std::f32::consts::PI;

use crate::{
    area::{AreaLight, AreaShape},
    light::{LUX, Lamp, Lamps, Sky, Sun, Time, VirtualLight, luminance},
    sampling::{cosine_direction, r2},
    surface::{Surface, Surfaces},
    trace::{Ray, Tracer},
};

/// Everything that passes read.
pub(crate) struct World<'w> {
    pub tracer: &'w Tracer,
    pub surfaces: &'w Surfaces<'w>,
    pub lighting: Lighting,
    /// Lights with a surface, which is seen.
    pub area: &'w [AreaLight],
}

/// A scene's light at one time.
#[derive(Clone, Debug)]
pub(crate) struct Lighting {
    pub time: Time,
    /// At night: moons.
    pub suns: Vec<Sun>,
    pub lamps: Lamps,
    pub sky: Sky,
    /// What white ground in the open reflects of the suns and the sky (under a low sun it is tilted towards it), and at
    /// night of what lamps send all round.
    pub outdoors: Vec3,
    /// Irradiance of what is plainly lit: by the sun by day, by lamps at night.
    pub plainly_lit: f32,
    /// Radiance of a surface whose material is emissive by 1.
    pub glow: f32,
    /// Length of the scene's diagonal, metres.
    pub diagonal_m: f64,
}

/// A lamp whose light is this small a share of what is plainly lit is not looked at.
const LEAST_SHARE: f32 = 1.0 / 4096.0;
/// Radiance of the horizon at night, relative to a plainly lit white surface.
const NIGHT_HORIZON: f32 = 0.03;
/// How much less of it there is beside virtual lights, which are themselves what lamps send all round.
const BESIDE_VIRTUAL: f32 = 0.1;
/// Radiance at night of what glows (windows, signs), relative to a plainly lit white surface.
const NIGHT_GLOW: f32 = 4.0;
/// Share of plainly lit places' light that lamps send all round at night, by way of walls and haze.
const LAMPS_ALL_ROUND: f32 = 0.25;
/// Moonlight is at most this share of what is plainly lit: files in an artist's units have moons that would drown their
/// lamps.
const MOST_MOONLIGHT: f32 = 0.1;
/// Moonlight's colour as eyes see it that are used to the dark.
const MOON_TINT: Vec3 = Vec3::new(0.5, 0.75, 1.35);
/// Rays from each area light that find out what it lights.
const RAYS_PER_AREA_LIGHT: u32 = 256;
/// Rays from each lamp that find out what it lights.
const RAYS_PER_LAMP: u32 = 64;

impl Lighting {
    /// The light of some of a scene's lights and of virtual ones, by day or night. `lamplit` finds the irradiance of a place that lamps light:
    /// asked at night alone.
    pub(crate) fn new(
        lights: &[Light],
        virtual_lights: &[VirtualLight],
        time: Time,
        diagonal_m: f64,
        lamplit: impl FnOnce(&[Lamp]) -> Option<f32>,
    ) -> Self {
        let mut lamps: Vec<Lamp> = lights.iter().filter_map(|light| Lamp::of_light(light, diagonal_m)).collect();
        let (suns, sky, plainly_lit, glow) = match time {
            Time::Day => {
                let suns = Sun::of_lights(lights);
                let sky = Sky::new(&suns[0]);
                (suns, sky, 1.0, 1.0)
            }
            Time::Night => {
                let moons = Sun::moons(lights);
                let plainly_lit = lamplit(&lamps).or_else(|| moonlit(&moons)).unwrap_or(LUX);
                let moons: Vec<Sun> = moons.into_iter().map(|moon| beside_lamps(moon, plainly_lit)).collect();
                let white = plainly_lit / PI;
                let horizon = if virtual_lights.is_empty() { NIGHT_HORIZON } else { NIGHT_HORIZON * BESIDE_VIRTUAL };
                let sky = Sky::night(white * horizon, moons.first());
                (moons, sky, plainly_lit, white * NIGHT_GLOW)
            }
        };
        let from_suns: Vec3 = suns.iter().map(|s| s.irradiance * (s.towards_world.y as f32).max(0.35)).sum();
        let from_lamps =
            if time == Time::Night && virtual_lights.is_empty() { plainly_lit * LAMPS_ALL_ROUND / PI } else { 0.0 };
        lamps.extend(virtual_lights.iter().enumerate().map(|(i, light)| light.lamp(i, diagonal_m)));
        let outdoors = from_suns / PI + sky.overhead() + from_lamps;
        let lamps = Lamps::new(lamps, plainly_lit * LEAST_SHARE);
        Self { time, suns, lamps, sky, outdoors, plainly_lit, glow, diagonal_m }
    }
}

impl<'w> World<'w> {
    /// A scene in the light of some of its lights, of virtual lights and of area lights, by day or night.
    pub(crate) fn new(
        tracer: &'w Tracer,
        surfaces: &'w Surfaces<'w>,
        lights: &[Light],
        virtual_lights: &[VirtualLight],
        area: &'w [AreaLight],
        time: Time,
    ) -> Self {
        let lamplit = |lamps: &[Lamp]| lamplit(tracer, surfaces, lamps, area);
        let lighting = Lighting::new(lights, virtual_lights, time, tracer.bounds().diagonal(), lamplit);
        Self { tracer, surfaces, lighting, area }
    }

    /// Radiance of what lies around the scene, in environments.
    pub(crate) fn around(&self, direction: Vec3) -> Vec3 {
        let environments = self.area.iter().filter(|light| light.shape == AreaShape::Environment);
        environments
            .filter_map(|light| light.seen(DVec3::ZERO, direction.as_dvec3()))
            .map(|(_, radiance)| radiance)
            .sum()
    }

    /// The nearest surface of a light on a ray, as a surface that glows; nearer than a distance.
    pub(crate) fn light_surface(&self, ray: &Ray, nearer: f64) -> Option<Surface> {
        let seen = self.area.iter().filter_map(|light| light.seen(ray.origin, ray.direction));
        let (distance, radiance) =
            seen.filter(|(t, _)| *t < nearer && t.is_finite()).min_by(|a, b| a.0.total_cmp(&b.0))?;
        let towards_eye = -ray.direction.as_vec3();
        Some(Surface {
            position: ray.at(distance),
            distance,
            footprint_m: 0.0,
            face_normal: towards_eye,
            normal: towards_eye,
            towards_eye,
            albedo: Vec3::ZERO,
            emissive: radiance / self.lighting.glow,
            metallic: 1.0,
            roughness: 1.0,
        })
    }

    /// A ray that leaves a surface. It starts a little off it: modelled surfaces lie on one another (decals, panes,
    /// doubled walls) more loosely than the tracer computes.
    pub(crate) fn leaving(&self, position: DVec3, face_normal: Vec3, direction: DVec3) -> Ray {
        let offset_m = self.lighting.diagonal_m * 1e-6 + position.abs().max_element() * 1e-14;
        Ray::new(position + face_normal.as_dvec3() * offset_m, direction)
    }
}

/// Irradiance of a place that lamps or area lights light: of those that are brighter.
pub(crate) fn lamplit(tracer: &Tracer, surfaces: &Surfaces<'_>, lamps: &[Lamp], area: &[AreaLight]) -> Option<f32> {
    match (by_lamps(tracer, surfaces, lamps), area_lit(tracer, surfaces, area)) {
        (Some(by_lamps), Some(by_area)) => Some(by_lamps.max(by_area)),
        (by_lamps, by_area) => by_lamps.or(by_area),
    }
}

/// Irradiance of a place that lamps light: the median over places that rays from the lamps find. A few rays tell enough,
/// and a lamp's own housing or a wall beside it does not count for more than what it lights.
fn by_lamps(tracer: &Tracer, surfaces: &Surfaces<'_>, lamps: &[Lamp]) -> Option<f32> {
    let from = |lamp| (0..RAYS_PER_LAMP).filter_map(move |i| lit_place(tracer, surfaces, lamp, i));
    let mut lit: Vec<f32> = lamps.iter().flat_map(from).collect();
    if lit.is_empty() {
        // Nothing is in reach: as bright as half way to it.
        let halfway = |lamp: &Lamp| lamp.at(lamp.position_world + lamp.direction(0.0, 0.0) * 512.0 * lamp.near_m);
        lit = lamps.iter().filter_map(halfway).map(|light| luminance(light.irradiance)).collect();
    }
    let middle = lit.len() / 2;
    (!lit.is_empty()).then(|| *lit.select_nth_unstable_by(middle, f32::total_cmp).1)
}

/// Irradiance of a place that area lights light: as [`by_lamps`] finds it.
fn area_lit(tracer: &Tracer, surfaces: &Surfaces<'_>, lights: &[AreaLight]) -> Option<f32> {
    let mut lit: Vec<f32> = Vec::new();
    for light in lights {
        for i in 0..RAYS_PER_AREA_LIGHT {
            let point = light.point(r2(i), &tracer.bounds());
            let spread = (point.spread * point.spread) as f32;
            let at = r2(i + RAYS_PER_AREA_LIGHT).as_vec2() * glam::Vec2::new(1.0, spread.min(1.0));
            let direction = cosine_direction(point.normal_world.as_vec3(), at).as_dvec3();
            let ray = Ray::new(point.position_world, direction);
            let Some(hit) = tracer.closest_if(&ray, |hit| surfaces.casts_shadow(tracer, hit)) else { continue };
            let cos = tracer.normal(hit.triangle).dot(direction).abs() * direction.dot(point.normal_world);
            let solid_angle = point.area_m2 / (hit.t * hit.t + point.area_m2 / std::f64::consts::PI);
            lit.push(luminance(point.radiance) * (cos * solid_angle) as f32);
        }
    }
    let middle = lit.len() / 2;
    (!lit.is_empty()).then(|| *lit.select_nth_unstable_by(middle, f32::total_cmp).1).filter(|lit| *lit > 0.0)
}

fn lit_place(tracer: &Tracer, surfaces: &Surfaces<'_>, lamp: &Lamp, ray: u32) -> Option<f32> {
    let direction = lamp.direction(r2(ray).x, r2(ray).y);
    let ray = Ray::new(lamp.position_world, direction).between(lamp.near_m, lamp.range_m);
    let hit = tracer.closest_if(&ray, |hit| surfaces.casts_shadow(tracer, hit))?;
    let light = lamp.at(ray.at(hit.t))?;
    let cos = tracer.normal(hit.triangle).dot(direction).abs() as f32;
    Some(luminance(light.irradiance) * cos).filter(|lit| *lit > 0.0)
}

fn moonlit(moons: &[Sun]) -> Option<f32> {
    moons.first().map(|moon| luminance(moon.irradiance) / MOST_MOONLIGHT)
}

/// A moon as it appears beside lamps.
fn beside_lamps(moon: Sun, plainly_lit: f32) -> Sun {
    let dimmed = (MOST_MOONLIGHT * plainly_lit / luminance(moon.irradiance).max(f32::MIN_POSITIVE)).min(1.0);
    Sun { irradiance: moon.irradiance * MOON_TINT * dimmed, ..moon }
}
