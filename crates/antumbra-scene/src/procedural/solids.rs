//! Closed solids, gathered into one mesh.
//!
//! Every solid is watertight by construction: its triangles share vertices, or at least the exact bits of their
//! positions, and turn counter-clockwise seen from outside. Solids may run through each other; their union is then what
//! the winding number says. So a builder never has to cut a window out of a wall: it sets a pane into it.
//!
//! Curved solids are split into a smooth part with normals and flat caps without, which land in different primitives
//! of one mesh; the mesh as a whole stays closed.

use glam::{DVec2, DVec3};

use crate::model::{Mesh, Primitive};

/// A rotation about +Y, counter-clockwise seen from above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Turn {
    cos: f64,
    sin: f64,
}

impl Turn {
    pub(crate) const NONE: Self = Self { cos: 1.0, sin: 0.0 };

    pub(crate) fn radians(angle: f64) -> Self {
        Self { cos: libm::cos(angle), sin: libm::sin(angle) }
    }

    /// Exact quarter turns, so that walls along an axis stay along an axis.
    pub(crate) fn quarters(count: usize) -> Self {
        let (cos, sin) = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)][count % 4];
        Self { cos, sin }
    }

    /// Brings +X to a unit vector of the ground plane, given as x and z.
    pub(crate) fn facing(ahead: DVec2) -> Self {
        Self { cos: ahead.x, sin: -ahead.y }
    }

    pub(crate) fn then(self, other: Self) -> Self {
        Self { cos: self.cos * other.cos - self.sin * other.sin, sin: self.sin * other.cos + self.cos * other.sin }
    }

    pub(crate) fn apply(self, p: DVec3) -> DVec3 {
        DVec3::new(self.cos * p.x + self.sin * p.z, p.y, self.cos * p.z - self.sin * p.x)
    }
}

/// Upright placement: a turn about +Y, then an offset.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    origin: DVec3,
    turn: Turn,
}

impl Frame {
    fn point(&self, p: DVec3) -> DVec3 {
        self.turn.apply(p) + self.origin
    }
}

/// How the sides of a loft are shaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shading {
    /// By face.
    Flat,
    /// By averaged vertex normals.
    Smooth,
}

struct Part {
    material: usize,
    shading: Shading,
    primitive: Primitive,
}

/// Gathers solids into one mesh.
pub(crate) struct Builder {
    frame: Frame,
    parts: Vec<Part>,
}

/// The quads of a box; bit 0 of a corner's index picks x, bit 1 y, bit 2 z.
const BOX_QUADS: [[u32; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];

impl Builder {
    pub(crate) fn new() -> Self {
        Self { frame: Frame { origin: DVec3::ZERO, turn: Turn::NONE }, parts: Vec::new() }
    }

    /// Runs `build` in a frame that is turned and moved within the current one.
    pub(crate) fn within(&mut self, offset: DVec3, turn: Turn, build: impl FnOnce(&mut Self)) {
        let outer = self.frame;
        self.frame = Frame { origin: outer.point(offset), turn: outer.turn.then(turn) };
        build(self);
        self.frame = outer;
    }

    /// The finished mesh.
    pub(crate) fn finish(self, name: &str) -> Mesh {
        let primitives = self.parts.into_iter().map(|p| p.primitive).collect();
        Mesh { name: name.to_owned(), primitives }
    }

    /// A box between two corners.
    pub(crate) fn cuboid(&mut self, material: impl Into<usize>, min: DVec3, max: DVec3) {
        debug_assert!(min.cmplt(max).all(), "a box from {min} to {max} is inside out");
        let frame = self.frame;
        let primitive = self.part(material.into(), Shading::Flat);
        let first = primitive.positions.len() as u32;
        for i in 0..8 {
            let pick = |bit: usize, lo: f64, hi: f64| if i & bit == 0 { lo } else { hi };
            let corner = DVec3::new(pick(1, min.x, max.x), pick(2, min.y, max.y), pick(4, min.z, max.z));
            primitive.positions.push(rounded(frame.point(corner)));
        }
        for quad in BOX_QUADS {
            push_quad(primitive, quad.map(|i| first + i));
        }
    }

    /// A box that stands on `y0` centred over a point of the ground plane; `size` is along x and z.
    pub(crate) fn pillar(&mut self, material: impl Into<usize>, at: DVec2, size: DVec2, y0: f64, y1: f64) {
        let (lo, hi) = (at - size * 0.5, at + size * 0.5);
        self.cuboid(material, DVec3::new(lo.x, y0, lo.y), DVec3::new(hi.x, y1, hi.y));
    }

    /// A skin over rings of equally many points. Each ring turns counter-clockwise seen from the next; a first or last
    /// ring of one point is a tip, any other end is capped, for which it has to be convex.
    pub(crate) fn loft(&mut self, material: impl Into<usize>, shading: Shading, rings: &[Vec<DVec3>]) {
        let material = material.into();
        let rings = self.placed(rings);
        let sides: Vec<_> = rings.windows(2).flat_map(|pair| side_triangles(&pair[0], &pair[1])).collect();
        self.sides(material, shading, &sides);
        let reversed: Vec<DVec3> = rings[0].iter().rev().copied().collect();
        self.cap(material, &reversed);
        self.cap(material, &rings[rings.len() - 1]);
    }

    /// As [`Builder::loft`], with the last ring joined to the first: a frame, a tyre, a grandstand.
    pub(crate) fn loop_loft(&mut self, material: impl Into<usize>, shading: Shading, rings: &[Vec<DVec3>]) {
        let rings = self.placed(rings);
        let next = rings.iter().cycle().skip(1);
        let sides: Vec<_> = rings.iter().zip(next).flat_map(|(a, b)| side_triangles(a, b)).collect();
        self.sides(material.into(), shading, &sides);
    }

    /// An upright prism or, with two different radii, a truncated cone; a top radius of 0 makes a tip.
    pub(crate) fn cone(&mut self, material: impl Into<usize>, at: DVec2, sides: usize, ends: [(f64, f64); 2]) {
        let shading = if sides > 8 { Shading::Smooth } else { Shading::Flat };
        self.turned(material, shading, at, sides, &ends);
    }

    /// A solid of revolution about an upright axis. The profile is (radius, y) from bottom to top.
    pub(crate) fn turned(
        &mut self,
        material: impl Into<usize>,
        shading: Shading,
        at: DVec2,
        sides: usize,
        profile: &[(f64, f64)],
    ) {
        let rings: Vec<_> = profile.iter().map(|&(radius, y)| circle(at, y, radius, sides)).collect();
        self.loft(material, shading, &rings);
    }

    /// The upper half of a ball, closed below, on a round or many-sided plan.
    pub(crate) fn dome(&mut self, material: impl Into<usize>, at: DVec2, sides: usize, y: f64, radii: DVec2) {
        let steps = (sides / 4).clamp(3, 8);
        let profile: Vec<_> = (0..=steps)
            .map(|i| {
                let angle = core::f64::consts::FRAC_PI_2 * i as f64 / steps as f64;
                let radius = if i == steps { 0.0 } else { radii.x * libm::cos(angle) };
                (radius, y + radii.y * libm::sin(angle))
            })
            .collect();
        self.turned(material, Shading::Smooth, at, sides, &profile);
    }

    /// A straight bar between two points.
    pub(crate) fn strut(&mut self, material: impl Into<usize>, from: DVec3, to: DVec3, radius: f64, sides: usize) {
        let axis = (to - from).normalize();
        let across = if axis.y.abs() > 0.9 { DVec3::X } else { DVec3::Y }.cross(axis).normalize();
        let up = axis.cross(across);
        let ring = |center: DVec3| -> Vec<DVec3> {
            (0..sides).map(|i| center + (across * cos_turn(i, sides) + up * sin_turn(i, sides)) * radius).collect()
        };
        self.loft(material, Shading::Flat, &[ring(from), ring(to)]);
    }

    /// A rectangular frame lying flat, such as a parapet: the outer size, the width of the rim, and its bottom and top.
    pub(crate) fn rim(&mut self, material: impl Into<usize>, size: DVec2, width: f64, y0: f64, y1: f64) {
        let section = |sx: f64, sz: f64| -> Vec<DVec3> {
            let at = |inset: f64, y: f64| DVec3::new(sx * (size.x * 0.5 - inset), y, sz * (size.y * 0.5 - inset));
            vec![at(0.0, y0), at(width, y0), at(width, y1), at(0.0, y1)]
        };
        let rings = [section(-1.0, 1.0), section(1.0, 1.0), section(1.0, -1.0), section(-1.0, -1.0)];
        self.loop_loft(material, Shading::Flat, &rings);
    }

    /// A prism on a rectangle whose top is a ridge along x: a gable roof. `ridge` is the ridge's height over `y`.
    pub(crate) fn gable(&mut self, material: impl Into<usize>, at: DVec2, size: DVec2, y: f64, ridge: f64) {
        let half = size * 0.5;
        let end = |x: f64| -> Vec<DVec3> {
            [(half.y, 0.0), (-half.y, 0.0), (0.0, ridge)].map(|(z, dy)| DVec3::new(at.x + x, y + dy, at.y + z)).to_vec()
        };
        self.loft(material, Shading::Flat, &[end(-half.x), end(half.x)]);
    }

    /// A rectangle that tapers to a smaller one: mansard and hip roofs, pyramids (with a small top).
    pub(crate) fn taper(&mut self, material: impl Into<usize>, at: DVec2, ends: [(DVec2, f64); 2]) {
        self.loft(material, Shading::Flat, &ends.map(|(size, y)| rectangle(at, size, y)));
    }

    /// Closed triangles of any shape, flat shaded; the caller answers for their being closed.
    pub(crate) fn triangles(&mut self, material: impl Into<usize>, points: &[DVec3], triangles: &[[u32; 3]]) {
        let frame = self.frame;
        let primitive = self.part(material.into(), Shading::Flat);
        let first = primitive.positions.len() as u32;
        primitive.positions.extend(points.iter().map(|&p| rounded(frame.point(p))));
        primitive.triangles.extend(triangles.iter().map(|t| t.map(|i| first + i)));
    }

    /// As [`Builder::triangles`], shaded by averaged vertex normals. What is closed by other parts has to share the bits
    /// of their positions.
    pub(crate) fn smooth_triangles(&mut self, material: impl Into<usize>, points: &[DVec3], triangles: &[[u32; 3]]) {
        let frame = self.frame;
        let points: Vec<DVec3> = points.iter().map(|&p| frame.point(p)).collect();
        let primitive = self.part(material.into(), Shading::Smooth);
        let first = primitive.positions.len() as u32;
        primitive.normals.extend(smooth_normals(&points, triangles));
        primitive.positions.extend(points.iter().map(|&p| rounded(p)));
        primitive.triangles.extend(triangles.iter().map(|t| t.map(|i| first + i)));
    }

    fn placed(&self, rings: &[Vec<DVec3>]) -> Vec<Vec<DVec3>> {
        rings.iter().map(|ring| ring.iter().map(|&p| self.frame.point(p)).collect()).collect()
    }

    fn cap(&mut self, material: usize, ring: &[DVec3]) {
        if ring.len() < 3 {
            return;
        }
        let primitive = self.part(material, Shading::Flat);
        let first = primitive.positions.len() as u32;
        primitive.positions.extend(ring.iter().map(|&p| rounded(p)));
        for i in 1..ring.len() as u32 - 1 {
            primitive.triangles.push([first, first + i, first + i + 1]);
        }
    }

    fn sides(&mut self, material: usize, shading: Shading, triangles: &[[DVec3; 3]]) {
        let (points, triangles) = welded(triangles);
        let primitive = self.part(material, shading);
        let first = primitive.positions.len() as u32;
        if shading == Shading::Smooth {
            primitive.normals.extend(smooth_normals(&points, &triangles));
        }
        primitive.positions.extend(points.iter().map(|&p| rounded(p)));
        primitive.triangles.extend(triangles.iter().map(|t| t.map(|i| first + i)));
    }

    fn part(&mut self, material: usize, shading: Shading) -> &mut Primitive {
        let found = self.parts.iter().position(|p| p.material == material && p.shading == shading);
        let index = found.unwrap_or_else(|| {
            let primitive = Primitive { material: Some(material), ..Primitive::default() };
            self.parts.push(Part { material, shading, primitive });
            self.parts.len() - 1
        });
        &mut self.parts[index].primitive
    }
}

/// Points of a circle, counter-clockwise seen from above; a radius of 0 gives one point.
pub(crate) fn circle(at: DVec2, y: f64, radius: f64, sides: usize) -> Vec<DVec3> {
    ellipse(at, y, DVec2::splat(radius), sides)
}

/// Points of an ellipse, counter-clockwise seen from above; a zero radius gives one point.
pub(crate) fn ellipse(at: DVec2, y: f64, radii: DVec2, sides: usize) -> Vec<DVec3> {
    if radii == DVec2::ZERO {
        return vec![DVec3::new(at.x, y, at.y)];
    }
    (0..sides)
        .map(|i| DVec3::new(at.x + radii.x * cos_turn(i, sides), y, at.y - radii.y * sin_turn(i, sides)))
        .collect()
}

/// Corners of a rectangle, counter-clockwise seen from above; `size` is along x and z.
pub(crate) fn rectangle(at: DVec2, size: DVec2, y: f64) -> Vec<DVec3> {
    [(-0.5, 0.5), (0.5, 0.5), (0.5, -0.5), (-0.5, -0.5)]
        .map(|(x, z)| DVec3::new(at.x + x * size.x, y, at.y + z * size.y))
        .to_vec()
}

/// A rectangle with its corners cut off.
pub(crate) fn octagon(at: DVec2, size: DVec2, cut: f64, y: f64) -> Vec<DVec3> {
    let (x, z) = (size.x * 0.5, size.y * 0.5);
    let (cx, cz) = (x - cut, z - cut);
    [(-cx, z), (cx, z), (x, cz), (x, -cz), (cx, -z), (-cx, -z), (-x, -cz), (-x, cz)]
        .map(|(px, pz)| DVec3::new(at.x + px, y, at.y + pz))
        .to_vec()
}

fn cos_turn(i: usize, n: usize) -> f64 {
    libm::cos(core::f64::consts::TAU * i as f64 / n as f64)
}

fn sin_turn(i: usize, n: usize) -> f64 {
    libm::sin(core::f64::consts::TAU * i as f64 / n as f64)
}

/// To `f32`, with one zero only: a seam is welded by the bits of its positions.
fn rounded(p: DVec3) -> [f32; 3] {
    [p.x as f32 + 0.0, p.y as f32 + 0.0, p.z as f32 + 0.0]
}

fn push_quad(primitive: &mut Primitive, [a, b, c, d]: [u32; 4]) {
    primitive.triangles.push([a, b, c]);
    primitive.triangles.push([a, c, d]);
}

/// The triangles between two rings, either of which may be a single point.
fn side_triangles(a: &[DVec3], b: &[DVec3]) -> Vec<[DVec3; 3]> {
    let count = a.len().max(b.len());
    let mut triangles = Vec::with_capacity(2 * count);
    for i in 0..count {
        let j = (i + 1) % count;
        if a.len() > 1 {
            triangles.push([a[i], a[j], b[j.min(b.len() - 1)]]);
        }
        if b.len() > 1 {
            triangles.push([a[i.min(a.len() - 1)], b[j], b[i]]);
        }
    }
    triangles
}

/// Shares equal corners. A loft is small, so the search runs backwards over the latest points.
fn welded(triangles: &[[DVec3; 3]]) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let mut points: Vec<DVec3> = Vec::with_capacity(triangles.len());
    let mut index_of = |p: DVec3| -> u32 {
        let found = points.iter().rposition(|&q| q == p);
        found.unwrap_or_else(|| {
            points.push(p);
            points.len() - 1
        }) as u32
    };
    let indices = triangles.iter().map(|t| t.map(&mut index_of)).collect();
    (points, indices)
}

fn smooth_normals(points: &[DVec3], triangles: &[[u32; 3]]) -> Vec<[f32; 3]> {
    let mut sums = vec![DVec3::ZERO; points.len()];
    for t in triangles {
        let [a, b, c] = t.map(|i| points[i as usize]);
        let weighted = (b - a).cross(c - a);
        for &i in t {
            sums[i as usize] += weighted;
        }
    }
    sums.iter().map(|n| rounded(n.normalize_or(DVec3::Y))).collect()
}
