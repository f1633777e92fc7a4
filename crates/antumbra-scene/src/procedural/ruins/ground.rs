//! The ground: a dell as one open sheet, and flagstones on it where the church's floor is left.

use glam::{DVec2, DVec3};

use super::Site;
use super::church::{AISLE, CHOIR, NAVE, WEST};
use super::cloister::SOUTH;
use super::looks::{THIN_ASHLAR, TURF};
use super::stone::weather;
use crate::procedural::noise::{fractal_noise, gradient_noise, smoothstep};
use crate::procedural::palette::linear_color;
use crate::procedural::sheets::{Pattern, Sheets};

/// The sheet's corners.
pub(super) const MIN: DVec2 = DVec2::new(-112.0, -88.0);
pub(super) const MAX: DVec2 = DVec2::new(96.0, 102.0);

/// How far a point is from the buildings, metres.
pub(super) fn outside(x: f64, z: f64) -> f64 {
    let (lo, hi) = (DVec2::new(WEST - 2.0, -18.0), DVec2::new(CHOIR + 6.0, SOUTH + 2.0));
    let p = DVec2::new(x, z);
    (lo - p).max(p - hi).max(DVec2::ZERO).length()
}

/// Height of the ground: level where the abbey stands, rising all round.
pub(super) fn height(site: &Site, x: f64, z: f64) -> f64 {
    let p = DVec2::new(x, z);
    let away = outside(x, z);
    let bumps = 0.10 * gradient_noise(site.seed ^ 0x90, p / 3.4);
    let swell = 1.5 * fractal_noise(site.seed ^ 0x91, p / 31.0, 3, 0.5) * smoothstep(2.0, 26.0, away);
    let rise = 13.0 * smoothstep(22.0, 78.0, away) * (0.8 + 0.5 * gradient_noise(site.seed ^ 0x92, p / 55.0));
    bumps + swell + rise
}

/// Positive where flagstones are left.
pub(super) fn flags(site: &Site, x: f64, z: f64) -> f64 {
    let inside = (AISLE - 0.4 - z.abs()).min(x - WEST - 0.2).min(CHOIR + NAVE - x);
    let lost = fractal_noise(site.seed ^ 0x93, DVec2::new(x, z) / 6.0, 3, 0.6);
    let walked = 0.5 * smoothstep(3.4, 0.8, z.abs());
    (inside * 0.3).min(0.12 + lost + walked - 0.25 * smoothstep(0.0, 14.0, x - 4.0))
}

/// 1 on the path from the gate to the church, 0 off it.
pub(super) fn path(x: f64, z: f64) -> f64 {
    let course = -9.5 + 9.5 * smoothstep(-56.0, -33.0, x) + 0.8 * libm::sin(x * 0.21);
    smoothstep(1.9, 0.8, (z - course).abs()) * smoothstep(WEST + 1.0, WEST - 0.5, x)
}

pub(super) fn build(s: &mut Sheets, site: &Site) {
    let whole = Pattern::cut(MAX - MIN, site.cell_m * 7.5, |_| 1.0);
    // Seen from above, s runs east and t north.
    let at = |p: DVec2| (MIN.x + p.x, MAX.y - p.y);
    let place = |p: DVec2| {
        let (x, z) = at(p);
        DVec3::new(x, height(site, x, z), z)
    };
    s.side(TURF, &whole, &place, true, &|at| cover(site, at));
    let (lo, hi) = (DVec2::new(WEST, -AISLE), DVec2::new(CHOIR + NAVE, AISLE));
    let floor = Pattern::cut(hi - lo, site.cell_m * 1.6, |p| flags(site, lo.x + p.x, hi.y - p.y));
    let paved = |p: DVec2| {
        let (x, z) = (lo.x + p.x, hi.y - p.y);
        DVec3::new(x, height(site, x, z) + 0.07, z)
    };
    s.side(THIN_ASHLAR, &floor, &paved, true, &|at| weather(site, at + DVec3::Y * 1.2) * 0.86);
}

/// The linear colour of the ground.
fn cover(site: &Site, at: DVec3) -> DVec3 {
    let [meadow, lush, dry, earth, gravel] = [0x7d8a48, 0x5c7436, 0x9a9358, 0x7a6548, 0xb3a27c].map(linear_color);
    let p = DVec2::new(at.x, at.z);
    let patch = fractal_noise(site.seed ^ 0x95, p / 14.0, 4, 0.55);
    let fine = gradient_noise(site.seed ^ 0x96, p / 2.1);
    let mut color = meadow.lerp(lush, smoothstep(-0.4, 0.35, patch));
    color = color.lerp(dry, smoothstep(0.1, 0.6, -patch + 0.3 * fine));
    let bare = smoothstep(0.25, 0.6, fine + 0.5 * patch) * smoothstep(14.0, 2.0, outside(at.x, at.z));
    color = color.lerp(earth, 0.7 * bare);
    color.lerp(gravel, 0.85 * path(at.x, at.z))
}
