//! Which triangles cast, and which of them bound solids.
//!
//! *Closed* means a cycle: after welding corners that coincide, every edge is used equally often in both directions.
//! Then the winding number is defined everywhere, for touching, overlapping and duplicated solids too. Judged per node
//! first, then per edge-connected component of the rest of a node, then per component of all that is left over, so
//! that one broken house does not open its street. Inside is where the winding number, summed over all closed parts,
//! is positive: a closed part turned inward inside a solid is a room. A lone part turned inward is open, unless told
//! otherwise.
//!
//! Closed-object compression: Sintorn et al. 2014, section 4.2; Kämpe et al. 2015, section 3.3. Judging by cycles
//! instead of by watertight two-manifolds is ours: houses that share a wall stay closed.

mod closed;
mod lone;
pub mod occluder;

use antumbra_scene::{AlphaMode, Node, Primitive, Scene};
use glam::DVec3;

/// What a triangle is to the light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Part of an open surface.
    Open,
    /// Bounds a solid.
    Solid,
    /// Bounds a solid whose triangles are all turned over; they count as their mirror images.
    TurnedSolid,
}

/// What to do with closed parts that are turned inward and lie in no solid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Inverted {
    /// They are open: a room seen from inside, for example.
    #[default]
    Open,
    /// They are solids that were exported inside out.
    Solid,
}

/// What to do with `alphaMode` BLEND triangles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Blend {
    /// They cast nothing.
    #[default]
    Skip,
    /// They cast as if opaque.
    Opaque,
}

/// How casters are chosen and judged.
#[derive(Clone, Copy, Debug)]
pub struct CasterOptions {
    /// Look for solids at all.
    pub find_solids: bool,
    /// Lone inward parts.
    pub inverted: Inverted,
    /// Translucent triangles.
    pub blend: Blend,
    /// Bytes that judging may take.
    pub memory_limit: u64,
}

/// Judging needs more memory than it may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("finding closed parts needs more memory than the limit of {limit} bytes")]
pub struct CastersOutOfMemory {
    /// The limit.
    pub limit: u64,
}

/// Counts for reports.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CasterCounts {
    /// Triangles that bound solids, cavities included.
    pub closed: u64,
    /// Of those, triangles of cavities.
    pub cavity: u64,
    /// Triangles of open surfaces.
    pub open: u64,
    /// Of those, alpha-masked.
    pub alpha_masked: u64,
    /// Triangles that cast nothing.
    pub left_out: u64,
    /// Closed parts turned inward that lie in no solid.
    pub lone_inverted_parts: u64,
}

/// The scene's casters: each casting node's triangles in order, with what was judged of them.
pub struct Casters<'a> {
    scene: &'a Scene,
    blend: Blend,
    /// Casting nodes: indices into the scene's nodes.
    nodes: Vec<usize>,
    /// For each casting node, a verdict per triangle that [`casting_triangles`] gives.
    verdicts: Vec<Vec<Verdict>>,
    /// What was found.
    pub counts: CasterCounts,
}

/// A casting triangle in the world, counter-clockwise seen from outside.
#[derive(Clone, Copy, Debug)]
pub struct CasterTriangle {
    /// Corners, world metres.
    pub corners: [DVec3; 3],
    /// Index of its node in the scene.
    pub node: usize,
    /// Whether it bounds a solid.
    pub solid: bool,
}

impl<'a> Casters<'a> {
    /// Chooses and judges; deterministic. Time and memory in proportion to the triangles (and, beyond that, to pairs of
    /// an inward part and a part about it). The scene's indices must be in range, as its loaders leave them.
    ///
    /// # Errors
    /// [`CastersOutOfMemory`], judged by an estimate before the memory is taken.
    pub fn new(scene: &'a Scene, options: CasterOptions) -> Result<Self, CastersOutOfMemory> {
        let blend = options.blend;
        let nodes: Vec<usize> = (0..scene.nodes.len()).filter(|&n| !scene.nodes[n].dynamic).collect();
        let limit = options.memory_limit;
        let parts = if options.find_solids {
            closed::judge(scene, &nodes, blend, limit).ok_or(CastersOutOfMemory { limit })?
        } else {
            closed::Parts::none()
        };
        let places = lone::judge_places(scene, &nodes, &parts, blend);
        let verdict_of_part = |part: u32| match (places[part as usize], options.inverted) {
            (lone::Place::Outward | lone::Place::InSolid, _) => Verdict::Solid,
            (lone::Place::Lone, Inverted::Open) => Verdict::Open,
            (lone::Place::Lone, Inverted::Solid) => Verdict::TurnedSolid,
        };
        let lone_inverted_parts = places.iter().filter(|p| **p == lone::Place::Lone).count() as u64;
        let mut counts = CasterCounts { lone_inverted_parts, ..CasterCounts::default() };
        let mut verdicts = Vec::with_capacity(nodes.len());
        for (caster_node, &node) in nodes.iter().enumerate() {
            let judged = casting_triangles(scene, node, blend).enumerate().map(|(index, triangle)| {
                let part = parts.of(caster_node, index);
                let verdict = part.map_or(Verdict::Open, verdict_of_part);
                let cavity = part.is_some_and(|p| places[p as usize] == lone::Place::InSolid);
                counts.add(&triangle, verdict, cavity);
                verdict
            });
            verdicts.push(judged.collect());
        }
        counts.left_out = scene.triangle_count() - counts.open - counts.closed;
        Ok(Self { scene, blend, nodes, verdicts, counts })
    }

    /// Calls `each` with every casting triangle, in the scene's order. Seams take part only where they bound solids.
    pub fn for_each(&self, mut each: impl FnMut(CasterTriangle)) {
        for (&index, verdicts) in self.nodes.iter().zip(&self.verdicts) {
            let node = &self.scene.nodes[index];
            let mirrors = node.mirrors();
            for (triangle, &verdict) in casting_triangles(self.scene, index, self.blend).zip(verdicts) {
                let solid = verdict != Verdict::Open;
                if triangle.seam && !solid {
                    continue;
                }
                let mut corners = triangle.corners().map(|p| node.world_point(p));
                if mirrors != (verdict == Verdict::TurnedSolid) {
                    corners.swap(1, 2);
                }
                each(CasterTriangle { corners, node: index, solid });
            }
        }
    }

    /// Triangles that [`Casters::for_each`] gives, at most.
    #[must_use]
    pub fn len(&self) -> usize {
        self.verdicts.iter().map(Vec::len).sum()
    }

    /// Whether nothing casts.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The scene that the casters belong to.
    #[must_use]
    pub fn scene(&self) -> &'a Scene {
        self.scene
    }
}

impl CasterCounts {
    fn add(&mut self, triangle: &MeshTriangle<'_>, verdict: Verdict, cavity: bool) {
        if triangle.seam {
            return;
        }
        let open = verdict == Verdict::Open;
        self.open += u64::from(open);
        self.closed += u64::from(!open);
        self.cavity += u64::from(cavity);
        self.alpha_masked += u64::from(triangle.alpha_masked);
    }
}

/// A triangle of a node before it is placed in the world.
#[derive(Clone, Copy)]
pub(crate) struct MeshTriangle<'a> {
    primitive: &'a Primitive,
    indices: [u32; 3],
    /// A zero-area triangle: takes part only in closing its surface.
    pub seam: bool,
    pub alpha_masked: bool,
}

impl MeshTriangle<'_> {
    pub fn corners(&self) -> [[f32; 3]; 3] {
        self.indices.map(|i| self.primitive.positions[i as usize])
    }
}

/// A node's triangles that cast, in the mesh's order: each primitive's triangles, then its seams.
pub(crate) fn casting_triangles(scene: &Scene, node: usize, blend: Blend) -> impl Iterator<Item = MeshTriangle<'_>> {
    let node: &Node = &scene.nodes[node];
    scene.meshes[node.mesh].primitives.iter().flat_map(move |primitive| {
        let mode = primitive.material.map_or(AlphaMode::Opaque, |m| scene.materials[m].alpha_mode);
        let casts = mode != AlphaMode::Blend || blend == Blend::Opaque;
        let alpha_masked = mode == AlphaMode::Mask;
        let whole = primitive.triangles.iter().map(|t| (t, false));
        let seams = primitive.seams.iter().map(|t| (t, true));
        whole.chain(seams).filter(move |_| casts).map(move |(&indices, seam)| MeshTriangle {
            primitive,
            indices,
            seam,
            alpha_masked,
        })
    })
}
