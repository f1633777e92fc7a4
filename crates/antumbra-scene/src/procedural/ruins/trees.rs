//! Trees: trunks and boughs as open tubes, leaves as cards.

use core::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::looks::{BARK, BEECH};
use super::{Site, ground};
use crate::procedural::rng::Rng;
use crate::procedural::sheets::{Card, Sheets};

/// Different trees.
pub(super) const KINDS: usize = 4;
/// Cards per tree at scale 1.
const CARDS: f64 = 440.0;

/// A tree's place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot {
    pub at: DVec2,
    pub angle: f64,
    pub size: f64,
    pub kind: usize,
}

/// Trees by hand where cameras look, then woods on the slopes all round.
pub(super) fn spots(site: &Site) -> Vec<Spot> {
    const CHOSEN: [(f64, f64, f64); 11] = [
        (-46.0, 11.5, 1.15),
        (-52.5, 7.0, 0.95),
        (-43.0, 19.5, 1.0),
        (-40.5, -15.5, 1.1),
        (-3.0, 0.8, 0.72),
        (20.5, 11.0, 0.9),
        (-3.0, 31.0, 0.7),
        (-34.0, 44.0, 1.05),
        (10.0, 47.0, 1.2),
        (-14.0, -21.0, 1.1),
        (6.0, -19.5, 0.95),
    ];
    let mut rng = site.rng.fork(500);
    let mut spots: Vec<Spot> = CHOSEN
        .iter()
        .enumerate()
        .map(|(kind, &(x, z, size))| Spot { at: DVec2::new(x, z), angle: rng.range(0.0, TAU), size, kind })
        .collect();
    for _ in 0..900 {
        let at = DVec2::new(rng.range(ground::MIN.x, ground::MAX.x), rng.range(ground::MIN.y, ground::MAX.y));
        let (size, angle, kind) = (rng.range(0.85, 1.4), rng.range(0.0, TAU), rng.index(KINDS));
        // The south-west stays open: the overview looks in from there.
        let view = (at - DVec2::new(-56.0, 58.0)).length() < 36.0 || ground::path(at.x, at.y) > 0.0;
        let near = spots.iter().any(|s| (s.at - at).length() < 7.5);
        let border = (at - ground::MIN).min(ground::MAX - at).min_element();
        if spots.len() < 34 && !view && !near && border > 4.0 && ground::outside(at.x, at.y) > 17.0 {
            spots.push(Spot { at, angle, size, kind });
        }
    }
    spots
}

/// A tree about 11 m tall, its foot at the origin.
pub(super) fn grow(s: &mut Sheets, site: &Site, kind: usize) {
    let mut rng = site.rng.fork(520 + kind as u64);
    let tint = |at: DVec3| DVec3::splat(0.72 + 0.28 * (at.y / 3.0).clamp(0.0, 1.0)) * DVec3::new(1.0, 1.0, 0.94);
    let sway = DVec2::new(rng.range(-0.5, 0.5), rng.range(-0.5, 0.5));
    let trunk: Vec<_> = [(-0.4, 0.62), (0.15, 0.42), (1.2, 0.33), (3.2, 0.27), (5.4, 0.19), (7.6, 0.10), (9.4, 0.04)]
        .iter()
        .map(|&(y, r)| (stem(sway, y), r))
        .collect();
    s.tube(BARK, 9, &trunk, &tint);
    let boughs = 11;
    let mut masses = vec![(stem(sway, 9.2), 1.7)];
    for i in 0..boughs {
        let y = 2.9 + 4.9 * f64::from(i) / f64::from(boughs);
        let angle = 2.4 * f64::from(i) + rng.range(-0.3, 0.3);
        let long = rng.range(2.7, 3.7) * (1.0 - 0.055 * (y - 2.9));
        let tip = bough(s, stem(sway, y), angle, long, &mut rng, &tint);
        masses.push((tip, rng.range(1.25, 1.75)));
    }
    leaves(s, site, &mut rng, &masses);
}

/// The middle of the trunk at a height.
fn stem(sway: DVec2, y: f64) -> DVec3 {
    let bend = sway * (libm::sin(y * 0.5) + 0.06 * y);
    DVec3::new(bend.x, y, bend.y)
}

/// A bough that rises as it reaches out; returns its tip.
fn bough(s: &mut Sheets, from: DVec3, angle: f64, long: f64, rng: &mut Rng, tint: &dyn Fn(DVec3) -> DVec3) -> DVec3 {
    let out = DVec3::new(libm::cos(angle), 0.0, libm::sin(angle));
    let (rise, droop) = (rng.range(0.35, 0.75), rng.range(0.05, 0.25));
    let at = |t: f64| from + out * long * t + DVec3::Y * long * (rise * t - droop * t * t);
    let line: Vec<_> = (0..=3).map(|k| f64::from(k) / 3.0).map(|t| (at(t), 0.13 - 0.10 * t)).collect();
    s.tube(BARK, 6, &line, tint);
    at(1.0)
}

/// Cards in balls about the boughs' tips, each lit as the surface of its ball.
fn leaves(s: &mut Sheets, site: &Site, rng: &mut Rng, masses: &[(DVec3, f64)]) {
    let count = site.many(CARDS);
    let tone = rng.range(0.88, 1.08);
    for i in 0..count {
        let (center, radius) = masses[i % masses.len()];
        let out = direction(rng);
        let away = radius * (0.35 + 0.65 * rng.unit().sqrt());
        let at = center + out * DVec3::new(1.0, 0.78, 1.0) * away;
        // Sprays lie nearly level, as a beech's do, and hang a little at their ends.
        let up = (out + direction(rng) * 0.7 - DVec3::Y * 0.25).normalize();
        let across = up.cross((DVec3::Y + direction(rng) * 0.75).normalize()).normalize_or(DVec3::X);
        let size = rng.range(0.7, 1.0) * site.plant_size;
        let light = tone * rng.range(0.82, 1.12) * (0.78 + 0.22 * (away / radius));
        let color = DVec3::new(0.94, 1.0, 0.8) * light;
        // Between the ball's normal and the card's own: see the grass.
        let own = across.cross(up).normalize_or(out);
        let normal = (out + own * if own.dot(out) < 0.0 { -0.8 } else { 0.8 }).normalize_or(DVec3::Y);
        s.card(BEECH, &Card { foot: at - up * size, across: across * size, up: up * 2.0 * size, normal, color });
    }
}

/// A unit vector, evenly over all.
fn direction(rng: &mut Rng) -> DVec3 {
    let (y, angle) = (rng.range(-1.0, 1.0), rng.range(0.0, TAU));
    let flat = (1.0 - y * y).sqrt();
    DVec3::new(flat * libm::cos(angle), y, flat * libm::sin(angle))
}
