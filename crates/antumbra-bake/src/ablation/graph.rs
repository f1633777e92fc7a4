//! A finished octree with its bytes.

use antumbra::format::dag8::{LIT, NodeCounts, POOL_HEADER_WORDS, SHADOWED, SLICE_LEVEL, child_code, child_slot};

use crate::dag::{EncodeError, Id, Tables, encode};
use crate::never_pause;

/// An octree over 2^log2 voxels per side, encoded as [`antumbra::format::dag8`] has it.
pub struct Graph {
    pool: Vec<u32>,
    root: u32,
    log2: u32,
    nodes: NodeCounts,
}

impl Graph {
    /// Encodes what is reachable from a root.
    ///
    /// # Errors
    /// [`EncodeError::TooManyWords`].
    pub fn new(tables: Tables, root: Id, log2: u32) -> Result<Self, EncodeError> {
        let encoded = encode(tables, &[(root, log2)], u64::MAX, &never_pause)?;
        Ok(Self { pool: encoded.pool, root: encoded.roots[0], log2, nodes: encoded.added[0].0 })
    }

    /// log2 of the voxels per side.
    #[must_use]
    pub fn log2(&self) -> u32 {
        self.log2
    }

    /// Bytes of all nodes, without the pool's header.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        4 * (self.pool.len() - POOL_HEADER_WORDS) as u64
    }

    /// Nodes by kind.
    #[must_use]
    pub fn nodes(&self) -> NodeCounts {
        self.nodes
    }

    /// The root's reference.
    #[must_use]
    pub fn root(&self) -> u32 {
        self.root
    }

    /// Whether a voxel is lit.
    #[must_use]
    pub fn is_lit(&self, [x, y, z]: [u32; 3]) -> bool {
        let (mut node, mut level) = (self.root, self.log2);
        while node > SHADOWED && level > SLICE_LEVEL {
            level -= 1;
            node = self.child(node, ((x >> level) & 1) | (((y >> level) & 1) << 1) | (((z >> level) & 1) << 2));
        }
        self.mask(node, z & 7) >> (8 * (y & 7) + (x & 7)) & 1 != 0
    }

    /// Reference of child `i` of a node that is not homogeneous.
    #[must_use]
    pub fn child(&self, node: u32, i: u32) -> u32 {
        child(&self.pool, node, i)
    }

    /// The mask of slice `z` of a slice node, or of a homogeneous one.
    #[must_use]
    pub fn mask(&self, node: u32, z: u32) -> u64 {
        match if node > SHADOWED { self.child(node, z) } else { node } {
            LIT => u64::MAX,
            SHADOWED => 0,
            at => leaf(&self.pool, at),
        }
    }
}

/// Reference of child `i` of the node at a word of a pool.
pub(super) fn child(pool: &[u32], node: u32, i: u32) -> u32 {
    let at = node as usize;
    match child_code(pool[at], i) {
        code if code <= SHADOWED => code,
        _ => pool[at + 1 + child_slot(pool[at], i)],
    }
}

/// The 64 bits at a word of a pool.
pub(super) fn leaf(pool: &[u32], at: u32) -> u64 {
    u64::from(pool[at as usize]) | (u64::from(pool[at as usize + 1]) << 32)
}
