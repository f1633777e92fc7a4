//! The casters in chunks of triangles that follow one another in the scene: what threads take at a time, and what a tree of
//! boxes finds for a light that shines a little way only.

use std::ops::Range;
use std::sync::OnceLock;

use antumbra_scene::{Bounds, Primitive, Scene};
use glam::DVec3;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use rayon::prelude::*;

use super::{Blend, casting_primitives};

/// Triangles in a chunk, at most.
const LENGTH: usize = 64;
/// Coordinates beyond this are taken for this in boxes.
const FARTHEST: f64 = 1e30;

/// Some triangles of a primitive.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chunk {
    /// Index into the casting nodes.
    pub caster_node: u32,
    pub primitive: u32,
    /// Whether these are the primitive's seams.
    pub seams: bool,
    /// First of the primitive's triangles, or seams.
    first: u32,
    length: u32,
    /// Place of the first among the casting node's triangles.
    pub place: u32,
}

/// All chunks, in the scene's order.
pub(super) struct Chunks {
    chunks: Vec<Chunk>,
    /// World boxes.
    bounds: Vec<Bounds>,
    /// Made when it is first asked for.
    tree: OnceLock<Bvh2>,
}

impl Chunk {
    /// Its triangles' indices.
    pub fn triangles<'a>(&self, primitive: &'a Primitive) -> &'a [[u32; 3]] {
        let all = if self.seams { &primitive.seams } else { &primitive.triangles };
        &all[self.first as usize..(self.first + self.length) as usize]
    }
}

impl Chunks {
    pub fn new(scene: &Scene, nodes: &[usize], blend: Blend) -> Self {
        let mut chunks = Vec::new();
        for (caster_node, &node) in nodes.iter().enumerate() {
            let mut place = 0;
            for (primitive, of_primitive) in casting_primitives(scene, node, blend) {
                for (seams, length) in [(false, of_primitive.triangles.len()), (true, of_primitive.seams.len())] {
                    for first in (0..length).step_by(LENGTH) {
                        chunks.push(Chunk {
                            caster_node: caster_node as u32,
                            primitive: primitive as u32,
                            seams,
                            first: first as u32,
                            length: LENGTH.min(length - first) as u32,
                            place: place + first as u32,
                        });
                    }
                    place += length as u32;
                }
            }
        }
        let bounds = chunks.par_iter().map(|chunk| chunk_bounds(chunk, scene, nodes)).collect();
        Self { chunks, bounds, tree: OnceLock::new() }
    }

    pub fn len(&self) -> usize {
        self.chunks.len()
    }

    pub fn range(&self, range: Range<usize>) -> &[Chunk] {
        &self.chunks[range]
    }

    pub fn bounds(&self) -> &[Bounds] {
        &self.bounds
    }

    /// The chunks whose boxes touch a box, in the scene's order.
    pub fn within(&self, bounds: &Bounds) -> Vec<Chunk> {
        let tree = self.tree.get_or_init(|| self.make_tree());
        let mut found: Vec<u32> = Vec::new();
        tree.aabb_traverse(outward(bounds), |tree, node| {
            let node = &tree.nodes[node as usize];
            let first = node.first_index as usize;
            found.extend_from_slice(&tree.primitive_indices[first..first + node.prim_count as usize]);
            true
        });
        found.sort_unstable();
        found.into_iter().map(|chunk| self.chunks[chunk as usize]).collect()
    }

    fn make_tree(&self) -> Bvh2 {
        let boxes: Vec<Aabb> = self.bounds.iter().map(outward).collect();
        let indices = (0..boxes.len() as u32).collect();
        PlocBuilder::new().build(PlocSearchDistance::Low, &boxes, indices, SortPrecision::U64, 0)
    }
}

fn chunk_bounds(chunk: &Chunk, scene: &Scene, nodes: &[usize]) -> Bounds {
    let node = &scene.nodes[nodes[chunk.caster_node as usize]];
    let primitive = &scene.meshes[node.mesh].primitives[chunk.primitive as usize];
    let mut bounds = Bounds::EMPTY;
    for &corner in chunk.triangles(primitive).iter().flatten() {
        let p = node.world_point(primitive.positions[corner as usize]);
        if p.is_finite() {
            bounds.insert(p);
        }
    }
    bounds
}

/// The least box of single precision about a box; the box of nothing touches nothing that is finite.
fn outward(bounds: &Bounds) -> Aabb {
    let clamped = |p: DVec3| p.clamp(DVec3::splat(-FARTHEST), DVec3::splat(FARTHEST)).to_array();
    let [low, high] =
        [clamped(bounds.min).map(|c| (c as f32).next_down()), clamped(bounds.max).map(|c| (c as f32).next_up())];
    Aabb::new(low.into(), high.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use antumbra_scene::procedural::{self, Options};

    #[test]
    fn a_box_finds_every_chunk_that_touches_it() {
        let scene = procedural::build("village", &Options::default()).expect("a scene");
        let nodes: Vec<usize> = (0..scene.nodes.len()).collect();
        let chunks = Chunks::new(&scene, &nodes, Blend::Opaque);
        let all = scene.bounds(|_| true);
        let mut found = 0;
        for i in 0..200u32 {
            let share = |k: u32| f64::from((i * k) % 97) / 96.0;
            let middle = all.min + (all.max - all.min) * DVec3::new(share(31), share(57), share(83));
            let half = DVec3::splat(all.diagonal() * 0.2 * share(13) * share(29));
            let wanted = Bounds { min: middle - half, max: middle + half };
            let touches = |b: &Bounds| b.min.cmple(wanted.max).all() && wanted.min.cmple(b.max).all();
            let within = chunks.within(&wanted);
            let key = |c: &Chunk| (c.caster_node, c.place);
            let is_within = |chunk: &Chunk| within.binary_search_by_key(&key(chunk), key).is_ok();
            assert!(within.is_sorted_by_key(key));
            for (chunk, bounds) in chunks.chunks.iter().zip(&chunks.bounds) {
                assert!(!touches(bounds) || is_within(chunk));
            }
            found += within.len();
        }
        assert!(found > 0 && found < 200 * chunks.len(), "{found} of {}", 200 * chunks.len());
    }
}
