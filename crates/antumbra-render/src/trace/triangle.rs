//! The ray-triangle test: watertight, exact in its yes and no, in `f64`.
//!
//! After Woop, Benthin and Wald (2013), "Watertight Ray/Triangle Intersection", Journal of Computer Graphics
//! Techniques 2(1). A shear and a scale turn the ray into the +z axis; a triangle is hit when the origin lies on the
//! same side of its three sheared edges. It departs from the paper in three ways:
//!
//! - Everything is `f64`. `fl(a b) - fl(c d)` never has the wrong sign, because rounding is monotone; it can only be
//!   zero when the exact value is not. Only then is the sign taken from the rounding errors of the two products,
//!   which fused multiply-adds give exactly. So the side of an edge is always exact for the sheared corners.
//! - An edge that goes through the ray itself is decided by moving the ray by (e, e^2) with an infinitely small e
//!   (Edelsbrunner and Muecke 1990, "Simulation of Simplicity"). Neighbours that share the edge then never both claim
//!   the ray, and never both disown it: crossing counts are right, and closed meshes never leak.
//! - No epsilon at all: the smallest and the thinnest triangles count. Only a triangle that projects to a line or a
//!   point, seen along the ray, is missed; a ray cannot pass through it from one side to the other.

use glam::DVec3;

/// A ray, prepared for many triangles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shear {
    origin: [f64; 3],
    /// The axes that become x, y and z: z is the direction's longest one.
    axes: [usize; 3],
    /// What to take off x and y per unit of z, and what to multiply z by.
    shear: [f64; 3],
}

/// Where the ray crosses a triangle's plane, in the ray's parameter, with barycentric weights of corners 1 and 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Crossing {
    pub t: f64,
    pub u: f64,
    pub v: f64,
    /// The ray comes from the side on which the corners run counter-clockwise.
    pub front: bool,
}

impl Shear {
    /// `direction` is finite and not zero, of any length.
    pub(super) fn new(origin: DVec3, direction: DVec3) -> Self {
        let d = direction.to_array();
        let z = (0..3).fold(0, |best, axis| if d[axis].abs() > d[best].abs() { axis } else { best });
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        // A ray against the axis would mirror the picture; swapping the other two axes mirrors it back.
        if d[z] < 0.0 {
            (x, y) = (y, x);
        }
        Self { origin: origin.to_array(), axes: [x, y, z], shear: [d[x] / d[z], d[y] / d[z], 1.0 / d[z]] }
    }

    /// A corner as the ray sees it: the ray is the z axis, and z is the ray's parameter.
    ///
    /// The same corner gives the same bits in every triangle, on which watertightness rests.
    #[inline(always)]
    fn corner(&self, p: DVec3) -> [f64; 3] {
        let p = p.to_array();
        let [x, y, z] = self.axes.map(|axis| p[axis] - self.origin[axis]);
        [x - self.shear[0] * z, y - self.shear[1] * z, z * self.shear[2]]
    }

    /// The crossing of the ray's whole line with a triangle, before and behind the origin alike.
    #[inline(always)]
    pub(super) fn cross(&self, corners: &[DVec3; 3]) -> Option<Crossing> {
        let [a, b, c] = [self.corner(corners[0]), self.corner(corners[1]), self.corner(corners[2])];
        let weights = [cross_2d(c, b), cross_2d(a, c), cross_2d(b, a)];
        let front = if weights.iter().all(|&w| w > 0.0) {
            true
        } else if weights.iter().all(|&w| w < 0.0) {
            false
        } else if weights.iter().any(|&w| w > 0.0) && weights.iter().any(|&w| w < 0.0) {
            return None;
        } else {
            side_on_an_edge([(c, b), (a, c), (b, a)])?
        };
        Some(crossing(weights, [a[2], b[2], c[2]], front))
    }
}

/// Interpolates the ray's parameter with the three corners' weights (each times the same factor).
#[inline(always)]
fn crossing(weights: [f64; 3], z: [f64; 3], front: bool) -> Crossing {
    let sum = weights[0] + weights[1] + weights[2];
    // Rounded to nothing: the triangle is thinner, seen along the ray, than f64 can weigh. Any point of it will do.
    let [wa, wb, wc] = if sum == 0.0 { [1.0 / 3.0; 3] } else { weights.map(|w| w / sum) };
    Crossing { t: wa * z[0] + wb * z[1] + wc * z[2], u: wb, v: wc, front }
}

#[inline(always)]
fn cross_2d(p: [f64; 3], q: [f64; 3]) -> f64 {
    p[0] * q[1] - p[1] * q[0]
}

/// Settles a triangle with an edge through the ray or within rounding of it: `Some(front)` where it is hit.
#[cold]
fn side_on_an_edge(edges: [([f64; 3], [f64; 3]); 3]) -> Option<bool> {
    let [u, v, w] = edges.map(|(p, q)| exact_side(p, q));
    (u != 0 && u == v && v == w).then_some(u > 0)
}

/// Sign of `p x q` in the plane, exact, with ties broken by moving the origin; 0 only where the two points coincide.
fn exact_side(p: [f64; 3], q: [f64; 3]) -> i32 {
    let (left, right) = (p[0] * q[1], p[1] * q[0]);
    let rounded = sign(left - right);
    if rounded != 0 {
        return rounded;
    }
    // Both products round to the same number: compare what the rounding lost.
    let lost = sign(p[0].mul_add(q[1], -left) - p[1].mul_add(q[0], -right));
    if lost != 0 {
        return lost;
    }
    // (p - m) x (q - m) = p x q + m x (p - q) with m = (e, e^2): the y difference decides, then the x difference.
    let along_y = compare(p[1], q[1]);
    if along_y != 0 { along_y } else { compare(q[0], p[0]) }
}

fn sign(x: f64) -> i32 {
    compare(x, 0.0)
}

fn compare(a: f64, b: f64) -> i32 {
    i32::from(a > b) - i32::from(a < b)
}
