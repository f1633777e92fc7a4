//! Three rows of closed houses around the square, over arcades in which one can walk.

use glam::{DVec2, DVec3};

use super::{Market, SQUARE};
use crate::procedural::palette::Paint;
use crate::procedural::rng::Rng;
use crate::procedural::shapes::{Detail, Opening, wall};
use crate::procedural::solids::{Builder, Turn};
use crate::procedural::village::houses::{Body, OVERHANG_M, ROOF_M, chimney, roof, window};
use crate::procedural::village::{Coat, Glow};

const DEPTH_M: f64 = 9.0;
/// From the arcade's front to the shops behind it.
pub(super) const ARCADE_M: f64 = 3.0;
/// Height of the arcade's floor.
pub(super) const FLOOR_M: f64 = 0.14;
/// Underside of the upper floors.
pub(super) const CEILING_M: f64 = 4.0;
const STOREY_M: f64 = 2.9;

/// One side of the square: along it houses stand from `from` to `to`, west to east in a frame whose front is +z.
struct Row {
    from: f64,
    to: f64,
    /// Distance of the fronts from the square's middle.
    away: f64,
    turn: Turn,
}

const GLOWS: [Option<Glow>; 6] = [None, None, None, Some(Glow::Pane), Some(Glow::Curtain), None];

pub(super) fn build(market: &mut Market) {
    for row in [
        Row { from: -15.5, to: 15.0, away: SQUARE.y, turn: Turn::NONE },
        Row { from: -12.0, to: 13.0, away: SQUARE.x, turn: Turn::quarters(3) },
        Row { from: -16.5, to: 12.5, away: SQUARE.y, turn: Turn::quarters(2) },
    ] {
        fill(market, &row);
    }
}

/// Houses of 6.5 to 9.5 m, side by side.
fn fill(market: &mut Market, row: &Row) {
    let mut rng = market.rng.fork(700 + market.scene.nodes.len() as u64);
    let count = ((row.to - row.from) / 7.6).round();
    let shares: Vec<f64> = (0..count as usize).map(|_| rng.range(0.85, 1.2)).collect();
    let metres = (row.to - row.from) / shares.iter().sum::<f64>();
    let mut x = row.from;
    for share in shares {
        let width = share * metres;
        let at = row.turn.apply(DVec3::new(x + width * 0.5, 0.0, -row.away));
        market.add("house", at, row.turn, |b, rng, detail| house(b, rng, detail, width));
        x += width;
    }
}

/// A house whose front is the plane z = 0.
fn house(b: &mut Builder, rng: &mut Rng, detail: Detail, width: f64) {
    let coat = coat(rng);
    let storeys = 2 + rng.index(2);
    let eaves = CEILING_M + STOREY_M * storeys as f64 + rng.range(0.1, 0.6);
    arcade(b, rng, detail, coat, width);
    let half = width * 0.5;
    b.cuboid(coat.wall, DVec3::new(-half, CEILING_M, -DEPTH_M), DVec3::new(half, eaves, 0.0));
    for (y, tall, out) in [(CEILING_M - 0.04, 0.26, 0.1), (eaves - 0.3, 0.28, 0.16)] {
        b.cuboid(Paint::Limestone, DVec3::new(-half, y, -0.2), DVec3::new(half, y + tall, out));
    }
    upper_windows(b, rng, coat, width, storeys);
    b.within(DVec3::new(0.0, 0.0, -DEPTH_M * 0.5), Turn::NONE, |b| {
        let body = Body { size: DVec2::new(width - 0.8, DEPTH_M), eaves, ridge: DEPTH_M * rng.range(0.3, 0.4) };
        b.gable(coat.wall, DVec2::ZERO, DVec2::new(width - 0.02, DEPTH_M - 0.02), eaves - 0.01, body.ridge - 0.02);
        roof(b, coat.roof, &body);
        tiles(b, detail, coat.roof, &body);
        let x = half * if rng.chance(0.5) { 0.6 } else { -0.6 };
        chimney(b, DVec2::new(x, 1.2), eaves, eaves + body.ridge + 0.8);
    });
}

fn coat(rng: &mut Rng) -> Coat {
    const WALLS: [Paint; 6] = [
        Paint::StuccoCream,
        Paint::StuccoRose,
        Paint::BrickOchre,
        Paint::StuccoWhite,
        Paint::Sandstone,
        Paint::BrickRed,
    ];
    Coat {
        wall: rng.pick(&WALLS),
        roof: rng.pick(&[Paint::Terracotta, Paint::Terracotta, Paint::BrickBrown, Paint::Slate]),
        wood: rng.pick(&[Paint::LeafDeep, Paint::CarBlue, Paint::Timber, Paint::CarRed]),
    }
}

/// The open ground floor: arches before, shops behind.
fn arcade(b: &mut Builder, rng: &mut Rng, detail: Detail, coat: Coat, width: f64) {
    let half = width * 0.5;
    let count = (width / 2.9).round();
    let pitch = width / count;
    let middles = (0..count as usize).map(|i| (i as f64 + 0.5) * pitch - half);
    let clear = pitch * 0.5 - 0.36;
    let arches: Vec<_> =
        middles.clone().map(|middle| Opening { middle, half: clear, spring: 2.35, rise: clear }).collect();
    let (min, max) = (DVec3::new(-half, -0.4, -0.55), DVec3::new(half, CEILING_M + 0.05, 0.0));
    wall(b, Paint::Limestone, min, max, &arches, detail.steps(20.0));
    for i in 0..=count as usize {
        let x = (i as f64 * pitch - half).clamp(-half + 0.2, half - 0.2);
        b.pillar(Paint::Granite, DVec2::new(x, -0.275), DVec2::new(0.84, 0.68), 2.22, 2.38);
        b.pillar(Paint::Granite, DVec2::new(x, -0.275), DVec2::new(0.88, 0.7), -0.3, 0.5);
    }
    b.cuboid(Paint::Granite, DVec3::new(-half, -0.5, -ARCADE_M - 0.2), DVec3::new(half, FLOOR_M, 0.4));
    b.cuboid(coat.wall, DVec3::new(-half, -0.4, -DEPTH_M), DVec3::new(half, CEILING_M + 0.05, -ARCADE_M));
    for (i, x) in middles.enumerate() {
        if i % 2 == 1 {
            b.pillar(Paint::Limestone, DVec2::new(x, -ARCADE_M), DVec2::new(1.3, 0.16), 0.1, 2.55);
            b.pillar(coat.wood, DVec2::new(x, -ARCADE_M), DVec2::new(1.04, 0.24), 0.1, 2.4);
        } else {
            let glow = rng.pick(&[Some(Glow::Curtain), Some(Glow::Pane), None]);
            window(b, coat, DVec3::new(x, 1.75, -ARCADE_M), DVec2::new(1.5, 1.4), glow, false);
        }
    }
}

fn upper_windows(b: &mut Builder, rng: &mut Rng, coat: Coat, width: f64, storeys: usize) {
    let count = (width / 2.3).floor().max(1.0) as usize;
    for storey in 0..storeys {
        let y = CEILING_M + STOREY_M * storey as f64 + 1.5;
        for i in 0..count {
            let x = width * ((i as f64 + 0.5) / count as f64 - 0.5);
            window(b, coat, DVec3::new(x, y, 0.0), DVec2::new(0.95, 1.5), rng.pick(&GLOWS), true);
            if storey == 0 && i % 2 == 0 {
                flower_box(b, DVec3::new(x, y - 0.95, 0.24));
            }
        }
    }
}

/// A box of greens under a window.
fn flower_box(b: &mut Builder, at: DVec3) {
    let foot = DVec2::new(at.x, at.z);
    b.pillar(Paint::Timber, foot, DVec2::new(1.1, 0.24), at.y - 0.14, at.y + 0.08);
    b.taper(Paint::LeafDeep, foot, [(DVec2::new(1.2, 0.3), at.y + 0.02), (DVec2::new(0.9, 0.12), at.y + 0.26)]);
}

/// Round tiles in lines up both slopes.
fn tiles(b: &mut Builder, detail: Detail, paint: Paint, body: &Body) {
    let edge = body.size.y * 0.5 + OVERHANG_M;
    let slope = body.ridge / (body.size.y * 0.5);
    let lines = detail.sides(body.size.x / 0.5);
    let courses = detail.sides(5.0);
    for (line, side) in (0..lines).flat_map(|line| [(line, -1.0), (line, 1.0)]) {
        let x = (body.size.x + 0.6) * ((line as f64 + 0.5) / lines as f64 - 0.5);
        let at = |share: f64, up: f64| {
            let z = side * edge * (1.0 - share);
            DVec3::new(x, body.eaves + body.ridge - slope * z.abs() + ROOF_M + up, z)
        };
        // The upper end of each tile lies under the next.
        for course in 0..courses {
            let share = |i: usize| i as f64 / courses as f64;
            b.strut(paint, at(share(course), 0.035), at(share(course + 1), 0.0), 0.075, 5);
        }
    }
}
