//! Doors: panelled leaves, and the stone frames around them.

use glam::DVec3;

use super::Palace;
use super::plan::{BAY, COURT, DOOR, FLOOR, GALLERY, HALL, Side, WALK, WALL, WEST_DOOR_Z};
use super::shows::Show;
use crate::procedural::palette::Paint;
use crate::procedural::shapes::Detail;
use crate::procedural::solids::{Builder, Turn};

/// Thickness of a leaf.
const LEAF: f64 = 0.05;

/// Builds every door: the gallery's and the lumber room's, which open, and those that never do.
pub(super) fn build(palace: &mut Palace) {
    let frame = palace.mesh("door frame", |b, _| frame(b));
    let leaf = palace.mesh("door leaf", |b, detail| leaf(b, detail, Paint::Timber));
    for (at, turn) in blind_doors() {
        palace.place("door frame", frame, at, turn);
        palace.place("door leaf", leaf, at + turn.apply(DVec3::new(-DOOR.x, 0.0, 0.06)), turn);
    }
    gallery_door(palace, frame, leaf);
    lumber_door(palace, leaf);
}

/// Doors on the walls of the walks, in every other bay, that never open: where the middle of the threshold is, and the
/// turn that brings +z to the walk. The chamber's door is not among them.
fn blind_doors() -> impl Iterator<Item = (DVec3, Turn)> {
    Side::all().into_iter().enumerate().flat_map(|(k, side)| {
        let bays = (0..side.bays).filter(move |i| (i + k) % 2 == 0);
        bays.flat_map(move |i| {
            let x = side.column_x(i) + 0.5 * BAY;
            let open = k == 0 && i == side.bays / 2;
            [0.0, GALLERY]
                .into_iter()
                .filter(move |&floor| !(open && floor > 0.0))
                .map(move |floor| (side.turn.apply(DVec3::new(x, floor, -side.away - WALK)), side.turn))
        })
    })
}

/// The door of the chamber behind the gallery; it opens onto the gallery.
fn gallery_door(palace: &mut Palace, frame: usize, leaf: usize) {
    let at = DVec3::new(0.0, GALLERY, -COURT.y - WALK);
    palace.place("door frame", frame, at, Turn::NONE);
    palace.place("door frame", frame, at - DVec3::Z * WALL, Turn::quarters(2));
    let open = if palace.show == Show::Door { -1.72 } else { 0.0 };
    let hinge = at + DVec3::new(-DOOR.x, 0.0, 0.02);
    palace.place_moving("gallery door", leaf, hinge, Turn::radians(open), palace.show == Show::Door);
}

/// The door from the hall to the lumber room; it opens into the room.
fn lumber_door(palace: &mut Palace, leaf: usize) {
    let open = if palace.show == Show::Room { 1.5 } else { 0.0 };
    let hinge = DVec3::new(-HALL.x - 0.3, FLOOR, WEST_DOOR_Z + DOOR.x);
    palace.place("lumber door", leaf, hinge, Turn::quarters(1).then(Turn::radians(open)));
}

/// The frame around a door, proud of a wall whose face is z = 0 and looks along +z.
fn frame(b: &mut Builder) {
    let (half, high) = (DOOR.x, DOOR.y);
    for (x0, x1) in [(-half - 0.2, -half), (half, half + 0.2)] {
        b.cuboid(Paint::Limestone, DVec3::new(x0, -0.02, -0.08), DVec3::new(x1, high + 0.2, 0.1));
    }
    b.cuboid(Paint::Limestone, DVec3::new(-half, high, -0.08), DVec3::new(half, high + 0.2, 0.1));
    b.cuboid(Paint::Limestone, DVec3::new(-half - 0.3, high + 0.2, -0.08), DVec3::new(half + 0.3, high + 0.32, 0.2));
}

/// A leaf whose hinge is the y axis; it closes an opening from there along +x, and its middle plane is z = 0.
fn leaf(b: &mut Builder, detail: Detail, wood: Paint) {
    let (wide, high) = (2.0 * DOOR.x, DOOR.y);
    let thick = 0.5 * LEAF;
    b.cuboid(wood, DVec3::new(0.0, 0.01, -0.6 * thick), DVec3::new(wide, high, 0.6 * thick));
    // Stiles and rails, which leave six panels.
    for x in [0.0, 0.5 * wide - 0.06, wide - 0.12] {
        b.cuboid(wood, DVec3::new(x, 0.01, -thick), DVec3::new(x + 0.12, high, thick));
    }
    for (y0, y1) in [(0.01, 0.24), (0.92, 1.06), (1.68, 1.8), (high - 0.14, high)] {
        b.cuboid(wood, DVec3::new(0.001, y0, -thick + 0.002), DVec3::new(wide - 0.001, y1, thick - 0.002));
    }
    for (x, y) in [(0.17, 0.3), (0.17, 1.12), (0.17, 1.86)].into_iter().flat_map(|(x, y)| [(x, y), (x + 0.54, y)]) {
        let top = if y < 1.0 {
            0.86
        } else if y < 1.5 {
            1.62
        } else {
            high - 0.2
        };
        b.cuboid(wood, DVec3::new(x, y, -0.85 * thick), DVec3::new(x + 0.32, top, 0.85 * thick));
    }
    for z in [-1.0, 1.0] {
        let at = |x: f64, deep: f64| DVec3::new(x, 1.0, z * (thick + deep));
        b.strut(Paint::Bronze, at(wide - 0.07, -0.01), at(wide - 0.07, 0.05), 0.012, detail.sides(8.0));
        b.strut(Paint::Bronze, at(wide - 0.06, 0.05), at(wide - 0.19, 0.05), 0.01, detail.sides(8.0));
    }
}
