//! The lumber room's mess, and the furniture of the chamber behind the gallery.

use core::f64::consts::{FRAC_PI_2, TAU};

use glam::{DAffine3, DMat3, DVec2, DVec3};

use super::Palace;
use super::furniture::{BOARDS, SHELF, TABLE, book_pile, books, carpet, chair, chest, crockery, shelf, table};
use super::plan::{CHAMBER, COURT, FLOOR, GALLERY, LUMBER, WALK, WALL, WEST_DOOR_Z};
use super::shows::Show;
use super::stores::{Stock, crate_of_bottles, lying};
use crate::procedural::solids::Turn;

/// The furniture that both rooms share.
struct Kit {
    table: usize,
    chair: usize,
    shelf: usize,
    chest: usize,
}

/// Furnishes both rooms.
pub(super) fn build(palace: &mut Palace, stock: Stock) {
    let kit = Kit {
        table: palace.mesh("table", table),
        chair: palace.mesh("chair", chair),
        shelf: palace.mesh("shelf", |b, _| shelf(b)),
        chest: palace.mesh("chest", |b, _| chest(b)),
    };
    furniture(palace, &kit, stock);
    shelves(palace, &kit, stock);
    floor(palace, stock);
    chamber(palace, &kit);
}

/// A point of the lumber room, from the middle of its floor.
fn spot(x: f64, y: f64, z: f64) -> DVec3 {
    let middle = |[low, high]: [f64; 2]| (low + high) * 0.5;
    DVec3::new(middle(LUMBER[0]) + x, FLOOR + y, middle(LUMBER[1]) + z)
}

fn furniture(palace: &mut Palace, kit: &Kit, stock: Stock) {
    let mut rng = palace.rng.fork(31);
    let carpet_at = DVec3::new(LUMBER[0][1] - 0.75, FLOOR, WEST_DOOR_Z - 0.05);
    let mesh = palace.mesh("carpet", carpet);
    palace.place("carpet", mesh, carpet_at, Turn::radians(0.08));
    let table_at = spot(-0.75, 0.0, -0.15);
    palace.place("table", kit.table, table_at, Turn::radians(0.22));
    for i in 0..5 {
        let at = DVec3::new(0.3 * f64::from(i) - 0.6 + rng.range(-0.06, 0.06), TABLE.y, rng.range(-0.26, 0.26));
        let at = table_at + Turn::radians(0.22).apply(at);
        if i % 2 == 0 {
            let mesh = palace.mesh("pile", |b, _| book_pile(b, &mut rng, 2 + i as usize));
            palace.place("pile", mesh, at, Turn::radians(0.7 * f64::from(i)));
        } else {
            let mesh = palace.mesh("crockery", |b, detail| crockery(b, detail, &mut rng));
            palace.place("crockery", mesh, at, Turn::NONE);
        }
    }
    for (x, z) in [(-0.25, 0.22), (-0.05, -0.3), (-1.3, 0.05)] {
        palace.place("bottle", rng.pick(&stock.bottles), table_at + DVec3::new(x + 0.2, TABLE.y, z * 0.6), Turn::NONE);
    }
    // The chair that moves stands before the table; another has fallen on its back.
    palace.place_moving("chair", kit.chair, spot(0.1, 0.0, 0.75), Turn::radians(2.7), palace.show == Show::Room);
    palace.place("chair", kit.chair, spot(-0.6, 0.0, -1.1), Turn::radians(0.3));
    palace.place_as("chair", kit.chair, fallen(spot(0.85, 0.24, -1.55), 0.9));
    palace.place("chest", kit.chest, spot(-1.5, 0.0, 1.75), Turn::radians(0.06));
    palace.place("chest", kit.chest, spot(-1.42, 0.468, 1.78), Turn::radians(-0.16));
}

/// On its back, turned: what was up points back.
fn fallen(at: DVec3, angle: f64) -> DAffine3 {
    let turn = Turn::radians(angle);
    let axes = [DVec3::X, DVec3::NEG_Z, DVec3::Y].map(|axis| turn.apply(axis));
    DAffine3 { matrix3: DMat3::from_cols(axes[0], axes[1], axes[2]), translation: at }
}

/// Two shelves along the west wall and one along the north, full of books, jugs and bottles.
fn shelves(palace: &mut Palace, kit: &Kit, stock: Stock) {
    let mut rng = palace.rng.fork(32);
    let (west, north) = (LUMBER[0][0], LUMBER[1][0]);
    for (at, turn) in [
        (DVec3::new(west + 0.01, FLOOR, -1.2), Turn::quarters(1)),
        (DVec3::new(west + 0.01, FLOOR, -2.75), Turn::quarters(1)),
        (DVec3::new(-11.3, FLOOR, north + 0.01), Turn::NONE),
    ] {
        palace.place("shelf", kit.shelf, at, turn);
        for y in BOARDS {
            let start = at + turn.apply(DVec3::new(-SHELF.x + 0.03, y, 0.26));
            if rng.chance(0.72) {
                let long = rng.range(0.35, 1.12) * palace.detail.scale.clamp(0.2, 1.0);
                let mesh = palace.mesh("books", |b, _| books(b, &mut rng, long));
                palace.place("books", mesh, start, turn);
            } else {
                for i in 0..4 {
                    let at = start + turn.apply(DVec3::new(0.12 + 0.26 * f64::from(i), 0.0, -0.1));
                    palace.place("bottle", rng.pick(&stock.bottles), at, Turn::NONE);
                }
            }
        }
    }
}

/// Crates, books, and bottles that have rolled about.
fn floor(palace: &mut Palace, stock: Stock) {
    let mut rng = palace.rng.fork(33);
    for (x, y, z, angle) in
        [(1.75, 0.0, 1.7, 0.2), (1.7, 0.305, 1.72, 0.5), (1.05, 0.0, 1.85, -0.3), (-0.35, 0.0, 1.75, 0.1)]
    {
        crate_of_bottles(palace, &mut rng, stock, spot(x, y, z), Turn::radians(angle));
    }
    for (x, z) in [(0.35, -1.85), (0.6, 1.35), (-0.1, 0.2), (1.55, -1.75)] {
        let count = 2 + rng.index(4);
        let mesh = palace.mesh("pile", |b, _| book_pile(b, &mut rng, count));
        palace.place("pile", mesh, spot(x, 0.0, z), Turn::radians(rng.range(0.0, TAU)));
    }
    for _ in 0..12 {
        let at = DVec2::new(rng.range(-0.2, 1.1), rng.range(-1.3, 1.5));
        let turn = Turn::radians(rng.range(0.0, TAU));
        palace.place_as("bottle", rng.pick(&stock.bottles), lying(spot(at.x, 0.039, at.y), turn));
    }
}

/// The chamber behind the gallery: a table, chairs and shelves along its walls, out of the light's way.
fn chamber(palace: &mut Palace, kit: &Kit) {
    let mut rng = palace.rng.fork(34);
    let far = -COURT.y - WALK - WALL - CHAMBER.y;
    palace.place("table", kit.table, DVec3::new(-2.0, GALLERY, far + 1.6), Turn::quarters(1));
    palace.place("chair", kit.chair, DVec3::new(-1.3, GALLERY, far + 1.7), Turn::radians(-FRAC_PI_2));
    for (x, turn) in [(-CHAMBER.x + 0.01, Turn::quarters(1)), (CHAMBER.x - 0.01, Turn::quarters(3))] {
        let at = DVec3::new(x, GALLERY, far + 3.2);
        palace.place("shelf", kit.shelf, at, turn);
        for y in BOARDS {
            let long = rng.range(0.5, 1.12) * palace.detail.scale.clamp(0.2, 1.0);
            let mesh = palace.mesh("books", |b, _| books(b, &mut rng, long));
            palace.place("books", mesh, at + turn.apply(DVec3::new(-SHELF.x + 0.03, y, 0.26)), turn);
        }
    }
}
