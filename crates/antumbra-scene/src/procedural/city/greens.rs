//! Open ground: the park, squares, courtyards, street trees.

use glam::{DVec2, DVec3};

use super::civic;
use super::streets::lamp;
use crate::procedural::foliage::{Habit, tree};
use crate::procedural::palette::Paint;
use crate::procedural::rng::Rng;
use crate::procedural::solids::{Builder, Shading, Turn, ellipse, octagon};

/// The raised pavement of a block.
pub(crate) fn pavement(b: &mut Builder, paint: Paint, size: DVec2) {
    let cut = (size.min_element() * 0.1).min(2.5);
    b.loft(paint, Shading::Flat, &[-0.5, 0.18].map(|y| octagon(DVec2::ZERO, size, cut, y)));
}

/// Trees and lamps along the kerbs of a block.
pub(crate) fn kerb(b: &mut Builder, rng: &mut Rng, size: DVec2, trees: f64) {
    for (axis, side) in [(0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0)] {
        let count = (size[axis] / 10.0) as usize;
        for i in 1..count {
            let mut at = DVec2::ZERO;
            at[axis] = size[axis] * (i as f64 / count as f64 - 0.5);
            at[1 - axis] = side * (size[1 - axis] * 0.5 - 1.1);
            if i % 4 == 0 {
                let turn = Turn::quarters(match (axis, side > 0.0) {
                    (0, true) => 3,
                    (0, false) => 1,
                    (_, true) => 0,
                    _ => 2,
                });
                b.within(DVec3::new(at.x, 0.18, at.y), turn, |b| lamp(b, DVec2::ZERO, 1.0));
            } else if rng.chance(trees) {
                tree(b, rng, Habit::Round, DVec3::new(at.x, 0.18, at.y), (5.5, 8.5));
            }
        }
    }
}

/// Scatters trees over a rectangle.
pub(crate) fn grove(b: &mut Builder, rng: &mut Rng, center: DVec2, size: DVec2, count: usize) {
    for _ in 0..count {
        let at = center + size * DVec2::new(rng.range(-0.5, 0.5), rng.range(-0.5, 0.5));
        tree(b, rng, Habit::Round, DVec3::new(at.x, 0.2, at.y), (6.0, 10.0));
    }
}

/// A place in the park where a tree stands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spot {
    pub(crate) at: DVec2,
    pub(crate) size: f64,
    pub(crate) angle: f64,
    pub(crate) kind: usize,
}

/// Lawn, paths, a pond and a bandstand; returns where the trees go.
pub(crate) fn park(b: &mut Builder, rng: &mut Rng, size: DVec2) -> Vec<Spot> {
    pavement(b, Paint::Paving, size);
    let lawn = size - DVec2::splat(9.0);
    b.loft(Paint::Grass, Shading::Flat, &[-0.3, 0.34].map(|y| octagon(DVec2::ZERO, lawn, 8.0, y)));
    let pond = size * DVec2::new(-0.17, 0.12);
    let shore = DVec2::new(size.x * 0.17, size.y * 0.13);
    b.loft(Paint::Gravel, Shading::Flat, &[-0.2, 0.40].map(|y| ellipse(pond, y, shore + DVec2::splat(3.0), 40)));
    b.loft(Paint::Water, Shading::Flat, &[-0.2, 0.46].map(|y| ellipse(pond, y, shore, 40)));
    let hub = size * DVec2::new(0.2, -0.05);
    let gates = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.47), (0.5, -0.05), (0.0, -0.5), (0.12, 0.5)];
    let paths: Vec<_> = gates.iter().map(|&(x, z)| (hub, lawn * DVec2::new(x, z) * 0.99)).collect();
    for (i, &(from, to)) in paths.iter().enumerate() {
        path(b, from, to, 0.42 + 0.012 * i as f64);
    }
    b.cone(Paint::Gravel, hub, 32, [(16.0, -0.2), (16.0, 0.55)]);
    bandstand(b, hub);
    let taken = |p: DVec2| {
        let wet = ((p - pond) / (shore + DVec2::splat(6.0))).length() < 1.0;
        let on_path = paths.iter().any(|&(a, c)| off_line(p, a, c) < 4.5);
        wet || on_path || (p - hub).length() < 19.0
    };
    spots(rng, lawn - DVec2::splat(8.0), taken)
}

fn spots(rng: &mut Rng, area: DVec2, taken: impl Fn(DVec2) -> bool) -> Vec<Spot> {
    let count = (area.x * area.y / 95.0) as usize;
    let mut spots: Vec<Spot> = Vec::new();
    for _ in 0..count {
        let at = area * DVec2::new(rng.range(-0.5, 0.5), rng.range(-0.5, 0.5));
        let (size, angle, kind) = (rng.range(0.75, 1.35), rng.range(0.0, core::f64::consts::TAU), rng.index(64));
        let near = spots.iter().any(|s| (s.at - at).length() < 5.5);
        // Woods at the edges, open lawns within.
        let edge = (at / area).abs().max_element() > 0.36;
        if !taken(at) && !near && (edge || rng.chance(0.3)) {
            spots.push(Spot { at, size, angle, kind });
        }
    }
    spots
}

fn off_line(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let way = b - a;
    let t = ((p - a).dot(way) / way.length_squared()).clamp(0.0, 1.0);
    (p - a - way * t).length()
}

fn path(b: &mut Builder, from: DVec2, to: DVec2, top: f64) {
    let side = (to - from).perp().normalize() * 2.2;
    let ring = |y: f64| [from - side, from + side, to + side, to - side].map(|p| DVec3::new(p.x, y, p.y)).to_vec();
    b.loft(Paint::Gravel, Shading::Flat, &[ring(-0.2), ring(top)]);
}

fn bandstand(b: &mut Builder, at: DVec2) {
    b.cone(Paint::Marble, at, 8, [(6.0, 0.2), (6.0, 1.3)]);
    for i in 0..8 {
        let angle = core::f64::consts::TAU * f64::from(i) / 8.0;
        let foot = at + DVec2::new(libm::cos(angle), libm::sin(angle)) * 5.0;
        b.cone(Paint::White, foot, 8, [(0.22, 1.0), (0.18, 5.2)]);
    }
    b.cone(Paint::White, at, 8, [(5.8, 5.1), (5.8, 5.6)]);
    b.turned(Paint::Copper, Shading::Flat, at, 8, &[(6.2, 5.5), (2.4, 7.4), (1.4, 8.8), (0.0, 10.5)]);
}

/// The square: an obelisk between fountains and rows of trees.
pub(crate) fn square(b: &mut Builder, rng: &mut Rng, size: DVec2) {
    pavement(b, Paint::Plaza, size);
    b.loft(Paint::Limestone, Shading::Flat, &[-0.2, 0.26].map(|y| octagon(DVec2::ZERO, size * 0.55, 5.0, y)));
    civic::obelisk(b, 52.0);
    for side in [-1.0, 1.0] {
        civic::fountain(b, DVec2::new(side * size.x * 0.3, 0.0));
        let lawn = DVec2::new(size.x * 0.62, size.y * 0.11);
        let at = DVec2::new(0.0, side * size.y * 0.38);
        b.pillar(Paint::Grass, at, lawn, -0.2, 0.36);
        for i in 0..8 {
            let x = lawn.x * (f64::from(i) / 7.0 - 0.5) * 0.92;
            tree(b, rng, Habit::Poplar, DVec3::new(at.x + x, 0.3, at.y), (10.0, 12.0));
        }
    }
}
