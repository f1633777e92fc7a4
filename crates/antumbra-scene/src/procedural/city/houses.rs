//! Where people live: terraced houses with shops below, and slabs with balconies.

use glam::{DVec2, DVec3};

use super::facade::{Facade, window};
use super::roofs;
use crate::procedural::palette::Paint;
use crate::procedural::rng::Rng;
use crate::procedural::solids::{Builder, Turn};

const WALLS: [Paint; 9] = [
    Paint::BrickRed,
    Paint::BrickRed,
    Paint::BrickBrown,
    Paint::BrickOchre,
    Paint::StuccoCream,
    Paint::StuccoCream,
    Paint::StuccoRose,
    Paint::StuccoWhite,
    Paint::Sandstone,
];

/// A terraced house: its street front is +z, `size.y` deep. `corner` says whether its left and right walls show.
pub(crate) fn terraced(b: &mut Builder, rng: &mut Rng, size: DVec2, storeys: usize, corner: [bool; 2]) {
    const SHOP_M: f64 = 4.2;
    const STOREY_M: f64 = 3.2;
    let wall = rng.pick(&WALLS);
    let trim = rng.pick(&[Paint::Limestone, Paint::StuccoWhite, Paint::StuccoCream]);
    let eaves = SHOP_M + STOREY_M * (storeys - 1) as f64;
    b.pillar(wall, DVec2::ZERO, size, -0.5, eaves);
    let rows: Vec<f64> = (1..storeys).map(|i| SHOP_M + STOREY_M * (i as f64 - 0.5) + 0.1).collect();
    let mut fronts = vec![(0, size), (2, size)];
    fronts.extend(
        corner.iter().zip([3, 1]).filter(|(shows, _)| **shows).map(|(_, turn)| (turn, DVec2::new(size.y, size.x))),
    );
    let rich = rng.chance(0.4);
    for (quarters, plan) in fronts {
        b.within(DVec3::ZERO, Turn::quarters(quarters), |b| match quarters {
            0 if rich => windows(b, trim, plan, &rows),
            _ => window_strips(b, wall, (quarters == 0).then_some(trim), plan, &rows),
        });
    }
    shop_front(b, rng, trim, size, SHOP_M);
    cornice(b, trim, size, eaves);
    roof(b, rng, wall, size, eaves);
}

/// The middles of the windows across a front.
fn axes(width: f64) -> impl Iterator<Item = f64> {
    let count = (width / 3.15).floor().max(1.0) as usize;
    (0..count).map(move |i| width * ((i as f64 + 0.5) / count as f64 - 0.5))
}

/// Windows one by one, with lintels, over a course of stone at each storey.
fn windows(b: &mut Builder, trim: Paint, plan: DVec2, rows: &[f64]) {
    let front = plan.y * 0.5;
    for &y in rows {
        for x in axes(plan.x) {
            window(b, trim, DVec3::new(x, y, front), DVec2::new(1.2, 1.9));
        }
        b.pillar(trim, DVec2::new(0.0, front), DVec2::new(plan.x - 0.5, 0.36), y - 1.17, y - 0.96);
    }
}

/// Windows above one another as one strip of glass, parted by bands of wall: a plain front for fewer triangles.
fn window_strips(b: &mut Builder, wall: Paint, trim: Option<Paint>, plan: DVec2, rows: &[f64]) {
    let front = DVec2::new(0.0, plan.y * 0.5);
    let (Some(first), Some(last)) = (rows.first(), rows.last()) else { return };
    for x in axes(plan.x) {
        b.pillar(Paint::GlassDark, front + DVec2::X * x, DVec2::new(1.2, 0.1), first - 1.0, last + 0.95);
    }
    for &y in rows {
        b.pillar(wall, front, DVec2::new(plan.x - 0.3, 0.24), y - 2.2, y - 1.0);
        if let Some(trim) = trim {
            b.pillar(trim, front, DVec2::new(plan.x - 0.5, 0.4), y - 1.12, y - 0.94);
        }
    }
}

fn shop_front(b: &mut Builder, rng: &mut Rng, trim: Paint, size: DVec2, top: f64) {
    let front = size.y * 0.5;
    if rng.chance(0.5) {
        let pane = DVec2::new(size.x - 1.6, 0.4);
        b.pillar(Paint::GlassDark, DVec2::new(0.0, front - 0.1), pane, 0.4, top - 1.1);
        let awning =
            rng.pick(&[Paint::BrickRed, Paint::StuccoCream, Paint::LeafDeep, Paint::Terracotta, Paint::CarBlue]);
        let edge = |z: f64, y: f64| DVec3::new(0.0, y, front + z);
        let profile = [edge(1.5, top - 1.45), edge(-0.1, top - 1.45), edge(-0.1, top - 0.55), edge(1.5, top - 1.3)];
        let ring = |x: f64| profile.map(|p| p + DVec3::X * x).to_vec();
        b.loft(awning, crate::procedural::solids::Shading::Flat, &[ring(-pane.x * 0.5), ring(pane.x * 0.5)]);
    } else {
        stoop(b, trim, DVec2::new(size.x * rng.range(-0.25, 0.25), front));
    }
    b.pillar(trim, DVec2::new(0.0, front), DVec2::new(size.x - 0.1, 0.5), top - 0.45, top - 0.1);
}

/// Four steps to a door.
fn stoop(b: &mut Builder, trim: Paint, at: DVec2) {
    for i in 0..4 {
        let depth = 0.45 * f64::from(4 - i);
        let middle = at + DVec2::new(0.0, depth * 0.5 - 0.1);
        let height = 0.22 * f64::from(i + 1);
        b.pillar(Paint::Granite, middle, DVec2::new(1.9, depth + 0.2), -0.5, 0.16 + height);
    }
    b.pillar(Paint::Timber, at, DVec2::new(1.1, 0.3), 0.9, 3.1);
    b.pillar(trim, at, DVec2::new(1.7, 0.9), 3.1, 3.4);
}

fn cornice(b: &mut Builder, trim: Paint, size: DVec2, eaves: f64) {
    for (grow, drop) in [(0.9, 0.0), (0.5, 0.35)] {
        let plan = DVec2::new(size.x - 0.06, size.y + grow);
        b.pillar(trim, DVec2::ZERO, plan, eaves - drop - 0.3, eaves - drop + 0.06);
    }
}

fn roof(b: &mut Builder, rng: &mut Rng, wall: Paint, size: DVec2, eaves: f64) {
    match rng.index(5) {
        0 | 1 => {
            b.gable(Paint::Terracotta, DVec2::ZERO, size + DVec2::new(-0.08, 0.8), eaves, size.y * 0.34);
            roofs::chimney(b, DVec2::new(size.x * 0.36, 0.8), eaves, eaves + size.y * 0.34 + 1.2);
        }
        2 => mansard(b, rng, size, eaves),
        _ => {
            b.rim(wall, size - DVec2::splat(0.04), 0.35, eaves - 0.2, eaves + 0.9);
            roofs::flat(b, rng, size - DVec2::splat(0.5), eaves);
            if rng.chance(0.3) {
                roofs::water_tank(b, size * DVec2::new(-0.2, -0.18), eaves, 1.4);
            }
            roofs::chimney(b, size * DVec2::new(0.4, 0.1), eaves, eaves + 1.9);
        }
    }
}

fn mansard(b: &mut Builder, rng: &mut Rng, size: DVec2, eaves: f64) {
    let low = size + DVec2::new(-0.08, 0.3);
    let high = size - DVec2::new(0.6, 3.4);
    let slate = rng.pick(&[Paint::Slate, Paint::Slate, Paint::Copper]);
    b.taper(slate, DVec2::ZERO, [(low, eaves), (high, eaves + 3.2)]);
    b.taper(slate, DVec2::ZERO, [(high + DVec2::splat(0.3), eaves + 3.15), (high * DVec2::new(0.9, 0.1), eaves + 4.2)]);
    let count = (size.x / 3.0).floor().max(1.0) as usize;
    for (i, side) in (0..count).flat_map(|i| [(i, 0), (i, 2)]) {
        let x = size.x * ((i as f64 + 0.5) / count as f64 - 0.5);
        b.within(DVec3::ZERO, Turn::quarters(side), |b| {
            let z = size.y * 0.5 - 0.9;
            b.pillar(Paint::StuccoWhite, DVec2::new(x, z), DVec2::new(1.4, 1.5), eaves + 0.3, eaves + 2.2);
            b.pillar(Paint::GlassDark, DVec2::new(x, z), DVec2::new(0.95, 1.6), eaves + 0.6, eaves + 1.95);
            b.pillar(slate, DVec2::new(x, z), DVec2::new(1.7, 1.9), eaves + 2.15, eaves + 2.4);
        });
    }
    roofs::chimney(b, DVec2::new(size.x * 0.38, -0.5), eaves, eaves + 5.4);
}

/// A long residential slab on columns, balconies to the front.
pub(crate) fn slab(b: &mut Builder, rng: &mut Rng, size: DVec2, height: f64) {
    const LIFT_M: f64 = 4.0;
    let accent =
        rng.pick(&[Paint::StuccoRose, Paint::BrickOchre, Paint::GlassGreen, Paint::StuccoCream, Paint::Terracotta]);
    let facade = Facade {
        glass: Paint::GlassDark,
        wall: rng.pick(&[Paint::StuccoWhite, Paint::Concrete, Paint::StuccoCream]),
        bay: 4.2,
        pier: DVec2::new(1.5, 0.18),
        storey: 3.0,
        band: DVec2::new(1.1, 0.24),
    };
    facade.clad(b, size, LIFT_M, height);
    roofs::flat(b, rng, size, height);
    b.pillar(Paint::GlassGrey, DVec2::ZERO, DVec2::new(size.x * 0.5, size.y * 0.6), -0.5, LIFT_M);
    pilotis(b, size, LIFT_M);
    balconies(b, accent, size, LIFT_M, height);
    let stair = DVec2::new(rng.range(-0.3, 0.3) * size.x, -size.y * 0.5 - 1.4);
    b.pillar(accent, stair, DVec2::new(5.0, 3.6), -0.5, height + 3.5);
}

fn pilotis(b: &mut Builder, size: DVec2, height: f64) {
    let count = (size.x / 6.0).round().max(2.0) as usize;
    for (i, side) in (0..=count).flat_map(|i| [(i, -0.4), (i, 0.4)]) {
        let x = (size.x - 1.0) * (i as f64 / count as f64 - 0.5);
        b.cone(Paint::Concrete, DVec2::new(x, size.y * side), 8, [(0.35, -0.5), (0.45, height)]);
    }
}

fn balconies(b: &mut Builder, accent: Paint, size: DVec2, y0: f64, y1: f64) {
    let (bays, storeys) = ((size.x / 4.2).round() as usize, ((y1 - y0) / 3.0).round() as usize);
    let storey = (y1 - y0) / storeys as f64;
    for i in 0..bays {
        let x = size.x * ((i as f64 + 0.5) / bays as f64 - 0.5);
        for k in 0..storeys {
            let y = y0 + storey * k as f64;
            let paint = if (i + k) % 3 == 0 { accent } else { Paint::White };
            b.pillar(Paint::Concrete, DVec2::new(x, size.y * 0.5 + 0.6), DVec2::new(3.3, 1.6), y - 0.05, y + 0.15);
            b.pillar(paint, DVec2::new(x, size.y * 0.5 + 1.33), DVec2::new(3.36, 0.12), y - 0.1, y + 1.05);
        }
    }
}
