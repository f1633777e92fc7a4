//! The church: a nave with a tower and a tall spire, in a walled yard.

use glam::{DVec2, DVec3};

use super::houses::{Body, body};
use super::{Coat, Glow};
use crate::procedural::palette::Paint;
use crate::procedural::solids::{Builder, Shading, Turn, octagon};

/// Its middle.
pub(super) const AT: DVec2 = DVec2::new(-4.0, -31.0);
/// Radians it is turned out of the east.
pub(super) const ANGLE: f64 = 0.12;

const COAT: Coat = Coat { wall: Paint::Limestone, roof: Paint::Slate, wood: Paint::Timber };
const NAVE: Body = Body { size: DVec2::new(19.0, 9.0), eaves: 6.6, ridge: 5.6 };
/// From the nave's middle to the tower's.
const TOWER_X: f64 = -11.6;
const TOWER_M: f64 = 5.6;
const BELFRY_M: f64 = 18.5;

/// The church about its own middle, its long side along x, the door towards +z.
pub(super) fn build(b: &mut Builder) {
    body(b, COAT, &NAVE);
    for quarters in [0, 2] {
        b.within(DVec3::ZERO, Turn::quarters(quarters), |b| {
            for i in 0..4 {
                let x = -7.2 + 4.8 * f64::from(i);
                lancet(b, Glow::Curtain, DVec3::new(x + 2.4, 2.0, NAVE.size.y * 0.5), DVec2::new(1.05, 3.2));
                buttress(b, DVec2::new(x, NAVE.size.y * 0.5), 5.4);
            }
        });
    }
    apse(b);
    tower(b);
    porch(b);
    yard(b);
}

/// A pointed window; `foot` is the middle of its sill.
fn lancet(b: &mut Builder, pane: impl Into<usize>, foot: DVec3, size: DVec2) {
    let outline = |grow: f64, z: f64| -> Vec<DVec3> {
        let (half, top) = (size.x * 0.5 + grow, size.y + grow);
        // Counter-clockwise seen from outside, which is +z.
        [
            (-half, -grow),
            (half, -grow),
            (half, top - 0.9),
            (half * 0.55, top - 0.3),
            (0.0, top),
            (-half * 0.55, top - 0.3),
            (-half, top - 0.9),
        ]
        .map(|(x, y)| foot + DVec3::new(x, y, z))
        .to_vec()
    };
    b.loft(Paint::Sandstone, Shading::Flat, &[outline(0.16, -0.2), outline(0.16, 0.08)]);
    b.loft(pane, Shading::Flat, &[outline(0.0, -0.1), outline(0.0, 0.11)]);
    let at = DVec2::new(foot.x, foot.z);
    b.pillar(Paint::Sandstone, at, DVec2::new(0.09, 0.3), foot.y - 0.1, foot.y + size.y - 0.25);
    b.pillar(Paint::Sandstone, at, DVec2::new(size.x + 0.1, 0.28), foot.y + 1.25, foot.y + 1.35);
}

fn buttress(b: &mut Builder, at: DVec2, top: f64) {
    b.taper(Paint::Quay, at, [(DVec2::new(0.8, 2.2), -1.2), (DVec2::new(0.7, 1.5), top * 0.55)]);
    b.taper(Paint::Limestone, at, [(DVec2::new(0.7, 1.4), top * 0.5), (DVec2::new(0.66, 0.3), top)]);
}

fn apse(b: &mut Builder) {
    let at = DVec2::new(NAVE.size.x * 0.5, 0.0);
    b.cone(Paint::Quay, at, 10, [(3.55, -1.2), (3.45, 0.5)]);
    b.cone(Paint::Limestone, at, 10, [(3.4, -0.8), (3.4, 5.4)]);
    b.turned(Paint::Slate, Shading::Flat, at, 10, &[(3.85, 5.3), (3.75, 5.5), (0.0, 8.4)]);
    b.within(DVec3::new(at.x, 0.0, 0.0), Turn::quarters(1), |b| {
        lancet(b, Glow::Curtain, DVec3::new(0.0, 1.9, 3.3), DVec2::new(0.9, 2.4));
    });
}

fn tower(b: &mut Builder) {
    let at = DVec2::new(TOWER_X, 0.0);
    b.pillar(Paint::Quay, at, DVec2::splat(TOWER_M + 0.5), -1.6, 1.1);
    b.pillar(Paint::Limestone, at, DVec2::splat(TOWER_M), -1.0, BELFRY_M);
    for y in [6.8, 12.4, BELFRY_M - 0.5] {
        b.pillar(Paint::Sandstone, at, DVec2::splat(TOWER_M + 0.34), y, y + 0.35);
    }
    b.within(DVec3::new(at.x, 0.0, at.y), Turn::NONE, |b| {
        for (sx, sz) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            let corner = DVec2::new(sx, sz) * TOWER_M * 0.5;
            b.taper(Paint::Limestone, corner, [(DVec2::splat(1.3), -1.2), (DVec2::splat(0.8), 11.8)]);
            b.pillar(Paint::Limestone, corner, DVec2::splat(0.66), BELFRY_M - 0.4, BELFRY_M + 1.5);
            b.cone(Paint::Slate, corner, 4, [(0.62, BELFRY_M + 1.4), (0.0, BELFRY_M + 3.2)]);
        }
        for quarters in 0..4 {
            b.within(DVec3::ZERO, Turn::quarters(quarters), |b| tower_face(b, quarters));
        }
        spire(b);
    });
}

/// Openings of the belfry, a clock, a slit.
fn tower_face(b: &mut Builder, quarters: usize) {
    let face = TOWER_M * 0.5;
    for x in [-1.0, 1.0] {
        lancet(b, Paint::GlassDark, DVec3::new(x, 13.6, face), DVec2::new(1.05, 3.3));
    }
    if quarters.is_multiple_of(2) {
        let disc = |radius: f64, z: f64| -> Vec<DVec3> {
            (0..20)
                .map(|i| core::f64::consts::TAU * f64::from(i) / 20.0)
                .map(|angle| DVec3::new(radius * libm::cos(angle), 10.4 + radius * libm::sin(angle), face + z))
                .collect()
        };
        b.loft(Paint::Bronze, Shading::Flat, &[disc(1.05, -0.2), disc(1.05, 0.08)]);
        b.loft(Glow::Curtain, Shading::Flat, &[disc(0.9, -0.1), disc(0.9, 0.11)]);
        b.pillar(Paint::GlassDark, DVec2::new(0.0, face), DVec2::new(0.07, 0.3), 10.35, 11.1);
        b.pillar(Paint::GlassDark, DVec2::new(0.24, face), DVec2::new(0.5, 0.3), 10.36, 10.44);
    }
    lancet(b, Paint::GlassDark, DVec3::new(0.0, 3.4, face), DVec2::new(0.6, 2.2));
}

fn spire(b: &mut Builder) {
    let ring = |half: f64, y: f64| octagon(DVec2::ZERO, DVec2::splat(2.0 * half), half * 0.586, y);
    let square = TOWER_M * 0.5 + 0.3;
    b.taper(Paint::Slate, DVec2::ZERO, [(DVec2::splat(2.0 * square), BELFRY_M), (DVec2::splat(3.6), BELFRY_M + 2.6)]);
    let tip = vec![DVec3::Y * (BELFRY_M + 16.5)];
    b.loft(Paint::Slate, Shading::Flat, &[ring(2.2, BELFRY_M + 0.4), ring(1.9, BELFRY_M + 2.8), tip]);
    let y = BELFRY_M + 16.2;
    b.cone(Paint::Bronze, DVec2::ZERO, 8, [(0.16, y), (0.16, y + 0.3)]);
    b.pillar(Paint::Bronze, DVec2::ZERO, DVec2::splat(0.08), y, y + 1.7);
    b.pillar(Paint::Bronze, DVec2::ZERO, DVec2::new(0.8, 0.08), y + 1.1, y + 1.18);
}

/// A porch before the door, lit from within.
fn porch(b: &mut Builder) {
    let front = NAVE.size.y * 0.5;
    b.within(DVec3::new(-4.8, 0.0, front + 1.2), Turn::quarters(1), |b| {
        body(b, COAT, &Body { size: DVec2::new(3.2, 3.4), eaves: 2.9, ridge: 1.9 });
    });
    let door = DVec3::new(-4.8, 0.3, front + 2.8);
    lancet(b, Glow::Pane, door, DVec2::new(1.5, 2.6));
    b.pillar(Paint::Quay, DVec2::new(-4.8, front + 3.3), DVec2::new(2.6, 1.8), -0.7, 0.22);
}

/// A low wall, headstones, and two yews by the gate.
fn yard(b: &mut Builder) {
    let (x0, x1, z0, z1) = (-18.0, 16.5, -11.0, 11.0);
    let walls = [
        ((x0 + x1) * 0.5, z0, x1 - x0, 0.45),
        (x0, 0.0, 0.45, z1 - z0),
        (x1, 0.0, 0.45, z1 - z0),
        (-12.4, z1, 11.0, 0.45),
        (7.0, z1, 18.8, 0.45),
    ];
    for (x, z, long, deep) in walls {
        b.pillar(Paint::Quay, DVec2::new(x, z), DVec2::new(long, deep), -1.2, 0.95);
        b.pillar(Paint::Granite, DVec2::new(x, z), DVec2::new(long + 0.14, deep + 0.14), 0.9, 1.06);
    }
    for i in 0..16 {
        let (row, place) = (i / 8, i % 8);
        let at = DVec2::new(1.2 + 1.85 * f64::from(place), 6.9 + 2.2 * f64::from(row));
        let tall = 0.7 + 0.14 * f64::from((place * 5 + row * 3) % 4);
        b.within(DVec3::new(at.x, 0.0, at.y), Turn::radians(0.13 * f64::from((place * 7 + row) % 5) - 0.26), |b| {
            b.pillar(Paint::Granite, DVec2::ZERO, DVec2::new(0.62, 0.16), -0.7, tall);
            b.taper(
                Paint::Granite,
                DVec2::ZERO,
                [(DVec2::new(0.62, 0.155), tall - 0.02), (DVec2::new(0.3, 0.14), tall + 0.2)],
            );
        });
    }
    for x in [-7.9, -1.7] {
        b.pillar(Paint::Limestone, DVec2::new(x + if x < -4.0 { 0.9 } else { -0.9 }, z1), DVec2::splat(0.6), -1.0, 1.9);
        b.turned(
            Paint::LeafDeep,
            Shading::Flat,
            DVec2::new(x, z1 - 2.2),
            9,
            &[(0.7, -0.5), (1.15, 1.0), (0.95, 2.6), (0.0, 4.6)],
        );
    }
}
