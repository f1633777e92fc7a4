//! Trees: closed trunks and closed, faceted crowns that run into one another.

use glam::{DVec2, DVec3, Vec3Swizzles};

use super::palette::Paint;
use super::rng::Rng;
use super::solids::{Builder, Shading, Turn, circle};

/// A tree's habit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Habit {
    /// One round crown, as along streets.
    Round,
    /// Several crowns: an old park tree.
    Spreading,
    /// A column of leaves.
    Poplar,
    /// Stacked cones.
    Conifer,
}

const LEAVES: [Paint; 7] = [
    Paint::LeafDeep,
    Paint::LeafDeep,
    Paint::LeafGreen,
    Paint::LeafGreen,
    Paint::LeafGreen,
    Paint::LeafOlive,
    Paint::LeafRust,
];

/// A tree with its foot at a point, as tall as chance has it.
pub(crate) fn tree(b: &mut Builder, rng: &mut Rng, habit: Habit, foot: DVec3, heights: (f64, f64)) {
    let height = rng.range(heights.0, heights.1);
    let (at, y) = (foot.xz(), foot.y);
    let leaves = rng.pick(&LEAVES);
    let girth = height * 0.022;
    let trunk_top = y + height * 0.5;
    b.cone(Paint::Trunk, at, 5, [(girth * 1.3, y - 0.4), (girth, trunk_top)]);
    let center = |dx: f64, up: f64, dz: f64| DVec3::new(at.x + dx * height, y + up * height, at.y + dz * height);
    match habit {
        Habit::Round => turned_crown(b, rng, leaves, center(0.0, 0.64, 0.0), DVec3::new(0.29, 0.36, 0.29) * height),
        Habit::Poplar => turned_crown(b, rng, leaves, center(0.0, 0.56, 0.0), DVec3::new(0.13, 0.44, 0.13) * height),
        Habit::Spreading => {
            crown(b, rng, leaves, center(0.0, 0.68, 0.0), DVec3::new(0.28, 0.30, 0.28) * height);
            for _ in 0..2 {
                let (dx, up, dz) = (rng.range(-0.22, 0.22), rng.range(0.5, 0.6), rng.range(-0.22, 0.22));
                crown(b, rng, leaves, center(dx, up, dz), DVec3::new(0.22, 0.20, 0.22) * height);
            }
        }
        Habit::Conifer => {
            for (up, radius) in [(0.16, 0.20), (0.40, 0.16), (0.64, 0.11)] {
                let tip: f64 = up + 0.36;
                b.cone(Paint::LeafDeep, at, 7, [(radius * height, y + up * height), (0.0, y + tip * height)]);
            }
        }
    }
}

/// A ball of 80 facets, pushed in and out a little at each corner.
fn crown(b: &mut Builder, rng: &mut Rng, leaves: Paint, center: DVec3, radii: DVec3) {
    let (mut points, triangles) = ball();
    for p in &mut points {
        *p = center + *p * radii * rng.range(0.84, 1.12);
    }
    b.triangles(leaves, &points, &triangles);
}

/// A ball of 42 facets for trees of which there are many.
fn turned_crown(b: &mut Builder, rng: &mut Rng, leaves: Paint, center: DVec3, radii: DVec3) {
    const RINGS: [(f64, f64); 5] = [(0.0, -0.95), (0.82, -0.52), (1.0, 0.08), (0.68, 0.7), (0.0, 1.05)];
    let spin = rng.range(0.0, 1.0);
    let rings = RINGS.map(|(radius, up)| {
        let ring = circle(DVec2::ZERO, up, radius, 7);
        let wobble = |p: DVec3| center + Turn::radians(spin + up * 0.4).apply(p) * radii * rng.range(0.88, 1.12);
        ring.into_iter().map(wobble).collect()
    });
    b.loft(leaves, Shading::Flat, &rings);
}

/// An icosahedron, each face split in four, on the unit sphere.
fn ball() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let (mut points, faces) = icosahedron();
    let mut middles: Vec<(u32, u32, u32)> = Vec::with_capacity(30);
    let mut triangles = Vec::with_capacity(80);
    for [a, b, c] in faces {
        let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(p, q)| middle(&mut points, &mut middles, p.min(q), p.max(q)));
        triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    (points, triangles)
}

fn middle(points: &mut Vec<DVec3>, known: &mut Vec<(u32, u32, u32)>, a: u32, b: u32) -> u32 {
    if let Some(found) = known.iter().find(|m| (m.0, m.1) == (a, b)) {
        return found.2;
    }
    let index = points.len() as u32;
    points.push((points[a as usize] + points[b as usize]).normalize());
    known.push((a, b, index));
    index
}

fn icosahedron() -> (Vec<DVec3>, [[u32; 3]; 20]) {
    let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let mut points = Vec::with_capacity(42);
    for (s, t) in [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)] {
        points.push(DVec3::new(s, t, 0.0).normalize());
    }
    for (s, t) in [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)] {
        points.push(DVec3::new(0.0, s, t).normalize());
    }
    for (s, t) in [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)] {
        points.push(DVec3::new(t, 0.0, s).normalize());
    }
    let faces = [
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    (points, faces)
}
