//! The green in the middle of the village: paving, a well, an old tree with a bench around it, a market cross.

use core::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::land::{GREEN_M, Land};
use crate::procedural::foliage::{Habit, tree};
use crate::procedural::palette::Paint;
use crate::procedural::props::cart;
use crate::procedural::rng::Rng;
use crate::procedural::solids::{Builder, Shading, Turn};

pub(super) fn build(b: &mut Builder, rng: &mut Rng, land: &Land) {
    b.cone(Paint::Paving, DVec2::ZERO, 48, [(GREEN_M, -0.8), (GREEN_M, 0.2)]);
    b.cone(Paint::Quay, DVec2::ZERO, 48, [(GREEN_M * 0.62, -0.7), (GREEN_M * 0.62, 0.23)]);
    b.cone(Paint::Paving, DVec2::ZERO, 48, [(GREEN_M * 0.58, -0.6), (GREEN_M * 0.58, 0.25)]);
    b.within(DVec3::new(-5.2, 0.2, 3.4), Turn::radians(0.4), well);
    b.within(DVec3::new(6.0, 0.2, -3.6), Turn::NONE, |b| old_tree(b, rng));
    b.within(DVec3::new(0.6, 0.2, -0.4), Turn::radians(0.3), cross);
    for (i, angle) in [0.9_f64, 2.4, 3.9].into_iter().enumerate() {
        let at = DVec2::new(libm::cos(angle), libm::sin(angle)) * (GREEN_M - 4.5);
        let facing = Turn::facing(DVec2::new(libm::sin(angle), -libm::cos(angle)));
        b.within(DVec3::new(at.x, 0.2, at.y), facing, bench);
        if i == 1 {
            b.within(DVec3::new(at.x + 2.4, 0.2, at.y - 1.2), Turn::radians(1.1), cart);
        }
    }
    // A path from the green to the church's gate.
    let line: Vec<_> =
        (0..=6).map(|i| DVec2::new(-4.0, -14.0).lerp(DVec2::new(-7.4, -21.5), f64::from(i) / 6.0)).collect();
    land.ribbon(b, Paint::Gravel, &line, 1.3, 0.19);
}

/// A round well under a little roof.
fn well(b: &mut Builder) {
    const SIDES: usize = 16;
    let ring = |i: usize| -> Vec<DVec3> {
        let angle = TAU * i as f64 / SIDES as f64;
        // The wall's section, carried round the shaft.
        [(0.95, -0.4), (1.25, -0.4), (1.25, 0.85), (0.95, 0.85)]
            .map(|(r, y)| DVec3::new(r * libm::cos(angle), y, r * libm::sin(angle)))
            .to_vec()
    };
    b.loop_loft(Paint::Quay, Shading::Flat, &(0..SIDES).map(ring).collect::<Vec<_>>());
    b.cone(Paint::Water, DVec2::ZERO, SIDES, [(1.0, -0.35), (1.0, 0.3)]);
    for x in [-1.1, 1.1] {
        b.pillar(Paint::Timber, DVec2::new(x, 0.0), DVec2::splat(0.2), 0.5, 2.75);
    }
    b.strut(Paint::Trunk, DVec3::new(-1.2, 1.9, 0.0), DVec3::new(1.35, 1.9, 0.0), 0.12, 8);
    b.gable(Paint::Terracotta, DVec2::ZERO, DVec2::new(3.2, 2.6), 2.7, 1.15);
    b.cone(Paint::Timber, DVec2::new(0.3, 0.0), 10, [(0.17, 1.05), (0.22, 1.4)]);
    b.pillar(Paint::GlassDark, DVec2::new(0.3, 0.0), DVec2::splat(0.03), 1.35, 1.9);
}

/// An oak in a ring of stone, with a bench around its trunk.
fn old_tree(b: &mut Builder, rng: &mut Rng) {
    b.cone(Paint::Quay, DVec2::ZERO, 12, [(2.1, -0.4), (2.1, 0.35)]);
    b.cone(Paint::Grass, DVec2::ZERO, 12, [(1.8, -0.3), (1.8, 0.42)]);
    for i in 0..8 {
        b.within(DVec3::ZERO, Turn::radians(TAU * f64::from(i) / 8.0), |b| {
            b.pillar(Paint::Timber, DVec2::new(1.25, 0.0), DVec2::new(0.42, 0.96), 0.75, 0.83);
            b.pillar(Paint::Timber, DVec2::new(1.25, 0.36), DVec2::new(0.3, 0.09), 0.3, 0.77);
        });
    }
    tree(b, rng, Habit::Spreading, DVec3::Y * 0.3, (11.0, 11.5));
}

/// A market cross on three steps.
fn cross(b: &mut Builder) {
    for (i, radius) in [1.9, 1.4, 0.95].into_iter().enumerate() {
        b.cone(Paint::Granite, DVec2::ZERO, 8, [(radius, -0.4), (radius, 0.28 * (i + 1) as f64)]);
    }
    b.taper(Paint::Limestone, DVec2::ZERO, [(DVec2::splat(0.5), 0.8), (DVec2::splat(0.28), 4.3)]);
    b.pillar(Paint::Limestone, DVec2::ZERO, DVec2::splat(0.5), 4.2, 4.45);
    b.pillar(Paint::Limestone, DVec2::ZERO, DVec2::new(0.2, 0.16), 4.4, 5.6);
    b.pillar(Paint::Limestone, DVec2::ZERO, DVec2::new(0.85, 0.15), 5.0, 5.2);
}

fn bench(b: &mut Builder) {
    b.pillar(Paint::Timber, DVec2::ZERO, DVec2::new(1.7, 0.45), 0.42, 0.48);
    b.pillar(Paint::Timber, DVec2::new(0.0, -0.24), DVec2::new(1.7, 0.06), 0.55, 0.9);
    for x in [-0.7, 0.7] {
        b.pillar(Paint::GlassDark, DVec2::new(x, 0.0), DVec2::new(0.08, 0.42), -0.1, 0.43);
        b.pillar(Paint::GlassDark, DVec2::new(x, -0.23), DVec2::new(0.08, 0.1), 0.4, 0.86);
    }
}
