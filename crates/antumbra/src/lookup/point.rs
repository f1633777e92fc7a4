//! Point lookups: descend to one voxel (Sintorn et al. 2014, section 5).

use crate::format::dag8::{LIT, SHADOWED, SLICE_LEVEL, child_code, child_slot};

/// Reference of child `i` of the node at `node`: 0 or 1 where it is homogeneous.
#[inline(always)]
pub(crate) fn child(pool: &[u32], node: u32, i: u32) -> u32 {
    let node = node as usize;
    let header = pool[node];
    let code = child_code(header, i);
    if code <= SHADOWED { code } else { pool[node + 1 + child_slot(header, i)] }
}

/// Descends from a node with 2^`from` voxels per side towards voxel (x, y, z), until the node is homogeneous or has
/// 2^`to` voxels per side. Coordinates may be the whole light's: only their low bits count. `to` is at least
/// [`SLICE_LEVEL`].
#[inline(always)]
pub(crate) fn descend(pool: &[u32], mut node: u32, from: u32, to: u32, [x, y, z]: [u32; 3]) -> u32 {
    let mut level = from;
    while node > SHADOWED && level > to {
        level -= 1;
        let octant = ((x >> level) & 1) | (((y >> level) & 1) << 1) | (((z >> level) & 1) << 2);
        node = child(pool, node, octant);
    }
    node
}

/// The 8 x 8 texels of one slice of a node at [`SLICE_LEVEL`], or of a homogeneous one: bit 8*y + x is 1 where lit.
#[inline(always)]
pub(crate) fn slice_mask(pool: &[u32], node: u32, z: u32) -> u64 {
    let mask = if node > SHADOWED { child(pool, node, z & 7) } else { node };
    match mask {
        LIT => u64::MAX,
        SHADOWED => 0,
        at => u64::from(pool[at as usize]) | (u64::from(pool[at as usize + 1]) << 32),
    }
}

/// Whether voxel (x, y, z) below `node`, of 2^`level` voxels per side, is lit.
#[inline(always)]
pub(crate) fn is_lit(pool: &[u32], node: u32, level: u32, voxel: [u32; 3]) -> bool {
    let node = descend(pool, node, level, SLICE_LEVEL, voxel);
    if node <= SHADOWED {
        return node == LIT;
    }
    let [x, y, z] = voxel;
    let at = child(pool, node, z & 7);
    if at <= SHADOWED {
        return at == LIT;
    }
    let word = pool[at as usize + ((y >> 2) & 1) as usize];
    (word >> (8 * (y & 3) + (x & 7))) & 1 != 0
}
