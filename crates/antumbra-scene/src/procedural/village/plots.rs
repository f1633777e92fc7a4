//! Where houses stand, and their gardens: fences, hedges, paths.

use glam::{DVec2, DVec3};

use super::church;
use super::houses::Kind;
use super::land::{GREEN_M, LANE_M, Land};
use crate::procedural::foliage::{Habit, tree};
use crate::procedural::palette::Paint;
use crate::procedural::rng::Rng;
use crate::procedural::solids::{Builder, Turn};

/// A place for a house. Its front is +z in its own frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plot {
    pub at: DVec2,
    pub turn: Turn,
    pub kind: Kind,
    /// From the house's middle to the garden's front.
    pub front: f64,
}

/// Every plot: around the green, then along the lanes.
pub(super) fn all(land: &Land, rng: &Rng) -> Vec<Plot> {
    let mut plots = Vec::new();
    for (i, degrees) in [33.0_f64, 63.0, 117.0, 147.0].into_iter().enumerate() {
        let angle = degrees.to_radians();
        let out = DVec2::new(libm::cos(angle), libm::sin(angle));
        let kind = [Kind::House, Kind::Inn, Kind::Wing, Kind::House][i];
        let at = out * (GREEN_M + 10.5);
        plots.push(Plot { at, turn: facing(-out), kind, front: 9.0 });
    }
    for lane in -land.lanes..=land.lanes {
        for side in [-1.0, 1.0] {
            let mut rng = rng.fork(3000 + (lane + 64) as u64 * 2 + u64::from(side > 0.0));
            row(land, &mut rng, lane, side, &mut plots);
        }
    }
    plots
}

/// The houses along one side of a lane.
fn row(land: &Land, rng: &mut Rng, lane: i32, side: f64, plots: &mut Vec<Plot>) {
    let mut x = -land.reach + rng.range(6.0, 12.0);
    while x < land.reach - 5.0 {
        let middle = DVec2::new(x, land.lane_z(lane, x));
        let way = DVec2::new(2.0, land.lane_z(lane, x + 1.0) - land.lane_z(lane, x - 1.0)).normalize();
        let out = way.perp() * side;
        let (setback, kind) = (rng.range(3.2, 7.0), rng.pick(&Kind::COMMON));
        let front = setback + kind.depth() * 0.5;
        let at = middle + out * (LANE_M + front);
        let clear = plots.iter().all(|p| (p.at - at).length() > 15.5);
        let off_cross = land.lanes == 0 || (at.x - land.cross_x(at.y)).abs() > 11.0;
        let free = at.length() > GREEN_M + 14.0 && (at - church::AT).length() > 26.0;
        if clear && off_cross && free && land.off_lanes(at) > LANE_M + front - 1.5 {
            let turn = facing(-out).then(Turn::radians(rng.range(-0.06, 0.06)));
            plots.push(Plot { at, turn, kind, front: front - 0.5 });
        }
        x += rng.range(17.0, 23.0);
    }
}

/// The turn that brings +z to a unit vector of the ground plane.
fn facing(ahead: DVec2) -> Turn {
    Turn::facing(ahead.perp() * -1.0)
}

/// What surrounds a house.
pub(super) fn garden(b: &mut Builder, rng: &mut Rng, plot: &Plot, land: &Land) {
    let base = land.height(plot.at);
    let ground = |p: DVec2| {
        let offset = plot.turn.apply(DVec3::new(p.x, 0.0, p.y));
        land.height(plot.at + DVec2::new(offset.x, offset.z)) - base
    };
    let wide = plot.kind.width() * 0.5 + rng.range(1.2, 2.4);
    let near = plot.kind.depth() * 0.5;
    path(b, near, plot.front, &ground);
    let sides = [
        (DVec2::new(-wide, plot.front), DVec2::new(-0.85, plot.front)),
        (DVec2::new(0.85, plot.front), DVec2::new(wide, plot.front)),
        (DVec2::new(wide, plot.front), DVec2::new(wide, -near * 0.5)),
        (DVec2::new(-wide, -near * 0.5), DVec2::new(-wide, plot.front)),
    ];
    let border: Border = rng.pick(&[pickets, pickets, rails, hedge]);
    for (from, to) in sides {
        border(b, rng, from, to, &ground);
    }
    for _ in 0..4 {
        let side = if rng.chance(0.5) { 1.0 } else { -1.0 };
        let at = DVec2::new(side * rng.range(1.6, wide - 0.6), rng.range(near + 0.8, plot.front - 0.5));
        bush(b, rng, DVec3::new(at.x, ground(at), at.y));
    }
    if rng.chance(0.55) {
        let at = DVec2::new(rng.range(-4.0, 4.0), -near - rng.range(3.0, 5.0));
        tree(b, rng, Habit::Spreading, DVec3::new(at.x, ground(at), at.y), (4.5, 6.5));
    }
    woodpile(b, rng, DVec2::new(plot.kind.width() * 0.5 + 0.5, 0.0), &ground);
}

type Ground<'a> = dyn Fn(DVec2) -> f64 + 'a;
type Border = fn(&mut Builder, &mut Rng, DVec2, DVec2, &Ground<'_>);

/// Stepping stones from the door to the gate.
fn path(b: &mut Builder, from: f64, to: f64, ground: &Ground<'_>) {
    let count = ((to - from + 0.6) / 0.75) as usize;
    for i in 0..count {
        let at = DVec2::new(if i % 2 == 0 { -0.07 } else { 0.07 }, from + 0.9 + 0.75 * i as f64);
        b.pillar(Paint::Quay, at, DVec2::new(0.95, 0.62), ground(at) - 0.3, ground(at) + 0.09);
    }
}

fn pickets(b: &mut Builder, _: &mut Rng, from: DVec2, to: DVec2, ground: &Ground<'_>) {
    let long = (to - from).length();
    let count = (long / 0.27).floor().max(2.0) as usize;
    let along = (to - from) / long;
    let thin = along.abs() * 0.10 + along.perp().abs() * 0.035;
    for i in 0..=count {
        let at = from.lerp(to, i as f64 / count as f64);
        let y = ground(at);
        let post = i % 8 == 0;
        let (size, top) = if post { (DVec2::splat(0.12), 1.08) } else { (thin, 0.92) };
        b.pillar(Paint::White, at, size, y - if post { 0.4 } else { -0.08 }, y + top);
    }
    beams(b, Paint::White, from, to, ground, &[0.3, 0.72], 0.035);
}

fn rails(b: &mut Builder, _: &mut Rng, from: DVec2, to: DVec2, ground: &Ground<'_>) {
    let count = ((to - from).length() / 1.9).ceil().max(1.0) as usize;
    for i in 0..=count {
        let at = from.lerp(to, i as f64 / count as f64);
        b.pillar(Paint::Timber, at, DVec2::splat(0.14), ground(at) - 0.4, ground(at) + 1.1);
    }
    beams(b, Paint::Timber, from, to, ground, &[0.4, 0.7, 1.0], 0.05);
}

/// Horizontal bars that follow the ground.
fn beams(b: &mut Builder, paint: Paint, from: DVec2, to: DVec2, ground: &Ground<'_>, heights: &[f64], radius: f64) {
    let steps = ((to - from).length() / 4.0).ceil().max(1.0) as usize;
    let at = |i: usize, up: f64| {
        let p = from.lerp(to, i as f64 / steps as f64);
        DVec3::new(p.x, ground(p) + up, p.y)
    };
    for (i, &up) in (0..steps).flat_map(|i| heights.iter().map(move |up| (i, up))) {
        b.strut(paint, at(i, up), at(i + 1, up), radius, 4);
    }
}

fn hedge(b: &mut Builder, rng: &mut Rng, from: DVec2, to: DVec2, ground: &Ground<'_>) {
    let long = (to - from).length();
    let count = (long / 0.9).ceil().max(1.0) as usize;
    let along = (to - from) / long;
    for i in 0..count {
        let at = from.lerp(to, (i as f64 + 0.5) / count as f64);
        let size = along.abs() * rng.range(1.0, 1.15) + along.perp().abs() * rng.range(0.55, 0.75);
        let (y, top) = (ground(at), rng.range(0.95, 1.2));
        b.taper(Paint::LeafDeep, at, [(size, y - 0.3), (size * rng.range(0.62, 0.85), y + top)]);
    }
}

fn bush(b: &mut Builder, rng: &mut Rng, foot: DVec3) {
    let paint = rng.pick(&[Paint::LeafGreen, Paint::LeafOlive, Paint::LeafDeep, Paint::LeafRust]);
    let radius = rng.range(0.3, 0.62);
    let profile = [(0.7, -0.4), (1.0, 0.35), (0.8, 0.9), (0.0, 1.2)].map(|(r, y)| (r * radius, foot.y + y * radius));
    b.turned(paint, crate::procedural::solids::Shading::Flat, DVec2::new(foot.x, foot.z), 7, &profile);
}

/// Logs stacked against the wall.
fn woodpile(b: &mut Builder, rng: &mut Rng, at: DVec2, ground: &Ground<'_>) {
    if rng.chance(0.5) {
        return;
    }
    for row in 0..3 {
        for k in 0..6 - row {
            let z = at.y + 0.27 * (f64::from(k) + 0.5 * f64::from(row)) - 0.8;
            let y = ground(at) + 0.12 + 0.23 * f64::from(row);
            b.strut(Paint::Trunk, DVec3::new(at.x - 0.42, y, z), DVec3::new(at.x + 0.45, y, z), 0.13, 6);
        }
    }
}
