//! A clear sky for any height of the sun or for the night, as a table of radiance by direction, and an endless plain
//! under it.
//!
//! The table's layout, packed towards the horizon, is that of Hillaire (2020); see [`atmosphere`] and [`night`] for what
//! is in it.

mod atmosphere;
mod night;

use glam::{DVec3, Vec3};
use std::f32::consts::{FRAC_PI_2, PI};

use super::Sun;
use crate::sampling::{cosine_direction, r2};
use atmosphere::Atmosphere;

/// The plain's reflectance: that of hazy land and water seen from far, so that scenes float on a quiet background.
const PLAIN_ALBEDO: Vec3 = Vec3::new(0.10, 0.135, 0.165);
/// How fast the plain fades into the horizon, in units of the sine of the angle below it.
const PLAIN_HAZE: f32 = 0.2;
/// Sine of the least height of the sun, about one degree.
const LOWEST_SUN: f32 = 0.02;

/// Columns (from the sun's azimuth round to the one opposite) and rows (from the horizon to the zenith) of the table.
const COLUMNS: usize = 64;
const ROWS: usize = 48;

/// How much more light the night's sky gives than it shows: the town's own glow and eyes that are used to the dark.
const NIGHT_FILL: f32 = 3.0;
/// The brightest star, relative to the horizon.
const STARLIGHT: f32 = 30.0;

/// The sky of one sun, or of a night.
#[derive(Clone, Debug)]
pub struct Sky {
    pub(crate) towards_sun: Vec3,
    /// Unit vector to the sun's azimuth.
    pub(crate) sun_azimuth: Vec3,
    pub(crate) radiance: Vec<Vec3>,
    pub(crate) plain: Vec3,
    /// Mean radiance over the upper hemisphere, weighted by the cosine to the zenith: irradiance over pi.
    pub(crate) overhead: Vec3,
    pub(crate) disc: Vec3,
    /// Light given per light shown.
    pub(crate) fill: f32,
    /// Radiance of the brightest star.
    pub(crate) stars: f32,
}

impl Sky {
    /// The sky that goes with a sun. A sun below the horizon gets the sky of one that is setting.
    #[must_use]
    pub fn new(sun: &Sun) -> Self {
        let above =
            DVec3::new(sun.towards_world.x, sun.towards_world.y.max(f64::from(LOWEST_SUN)), sun.towards_world.z);
        let towards_sun = above.normalize().as_vec3();
        let flat = Vec3::new(towards_sun.x, 0.0, towards_sun.z);
        let mut sky = Self {
            towards_sun,
            sun_azimuth: flat.try_normalize().unwrap_or(Vec3::Z),
            radiance: table(towards_sun.y),
            plain: Vec3::ZERO,
            overhead: Vec3::ZERO,
            disc: sun.irradiance * 60.0,
            fill: 1.0,
            stars: 0.0,
        };
        sky.overhead = sky.mean_overhead();
        sky.plain = PLAIN_ALBEDO * (sun.irradiance * (towards_sun.y / PI) + sky.overhead);
        sky
    }

    /// The sky of a night, whose horizon has the given radiance (linear, in the unit of pictures). The moon, if there is
    /// one, stands in it but does not light it.
    #[must_use]
    pub fn night(horizon: f32, moon: Option<&Sun>) -> Self {
        let row = |i: usize| night::gradient(row_height(i / COLUMNS).sin()) * horizon;
        let mut sky = Self {
            towards_sun: moon.map_or(Vec3::NEG_Y, |moon| moon.towards_world.as_vec3()),
            sun_azimuth: Vec3::Z,
            radiance: (0..COLUMNS * ROWS).map(row).collect(),
            plain: Vec3::ZERO,
            overhead: Vec3::ZERO,
            disc: moon.map_or(Vec3::ZERO, |moon| moon.irradiance * 60.0),
            fill: NIGHT_FILL,
            stars: STARLIGHT * horizon,
        };
        sky.overhead = sky.mean_overhead();
        sky.plain = PLAIN_ALBEDO * sky.overhead;
        sky
    }

    /// Radiance from a direction (unit vector to where the light comes from), without the sun's disc.
    #[must_use]
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        if direction.y >= 0.0 {
            return self.lookup(direction);
        }
        let horizon = self.lookup(Vec3::new(direction.x, 0.0, direction.z));
        horizon.lerp(self.plain, (-PLAIN_HAZE / -direction.y).exp())
    }

    /// Radiance as a source of light for surfaces: paler than it looks, as a camera that is balanced for daylight
    /// records shade.
    #[must_use]
    pub fn light(&self, direction: Vec3) -> Vec3 {
        paler(self.radiance(direction), 0.35) * self.fill
    }

    /// Radiance with the disc of the sun or moon and the stars, for pictures of the sky itself.
    #[must_use]
    pub fn radiance_with_disc(&self, direction: Vec3) -> Vec3 {
        let sky = self.radiance(direction);
        // The disc's edge: 0.27 degrees, softened to a third of a degree.
        let away = direction.dot(self.towards_sun).clamp(-1.0, 1.0).acos().to_degrees();
        let disc = ((0.33 - away) / 0.12).clamp(0.0, 1.0);
        if direction.y <= 0.0 {
            return sky;
        }
        let stars = if self.stars > 0.0 { self.stars * night::stars(direction) } else { 0.0 };
        sky + self.disc * (disc * disc) + stars
    }

    /// Light from all sides onto a surface without anything in the way, over pi: what a white surface reflects.
    #[must_use]
    pub fn ambient(&self, normal: Vec3) -> Vec3 {
        self.plain.lerp(self.overhead, 0.5 + 0.5 * normal.y)
    }

    /// What a white surface that faces the zenith reflects of the sky alone.
    #[must_use]
    pub fn overhead(&self) -> Vec3 {
        self.overhead
    }

    fn lookup(&self, direction: Vec3) -> Vec3 {
        let flat = Vec3::new(direction.x, 0.0, direction.z).normalize_or_zero();
        let azimuth = flat.dot(self.sun_azimuth).clamp(-1.0, 1.0).acos();
        let height = direction.y.clamp(0.0, 1.0).asin() / FRAC_PI_2;
        let x = azimuth / PI * (COLUMNS - 1) as f32;
        let y = height.sqrt() * (ROWS - 1) as f32;
        let (column, row) = ((x as usize).min(COLUMNS - 2), (y as usize).min(ROWS - 2));
        let (fx, fy) = (x - column as f32, y - row as f32);
        let at = |c: usize, r: usize| self.radiance[(row + r) * COLUMNS + column + c];
        at(0, 0).lerp(at(1, 0), fx).lerp(at(0, 1).lerp(at(1, 1), fx), fy)
    }

    fn mean_overhead(&self) -> Vec3 {
        let count = 1024;
        (0..count).map(|i| self.light(cosine_direction(Vec3::Y, r2(i).as_vec2()))).sum::<Vec3>() / count as f32
    }
}

/// Share of sunlight that reaches the ground, for the sine of the sun's height; a sun below the horizon counts as
/// one that is setting.
pub(super) fn sun_transmittance(sun_y: f32) -> Vec3 {
    atmosphere::transmittance(atmosphere::VIEWER_HEIGHT, sun_y.max(LOWEST_SUN))
}

/// The sky's colour on a screen. The atmosphere is computed for three single wavelengths, which a screen's primaries
/// are not: real skies are paler than that. They are brighter too, as far as there is ever a little thin cloud.
fn perceived(radiance: Vec3) -> Vec3 {
    paler(radiance, 0.25) * 1.2
}

fn paler(color: Vec3, amount: f32) -> Vec3 {
    color.lerp(Vec3::splat(color.dot(Vec3::new(0.2126, 0.7152, 0.0722))), amount)
}

/// The whole sky for the sine of the sun's height: rows from the horizon up, packed towards the horizon.
fn table(sun_y: f32) -> Vec<Vec3> {
    let atmosphere = Atmosphere::new(sun_y);
    let texel = |i: usize| {
        let azimuth = (i % COLUMNS) as f32 / (COLUMNS - 1) as f32 * PI;
        let (sin, cos) = row_height(i / COLUMNS).sin_cos();
        perceived(atmosphere.radiance(Vec3::new(cos * azimuth.cos(), sin, cos * azimuth.sin())))
    };
    (0..COLUMNS * ROWS).map(texel).collect()
}

/// Angle above the horizon of a row of the table.
fn row_height(row: usize) -> f32 {
    (row as f32 / (ROWS - 1) as f32).powi(2) * FRAC_PI_2
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sky(height_deg: f64) -> Sky {
        let (sin, cos) = height_deg.to_radians().sin_cos();
        Sky::new(&Sun { name: None, towards_world: DVec3::new(cos, sin, 0.0), irradiance: Vec3::ONE })
    }

    #[test]
    fn the_zenith_is_blue_and_the_low_sun_is_red() {
        let zenith = sky(50.0).radiance(Vec3::Y);
        assert!(zenith.z > 1.5 * zenith.x, "{zenith}");
        let (high, low) = (sun_transmittance(0.8), sun_transmittance(0.05));
        assert!(high.x < 1.4 * high.z && low.x > 3.0 * low.z, "{high} {low}");
    }

    #[test]
    fn the_sky_gives_less_light_than_the_sun_and_more_than_none() {
        for height in [5.0, 20.0, 60.0, 90.0] {
            let sky = sky(height);
            let up = sky.overhead().y * PI;
            assert!(up > 0.01 && up < 0.4, "{height}: {up}");
            assert!(sky.radiance(-Vec3::Y).is_finite() && sky.radiance(Vec3::X).is_finite());
        }
    }

    #[test]
    fn there_is_no_seam_at_the_horizon() {
        let sky = sky(30.0);
        for azimuth in [0.0_f32, 1.0, 2.0, 3.0] {
            let at = |y: f32| sky.radiance(Vec3::new(azimuth.cos(), y, azimuth.sin()).normalize());
            assert!((at(1e-4) - at(-1e-4)).length() < 0.02 * at(0.0).length());
        }
    }

    #[test]
    fn an_overhead_sun_has_a_finite_sky() {
        assert!(sky(90.0).radiance(Vec3::new(0.1, 0.9, 0.0).normalize()).is_finite());
    }
}
