//! Ray tracing in world space: the project's ground truth, and the primary rays of its pictures.
//!
//! The hierarchy is obvhs's eight-wide compressed one (Ylitie, Karras and Laine 2017, "Efficient Incoherent Ray
//! Traversal on GPUs Through Compressed Wide BVHs", built by PLOC: Meister and Bittner 2018, "Parallel
//! Locally-Ordered Clustering for Bounding Volume Hierarchy Construction"). Its traversal is used as it is; the
//! triangles are ours, in `f64` world space (`triangle.rs`), and the hierarchy's boxes are padded by more than all its
//! roundings (`frame.rs`), so that no hit is ever lost to them.

mod build;
mod frame;
mod triangle;
mod walk;

#[cfg(test)]
mod tests;

use antumbra_scene::{Bounds, Primitive, Scene};
use glam::DVec3;
use obvhs::cwbvh::CwBvh;

use frame::Frame;

/// A piece of a line, in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where `t` is 0, metres.
    pub origin: DVec3,
    /// Point at `t` is `origin + t * direction`; of any length but zero.
    pub direction: DVec3,
    /// Hits at `t <= t_min` do not count.
    pub t_min: f64,
    /// Hits at `t >= t_max` do not count; may be infinite.
    pub t_max: f64,
}

impl Ray {
    /// Everything ahead of a point.
    #[must_use]
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        Self { origin, direction, t_min: 0.0, t_max: f64::INFINITY }
    }

    /// The same line, between two parameters.
    #[must_use]
    pub fn between(self, t_min: f64, t_max: f64) -> Self {
        Self { t_min, t_max, ..self }
    }

    /// The point at a parameter.
    #[must_use]
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

/// A triangle of a [`Tracer`]: less than [`Tracer::triangle_count`], in no particular order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct TriangleId(pub u32);

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The ray's parameter.
    pub t: f64,
    /// The triangle.
    pub triangle: TriangleId,
    /// Weight of the triangle's second corner.
    pub u: f64,
    /// Weight of the triangle's third corner; the first one's is `1 - u - v`.
    pub v: f64,
    /// The ray comes from outside: it meets the side on which the corners run counter-clockwise.
    pub front: bool,
}

/// Which triangle of the scene a [`TriangleId`] is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Source {
    /// Index into [`Scene::nodes`].
    pub node: usize,
    /// Index into the node's mesh's primitives.
    pub primitive: usize,
    /// Index into the primitive's triangles.
    pub triangle: usize,
    /// The node mirrors: the second and the third corner have changed places, so that the normal points outward.
    pub flipped: bool,
}

impl Source {
    /// The primitive this triangle is of.
    #[must_use]
    pub fn primitive<'a>(&self, scene: &'a Scene) -> &'a Primitive {
        &scene.meshes[scene.nodes[self.node].mesh].primitives[self.primitive]
    }

    /// The vertices of the triangle's three corners, in the tracer's order of corners.
    #[must_use]
    pub fn vertices(&self, scene: &Scene) -> [usize; 3] {
        let [a, b, c] = self.primitive(scene).triangles[self.triangle].map(|i| i as usize);
        if self.flipped { [a, c, b] } else { [a, b, c] }
    }
}

/// A run of triangles from one primitive of one node, in flattened order.
#[derive(Clone, Copy, Debug)]
struct Part {
    first: u32,
    node: u32,
    primitive: u32,
    flipped: bool,
}

/// Traces rays through a scene's triangles.
///
/// Watertight: no ray passes between two triangles that share an edge or a corner (to the bit), at any scale and at
/// any distance from the origin. About 100 bytes per triangle, three times that while building, which takes about
/// a second per million.
#[derive(Clone, Debug)]
pub struct Tracer {
    frame: Frame,
    tree: CwBvh,
    /// Levels of the tree, which bound the traversal's stack.
    depth: usize,
    /// World-space corners, by [`TriangleId`].
    corners: Vec<[DVec3; 3]>,
    /// Index in flattened order, by [`TriangleId`].
    flattened: Vec<u32>,
    parts: Vec<Part>,
    bounds: Bounds,
}

impl Tracer {
    /// How many triangles there are.
    #[must_use]
    pub fn triangle_count(&self) -> usize {
        self.corners.len()
    }

    /// World box of all triangles.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// The corners in world space, counter-clockwise seen from outside.
    ///
    /// # Panics
    /// When the triangle is not this tracer's.
    #[must_use]
    pub fn corners(&self, triangle: TriangleId) -> [DVec3; 3] {
        self.corners[triangle.0 as usize]
    }

    /// The unit normal, pointing outward; zero where the triangle is too thin to have one.
    ///
    /// # Panics
    /// When the triangle is not this tracer's.
    #[must_use]
    pub fn normal(&self, triangle: TriangleId) -> DVec3 {
        let [a, b, c] = self.corners(triangle);
        let (ab, ac) = (b - a, c - a);
        // Scaled first, so that the product of two tiny edges does not vanish.
        let longest = ab.abs().max(ac.abs()).max_element();
        (ab / longest).cross(ac / longest).try_normalize().unwrap_or(DVec3::ZERO)
    }

    /// A triangle's number in the order of the scene's nodes and primitives.
    pub(crate) fn number(&self, triangle: TriangleId) -> u32 {
        self.flattened[triangle.0 as usize]
    }

    /// Which triangle of the scene this is.
    ///
    /// # Panics
    /// When the triangle is not this tracer's.
    #[must_use]
    pub fn source(&self, triangle: TriangleId) -> Source {
        let index = self.number(triangle);
        let part = self.parts[self.parts.partition_point(|p| p.first <= index) - 1];
        Source {
            node: part.node as usize,
            primitive: part.primitive as usize,
            triangle: (index - part.first) as usize,
            flipped: part.flipped,
        }
    }
}
