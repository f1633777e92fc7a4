//! The ground: slabs in a running bond on a bed, and a fountain with a mast in the middle.

use core::f64::consts::{FRAC_PI_2, TAU};

use glam::{DVec2, DVec3};

use super::{Market, SQUARE};
use crate::procedural::palette::Paint;
use crate::procedural::rng::Rng;
use crate::procedural::shapes::{Detail, hoop, smooth_profile};
use crate::procedural::solids::{Builder, Shading, Turn};

/// The top of the mast over the fountain, where the garlands meet.
pub(super) const MAST_M: f64 = 7.4;
/// Outer radius of the fountain's steps.
const STEPS_M: f64 = 3.3;

pub(super) fn build(market: &mut Market) {
    market.add("ground", DVec3::ZERO, Turn::NONE, |b, _, _| {
        b.cuboid(Paint::Quay, DVec3::new(-46.0, -1.2, -34.0), DVec3::new(34.0, -0.05, 34.0));
    });
    market.add("paving", DVec3::ZERO, Turn::NONE, paving);
    market.add("fountain", DVec3::ZERO, Turn::NONE, |b, _, detail| fountain(b, detail));
}

/// Slabs of about 1.2 by 0.9 m at scale 1; every other row is set off by half a slab.
fn paving(b: &mut Builder, rng: &mut Rng, detail: Detail) {
    const STONES: [Paint; 6] =
        [Paint::Plaza, Paint::Plaza, Paint::Paving, Paint::Paving, Paint::Limestone, Paint::Sandstone];
    const GAP_M: f64 = 0.025;
    let (columns, rows) = (detail.sides(30.0), detail.sides(34.0));
    let size = 2.0 * SQUARE / DVec2::new(columns as f64, rows as f64);
    for row in 0..rows {
        let shift = if row % 2 == 0 { 0.0 } else { 0.5 };
        for column in 0..=columns {
            let x0 = (column as f64 - shift) * size.x - SQUARE.x;
            let (x0, x1) = (x0.max(-SQUARE.x), (x0 + size.x).min(SQUARE.x));
            if x1 - x0 < 0.1 * size.x {
                continue;
            }
            let z0 = row as f64 * size.y - SQUARE.y;
            let top = rng.range(-0.012, 0.006);
            let (min, max) = (DVec3::new(x0, -0.3, z0), DVec3::new(x1 - GAP_M, top, z0 + size.y - GAP_M));
            b.cuboid(rng.pick(&STONES), min, max);
        }
    }
}

/// Two steps, a basin with water, two bowls on a stem, and out of the upper one the mast.
fn fountain(b: &mut Builder, detail: Detail) {
    let (sides, at) = (detail.sides(32.0).max(8), DVec2::ZERO);
    b.cone(Paint::Granite, at, sides, [(STEPS_M, -0.4), (STEPS_M, 0.14)]);
    b.cone(Paint::Granite, at, sides, [(STEPS_M - 0.45, -0.3), (STEPS_M - 0.45, 0.28)]);
    hoop(b, Paint::Limestone, at, [2.05, 2.4], [0.1, 0.86], sides);
    hoop(b, Paint::Marble, at, [1.98, 2.5], [0.82, 0.95], sides);
    b.cone(Paint::Water, at, sides, [(2.2, 0.2), (2.2, 0.68)]);
    let stem = [(0.55, 0.2), (0.42, 0.5), (0.24, 1.1), (0.2, 1.6), (0.32, 1.85), (0.9, 2.02), (1.12, 2.2)];
    b.turned(Paint::Limestone, Shading::Smooth, at, sides, &smooth_profile(&stem, detail.steps(18.0)));
    hoop(b, Paint::Limestone, at, [1.02, 1.16], [2.12, 2.3], sides);
    b.cone(Paint::Water, at, sides, [(1.06, 2.1), (1.06, 2.26)]);
    let top = [(0.2, 2.1), (0.14, 2.6), (0.13, 2.9), (0.22, 3.05), (0.5, 3.16), (0.6, 3.3)];
    b.turned(Paint::Limestone, Shading::Smooth, at, sides, &smooth_profile(&top, detail.steps(15.0)));
    b.cone(Paint::GlassDark, at, detail.sides(10.0), [(0.09, 3.2), (0.05, MAST_M)]);
    b.dome(Paint::Bronze, at, detail.sides(16.0), MAST_M, DVec2::splat(0.16));
    hoop(b, Paint::Bronze, at, [0.03, 0.17], [MAST_M - 0.18, MAST_M - 0.1], detail.sides(16.0));
    // Jets of water, from the upper bowl to the lower and from that to the basin.
    for (count, from, to) in [(8, (0.58, 3.28), (0.92, 2.25)), (12, (1.1, 2.27), (1.72, 0.66))] {
        for i in 0..count {
            jet(b, detail, TAU * f64::from(i) / f64::from(count), from, to);
        }
    }
}

/// A thin jet that leaves a bowl's rim sideways and falls: from (radius, y) to (radius, y).
fn jet(b: &mut Builder, detail: Detail, angle: f64, from: (f64, f64), to: (f64, f64)) {
    let steps = detail.steps(5.0).max(2);
    let point = |i: usize| {
        let turn = FRAC_PI_2 * i as f64 / steps as f64;
        let radius = from.0 + (to.0 - from.0) * libm::sin(turn);
        let y = to.1 + (from.1 - to.1) * libm::cos(turn);
        DVec3::new(radius * libm::cos(angle), y, radius * libm::sin(angle))
    };
    for i in 0..steps {
        b.strut(Paint::White, point(i), point(i + 1), 0.012, 5);
    }
}
