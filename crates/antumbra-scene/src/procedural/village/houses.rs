//! Houses: walls, roofs, windows, doors, chimneys; all closed.

use glam::{DVec2, DVec3};

use super::lamps::Window;
use super::{Coat, Glow};
use crate::procedural::palette::Paint;
use crate::procedural::rng::Rng;
use crate::procedural::solids::{Builder, Shading, Turn};

/// Height of the floor over the ground at the house's middle.
const FLOOR_M: f64 = 0.45;
/// Thickness of a roof.
pub(in crate::procedural) const ROOF_M: f64 = 0.17;
/// How far a roof's eaves stand out.
pub(in crate::procedural) const OVERHANG_M: f64 = 0.5;
/// Width of a wing.
const WING_M: f64 = 4.2;

/// What kind of house.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// One storey under a steep roof.
    Cottage,
    /// Two storeys.
    House,
    /// Two storeys with a wing towards the street.
    Wing,
    /// A barn: hardly a window.
    Barn,
    /// The inn on the green: the largest.
    Inn,
}

impl Kind {
    /// What stands along lanes, as often as it is listed.
    pub const COMMON: [Self; 8] =
        [Self::Cottage, Self::Cottage, Self::Cottage, Self::House, Self::House, Self::Wing, Self::Wing, Self::Barn];

    pub fn width(self) -> f64 {
        match self {
            Self::Cottage => 9.2,
            Self::House => 10.4,
            Self::Wing => 11.6,
            Self::Barn => 12.4,
            Self::Inn => 14.5,
        }
    }

    pub fn depth(self) -> f64 {
        match self {
            Self::Cottage => 6.6,
            Self::House | Self::Wing => 7.2,
            Self::Barn => 7.8,
            Self::Inn => 8.4,
        }
    }

    fn storeys(self) -> usize {
        match self {
            Self::Cottage | Self::Barn => 1,
            _ => 2,
        }
    }
}

/// One wing of a house: a box under a gable roof whose ridge runs along x.
#[derive(Clone, Copy, Debug)]
pub(in crate::procedural) struct Body {
    pub size: DVec2,
    pub eaves: f64,
    pub ridge: f64,
}

/// A house with its front towards +z; returns the windows that throw light outside.
pub(super) fn build(b: &mut Builder, rng: &mut Rng, kind: Kind) -> Vec<Window> {
    let coat = coat(rng, kind);
    let storeys = kind.storeys();
    let size = DVec2::new(kind.width() * rng.range(0.94, 1.0), kind.depth());
    let eaves = FLOOR_M + 2.65 * storeys as f64 + if kind == Kind::Barn { 1.2 } else { 0.0 };
    let main = Body { size, eaves, ridge: size.y * 0.5 * rng.range(0.95, 1.2) };
    body(b, coat, &main);
    if kind == Kind::Barn {
        barn(b, coat, &main);
        return Vec::new();
    }
    let framed = rng.chance(0.5);
    let side = if rng.chance(0.5) { 1.0 } else { -1.0 };
    let hidden = (kind == Kind::Wing).then(|| wing_x(&main, side));
    let mut lit = Vec::new();
    for quarters in 0..4 {
        let plan = if quarters % 2 == 0 { size } else { DVec2::new(size.y, size.x) };
        b.within(DVec3::ZERO, Turn::quarters(quarters), |b| {
            if framed {
                timbers(b, &main, plan, quarters);
            }
            let hidden = hidden.filter(|_| quarters == 0);
            let panes = facade(b, rng, coat, &Wall { plan, storeys, quarters, hidden });
            if quarters == 0 {
                lit = panes;
            }
        });
    }
    let windows = street_windows(rng, kind, &lit);
    extras(b, rng, kind, coat, &main, side);
    windows
}

/// Of the lit windows at the front, the one or two that throw light on the street.
fn street_windows(rng: &mut Rng, kind: Kind, lit: &[DVec3]) -> Vec<Window> {
    let most = if kind == Kind::Inn { 2 } else { usize::from(rng.chance(0.5)) };
    lit.iter().take(most).map(|&pane| Window { pane, out: DVec3::Z }).collect()
}

fn coat(rng: &mut Rng, kind: Kind) -> Coat {
    const WALLS: [Paint; 8] = [
        Paint::StuccoCream,
        Paint::StuccoCream,
        Paint::StuccoWhite,
        Paint::StuccoWhite,
        Paint::StuccoRose,
        Paint::BrickOchre,
        Paint::Limestone,
        Paint::BrickRed,
    ];
    let wall = if kind == Kind::Barn { Paint::BrickBrown } else { rng.pick(&WALLS) };
    Coat {
        wall,
        roof: rng.pick(&[Paint::Terracotta, Paint::Terracotta, Paint::Slate, Paint::BrickBrown]),
        wood: rng.pick(&[Paint::Timber, Paint::LeafDeep, Paint::CarBlue, Paint::CarRed, Paint::Timber]),
    }
}

/// Plinth, walls, gables and roof.
pub(super) fn body(b: &mut Builder, coat: Coat, body: &Body) {
    let Body { size, eaves, ridge } = *body;
    b.pillar(Paint::Quay, DVec2::ZERO, size + DVec2::splat(0.18), -1.6, FLOOR_M);
    b.pillar(coat.wall, DVec2::ZERO, size, -1.0, eaves);
    b.gable(coat.wall, DVec2::ZERO, size - DVec2::splat(0.02), eaves - 0.01, ridge - 0.02);
    roof(b, coat.roof, body);
}

/// The two planes of a roof and the comb on their ridge.
pub(in crate::procedural) fn roof(b: &mut Builder, paint: Paint, body: &Body) {
    let Body { size, eaves, ridge } = *body;
    let slope = ridge / (size.y * 0.5);
    let (overhang, reach) = (OVERHANG_M, size.x * 0.5 + 0.4);
    for side in [-1.0, 1.0] {
        let edge = size.y * 0.5 + overhang;
        let (low, high) = (eaves - slope * overhang, eaves + ridge);
        // A roof's two planes meet a little beyond the ridge, one within the other.
        let over = 0.03;
        let (eave, top) = ((side * edge, low), (-side * over, high + slope * over));
        let ring = |x: f64| -> Vec<DVec3> {
            let [south, north] = if side > 0.0 { [eave, top] } else { [top, eave] };
            [(south, 0.0), (north, 0.0), (north, ROOF_M), (south, ROOF_M)]
                .map(|((z, y), up)| DVec3::new(x, y + up, z))
                .to_vec()
        };
        b.loft(paint, Shading::Flat, &[ring(-reach), ring(reach)]);
    }
    let comb = eaves + ridge + ROOF_M;
    b.strut(paint, DVec3::new(-reach - 0.02, comb, 0.0), DVec3::new(reach + 0.02, comb, 0.0), 0.11, 6);
}

/// Posts and beams before the plaster of one wall, with braces at its corners.
fn timbers(b: &mut Builder, body: &Body, plan: DVec2, quarters: usize) {
    let (front, half) = (plan.y * 0.5, plan.x * 0.5);
    let beam = |b: &mut Builder, x: f64, y: (f64, f64), wide: f64| {
        b.pillar(Paint::Trunk, DVec2::new(x, front), DVec2::new(wide, 0.11), y.0, y.1);
    };
    for x in [-half + 0.11, half - 0.11] {
        beam(b, x, (FLOOR_M - 0.02, body.eaves - 0.02), 0.23);
    }
    for y in [FLOOR_M + 0.12, body.eaves - 0.14] {
        beam(b, 0.0, (y - 0.1, y + 0.1), plan.x - 0.05);
    }
    if body.eaves > 5.0 {
        let y = FLOOR_M + 2.65;
        beam(b, 0.0, (y - 0.12, y + 0.12), plan.x - 0.05);
    }
    for side in [-1.0, 1.0] {
        let (foot, head) = (side * (half - 1.15), side * (half - 0.2));
        b.strut(Paint::Trunk, at(foot, FLOOR_M + 0.2, front), at(head, FLOOR_M + 2.1, front), 0.09, 4);
    }
    if quarters % 2 == 1 {
        let top = body.eaves + body.ridge;
        beam(b, 0.0, (body.eaves, top - 0.5), 0.2);
        let y = body.eaves + body.ridge * 0.45;
        beam(b, 0.0, (y - 0.09, y + 0.09), plan.x * 0.5);
    }
}

fn at(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// One of the four walls.
struct Wall {
    /// The house's size along the wall and across it.
    plan: DVec2,
    storeys: usize,
    quarters: usize,
    /// The middle of a wing that stands before it.
    hidden: Option<f64>,
}

/// The windows and, at the front, the door of one wall; returns the panes of the ground floor that are lit.
fn facade(b: &mut Builder, rng: &mut Rng, coat: Coat, wall: &Wall) -> Vec<DVec3> {
    let (plan, front) = (wall.plan, wall.quarters == 0);
    let pitch = if front { 2.45 } else { 3.1 };
    let count = ((plan.x - 1.0) / pitch).floor().max(1.0) as usize;
    let mut lit = Vec::new();
    for storey in 0..wall.storeys {
        let middle = FLOOR_M + 2.65 * storey as f64 + 1.5;
        for i in 0..count {
            let x = (i as f64 - (count - 1) as f64 * 0.5) * pitch;
            // The door has the middle of the front.
            let door = front && storey == 0 && x.abs() < 1.2;
            if door || wall.hidden.is_some_and(|wing| (x - wing).abs() < WING_M * 0.5 + 0.9) {
                continue;
            }
            let glow = rng.chance(0.52).then(|| rng.pick(&[Glow::Pane, Glow::Pane, Glow::Curtain]));
            let shutters = front || storey > 0;
            window(b, coat, at(x, middle, plan.y * 0.5), DVec2::new(0.95, 1.2), glow, shutters);
            if glow == Some(Glow::Pane) && storey == 0 {
                lit.push(at(x, middle, plan.y * 0.5 + 0.11));
            }
        }
    }
    if front {
        door(b, coat, plan.y * 0.5);
    }
    lit
}

/// A window set into a wall that faces +z.
pub(in crate::procedural) fn window(
    b: &mut Builder,
    coat: Coat,
    middle: DVec3,
    size: DVec2,
    glow: Option<Glow>,
    shutters: bool,
) {
    let at = DVec2::new(middle.x, middle.z);
    let (y0, y1) = (middle.y - size.y * 0.5, middle.y + size.y * 0.5);
    b.pillar(Paint::White, at, DVec2::new(size.x + 0.2, 0.16), y0 - 0.1, y1 + 0.1);
    let pane = DVec2::new(size.x, 0.22);
    match glow {
        Some(glow) => b.pillar(glow, at, pane, y0, y1),
        None => b.pillar(Paint::GlassDark, at, pane, y0, y1),
    }
    b.pillar(Paint::White, at, DVec2::new(0.055, 0.27), y0 - 0.05, y1 + 0.05);
    b.pillar(Paint::White, at, DVec2::new(size.x + 0.1, 0.255), middle.y + 0.13, middle.y + 0.18);
    b.pillar(Paint::Limestone, at, DVec2::new(size.x + 0.4, 0.42), y0 - 0.2, y0 - 0.09);
    if shutters {
        for side in [-1.0, 1.0] {
            let leaf = at + DVec2::X * side * (size.x * 0.75 + 0.13);
            b.pillar(coat.wood, leaf, DVec2::new(size.x * 0.46, 0.14), y0 - 0.06, y1 + 0.06);
        }
    }
}

/// A door with a step and a small roof over it.
fn door(b: &mut Builder, coat: Coat, front: f64) {
    let at = DVec2::new(0.0, front);
    b.pillar(Paint::White, at, DVec2::new(1.3, 0.18), 0.1, FLOOR_M + 2.15);
    b.pillar(coat.wood, at, DVec2::new(1.02, 0.26), 0.2, FLOOR_M + 2.02);
    b.pillar(Glow::Curtain, at, DVec2::new(0.4, 0.3), FLOOR_M + 1.5, FLOOR_M + 1.85);
    for (i, deep) in [(0, 1.5), (1, 0.85)] {
        let top = 0.2 + 0.2 * f64::from(i);
        b.pillar(Paint::Quay, at + DVec2::Y * deep * 0.5, DVec2::new(1.7, deep), -0.6, top);
    }
    b.within(DVec3::new(0.0, 0.0, front + 0.35), Turn::quarters(1), |b| {
        b.gable(coat.roof, DVec2::ZERO, DVec2::new(1.2, 1.9), FLOOR_M + 2.4, 0.6);
    });
    for side in [-0.75, 0.75] {
        let (foot, head) = (DVec3::new(side, FLOOR_M + 1.75, front), DVec3::new(side, FLOOR_M + 2.42, front + 0.8));
        b.strut(Paint::Trunk, foot, head, 0.05, 4);
    }
}

/// Chimneys, dormers, a wing, a lean-to: what tells houses apart.
fn extras(b: &mut Builder, rng: &mut Rng, kind: Kind, coat: Coat, main: &Body, side: f64) {
    chimney(b, DVec2::new(side * (main.size.x * 0.5 - 1.0), -0.7), main.eaves, main.eaves + main.ridge + 1.1);
    match kind {
        Kind::Wing => wing(b, rng, coat, main, side),
        Kind::Inn => {
            for x in [-0.3, 0.0, 0.3] {
                dormer(b, rng, coat, main, x * main.size.x);
            }
            chimney(b, DVec2::new(-side * 4.0, -0.5), main.eaves, main.eaves + main.ridge + 1.3);
            sign(b, main);
        }
        _ if rng.chance(0.6) => {
            for x in [-0.22, 0.22] {
                dormer(b, rng, coat, main, x * main.size.x);
            }
        }
        _ => lean_to(b, coat, main, side),
    }
}

/// A chimney of brick with two pots, from `y0` to `y1`.
pub(in crate::procedural) fn chimney(b: &mut Builder, at: DVec2, y0: f64, y1: f64) {
    b.pillar(Paint::BrickRed, at, DVec2::new(0.75, 1.05), y0, y1);
    b.pillar(Paint::BrickBrown, at, DVec2::new(0.93, 1.23), y1 - 0.3, y1 - 0.05);
    for dz in [-0.26, 0.26] {
        b.cone(Paint::Terracotta, at + DVec2::Y * dz, 8, [(0.16, y1 - 0.1), (0.12, y1 + 0.45)]);
    }
}

/// A window with a gable of its own on the front of the roof.
fn dormer(b: &mut Builder, rng: &mut Rng, coat: Coat, main: &Body, x: f64) {
    let slope = main.ridge / (main.size.y * 0.5);
    let (front, y) = (main.size.y * 0.5 - 0.75, main.eaves + slope * 0.75);
    let deep = 1.15 / slope + 0.9;
    let middle = DVec2::new(x, front - deep * 0.5);
    b.pillar(coat.wall, middle, DVec2::new(1.5, deep), y - 0.5, y + 1.15);
    b.within(DVec3::new(x, 0.0, front - deep * 0.5 + 0.08), Turn::quarters(1), |b| {
        b.gable(coat.roof, DVec2::ZERO, DVec2::new(deep + 0.5, 2.0), y + 1.08, 0.85);
    });
    let glow = rng.chance(0.5).then_some(Glow::Pane);
    window(b, coat, DVec3::new(x, y + 0.55, front), DVec2::new(0.75, 0.8), glow, false);
}

/// The middle of a wing.
fn wing_x(main: &Body, side: f64) -> f64 {
    side * (main.size.x * 0.5 - WING_M * 0.5 - 0.2)
}

/// A second body at a right angle, its gable towards the street.
fn wing(b: &mut Builder, rng: &mut Rng, coat: Coat, main: &Body, side: f64) {
    let size = DVec2::new(main.size.y * 0.5 + 3.2, WING_M);
    let offset = DVec3::new(wing_x(main, side), 0.0, size.x * 0.5 - 0.4);
    b.within(offset, Turn::quarters(1), |b| {
        body(b, coat, &Body { size, eaves: main.eaves - 0.25, ridge: 2.5 });
    });
    let front = offset.z + size.x * 0.5;
    for (up, lit) in [(1.5, 0.7), (4.0, 0.5)] {
        let glow = rng.chance(lit).then_some(Glow::Pane);
        window(b, coat, DVec3::new(offset.x, FLOOR_M + up, front), DVec2::new(1.3, 1.3), glow, true);
    }
}

/// A shed against the end wall.
fn lean_to(b: &mut Builder, coat: Coat, main: &Body, side: f64) {
    let (inner, outer) = (main.size.x * 0.5 - 0.1, main.size.x * 0.5 + 2.2);
    let half = main.size.y * 0.36;
    let (low, high) = (FLOOR_M + 1.75, FLOOR_M + 2.45);
    // Sections from front to back, counter-clockwise seen from behind.
    let section = |z: f64, [x0, x1]: [f64; 2], bottom: [f64; 2], top: [f64; 2]| -> Vec<DVec3> {
        let ring = [(x0, bottom[0]), (x1, bottom[1]), (x1, top[1]), (x0, top[0])].map(|(x, y)| at(side * x, y, z));
        if side > 0.0 { ring.into_iter().rev().collect() } else { ring.to_vec() }
    };
    let walls = |z: f64| section(z, [inner, outer], [-1.2; 2], [high, low]);
    b.loft(Paint::Timber, Shading::Flat, &[walls(half), walls(-half)]);
    let slope = (high - low) / (outer - inner);
    let eave = low - 0.35 * slope;
    let roof = |z: f64| section(z, [inner, outer + 0.35], [high, eave], [high + 0.14, eave + 0.14]);
    b.loft(coat.roof, Shading::Flat, &[roof(half + 0.3), roof(-half - 0.3)]);
    let door = DVec2::new(side * (inner + outer) * 0.5, half);
    b.pillar(coat.wood, door, DVec2::new(1.0, 0.16), -0.2, FLOOR_M + 1.5);
}

/// The inn's sign on a bracket.
fn sign(b: &mut Builder, main: &Body) {
    let (x, front, y) = (1.9, main.size.y * 0.5, FLOOR_M + 3.05);
    b.strut(Paint::GlassDark, DVec3::new(x, y, front - 0.1), DVec3::new(x, y, front + 1.35), 0.03, 4);
    b.pillar(Paint::Bronze, DVec2::new(x, front + 0.85), DVec2::new(0.07, 0.8), y - 0.85, y - 0.12);
    for z in [0.55, 1.15] {
        b.pillar(Paint::GlassDark, DVec2::new(x, front + z), DVec2::splat(0.03), y - 0.15, y + 0.02);
    }
}

/// Boards, a great door, a hatch under the gable.
fn barn(b: &mut Builder, coat: Coat, main: &Body) {
    let front = main.size.y * 0.5;
    let boards = (main.size.x / 0.62) as usize;
    for (i, side) in (0..boards).flat_map(|i| [(i, 0), (i, 2)]) {
        let x = main.size.x * ((i as f64 + 0.5) / boards as f64 - 0.5);
        b.within(DVec3::ZERO, Turn::quarters(side), |b| {
            b.pillar(Paint::Timber, DVec2::new(x, front), DVec2::new(0.5, 0.1), 1.1, main.eaves - 0.1);
        });
    }
    b.pillar(coat.wood, DVec2::new(0.0, front), DVec2::new(3.3, 0.26), -0.3, 3.3);
    b.pillar(Paint::Trunk, DVec2::new(0.0, front), DVec2::new(0.12, 0.32), -0.2, 3.2);
    for y in [0.5, 2.6] {
        b.pillar(Paint::Trunk, DVec2::new(0.0, front), DVec2::new(3.2, 0.3), y, y + 0.16);
    }
    for side in [1, 3] {
        b.within(DVec3::ZERO, Turn::quarters(side), |b| {
            let end = DVec2::new(0.0, main.size.x * 0.5);
            b.pillar(coat.wood, end, DVec2::new(1.3, 0.2), main.eaves + 0.5, main.eaves + 1.9);
            b.pillar(Paint::Trunk, end + DVec2::Y * 0.4, DVec2::new(0.16, 1.4), main.eaves + 2.1, main.eaves + 2.28);
        });
    }
}
