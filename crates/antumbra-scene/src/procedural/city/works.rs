//! The works by the river: sheds, silos, tanks, chimneys, cranes.

use glam::{DVec2, DVec3};

use crate::procedural::palette::Paint;
use crate::procedural::rng::Rng;
use crate::procedural::solids::{Builder, Shading, Turn};

/// Something industrial on a lot of that size.
pub(crate) fn works(b: &mut Builder, rng: &mut Rng, size: DVec2) {
    match rng.index(6) {
        0 if size.min_element() > 22.0 => silos(b, rng, size),
        1 if size.min_element() > 22.0 => tank_farm(b, rng, size),
        2 => power_house(b, size),
        _ => shed(b, rng, size),
    }
}

/// A brick shed with a saw-tooth roof.
fn shed(b: &mut Builder, rng: &mut Rng, size: DVec2) {
    let wall = rng.pick(&[Paint::BrickRed, Paint::BrickBrown, Paint::Concrete, Paint::BrickOchre]);
    let eaves = rng.range(7.0, 11.0);
    b.pillar(wall, DVec2::ZERO, size, -0.5, eaves);
    b.rim(Paint::Limestone, size + DVec2::splat(0.3), 0.6, eaves - 0.4, eaves + 0.5);
    let teeth = (size.x / 7.0).round().max(1.0) as usize;
    let pitch = (size.x - 1.0) / teeth as f64;
    for i in 0..teeth {
        let x = pitch * i as f64 - (size.x - 1.0) * 0.5;
        tooth(b, x + 0.05, pitch - 0.1, size.y - 1.2, eaves);
    }
    let bays = (size.x / 4.5).round().max(1.0) as usize;
    for (i, side) in (0..bays).flat_map(|i| [(i, -0.5), (i, 0.5)]) {
        let x = size.x * ((i as f64 + 0.5) / bays as f64 - 0.5);
        let at = DVec2::new(x, size.y * side);
        b.pillar(Paint::GlassDark, at, DVec2::new(2.6, 0.16), 2.4, eaves - 1.6);
        b.pillar(wall, at + DVec2::X * 2.25, DVec2::new(0.8, 0.7), -0.5, eaves - 0.6);
        b.pillar(Paint::Limestone, at, DVec2::new(3.0, 0.5), 2.1, 2.4);
    }
    b.pillar(Paint::Concrete, DVec2::new(0.0, size.y * 0.5 + 1.2), DVec2::new(size.x * 0.5, 3.0), -0.5, 1.3);
}

fn tooth(b: &mut Builder, x: f64, pitch: f64, depth: f64, y: f64) {
    let section = |z: f64| -> Vec<DVec3> {
        [(0.0, -0.3), (pitch, -0.3), (pitch, 0.2), (0.6, 3.2), (0.0, 3.2)]
            .map(|(dx, dy)| DVec3::new(x + dx, y + dy, z))
            .to_vec()
    };
    b.loft(Paint::Slate, Shading::Flat, &[section(-depth * 0.5), section(depth * 0.5)]);
    b.pillar(Paint::GlassGrey, DVec2::new(x, 0.0), DVec2::new(0.16, depth - 1.0), y + 0.8, y + 2.8);
}

fn silos(b: &mut Builder, rng: &mut Rng, size: DVec2) {
    let radius = 4.6;
    let (columns, rows) = ((size.x / 9.4).floor() as usize, (size.y * 0.8 / 9.4).floor().max(1.0) as usize);
    let height = rng.range(24.0, 34.0);
    for (i, k) in (0..columns).flat_map(|i| (0..rows).map(move |k| (i, k))) {
        let at = DVec2::new(i as f64 - (columns - 1) as f64 * 0.5, k as f64 - (rows - 1) as f64 * 0.5) * 9.3;
        b.cone(Paint::Concrete, at, 24, [(radius, -0.5), (radius, height)]);
        b.cone(Paint::White, at, 24, [(radius + 0.15, height - 0.4), (0.0, height + 1.8)]);
    }
    let gallery = DVec2::new(columns as f64 * 9.3, 4.0);
    b.pillar(Paint::Steel, DVec2::ZERO, gallery, height + 0.8, height + 5.0);
    b.pillar(Paint::Concrete, DVec2::new(gallery.x * 0.5 - 1.0, 0.0), DVec2::new(7.0, 8.0), -0.5, height + 14.0);
}

fn tank_farm(b: &mut Builder, rng: &mut Rng, size: DVec2) {
    b.rim(Paint::Concrete, size - DVec2::splat(1.0), 0.5, -0.4, 1.6);
    let radius = size.min_element() * 0.21;
    for (sx, sz) in [(-0.25, -0.25), (0.25, -0.25), (-0.25, 0.25), (0.25, 0.25)] {
        let at = size * DVec2::new(sx, sz);
        let height = rng.range(8.0, 14.0);
        let paint = rng.pick(&[Paint::White, Paint::StuccoCream, Paint::Steel]);
        b.cone(paint, at, 28, [(radius, -0.4), (radius, height)]);
        b.dome(paint, at, 28, height - 0.1, DVec2::new(radius * 0.98, radius * 0.25));
        for k in 1..4 {
            let y = height * f64::from(k) / 4.0;
            b.cone(Paint::Steel, at, 28, [(radius + 0.18, y), (radius + 0.18, y + 0.25)]);
        }
        b.strut(Paint::Steel, DVec3::new(at.x, 1.0, at.y), DVec3::new(0.0, 1.0, at.y), 0.35, 6);
    }
}

fn power_house(b: &mut Builder, size: DVec2) {
    let hall = size * DVec2::new(0.92, 0.6);
    super::facade::Facade {
        glass: Paint::GlassDark,
        wall: Paint::BrickBrown,
        bay: 5.0,
        pier: DVec2::new(2.6, 0.5),
        storey: 16.0,
        band: DVec2::new(4.0, 0.25),
    }
    .clad(b, hall, 0.2, 21.0);
    b.gable(Paint::Slate, DVec2::ZERO, hall * 0.94, 20.9, 5.0);
    let count = (size.x / 14.0).floor().clamp(1.0, 4.0) as usize;
    for i in 0..count {
        let x = size.x * 0.8 * ((i as f64 + 0.5) / count as f64 - 0.5);
        stack(b, DVec2::new(x, -size.y * 0.36), 62.0);
    }
}

/// A tall chimney with bands.
fn stack(b: &mut Builder, at: DVec2, height: f64) {
    b.pillar(Paint::BrickBrown, at, DVec2::splat(5.6), -0.5, 7.0);
    b.turned(Paint::BrickRed, Shading::Smooth, at, 20, &[(2.5, 6.5), (1.6, height)]);
    for share in [0.86, 0.93, 1.0] {
        let radius = 2.5 - 0.9 * share + 0.25;
        b.cone(Paint::StuccoWhite, at, 20, [(radius, height * share - 1.6), (radius, height * share + 0.1)]);
    }
}

/// A quay crane on a gantry; its arm reaches along +z.
pub(crate) fn crane(b: &mut Builder, paint: Paint) {
    for (sx, sz) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
        b.strut(paint, DVec3::new(sx * 4.0, -0.3, sz * 3.5), DVec3::new(sx * 2.2, 11.0, sz * 2.2), 0.4, 4);
    }
    b.pillar(paint, DVec2::ZERO, DVec2::new(6.0, 6.0), 10.6, 11.8);
    b.pillar(Paint::White, DVec2::new(0.0, 0.5), DVec2::new(3.4, 5.0), 11.6, 15.6);
    let tip = DVec3::new(0.0, 34.0, 26.0);
    for side in [-0.9, 0.9] {
        b.strut(paint, DVec3::new(side, 14.0, 2.0), tip, 0.28, 4);
        b.strut(paint, DVec3::new(side, 14.0, -1.0), DVec3::new(side, 25.0, -1.5), 0.3, 4);
        b.strut(Paint::Steel, DVec3::new(side, 25.0, -1.5), tip, 0.12, 4);
    }
    for i in 1..7 {
        let t = f64::from(i) / 7.0;
        let at = DVec3::new(0.0, 14.0 + 20.0 * t, 2.0 + 24.0 * t);
        let half = DVec3::X * (0.9 * (1.0 - t) + 0.15);
        b.strut(paint, at - half, at + half, 0.14, 4);
    }
    b.strut(Paint::Steel, tip, DVec3::new(0.0, 8.0, 26.0), 0.08, 4);
    b.pillar(Paint::BrickBrown, DVec2::new(0.0, 26.0), DVec2::new(2.4, 6.0), 5.6, 8.2);
    b.within(DVec3::ZERO, Turn::NONE, |b| {
        b.pillar(Paint::Concrete, DVec2::new(0.0, -3.0), DVec2::new(3.0, 2.4), 11.6, 14.4);
    });
}
