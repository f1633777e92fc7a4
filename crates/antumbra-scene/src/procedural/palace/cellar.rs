//! The wine cellar below the court: a hall of groined vaults on pillars, an anteroom to the east, a lumber room to the west,
//! and a strongroom to the south behind a grille.

use glam::{DVec2, DVec3};

use super::Palace;
use super::looks::Look;
use super::plan::{
    ANTEROOM, BAY, DOOR, EAST_DOOR_Z, FLOOR, GRILLE, HALL, LUMBER, RISE, SPRING, STRONGROOM, THICK, UNDER, WEST_DOOR_Z,
};
use crate::procedural::palette::Paint;
use crate::procedural::shapes::{Arch, Detail, Opening, Vault, wall};
use crate::procedural::solids::{Builder, Shading, Turn, octagon};

/// Builds the cellar.
pub(super) fn build(palace: &mut Palace) {
    palace.add("cellar floors", |b, _| floors(b));
    palace.add("cellar walls", walls);
    palace.add("side vaults", side_vaults);
    palace.add("stairs", |b, _| stairs(b));
    palace.add("grille", grille);
    vaults(palace);
}

fn floors(b: &mut Builder) {
    b.cuboid(Paint::Quay, DVec3::new(-13.8, FLOOR - 0.3, -4.8), DVec3::new(13.2, FLOOR, 9.6));
    // Flagstones a little proud of their joints, in courses that break joint.
    for row in 0..12 {
        let z = 0.7 * f64::from(row) - HALL.y + 0.35;
        for column in 0..17 {
            let x = 0.96 * f64::from(column) - HALL.x + if row % 2 == 0 { 0.32 } else { 0.0 };
            let paint = if (row * 7 + column * 5) % 11 < 3 { Paint::Granite } else { Paint::Paving };
            b.pillar(paint, DVec2::new(x + 0.16, z), DVec2::new(0.945, 0.685), FLOOR - 0.1, FLOOR + 0.008);
        }
    }
}

fn walls(b: &mut Builder, detail: Detail) {
    let steps = detail.steps(20.0);
    let (x, z) = (HALL.x + THICK, HALL.y + THICK);
    let corner = |x: f64, z: f64| DVec3::new(x, FLOOR - 0.2, z);
    let top = |x: f64, z: f64| DVec3::new(x, UNDER + 0.1, z);
    let stone = Paint::Limestone;
    b.cuboid(stone, corner(-x, -z), top(x, -HALL.y));
    let [half, spring, crown] = GRILLE;
    let opening = Opening { middle: 0.0, half, spring, rise: crown - spring };
    wall(b, stone, corner(-x, HALL.y), top(x, z), &[opening], steps);
    // Walls along z are built along x and turned: a quarter turn brings +x to -z and +z to +x.
    let east = Opening { middle: -EAST_DOOR_Z, half: 0.7, spring: FLOOR + 1.75, rise: 0.55 };
    let west = Opening { middle: -WEST_DOOR_Z, half: DOOR.x, spring: FLOOR + DOOR.y, rise: 0.0 };
    b.within(DVec3::ZERO, Turn::quarters(1), |b| {
        wall(b, stone, corner(-z, HALL.x), top(z, x), &[east], steps);
        wall(b, stone, corner(-z, -x), top(z, -HALL.x), &[west], steps);
    });
    for (room, paint) in
        [(ANTEROOM, Paint::StuccoCream), (LUMBER, Paint::StuccoCream), (STRONGROOM, Paint::StuccoWhite)]
    {
        room_walls(b, paint, room);
    }
    // Pillars in the hall, responds along its walls.
    for i in 0..=5 {
        let x = BAY * f64::from(i) - HALL.x;
        for z in [-HALL.y, 0.0, HALL.y] {
            pillar(b, DVec2::new(x, z));
        }
    }
}

/// The three walls of a side room that are not the hall's own.
fn room_walls(b: &mut Builder, paint: Paint, [[x0, x1], [z0, z1]]: [[f64; 2]; 2]) {
    const T: f64 = THICK - 0.05;
    let mut wall = |x: [f64; 2], z: [f64; 2]| {
        b.cuboid(paint, DVec3::new(x[0], FLOOR - 0.2, z[0]), DVec3::new(x[1], UNDER + 0.1, z[1]));
    };
    if z0 < HALL.y {
        wall([x0 - 0.05, x1 + 0.05], [z0 - T, z0]);
    }
    wall([x0 - 0.05, x1 + 0.05], [z1, z1 + T]);
    if x0 < HALL.x {
        wall([x0 - T, x0], [z0 - 0.05, z1 + T]);
    }
    if x1 > -HALL.x {
        wall([x1, x1 + T], [z0 - 0.05, z1 + T]);
    }
}

/// A square base, an eight-sided shaft, and a capital that widens to the vaults' corners.
fn pillar(b: &mut Builder, at: DVec2) {
    let top = SPRING + 0.03;
    b.pillar(Paint::Sandstone, at, DVec2::splat(0.66), FLOOR - 0.1, FLOOR + 0.16);
    b.taper(Paint::Sandstone, at, [(DVec2::splat(0.62), FLOOR + 0.16), (DVec2::splat(0.5), FLOOR + 0.25)]);
    let ring = |size: f64, y: f64| octagon(at, DVec2::splat(size), 0.29 * size, y);
    b.loft(Paint::Sandstone, Shading::Flat, &[ring(0.5, FLOOR + 0.2), ring(0.46, top - 0.3)]);
    b.loft(Paint::Sandstone, Shading::Flat, &[ring(0.54, top - 0.35), ring(0.54, top - 0.3)]);
    b.taper(Paint::Sandstone, at, [(DVec2::splat(0.44), top - 0.3), (DVec2::splat(0.62), top - 0.1)]);
    b.pillar(Paint::Sandstone, at, DVec2::splat(0.66), top - 0.1, top);
}

/// Ten bays of one vault, with ribs between them.
fn vaults(palace: &mut Palace) {
    let bay = palace.mesh("vault", |b, detail| {
        let size = DVec2::new(BAY, HALL.y);
        Vault { size, spring: SPRING, rise: RISE, top: UNDER + 0.05 }.build(b, Paint::StuccoCream, detail.steps(8.0));
    });
    let along = palace.mesh("rib along", |b, detail| rib(b, detail, BAY));
    let across = palace.mesh("rib across", |b, detail| rib(b, detail, HALL.y));
    for (i, k) in (0..5).flat_map(|i| [(i, -0.5), (i, 0.5)]) {
        let middle = DVec3::new(BAY * (f64::from(i) - 2.0), 0.0, HALL.y * k);
        palace.place("vault", bay, middle, Turn::NONE);
        if k < 0.0 {
            palace.place("rib", along, middle + DVec3::Z * 0.5 * HALL.y, Turn::NONE);
        }
        if i > 0 {
            palace.place("rib", across, middle - DVec3::X * 0.5 * BAY, Turn::quarters(1));
        }
    }
}

/// A flat stone arch below a vault's edge.
fn rib(b: &mut Builder, detail: Detail, span: f64) {
    let (half, rise) = (0.5 * span, RISE - 0.12);
    let rib = Arch { middle: 0.0, half, clear: half - 0.14, spring: SPRING, rise, top: UNDER };
    rib.build(b, Paint::Sandstone, [-0.16, 0.16], detail.steps(20.0));
}

/// Barrels over the lumber room and the strongroom, beams over the anteroom.
fn side_vaults(b: &mut Builder, detail: Detail) {
    let steps = detail.steps(22.0);
    let barrel = |b: &mut Builder, across: [f64; 2], along: [f64; 2]| {
        let (middle, half) = ((across[0] + across[1]) * 0.5, (across[1] - across[0]) * 0.5 + 0.05);
        let arch = Arch { middle, half, clear: half - 0.06, spring: FLOOR + 1.9, rise: 1.1, top: UNDER + 0.05 };
        arch.build(b, Paint::StuccoWhite, along, steps);
    };
    barrel(b, STRONGROOM[0], [STRONGROOM[1][0] - 0.02, STRONGROOM[1][1] + 0.05]);
    let [[x0, x1], [z0, z1]] = LUMBER;
    b.within(DVec3::ZERO, Turn::quarters(1), |b| barrel(b, [-z1, -z0], [x0 - 0.05, x1 + 0.02]));
    let [[x0, x1], [z0, z1]] = ANTEROOM;
    b.cuboid(Paint::Timber, DVec3::new(x0 - 0.05, -1.0, z0 - 0.1), DVec3::new(x1 + 0.1, UNDER + 0.05, z1 + 0.1));
    for i in 0..5 {
        let x = x0 + 0.45 + 0.8 * f64::from(i);
        b.cuboid(Look::DarkOak, DVec3::new(x - 0.09, -1.2, z0 - 0.1), DVec3::new(x + 0.09, -0.95, z1 + 0.1));
    }
}

/// Stairs in the anteroom, up to a door that stays shut.
fn stairs(b: &mut Builder) {
    let [[_, x1], [z0, _]] = ANTEROOM;
    for i in 0..6 {
        let (rise, reach) = (0.17 * f64::from(i + 1), 0.3 * f64::from(6 - i) + 0.9);
        let (min, max) = (DVec3::new(x1 - reach, FLOOR - 0.1, z0), DVec3::new(x1 + 0.05, FLOOR + rise, z0 + 1.5));
        b.cuboid(Paint::Granite, min, max);
    }
    let (foot, z) = (FLOOR + 1.02, z0 + 0.75);
    b.cuboid(Look::Oak, DVec3::new(x1 - 0.05, foot, z - 0.5), DVec3::new(x1 + 0.1, foot + 1.75, z + 0.5));
    for side in [-0.6, 0.6] {
        let (min, max) =
            (DVec3::new(x1 - 0.1, foot, z + side - 0.1), DVec3::new(x1 + 0.1, foot + 1.85, z + side + 0.1));
        b.cuboid(Paint::Limestone, min, max);
    }
}

/// Thin bars in the arch to the strongroom, with a gate among them.
fn grille(b: &mut Builder, detail: Detail) {
    const PITCH: f64 = 0.15;
    let [half, spring, crown] = GRILLE;
    let (z, sides) = (HALL.y + 0.22, detail.sides(10.0));
    for i in -7..=7 {
        let x = PITCH * f64::from(i);
        let top = spring + (crown - spring) * (1.0 - (x / half) * (x / half)).sqrt();
        b.strut(Look::Iron, DVec3::new(x, FLOOR - 0.02, z), DVec3::new(x, top + 0.06, z), 0.014, sides);
    }
    for y in [0.12, 0.85, 1.6] {
        let (min, max) =
            (DVec3::new(-half - 0.05, FLOOR + y, z - 0.008), DVec3::new(half + 0.05, FLOOR + y + 0.04, z + 0.008));
        b.cuboid(Look::Iron, min, max);
    }
    for x in [-0.45, 0.45] {
        let (min, max) = (DVec3::new(x - 0.02, FLOOR - 0.02, z - 0.02), DVec3::new(x + 0.02, FLOOR + 1.64, z + 0.02));
        b.cuboid(Look::Iron, min, max);
    }
    b.cuboid(Look::Iron, DVec3::new(0.3, FLOOR + 0.95, z - 0.035), DVec3::new(0.46, FLOOR + 1.15, z + 0.035));
    b.cuboid(Look::Iron, DVec3::new(-0.47, FLOOR + 1.62, z - 0.02), DVec3::new(0.47, FLOOR + 1.66, z + 0.02));
}
