//! The ground and all that is level with it: quays, water, road markings, cars, bridges, street furniture.

use glam::{DVec2, DVec3};

use super::layout::{AVENUE_M, Plan, River, Street};
use crate::procedural::foliage::{Habit, tree};
use crate::procedural::palette::Paint;
use crate::procedural::rng::Rng;
use crate::procedural::solids::{Builder, Shading, Turn};

/// Level of the river.
const WATER_M: f64 = -4.2;
/// From the water to where streets end.
const QUAY_M: f64 = 22.0;
/// How deep the ground slab goes.
const DEPTH_M: f64 = -9.0;

/// The ground: one slab, or two banks with the river between them, on a plinth.
pub(crate) fn ground(b: &mut Builder, plan: &Plan) {
    let half = plan.half;
    let corner = |p: DVec2, y: f64| DVec3::new(p.x, y, p.y);
    let plinth = half + DVec2::splat(3.0);
    b.cuboid(Paint::Granite, corner(-plinth, DEPTH_M - 3.0), corner(plinth, DEPTH_M + 0.5));
    let Some(river) = plan.river else {
        b.cuboid(Paint::Asphalt, corner(-half, DEPTH_M), corner(half, 0.0));
        return;
    };
    let wet = half - DVec2::splat(0.4);
    b.cuboid(Paint::Water, corner(-wet, DEPTH_M), corner(wet, WATER_M));
    b.loft(Paint::Asphalt, Shading::Flat, &banks(half, 0.0, |x| (-half.y, river.north_bank(x))));
    b.loft(Paint::Asphalt, Shading::Flat, &banks(half, 0.0, |x| (river.south_bank(x), half.y)));
    for north in [true, false] {
        let edge = |x: f64| if north { river.north_bank(x) } else { river.south_bank(x) };
        // The paving ends within the wall, so that their faces never coincide.
        let (paving, wall) = if north { ((-9.0, 0.3), (-0.1, 0.55)) } else { ((-0.3, 9.0), (-0.55, 0.1)) };
        b.loft(Paint::Paving, Shading::Flat, &banks(half, 0.2, |x| (edge(x) + paving.0, edge(x) + paving.1)));
        b.loft(Paint::Quay, Shading::Flat, &banks(half, 1.15, |x| (edge(x) + wall.0, edge(x) + wall.1)));
    }
}

/// Cross-sections from west to east of a slab between two lines.
fn banks(half: DVec2, top: f64, edges: impl Fn(f64) -> (f64, f64)) -> Vec<Vec<DVec3>> {
    let steps = (half.x / 12.0).ceil() as usize;
    (0..=steps)
        .map(|i| half.x * (2.0 * i as f64 / steps as f64 - 1.0))
        .map(|x| {
            let (north, south) = edges(x);
            [(south, DEPTH_M), (north, DEPTH_M), (north, top), (south, top)].map(|(z, y)| DVec3::new(x, y, z)).to_vec()
        })
        .collect()
}

/// A stretch of street, free of the river: middle line from one point to another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stretch {
    pub(crate) from: DVec2,
    pub(crate) to: DVec2,
    pub(crate) width: f64,
}

impl Stretch {
    fn length(&self) -> f64 {
        (self.to - self.from).length()
    }
}

/// The pieces of a street between crossings with `others`, and between quays.
pub(crate) fn stretches(plan: &Plan, street: &Street, others: &[Street], along_z: bool) -> Vec<Stretch> {
    let reach = if along_z { plan.half.y } else { plan.half.x };
    let mut cuts: Vec<_> = others.iter().map(|o| (o.middle - o.width * 0.5, o.middle + o.width * 0.5)).collect();
    if let (Some(river), true) = (plan.river, along_z) {
        cuts.push((river.north_bank(street.middle) - QUAY_M, river.south_bank(street.middle) + QUAY_M));
    }
    cuts.push((reach, reach));
    cuts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let at = |along: f64| if along_z { DVec2::new(street.middle, along) } else { DVec2::new(along, street.middle) };
    let mut from = -reach;
    let mut out = Vec::new();
    for (lo, hi) in cuts {
        let stretch = Stretch { from: at(from), to: at(lo), width: street.width };
        if lo - from > 20.0 && (0..=4).all(|i| dry(plan, stretch.from.lerp(stretch.to, f64::from(i) * 0.25))) {
            out.push(stretch);
        }
        from = hi.max(from);
    }
    out
}

fn dry(plan: &Plan, at: DVec2) -> bool {
    plan.river.is_none_or(|r| at.y < r.north_bank(at.x) - 14.0 || at.y > r.south_bank(at.x) + 14.0)
}

/// Lane lines, zebra crossings and traffic on a stretch. It is laid along -z from the frame's origin.
pub(crate) fn traffic(b: &mut Builder, rng: &mut Rng, stretch: &Stretch) {
    let way = (stretch.to - stretch.from) / stretch.length();
    let turn = if way.x.abs() > 0.5 { Turn::quarters(1) } else { Turn::NONE };
    let middle = (stretch.from + stretch.to) * 0.5;
    let long = stretch.length();
    let avenue = stretch.width > 20.0;
    b.within(DVec3::new(middle.x, 0.0, middle.y), turn, |b| {
        markings(b, stretch.width, long, avenue);
        let lanes: &[f64] = if avenue { &[-7.4, -3.9, 3.9, 7.4] } else { &[-1.9, 1.9] };
        let mut lanes: Vec<_> = lanes.iter().map(|&x| (x, 44.0)).collect();
        let kerb = stretch.width * 0.5 - 1.2;
        lanes.extend([(-kerb, 28.0), (kerb, 28.0)]);
        for (x, gap) in lanes {
            let mut z = -long * 0.5 + rng.range(5.0, 5.0 + gap);
            while z < long * 0.5 - 5.0 {
                b.within(DVec3::new(x, 0.0, z), Turn::NONE, |b| car(b, rng));
                z += rng.range(6.0, 3.0 * gap);
            }
        }
    });
}

fn markings(b: &mut Builder, width: f64, long: f64, avenue: bool) {
    let line =
        |b: &mut Builder, x: f64, z: f64, size: DVec2| b.pillar(Paint::Marking, DVec2::new(x, z), size, -0.1, 0.03);
    let dashes = (long / 18.0) as usize;
    let lines: &[f64] = if avenue { &[-5.65, 5.65] } else { &[0.0] };
    for (i, &x) in (0..dashes).flat_map(|i| lines.iter().map(move |x| (i, x))) {
        line(b, x, long * ((i as f64 + 0.5) / dashes as f64 - 0.5), DVec2::new(0.22, 3.6));
    }
    if avenue {
        line(b, -0.25, 0.0, DVec2::new(0.18, long - 9.0));
        line(b, 0.25, 0.0, DVec2::new(0.18, long - 9.0));
    } else {
        return;
    }
    let stripes = ((width - 1.2) / 1.5) as usize;
    for (i, end) in (0..stripes).flat_map(|i| [(i, -1.0), (i, 1.0)]) {
        let x = (width - 1.2) * ((i as f64 + 0.5) / stripes as f64 - 0.5);
        line(b, x, end * (long * 0.5 - 2.2), DVec2::new(0.65, 3.2));
    }
}

fn car(b: &mut Builder, rng: &mut Rng) {
    let paint = rng.pick(&[
        Paint::CarRed,
        Paint::CarBlue,
        Paint::CarWhite,
        Paint::CarWhite,
        Paint::CarYellow,
        Paint::Steel,
        Paint::GlassDark,
        Paint::GlassDark,
    ]);
    if rng.chance(0.06) {
        b.pillar(Paint::Asphalt, DVec2::ZERO, DVec2::new(2.3, 9.5), 0.1, 0.6);
        b.pillar(paint, DVec2::ZERO, DVec2::new(2.5, 11.0), 0.4, 3.1);
        b.pillar(Paint::GlassDark, DVec2::ZERO, DVec2::new(2.56, 10.2), 1.5, 2.5);
        return;
    }
    b.pillar(Paint::Asphalt, DVec2::ZERO, DVec2::new(1.7, 3.6), 0.06, 0.5);
    b.pillar(paint, DVec2::ZERO, DVec2::new(1.85, 4.4), 0.32, 0.9);
    b.taper(Paint::GlassDark, DVec2::new(0.0, -0.2), [(DVec2::new(1.7, 2.7), 0.85), (DVec2::new(1.4, 1.7), 1.4)]);
    b.pillar(paint, DVec2::new(0.0, -0.2), DVec2::new(1.36, 1.62), 1.3, 1.44);
}

/// A street lamp; its arm reaches along +x.
pub(crate) fn lamp(b: &mut Builder, at: DVec2, towards: f64) {
    b.pillar(Paint::GlassDark, at, DVec2::splat(0.2), -0.2, 7.6);
    b.pillar(Paint::GlassDark, at + DVec2::X * towards, DVec2::new(2.2, 0.14), 7.5, 7.62);
    b.pillar(Paint::White, at + DVec2::X * towards * 1.8, DVec2::new(0.9, 0.3), 7.4, 7.54);
}

/// Trees and lamps along both quays.
pub(crate) fn promenade(b: &mut Builder, rng: &mut Rng, plan: &Plan, river: &River) {
    let steps = (plan.half.x / 5.5) as usize;
    for i in 1..steps {
        let x = plan.half.x * (2.0 * i as f64 / steps as f64 - 1.0);
        let clear = plan.meridians.iter().all(|s| (x - s.middle).abs() > s.width * 0.5 + 3.0);
        if !clear {
            continue;
        }
        for z in [river.north_bank(x) - 4.5, river.south_bank(x) + 4.5] {
            let at = DVec2::new(x, z);
            if i % 3 == 0 { lamp(b, at, 1.0) } else { tree(b, rng, Habit::Round, DVec3::new(x, 0.0, z), (6.5, 9.0)) }
        }
    }
}

/// The main avenue's bridge: two pylons and their cables over a long deck along z.
pub(crate) fn cable_bridge(b: &mut Builder, x: f64, span: (f64, f64)) {
    b.within(DVec3::X * x, Turn::NONE, |b| pylons(b, span));
}

fn pylons(b: &mut Builder, span: (f64, f64)) {
    let (middle, half) = ((span.0 + span.1) * 0.5, (span.1 - span.0) * 0.5);
    let wide = AVENUE_M * 0.5;
    deck(b, middle, half, AVENUE_M - 1.0, 1.6);
    for end in [-1.0, 1.0] {
        let z = middle + end * half * 0.5;
        for side in [-1.0, 1.0] {
            let head = DVec3::new(side * 3.0, 62.0, z);
            b.strut(Paint::Concrete, DVec3::new(side * (wide + 3.0), DEPTH_M, z), head, 1.7, 6);
            cables(b, DVec3::new(side * 3.2, 60.0, z), side * (wide - 0.2), half * 0.46);
        }
        b.pillar(Paint::Concrete, DVec2::new(0.0, z), DVec2::new(2.0 * wide + 6.0, 3.4), -3.4, -0.9);
        b.pillar(Paint::Concrete, DVec2::new(0.0, z), DVec2::new(8.0, 3.0), 44.0, 63.0);
        b.cone(Paint::Quay, DVec2::new(0.0, z), 16, [(wide + 8.0, DEPTH_M), (wide + 6.5, WATER_M + 1.4)]);
    }
}

fn cables(b: &mut Builder, head: DVec3, x: f64, reach: f64) {
    for (i, way) in (1..=8).flat_map(|i| [(i, -1.0), (i, 1.0)]) {
        let t = f64::from(i) / 8.0;
        let from = head - DVec3::Y * (1.0 - t) * 22.0;
        b.strut(Paint::White, from, DVec3::new(x, 0.9, head.z + way * reach * t), 0.16, 4);
    }
}

/// A roadway with raised sides, cambered over the water.
fn deck(b: &mut Builder, middle: f64, half: f64, width: f64, rise: f64) {
    let strip = |b: &mut Builder, paint: Paint, x: (f64, f64), low: f64, high: f64| {
        let rings: Vec<Vec<DVec3>> = (0..=16)
            .map(|i| f64::from(i) / 8.0 - 1.0)
            .map(|t| {
                let (y, z) = (rise * (1.0 - t * t), middle + t * half);
                [(x.0, low), (x.1, low), (x.1, high), (x.0, high)].map(|(x, dy)| DVec3::new(x, y + dy, z)).to_vec()
            })
            .collect();
        b.loft(paint, Shading::Flat, &rings);
    };
    let edge = width * 0.5;
    strip(b, Paint::Asphalt, (-edge, edge), -1.7, 0.06);
    for side in [-1.0, 1.0] {
        let span = |a: f64, c: f64| if side < 0.0 { (-c, -a) } else { (a, c) };
        strip(b, Paint::Paving, span(edge - 2.6, edge + 0.4), -1.2, 0.26);
        strip(b, Paint::Limestone, span(edge + 0.1, edge + 0.6), -1.5, 1.3);
    }
}

/// A stone bridge on arches, along z.
pub(crate) fn arch_bridge(b: &mut Builder, x: f64, span: (f64, f64), width: f64) {
    let (middle, half) = ((span.0 + span.1) * 0.5, (span.1 - span.0) * 0.5);
    b.within(DVec3::X * x, Turn::NONE, |b| {
        deck(b, middle, half, width, 1.1);
        let arches = 4;
        for i in 0..=arches {
            let z = middle + (f64::from(i) / f64::from(arches) - 0.5) * 2.0 * half * 0.86;
            b.pillar(Paint::Limestone, DVec2::new(0.0, z), DVec2::new(width + 1.6, 4.2), DEPTH_M, -0.4);
            for side in [-1.0, 1.0] {
                let nose = DVec2::new(side * (width * 0.5 + 1.0), z);
                b.cone(Paint::Limestone, nose, 6, [(2.3, DEPTH_M), (2.1, 0.4)]);
                b.cone(Paint::Limestone, nose, 6, [(2.3, 0.3), (0.0, 2.1)]);
            }
            if i < arches {
                spandrel(b, width, z, 2.0 * half * 0.86 / f64::from(arches));
            }
        }
    });
}

/// The stone over one arch: wedges that hang from the deck and leave a round opening.
fn spandrel(b: &mut Builder, width: f64, z: f64, pitch: f64) {
    let steps = 10;
    let (bottom, top) = (WATER_M - 0.5, -0.5);
    let soffit = |t: f64| bottom + (top - 0.6 - bottom) * (1.0 - (2.0 * t - 1.0) * (2.0 * t - 1.0)).max(0.0).sqrt();
    let rings: Vec<Vec<DVec3>> = (0..=steps)
        .map(|i| f64::from(i) / f64::from(steps))
        .map(|t| {
            let edge = width * 0.5 + 0.45;
            [(-edge, soffit(t)), (edge, soffit(t)), (edge, top), (-edge, top)]
                .map(|(x, y)| DVec3::new(x, y, z + pitch * t))
                .to_vec()
        })
        .collect();
    b.loft(Paint::Limestone, Shading::Flat, &rings);
}
