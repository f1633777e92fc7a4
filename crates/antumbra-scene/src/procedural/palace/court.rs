//! The court: two storeys of arches around it, walks behind them, a balustrade along the gallery, and roofs.

use core::f64::consts::PI;

use glam::{DVec2, DVec3};

use super::Palace;
use super::plan::{BAY, CEILING, CHAMBER, COLUMN, COURT, DOOR, GALLERY, Side, UNDER, WALK, WALL};
use crate::procedural::palette::Paint;
use crate::procedural::shapes::{Arch, Detail, Opening, hoop, smooth_profile, wall};
use crate::procedural::solids::{Builder, Shading};

/// Thickness of the walls over the columns, and half the width of an arch.
const OVER: f64 = 0.5;
const CLEAR: f64 = 1.27;
/// Height of the balustrade.
const PARAPET: f64 = 1.0;

/// Builds the court.
pub(super) fn build(palace: &mut Palace) {
    palace.add("court floors", |b, _| floors(b));
    palace.add("court walls", |b, _| walls(b));
    palace.add("court bands", |b, _| bands(b));
    palace.add("well", well);
    columns(palace);
    bays(palace);
    roofs(palace);
}

/// Outer size of the court and its walks, grown by a margin on every side.
fn outer(margin: f64) -> DVec2 {
    (COURT + DVec2::splat(WALK + margin)) * 2.0
}

fn floors(b: &mut Builder) {
    b.cuboid(Paint::Quay, DVec3::new(-16.0, UNDER, -16.0), DVec3::new(16.0, 0.0, 14.0));
    // Paving: bands along the columns and a pattern of large slabs in the open.
    for i in -5..5 {
        for k in -4..4 {
            let at = DVec2::new(1.6 * f64::from(i) + 0.8, 1.6 * f64::from(k) + 0.8);
            let paint = if (i + k) % 2 == 0 { Paint::Plaza } else { Paint::Paving };
            b.pillar(paint, at, DVec2::splat(1.57), -0.2, 0.012);
        }
    }
    let depth = WALK + WALL + 0.5 * OVER;
    b.rim(Paint::Limestone, outer(WALL), depth, GALLERY - 0.3, GALLERY);
    b.rim(Paint::StuccoCream, outer(WALL), depth, CEILING, CEILING + 0.25);
}

/// The walls behind the walks, and the chamber behind the northern one.
fn walls(b: &mut Builder) {
    let (inner, out) = (COURT + DVec2::splat(WALK), COURT + DVec2::splat(WALK + WALL));
    let top = CEILING + 0.25;
    b.rim(Paint::Sandstone, outer(WALL), WALL, -0.2, GALLERY);
    for x in [-out.x, inner.x] {
        b.cuboid(Paint::StuccoCream, DVec3::new(x, GALLERY, -out.y), DVec3::new(x + WALL, top, out.y));
    }
    b.cuboid(Paint::StuccoCream, DVec3::new(-out.x, GALLERY, inner.y), DVec3::new(out.x, top, out.y));
    let door = Opening { middle: 0.0, half: DOOR.x, spring: GALLERY + DOOR.y, rise: 0.0 };
    let (min, max) = (DVec3::new(-out.x, GALLERY, -out.y), DVec3::new(out.x, top, -inner.y));
    wall(b, Paint::StuccoCream, min, max, &[door], 1);
    // The chamber.
    let (near, far) = (-out.y, -out.y - CHAMBER.y);
    let (west, east) = (-CHAMBER.x - WALL, CHAMBER.x + WALL);
    b.cuboid(Paint::Timber, DVec3::new(west, GALLERY - 0.3, far - WALL), DVec3::new(east, GALLERY, near));
    b.cuboid(Paint::StuccoWhite, DVec3::new(west, CEILING, far - WALL), DVec3::new(east, top, near));
    b.cuboid(Paint::StuccoCream, DVec3::new(west, GALLERY, far - WALL), DVec3::new(east, CEILING, far));
    for x in [west, CHAMBER.x] {
        b.cuboid(Paint::StuccoCream, DVec3::new(x, GALLERY, far), DVec3::new(x + WALL, CEILING, near));
    }
    b.pillar(Paint::Sandstone, DVec2::new(0.0, (near + far) * 0.5), DVec2::new(east - west, near - far), -0.2, 4.3);
}

/// Skirtings, string courses and cornices that go all the way round.
fn bands(b: &mut Builder) {
    for floor in [0.0, GALLERY] {
        // Along the walls: left out where the gallery's door is, so along three sides and a half.
        for (y0, y1, proud) in [(0.0, 0.22, 0.05), (3.5, 3.62, 0.07)] {
            for x in [-COURT.x - WALK, COURT.x + WALK] {
                b.pillar(Paint::Granite, DVec2::new(x, 0.0), DVec2::new(2.0 * proud, 18.7), floor + y0, floor + y1);
            }
            let z = COURT.y + WALK;
            b.pillar(Paint::Granite, DVec2::new(0.0, z), DVec2::new(22.0, 2.0 * proud), floor + y0, floor + y1);
            for side in [-1.0, 1.0] {
                let (at, size) = (DVec2::new(side * 5.95, -z), DVec2::new(10.1, 2.0 * proud));
                b.pillar(Paint::Granite, at, size, floor + y0, floor + y1);
            }
        }
    }
    let facing = |reach: f64| (COURT + DVec2::splat(reach)) * 2.0;
    for (y0, y1, proud) in [
        (4.22, 4.32, 0.06),
        (4.32, 4.5, 0.12),
        (4.5, 4.62, 0.17),
        (CEILING - 0.1, CEILING, 0.06),
        (CEILING, CEILING + 0.14, 0.12),
        (CEILING + 0.14, CEILING + 0.3, 0.24),
        (CEILING + 0.3, CEILING + 0.4, 0.34),
    ] {
        b.rim(Paint::Limestone, facing(0.0), 0.5 * OVER + proud, y0, y1);
    }
}

/// A well in the middle of the court.
fn well(b: &mut Builder, detail: Detail) {
    let sides = detail.sides(32.0);
    for (i, reach) in [1.75, 1.4].into_iter().enumerate() {
        b.cone(Paint::Granite, DVec2::ZERO, 8, [(reach, 0.16 * i as f64 - 0.1), (reach, 0.16 * (i + 1) as f64)]);
    }
    b.cone(Paint::GlassDark, DVec2::ZERO, sides, [(0.72, 0.2), (0.72, 0.5)]);
    hoop(b, Paint::Limestone, DVec2::ZERO, [0.7, 0.86], [0.25, 1.05], sides);
    hoop(b, Paint::Limestone, DVec2::ZERO, [0.66, 0.95], [1.05, 1.18], sides);
    for x in [-0.84, 0.84] {
        b.strut(Paint::Bronze, DVec3::new(x, 1.1, 0.0), DVec3::new(x, 2.6, 0.0), 0.035, detail.sides(10.0));
    }
    b.strut(Paint::Bronze, DVec3::new(-0.95, 2.6, 0.0), DVec3::new(0.95, 2.6, 0.0), 0.04, detail.sides(10.0));
}

/// Columns of both storeys share one mesh.
fn columns(palace: &mut Palace) {
    let mesh = palace.mesh("column", column);
    for side in Side::all() {
        for (i, floor) in (0..side.bays).flat_map(|i| [(i, 0.0), (i, GALLERY)]) {
            palace.place("column", mesh, side.turn.apply(DVec3::new(side.column_x(i), floor, -side.away)), side.turn);
        }
    }
}

fn column(b: &mut Builder, detail: Detail) {
    const SHAFT: [(f64, f64); 4] = [(0.215, 0.36), (0.212, 1.2), (0.2, 2.2), (0.18, 2.92)];
    let sides = detail.sides(14.0);
    let turned = |b: &mut Builder, knots: &[(f64, f64)], steps: f64| {
        let profile = smooth_profile(knots, detail.steps(steps));
        b.turned(Paint::Marble, Shading::Smooth, DVec2::ZERO, sides, &profile);
    };
    b.pillar(Paint::Marble, DVec2::ZERO, DVec2::splat(0.62), -0.05, 0.14);
    turned(b, &[(0.28, 0.12), (0.31, 0.18), (0.28, 0.235)], 4.0);
    turned(b, &[(0.262, 0.23), (0.236, 0.27), (0.25, 0.3)], 3.0);
    turned(b, &[(0.252, 0.295), (0.272, 0.33), (0.245, 0.365)], 4.0);
    turned(b, &SHAFT, 6.0);
    turned(b, &[(0.185, 2.86), (0.215, 2.885), (0.185, 2.91)], 3.0);
    turned(b, &[(0.175, 2.9), (0.2, 3.02), (0.27, 3.15), (0.31, 3.22), (0.27, 3.255)], 7.0);
    b.pillar(Paint::Marble, DVec2::ZERO, DVec2::splat(0.62), 3.22, 3.32);
    b.pillar(Paint::Marble, DVec2::ZERO, DVec2::splat(0.68), 3.32, COLUMN);
}

/// What is the same in every bay: the arches, the balustrade, and the walls' pilasters and beams.
fn bays(palace: &mut Palace) {
    let lower = palace.mesh("lower arch", |b, detail| arch(b, detail, COLUMN, GALLERY - 0.1));
    let upper = palace.mesh("upper arch", |b, detail| arch(b, detail, COLUMN, CEILING + 0.2 - GALLERY));
    let rail = palace.mesh("balustrade", balustrade);
    let wall = palace.mesh("bay of the wall", |b, _| wall_bay(b));
    for side in Side::all() {
        for i in 0..side.bays {
            let place = |y: f64| side.turn.apply(DVec3::new(side.column_x(i) + 0.5 * BAY, y, -side.away));
            palace.place("lower arch", lower, place(0.0), side.turn);
            palace.place("upper arch", upper, place(GALLERY), side.turn);
            palace.place("balustrade", rail, place(GALLERY), side.turn);
            palace.place("bay of the wall", wall, place(0.0), side.turn);
            palace.place("bay of the wall", wall, place(GALLERY), side.turn);
        }
    }
}

/// An arch over a bay whose middle is x = 0, with a moulding along it and a keystone.
fn arch(b: &mut Builder, detail: Detail, spring: f64, top: f64) {
    let steps = detail.steps(16.0);
    let half = 0.5 * BAY;
    let bay = Arch { middle: 0.0, half, clear: CLEAR, spring, rise: 0.72, top };
    bay.build(b, Paint::Sandstone, [-0.5 * OVER, 0.5 * OVER], steps);
    // The corners of the court need a pier between two sides' walls.
    b.pillar(Paint::Sandstone, DVec2::new(-half, 0.0), DVec2::splat(OVER + 0.02), spring, top - 0.01);
    moulding(b, detail, spring);
    b.taper(
        Paint::Limestone,
        DVec2::ZERO,
        [(DVec2::new(0.22, OVER + 0.12), spring + 0.66), (DVec2::new(0.34, OVER + 0.16), spring + 0.98)],
    );
}

/// The raised band along an arch, proud of the wall on both sides.
fn moulding(b: &mut Builder, detail: Detail, spring: f64) {
    let steps = detail.steps(16.0).max(4);
    for (inside, outside, proud) in [(0.0, 0.16, 0.03), (0.1, 0.16, 0.055)] {
        let ring = |i: usize| {
            let angle = PI * i as f64 / steps as f64;
            let at = |grow: f64, z: f64| {
                let (x, y) = (-(CLEAR + grow) * libm::cos(angle), spring + (0.72 + grow) * libm::sin(angle));
                DVec3::new(x, y, z)
            };
            let z = 0.5 * OVER + proud;
            vec![at(inside, z), at(inside, -z), at(outside, -z), at(outside, z)]
        };
        b.loft(Paint::Limestone, Shading::Flat, &(0..=steps).map(ring).collect::<Vec<_>>());
    }
}

/// Turned balusters between two rails, over a bay whose middle is x = 0.
fn balustrade(b: &mut Builder, detail: Detail) {
    const BALUSTER: [(f64, f64); 11] = [
        (0.05, 0.17),
        (0.058, 0.2),
        (0.036, 0.24),
        (0.05, 0.29),
        (0.072, 0.36),
        (0.066, 0.43),
        (0.044, 0.53),
        (0.03, 0.63),
        (0.028, 0.7),
        (0.052, 0.735),
        (0.045, 0.78),
    ];
    let profile = smooth_profile(&BALUSTER, detail.steps(10.0));
    let half = 0.5 * BAY - 0.2;
    b.pillar(Paint::Limestone, DVec2::ZERO, DVec2::new(2.0 * half, 0.26), -0.02, 0.12);
    b.pillar(Paint::Limestone, DVec2::ZERO, DVec2::new(2.0 * half, 0.22), 0.82, 0.88);
    b.pillar(Paint::Limestone, DVec2::ZERO, DVec2::new(2.0 * half, 0.3), 0.88, PARAPET);
    let count = detail.up_to(10);
    for i in 0..count {
        let at = DVec2::new(2.7 * ((i as f64 + 0.5) / count as f64 - 0.5), 0.0);
        b.pillar(Paint::Limestone, at, DVec2::splat(0.13), 0.1, 0.175);
        b.turned(Paint::Limestone, Shading::Smooth, at, detail.sides(8.0), &profile);
        b.pillar(Paint::Limestone, at, DVec2::splat(0.12), 0.775, 0.83);
    }
}

/// A pilaster on the wall opposite a column, and the beam from there to the column.
fn wall_bay(b: &mut Builder) {
    let (x, z) = (-0.5 * BAY, -WALK);
    for (width, proud, y0, y1) in [
        (0.62, 0.14, -0.05, 0.3),
        (0.46, 0.1, 0.3, 3.0),
        (0.56, 0.13, 3.0, 3.1),
        (0.52, 0.12, 3.1, 3.45),
        (0.64, 0.17, 3.45, 3.66),
    ] {
        b.pillar(Paint::Limestone, DVec2::new(x, z), DVec2::new(width, 2.0 * proud), y0, y1);
    }
    b.cuboid(Paint::Timber, DVec3::new(x - 0.13, 3.98, z - 0.1), DVec3::new(x + 0.13, 4.31, 0.2));
    for i in 0..6 {
        let z = z + 0.25 + 0.5 * f64::from(i);
        b.cuboid(Paint::Timber, DVec3::new(x, 4.16, z - 0.06), DVec3::new(x + BAY, 4.31, z + 0.06));
    }
}

/// Tiled roofs over the galleries, leaning outwards, with pavilions on the corners and over the chamber.
fn roofs(palace: &mut Palace) {
    let tiles = palace.mesh("roof tiles", tiles);
    for side in Side::all() {
        for i in 0..side.bays {
            let at = DVec3::new(side.column_x(i) + 0.5 * BAY, CEILING + 0.35, -side.away);
            palace.place("roof tiles", tiles, side.turn.apply(at), side.turn);
        }
    }
    palace.add("pavilions", |b, _| {
        let (at, size) = (COURT + DVec2::splat(0.5 * WALK + 0.2), DVec2::splat(WALK + 0.9));
        for (x, z) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            let at = at * DVec2::new(x, z);
            b.pillar(Paint::StuccoCream, at, size, CEILING, CEILING + 1.5);
            b.pillar(Paint::Limestone, at, size + DVec2::splat(0.3), CEILING + 1.5, CEILING + 1.7);
            let (eaves, peak) = (size + DVec2::splat(0.5), DVec2::splat(0.3));
            b.taper(Paint::Terracotta, at, [(eaves, CEILING + 1.7), (peak, CEILING + 3.3)]);
        }
        let (at, size) = (DVec2::new(0.0, -COURT.y - WALK - 2.6), DVec2::new(8.4, 5.2));
        b.gable(Paint::Terracotta, at, size, CEILING + 0.2, 1.6);
    });
}

/// A bay of roof from the court's cornice up to the outer wall: boards, and rows of half-round tiles on them.
fn tiles(b: &mut Builder, detail: Detail) {
    let (rows, columns) = (detail.up_to(8), detail.up_to(8));
    let (pitch, length) = (BAY / columns as f64, 4.16 / rows as f64);
    let slope = DVec3::new(0.0, 0.36, -1.0).normalize();
    let up = DVec3::X.cross(slope);
    let half = 0.5 * BAY;
    let boards = |z: f64| {
        let corner = |x: f64, y: f64| DVec3::new(x, y, z);
        let top = 0.05 + z * slope.y / slope.z;
        vec![corner(half, -0.05), corner(-half, -0.05), corner(-half, top), corner(half, top)]
    };
    b.loft(Paint::Terracotta, Shading::Flat, &[boards(0.1), boards(-WALK - WALL)]);
    let sides = detail.sides(4.0);
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        let x = pitch * (column as f64 + 0.5) - half;
        let foot = DVec3::X * x + slope * (length * 0.92 * row as f64 - 0.5);
        let ring = |along: f64, radius: f64, lift: f64| -> Vec<DVec3> {
            let middle = foot + slope * along + up * (0.03 + lift);
            let angle = |i: usize| PI * i as f64 / sides as f64;
            (0..=sides)
                .map(|i| middle + (DVec3::NEG_X * libm::cos(angle(i)) + up * libm::sin(angle(i))) * radius)
                .collect()
        };
        b.loft(Paint::Terracotta, Shading::Flat, &[ring(0.0, 0.475 * pitch, 0.03), ring(length, 0.41 * pitch, 0.0)]);
    }
}
