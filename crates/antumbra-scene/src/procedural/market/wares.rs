//! What is sold: fruit in crates, bread in baskets.

use core::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

use super::Market;
use super::looks::Look;
use crate::procedural::palette::Paint;
use crate::procedural::props;
use crate::procedural::rng::Rng;
use crate::procedural::shapes::{Detail, hoop};
use crate::procedural::solids::{Builder, Shading};

/// The meshes that stalls share.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wares {
    /// Crates of fruit, 0.56 by 0.4 m.
    pub crates: [usize; 5],
    /// An empty crate.
    pub empty: usize,
    /// Round baskets, 0.5 m across.
    pub baskets: [usize; 2],
    pub barrel: usize,
}

const CRATE: [Look; 2] = [Look::Plank, Look::Wicker];

impl Wares {
    pub fn new(market: &mut Market) -> Self {
        let fruit = [Look::Apple, Look::Orange, Look::Lemon, Look::Plum, Look::Cabbage];
        Self {
            crates: fruit.map(|fruit| market.mesh("crate", |b, rng, detail| full_crate(b, rng, detail, fruit))),
            empty: market.mesh("crate", |b, _, _| props::open_crate(b, CRATE.map(usize::from))),
            baskets: [Look::Loaf, Look::Apple]
                .map(|ware| market.mesh("basket", |b, rng, detail| basket(b, rng, detail, ware))),
            barrel: market.mesh("barrel", |b, _, detail| {
                props::barrel(b, detail, [Look::Plank.into(), Paint::Steel.into()]);
            }),
        }
    }
}

/// A ball of fruit; cabbages are large.
fn ball(b: &mut Builder, detail: Detail, paint: Look, center: DVec3, radius: f64) {
    let steps = detail.steps(4.0).max(2);
    let profile: Vec<_> = (0..=steps)
        .map(|i| PI * i as f64 / steps as f64)
        .map(|angle| (radius * libm::sin(angle), center.y - radius * libm::cos(angle)))
        .enumerate()
        // At the upper end the sine is not quite zero.
        .map(|(i, (r, y))| (if i == 0 || i == steps { 0.0 } else { r }, y))
        .collect();
    b.turned(paint, Shading::Smooth, DVec2::new(center.x, center.z), detail.sides(6.0), &profile);
}

/// A crate heaped with one kind of fruit.
fn full_crate(b: &mut Builder, rng: &mut Rng, detail: Detail, fruit: Look) {
    props::open_crate(b, CRATE.map(usize::from));
    let large = fruit == Look::Cabbage;
    let (columns, rows, radius) = if large { (3, 2, 0.1) } else { (5, 3, 0.058) };
    let pitch = DVec2::new(0.52 / f64::from(columns), 0.36 / f64::from(rows));
    for (i, k) in (0..columns).flat_map(|i| (0..rows).map(move |k| (i, k))) {
        let cell = DVec2::new(f64::from(i), f64::from(k)) + DVec2::splat(0.5);
        let at = cell * pitch - DVec2::new(0.26, 0.18);
        if !rng.chance(detail.share(1.0)) {
            continue;
        }
        // Heaped up in the middle.
        let y = 0.27 + 0.07 * (1.0 - (at.x / 0.26) * (at.x / 0.26)) + rng.range(-0.012, 0.012);
        ball(b, detail, fruit, DVec3::new(at.x, y, at.y), radius * rng.range(0.9, 1.1));
    }
}

/// A wicker basket with loaves or fruit in it.
fn basket(b: &mut Builder, rng: &mut Rng, detail: Detail, ware: Look) {
    let sides = detail.sides(12.0);
    b.cone(Look::Wicker, DVec2::ZERO, sides, [(0.2, 0.0), (0.215, 0.16)]);
    for i in 0..2 {
        let (y, radius) = (0.12 + 0.12 * f64::from(i), 0.225 + 0.02 * f64::from(i));
        hoop(b, Look::Wicker, DVec2::ZERO, [radius - 0.02, radius + 0.008], [y, y + 0.1], sides);
    }
    for i in 0..detail.up_to(9) {
        let (angle, away) = (TAU * i as f64 / 9.0, if i % 3 == 0 { 0.05 } else { 0.14 });
        let at = DVec3::new(away * libm::cos(angle), rng.range(0.27, 0.33), away * libm::sin(angle));
        if ware == Look::Loaf {
            let way = DVec3::new(libm::sin(angle), 0.5, libm::cos(angle)).normalize() * 0.15;
            b.strut(ware, at - way, at + way, 0.045, detail.sides(6.0));
        } else {
            ball(b, detail, ware, at, 0.065);
        }
    }
}
