//! Clips convex polygons by planes, each cut computed from its edge's canonical end: two triangles that share an edge get the
//! same cut to the bit, so that surfaces stay watertight.

use std::cmp::Ordering;

use glam::DVec3;

/// Corners of a triangle that five planes have cut.
const MOST_CORNERS: usize = 8;

/// A convex polygon.
#[derive(Clone, Copy, Debug)]
pub(super) struct Polygon {
    corners: [DVec3; MOST_CORNERS],
    length: usize,
}

impl Polygon {
    pub fn new(triangle: [DVec3; 3]) -> Self {
        let mut corners = [DVec3::ZERO; MOST_CORNERS];
        corners[..3].copy_from_slice(&triangle);
        Self { corners, length: 3 }
    }

    pub fn corners(&self) -> &[DVec3] {
        &self.corners[..self.length]
    }

    /// Keeps the part where a linear function is not negative.
    pub fn clip(&mut self, side: impl Fn(DVec3) -> f64) {
        let distances = self.corners.map(&side);
        if self.length == 0 || distances[..self.length].iter().all(|d| *d >= 0.0) {
            return;
        }
        let before = *self;
        self.length = 0;
        for i in 0..before.length {
            let j = (i + 1) % before.length;
            let (a, b) = (before.corners[i], before.corners[j]);
            if distances[i] >= 0.0 {
                self.push(a);
            }
            if (distances[i] >= 0.0) != (distances[j] >= 0.0) {
                self.push(cut([a, b], [distances[i], distances[j]]));
            }
        }
    }

    fn push(&mut self, corner: DVec3) {
        self.corners[self.length] = corner;
        self.length += 1;
    }
}

/// Where an edge crosses the plane, given its ends' distances, of which exactly one is negative.
fn cut([a, b]: [DVec3; 2], [da, db]: [f64; 2]) -> DVec3 {
    let (a, b, da, db) = if before(a, b) { (a, b, da, db) } else { (b, a, db, da) };
    a + (b - a) * (da / (da - db))
}

/// An order of points that does not depend on the triangle.
fn before(a: DVec3, b: DVec3) -> bool {
    let orders = a.to_array().into_iter().zip(b.to_array()).map(|(a, b)| a.total_cmp(&b));
    orders.fold(Ordering::Equal, Ordering::then) == Ordering::Less
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_get_the_same_cut() {
        let (a, b) = (DVec3::new(0.1, 0.7, -0.3), DVec3::new(5.3, -1.9, 2.2));
        let side = |p: DVec3| p.z - 0.37;
        let corners_of = |triangle| {
            let mut polygon = Polygon::new(triangle);
            polygon.clip(side);
            polygon.corners().to_vec()
        };
        let left = corners_of([a, b, DVec3::new(-3.0, 4.0, 1.0)]);
        let right = corners_of([b, a, DVec3::new(2.0, -9.0, -4.0)]);
        let shared = left.iter().filter(|c| right.contains(c)).count();
        assert_eq!(shared, 2, "the edge's inner end and its cut: {left:?} {right:?}");
    }

    #[test]
    fn five_planes_leave_at_most_eight_corners() {
        let mut polygon =
            Polygon::new([DVec3::new(-9.0, -8.0, 2.0), DVec3::new(9.0, -7.0, 3.0), DVec3::new(0.5, 11.0, 0.1)]);
        polygon.clip(|p| p.z - 1.0);
        for sign in [-1.0, 1.0] {
            polygon.clip(|p| p.z - sign * p.x);
            polygon.clip(|p| p.z - sign * p.y);
        }
        assert!((3..=MOST_CORNERS).contains(&polygon.corners().len()));
        assert!(polygon.corners().iter().all(|p| p.z >= 0.999 && p.x.abs() <= p.z + 1e-9));
        polygon.clip(|_| -1.0);
        assert!(polygon.corners().is_empty());
    }
}
