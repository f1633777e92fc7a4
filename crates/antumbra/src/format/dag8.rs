//! The node encoding `dag8`: the papers' own (Sintorn et al. 2014, section 4; Kämpe et al. 2015, section 3).
//!
//! The pool is an array of 32-bit words. A **reference** is 0 (lit), 1 (shadowed), or a word's index in the pool.
//!
//! ```text
//! word      contents
//! 0         M: words of masks (two per mask)
//! 1         S: words of slice nodes
//! 2         I: words of inner nodes
//! 3..8      zero
//! 8         masks: 64 bits each, low word first; bit 8*y + x is 1 where texel (x, y) of the tile is lit
//! 8+M       slice nodes: a node over 8 x 8 x 8 voxels; child i is the slice z = i, its references are masks
//! 8+M+S     inner nodes: a node over 2^L voxels per side, L >= 4; child i = x + 2y + 4z is an octant
//! ```
//!
//! A node of either kind is a header word and then one reference per mixed child, in the children's order:
//!
//! ```text
//! header bits 2i+1..2i   child i: 0 lit, 1 shadowed, 2 mixed (3 does not occur)
//!        bits 31..16     mean visibility of the node's voxels: 0 all shadowed, 65535 all lit, rounded to nearest
//! ```
//!
//! The reference of a mixed child i is in word 1 + (mixed children before i). An inner node over 16 voxels per side
//! refers to slice nodes; a greater one to inner nodes of half its size. Inner nodes stand behind their children, so a
//! reference is always less than its owner's index and cycles cannot be. The order is canonical: see
//! [`super::canonical`].

use alloc::vec;
use alloc::vec::Vec;

use crate::FormatError;

/// Reference to a lit volume.
pub const LIT: u32 = 0;
/// Reference to a shadowed volume.
pub const SHADOWED: u32 = 1;
/// Words before the masks.
pub const POOL_HEADER_WORDS: usize = 8;
/// Level of slice nodes: log2 of the voxels per side.
pub const SLICE_LEVEL: u32 = 3;

/// Where each kind of node lies in a pool.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// First word of the slice nodes; masks lie between the pool's header and here.
    pub slices: usize,
    /// First word of the inner nodes.
    pub inner: usize,
    /// Words in the pool.
    pub end: usize,
}

/// Nodes by kind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NodeCounts {
    /// Inner nodes.
    pub inner: u64,
    /// Slice nodes, 8 x 8 x 8.
    pub slices: u64,
    /// Masks, 8 x 8 x 1.
    pub masks: u64,
    /// Leaves with edges, of the encoding [`super::silhouette`].
    pub cuts: u64,
}

/// The two bits of a header that say what child `i` is: a reference below 2, or 2 for mixed.
#[inline]
#[must_use]
pub fn child_code(header: u32, i: u32) -> u32 {
    (header >> (2 * i)) & 3
}

/// The mean visibility that a node's header holds, 0 to 1; within 1/131070 of the exact mean over its voxels.
#[inline]
#[must_use]
pub fn mean(header: u32) -> f32 {
    (header >> 16) as f32 * (1.0 / 65535.0)
}

/// A share of a volume that is exact for every node: 0 to this.
pub const WHOLE: u64 = 1 << 60;

/// The upper half of a header, for a node of whose volume a share (of [`WHOLE`]) is lit.
#[must_use]
pub fn mean_bits(lit: u64) -> u32 {
    (((u128::from(lit) * 65535 + u128::from(WHOLE / 2)) / u128::from(WHOLE)) as u32) << 16
}

/// The lit share of a slice node (of [`WHOLE`]), given its lit voxels, at most 512.
#[must_use]
pub fn slice_node_share(lit_voxels: u32) -> u64 {
    u64::from(lit_voxels) * (WHOLE / 512)
}

/// Which of a node's references belongs to mixed child `i`.
#[inline]
#[must_use]
pub fn child_slot(header: u32, i: u32) -> usize {
    count_mixed(header & ((1u32 << (2 * i)) - 1)) as usize
}

/// Number of mixed children in a header without impossible codes. Adds up in place: quicker than a population count
/// where the processor has no instruction for it, and never more than 8.
#[inline]
fn count_mixed(header: u32) -> u32 {
    let ones = (header >> 1) & 0x5555;
    let pairs = (ones & 0x3333) + ((ones >> 2) & 0x3333);
    ((pairs * 0x1111) >> 12) & 0xf
}

/// Number of references that follow a header.
#[inline]
#[must_use]
pub fn reference_count(header: u32) -> usize {
    count_mixed(header) as usize
}

/// Reads the pool's own header. Every later index into the three parts lies within the pool.
///
/// # Errors
/// [`FormatError::Malformed`] if the parts do not fill the pool.
pub fn layout(pool: &[u32]) -> Result<Layout, FormatError> {
    let &[masks, slices, inner, 0, 0, 0, 0, 0] = pool.get(..POOL_HEADER_WORDS).unwrap_or_default() else {
        return Err(FormatError::Malformed("the node pool's header is cut off or has stray words"));
    };
    let total = POOL_HEADER_WORDS as u64 + u64::from(masks) + u64::from(slices) + u64::from(inner);
    if total != pool.len() as u64 || !masks.is_multiple_of(2) || total > u64::from(u32::MAX) {
        return Err(FormatError::Malformed("the node pool's parts do not fill it"));
    }
    let slices_at = POOL_HEADER_WORDS + masks as usize;
    Ok(Layout { slices: slices_at, inner: slices_at + slices as usize, end: pool.len() })
}

/// What levels a node can stand at: exactly one, or any from a least one up (a node all of whose children are lit or
/// shadowed fits every level).
#[derive(Clone, Copy, PartialEq, Eq)]
enum Levels {
    NoNode,
    Exactly(u8),
    AtLeast(u8),
}

/// A pool that was checked once: lookups in it cannot read outside it or run for ever.
pub struct Checked {
    layout: Layout,
    /// For each word from `layout.slices` on: the levels of the node that starts there.
    levels: Vec<Levels>,
}

/// Checks every node: whole, no impossible child codes, references to starts of nodes of the right kind and level.
/// Linear in the pool's size.
///
/// # Errors
/// [`FormatError::Malformed`] with what is wrong.
pub fn check(pool: &[u32]) -> Result<Checked, FormatError> {
    let layout = layout(pool)?;
    let mut checked = Checked { layout, levels: vec![Levels::NoNode; layout.end - layout.slices] };
    let mut at = layout.slices;
    while at < layout.end {
        let region_end = if at < layout.inner { layout.inner } else { layout.end };
        let references = node_references(pool, at, region_end)?;
        checked.levels[at - layout.slices] =
            if at < layout.inner { checked.slice_node(references)? } else { checked.inner_node(references, at)? };
        at += 1 + references.len();
    }
    Ok(checked)
}

/// The references of the node at `at`, which must end before `region_end`.
fn node_references(pool: &[u32], at: usize, region_end: usize) -> Result<&[u32], FormatError> {
    let header = pool[at];
    if header & (header >> 1) & 0x5555 != 0 {
        return Err(FormatError::Malformed("a node has an impossible header"));
    }
    let end = at + 1 + reference_count(header);
    if end > region_end {
        return Err(FormatError::Malformed("a node is cut off"));
    }
    Ok(&pool[at + 1..end])
}

impl Checked {
    fn slice_node(&self, references: &[u32]) -> Result<Levels, FormatError> {
        let is_mask = |&r: &u32| {
            let r = r as usize;
            (POOL_HEADER_WORDS..self.layout.slices).contains(&r) && r.is_multiple_of(2)
        };
        if references.iter().all(is_mask) {
            Ok(Levels::Exactly(SLICE_LEVEL as u8))
        } else {
            Err(FormatError::Malformed("a slice node refers to something that is no mask"))
        }
    }

    fn inner_node(&self, references: &[u32], at: usize) -> Result<Levels, FormatError> {
        let mut levels = Levels::AtLeast(SLICE_LEVEL as u8 + 1);
        for &r in references {
            let child = if (r as usize) < at { self.levels_at(r) } else { Levels::NoNode };
            levels = meet_above(levels, child)
                .ok_or(FormatError::Malformed("an inner node refers to something that is no node of half its size"))?;
        }
        Ok(levels)
    }

    fn levels_at(&self, reference: u32) -> Levels {
        let index = (reference as usize).checked_sub(self.layout.slices);
        index.and_then(|i| self.levels.get(i)).copied().unwrap_or(Levels::NoNode)
    }

    /// Whether a reference may stand for a volume of 2^`level` voxels per side.
    #[must_use]
    pub fn fits(&self, reference: u32, level: u32) -> bool {
        reference <= SHADOWED
            || match self.levels_at(reference) {
                Levels::NoNode => false,
                Levels::Exactly(l) => u32::from(l) == level,
                Levels::AtLeast(l) => u32::from(l) <= level,
            }
    }

    /// Nodes by kind in the whole pool.
    #[must_use]
    pub fn counts(&self) -> NodeCounts {
        let split = self.layout.inner - self.layout.slices;
        let nodes = |levels: &[Levels]| levels.iter().filter(|l| **l != Levels::NoNode).count() as u64;
        NodeCounts {
            inner: nodes(&self.levels[split..]),
            slices: nodes(&self.levels[..split]),
            masks: ((self.layout.slices - POOL_HEADER_WORDS) / 2) as u64,
            cuts: 0,
        }
    }
}

/// The levels of a node that could stand at `node` and has a child that could stand at `child`.
fn meet_above(node: Levels, child: Levels) -> Option<Levels> {
    let above = match child {
        Levels::NoNode => return None,
        Levels::Exactly(l) => Levels::Exactly(l.checked_add(1)?),
        Levels::AtLeast(l) => Levels::AtLeast(l.saturating_add(1)),
    };
    match (node, above) {
        (Levels::AtLeast(a), Levels::AtLeast(b)) => Some(Levels::AtLeast(a.max(b))),
        (Levels::Exactly(a), Levels::Exactly(b)) => (a == b).then_some(node),
        (Levels::Exactly(a), Levels::AtLeast(b)) | (Levels::AtLeast(b), Levels::Exactly(a)) => {
            (b <= a).then_some(Levels::Exactly(a))
        }
        (Levels::NoNode, _) | (_, Levels::NoNode) => None,
    }
}
