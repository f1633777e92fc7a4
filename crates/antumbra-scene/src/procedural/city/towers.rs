//! Downtown: towers of several decades.

use glam::{DVec2, DVec3};

use super::facade::Facade;
use super::roofs;
use crate::procedural::palette::Paint;
use crate::procedural::rng::Rng;
use crate::procedural::solids::{Builder, Shading, Turn, circle, octagon, rectangle};

/// A tower on a lot of that size, about `height` tall.
pub(crate) fn tower(b: &mut Builder, rng: &mut Rng, size: DVec2, height: f64) {
    let slender = size.min_element() < 0.62 * size.max_element();
    match rng.index(12) {
        0..=2 => deco(b, rng, size, height),
        3 if !slender => round(b, rng, size, height),
        4 if !slender && height > 70.0 => twisted(b, rng, size, height),
        5 if !slender && height > 60.0 => tapered(b, rng, size, height),
        6 if height > 60.0 => wedge(b, rng, size, height),
        7 | 8 => masonry(b, rng, size, height),
        _ => office(b, rng, size, height),
    }
}

/// A base of columns around a recessed lobby.
fn arcade(b: &mut Builder, paint: Paint, size: DVec2, height: f64) {
    b.pillar(Paint::GlassGrey, DVec2::ZERO, size - DVec2::splat(7.0), -0.6, height);
    b.pillar(paint, DVec2::ZERO, size + DVec2::splat(0.7), height - 0.9, height + 0.5);
    for axis in 0..2 {
        let spaces = (size[axis] / 5.2).round().max(2.0) as usize;
        for (i, side) in (0..=spaces).flat_map(|i| [(i, -1.0), (i, 1.0)]) {
            let mut at = DVec2::ZERO;
            at[axis] = (size[axis] - 1.2) * (i as f64 / spaces as f64 - 0.5);
            at[1 - axis] = side * (size[1 - axis] - 1.2) * 0.5;
            let corner = i == 0 || i == spaces;
            if !(corner && axis == 1) {
                b.cone(paint, at, 8, [(0.48, -0.5), (0.42, height)]);
            }
        }
    }
}

/// A podium, a shaft of one to three setbacks, and plant on top.
fn office(b: &mut Builder, rng: &mut Rng, size: DVec2, height: f64) {
    let facade = if rng.chance(0.7) { Facade::curtain(rng) } else { Facade::ribbon(rng) };
    let podium = rng.range(8.0, 14.0);
    let mut shaft = size * rng.range(0.78, 0.94);
    if rng.chance(0.5) {
        arcade(b, facade.wall, shaft, podium * 0.6);
        facade.clad(b, shaft, podium * 0.6, height * 0.6);
    } else {
        Facade { bay: 6.0, ..facade }.clad(b, size, 0.2, podium);
        roofs::flat(b, rng, size, podium);
        facade.clad(b, shaft, podium, height * 0.6);
    }
    let mut y = height * 0.6;
    for share in [0.85, 1.0] {
        shaft *= if rng.chance(0.6) { rng.range(0.78, 0.94) } else { 0.985 };
        facade.clad(b, shaft, y, height * share);
        y = height * share;
    }
    crown(b, rng, &facade, shaft, y);
}

fn crown(b: &mut Builder, rng: &mut Rng, facade: &Facade, size: DVec2, y: f64) {
    roofs::flat(b, rng, size, y);
    let house = size * rng.range(0.4, 0.6);
    let top = y + rng.range(3.5, 7.0);
    b.pillar(facade.wall, DVec2::ZERO, house, y - 0.3, top);
    if rng.chance(0.6) {
        let bars = 5;
        for i in 0..bars {
            let level = y + 0.8 + (top - y) * f64::from(i) / f64::from(bars);
            b.pillar(Paint::Steel, DVec2::ZERO, house + DVec2::splat(0.5), level, level + 0.35);
        }
    }
    if rng.chance(0.45) {
        roofs::mast(b, house * DVec2::new(0.2, -0.2), top, rng.range(12.0, 26.0));
    }
}

/// Setbacks of stone with strong piers, and a crown in copper or stone.
pub(crate) fn deco(b: &mut Builder, rng: &mut Rng, size: DVec2, height: f64) {
    let facade = Facade::vertical(rng);
    let mut plan = size * 0.97;
    let mut y = 0.2;
    let steps = if height > 90.0 { [0.22, 0.52, 0.74, 0.90, 1.0] } else { [0.30, 0.62, 0.84, 0.94, 1.0] };
    for (i, share) in steps.into_iter().enumerate() {
        let top = (height * (share + rng.range(-0.03, 0.03))).max(y + 4.0);
        facade.clad(b, plan, y, top);
        if i % 2 == 0 {
            notches(b, &facade, plan, y, top);
        }
        y = top;
        plan *= rng.range(0.74, 0.87);
    }
    deco_crown(b, rng, facade.wall, plan, y);
}

/// Lower wings that step out of the middle of each side.
fn notches(b: &mut Builder, facade: &Facade, plan: DVec2, y0: f64, y1: f64) {
    let top = y0 + (y1 - y0) * 0.82;
    facade.clad(b, DVec2::new(plan.x * 0.5, plan.y + 1.9), y0, top);
    facade.clad(b, DVec2::new(plan.x + 1.9, plan.y * 0.5), y0, top - 1.7);
}

fn deco_crown(b: &mut Builder, rng: &mut Rng, wall: Paint, plan: DVec2, y: f64) {
    let side = plan.min_element();
    let metal = rng.pick(&[Paint::Copper, Paint::Copper, Paint::Slate, Paint::Bronze]);
    let rise = side * rng.range(0.9, 1.6);
    b.pillar(wall, DVec2::ZERO, plan * 0.86, y - 0.5, y + 3.4);
    match rng.index(3) {
        0 => b.taper(metal, DVec2::ZERO, [(plan * 0.92, y + 3.2), (plan * 0.06, y + 3.2 + rise)]),
        1 => {
            for i in 0..4 {
                let share = 0.8 - 0.19 * f64::from(i);
                let level = y + 3.0 + rise * 0.22 * f64::from(i);
                let top = level + rise * 0.22 + 0.3;
                b.loft(wall, Shading::Flat, &[level, top].map(|h| octagon(DVec2::ZERO, plan * share, side * 0.12, h)));
            }
        }
        _ => {
            b.cone(wall, DVec2::ZERO, 16, [(side * 0.4, y + 3.0), (side * 0.4, y + 6.0)]);
            b.dome(metal, DVec2::ZERO, 16, y + 5.9, DVec2::new(side * 0.42, rise * 0.5));
        }
    }
    b.cone(Paint::White, DVec2::ZERO, 6, [(0.5, y + 2.0), (0.12, y + 3.0 + rise * 1.7)]);
}

/// Masonry blocks of the early high-rises: base, shaft and a projecting top.
pub(crate) fn masonry(b: &mut Builder, rng: &mut Rng, size: DVec2, height: f64) {
    let facade = Facade::masonry(rng);
    let base = 9.0_f64.min(height * 0.4);
    let stone = Facade { wall: Paint::Limestone, bay: facade.bay * 1.5, storey: base * 0.5, ..facade };
    stone.clad(b, size, 0.2, base);
    let shaft = size - DVec2::splat(0.9);
    let set_back = height > 40.0 && rng.chance(0.65);
    let shoulder = if set_back { height * rng.range(0.55, 0.8) } else { height };
    facade.clad(b, shaft, base, shoulder);
    let mut top = shaft;
    if set_back {
        top = shaft * rng.range(0.62, 0.8);
        facade.clad(b, top, shoulder, height);
        b.pillar(Paint::Ballast, DVec2::ZERO, shaft, shoulder - 0.3, shoulder + 0.12);
    }
    roofs::flat(b, rng, top, height);
    if rng.chance(0.4) {
        let at = top * DVec2::new(rng.range(-0.3, 0.3), rng.range(-0.3, 0.3));
        roofs::water_tank(b, at, height, rng.range(1.5, 2.2));
    }
}

/// A drum of glass with a plate at each floor.
fn round(b: &mut Builder, rng: &mut Rng, size: DVec2, height: f64) {
    const SIDES: usize = 32;
    let radius = size.min_element() * 0.46;
    let (glass, wall) = (rng.pick(&[Paint::GlassBlue, Paint::GlassGreen]), rng.pick(&[Paint::White, Paint::Steel]));
    b.pillar(Paint::Granite, DVec2::ZERO, size * 0.98, -0.6, 5.0);
    b.cone(glass, DVec2::ZERO, SIDES, [(radius, 4.0), (radius, height)]);
    plates(b, wall, 5.0, height, |y| circle(DVec2::ZERO, y, radius + 0.7, SIDES));
    for i in 0..16 {
        let turn = Turn::radians(core::f64::consts::TAU * f64::from(i) / 16.0);
        b.within(DVec3::ZERO, turn, |b| {
            b.pillar(wall, DVec2::new(radius, 0.0), DVec2::new(1.1, 0.5), 4.0, height + 1.5);
        });
    }
    b.cone(wall, DVec2::ZERO, SIDES, [(radius * 0.6, height - 0.3), (radius * 0.6, height + 4.5)]);
    if rng.chance(0.5) {
        b.dome(glass, DVec2::ZERO, 20, height + 4.4, DVec2::new(radius * 0.56, radius * 0.35));
    } else {
        roofs::mast(b, DVec2::ZERO, height + 4.5, 22.0);
    }
}

/// A thin plate at every floor; `outline` gives its edge at a height.
fn plates(b: &mut Builder, paint: Paint, y0: f64, y1: f64, outline: impl Fn(f64) -> Vec<DVec3>) {
    let floors = ((y1 - y0) / 4.0).round().max(1.0) as usize;
    for i in 0..=floors {
        let y = y0 + (y1 - y0) * i as f64 / floors as f64;
        let lifted = |dy: f64| -> Vec<DVec3> { outline(y).iter().map(|p| p + DVec3::Y * dy).collect() };
        b.loft(paint, Shading::Flat, &[lifted(-0.3), lifted(0.45)]);
    }
}

/// Each floor turned a little against the one below.
pub(crate) fn twisted(b: &mut Builder, rng: &mut Rng, size: DVec2, height: f64) {
    let side = size.min_element() * 0.72;
    let whole_turn = rng.range(1.2, 2.1);
    let outline = |y: f64, side: f64| -> Vec<DVec3> {
        let turn = Turn::radians(whole_turn * y / height);
        let shrink = 1.0 - 0.22 * y / height;
        octagon(DVec2::ZERO, DVec2::splat(side * shrink), side * 0.12, y).iter().map(|&p| turn.apply(p)).collect()
    };
    b.pillar(Paint::Granite, DVec2::ZERO, size * 0.96, -0.6, 5.5);
    let levels = (height / 4.0) as usize;
    let core: Vec<_> = (0..=levels).map(|i| outline(5.0 + (height - 5.0) * i as f64 / levels as f64, side)).collect();
    b.loft(rng.pick(&[Paint::GlassBlue, Paint::GlassGreen]), Shading::Flat, &core);
    plates(b, Paint::White, 5.5, height, |y| outline(y, side + 1.6));
    roofs::mast(b, DVec2::ZERO, height, 18.0);
}

/// Four walls that lean inward, braced by diagonals.
fn tapered(b: &mut Builder, rng: &mut Rng, size: DVec2, height: f64) {
    let (low, high) = (size * 0.92, size * 0.52);
    let (glass, wall) = (rng.pick(&[Paint::GlassDark, Paint::GlassGrey]), rng.pick(&[Paint::Bronze, Paint::Steel]));
    let at = |y: f64| low + (high - low) * (y / height).max(0.0);
    b.taper(glass, DVec2::ZERO, [(at(0.0), -0.6), (high, height)]);
    plates(b, wall, 0.5, height, |y| rectangle(DVec2::ZERO, at(y) + DVec2::splat(0.5), y));
    let panels = (height / size.max_element()).round().max(1.0) as usize;
    for i in 0..panels {
        let ends = [i, i + 1].map(|k| (height - 1.0) * k as f64 / panels as f64 + 0.5);
        braces(b, wall, ends, |y| at(y) * 0.5 + DVec2::splat(0.2));
    }
    b.pillar(wall, DVec2::ZERO, high * 0.7, height - 0.3, height + 5.0);
    for side in [-0.25, 0.25] {
        roofs::mast(b, DVec2::new(high.x * side, 0.0), height + 5.0, height * 0.2);
    }
}

fn braces(b: &mut Builder, paint: Paint, [y0, y1]: [f64; 2], half: impl Fn(f64) -> DVec2) {
    let corner = |y: f64, sx: f64, sz: f64| DVec3::new(half(y).x * sx, y, half(y).y * sz);
    for (a, c) in
        [((-1.0, 1.0), (1.0, 1.0)), ((1.0, 1.0), (1.0, -1.0)), ((1.0, -1.0), (-1.0, -1.0)), ((-1.0, -1.0), (-1.0, 1.0))]
    {
        b.strut(paint, corner(y0, a.0, a.1), corner(y1, c.0, c.1), 0.55, 4);
        b.strut(paint, corner(y0, c.0, c.1), corner(y1, a.0, a.1), 0.55, 4);
    }
}

/// A shaft on stilts with a slanted top.
fn wedge(b: &mut Builder, rng: &mut Rng, size: DVec2, height: f64) {
    let facade = Facade { bay: 3.0, ..Facade::ribbon(rng) };
    let shaft = size * 0.82;
    let (base, eaves) = (14.0, height - shaft.x * 0.5);
    arcade(b, facade.wall, shaft, base);
    facade.clad(b, shaft, base, eaves);
    let top = shaft - DVec2::splat(0.2);
    let slanted: Vec<_> = rectangle(DVec2::ZERO, top, 0.0)
        .iter()
        .map(|p| DVec3::new(p.x, eaves + 1.5 + (p.x / top.x + 0.5) * top.x * 0.72, p.z))
        .collect();
    b.loft(facade.wall, Shading::Flat, &[rectangle(DVec2::ZERO, top, eaves - 0.2), slanted]);
}

/// The tallest: a deco shaft of many setbacks under a lantern and a long spire.
pub(crate) fn spire(b: &mut Builder, size: DVec2, height: f64) {
    let facade = Facade {
        glass: Paint::GlassDark,
        wall: Paint::Limestone,
        bay: 3.0,
        pier: DVec2::new(1.25, 0.9),
        storey: 3.9,
        band: DVec2::new(1.3, 0.25),
    };
    let tiers = [(1.0, 0.09), (0.82, 0.20), (0.68, 0.44), (0.60, 0.70), (0.52, 0.78), (0.42, 0.83), (0.33, 0.87)];
    let mut y = 0.2;
    for (share, top) in tiers {
        let plan = size * share;
        facade.clad(b, plan, y, top * height);
        notches(b, &facade, plan, y, top * height);
        y = top * height;
    }
    let radius = size.min_element() * 0.13;
    for i in 0..8 {
        b.within(DVec3::ZERO, Turn::radians(core::f64::consts::TAU * f64::from(i) / 8.0), |b| {
            b.taper(
                Paint::Limestone,
                DVec2::new(radius, 0.0),
                [(DVec2::new(radius, 1.2), y - 0.5), (DVec2::new(0.6, 0.8), y + radius * 2.6)],
            );
        });
    }
    b.cone(Paint::GlassGrey, DVec2::ZERO, 16, [(radius, y - 0.5), (radius * 0.9, y + radius * 2.2)]);
    let lantern = y + radius * 2.2;
    b.dome(Paint::Copper, DVec2::ZERO, 16, lantern - 0.2, DVec2::new(radius * 1.05, radius * 1.3));
    b.cone(Paint::White, DVec2::ZERO, 8, [(1.1, lantern), (0.15, height * 1.06)]);
}

/// A bulging drum that narrows to a tip.
pub(crate) fn gherkin(b: &mut Builder, size: DVec2, height: f64) {
    const SIDES: usize = 28;
    let radius = size.min_element() * 0.46;
    let girth = |y: f64| {
        let t = (y / height).clamp(0.0, 1.0);
        let bulge = 1.0 - (t - 0.36) * (t - 0.36) * 1.1;
        radius * bulge * (1.0 - t * t * t * t * t).max(0.0).sqrt()
    };
    let rings = 30;
    let profile: Vec<_> = (0..=rings)
        .map(|i| height * f64::from(i) / f64::from(rings))
        .map(|y| (if y >= height { 0.0 } else { girth(y) }, y - 0.6))
        .collect();
    b.turned(Paint::GlassBlue, Shading::Smooth, DVec2::ZERO, SIDES, &profile);
    plates(b, Paint::Steel, 4.0, height * 0.93, |y| circle(DVec2::ZERO, y, girth(y) + 0.35, SIDES));
    for i in 0..SIDES {
        for lean in [-1.0, 1.0] {
            spiral(b, i as f64 / SIDES as f64, lean, height, &girth);
        }
    }
}

/// A rib that winds up the drum.
fn spiral(b: &mut Builder, start: f64, lean: f64, height: f64, girth: &impl Fn(f64) -> f64) {
    let steps = 8;
    let at = |i: i32| {
        let y = height * 0.92 * f64::from(i) / f64::from(steps);
        let angle = core::f64::consts::TAU * (start + lean * 0.18 * y / height);
        let r = girth(y) + 0.3;
        DVec3::new(r * libm::cos(angle), y, r * libm::sin(angle))
    };
    for i in 0..steps {
        b.strut(Paint::Steel, at(i), at(i + 1), 0.22, 4);
    }
}

/// Two shafts joined by bridges.
pub(crate) fn twins(b: &mut Builder, rng: &mut Rng, size: DVec2, height: f64) {
    let facade = Facade::curtain(rng);
    let along_x = size.x > size.y;
    let axis = if along_x { DVec2::X } else { DVec2::Y };
    let long = size.max_element();
    let plan = DVec2::splat(size.min_element() * 0.7).min(DVec2::splat(long * 0.36));
    Facade { bay: 6.0, ..facade }.clad(b, size * 0.97, 0.2, 9.0);
    roofs::flat(b, rng, size * 0.97, 9.0);
    for side in [-0.3, 0.3] {
        let at = axis * long * side;
        b.within(DVec3::new(at.x, 0.0, at.y), Turn::NONE, |b| {
            facade.clad(b, plan, 9.0, height * 0.82);
            facade.clad(b, plan * 0.8, height * 0.82, height);
            b.taper(facade.glass, DVec2::ZERO, [(plan * 0.7, height - 0.3), (plan * 0.1, height + plan.x * 0.7)]);
            roofs::mast(b, DVec2::ZERO, height + plan.x * 0.6, 14.0);
        });
    }
    let bridge = axis * long * 0.6 + (DVec2::ONE - axis) * 5.0;
    for level in [0.36, 0.62] {
        Facade { bay: 2.5, ..facade }.clad(b, bridge, height * level, height * level + 7.0);
    }
}
