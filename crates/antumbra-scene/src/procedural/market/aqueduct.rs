//! An old aqueduct along the west side: two tiers of arches, through which the moon shines into the square.

use glam::DVec3;

use super::{Market, SQUARE};
use crate::procedural::palette::Paint;
use crate::procedural::shapes::{Detail, Opening, wall};
use crate::procedural::solids::{Builder, Turn};

/// From arch to arch.
const BAY_M: f64 = 4.5;
/// Arches of the lower tier.
const BAYS: i32 = 9;
const DEEP_M: f64 = 1.4;
/// Half the width of a lower arch.
const LOWER_HALF_M: f64 = 1.55;
/// Tops of the two tiers.
const TIERS_M: [f64; 2] = [5.6, 10.6];

/// Height of the lower tier's cornice, to which garlands are tied.
pub(super) const CORNICE_M: f64 = TIERS_M[0];

pub(super) fn build(market: &mut Market) {
    // Its front is +z in its own frame, x runs to the north.
    market.add("aqueduct", DVec3::new(-SQUARE.x, 0.0, 0.0), Turn::quarters(1), |b, _, detail| tiers(b, detail));
}

fn tiers(b: &mut Builder, detail: Detail) {
    let long = f64::from(BAYS) * BAY_M * 0.5;
    let arches = |half: f64, spring: f64| -> Vec<Opening> {
        let middle = |i: i32| (f64::from(i) + 0.5) * BAY_M - long;
        (0..BAYS).map(|i| Opening { middle: middle(i), half, spring, rise: half }).collect()
    };
    // The upper arches are narrow and far apart, so that shafts through them stand apart.
    let (lower, upper) = (arches(LOWER_HALF_M, 2.9), arches(1.1, 8.4));
    let tier = |b: &mut Builder, openings: &[Opening], [y0, y1]: [f64; 2], inset: f64, steps: f64| {
        let (min, max) = (DVec3::new(-long, y0, inset - DEEP_M), DVec3::new(long, y1, -inset));
        wall(b, Paint::Sandstone, min, max, openings, detail.steps(steps));
    };
    tier(b, &lower, [-0.5, TIERS_M[0]], 0.0, 24.0);
    tier(b, &upper, [TIERS_M[0] - 0.1, TIERS_M[1]], 0.25, 16.0);
    for (y, out) in [(TIERS_M[0] - 0.3, 0.16), (TIERS_M[0] - 0.12, 0.26), (TIERS_M[1] - 0.2, 0.14)] {
        let (min, max) = (DVec3::new(-long, y, -DEEP_M - out), DVec3::new(long, y + 0.2, out));
        b.cuboid(Paint::Limestone, min, max);
    }
    // Imposts where the lower arches begin, and feet.
    for i in 0..=BAYS {
        let x = (f64::from(i) - f64::from(BAYS) * 0.5) * BAY_M;
        let half = BAY_M * 0.5 - LOWER_HALF_M;
        for (y0, y1, out) in [(2.72, 2.95, 0.1), (-0.4, 0.5, 0.14)] {
            let (min, max) = (DVec3::new(x - half - out, y0, -DEEP_M - out), DVec3::new(x + half + out, y1, out));
            b.cuboid(Paint::Limestone, min, max);
        }
    }
    // The channel's broken coping.
    for i in (0..BAYS * 3).filter(|i| i % 7 != 3) {
        let x = (f64::from(i) + 0.5) * BAY_M / 3.0 - long;
        b.cuboid(Paint::Quay, DVec3::new(x - 0.7, TIERS_M[1], -0.5), DVec3::new(x + 0.7, TIERS_M[1] + 0.5, -0.2));
    }
}
