//! Vaults and what held them: webs of a single sheet with holes in them, ribs as open tubes, a half dome, tracery, and a
//! piece of the cloister's roof.

use core::f64::consts::{FRAC_PI_2, PI};

use glam::{DVec2, DVec3};

use super::Site;
use super::church::{AISLE, BAY, BAYS, CHOIR, CROSSING, NAVE, ROSE, WEST, north_arcade};
use super::cloister;
use super::looks::{CARVED, SLATE, THIN_ASHLAR};
use super::stone::{FOOT_M, weather};
use crate::procedural::noise::{gradient_noise, smoothstep};
use crate::procedural::sheets::{Pattern, Sheets};

/// Where the aisles' vaults begin, and how high they rise from there.
const SPRING: f64 = 4.9;
const RISE: f64 = 2.5;

pub(super) fn build(s: &mut Sheets, site: &Site) {
    aisle(s, site);
    ribs(s, site);
    half_dome(s, site);
    rose(s, site);
    mullions(s, site);
    lean_to(s, site);
}

/// Across an aisle's vault, 0..1 from the outer wall to the arcade.
fn section(t: f64, z0: f64, z1: f64) -> (f64, f64) {
    let angle = PI * t;
    let middle = (z0 + z1) * 0.5;
    (SPRING + RISE * libm::sin(angle), middle - (z1 - z0) * 0.5 * libm::cos(angle))
}

/// The barrel over the north aisle, pierced where windows and arches meet it, ragged at its end.
fn aisle(s: &mut Sheets, site: &Site) {
    let (z0, z1) = (-AISLE, -NAVE - 0.3);
    let size = DVec2::new(22.0, 7.6);
    let web = |p: DVec2| {
        let end = 17.5 + 3.5 * gradient_noise(site.seed ^ 0xa0, DVec2::new(0.3, p.y / 1.9)) - p.x;
        let hole = 0.34 + gradient_noise(site.seed ^ 0xa1, p / 2.7) - 0.25 * smoothstep(8.0, 16.0, p.x);
        end.min(3.0 * hole)
    };
    let place = |p: DVec2| {
        let (y, z) = section(p.y / size.y, z0, z1);
        DVec3::new(WEST + 0.4 + p.x, y, z)
    };
    s.side(THIN_ASHLAR, &Pattern::cut(size, site.cell_m, web), &place, true, &|at| weather(site, at));
}

/// Transverse ribs: over the north aisle where its arcade stands, and what is left of three over the nave.
fn ribs(s: &mut Sheets, site: &Site) {
    let tint = |at: DVec3| weather(site, at);
    for i in 1..BAYS {
        let x = WEST + BAY * i as f64;
        if north_arcade(x) < 7.0 {
            continue;
        }
        let arc: Vec<_> = (0..=14)
            .map(|k| section(f64::from(k) / 14.0, -AISLE, -NAVE))
            .map(|(y, z)| (DVec3::new(x, y - 0.08, z), 0.17))
            .collect();
        s.tube(CARVED, 8, &arc, &tint);
    }
    for (x, share) in [(WEST + BAY, 0.66), (WEST + 2.0 * BAY, 0.47), (WEST + 3.0 * BAY, 0.31)] {
        let last = (18.0 * share) as i32;
        let arc: Vec<_> = (0..=last)
            .map(|k| PI * f64::from(k) / 18.0)
            .map(|angle| (DVec3::new(x, 7.4 + 5.2 * libm::sin(angle), -4.7 * libm::cos(angle)), 0.21))
            .collect();
        s.tube(CARVED, 8, &arc, &tint);
    }
}

/// Half a dome over the apse, fallen in on the south side.
fn half_dome(s: &mut Sheets, site: &Site) {
    const SPRING: f64 = 8.4;
    let radius = NAVE - 0.3;
    let size = DVec2::new(PI * radius, FRAC_PI_2 * radius);
    let web = |p: DVec2| {
        let across = p.x / size.x;
        let ragged = 0.24 * gradient_noise(site.seed ^ 0xd0, p / 1.6);
        let top = 0.93 - 0.9 * smoothstep(0.62, 0.12, across) + ragged;
        top * size.y - p.y
    };
    let place = |p: DVec2| {
        let (angle, up) = (p.x / radius - FRAC_PI_2, p.y / radius);
        let r = radius * libm::cos(up);
        DVec3::new(CHOIR + r * libm::cos(angle), SPRING + radius * libm::sin(up), -r * libm::sin(angle))
    };
    s.side(THIN_ASHLAR, &Pattern::cut(size, site.cell_m, web), &place, true, &|at| weather(site, at));
}

/// The tracery of the west front's round window: a wheel, of which some spokes are gone.
fn rose(s: &mut Sheets, site: &Site) {
    const SPOKES: usize = 10;
    let (center, radius) = ROSE;
    let spoke = |i: usize| {
        let angle = 2.0 * PI * i as f64 / SPOKES as f64;
        DVec2::new(libm::cos(angle), libm::sin(angle))
    };
    let wheel = |p: DVec2| {
        let q = p - DVec2::splat(radius);
        let (r, mut stone) = (q.length(), f64::NEG_INFINITY);
        for i in (0..SPOKES).filter(|i| ![2, 3, 7].contains(i)) {
            let ahead = spoke(i);
            let on = if q.dot(ahead) > 0.0 { 0.075 - q.perp_dot(ahead).abs() } else { -1.0 };
            let foil = 0.07 - ((q - ahead * radius * 0.78).length() - 0.34).abs();
            stone = stone.max(on).max(foil);
        }
        let rings = (0.10 - (r - 0.45 * radius).abs()).max(0.12 - (r - radius).abs()).max(0.07 - (r - 0.30).abs());
        stone.max(rings)
    };
    let cell = (site.cell_m * 0.19).clamp(0.03, 0.12);
    let pattern = Pattern::cut(DVec2::splat(2.0 * radius), cell, wheel);
    let place = |p: DVec2| DVec3::new(WEST + 0.4, center - radius + p.y, p.x - radius);
    s.side(THIN_ASHLAR, &pattern, &place, true, &|at| weather(site, at));
}

/// What divides the great window of the north transept, and shafts at the corners of its gable.
fn mullions(s: &mut Sheets, site: &Site) {
    let (west, east) = CROSSING;
    let (middle, z) = ((west + east) * 0.5, -NAVE - 12.4);
    let tint = |at: DVec3| weather(site, at);
    for (x, top) in [(-0.8, 9.4), (0.8, 8.1)] {
        let bar = [(DVec3::new(middle + x, 2.9, z), 0.11), (DVec3::new(middle + x, top, z), 0.11)];
        s.tube(CARVED, 6, &bar, &tint);
    }
    for x in [west - 0.4, east + 0.4] {
        let shaft = [(DVec3::new(x, FOOT_M, z - 0.2), 0.62), (DVec3::new(x, 9.2, z - 0.2), 0.5)];
        s.tube(CARVED, 10, &shaft, &tint);
    }
}

/// The roof of the cloister's north walk, leaning against the church, as far as it has not slid off.
fn lean_to(s: &mut Sheets, site: &Site) {
    let size = DVec2::new(cloister::EAST - cloister::WEST, cloister::WALK + 0.9);
    let left = |p: DVec2| {
        let slid = gradient_noise(site.seed ^ 0xe0, p / 3.3) + 0.5 * gradient_noise(site.seed ^ 0xe1, p / 0.9);
        0.9 * smoothstep(7.0, 13.0, p.x) - 1.1 * smoothstep(19.0, 25.0, p.x) - 0.4 - 0.7 * slid
    };
    // From the wall down to beyond the arcade; the front, which is up, needs s to run east.
    let place = |p: DVec2| DVec3::new(cloister::WEST + p.x, 4.3 + 0.42 * p.y, AISLE + size.y - 0.05 - p.y);
    s.side(SLATE, &Pattern::cut(size, site.cell_m * 0.8, left), &place, true, &|at| weather(site, at));
}
