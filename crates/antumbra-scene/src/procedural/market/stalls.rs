//! Stalls: a counter of planks under a striped awning on four posts, with crates, baskets and barrels about it.

use core::f64::consts::{FRAC_PI_2, TAU};

use glam::{DVec2, DVec3};

use super::Market;
use super::looks::Look;
use super::wares::Wares;
use crate::procedural::palette::Paint;
use crate::procedural::rng::Rng;
use crate::procedural::shapes::Detail;
use crate::procedural::solids::{Builder, Shading, Turn};

/// Where stalls stand, and which way they face: radians, 0 is south (+z).
const STALLS: [(DVec2, f64); 10] = [
    (DVec2::new(-11.0, -6.6), 0.06),
    (DVec2::new(-6.4, -7.2), -0.04),
    (DVec2::new(6.8, -5.8), -0.1),
    (DVec2::new(-13.2, -1.2), FRAC_PI_2 - 0.05),
    (DVec2::new(-12.8, 3.2), FRAC_PI_2 + 0.08),
    (DVec2::new(-6.6, 7.6), 3.1),
    (DVec2::new(0.9, 8.6), 3.2),
    (DVec2::new(6.0, 7.8), 3.08),
    (DVec2::new(12.6, 2.6), -FRAC_PI_2 + 0.1),
    (DVec2::new(12.9, -3.0), -FRAC_PI_2 - 0.06),
];

const CANVAS: [[Look; 2]; 5] = [
    [Look::CanvasRed, Look::CanvasWhite],
    [Look::CanvasBlue, Look::CanvasWhite],
    [Look::CanvasOchre, Look::CanvasRed],
    [Look::CanvasGreen, Look::CanvasWhite],
    [Look::CanvasOchre, Look::CanvasWhite],
];

/// Half the counter's width, and its height.
const HALF_M: f64 = 1.4;
const COUNTER_M: f64 = 0.86;
/// The awning's back and front edge: (z, y).
const BACK: DVec2 = DVec2::new(-1.05, 2.85);
const FRONT: DVec2 = DVec2::new(1.45, 2.22);

pub(super) fn build(market: &mut Market) {
    let wares = Wares::new(market);
    for (i, (at, angle)) in STALLS.into_iter().enumerate() {
        let (at, turn) = (DVec3::new(at.x, 0.0, at.y), Turn::radians(angle));
        let canvas = CANVAS[i % CANVAS.len()];
        market.add("stall", at, turn, |b, rng, detail| stall(b, rng, detail, canvas));
        lay_out(market, wares, at, turn);
    }
}

fn stall(b: &mut Builder, rng: &mut Rng, detail: Detail, canvas: [Look; 2]) {
    frame(b);
    counter(b);
    awning(b, detail, canvas);
    // Strings of wares from the front beam.
    for i in 0..5 {
        let x = -1.0 + 0.5 * f64::from(i) + rng.range(-0.1, 0.1);
        let long = rng.range(0.25, 0.42);
        b.strut(Look::Wicker, DVec3::new(x, 2.2, 0.95), DVec3::new(x, 2.19 - long, 0.95), 0.006, 4);
        let y = 2.2 - long;
        let profile = [(0.02, y), (0.055, y - 0.05), (0.05, y - 0.16), (0.02, y - 0.24), (0.0, y - 0.26)];
        let profile: Vec<_> = profile.into_iter().rev().collect();
        b.turned(Paint::BrickRed, Shading::Smooth, DVec2::new(x, 0.95), detail.sides(7.0), &profile);
    }
}

/// Posts, beams and braces.
fn frame(b: &mut Builder) {
    let posts = [(-1.0, 2.8), (0.95, 2.32)];
    for ((z, top), x) in posts.into_iter().flat_map(|post| [(post, -HALF_M), (post, HALF_M)]) {
        b.pillar(Paint::Timber, DVec2::new(x, z), DVec2::splat(0.09), -0.05, top);
        let brace = DVec3::new(x - 0.42 * x.signum(), top - 0.06, z);
        b.strut(Paint::Timber, DVec3::new(x, top - 0.5, z), brace, 0.025, 4);
    }
    for (z, top) in posts {
        let (a, c) = (DVec3::new(-HALF_M - 0.1, top - 0.05, z), DVec3::new(HALF_M + 0.1, top - 0.05, z));
        b.strut(Paint::Timber, a, c, 0.045, 4);
    }
    for x in [-HALF_M, HALF_M] {
        b.strut(Paint::Timber, DVec3::new(x, 2.78, -1.0), DVec3::new(x, 2.3, 0.95), 0.035, 4);
    }
}

/// A counter with gaps between its front planks, a shelf behind.
fn counter(b: &mut Builder) {
    let top = DVec3::new(HALF_M + 0.08, COUNTER_M, 1.02);
    b.cuboid(Look::Plank, DVec3::new(-HALF_M - 0.08, COUNTER_M - 0.05, 0.1), top);
    for i in 0..11 {
        let x = (f64::from(i) - 5.0) * 0.26;
        b.pillar(Look::Plank, DVec2::new(x, 0.97), DVec2::new(0.19, 0.03), 0.03, COUNTER_M - 0.02);
    }
    for y in [0.2, 0.66] {
        b.cuboid(Paint::Timber, DVec3::new(-HALF_M, y, 0.92), DVec3::new(HALF_M, y + 0.08, 0.96));
    }
    for y in [0.5, 1.1, 1.6] {
        b.cuboid(Look::Plank, DVec3::new(-HALF_M, y, -1.02), DVec3::new(HALF_M, y + 0.035, -0.68));
    }
}

/// Stripes that sag a little from the back to the front, where each ends in a scallop.
fn awning(b: &mut Builder, detail: Detail, canvas: [Look; 2]) {
    const STRIPES: usize = 11;
    const THICK_M: f64 = 0.012;
    let (half, steps) = (HALF_M + 0.3, detail.steps(8.0));
    for i in 0..STRIPES {
        let x = |k: usize| half * (2.0 * k as f64 / STRIPES as f64 - 1.0);
        let (x0, x1) = (x(i), x(i + 1));
        let rings: Vec<Vec<DVec3>> = (0..=steps)
            .map(|k| {
                let t = k as f64 / steps as f64;
                let p = BACK.lerp(FRONT, t) - DVec2::Y * 0.3 * t * (1.0 - t);
                [(x0, 0.0), (x1, 0.0), (x1, THICK_M), (x0, THICK_M)]
                    .map(|(x, up)| DVec3::new(x, p.y + up, p.x))
                    .to_vec()
            })
            .collect();
        b.loft(canvas[i % 2], Shading::Flat, &rings);
        let scallop = |z: f64| -> Vec<DVec3> {
            let (top, low, radius) = (FRONT.y + THICK_M, FRONT.y - 0.14, (x1 - x0) * 0.5);
            let arcs = detail.steps(6.0).max(2);
            let arc = (0..=arcs).map(|k| core::f64::consts::PI * k as f64 / arcs as f64).map(|angle| {
                DVec3::new((x0 + x1) * 0.5 - radius * libm::cos(angle), low - radius * 0.7 * libm::sin(angle), z)
            });
            [DVec3::new(x0, top, z)].into_iter().chain(arc).chain([DVec3::new(x1, top, z)]).collect()
        };
        b.loft(canvas[i % 2], Shading::Flat, &[scallop(FRONT.x - THICK_M), scallop(FRONT.x)]);
    }
}

/// Places wares on the counter, on the shelf and on the ground.
fn lay_out(market: &mut Market, wares: Wares, at: DVec3, turn: Turn) {
    let mut rng = market.rng.fork(3000 + market.scene.nodes.len() as u64);
    let shelved = market.detail.up_to(3);
    let mut put = |kind: &str, mesh: usize, offset: DVec3, spin: f64| {
        market.place(kind, mesh, at + turn.apply(offset), turn.then(Turn::radians(spin)));
    };
    for i in 0..4 {
        let x = -1.05 + 0.7 * f64::from(i);
        let offset = DVec3::new(x, COUNTER_M, 0.62 + rng.range(-0.05, 0.05));
        put("crate", rng.pick(&wares.crates), offset, rng.range(-0.1, 0.1));
    }
    for i in 0..shelved {
        let offset = DVec3::new(-0.9 + 0.9 * i as f64, 1.135, -0.86);
        put("basket", rng.pick(&wares.baskets), offset, rng.range(0.0, TAU));
    }
    for side in [-1.0, 1.0] {
        let beside = DVec3::new(side * rng.range(1.95, 2.15), 0.0, rng.range(0.0, 0.6));
        if rng.chance(0.6) {
            put("barrel", wares.barrel, beside, rng.range(0.0, TAU));
        } else {
            let spin = rng.range(-0.4, 0.4);
            put("crate", wares.empty, beside, spin);
            put("crate", rng.pick(&wares.crates), beside + DVec3::Y * 0.3, spin + rng.range(-0.2, 0.2));
        }
        let before = DVec3::new(side * rng.range(0.5, 1.1), 0.0, rng.range(1.35, 1.5));
        put("basket", rng.pick(&wares.baskets), before, rng.range(0.0, TAU));
    }
}

/// Where those who sell stand, and the way in which their stalls face, radians.
pub(super) fn behind_counters() -> impl Iterator<Item = (DVec3, f64)> {
    STALLS.into_iter().enumerate().map(|(i, (at, angle))| {
        let aside = [-0.5, 0.3, 0.0, 0.6][i % 4];
        (DVec3::new(at.x, 0.0, at.y) + Turn::radians(angle).apply(DVec3::new(aside, 0.0, -0.28)), angle)
    })
}
