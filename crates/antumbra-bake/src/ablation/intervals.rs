//! A light's exact intervals, texel by texel: the enter and exit depth maps of Kämpe et al. 2015, section 3.3, from
//! the oracle instead of from depth peeling.

use antumbra::{DepthDistribution, Interior};
use antumbra_scene::{Light, Scene};
use rayon::prelude::*;

use super::graph::Graph;
use super::octree::Cube;
use super::pyramid::Pyramid;
use crate::bake::{BakeError, ResolutionRequest};
use crate::casters::{Blend, CasterOptions, Casters, Inverted};
use crate::columns::Cutout;
use crate::dag::{LIT, SHADOWED};
use crate::light_space::{LatticeTriangle, Resolution};
use crate::never_pause;
use crate::oracle::{Free, Oracle, View};
use crate::place::{LightSpace, SpaceRequest, for_each_placed};

/// For each texel (row by row) the first slice in shadow and the first that must be, and the same over squares of texels.
/// A voxel before enter must be lit, one from exit on must be shadowed, and what lies between is undefined.
pub struct Intervals {
    log2: u32,
    enter: Pyramid,
    exit: Pyramid,
}

impl Intervals {
    /// The intervals of each face of a light: open, or with the inside of solids undefined. Takes about a microsecond per
    /// texel and triangle near it.
    ///
    /// # Errors
    /// [`BakeError`] as a bake has it.
    pub fn of_light(
        scene: &Scene,
        light: &Light,
        resolution: Resolution,
        interior: Interior,
    ) -> Result<Vec<Self>, BakeError> {
        let find_solids = interior != Interior::Open;
        let options =
            CasterOptions { find_solids, inverted: Inverted::Open, blend: Blend::Skip, memory_limit: u64::MAX };
        let out_of_memory = |_| BakeError::Memory { limit: u64::MAX, stage: "finding closed parts" };
        let casters = Casters::new(scene, options).map_err(out_of_memory)?;
        let request = SpaceRequest {
            resolution: ResolutionRequest::Texels(resolution),
            near_m: None,
            distribution: DepthDistribution::Logarithmic,
        };
        let space = LightSpace::new(&casters, light, request, &never_pause)?;
        let mut faces = vec![Face::default(); space.faces()];
        for_each_placed(&casters, &space, &space.opened_parts(&casters), |face, triangle, caster| {
            faces[face].triangles.push(*triangle);
            faces[face].cutouts.push(space.cutout(caster, face));
        });
        Ok(faces.iter().map(|face| face.intervals(&space)).collect())
    }

    /// Intervals that are already known: enter and exit of each texel, row by row.
    ///
    /// # Panics
    /// When their number is not that of the texels.
    #[must_use]
    pub fn new(log2: u32, enter: Vec<u32>, exit: Vec<u32>) -> Self {
        Self { log2, enter: Pyramid::new(log2, enter, u32::max), exit: Pyramid::new(log2, exit, u32::min) }
    }

    /// log2 of the texels per side and of the slices.
    #[must_use]
    pub fn log2(&self) -> u32 {
        self.log2
    }

    /// First slice in shadow.
    #[must_use]
    pub fn enter(&self, x: u32, y: u32) -> u32 {
        self.enter.texel(x, y)
    }

    /// First slice that must be in shadow.
    #[must_use]
    pub fn exit(&self, x: u32, y: u32) -> u32 {
        self.exit.texel(x, y)
    }

    /// Whether no voxel of a box (last indices included) must be lit.
    #[must_use]
    pub fn may_be_shadowed(&self, [first, last]: [[u32; 3]; 2]) -> bool {
        first[2] >= self.enter.over([first[0], first[1]], [last[0], last[1]])
    }

    /// Whether no voxel of a box (last indices included) must be shadowed.
    #[must_use]
    pub fn may_be_lit(&self, [first, last]: [[u32; 3]; 2]) -> bool {
        last[2] < self.exit.over([first[0], first[1]], [last[0], last[1]])
    }

    /// Of a tile's 64 texels those that must be lit in a slice, and those that may be.
    #[must_use]
    pub fn masks(&self, [x, y]: [u32; 2], z: u32) -> [u64; 2] {
        let mut masks = [0; 2];
        for texel in 0..64 {
            let (x, y) = (x + texel % 8, y + texel / 8);
            masks[0] |= u64::from(z < self.enter(x, y)) << texel;
            masks[1] |= u64::from(z < self.exit(x, y)) << texel;
        }
        masks
    }

    /// Whether every voxel of a light-space octree that must be lit or shadowed is.
    #[must_use]
    pub fn allow(&self, graph: &Graph) -> bool {
        self.allow_node(graph, graph.root(), Cube::root(self.log2))
    }

    fn allow_node(&self, graph: &Graph, node: u32, cube: Cube) -> bool {
        match node {
            LIT => self.may_be_lit(cube.ends()),
            SHADOWED => self.may_be_shadowed(cube.ends()),
            _ if cube.is_block() => (0..8).all(|z| {
                let [must, may] = self.masks([cube.corner[0], cube.corner[1]], cube.corner[2] + z);
                let mask = graph.mask(node, z);
                must & !mask == 0 && mask & !may == 0
            }),
            _ => (0..8).all(|i| self.allow_node(graph, graph.child(node, i), cube.octant(i))),
        }
    }
}

/// What one face sees.
#[derive(Clone, Default)]
struct Face<'a> {
    triangles: Vec<LatticeTriangle>,
    /// For each triangle its alpha test, if it has one.
    cutouts: Vec<Option<Cutout<'a>>>,
}

impl Face<'_> {
    fn intervals(&self, space: &LightSpace) -> Intervals {
        let slices = space.slices();
        let slice = |step: u32| slices.of_step(step);
        let keeps = |t: usize, at: [i64; 2]| self.cutouts[t].is_none_or(|cutout| cutout.keeps(at));
        let view = View { resolution: space.resolution(), slice: &slice, keeps: &keeps, free: Free::Nothing };
        let oracle = Oracle::new(&self.triangles, view);
        let n = space.resolution().texels();
        let texels = (0..n * n).into_par_iter().map(|i| {
            let interval = oracle.interval(i % n, i / n);
            (interval.enter, interval.exit)
        });
        let (enter, exit) = texels.unzip();
        Intervals::new(space.resolution().log2(), enter, exit)
    }
}
