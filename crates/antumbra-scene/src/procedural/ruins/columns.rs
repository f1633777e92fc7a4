//! Columns, whole and broken, as tubes that are open at the top; their fallen drums; blocks without undersides.

use core::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::church::{AISLE, ARCADE_SPRING, BAY, BAYS, CROSSING, NAVE, WEST, north_arcade, south_arcade};
use super::looks::{ASHLAR, CARVED};
use super::stone::weather;
use super::{Site, cloister, ground};
use crate::procedural::rng::Rng;
use crate::procedural::sheets::{Pattern, Sheets};
use crate::procedural::solids::Turn;

/// Profile of a column: (height as a share of the whole, radius as a share of the shaft's).
const PROFILE: [(f64, f64); 13] = [
    (-0.14, 1.55),
    (0.045, 1.55),
    (0.055, 1.42),
    (0.085, 1.42),
    (0.10, 1.12),
    (0.115, 1.0),
    (0.50, 0.97),
    (0.84, 0.92),
    (0.85, 1.05),
    (0.865, 0.94),
    (0.90, 1.02),
    (0.96, 1.42),
    (1.0, 1.5),
];

/// How many points of the profile make up the base.
const BASE: usize = 6;

pub(super) fn build(s: &mut Sheets, site: &Site) {
    let mut rng = site.rng.fork(100);
    for i in 1..BAYS {
        let x = WEST + BAY * i as f64;
        for (z, standing) in [(-NAVE, north_arcade(x)), (NAVE, south_arcade(x))] {
            let stump = rng.range(0.5, 3.4);
            let broken = (standing < ARCADE_SPRING + 2.0).then_some(stump);
            column(s, site, &mut rng, DVec2::new(x, z), 0.52, ARCADE_SPRING, broken);
        }
    }
    piers(s, site);
    // A lone pair in the chapter house, and a fountain in the garth.
    for (z, broken) in [(22.5, None), (28.5, Some(2.3))] {
        column(s, site, &mut rng, DVec2::new(cloister::EAST + 4.6, z), 0.30, 3.4, broken);
    }
    fountain(s, site);
}

/// A column as tall as `height`, or broken askew at a lower height.
fn column(s: &mut Sheets, site: &Site, rng: &mut Rng, at: DVec2, radius: f64, height: f64, broken: Option<f64>) {
    let tint = |at: DVec3| weather(site, at);
    let lean = DVec2::new(rng.range(-0.5, 0.5), rng.range(-0.5, 0.5)) * 1.6;
    let ring = |&(share, width): &(f64, f64)| (DVec3::new(at.x, share * height, at.y), width * radius);
    let Some(top) = broken else {
        return s.tube(CARVED, 16, &PROFILE.iter().map(ring).collect::<Vec<_>>(), &tint);
    };
    s.tube(CARVED, 16, &PROFILE[..BASE].iter().map(ring).collect::<Vec<_>>(), &tint);
    let (around, foot) = (TAU * radius, PROFILE[BASE - 1].0 * height);
    let place = |p: DVec2| {
        // The seam closes to the bit: at the end of the way round stands the same angle as at its start.
        let angle = if p.x >= around { 0.0 } else { p.x / radius };
        DVec3::new(at.x + radius * libm::cos(angle), p.y + foot, at.y - radius * libm::sin(angle))
    };
    let left = |p: DVec2| {
        let angle = p.x / radius;
        let askew = lean.x * libm::cos(angle) + lean.y * libm::sin(angle) + 0.12 * libm::sin(5.0 * angle);
        top + askew * radius - (p.y + foot)
    };
    let cell = (site.cell_m * 0.5).min(around / 8.0);
    s.side(CARVED, &Pattern::cut(DVec2::new(around, height - foot), cell, left), &place, true, &tint);
}

/// Clustered shafts at the corners of the crossing.
fn piers(s: &mut Sheets, site: &Site) {
    let tint = |at: DVec3| weather(site, at);
    for (x, z, top) in
        [(CROSSING.0, -NAVE, 9.0), (CROSSING.1, -NAVE, 9.0), (CROSSING.0, NAVE, 8.8), (CROSSING.1, NAVE, 3.6)]
    {
        for i in 0..8 {
            let angle = TAU * (f64::from(i) + 0.5) / 8.0;
            let at = DVec2::new(x, z) + DVec2::new(libm::cos(angle), libm::sin(angle)) * 0.74;
            let height = top - if top < 5.0 { 0.35 * f64::from(i % 3) } else { 0.0 };
            let shaft = [(-0.8, 0.42), (0.5, 0.42), (0.62, 0.29), (height - 0.5, 0.27), (height, 0.42)];
            let line: Vec<_> = shaft.iter().map(|&(y, r)| (DVec3::new(at.x, y, at.y), r)).collect();
            s.tube(CARVED, 9, &line, &tint);
        }
    }
}

/// A basin on a foot, both open shells.
fn fountain(s: &mut Sheets, site: &Site) {
    let at = DVec2::new((cloister::WEST + cloister::EAST) * 0.5, (AISLE + cloister::SOUTH) * 0.5);
    let base = ground::height(site, at.x, at.y);
    let tint = |at: DVec3| weather(site, at);
    for line in [
        &[(-0.5, 2.3), (0.55, 2.3), (0.6, 2.45), (0.72, 2.45), (0.72, 2.1), (0.2, 1.95)][..],
        &[(-0.3, 0.34), (0.9, 0.28), (1.05, 0.42), (1.3, 1.05), (1.42, 1.1), (1.30, 0.95), (1.2, 0.4)][..],
    ] {
        let line: Vec<_> = line.iter().map(|&(y, r)| (DVec3::new(at.x, base + y, at.y), r)).collect();
        s.tube(CARVED, 12, &line, &tint);
    }
}

/// What has fallen: drums by the broken columns, blocks below the broken walls.
pub(super) fn rubble(s: &mut Sheets, site: &Site) {
    let mut rng = site.rng.fork(110);
    for i in 1..BAYS {
        let x = WEST + BAY * i as f64;
        for (z, standing) in [(-NAVE, north_arcade(x)), (NAVE, south_arcade(x))] {
            if standing < ARCADE_SPRING + 2.0 {
                drums(s, site, &mut rng, DVec2::new(x, z));
            }
        }
    }
    let heaps = [(-2.0, -4.0, 5.0), (-8.0, 6.5, 5.0), (-30.5, -8.0, 3.5), (19.0, 13.0, 6.0), (24.0, 5.0, 4.0)];
    let count = site.many(46.0).min(400);
    for (x, z, reach) in heaps {
        for _ in 0..count {
            let (angle, away) = (rng.range(0.0, TAU), reach * rng.unit());
            let at = DVec2::new(x + away * libm::cos(angle), z + away * libm::sin(angle));
            let pile = 0.9 * (1.0 - away / reach);
            block(s, site, &mut rng, at, pile);
        }
    }
}

fn drums(s: &mut Sheets, site: &Site, rng: &mut Rng, at: DVec2) {
    for _ in 0..1 + rng.index(2) {
        let (angle, away) = (rng.range(0.0, TAU), rng.range(1.4, 3.2));
        let center = at + DVec2::new(libm::cos(angle), libm::sin(angle)) * away;
        let roll = rng.range(0.0, TAU);
        let half = DVec3::new(libm::cos(roll), rng.range(-0.12, 0.12), libm::sin(roll)) * rng.range(0.35, 0.75);
        let middle = DVec3::new(center.x, ground::height(site, center.x, center.y) + rng.range(0.18, 0.42), center.y);
        s.tube(CARVED, 14, &[(middle - half, 0.5), (middle + half, 0.49)], &|at| weather(site, at));
    }
}

/// A hewn block, askew, without an underside.
fn block(s: &mut Sheets, site: &Site, rng: &mut Rng, at: DVec2, lift: f64) {
    let half = DVec3::new(rng.range(0.16, 0.5), rng.range(0.12, 0.26), rng.range(0.14, 0.34));
    let (turn, tilt) = (Turn::radians(rng.range(0.0, TAU)), DVec2::new(rng.range(-0.4, 0.4), rng.range(-0.4, 0.4)));
    let base = ground::height(site, at.x, at.y) + lift * rng.unit();
    let corner = |x: f64, y: f64, z: f64| {
        let p = turn.apply(half * DVec3::new(x, y, z));
        DVec3::new(at.x + p.x, base + p.y + tilt.x * p.x + tilt.y * p.z, at.y + p.z)
    };
    let faces = [
        [(-1.0, 1.0, 1.0), (1.0, 1.0, 1.0), (1.0, 1.0, -1.0), (-1.0, 1.0, -1.0)],
        [(-1.0, -1.0, 1.0), (1.0, -1.0, 1.0), (1.0, 1.0, 1.0), (-1.0, 1.0, 1.0)],
        [(1.0, -1.0, -1.0), (-1.0, -1.0, -1.0), (-1.0, 1.0, -1.0), (1.0, 1.0, -1.0)],
        [(1.0, -1.0, 1.0), (1.0, -1.0, -1.0), (1.0, 1.0, -1.0), (1.0, 1.0, 1.0)],
        [(-1.0, -1.0, -1.0), (-1.0, -1.0, 1.0), (-1.0, 1.0, 1.0), (-1.0, 1.0, -1.0)],
    ];
    let uv = [(0.1, 0.05), (0.7, 0.05), (0.7, 0.35), (0.1, 0.35)].map(DVec2::from);
    for face in faces {
        s.quad(ASHLAR, face.map(|(x, y, z)| corner(x, y, z)), uv, &|at| weather(site, at));
    }
}
