//! What a wine cellar holds: barrels on racks, bottles in bins, on shelves and on the floor, crates.

use core::f64::consts::TAU;

use glam::{DAffine3, DMat3, DVec2, DVec3};

use super::Palace;
use super::looks::Look;
use super::plan::{ANTEROOM, BAY, FLOOR, HALL, STRONGROOM};
use crate::procedural::props;
use crate::procedural::rng::Rng;
use crate::procedural::shapes::{Detail, smooth_profile};
use crate::procedural::solids::{Builder, Shading, Turn};

/// The meshes that the cellar's things share.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stock {
    pub barrel: usize,
    pub bottles: [usize; 2],
    pub crate_: usize,
}

impl Stock {
    pub fn new(palace: &mut Palace) -> Self {
        Self {
            barrel: palace.mesh("barrel", barrel),
            bottles: [
                palace.mesh("claret bottle", |b, detail| bottle(b, detail, Look::BottleGreen, &CLARET)),
                palace.mesh("hock bottle", |b, detail| bottle(b, detail, Look::BottleAmber, &HOCK)),
            ],
            crate_: palace.mesh("crate", |b, _| props::open_crate(b, [Look::Oak.into(), Look::DarkOak.into()])),
        }
    }
}

/// Fills the hall.
pub(super) fn build(palace: &mut Palace, stock: Stock) {
    barrel_rows(palace, stock);
    bins(palace, stock);
    floor_things(palace, stock);
}

/// Lies on its side along z: up becomes ahead (+z).
pub(super) fn lying(at: DVec3, turn: Turn) -> DAffine3 {
    let axes = [DVec3::X, DVec3::Z, DVec3::NEG_Y].map(|axis| turn.apply(axis));
    DAffine3 { matrix3: DMat3::from_cols(axes[0], axes[1], axes[2]), translation: at }
}

/// A barrel with a tap in the lower part of one head, for when it lies.
fn barrel(b: &mut Builder, detail: Detail) {
    props::barrel(b, detail, [Look::Oak.into(), Look::Iron.into()]);
    b.strut(Look::DarkOak, DVec3::new(0.0, 0.98, 0.2), DVec3::new(0.0, 1.12, 0.2), 0.018, detail.sides(8.0));
    b.strut(Look::DarkOak, DVec3::new(0.0, 1.08, 0.15), DVec3::new(0.0, 1.08, 0.26), 0.012, detail.sides(8.0));
}

const CLARET: [(f64, f64); 9] = [
    (0.03, 0.004),
    (0.0375, 0.06),
    (0.0365, 0.185),
    (0.027, 0.212),
    (0.0165, 0.232),
    (0.0145, 0.262),
    (0.0140, 0.285),
    (0.0165, 0.292),
    (0.0140, 0.300),
];

const HOCK: [(f64, f64); 9] = [
    (0.031, 0.004),
    (0.038, 0.012),
    (0.0385, 0.07),
    (0.037, 0.13),
    (0.030, 0.19),
    (0.019, 0.25),
    (0.0145, 0.30),
    (0.0165, 0.315),
    (0.0140, 0.33),
];

/// An upright bottle with a label and a sealed neck.
fn bottle(b: &mut Builder, detail: Detail, glass: Look, knots: &[(f64, f64)]) {
    let sides = detail.sides(8.0);
    b.turned(glass, Shading::Smooth, DVec2::ZERO, sides, &smooth_profile(knots, detail.steps(8.0)));
    b.cone(Look::Parchment, DVec2::ZERO, sides, [(0.0392, 0.055), (0.0392, 0.125)]);
    let top = knots[knots.len() - 1].1;
    b.cone(Look::Wax, DVec2::ZERO, sides, [(0.0172, top - 0.05), (0.0172, top + 0.004)]);
}

/// Barrels on trestles along the north wall, two high, one row of big ones before the grille's wall.
fn barrel_rows(palace: &mut Palace, stock: Stock) {
    let trestle = palace.mesh("trestle", |b, _| trestle(b));
    let mut rng = palace.rng.fork(21);
    for bay in 0..5 {
        let x = BAY * (f64::from(bay) - 2.0);
        rack(palace, &mut rng, stock, trestle, DVec3::new(x, FLOOR, -HALL.y + 0.85), Turn::NONE);
        if bay != 2 && bay != 0 {
            rack(palace, &mut rng, stock, trestle, DVec3::new(x, FLOOR, HALL.y - 0.85), Turn::quarters(2));
        }
    }
}

/// Three barrels on a trestle and two in the hollows between them, their taps along +z.
fn rack(palace: &mut Palace, rng: &mut Rng, stock: Stock, trestle: usize, at: DVec3, turn: Turn) {
    palace.place("trestle", trestle, at, turn);
    let places = [(-0.82, 0.62), (0.0, 0.62), (0.82, 0.62), (-0.41, 1.29), (0.41, 1.29)];
    for (i, (x, y)) in places.into_iter().enumerate() {
        if i > 2 && rng.chance(0.3) {
            continue;
        }
        let offset = DVec3::new(x + rng.range(-0.012, 0.012), y, -0.5 + rng.range(-0.03, 0.03));
        palace.place_as("barrel", stock.barrel, lying(at + turn.apply(offset), turn));
    }
}

/// Two beams with chocks, on short legs: carries barrels whose axes are 0.62 m up.
fn trestle(b: &mut Builder) {
    for z in [-0.3, 0.3] {
        b.cuboid(Look::DarkOak, DVec3::new(-1.25, 0.13, z - 0.06), DVec3::new(1.25, 0.26, z + 0.06));
        for x in [-1.05, 0.0, 1.05] {
            b.pillar(Look::DarkOak, DVec2::new(x, z), DVec2::new(0.14, 0.16), -0.01, 0.14);
        }
        for x in [-1.15, -0.41, 0.41, 1.15] {
            b.taper(Look::DarkOak, DVec2::new(x, z), [(DVec2::new(0.24, 0.1), 0.25), (DVec2::new(0.05, 0.1), 0.4)]);
        }
    }
}

/// Shelves with bottles lying in them: at the hall's ends, in the anteroom and in the strongroom.
fn bins(palace: &mut Palace, stock: Stock) {
    let bin = palace.mesh("bottle rack", |b, _| bottle_rack(b));
    let mut rng = palace.rng.fork(22);
    let [[_, x1], [_, z1]] = ANTEROOM;
    for (at, turn) in [
        (DVec3::new(-HALL.x + 0.25, FLOOR, 1.35), Turn::quarters(1)),
        (DVec3::new(HALL.x - 0.25, FLOOR, -1.45), Turn::quarters(3)),
        (DVec3::new(x1 - 0.9, FLOOR, z1 - 0.25), Turn::quarters(2)),
        // They leave a strip of the strongroom's wall bare, which is what lights the grille.
        (DVec3::new(-1.5, FLOOR, STRONGROOM[1][1] - 0.25), Turn::quarters(2)),
        (DVec3::new(1.5, FLOOR, STRONGROOM[1][1] - 0.25), Turn::quarters(2)),
    ] {
        palace.place("bottle rack", bin, at, turn);
        for (i, k) in (0..5).flat_map(|i| (0..9).map(move |k| (i, k))) {
            if !rng.chance(palace.detail.share(0.45)) {
                continue;
            }
            let offset = DVec3::new(0.14 * (f64::from(k) - 4.0), 0.164 + 0.36 * f64::from(i), -0.12);
            let spin = Turn::radians(rng.range(-0.06, 0.06));
            palace.place_as("bottle", rng.pick(&stock.bottles), lying(at + turn.apply(offset), turn.then(spin)));
        }
    }
}

/// Uprights and shelves 1.4 m wide and 2 m high with its back at z = -0.25; shelves carry a strip that holds the necks.
fn bottle_rack(b: &mut Builder) {
    for x in [-0.7, 0.0, 0.7] {
        b.cuboid(Look::DarkOak, DVec3::new(x - 0.02, -0.01, -0.24), DVec3::new(x + 0.02, 1.98, 0.16));
    }
    for i in 0..6 {
        let y = 0.1 + 0.36 * f64::from(i);
        b.cuboid(Look::Oak, DVec3::new(-0.72, y, -0.24), DVec3::new(0.72, y + 0.024, 0.15));
    }
    b.cuboid(Look::Oak, DVec3::new(-0.72, 0.0, -0.25), DVec3::new(0.72, 1.98, -0.22));
}

/// Upright barrels, crates, and bottles that stand about.
fn floor_things(palace: &mut Palace, stock: Stock) {
    let mut rng = palace.rng.fork(23);
    let standing = [(0.1, 2.0), (-1.5, 3.1), (-2.2, 2.2), (6.9, 0.75), (-3.2, -0.75), (3.6, -0.7)];
    for (x, z) in standing {
        let turn = Turn::radians(rng.range(0.0, TAU));
        palace.place("barrel", stock.barrel, DVec3::new(x, FLOOR, z), turn);
        for _ in 0..2 + rng.index(3) {
            let (angle, away) = (rng.range(0.0, TAU), rng.range(0.06, 0.2));
            let at = DVec3::new(x + away * libm::cos(angle), FLOOR + 0.966, z + away * libm::sin(angle));
            palace.place("bottle", rng.pick(&stock.bottles), at, Turn::radians(angle));
        }
    }
    for (x, z) in [(0.95, 3.0), (-0.75, 3.35), (6.3, 1.5), (-6.6, -0.4), (4.4, 0.5), (-4.1, 0.45)] {
        let turn = Turn::radians(rng.range(0.0, TAU));
        crate_of_bottles(palace, &mut rng, stock, DVec3::new(x, FLOOR, z), turn);
    }
}

/// A crate with a few bottles standing in it.
pub(super) fn crate_of_bottles(palace: &mut Palace, rng: &mut Rng, stock: Stock, at: DVec3, turn: Turn) {
    palace.place("crate", stock.crate_, at, turn);
    for (i, k) in (0..4).flat_map(|i| (0..3).map(move |k| (i, k))) {
        if !rng.chance(palace.detail.share(0.55)) {
            continue;
        }
        let offset = DVec3::new(0.115 * (f64::from(i) - 1.5), 0.02, 0.105 * (f64::from(k) - 1.0));
        palace.place("bottle", rng.pick(&stock.bottles), at + turn.apply(offset), Turn::NONE);
    }
}
