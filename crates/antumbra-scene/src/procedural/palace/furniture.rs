//! Furniture: tables, chairs, shelves, books, boxes, and a carpet. Every piece stands on y = 0 about the y axis.

use core::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::looks::Look;
use crate::procedural::palette::Paint;
use crate::procedural::rng::Rng;
use crate::procedural::shapes::{Detail, cloth, smooth_profile};
use crate::procedural::solids::{Builder, Shading};

/// Height of a table's top, and half its size.
pub(super) const TABLE: DVec3 = DVec3::new(0.8, 0.76, 0.42);
/// Heights of a shelf's boards.
pub(super) const BOARDS: [f64; 5] = [0.06, 0.46, 0.86, 1.26, 1.66];
/// Half the width of a shelf, and its depth.
pub(super) const SHELF: DVec2 = DVec2::new(0.62, 0.32);

/// A table on turned legs.
pub(super) fn table(b: &mut Builder, detail: Detail) {
    const LEG: [(f64, f64); 6] =
        [(0.022, 0.0), (0.034, 0.06), (0.024, 0.16), (0.042, 0.42), (0.028, 0.56), (0.04, 0.6)];
    let profile = smooth_profile(&LEG, detail.steps(15.0));
    let size = DVec2::new(TABLE.x, TABLE.z) * 2.0;
    b.pillar(Look::Walnut, DVec2::ZERO, size, TABLE.y - 0.035, TABLE.y);
    b.rim(Look::Walnut, size - DVec2::splat(0.12), 0.025, TABLE.y - 0.14, TABLE.y - 0.03);
    for (x, z) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
        let at = (size * 0.5 - DVec2::splat(0.1)) * DVec2::new(x, z);
        b.turned(Look::Walnut, Shading::Smooth, at, detail.sides(12.0), &profile);
        b.pillar(Look::Walnut, at, DVec2::splat(0.08), 0.595, TABLE.y - 0.03);
    }
}

/// A chair that faces +z.
pub(super) fn chair(b: &mut Builder, detail: Detail) {
    let sides = detail.sides(9.0);
    let seat = 0.45;
    b.pillar(Look::Oak, DVec2::ZERO, DVec2::new(0.42, 0.4), seat - 0.03, seat);
    for x in [-0.18, 0.18] {
        let at = |y: f64, z: f64| DVec3::new(x, y, z);
        b.strut(Look::Oak, at(0.0, 0.18), at(seat - 0.02, 0.17), 0.018, sides);
        b.strut(Look::Oak, at(0.0, -0.2), at(seat, -0.17), 0.019, sides);
        b.strut(Look::Oak, at(seat - 0.02, -0.17), at(0.98, -0.25), 0.018, sides);
        b.strut(Look::Oak, at(0.2, -0.18), at(0.2, 0.17), 0.012, sides);
    }
    for (y, z) in [(0.16, 0.17), (0.24, -0.18)] {
        b.strut(Look::Oak, DVec3::new(-0.18, y, z), DVec3::new(0.18, y, z), 0.012, sides);
    }
    for y in [0.6, 0.74, 0.88] {
        let z = -0.17 - 0.08 * (y - seat) / 0.53;
        b.cuboid(Look::Oak, DVec3::new(-0.18, y, z - 0.008), DVec3::new(0.18, y + 0.07, z + 0.008));
    }
}

/// A shelf with its back at z = 0, open to +z.
pub(super) fn shelf(b: &mut Builder) {
    let (half, deep) = (SHELF.x, SHELF.y);
    for x in [-half, half] {
        b.cuboid(Look::Walnut, DVec3::new(x - 0.014, 0.0, 0.0), DVec3::new(x + 0.014, 2.02, deep));
    }
    for y in BOARDS.into_iter().chain([2.0]) {
        b.cuboid(Look::Walnut, DVec3::new(-half, y - 0.024, 0.0), DVec3::new(half, y, deep - 0.004));
    }
    b.cuboid(Look::Walnut, DVec3::new(-half, 0.03, 0.0), DVec3::new(half, 2.0, 0.015));
}

/// A row of books from x = 0 that stand on y = 0 with their backs near z = 0; some have fallen against the others.
pub(super) fn books(b: &mut Builder, rng: &mut Rng, long: f64) {
    let mut x = 0.0;
    while x < long {
        let (thick, high, deep) = (rng.range(0.02, 0.055), rng.range(0.2, 0.33), rng.range(0.15, 0.2));
        let back = rng.range(-0.015, 0.015);
        book(b, rng, DVec3::new(x, 0.0, back - deep), DVec3::new(x + thick, high, back));
        x += thick + if rng.chance(0.12) { rng.range(0.03, 0.12) } else { 0.001 };
    }
}

/// A closed book between two corners, its back along the z end.
fn book(b: &mut Builder, rng: &mut Rng, min: DVec3, max: DVec3) {
    let cover = rng.pick(&[Paint::BrickRed, Paint::BrickBrown, Paint::CarBlue, Paint::LeafDeep, Paint::BrickOchre]);
    b.cuboid(cover, min, max);
    // The pages stand out a little at the top and the front, in place of a recess.
    b.cuboid(Look::Parchment, min + DVec3::new(0.004, 0.004, -0.001), max - DVec3::new(0.004, -0.001, 0.004));
}

/// Books that lie in a heap, the widest below, askew.
pub(super) fn book_pile(b: &mut Builder, rng: &mut Rng, count: usize) {
    let mut y = 0.0;
    for _ in 0..count {
        let half = DVec2::new(rng.range(0.1, 0.14), rng.range(0.075, 0.1));
        let thick = rng.range(0.022, 0.05);
        let turn = crate::procedural::solids::Turn::radians(rng.range(-0.5, 0.5));
        b.within(DVec3::new(rng.range(-0.015, 0.015), y, rng.range(-0.015, 0.015)), turn, |b| {
            let cover =
                rng.pick(&[Paint::BrickRed, Paint::BrickBrown, Paint::CarBlue, Paint::LeafDeep, Paint::BrickOchre]);
            b.pillar(cover, DVec2::ZERO, half * 2.0, 0.0, 0.004);
            b.pillar(Look::Parchment, DVec2::ZERO, half * 2.0 - DVec2::splat(0.012), 0.003, thick - 0.003);
            b.pillar(cover, DVec2::ZERO, half * 2.0, thick - 0.004, thick);
        });
        y += thick;
    }
}

/// A closed box with a lid and iron bands.
pub(super) fn chest(b: &mut Builder) {
    b.pillar(Look::DarkOak, DVec2::ZERO, DVec2::new(0.84, 0.48), 0.0, 0.38);
    b.pillar(Look::Oak, DVec2::ZERO, DVec2::new(0.88, 0.52), 0.38, 0.46);
    for x in [-0.28, 0.28] {
        b.pillar(Look::Iron, DVec2::new(x, 0.0), DVec2::new(0.05, 0.494), 0.0, 0.37);
        b.pillar(Look::Iron, DVec2::new(x, 0.0), DVec2::new(0.05, 0.534), 0.37, 0.468);
    }
    b.pillar(Look::Iron, DVec2::new(0.0, 0.26), DVec2::new(0.1, 0.03), 0.3, 0.42);
}

/// A carpet 1.8 m by 1.3 m, with a border, whose ends curl a little.
pub(super) fn carpet(b: &mut Builder, detail: Detail) {
    let cells = [detail.steps(20.0), detail.steps(14.0)];
    let lay = |size: DVec2, lift: f64| {
        move |p: DVec2| {
            let at = (p - DVec2::splat(0.5)) * size;
            let end = (at.x.abs() / 0.9 - 0.86).max(0.0);
            let curl = 0.5 * end * end + 0.003 * libm::sin(9.0 * at.x + 4.0 * at.y);
            DVec3::new(at.x, 0.016 + lift + curl, -at.y)
        }
    };
    cloth(b, Look::CarpetBorder, cells, &lay(DVec2::new(1.8, 1.3), 0.0));
    cloth(b, Look::Carpet, cells, &lay(DVec2::new(1.6, 1.1), 0.005));
}

/// A jug, a bowl, or a plate: what stands on tables.
pub(super) fn crockery(b: &mut Builder, detail: Detail, rng: &mut Rng) {
    const JUG: [(f64, f64); 6] = [(0.05, 0.0), (0.085, 0.07), (0.08, 0.14), (0.045, 0.21), (0.05, 0.25), (0.056, 0.26)];
    const BOWL: [(f64, f64); 5] = [(0.04, 0.0), (0.045, 0.015), (0.1, 0.06), (0.12, 0.085), (0.115, 0.09)];
    let paint = rng.pick(&[Paint::Terracotta, Paint::StuccoWhite, Paint::BrickOchre]);
    let knots: &[(f64, f64)] = if rng.chance(0.5) { &JUG } else { &BOWL };
    let profile = smooth_profile(knots, detail.steps(15.0));
    b.turned(paint, Shading::Smooth, DVec2::ZERO, detail.sides(18.0), &profile);
    if knots.len() == JUG.len() {
        let angle = rng.range(0.0, TAU);
        let out = DVec3::new(libm::cos(angle), 0.0, libm::sin(angle));
        let at = |away: f64, y: f64| out * away + DVec3::Y * y;
        for (from, to) in
            [(at(0.07, 0.1), at(0.125, 0.12)), (at(0.125, 0.115), at(0.115, 0.2)), (at(0.117, 0.2), at(0.045, 0.235))]
        {
            b.strut(paint, from, to, 0.008, detail.sides(8.0));
        }
    }
}
