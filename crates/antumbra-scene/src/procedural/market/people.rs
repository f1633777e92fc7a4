//! People and carts. Those who walk and what they push move; those who sell stay.

use core::f64::consts::{FRAC_PI_2, PI};

use glam::{DVec2, DVec3};

use super::Market;
use super::looks::Look;
use super::stalls::behind_counters;
use crate::procedural::palette::Paint;
use crate::procedural::props::{cart, person};
use crate::procedural::solids::Turn;

/// Someone who carries a lantern on a stick: where, and which way, radians; 0 walks north (-z).
#[derive(Clone, Copy, Debug)]
pub(super) struct Carrier {
    at: DVec2,
    angle: f64,
}

pub(super) const CARRIERS: [Carrier; 3] = [
    Carrier { at: DVec2::new(-7.4, 1.8), angle: -0.9 },
    Carrier { at: DVec2::new(3.6, -8.4), angle: 2.3 },
    Carrier { at: DVec2::new(8.2, 3.4), angle: 1.2 },
];

/// The end of the stick, seen from the carrier's feet.
const STICK: DVec3 = DVec3::new(0.34, 2.05, -0.95);
/// From the stick's end down to the light.
const CORD_M: f64 = 0.72;

impl Carrier {
    /// Where the lantern is hooked, and how far below that its light is.
    pub fn hook(&self) -> (DVec3, f64) {
        (DVec3::new(self.at.x, 0.0, self.at.y) + Turn::radians(self.angle).apply(STICK), CORD_M)
    }
}

/// Those who walk with empty hands.
const WALKERS: [(DVec2, f64); 4] = [
    (DVec2::new(1.6, -9.6), 0.2),
    (DVec2::new(4.4, -10.0), -0.15),
    (DVec2::new(-3.2, 4.2), 1.9),
    (DVec2::new(9.4, -1.0), -2.2),
];
/// Carts, their shafts ahead.
const CARTS: [(DVec2, f64); 2] = [(DVec2::new(-8.6, -2.4), 0.5), (DVec2::new(3.2, 4.9), 2.7)];

pub(super) fn build(market: &mut Market) {
    for carrier in CARRIERS {
        let mesh = market.mesh("carrier", |b, rng, detail| {
            person(b, rng);
            b.strut(Paint::Timber, DVec3::new(0.3, 0.8, -0.05), STICK + DVec3::Y * 0.02, 0.014, detail.sides(6.0));
        });
        walk(market, "carrier", mesh, carrier.at, carrier.angle);
    }
    for (at, angle) in WALKERS {
        let mesh = market.mesh("walker", |b, rng, _| person(b, rng));
        walk(market, "walker", mesh, at, angle);
    }
    for (at, angle) in CARTS {
        let mesh = market.mesh("cart", |b, _, detail| {
            cart(b);
            let at = DVec2::new(-0.6, 0.35);
            b.cone(Look::Wicker, at, detail.sides(14.0), [(0.26, 0.82), (0.32, 1.4)]);
        });
        walk(market, "cart", mesh, at, angle);
    }
    let vendors = market.detail.up_to(10);
    for (at, angle) in behind_counters().take(vendors) {
        // A stall's front is +z, a person's -z.
        market.add("vendor", at, Turn::radians(angle + PI), |b, rng, _| person(b, rng));
    }
    // One watches the people from before the arcade.
    market.add("onlooker", DVec3::new(14.2, 0.0, -7.2), Turn::radians(FRAC_PI_2), |b, rng, _| person(b, rng));
}

/// Places something that moves.
fn walk(market: &mut Market, kind: &str, mesh: usize, at: DVec2, angle: f64) {
    let name = format!("{kind}-{}", market.scene.nodes.len());
    market.place_as(name, mesh, DVec3::new(at.x, 0.0, at.y), Turn::radians(angle), true);
}
