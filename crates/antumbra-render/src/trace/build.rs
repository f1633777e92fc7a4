//! From a scene to a [`Tracer`]: flattens nodes to world-space triangles and builds the hierarchy over them.

use antumbra_scene::{Bounds, Material, Node, Primitive, Scene};
use glam::DVec3;
use obvhs::{
    bvh2::reinsertion::ReinsertionOptimizer,
    cwbvh::{CwBvh, bvh2_to_cwbvh::bvh2_to_cwbvh},
    ploc::{PlocBuilder, PlocSearchDistance, SortPrecision},
};

use super::{Frame, Part, Tracer};

impl Tracer {
    /// Flattens the triangles of every node and material for which `keep` holds.
    ///
    /// Triangles with a corner at infinity are left out, and so is what comes after the first 2^32 - 1 triangles.
    #[must_use]
    pub fn new(scene: &Scene, keep: impl Fn(&Node, &Material) -> bool) -> Self {
        let flat = Flat::new(scene, keep);
        let mut bounds = Bounds::EMPTY;
        flat.corners.iter().flatten().for_each(|&p| bounds.insert(p));
        let frame = Frame::new(bounds);
        let mut tree = build_tree(&frame, &flat.corners);
        // Triangles are stored in the order in which the tree's leaves name them: neighbours in space, neighbours in
        // memory, and one indirection less.
        let order = core::mem::take(&mut tree.primitive_indices);
        let corners = order.iter().map(|&i| flat.corners[i as usize]).collect();
        let flattened = order.iter().map(|&i| flat.index[i as usize]).collect();
        Self { frame, depth: depth(&tree), tree, corners, flattened, parts: flat.parts, bounds }
    }
}

/// A scene's triangles in a row.
#[derive(Default)]
struct Flat {
    corners: Vec<[DVec3; 3]>,
    /// Flattened index of each of `corners`: counts the triangles left out, too.
    index: Vec<u32>,
    parts: Vec<Part>,
    next: u32,
}

impl Flat {
    fn new(scene: &Scene, keep: impl Fn(&Node, &Material) -> bool) -> Self {
        let mut flat = Self::default();
        for (n, node) in scene.nodes.iter().enumerate() {
            for (p, primitive) in scene.meshes[node.mesh].primitives.iter().enumerate() {
                if keep(node, &scene.material(primitive)) {
                    flat.push(
                        node,
                        primitive,
                        Part { first: flat.next, node: n as u32, primitive: p as u32, flipped: node.mirrors() },
                    );
                }
            }
        }
        flat
    }

    fn push(&mut self, node: &Node, primitive: &Primitive, part: Part) {
        let world: Vec<DVec3> = primitive.positions.iter().map(|&p| node.world_point(p)).collect();
        self.parts.push(part);
        for triangle in &primitive.triangles {
            let Some(next) = self.next.checked_add(1) else { return };
            let [a, b, c] = triangle.map(|i| world[i as usize]);
            if a.is_finite() && b.is_finite() && c.is_finite() {
                self.corners.push(if part.flipped { [a, c, b] } else { [a, b, c] });
                self.index.push(self.next);
            }
            self.next = next;
        }
    }
}

/// The steps of obvhs's own `build_cwbvh`, less its validation in debug builds, which takes seconds and whose
/// tolerance is made for a smaller space than ours.
fn build_tree(frame: &Frame, corners: &[[DVec3; 3]]) -> CwBvh {
    let boxes: Vec<_> = corners.iter().enumerate().map(|(i, c)| frame.padded_box(c, i)).collect();
    let mut binary = PlocBuilder::with_capacity(boxes.len()).build(
        PlocSearchDistance::Low,
        &boxes,
        (0..boxes.len() as u32).collect(),
        SortPrecision::U64,
        2,
    );
    ReinsertionOptimizer::default().run(&mut binary, 0.02, None);
    bvh2_to_cwbvh(&binary, 3, true, false)
}

/// Levels of a tree, 0 for an empty one.
fn depth(tree: &CwBvh) -> usize {
    let mut deepest = 0;
    let mut open: Vec<(u32, usize)> = if tree.nodes.is_empty() { Vec::new() } else { vec![(0, 1)] };
    while let Some((index, level)) = open.pop() {
        deepest = deepest.max(level);
        let node = &tree.nodes[index as usize];
        let inner = (0..8).filter(|&child| !node.is_leaf(child));
        open.extend(inner.map(|child| (node.child_node_index(child), level + 1)));
    }
    deepest
}
