//! Flags between the columns of the gallery, and the lantern in the anteroom.

use core::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

use super::Palace;
use super::looks::Look;
use super::plan::{COLUMN, EAST_DOOR_Z, FLOOR, GALLERY, Side};
use crate::procedural::palette::Paint;
use crate::procedural::rng::Rng;
use crate::procedural::shapes::{Detail, cloth, hoop};
use crate::procedural::solids::{Builder, Shading};

/// Half the width of a flag, and how long it is.
const FLAG: DVec2 = DVec2::new(0.92, 3.1);

/// Where the lantern's light is.
pub(super) const LANTERN: DVec3 = DVec3::new(9.6, FLOOR + 2.05, EAST_DOOR_Z);

/// Hangs flags in bays of the gallery but on its south side, on the court's side of the columns; all of them move.
pub(super) fn flags(palace: &mut Palace) {
    let cloths = [Look::ClothRed, Look::ClothOchre, Look::ClothBlue, Look::ClothGreen];
    for (k, side) in Side::all().into_iter().enumerate() {
        for i in (0..side.bays).filter(|i| k == 0 || (k != 2 && (i + k) % 2 == 1)) {
            let mut rng = palace.rng.fork(4000 + (10 * k + i) as u64);
            let paint = cloths[(i + k) % cloths.len()];
            let mesh = palace.mesh("flag", |b, detail| flag(b, detail, &mut rng, paint));
            let at = DVec3::new(side.column_x(i) + 1.6, GALLERY + COLUMN, -side.away + 0.34);
            palace.place_moving("flag", mesh, side.turn.apply(at), side.turn, true);
        }
    }
}

/// A trough about a lamp that stands on the floor, open above and to the north: it keeps the light off the walk.
pub(super) fn footlight(b: &mut Builder) {
    b.pillar(Look::Iron, DVec2::ZERO, DVec2::new(0.6, 0.4), -0.26, -0.22);
    for x in [-0.3, 0.27] {
        b.cuboid(Look::Iron, DVec3::new(x, -0.26, -0.2), DVec3::new(x + 0.03, 0.14, 0.2));
    }
    b.cuboid(Look::Iron, DVec3::new(-0.3, -0.26, 0.17), DVec3::new(0.3, 0.18, 0.2));
}

/// A flag hanging from a pole along x at y = 0: folds that grow downwards, and a lower edge that swings.
fn flag(b: &mut Builder, detail: Detail, rng: &mut Rng, paint: Look) {
    let (phase, folds, swing) = (rng.range(0.0, TAU), rng.range(2.2, 3.2), rng.range(-0.16, 0.16));
    let (twist, second) = (rng.range(-0.12, 0.12), rng.range(0.0, TAU));
    let lay = |p: DVec2| {
        let (x, down) = (2.0 * p.x - 1.0, 1.0 - p.y);
        let fold = libm::sin(folds * PI * x + phase + 0.9 * down) + 0.35 * libm::sin(7.3 * x - second + 2.1 * down);
        let deep = (0.02 + 0.1 * down) * fold + down * down * (swing + twist * x);
        let narrow = 1.0 - 0.1 * down * (1.0 - 0.4 * down);
        DVec3::new(x * FLAG.x * narrow, -FLAG.y * down - 0.05 * down * x * x, deep)
    };
    cloth(b, paint, [detail.steps(16.0), detail.steps(20.0)], &lay);
    let end = FLAG.x + 0.1;
    b.strut(Look::DarkOak, DVec3::new(-end, 0.015, 0.0), DVec3::new(end, 0.015, 0.0), 0.022, detail.sides(10.0));
    for x in [-end, end] {
        b.strut(
            Paint::Bronze,
            DVec3::new(x - 0.03, 0.015, 0.0),
            DVec3::new(x + 0.03, 0.015, 0.0),
            0.04,
            detail.sides(10.0),
        );
    }
    for x in [-0.6, 0.6] {
        b.strut(Look::Iron, DVec3::new(x, 0.02, 0.0), DVec3::new(x, 0.72, 0.0), 0.005, 5);
    }
}

/// A lantern about its light, in a cage of thin bars, on a chain. Nothing stands right under the light but its candle.
pub(super) fn lantern(b: &mut Builder, detail: Detail) {
    const RADIUS: f64 = 0.13;
    let sides = detail.sides(24.0);
    for i in 0..8 {
        let angle = TAU * f64::from(i) / 8.0;
        let out = DVec3::new(libm::cos(angle), 0.0, libm::sin(angle)) * RADIUS;
        b.strut(Look::Iron, out - DVec3::Y * 0.2, out + DVec3::Y * 0.17, 0.005, detail.sides(8.0));
    }
    for y in [-0.2, -0.06, 0.08, 0.17] {
        hoop(b, Look::Iron, DVec2::ZERO, [RADIUS - 0.006, RADIUS + 0.006], [y - 0.006, y + 0.006], sides);
    }
    b.cone(Look::Iron, DVec2::ZERO, sides, [(RADIUS + 0.01, -0.225), (RADIUS + 0.01, -0.2)]);
    b.turned(
        Look::Iron,
        Shading::Smooth,
        DVec2::ZERO,
        sides,
        &[(RADIUS + 0.04, 0.17), (0.1, 0.23), (0.03, 0.29), (0.015, 0.33)],
    );
    b.cone(Look::Parchment, DVec2::ZERO, sides, [(0.022, -0.205), (0.02, -0.07)]);
    b.turned(
        Look::Flame,
        Shading::Smooth,
        DVec2::ZERO,
        sides,
        &[(0.003, -0.07), (0.009, -0.05), (0.004, -0.025), (0.0, -0.015)],
    );
    for i in 0..9 {
        let y = 0.32 + 0.06 * f64::from(i);
        let link = if i % 2 == 0 { DVec3::X } else { DVec3::Z } * 0.012;
        for side in [-1.0, 1.0] {
            b.strut(Look::Iron, link * side + DVec3::Y * y, link * side + DVec3::Y * (y + 0.07), 0.004, 5);
        }
    }
}
