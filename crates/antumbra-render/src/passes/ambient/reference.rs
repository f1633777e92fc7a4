//! Final gathering and its smoothing, on the CPU.

use glam::{DVec2, Vec2, Vec3};
use std::f32::consts::PI;

use super::Gathered;
use crate::{
    camera::View,
    light::{Lamplight, luminance},
    passes::{
        World,
        shadow::{Place, Shadows},
    },
    sampling,
    surface::Surface,
};

/// Share of the light outdoors that a surface gets which a gathering ray has hit: the sky as far as it is seen from
/// there, and further bounces. Nearby surfaces get less, for what is close to a corner is in the corner, too.
const SECOND_BOUNCE: f32 = 0.15;
/// Distance at which a surface gets half of that share, in diagonals of the scene.
const NEARBY: f64 = 0.01;
/// Lamps count for at most this much at the end of a gathering ray, relative to what is plainly lit.
const BRIGHTEST: f32 = 8.0;
/// Width of the cone that a gathering ray stands for, per distance.
const WIDTH: f64 = 0.2;

/// Gathers one row of pixels, through the pixels' middles.
pub(crate) fn row(world: &World<'_>, shadows: &Shadows<'_>, view: &View, y: u32, rays: u32) -> Vec<Gathered> {
    (0..view.width).map(|x| pixel(world, shadows, view, [x, y], rays)).collect()
}

fn pixel(world: &World<'_>, shadows: &Shadows<'_>, view: &View, [x, y]: [u32; 2], rays: u32) -> Gathered {
    let ray = view.ray(DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5));
    let seen = |hit: &_| world.surfaces.is_seen(world.tracer, hit, |_| 0.5);
    let Some(hit) = world.tracer.closest_if(&ray, seen) else { return Gathered::default() };
    let surface = world.surfaces.at(world.tracer, &ray, &hit, 0.0);
    let offset = sampling::pixel_offset(x, y);
    let points = (0..rays).map(|i| (sampling::r2(i).as_vec2() + offset).fract());
    Gathered {
        position: (surface.position - view.eye).as_vec3(),
        normal: surface.normal,
        light: points.map(|p| incoming(world, shadows, &surface, p)).sum::<Vec3>() / rays as f32,
        pixel_m: (surface.distance * view.pixel_size) as f32,
    }
}

/// Radiance along one gathering ray.
fn incoming(world: &World<'_>, shadows: &Shadows<'_>, surface: &Surface, point: Vec2) -> Vec3 {
    let mut direction = sampling::cosine_direction(surface.normal, point);
    // Where the smooth normal leans over, some directions would start into the triangle: mirror them out.
    let below = direction.dot(surface.face_normal);
    if below < 0.0 {
        direction -= 2.0 * below * surface.face_normal;
    }
    let ray = world.leaving(surface.position, surface.face_normal, direction.as_dvec3());
    let there = |hit: &_| world.surfaces.is_seen(world.tracer, hit, |_| point.x);
    match world.tracer.closest_if(&ray, there) {
        Some(hit) => {
            let far = (hit.t / (hit.t + NEARBY * world.lighting.diagonal_m)) as f32;
            bounced(world, shadows, &world.surfaces.at(world.tracer, &ray, &hit, WIDTH * hit.t), far, second_use(point))
        }
        None => world.lighting.sky.light(direction),
    }
}

/// What a surface reflects of the lights and the sky, as seen by a gathering ray. `far` is 0 for nearby to 1, `unit` any
/// number in 0..1.
fn bounced(world: &World<'_>, shadows: &Shadows<'_>, surface: &Surface, far: f32, unit: f32) -> Vec3 {
    let mut light = world.lighting.outdoors * (SECOND_BOUNCE * far);
    // At full depth: a ray's wide cone would push the lookup far off its surface.
    let place = Place { footprint_m: 0.0, ..Place::of(surface) };
    for (index, sun) in world.lighting.suns.iter().enumerate() {
        let cos = surface.face_normal.dot(sun.towards_world.as_vec3());
        if cos > 0.0 {
            light += sun.irradiance * (cos * shadows.of_sun(index, &place) / PI);
        }
    }
    surface.albedo * (light + lamplight(world, shadows, surface, &place, unit)) + surface.emissive * world.lighting.glow
}

/// What a white surface reflects of the lamps, by asking one of them: a lamp is drawn the more often the more light it
/// would give, and then stands for all. However many lamps there are, one lookup does.
fn lamplight(world: &World<'_>, shadows: &Shadows<'_>, surface: &Surface, place: &Place, mut unit: f32) -> Vec3 {
    let (mut total, mut drawn) = (0.0, None);
    world.lighting.lamps.reaching(surface.position, |index, Lamplight { towards, irradiance }| {
        let light = irradiance * surface.face_normal.dot(towards).max(0.0);
        let weight = luminance(light);
        if weight <= 0.0 {
            return;
        }
        total += weight;
        // Each takes the earlier ones' place by its share of what there is so far; what is left of the number is as
        // random as it was.
        let share = weight / total;
        if unit < share {
            drawn = Some((index, light / weight));
            unit /= share;
        } else {
            unit = (unit - share) / (1.0 - share);
        }
    });
    let Some((index, color)) = drawn else { return Vec3::ZERO };
    // What is right beside a lamp is so bright that a ray that happens to find it would show as a speck.
    let brightness = total.min(BRIGHTEST * world.lighting.plainly_lit);
    color * (brightness * shadows.of_lamp(index, place) / PI)
}

/// A number in 0..1 from a point of the unit square, unlike either of its coordinates.
fn second_use(point: Vec2) -> f32 {
    (point.x * 61.0 + point.y * 17.0).fract()
}

/// One row of one smoothing step: an edge-avoiding blur whose taps lie `spacing` pixels apart. After Dammertz, Sewtz,
/// Hanika and Lensch (2010), "Edge-Avoiding A-Trous Wavelet Transform for Fast Global Illumination Filtering"; edges
/// are where the surface's plane ends, whatever the light does there.
pub(crate) fn smooth_row(gathered: &[Gathered], width: u32, y: u32, spacing: u32) -> Vec<Gathered> {
    let (width, step) = (i64::from(width), i64::from(spacing));
    let height = gathered.len() as i64 / width;
    let at = |x: i64, y: i64| (0..width).contains(&x) && (0..height).contains(&y);
    let y = i64::from(y);
    let smooth = |x: i64| {
        let middle = gathered[(y * width + x) as usize];
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
        for (i, j) in (-2..=2).flat_map(|j| (-2..=2).map(move |i| (i, j))) {
            let (tx, ty) = (x + i * step, y + j * step);
            if at(tx, ty) {
                let tap = gathered[(ty * width + tx) as usize];
                let weight =
                    SPLINE[(i + 2) as usize] * SPLINE[(j + 2) as usize] * tap.affinity(middle.position, middle.normal);
                sum += tap.light * weight;
                weights += weight;
            }
        }
        Gathered { light: if weights > 0.0 { sum / weights } else { middle.light }, ..middle }
    };
    (0..width).map(smooth).collect()
}

/// The B3 spline.
const SPLINE: [f32; 5] = [1.0, 4.0, 6.0, 4.0, 1.0];
