//! Landmarks: the capitol, the obelisk, the cathedral, the stadium.

use glam::{DVec2, DVec3};

use super::facade::Facade;
use crate::procedural::palette::Paint;
use crate::procedural::solids::{Builder, Shading, Turn, ellipse};

const STONE: Facade = Facade {
    glass: Paint::GlassDark,
    wall: Paint::Marble,
    bay: 4.0,
    pier: DVec2::new(2.0, 0.5),
    storey: 6.5,
    band: DVec2::new(1.8, 0.35),
};

/// Wings, a portico over a flight of stairs, and a dome on a colonnaded drum. The front is +z.
pub(crate) fn capitol(b: &mut Builder, size: DVec2) {
    let plan = size.min(DVec2::new(120.0, 60.0));
    steps(b, Paint::Granite, plan + DVec2::splat(9.0), 0.16, 6);
    STONE.clad(b, DVec2::new(plan.x * 0.86, plan.y * 0.42), 2.2, 17.0);
    for side in [-1.0, 1.0] {
        b.within(DVec3::new(side * plan.x * 0.38, 0.0, 0.0), Turn::NONE, |b| {
            STONE.clad(b, DVec2::new(plan.x * 0.18, plan.y * 0.8), 2.2, 19.0);
            b.gable(Paint::Slate, DVec2::ZERO, DVec2::new(plan.x * 0.17, plan.y * 0.78), 18.9, 5.0);
        });
    }
    STONE.clad(b, DVec2::splat(plan.y * 0.66), 2.2, 22.0);
    portico(b, DVec2::new(0.0, plan.y * 0.33 + 4.0), 26.0, 2.2);
    great_dome(b, plan.y * 0.27, 22.0);
}

/// Slabs that shrink upwards.
pub(crate) fn steps(b: &mut Builder, paint: Paint, size: DVec2, y: f64, count: usize) {
    for i in 0..count {
        let inset = DVec2::splat(0.9 * i as f64);
        let bottom = if i == 0 { y - 0.5 } else { y + 0.3 * i as f64 };
        b.pillar(paint, DVec2::ZERO, size - inset, bottom, y + 0.34 * (i + 1) as f64);
    }
}

fn portico(b: &mut Builder, at: DVec2, width: f64, y: f64) {
    for i in 0..8 {
        let x = at.x + width * (f64::from(i) / 7.0 - 0.5);
        column(b, DVec2::new(x, at.y + 2.0), y, y + 13.5, 0.9);
    }
    b.pillar(Paint::Marble, at, DVec2::new(width + 3.0, 9.0), y + 13.4, y + 15.4);
    b.within(DVec3::new(at.x, y + 15.3, at.y), Turn::quarters(1), |b| {
        b.gable(Paint::Marble, DVec2::ZERO, DVec2::new(9.4, width + 4.0), 0.0, 5.5);
    });
    for i in 0..7 {
        let depth = 1.1 * f64::from(7 - i);
        let middle = DVec2::new(at.x, at.y + 3.5 + depth * 0.5);
        b.pillar(Paint::Granite, middle, DVec2::new(width + 2.0, depth + 3.0), -0.4, 0.4 + 0.28 * f64::from(i));
    }
}

/// A column with base and capital.
pub(crate) fn column(b: &mut Builder, at: DVec2, y0: f64, y1: f64, radius: f64) {
    let profile = [
        (radius * 1.3, y0 - 0.3),
        (radius * 1.3, y0 + 0.4),
        (radius, y0 + 0.7),
        (radius * 0.84, y1 - 0.9),
        (radius * 1.25, y1 - 0.3),
        (radius * 1.25, y1 + 0.1),
    ];
    b.turned(Paint::Marble, Shading::Smooth, at, 12, &profile);
}

fn great_dome(b: &mut Builder, radius: f64, y: f64) {
    let ring = |b: &mut Builder, share: f64, y0: f64, y1: f64| {
        b.cone(Paint::Marble, DVec2::ZERO, 40, [(radius * share, y0), (radius * share, y1)]);
    };
    ring(b, 1.12, y - 0.4, y + 2.5);
    ring(b, 0.84, y + 2.0, y + 14.0);
    for i in 0..24 {
        let angle = core::f64::consts::TAU * f64::from(i) / 24.0;
        let at = DVec2::new(libm::cos(angle), libm::sin(angle)) * radius * 1.0;
        column(b, at, y + 2.5, y + 12.0, 0.55);
    }
    ring(b, 1.08, y + 12.0, y + 13.6);
    ring(b, 0.9, y + 13.0, y + 16.5);
    b.dome(Paint::Copper, DVec2::ZERO, 40, y + 16.3, DVec2::new(radius * 0.88, radius * 1.05));
    for i in 0..16 {
        rib(b, core::f64::consts::TAU * f64::from(i) / 16.0, radius, y + 16.3);
    }
    let top = y + 16.0 + radius * 1.05;
    b.cone(Paint::Marble, DVec2::ZERO, 16, [(radius * 0.17, top - 0.6), (radius * 0.17, top + 5.0)]);
    b.dome(Paint::Copper, DVec2::ZERO, 16, top + 4.9, DVec2::new(radius * 0.2, radius * 0.24));
    b.cone(Paint::Bronze, DVec2::ZERO, 8, [(0.4, top + 6.0), (0.1, top + 14.0)]);
}

fn rib(b: &mut Builder, angle: f64, radius: f64, y: f64) {
    let at = |i: i32| {
        let up = core::f64::consts::FRAC_PI_2 * f64::from(i) / 6.0;
        let r = radius * 0.89 * libm::cos(up);
        DVec3::new(r * libm::cos(angle), y + radius * 1.06 * libm::sin(up), r * libm::sin(angle))
    };
    (0..5).for_each(|i| b.strut(Paint::Copper, at(i), at(i + 1), 0.28, 4));
}

/// An obelisk on a stepped base.
pub(crate) fn obelisk(b: &mut Builder, height: f64) {
    steps(b, Paint::Granite, DVec2::splat(height * 0.42), 0.2, 5);
    let width = height * 0.085;
    b.pillar(Paint::Marble, DVec2::ZERO, DVec2::splat(width * 1.7), 1.4, 4.4);
    let (low, high) = (DVec2::splat(width), DVec2::splat(width * 0.62));
    b.taper(Paint::Limestone, DVec2::ZERO, [(low, 4.0), (high, height * 0.93)]);
    let tip = DVec3::new(0.0, height, 0.0);
    let foot = crate::procedural::solids::rectangle(DVec2::ZERO, high, height * 0.93);
    b.loft(Paint::Bronze, Shading::Flat, &[foot, vec![tip]]);
}

/// A fountain: basins on a stem.
pub(crate) fn fountain(b: &mut Builder, at: DVec2) {
    b.cone(Paint::Marble, at, 24, [(5.2, -0.2), (5.2, 0.85)]);
    b.cone(Paint::Water, at, 24, [(4.7, 0.0), (4.7, 0.95)]);
    b.turned(Paint::Marble, Shading::Smooth, at, 16, &[(0.7, 0.5), (0.4, 1.6), (2.2, 2.3), (2.2, 2.6)]);
    b.turned(Paint::Marble, Shading::Smooth, at, 12, &[(0.4, 2.3), (0.25, 3.4), (1.1, 3.9), (1.1, 4.1)]);
}

/// Nave, transept, buttresses, two west towers and a spire over the crossing. The west front is +z.
pub(crate) fn cathedral(b: &mut Builder, size: DVec2) {
    let long = size.y.min(size.x * 1.25);
    let nave = DVec2::new(long * 0.17, long * 0.84);
    let eaves = long * 0.27;
    let wall = Paint::Sandstone;
    let gothic =
        Facade { wall, bay: 5.5, pier: DVec2::new(2.2, 0.9), storey: eaves * 0.9, band: DVec2::new(2.2, 0.5), ..STONE };
    gothic.clad(b, nave, 0.2, eaves);
    gothic.clad(b, DVec2::new(nave.x * 1.9, nave.y * 0.96), 0.2, eaves * 0.5);
    ridge(b, nave.y, nave.x, DVec3::Y * eaves, Turn::quarters(1));
    b.within(DVec3::new(0.0, 0.0, -nave.y * 0.16), Turn::NONE, |b| {
        gothic.clad(b, DVec2::new(nave.x * 3.0, nave.x), 0.2, eaves);
        ridge(b, nave.x * 3.0, nave.x, DVec3::Y * eaves, Turn::NONE);
        b.cone(Paint::Slate, DVec2::ZERO, 8, [(nave.x * 0.3, eaves), (0.0, eaves * 2.75)]);
    });
    b.dome(Paint::Slate, DVec2::new(0.0, -nave.y * 0.5), 16, eaves * 0.8, DVec2::new(nave.x * 0.5, nave.x * 0.4));
    b.cone(wall, DVec2::new(0.0, -nave.y * 0.5), 16, [(nave.x * 0.5, -0.5), (nave.x * 0.5, eaves * 0.82)]);
    buttresses(b, nave, eaves);
    for side in [-1.0, 1.0] {
        b.within(DVec3::new(side * nave.x * 0.62, 0.0, nave.y * 0.5), Turn::NONE, |b| {
            west_tower(b, &gothic, nave.x * 0.56, eaves);
        });
    }
}

fn ridge(b: &mut Builder, long: f64, wide: f64, at: DVec3, turn: Turn) {
    b.within(at, turn, |b| b.gable(Paint::Slate, DVec2::ZERO, DVec2::new(long - 0.5, wide + 0.9), -0.2, wide * 0.75));
}

fn buttresses(b: &mut Builder, nave: DVec2, eaves: f64) {
    for (i, side) in (0..9).flat_map(|i| [(i, -1.0), (i, 1.0)]) {
        let z = nave.y * 0.86 * (f64::from(i) / 8.0 - 0.5);
        let foot = DVec3::new(side * nave.x * 1.12, eaves * 0.55, z);
        b.pillar(Paint::Sandstone, DVec2::new(foot.x, z), DVec2::new(1.4, 1.1), -0.5, eaves * 0.66);
        b.cone(Paint::Sandstone, DVec2::new(foot.x, z), 4, [(0.7, eaves * 0.66), (0.0, eaves * 0.82)]);
        b.strut(Paint::Sandstone, foot, DVec3::new(side * nave.x * 0.5, eaves * 0.86, z), 0.5, 4);
    }
}

fn west_tower(b: &mut Builder, gothic: &Facade, side: f64, eaves: f64) {
    gothic.clad(b, DVec2::splat(side), 0.2, eaves * 1.1);
    gothic.clad(b, DVec2::splat(side * 0.88), eaves * 1.1, eaves * 1.65);
    for (sx, sz) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
        let at = DVec2::new(sx, sz) * side * 0.42;
        b.cone(Paint::Sandstone, at, 6, [(side * 0.1, eaves * 1.6), (side * 0.1, eaves * 1.75)]);
        b.cone(Paint::Sandstone, at, 6, [(side * 0.13, eaves * 1.74), (0.0, eaves * 2.0)]);
    }
    b.cone(Paint::Slate, DVec2::ZERO, 8, [(side * 0.42, eaves * 1.6), (0.0, eaves * 2.5)]);
}

/// A bowl of stands under a ring of roof on masts, around a field.
pub(crate) fn stadium(b: &mut Builder, size: DVec2) {
    const SIDES: usize = 48;
    let outer = size * 0.47;
    let ring = |grow: f64, y: f64| ellipse(DVec2::ZERO, y, outer - DVec2::splat(grow), SIDES);
    let shell = |b: &mut Builder, paint: Paint, profile: &[(f64, f64)]| {
        let sections: Vec<_> =
            (0..SIDES).map(|i| profile.iter().map(|&(grow, y)| ring(grow, y)[i]).collect()).collect();
        b.loop_loft(paint, Shading::Flat, &sections);
    };
    shell(b, Paint::Concrete, &[(2.0, -0.4), (32.0, -0.4), (32.0, 2.0), (2.0, 19.0)]);
    shell(b, Paint::StuccoWhite, &[(-0.8, 16.0), (1.0, 15.6), (2.6, 22.0), (0.8, 22.4)]);
    shell(b, Paint::White, &[(-2.0, 24.0), (22.0, 27.4), (22.0, 28.0), (-2.0, 25.2)]);
    for row in 0..8 {
        let (grow, y) = (29.0 - 3.3 * f64::from(row), 3.4 + 1.87 * f64::from(row));
        let paint = if row % 3 == 1 { Paint::CarBlue } else { Paint::StuccoCream };
        shell(b, paint, &[(grow - 1.1, y - 0.8), (grow, y - 0.8), (grow, y + 0.5), (grow - 1.1, y + 0.5)]);
    }
    b.loft(Paint::Grass, Shading::Flat, &[ring(31.0, -0.4), ring(31.0, 0.5)]);
    pitch(b, outer - DVec2::splat(33.0));
    for i in (0..SIDES).step_by(2) {
        let (foot, head) = (ring(-1.2, -0.4)[i], ring(-1.2, 34.0)[i]);
        b.strut(Paint::White, foot, head, 0.5, 6);
        b.strut(Paint::Steel, head, ring(20.0, 28.0)[i], 0.16, 4);
    }
}

fn pitch(b: &mut Builder, radii: DVec2) {
    let field = radii * 1.25;
    for i in 0..8 {
        let x = field.x * ((f64::from(i) + 0.5) / 8.0 - 0.5);
        let paint = if i % 2 == 0 { Paint::LeafGreen } else { Paint::Grass };
        b.pillar(paint, DVec2::new(x, 0.0), DVec2::new(field.x / 8.0, field.y), 0.2, 0.62);
    }
    b.rim(Paint::Marking, field * 0.96, 0.3, 0.4, 0.68);
    b.pillar(Paint::Marking, DVec2::ZERO, DVec2::new(0.3, field.y * 0.95), 0.4, 0.67);
}
