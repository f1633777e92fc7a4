//! Top-down construction: a cube is homogeneous or has eight octants, and a block of 8 x 8 x 8 voxels has eight slices.
//! Every node is hash-consed as it is made; time goes with the surface of the shadow volumes.

use rayon::prelude::*;

use super::graph::Graph;
use crate::dag::{EncodeError, Id, LIT, SHADOWED, Tables};

/// log2 of a block's voxels per side.
const BLOCK_LOG2: u32 = 3;
/// Cubes greater than this are built on several threads.
const SPLIT_LOG2: u32 = 6;

/// A node's place: 2^log2 voxels per side.
#[derive(Clone, Copy, Debug)]
pub struct Cube {
    /// Its first voxel.
    pub corner: [u32; 3],
    /// log2 of its side, at least 3.
    pub log2: u32,
}

impl Cube {
    /// Everything.
    #[must_use]
    pub fn root(log2: u32) -> Self {
        Self { corner: [0; 3], log2 }
    }

    /// Octant x + 2y + 4z.
    #[must_use]
    pub fn octant(self, i: u32) -> Self {
        let half = 1 << (self.log2 - 1);
        let [x, y, z] = self.corner;
        Self { corner: [x + half * (i & 1), y + half * (i >> 1 & 1), z + half * (i >> 2)], log2: self.log2 - 1 }
    }

    /// First and last voxel.
    #[must_use]
    pub fn ends(self) -> [[u32; 3]; 2] {
        [self.corner, self.corner.map(|c| c + (1 << self.log2) - 1)]
    }

    /// Whether its children are slices.
    #[must_use]
    pub fn is_block(self) -> bool {
        self.log2 == BLOCK_LOG2
    }
}

/// What an octree is built of.
pub trait Volume: Sync {
    /// Whether a whole cube may be lit (`true`) or shadowed, if it may be either.
    fn homogeneous(&self, cube: Cube) -> Option<bool>;
    /// The slices of the block at a corner: bit 8*y + x of slice z is 1 where voxel (x, y, z) of the block is lit.
    fn slices(&self, corner: [u32; 3]) -> [u64; 8];
}

/// Builds the octree of a volume of 2^log2 voxels per side, on the current rayon pool.
///
/// # Errors
/// [`EncodeError::TooManyWords`].
pub fn build(volume: &dyn Volume, log2: u32) -> Result<Graph, EncodeError> {
    let tables = Tables::default();
    let root = node(volume, &tables, Cube::root(log2));
    if tables.are_full() {
        return Err(EncodeError::TooManyWords);
    }
    Graph::new(tables, root, log2)
}

fn node(volume: &dyn Volume, tables: &Tables, cube: Cube) -> Id {
    match volume.homogeneous(cube) {
        Some(true) => return LIT,
        Some(false) => return SHADOWED,
        None => {}
    }
    if cube.is_block() {
        return tables.slice_node(volume.slices(cube.corner).map(|mask| tables.mask(mask)));
    }
    let octant = |i: usize| node(volume, tables, cube.octant(i as u32));
    let mut octants = [LIT; 8];
    if cube.log2 > SPLIT_LOG2 {
        octants.par_iter_mut().enumerate().for_each(|(i, child)| *child = octant(i));
    } else {
        octants = core::array::from_fn(octant);
    }
    tables.inner_node(octants)
}
