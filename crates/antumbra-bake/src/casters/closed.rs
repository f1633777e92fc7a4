//! Finds closed parts: sets of triangles whose edges cancel.

use antumbra_scene::{AlphaMode, Scene};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::{Blend, alpha_mode, casting_primitives, casting_triangles};

/// Closed parts, numbered from 0 in a fixed order.
pub(crate) struct Parts {
    /// For each casting node, the part of each of its casting triangles, or [`NO_PART`].
    of_triangle: Vec<Vec<u32>>,
    pub count: usize,
}

const NO_PART: u32 = u32::MAX;

impl Parts {
    /// Nothing is closed.
    pub fn none() -> Self {
        Self { of_triangle: Vec::new(), count: 0 }
    }

    /// The closed part that a casting node's triangle belongs to.
    pub fn of(&self, caster_node: usize, triangle: usize) -> Option<u32> {
        self.of_triangle.get(caster_node).map(|parts| parts[triangle]).filter(|part| *part != NO_PART)
    }
}

/// A triangle whose corners are welded: equal numbers are equal positions.
#[derive(Clone, Copy)]
struct Welded {
    /// Index into the casting nodes, and into that node's casting triangles.
    place: (u32, u32),
    corners: [u32; 3],
}

/// Finds all closed parts among the casting nodes (indices into the scene's nodes). Alpha-masked triangles are never
/// part of one. `None` if that would take more memory than the limit.
pub(crate) fn judge(scene: &Scene, casting: &[usize], blend: Blend, memory_limit: u64) -> Option<Parts> {
    let lasting = 17 * casting.iter().map(|&n| triangle_count(scene, n)).sum::<u64>();
    if lasting + largest_at_once(scene, casting) > memory_limit {
        return None;
    }
    // A node that is closed as a whole is so because its components are: edges are shared only within them.
    let per_node: Vec<(usize, Components)> = casting
        .par_iter()
        .enumerate()
        .map(|(caster_node, &node)| {
            let welded = weld_node(scene, caster_node as u32, node, blend);
            (casting_triangles(scene, node, blend).count(), split_components(&welded))
        })
        .collect();
    let mut parts = Parts { of_triangle: Vec::with_capacity(casting.len()), count: 0 };
    let mut rest = Vec::new();
    for (triangles, components) in per_node {
        parts.of_triangle.push(vec![NO_PART; triangles]);
        parts.add(&components);
        rest.extend(components.open);
    }
    if lasting + weld_bytes(rest.len() as u64, 3 * rest.len() as u64) > memory_limit {
        return None;
    }
    parts.add(&split_components(&weld_world(scene, casting, &rest, blend)));
    Some(parts)
}

fn triangle_count(scene: &Scene, node: usize) -> u64 {
    let primitives = &scene.meshes[scene.nodes[node].mesh].primitives;
    primitives.iter().map(|p| (p.triangles.len() + p.seams.len()) as u64).sum()
}

/// Bytes that welding and splitting take: corners, three edges, a set and a place per triangle; a map's entry per vertex.
fn weld_bytes(triangles: u64, vertices: u64) -> u64 {
    90 * triangles + 50 * vertices
}

/// Bytes that the largest nodes take that threads may judge at the same time.
fn largest_at_once(scene: &Scene, casting: &[usize]) -> u64 {
    let node_bytes = |&node: &usize| {
        let primitives = &scene.meshes[scene.nodes[node].mesh].primitives;
        let vertices = primitives.iter().map(|p| p.positions.len() as u64).sum::<u64>();
        weld_bytes(triangle_count(scene, node), vertices)
    };
    let mut bytes: Vec<u64> = casting.iter().map(node_bytes).collect();
    bytes.sort_unstable_by(|a, b| b.cmp(a));
    bytes.iter().take(rayon::current_num_threads()).sum()
}

impl Parts {
    fn add(&mut self, components: &Components) {
        for &((caster_node, triangle), part) in &components.closed {
            self.of_triangle[caster_node as usize][triangle as usize] = self.count as u32 + part;
        }
        self.count += components.count;
    }
}

/// Edge-connected components, told apart by whether their edges cancel.
struct Components {
    /// Places of closed components' triangles, with the component's number.
    closed: Vec<((u32, u32), u32)>,
    /// How many closed components there are.
    count: usize,
    /// Places of all other triangles.
    open: Vec<(u32, u32)>,
}

/// Undirected edges with +1 or -1 for the direction of use.
fn edges_of([a, b, c]: [u32; 3]) -> [(u32, u32, i32); 3] {
    [(a, b), (b, c), (c, a)].map(|(from, to)| if from < to { (from, to, 1) } else { (to, from, -1) })
}

/// Splits triangles into edge-connected components.
fn split_components(triangles: &[Welded]) -> Components {
    let mut edges: Vec<(u64, u32, i8)> = Vec::with_capacity(3 * triangles.len());
    for (index, t) in triangles.iter().enumerate() {
        let key = |a: u32, b: u32| (u64::from(a) << 32) | u64::from(b);
        // Corners may coincide once a node's transform has squashed them: such an edge joins and unbalances nothing.
        let whole = edges_of(t.corners).into_iter().filter(|(a, b, _)| a != b);
        edges.extend(whole.map(|(a, b, sign)| (key(a, b), index as u32, sign as i8)));
    }
    edges.par_sort_unstable();
    let mut sets = DisjointSets::new(triangles.len());
    for same_edge in edges.chunk_by(|a, b| a.0 == b.0) {
        same_edge.windows(2).for_each(|w| sets.join(w[0].1, w[1].1));
    }
    let mut balanced = vec![true; triangles.len()];
    for same_edge in edges.chunk_by(|a, b| a.0 == b.0) {
        if same_edge.iter().map(|e| i32::from(e.2)).sum::<i32>() != 0 {
            balanced[sets.find(same_edge[0].1) as usize] = false;
        }
    }
    drop(edges);
    collect_components(triangles, &mut sets, &balanced)
}

/// Numbers the closed components in the order of their first triangles.
fn collect_components(triangles: &[Welded], sets: &mut DisjointSets, balanced: &[bool]) -> Components {
    let mut components = Components { closed: Vec::new(), count: 0, open: Vec::new() };
    let mut part_of_root: FxHashMap<u32, u32> = FxHashMap::default();
    for (index, t) in triangles.iter().enumerate() {
        let root = sets.find(index as u32);
        if balanced[root as usize] {
            let next = part_of_root.len() as u32;
            components.closed.push((t.place, *part_of_root.entry(root).or_insert(next)));
        } else {
            components.open.push(t.place);
        }
    }
    components.count = part_of_root.len();
    components
}

/// Welds a node's triangles by the exact position in the mesh.
fn weld_node(scene: &Scene, caster_node: u32, node: usize, blend: Blend) -> Vec<Welded> {
    let mut welder: FxHashMap<[u32; 3], u32> = FxHashMap::default();
    let mut welded = Vec::new();
    let mut index = 0;
    for (_, primitive) in casting_primitives(scene, node, blend) {
        let weld = |p: &[f32; 3]| {
            let next = welder.len() as u32;
            // Adding zero turns -0 into 0.
            *welder.entry(p.map(|c| (c + 0.0).to_bits())).or_insert(next)
        };
        let is_masked = alpha_mode(scene, primitive) == AlphaMode::Mask;
        let vertices: Vec<u32> = if is_masked { Vec::new() } else { primitive.positions.iter().map(weld).collect() };
        for triangle in primitive.triangles.iter().chain(&primitive.seams) {
            if !is_masked {
                welded.push(Welded { place: (caster_node, index), corners: triangle.map(|i| vertices[i as usize]) });
            }
            index += 1;
        }
    }
    welded
}

/// Welds triangles of many nodes by the exact position in the world. `places` are in the casting nodes' order.
fn weld_world(scene: &Scene, casting: &[usize], places: &[(u32, u32)], blend: Blend) -> Vec<Welded> {
    let mut welder: FxHashMap<[u64; 3], u32> = FxHashMap::default();
    let mut welded = Vec::with_capacity(places.len());
    for same_node in places.chunk_by(|a, b| a.0 == b.0) {
        let node_index = casting[same_node[0].0 as usize];
        let node = &scene.nodes[node_index];
        let mut wanted = same_node.iter().peekable();
        for (index, t) in casting_triangles(scene, node_index, blend).enumerate() {
            if wanted.next_if(|place| place.1 as usize == index).is_none() {
                continue;
            }
            let mut corners = t.corners().map(|p| {
                let next = welder.len() as u32;
                let world = node.world_point(p).to_array().map(|c| (c + 0.0).to_bits());
                *welder.entry(world).or_insert(next)
            });
            if node.mirrors() {
                corners.swap(1, 2);
            }
            welded.push(Welded { place: (same_node[0].0, index as u32), corners });
        }
    }
    welded
}

/// Union-find with path halving; the root is a set's least member, so that it does not depend on the order of joins.
struct DisjointSets {
    parent: Vec<u32>,
}

impl DisjointSets {
    fn new(count: usize) -> Self {
        Self { parent: (0..count as u32).collect() }
    }

    fn find(&mut self, mut i: u32) -> u32 {
        while self.parent[i as usize] != i {
            let grandparent = self.parent[self.parent[i as usize] as usize];
            self.parent[i as usize] = grandparent;
            i = grandparent;
        }
        i
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }
}
