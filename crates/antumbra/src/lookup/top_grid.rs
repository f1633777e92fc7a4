//! A small grid of references that stands for a light's top levels (Kämpe et al. 2015, section 4): made when a file is
//! loaded, never stored.

use alloc::vec::Vec;

use super::{point::descend, silhouette};
use crate::format::dag8::{SHADOWED, SLICE_LEVEL};
use crate::format::silhouette::{Kind, MASK_LEVEL, kind};
use crate::format::slices::Spread;

/// log2 of the cells per side, where the light is large enough.
pub(crate) const MAX_LOG2_CELLS: u32 = 5;

/// log2 of the cells per side of a grid of tiles: 128 for a light of one face, 16 for those of a cube, where there may be hundreds; or more, while there are fewer
/// than a sixteenth of the words in a face's share of the pool, where every level costs a miss of the cache.
pub(crate) fn flat_log2(log2_cells: u32, words_per_face: usize) -> u32 {
    let least = if log2_cells == MAX_LOG2_CELLS { 7 } else { log2_cells };
    (words_per_face / 16).checked_ilog2().map_or(least, |log2| least.max(log2 / 2))
}

/// References to the nodes at the level with min(32, N/8) nodes per side (or fewer, where many grids are made), x fastest,
/// z slowest: 128 KiB at N >= 256. A homogeneous face has a single cell.
///
/// Of silhouettes cells are tiles, and *bounds* come before them: for each square of a quadtree, from the whole face down to the quarters of
/// cells, the slice up to which all of it is lit, and in the upper half of the word that from which on all is shadowed, both in units of
/// 2^`bounds_shift` slices. They answer for most points, of surfaces or in the air, without a descent, and walks through the air need few steps.
#[derive(Clone, Debug)]
pub(crate) struct TopGrid {
    words: Vec<u32>,
    /// Where cells begin.
    first_cell: usize,
    log2_cells: u32,
    /// Bits to shift a slice right by for its cell; so many that none is left where cells are tiles.
    z_shift: u32,
    /// log2 of the voxels per side of a cell's node.
    pub level: u32,
    /// See above: of silhouettes.
    bounds_shift: u32,
    /// What it stands for, and log2 of its voxels per side.
    pub root: (u32, u32),
}

impl TopGrid {
    /// At most 2^`most_log2` cells per side.
    pub(crate) fn new(pool: &[u32], root: u32, log2_resolution: u32, most_log2: u32) -> Self {
        let most = if root <= SHADOWED { 0 } else { most_log2 };
        let log2_cells = most.min(log2_resolution - SLICE_LEVEL);
        let level = log2_resolution - log2_cells;
        let side = 1u32 << log2_cells;
        let words = (0..side.pow(3))
            .map(|i| [i % side, i / side % side, i / (side * side)].map(|c| c << level))
            .map(|corner| descend(pool, root, log2_resolution, level, corner))
            .collect();
        let root = (root, log2_resolution);
        Self { words, first_cell: 0, log2_cells, z_shift: level, level, bounds_shift: 0, root }
    }

    /// The same of silhouettes: cells are tiles, whose level that of the grid is at least.
    pub(crate) fn new_flat(pool: &[u32], root: u32, log2_resolution: u32, most_log2: u32, spread: Spread<'_>) -> Self {
        let most = if kind(root) == Kind::Inner { most_log2 } else { 0 };
        let log2_cells = most.min(log2_resolution - MASK_LEVEL);
        let level = log2_resolution - log2_cells;
        let side = 1u32 << log2_cells;
        let bounds_shift = bounds_shift(log2_resolution);
        let finest = log2_cells + 1;
        let first_cell = squares_before(finest + 1);
        let cells = (0..side * side).map(|i| {
            let corner = [i % side, i / side].map(|c| c << level);
            silhouette::descend(pool, root, log2_resolution, level, corner)
        });
        let mut words = alloc::vec![0; first_cell];
        let mut in_cells = Vec::with_capacity((side * side) as usize);
        for (i, (tile, at)) in (0..).zip(cells) {
            in_cells.push(tile);
            for quarter in 0..4u32 {
                let [x, y] = [2 * (i % side) + (quarter & 1), 2 * (i / side) + (quarter >> 1)];
                let corner = [x, y].map(|c| c << (level - 1));
                let (tile, _) = silhouette::descend(pool, tile, at, level - 1, corner);
                let [least, greatest] = silhouette::bounds_below(pool, tile, level - 1, corner, spread);
                let greatest = (greatest + ((1 << bounds_shift) - 1)) >> bounds_shift;
                words[squares_before(finest) + ((y << finest) + x) as usize] =
                    (least >> bounds_shift) | (greatest << 16);
            }
        }
        for log2 in (0..finest).rev() {
            for i in 0..1u32 << (2 * log2) {
                let [x, y] = [i & ((1 << log2) - 1), i >> log2];
                let part = |i: u32| {
                    let [x, y] = [2 * x + (i & 1), 2 * y + (i >> 1)];
                    words[squares_before(log2 + 1) + ((y << (log2 + 1)) + x) as usize]
                };
                let joint = |a: u32, b: u32| (a & 0xffff).min(b & 0xffff) | ((a >> 16).max(b >> 16) << 16);
                words[squares_before(log2) + i as usize] = [1, 2, 3].map(part).into_iter().fold(part(0), joint);
            }
        }
        words.extend(in_cells);
        let root = (root, log2_resolution);
        Self { words, first_cell, log2_cells, z_shift: u32::BITS - 1, level, bounds_shift, root }
    }

    /// Its words: the bounds of silhouettes, and the references.
    pub(crate) fn words(&self) -> &[u32] {
        &self.words
    }

    /// The node that holds a voxel of the light's volume.
    #[inline(always)]
    pub(crate) fn node(&self, [x, y, z]: [u32; 3]) -> u32 {
        let (level, bits) = (self.level, self.log2_cells);
        let cell = ((((z >> self.z_shift) << bits) + (y >> level)) << bits) + (x >> level);
        self.words[self.first_cell + cell as usize]
    }

    /// Of silhouettes: whether slice z is all lit or all shadowed about a texel, where that is known: in the square of 2^`level` texels per
    /// side that holds it, or the least that there is.
    #[inline(always)]
    pub(crate) fn settled(&self, level: u32, texel: [u32; 2], z: u32) -> Option<bool> {
        self.settled_by(self.bounds(level, texel), z)
    }

    /// Whether slice z is all lit or all shadowed, if bounds say so.
    #[inline(always)]
    fn settled_by(&self, bounds: u32, z: u32) -> Option<bool> {
        let z = z >> self.bounds_shift;
        let is_lit = z < bounds & 0xffff;
        (is_lit || z >= bounds >> 16).then_some(is_lit)
    }

    /// Of silhouettes: bounds of the square of 2^`level` texels per side that holds a texel, or of the quarter of a cell, which is the least.
    #[inline(always)]
    fn bounds(&self, level: u32, [x, y]: [u32; 2]) -> u32 {
        let level = level.max(self.level - 1);
        let log2 = self.root.1 - level;
        self.words[squares_before(log2) + ((y >> level << log2) + (x >> level)) as usize]
    }

    /// Of silhouettes: whether slice z is all lit or all shadowed from one texel to another, if the least square that holds both says so.
    #[inline]
    pub(crate) fn is_lit_between(&self, first: [u32; 2], last: [u32; 2], z: u32) -> Option<bool> {
        let joint = u32::BITS - ((first[0] ^ last[0]) | (first[1] ^ last[1])).leading_zeros();
        self.settled(joint, first, z)
    }

    /// Of silhouettes: the widest square about a texel which is known to be all lit or all shadowed in slice z: log2 of its texels per side, which of
    /// both, and where the slices begin and end in which it is.
    pub(crate) fn widest(&self, texel: [u32; 2], z: u32) -> Option<(u32, bool, [u32; 2])> {
        let mut found = None;
        for level in self.level - 1..=self.root.1 {
            let bounds = self.bounds(level, texel);
            let Some(is_lit) = self.settled_by(bounds, z) else { break };
            let [least, greatest] = [bounds & 0xffff, bounds >> 16].map(|bound| bound << self.bounds_shift);
            found = Some((level, is_lit, if is_lit { [0, least] } else { [greatest, 1 << self.root.1] }));
        }
        found
    }

    /// Of silhouettes: whether the cube of 2^`level` voxels per side that holds a voxel is all lit or all shadowed, where that is known.
    pub(crate) fn cube_is_lit(&self, [x, y, z]: [u32; 3], level: u32) -> Option<bool> {
        let bounds = self.bounds(level, [x, y]);
        let first = z >> level << level;
        let [near, far] = [first, first + ((1 << level) - 1)].map(|z| self.settled_by(bounds, z));
        near.filter(|_| near == far)
    }
}

/// How many squares of the quadtree there are that are wider than those of which there are 2^`log2` per side.
#[inline(always)]
fn squares_before(log2: u32) -> usize {
    (0x5555_5555 & ((1u32 << (2 * log2)) - 1)) as usize
}

/// Bits by which bounds are shifted, so that N fits into 16.
fn bounds_shift(log2_resolution: u32) -> u32 {
    log2_resolution.saturating_sub(15)
}
