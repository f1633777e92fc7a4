//! What stands on roofs: machinery, water tanks, stair heads, masts, chimneys.

use glam::{DVec2, DVec3};

use crate::procedural::palette::Paint;
use crate::procedural::rng::Rng;
use crate::procedural::solids::{Builder, Shading, Turn};

/// A flat roof of that size at `y`: a layer of gravel and a scatter of machinery.
pub(crate) fn flat(b: &mut Builder, rng: &mut Rng, size: DVec2, y: f64) {
    let cover = rng.pick(&[Paint::Ballast, Paint::Felt, Paint::Ballast]);
    b.pillar(cover, DVec2::ZERO, size - DVec2::splat(0.3), y - 0.3, y + 0.12);
    let free = size - DVec2::splat(3.0);
    if free.min_element() < 3.0 {
        return;
    }
    let count = (free.x * free.y / 120.0).clamp(1.0, 7.0) as usize;
    for _ in 0..count {
        let at = DVec2::new(rng.range(-0.5, 0.5), rng.range(-0.5, 0.5)) * (free - DVec2::splat(2.5));
        unit(b, rng, at, y);
    }
    if free.min_element() > 6.0 {
        stair_head(b, rng, free, y);
    }
}

fn unit(b: &mut Builder, rng: &mut Rng, at: DVec2, y: f64) {
    let turn = Turn::quarters(rng.index(2));
    b.within(DVec3::new(at.x, y, at.y), turn, |b| match rng.index(4) {
        0 => b.cone(Paint::Steel, DVec2::ZERO, 10, [(0.7, -0.1), (0.7, rng.range(0.9, 1.6))]),
        1 => {
            b.pillar(Paint::Steel, DVec2::ZERO, DVec2::new(0.8, 6.0), -0.1, 0.7);
            b.pillar(Paint::White, DVec2::new(0.0, 2.2), DVec2::new(1.8, 1.8), -0.1, 1.3);
        }
        _ => {
            let size = DVec2::new(rng.range(1.4, 2.6), rng.range(1.8, 3.6));
            let top = rng.range(1.1, 1.9);
            b.pillar(Paint::White, DVec2::ZERO, size, -0.1, top);
            b.cone(Paint::Felt, DVec2::ZERO, 8, [(size.x * 0.36, top - 0.1), (size.x * 0.36, top + 0.2)]);
        }
    });
}

fn stair_head(b: &mut Builder, rng: &mut Rng, free: DVec2, y: f64) {
    let at = free * DVec2::new(rng.range(-0.3, 0.3), rng.range(-0.3, 0.3));
    let size = DVec2::new(rng.range(3.0, 4.5), rng.range(3.0, 6.0)).min(free * 0.6);
    b.pillar(Paint::Concrete, at, size, y - 0.2, y + 3.1);
    b.pillar(Paint::Felt, at, size + DVec2::splat(0.5), y + 3.0, y + 3.3);
}

/// A wooden water tank on legs.
pub(crate) fn water_tank(b: &mut Builder, at: DVec2, y: f64, size: f64) {
    let leg = 0.55 * size;
    for (sx, sz) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
        let foot = DVec3::new(at.x + sx * leg * 1.15, y - 0.3, at.y + sz * leg * 1.15);
        b.strut(Paint::Steel, foot, DVec3::new(at.x + sx * leg, y + 2.0 * size, at.y + sz * leg), 0.12 * size, 4);
    }
    b.pillar(Paint::Timber, at, DVec2::splat(1.9 * size), y + 1.85 * size, y + 2.05 * size);
    let profile = [(size, y + 2.0 * size), (0.94 * size, y + 4.1 * size)];
    b.turned(Paint::Timber, Shading::Smooth, at, 14, &profile);
    b.cone(Paint::Felt, at, 14, [(1.1 * size, y + 4.05 * size), (0.0, y + 5.0 * size)]);
}

/// A mast in thinner and thinner lengths.
pub(crate) fn mast(b: &mut Builder, at: DVec2, y: f64, height: f64) {
    let lengths = [(0.0, 0.4, 0.75), (0.38, 0.72, 0.45), (0.7, 1.0, 0.2)];
    for (from, to, radius) in lengths {
        b.cone(Paint::White, at, 8, [(radius, y - 0.5 + from * height), (radius * 0.8, y + to * height)]);
    }
}

/// A brick chimney with pots.
pub(crate) fn chimney(b: &mut Builder, at: DVec2, y0: f64, y1: f64) {
    b.pillar(Paint::BrickRed, at, DVec2::new(0.8, 1.6), y0, y1);
    b.pillar(Paint::BrickBrown, at, DVec2::new(1.0, 1.8), y1 - 0.25, y1 + 0.1);
    for dz in [-0.4, 0.4] {
        b.cone(Paint::Terracotta, at + DVec2::new(0.0, dz), 6, [(0.2, y1), (0.16, y1 + 0.8)]);
    }
}
