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

mod chunks;
mod closed;
mod lone;
pub mod occluder;
mod starts;

use std::ops::Range;

use antumbra_scene::{AlphaMode, AlphaTest, Bounds, Primitive, Scene};
use chunks::{Chunk, Chunks};
use glam::DVec3;

use crate::Pause;

pub use starts::OpenedParts;

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
    /// Casting nodes: indices into the scene's nodes.
    nodes: Vec<usize>,
    /// For each casting node, a verdict per triangle that [`casting_triangles`] gives.
    verdicts: Vec<Vec<Verdict>>,
    chunks: Chunks,
    parts: closed::Parts,
    /// World box of each closed part.
    part_bounds: Vec<Bounds>,
    /// What was found.
    pub counts: CasterCounts,
}

/// A casting triangle in the world, counter-clockwise seen from outside.
#[derive(Clone, Copy, Debug)]
pub struct CasterTriangle<'a> {
    /// Corners, world metres.
    pub corners: [DVec3; 3],
    /// Index of its node in the scene.
    pub node: usize,
    /// Whether it bounds a solid.
    pub solid: bool,
    /// The closed part that it belongs to.
    pub part: Option<u32>,
    /// Its alpha mask, if it has one to be tested.
    pub masked: Option<MaskedTriangle<'a>>,
}

/// Casters that follow one another.
#[derive(Clone)]
pub struct Piece<'c, 'a> {
    casters: &'c Casters<'a>,
    chunks: Range<usize>,
}

/// Chunks in a piece.
const PIECE_CHUNKS: usize = 256;
/// Chunks between two rests.
const PAUSE_CHUNKS: usize = 16;

impl<'a> Piece<'_, 'a> {
    /// Calls `each` with the piece's casting triangles, in the scene's order, and rests now and then.
    pub fn for_each(&self, pause: Pause<'_>, mut each: impl FnMut(CasterTriangle<'a>)) {
        for chunks in self.casters.chunks.range(self.chunks.clone()).chunks(PAUSE_CHUNKS) {
            self.casters.for_each_of(chunks, &mut each);
            pause();
        }
    }
}

/// What a masked triangle's alpha test needs.
#[derive(Clone, Copy, Debug)]
pub struct MaskedTriangle<'a> {
    /// The test.
    pub test: AlphaTest<'a>,
    /// Texture coordinates of the corners, in their order.
    pub texcoords: [[f64; 2]; 3],
    /// Vertex alpha of the corners, 1 where there is none.
    pub alpha: [f64; 3],
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
        let (places, part_bounds) = lone::judge_places(scene, &nodes, &parts, blend);
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
        let chunks = Chunks::new(scene, &nodes, blend);
        Ok(Self { scene, nodes, verdicts, chunks, parts, part_bounds, counts })
    }

    /// Calls `each` with every casting triangle, in the scene's order. Seams take part only where they bound solids.
    pub fn for_each(&self, each: impl FnMut(CasterTriangle<'a>)) {
        self.for_each_of(self.chunks.range(0..self.chunks.len()), each);
    }

    /// The same for those near a world box: all that touch it, at least. The first call makes a tree of boxes.
    pub fn for_each_near(&self, bounds: &Bounds, each: impl FnMut(CasterTriangle<'a>)) {
        self.for_each_of(&self.chunks.within(bounds), each);
    }

    /// The casters in pieces, for threads to share; in the scene's order.
    #[must_use]
    pub fn pieces(&self) -> Vec<Piece<'_, 'a>> {
        let piece =
            |first: usize| Piece { casters: self, chunks: first..(first + PIECE_CHUNKS).min(self.chunks.len()) };
        (0..self.chunks.len()).step_by(PIECE_CHUNKS).map(piece).collect()
    }

    fn for_each_of(&self, chunks: &[Chunk], mut each: impl FnMut(CasterTriangle<'a>)) {
        for chunk in chunks {
            let caster_node = chunk.caster_node as usize;
            let index = self.nodes[caster_node];
            let node = &self.scene.nodes[index];
            let mirrors = node.mirrors();
            let primitive = &self.scene.meshes[node.mesh].primitives[chunk.primitive as usize];
            let alpha_masked = alpha_mode(self.scene, primitive) == AlphaMode::Mask;
            for (place, &indices) in (chunk.place as usize..).zip(chunk.triangles(primitive)) {
                let verdict = self.verdicts[caster_node][place];
                let solid = verdict != Verdict::Open;
                if chunk.seams && !solid {
                    continue;
                }
                let triangle = MeshTriangle { primitive, indices, seam: chunk.seams, alpha_masked };
                let swapped = mirrors != (verdict == Verdict::TurnedSolid);
                let order = if swapped { [0, 2, 1] } else { [0, 1, 2] };
                let corners = triangle.corners().map(|p| node.world_point(p));
                each(CasterTriangle {
                    corners: order.map(|i| corners[i]),
                    node: index,
                    solid,
                    part: if solid { self.parts.of(caster_node, place) } else { None },
                    masked: triangle.masked(self.scene, order),
                });
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

    /// World box of all casting nodes.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        let mut all = Bounds::EMPTY;
        for bounds in self.chunks.bounds().iter().filter(|b| !b.is_empty()) {
            all.insert(bounds.min);
            all.insert(bounds.max);
        }
        all
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

impl<'a> MeshTriangle<'a> {
    pub fn corners(&self) -> [[f32; 3]; 3] {
        self.indices.map(|i| self.primitive.positions[i as usize])
    }

    /// Its alpha mask, with the corners in the given order.
    fn masked(&self, scene: &'a Scene, order: [usize; 3]) -> Option<MaskedTriangle<'a>> {
        let test = if self.alpha_masked { AlphaTest::new(scene, self.primitive)? } else { return None };
        let vertices = order.map(|i| self.indices[i] as usize);
        let alpha = |v: usize| self.primitive.colors.get(v).map_or(1.0, |c| f64::from(c[3]));
        let texcoords = vertices.map(|v| self.primitive.texcoords[v].map(f64::from));
        Some(MaskedTriangle { test, texcoords, alpha: vertices.map(alpha) })
    }
}

fn alpha_mode(scene: &Scene, primitive: &Primitive) -> AlphaMode {
    primitive.material.map_or(AlphaMode::Opaque, |m| scene.materials[m].alpha_mode)
}

/// A node's primitives that cast, with their indices.
pub(crate) fn casting_primitives(
    scene: &Scene,
    node: usize,
    blend: Blend,
) -> impl Iterator<Item = (usize, &Primitive)> {
    let primitives = scene.meshes[scene.nodes[node].mesh].primitives.iter().enumerate();
    primitives.filter(move |(_, p)| alpha_mode(scene, p) != AlphaMode::Blend || blend == Blend::Opaque)
}

/// A node's triangles that cast, in the mesh's order: each primitive's triangles, then its seams.
pub(crate) fn casting_triangles(scene: &Scene, node: usize, blend: Blend) -> impl Iterator<Item = MeshTriangle<'_>> {
    casting_primitives(scene, node, blend).flat_map(move |(_, primitive)| {
        let alpha_masked = alpha_mode(scene, primitive) == AlphaMode::Mask;
        let whole = primitive.triangles.iter().map(|t| (t, false));
        let seams = primitive.seams.iter().map(|t| (t, true));
        let both = whole.chain(seams);
        both.map(move |(&indices, seam)| MeshTriangle { primitive, indices, seam, alpha_masked })
    })
}
