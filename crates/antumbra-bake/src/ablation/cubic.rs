//! Cubic leaves: the same volume with 64-bit leaves of 4 x 4 x 4 voxels, eight below each block of 8 x 8 x 8, where the
//! format has eight slices of 8 x 8 x 1 ("we alter the order in which we subdivide the voxel grid in the last two
//! levels, so that leaf nodes only contain voxels at the same depth": Sintorn et al. 2014, talk).
//!
//! The rewritten pool has the layout of [`antumbra::format::dag8`], but for what its leaves mean: bit 16*z + 4*y + x, and
//! a block's child x + 2y + 4z is an octant. Blocks and all nodes above are one to one, so only leaves and blocks change
//! in size.

use antumbra::FormatError;
use antumbra::format::dag8::{self, LIT, POOL_HEADER_WORDS, SHADOWED, SLICE_LEVEL, reference_count};
use rustc_hash::{FxHashMap, FxHashSet};

use super::graph::{child, leaf};

/// How a pool's leaves lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Leaves {
    /// 8 x 8 x 1.
    Flat,
    /// 4 x 4 x 4.
    Cubic,
}

/// A pool of one kind or the other.
pub struct LeafPool {
    pool: Vec<u32>,
    leaves: Leaves,
    leaf_count: u64,
    last_node: u32,
}

/// What a filter's window reads below the blocks that it touches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reads {
    /// Distinct leaves that are not homogeneous.
    pub leaves: u64,
    /// Distinct aligned 32-byte sectors with what is read of blocks (header and references) and leaves.
    pub sectors: u64,
}

/// Words in a sector, which is what a GPU fetches at least.
const SECTOR_WORDS: u32 = 8;

impl LeafPool {
    /// A file's pool as it is.
    ///
    /// # Errors
    /// [`FormatError`] if its parts do not fill it.
    pub fn flat(pool: &[u32]) -> Result<Self, FormatError> {
        let layout = dag8::layout(pool)?;
        let masks = layout.slices - POOL_HEADER_WORDS;
        let last_node = nodes(pool, layout.inner, layout.end).last().unwrap_or(LIT);
        Ok(Self { pool: pool.to_vec(), leaves: Leaves::Flat, leaf_count: masks as u64 / 2, last_node })
    }

    /// The pool of a validated file, rewritten.
    ///
    /// # Errors
    /// [`FormatError`] if its parts do not fill it.
    pub fn cubic(flat: &[u32]) -> Result<Self, FormatError> {
        let layout = dag8::layout(flat)?;
        let mut leaves = Distinct::default();
        // Leaves stand in front: blocks are written once all are known.
        let blocks: Vec<(u32, [u32; 8])> = nodes(flat, layout.slices, layout.inner)
            .map(|at| (at, octants(flat, at).map(|bits| leaves.reference(bits))))
            .collect();
        let mut pool = vec![0; POOL_HEADER_WORDS];
        pool.extend(leaves.order.iter().flat_map(|bits| [*bits as u32, (*bits >> 32) as u32]));
        let mut moved: FxHashMap<u32, u32> = FxHashMap::default();
        let blocks_at = pool.len();
        for (at, children) in blocks {
            moved.insert(at, pool.len() as u32);
            push_node(&mut pool, flat[at as usize], children);
        }
        let inner_at = pool.len();
        let mut last_node = LIT;
        for at in nodes(flat, layout.inner, layout.end) {
            last_node = pool.len() as u32;
            moved.insert(at, last_node);
            let children = core::array::from_fn(|i| match child(flat, at, i as u32) {
                homogeneous @ (LIT | SHADOWED) => homogeneous,
                reference => moved[&reference],
            });
            push_node(&mut pool, flat[at as usize], children);
        }
        let parts = [blocks_at - POOL_HEADER_WORDS, inner_at - blocks_at, pool.len() - inner_at];
        pool[..3].copy_from_slice(&parts.map(|words| words as u32));
        Ok(Self { pool, leaves: Leaves::Cubic, leaf_count: leaves.order.len() as u64, last_node })
    }

    /// Bytes of all nodes, without the pool's header.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        4 * (self.pool.len() - POOL_HEADER_WORDS) as u64
    }

    /// What its leaves are.
    #[must_use]
    pub fn leaves(&self) -> Leaves {
        self.leaves
    }

    /// Distinct leaves.
    #[must_use]
    pub fn leaf_count(&self) -> u64 {
        self.leaf_count
    }

    /// The last node's reference: the root's, in a pool with one root that is not homogeneous.
    #[must_use]
    pub fn last_node(&self) -> u32 {
        self.last_node
    }

    /// Whether a voxel is lit, below a root with 2^log2 voxels per side.
    #[must_use]
    pub fn is_lit(&self, root: u32, log2: u32, voxel: [u32; 3]) -> bool {
        let block = self.block(root, log2, voxel);
        if block <= SHADOWED {
            return block == LIT;
        }
        let [x, y, z] = voxel.map(|c| c & 7);
        match (child(&self.pool, block, self.child_index([x, y], z)), self.leaves) {
            (homogeneous @ (LIT | SHADOWED), _) => homogeneous == LIT,
            (at, Leaves::Flat) => leaf(&self.pool, at) >> (8 * y + x) & 1 != 0,
            (at, Leaves::Cubic) => leaf(&self.pool, at) >> (16 * (z & 3) + 4 * (y & 3) + (x & 3)) & 1 != 0,
        }
    }

    /// What a window of texels (last included) reads in a slice.
    #[must_use]
    pub fn reads(&self, root: u32, log2: u32, [first, last]: [[u32; 2]; 2], z: u32) -> Reads {
        let width = if self.leaves == Leaves::Flat { 8 } else { 4 };
        let (mut leaves, mut sectors) = (FxHashSet::default(), FxHashSet::default());
        let along = |axis: usize| ((first[axis] / width)..=(last[axis] / width)).map(move |tile| tile * width);
        for (y, x) in along(1).flat_map(|y| along(0).map(move |x| (y, x))) {
            let block = self.block(root, log2, [x, y, z]);
            if block <= SHADOWED {
                continue;
            }
            sectors.insert(block / SECTOR_WORDS);
            let i = self.child_index([x & 7, y & 7], z & 7);
            let at = child(&self.pool, block, i);
            if at > SHADOWED {
                let slot = dag8::child_slot(self.pool[block as usize], i) as u32;
                leaves.insert(at);
                sectors.insert((block + 1 + slot) / SECTOR_WORDS);
                sectors.insert(at / SECTOR_WORDS);
            }
        }
        Reads { leaves: leaves.len() as u64, sectors: sectors.len() as u64 }
    }

    fn block(&self, root: u32, log2: u32, [x, y, z]: [u32; 3]) -> u32 {
        let (mut node, mut level) = (root, log2);
        while node > SHADOWED && level > SLICE_LEVEL {
            level -= 1;
            let octant = ((x >> level) & 1) | (((y >> level) & 1) << 1) | (((z >> level) & 1) << 2);
            node = child(&self.pool, node, octant);
        }
        node
    }

    /// Which of a block's children holds a voxel of it.
    fn child_index(&self, [x, y]: [u32; 2], z: u32) -> u32 {
        match self.leaves {
            Leaves::Flat => z,
            Leaves::Cubic => (x >> 2) | (y >> 2 << 1) | (z >> 2 << 2),
        }
    }
}

/// Leaves in the order in which they are met.
#[derive(Default)]
struct Distinct {
    order: Vec<u64>,
    known: FxHashMap<u64, u32>,
}

impl Distinct {
    fn reference(&mut self, bits: u64) -> u32 {
        match bits {
            u64::MAX => LIT,
            0 => SHADOWED,
            _ => *self.known.entry(bits).or_insert_with(|| {
                self.order.push(bits);
                (POOL_HEADER_WORDS + 2 * (self.order.len() - 1)) as u32
            }),
        }
    }
}

/// Where the nodes of a part of a pool begin.
fn nodes(pool: &[u32], from: usize, to: usize) -> impl Iterator<Item = u32> {
    let mut at = from;
    core::iter::from_fn(move || {
        let here = at;
        (here < to).then(|| {
            at += 1 + reference_count(pool[here]);
            here as u32
        })
    })
}

/// The eight cubic leaves of the block at a word.
fn octants(pool: &[u32], block: u32) -> [u64; 8] {
    let mut octants = [0u64; 8];
    for z in 0..8u32 {
        let mask = match child(pool, block, z) {
            LIT => u64::MAX,
            SHADOWED => 0,
            at => leaf(pool, at),
        };
        for y in 0..8u32 {
            for half in 0..2u32 {
                let row = mask >> (8 * y + 4 * half) & 0xf;
                let octant = half | (y >> 2 << 1) | (z >> 2 << 2);
                octants[octant as usize] |= row << (16 * (z & 3) + 4 * (y & 3));
            }
        }
    }
    octants
}

/// A header word (with the mean visibility of the old one) and a reference per mixed child.
fn push_node(pool: &mut Vec<u32>, old_header: u32, children: [u32; 8]) {
    let codes = children.iter().enumerate().fold(0, |codes, (i, child)| codes | ((*child).min(2) << (2 * i)));
    pool.push((old_header & 0xffff_0000) | codes);
    pool.extend(children.iter().filter(|child| **child > SHADOWED));
}
