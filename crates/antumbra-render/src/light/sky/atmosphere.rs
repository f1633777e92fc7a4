//! Light through the atmosphere.
//!
//! Nishita, Sirai, Tadamura and Nakamae (1993), "Display of the Earth Taking into Account Atmospheric Scattering", for
//! light scattered once; the atmosphere with its ozone, and all further scattering in closed form, from Hillaire
//! (2020), "A Scalable and Production Ready Sky and Atmosphere Rendering Technique", sections 4 and 5.5. It departs
//! from the latter in that the sun stands still: further scattering depends on the height alone.
//!
//! Lengths are kilometres, coefficients per kilometre; sunlight outside the atmosphere has an irradiance of 1.

use glam::Vec3;
use std::f32::consts::PI;

use crate::sampling::r2;

const GROUND_RADIUS: f32 = 6360.0;
const TOP_RADIUS: f32 = 6460.0;
const RAYLEIGH: Vec3 = Vec3::new(5.802e-3, 13.558e-3, 33.1e-3);
const RAYLEIGH_HEIGHT: f32 = 8.0;
const MIE_SCATTERING: f32 = 3.996e-3;
const MIE_EXTINCTION: f32 = 4.44e-3;
const MIE_HEIGHT: f32 = 1.2;
const MIE_ASYMMETRY: f32 = 0.8;
const OZONE: Vec3 = Vec3::new(0.650e-3, 1.881e-3, 0.085e-3);
/// The Earth's mean reflectance.
const GROUND_ALBEDO: f32 = 0.3;
/// The viewer stands this high, so that the horizon is not inside the ground.
pub(super) const VIEWER_HEIGHT: f32 = 0.2;

/// The atmosphere on a day with the sun at one height.
pub(super) struct Atmosphere {
    sun: Vec3,
    /// Radiance of light scattered more than once, at heights 0, 1/8, 4/8, 9/8, ... of 100 km.
    multiple: [Vec3; HEIGHTS],
}

const HEIGHTS: usize = 12;

impl Atmosphere {
    /// For the sine of the sun's height; the sun's azimuth is +x.
    pub(super) fn new(sun_y: f32) -> Self {
        let sun = Vec3::new((1.0 - sun_y * sun_y).max(0.0).sqrt(), sun_y, 0.0);
        let multiple = core::array::from_fn(|i| multiple_scattering(height_of(i as f32), sun));
        Self { sun, multiple }
    }

    /// Light scattered into a view ray of someone near the ground, at least horizontal.
    pub(super) fn radiance(&self, view: Vec3) -> Vec3 {
        let cos = view.dot(self.sun);
        let (rayleigh_phase, mie_phase) = (3.0 / (16.0 * PI) * (1.0 + cos * cos), mie_phase(cos));
        let mut light = Vec3::ZERO;
        march(VIEWER_HEIGHT, view, 32, |step| {
            let lit = transmittance(step.air.height, step.sun_y(self.sun));
            let once = (step.air.rayleigh * rayleigh_phase + step.air.mie * mie_phase) * lit;
            light += step.weight * (once + (step.air.rayleigh + step.air.mie) * self.multiple_at(step.air.height));
        });
        light
    }

    fn multiple_at(&self, height: f32) -> Vec3 {
        let x = (height.max(0.0) / height_of(1.0)).sqrt().min((HEIGHTS - 1) as f32 - 1e-3);
        let i = x as usize;
        self.multiple[i].lerp(self.multiple[i + 1], x - i as f32)
    }
}

fn height_of(index: f32) -> f32 {
    (TOP_RADIUS - GROUND_RADIUS) * (index / (HEIGHTS - 1) as f32).powi(2)
}

/// Hillaire's equations 5 to 10: light scattered twice, times the geometric series of all that follows.
fn multiple_scattering(height: f32, sun: Vec3) -> Vec3 {
    const DIRECTIONS: u32 = 64;
    let (mut twice, mut transfer) = (Vec3::ZERO, Vec3::ZERO);
    for i in 0..DIRECTIONS {
        let view = sphere_direction(r2(i).as_vec2());
        let seen = march(height, view, 16, |step| {
            let scattering = step.weight * (step.air.rayleigh + step.air.mie);
            twice += scattering * transmittance(step.air.height, step.sun_y(sun)) / (4.0 * PI);
            transfer += scattering;
        });
        if to_ground(height, view.y).is_some() {
            twice += seen * transmittance(0.0, sun.y) * (GROUND_ALBEDO * sun.y / PI);
        }
    }
    let (twice, transfer) = (twice / DIRECTIONS as f32, transfer / DIRECTIONS as f32);
    twice / (Vec3::ONE - transfer).max(Vec3::splat(0.05))
}

fn sphere_direction(point: glam::Vec2) -> Vec3 {
    let y = 1.0 - 2.0 * point.y;
    let flat = (1.0 - y * y).max(0.0).sqrt();
    let (sin, cos) = (std::f32::consts::TAU * point.x).sin_cos();
    Vec3::new(flat * cos, y, flat * sin)
}

/// What the atmosphere is like at a height.
struct Air {
    height: f32,
    /// Scattering by air and by haze.
    rayleigh: Vec3,
    mie: Vec3,
    extinction: Vec3,
}

impl Air {
    fn at(height: f32) -> Self {
        let (air, haze) = ((-height / RAYLEIGH_HEIGHT).exp(), (-height / MIE_HEIGHT).exp());
        let ozone = (1.0 - (height - 25.0).abs() / 15.0).max(0.0);
        Self {
            height,
            rayleigh: RAYLEIGH * air,
            mie: Vec3::splat(MIE_SCATTERING * haze),
            extinction: RAYLEIGH * air + MIE_EXTINCTION * haze + OZONE * ozone,
        }
    }
}

/// A piece of a view ray.
struct Step {
    air: Air,
    /// Upward there.
    up: Vec3,
    /// Length of the piece as far as its light reaches the viewer.
    weight: Vec3,
}

impl Step {
    fn sun_y(&self, sun: Vec3) -> f32 {
        self.up.dot(sun)
    }
}

/// Walks a view ray to the ground or the top of the atmosphere, in steps that grow: the air near the viewer is the
/// densest. Returns the share of light that comes all the way.
fn march(height: f32, view: Vec3, steps: usize, mut visit: impl FnMut(Step)) -> Vec3 {
    let length = to_ground(height, view.y).unwrap_or_else(|| to_top(height, view.y));
    let mut seen = Vec3::ONE;
    let mut from = 0.0;
    for i in 1..=steps {
        let to = length * (i as f32 / steps as f32).powi(2);
        let p = Vec3::Y * (GROUND_RADIUS + height) + view * (0.5 * (from + to));
        let air = Air::at((p.length() - GROUND_RADIUS).max(0.0));
        let through = (-air.extinction * (to - from)).exp();
        let weight = seen * (Vec3::ONE - through) / air.extinction.max(Vec3::splat(1e-9));
        visit(Step { air, up: p.normalize(), weight });
        seen *= through;
        from = to;
    }
    seen
}

/// Share of sunlight that reaches a height, for the sine of the sun's height there.
pub(super) fn transmittance(height: f32, sun_y: f32) -> Vec3 {
    if to_ground(height, sun_y).is_some() {
        return Vec3::ZERO;
    }
    let sun = Vec3::new((1.0 - sun_y * sun_y).max(0.0).sqrt(), sun_y, 0.0);
    march(height, sun, 16, |_| {})
}

/// Distance to the top of the atmosphere, in a direction of the given sine.
fn to_top(height: f32, sin: f32) -> f32 {
    let radius = GROUND_RADIUS + height;
    let b = radius * sin;
    (b * b + TOP_RADIUS * TOP_RADIUS - radius * radius).max(0.0).sqrt() - b
}

/// Distance to the ground, where there is ground.
fn to_ground(height: f32, sin: f32) -> Option<f32> {
    let radius = GROUND_RADIUS + height;
    let b = radius * sin;
    let inside = b * b - height * (radius + GROUND_RADIUS);
    (sin < 0.0 && inside >= 0.0).then(|| -b - inside.sqrt())
}

/// Cornette and Shanks (1992).
fn mie_phase(cos: f32) -> f32 {
    let g = MIE_ASYMMETRY;
    let base = 1.0 + g * g - 2.0 * g * cos;
    3.0 / (8.0 * PI) * (1.0 - g * g) * (1.0 + cos * cos) / ((2.0 + g * g) * base * base.sqrt())
}
