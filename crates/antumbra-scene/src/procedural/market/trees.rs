//! Two trees in full leaf, each leaf a thin closed solid: what light comes through them is dappled.

use core::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::Market;
use crate::procedural::palette::Paint;
use crate::procedural::rng::Rng;
use crate::procedural::shapes::{Detail, hoop};
use crate::procedural::solids::{Builder, Turn};

/// Where trees stand, and how high they are.
const TREES: [(DVec2, f64); 2] = [(DVec2::new(-11.2, 8.2), 8.4), (DVec2::new(11.5, -9.4), 7.6)];
/// Leaves of a tree at scale 1.
const LEAVES: f64 = 1600.0;

pub(super) fn build(market: &mut Market) {
    for (at, height) in TREES {
        let at = DVec3::new(at.x, 0.0, at.y);
        market.add("tree", at, Turn::NONE, |b, rng, detail| tree(b, rng, detail, height));
    }
}

fn tree(b: &mut Builder, rng: &mut Rng, detail: Detail, height: f64) {
    let sides = detail.sides(9.0);
    hoop(b, Paint::Granite, DVec2::ZERO, [0.95, 1.25], [-0.3, 0.42], detail.sides(20.0).max(8));
    b.cone(Paint::Trunk, DVec2::ZERO, detail.sides(20.0).max(8), [(1.05, -0.2), (1.05, 0.3)]);
    let fork = DVec3::new(0.12, height * 0.4, -0.08);
    b.strut(Paint::Trunk, DVec3::Y * -0.2, fork + DVec3::Y * 0.1, height * 0.026, sides);
    let mut tips = Vec::new();
    for i in 0..6 {
        let out = heading(TAU * (f64::from(i) + rng.range(-0.25, 0.25)) / 6.0, rng.range(0.7, 1.5));
        let limb = fork + out * height * rng.range(0.22, 0.3);
        b.strut(Paint::Trunk, fork, limb, height * 0.011, sides);
        for k in 0..4 {
            let aside = heading(TAU * (f64::from(k) + rng.unit()) / 4.0, rng.range(-0.1, 1.0));
            let tip = limb + (out * 0.5 + aside) * height * rng.range(0.09, 0.14);
            b.strut(Paint::Trunk, limb, tip, height * 0.005, 5);
            tips.push(tip);
        }
    }
    let leaves = (LEAVES * detail.scale * detail.scale).ceil() as usize;
    let size = 0.2 / detail.scale.clamp(0.3, 2.0);
    let paints = [Paint::LeafDeep, Paint::LeafGreen, Paint::LeafOlive];
    for i in 0..leaves {
        let around = heading(rng.range(0.0, TAU), rng.range(-1.5, 1.5)) * DVec3::new(1.0, 0.75, 1.0);
        let at = tips[i % tips.len()] + around * height * 0.125 * rng.unit().sqrt();
        leaf(b, rng, paints[(i / tips.len()) % paints.len()], at, size);
    }
}

/// A unit vector: an angle around, and how steeply it rises (as a tangent).
fn heading(angle: f64, rise: f64) -> DVec3 {
    DVec3::new(libm::cos(angle), rise, libm::sin(angle)).normalize()
}

/// A leaf folded along its middle: a flat tetrahedron that droops from `stalk`.
fn leaf(b: &mut Builder, rng: &mut Rng, paint: Paint, stalk: DVec3, size: f64) {
    let along = heading(rng.range(0.0, TAU), rng.range(-1.2, 0.4));
    let across = along.cross(DVec3::Y).normalize();
    let up = across.cross(along);
    let (long, half) = (size * rng.range(0.8, 1.25), size * rng.range(0.32, 0.45));
    let side = |way: f64| stalk + along * long * 0.45 + across * half * way + up * size * 0.12;
    let points = [stalk, stalk + along * long, side(-1.0), side(1.0)];
    b.triangles(paint, &points, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]);
}
