//! The sky at night: deep blue, lighter towards the horizon, with stars.

use glam::{IVec3, Vec3};

use crate::sampling::unit;

/// Colours of the zenith and the horizon, relative to one another.
const ZENITH: Vec3 = Vec3::new(0.16, 0.27, 0.62);
const HORIZON: Vec3 = Vec3::new(0.52, 0.66, 1.0);
/// How fast the horizon's glow fades with the sine of the height.
const GLOW: f32 = 4.5;

/// Stars lie in cells of this many to the unit of a unit vector, at most one in each.
const CELLS: f32 = 60.0;
/// Share of the cells with a star.
const STARRY: f32 = 0.22;
/// Radius of a star, radians: about a pixel of a picture.
const STAR_RADIUS: f32 = 0.0011;

/// Radiance relative to the horizon's, for the sine of the height.
pub(super) fn gradient(sin_height: f32) -> Vec3 {
    ZENITH.lerp(HORIZON, (-GLOW * sin_height.max(0.0)).exp())
}

/// Light of the stars in a direction: 0, or up to 1 in the middle of the brightest.
pub(super) fn stars(direction: Vec3) -> f32 {
    let cell = (direction * CELLS).floor();
    let IVec3 { x, y, z } = cell.as_ivec3();
    let random = |salt: i32| unit(x as u32, y as u32, (z * 8 + salt) as u32);
    if random(0) >= STARRY {
        return 0.0;
    }
    // Well inside its cell, whose edges then hardly ever cut it when it is moved onto the sphere.
    let place = cell + Vec3::new(random(1), random(2), random(3)) * 0.8 + 0.1;
    let away = (place.normalize_or_zero() - direction).length() / STAR_RADIUS;
    // Few are bright; near the horizon the air hides them.
    let bright = random(4).powi(6) + 0.06;
    bright * (1.0 - away * away).max(0.0) * (direction.y * 5.0).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{cosine_direction, r2};

    #[test]
    fn the_night_is_blue_and_brightest_at_the_horizon() {
        for i in 0..20 {
            let [r, _, b] = gradient(i as f32 / 20.0).to_array();
            assert!(b > 1.5 * r && gradient((i + 1) as f32 / 20.0).y < gradient(i as f32 / 20.0).y);
        }
    }

    #[test]
    fn there_are_some_stars_and_none_below_the_horizon() {
        let directions: Vec<Vec3> = (0..200_000).map(|i| cosine_direction(Vec3::Y, r2(i).as_vec2())).collect();
        let seen = directions.iter().filter(|d| stars(**d) > 0.0).count();
        assert!((10..2000).contains(&seen), "{seen}");
        assert!(directions.iter().all(|d| stars(-*d) == 0.0 && stars(*d) <= 1.06));
    }
}
