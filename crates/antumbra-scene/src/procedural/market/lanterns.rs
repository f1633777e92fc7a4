//! Paper lanterns that move: a node each, with a light of the same name inside. Between their thin ribs is nothing, so
//! that the light gets out and the ribs throw bars.

use core::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::garlands;
use super::looks::Look;
use super::people::Carrier;
use super::{Market, people};
use crate::model::Light;
use crate::procedural::palette::Paint;
use crate::procedural::rng::Rng;
use crate::procedural::shapes::{Detail, hoop};
use crate::procedural::solids::{Builder, Turn};
use crate::procedural::view::point;

/// Lanterns on the garlands: the line, where on it, and how far below it the light is.
const HUNG: [(usize, f64, f64); 7] =
    [(0, 0.56, 1.7), (1, 0.42, 1.9), (3, 0.6, 1.5), (4, 0.5, 1.8), (5, 0.55, 1.3), (6, 0.44, 1.75), (7, 0.5, 1.2)];

/// What the paper lets through: the ribs' look and the light's colour, linear RGB.
const PAPERS: [(Look, [f32; 3]); 5] = [
    (Look::PaperAmber, [1.0, 0.56, 0.17]),
    (Look::PaperRose, [1.0, 0.36, 0.26]),
    (Look::PaperOrange, [1.0, 0.43, 0.11]),
    (Look::PaperGreen, [0.7, 1.0, 0.36]),
    (Look::PaperAmber, [1.0, 0.64, 0.27]),
];

pub(super) fn build(market: &mut Market) {
    let hung = HUNG.into_iter().map(|(line, t, below)| (garlands::point(line, t), below));
    let carried = people::CARRIERS.iter().map(Carrier::hook);
    let all: Vec<(DVec3, f64)> = hung.chain(carried).collect();
    for (i, (hook, cord)) in all.into_iter().enumerate() {
        let name = format!("lantern{:02}", i + 1);
        let (paper, color) = PAPERS[i % PAPERS.len()];
        let mut rng = market.rng.fork(8000 + i as u64);
        let (candela, turn) = (rng.range(26.0, 58.0), Turn::radians(rng.range(0.0, TAU)));
        let mesh = market.mesh(&name, |b, rng, detail| match i % 3 {
            2 => square(b, detail, paper, cord),
            _ => round(b, rng, detail, paper, cord),
        });
        let at = hook - DVec3::Y * cord;
        market.place_as(name.clone(), mesh, at, turn, true);
        let range_m = 10.0 + 4.0 * (candela - 26.0) / 32.0;
        let light = point(name, at, range_m, candela as f32, color);
        market.scene.lights.push(Light { dynamic: true, ..light });
    }
}

/// A barrel of ribs about its light, which hangs `cord` metres below the hook.
fn round(b: &mut Builder, rng: &mut Rng, detail: Detail, paper: Look, cord: f64) {
    const RIBS: usize = 10;
    let (wide, tall) = (rng.range(0.19, 0.23), rng.range(0.24, 0.3));
    let radius = |y: f64| wide * (1.0 - 0.62 * (y / tall) * (y / tall)).sqrt();
    let steps = detail.steps(6.0).max(2);
    for rib in 0..RIBS {
        let angle = TAU * rib as f64 / RIBS as f64;
        let at = |i: usize| {
            let y = tall * (2.0 * i as f64 / steps as f64 - 1.0);
            DVec3::new(radius(y) * libm::cos(angle), y, radius(y) * libm::sin(angle))
        };
        for i in 0..steps {
            b.strut(paper, at(i), at(i + 1), 0.009, detail.sides(5.0));
        }
    }
    let sides = detail.sides(20.0);
    for y in [-0.6, -0.2, 0.2, 0.6].map(|share| share * tall) {
        hoop(b, paper, DVec2::ZERO, [radius(y) - 0.006, radius(y) + 0.006], [y - 0.005, y + 0.005], sides);
    }
    let rim = radius(tall);
    for (y0, y1) in [(-tall - 0.05, -tall + 0.01), (tall - 0.01, tall + 0.05)] {
        hoop(b, paper, DVec2::ZERO, [rim - 0.008, rim + 0.012], [y0, y1], sides);
    }
    candle(b, detail, tall + 0.02, rim);
    hang(b, tall + 0.03, rim, cord);
}

/// A box of four posts with a lattice on each side.
fn square(b: &mut Builder, detail: Detail, paper: Look, cord: f64) {
    const HALF: f64 = 0.17;
    const TALL: f64 = 0.26;
    for quarters in 0..4 {
        b.within(DVec3::ZERO, Turn::quarters(quarters), |b| {
            b.pillar(Paint::GlassDark, DVec2::splat(HALF), DVec2::splat(0.022), -TALL, TALL);
            for x in [-0.06, 0.06] {
                b.pillar(paper, DVec2::new(x, HALF), DVec2::splat(0.013), -TALL, TALL);
            }
            for y in [-0.13, 0.0, 0.13] {
                b.pillar(paper, DVec2::new(0.0, HALF), DVec2::new(2.0 * HALF, 0.012), y - 0.0065, y + 0.0065);
            }
        });
    }
    let size = DVec2::splat(2.0 * HALF + 0.05);
    for (y0, y1) in [(-TALL - 0.03, -TALL + 0.01), (TALL - 0.01, TALL + 0.05)] {
        b.rim(paper, size, 0.045, y0, y1);
    }
    candle(b, detail, TALL + 0.01, HALF);
    hang(b, TALL + 0.03, HALF, cord);
}

/// A candle on two crossed bars `low` metres under the light.
fn candle(b: &mut Builder, detail: Detail, low: f64, reach: f64) {
    let y = -low;
    b.strut(Paint::GlassDark, DVec3::new(-reach, y, 0.0), DVec3::new(reach, y, 0.0), 0.006, 4);
    b.strut(Paint::GlassDark, DVec3::new(0.0, y, -reach), DVec3::new(0.0, y, reach), 0.006, 4);
    b.cone(Look::Bulb, DVec2::ZERO, detail.sides(9.0), [(0.022, y), (0.018, -0.1)]);
    b.cone(Look::Bulb, DVec2::ZERO, detail.sides(9.0), [(0.012, -0.11), (0.0, -0.04)]);
}

/// Four cords from the upper rim to the line, and a tassel.
fn hang(b: &mut Builder, top: f64, rim: f64, cord: f64) {
    let knot = DVec3::Y * (top + 0.22).min(cord - 0.02);
    for quarters in 0..4 {
        let at = Turn::quarters(quarters).apply(DVec3::X * rim) + DVec3::Y * top;
        b.strut(Paint::GlassDark, at, knot, 0.004, 4);
    }
    b.strut(Paint::GlassDark, knot - DVec3::Y * 0.01, DVec3::Y * cord, 0.006, 4);
    b.cone(Paint::CarRed, DVec2::ZERO, 6, [(0.03, -top - 0.3), (0.008, -top)]);
}
