//! A small grid of references that stands for a light's top levels (Kämpe et al. 2015, section 4): made when a file is
//! loaded, never stored.

use alloc::vec::Vec;

use super::{point::descend, silhouette};
use crate::format::dag8::{SHADOWED, SLICE_LEVEL};
use crate::format::silhouette::{Kind, MASK_LEVEL, kind};
use crate::format::slices::Spread;

/// log2 of the cells per side, where the light is large enough.
pub(crate) const MAX_LOG2_CELLS: u32 = 5;

/// log2 of the cells per side of a grid of tiles: 256 for a light of one face, 32 for those of a cube, where there may be hundreds; or more, while there are fewer
/// than a sixteenth of the words in a face's share of the pool, where every level costs a miss of the cache.
pub(crate) fn flat_log2(log2_cells: u32, words_per_face: usize) -> u32 {
    let least = if log2_cells == MAX_LOG2_CELLS { 8 } else { log2_cells + 1 };
    (words_per_face / 16).checked_ilog2().map_or(least, |log2| least.max(log2 / 2))
}

/// References to the nodes at the level with min(32, N/8) nodes per side (or fewer, where many grids are made), x fastest,
/// z slowest: 128 KiB at N >= 256. A homogeneous face has a single cell.
///
/// Of silhouettes cells are tiles, and each has a second word: the slice up to which all of it is lit, and in the upper half that from which on
/// all is shadowed, both in units of 2^`bounds_shift` slices. They answer for most points, of surfaces or in the air, without a descent. Bounds of four
/// cells, of sixteen and so on up to the whole face follow, a word each: walks through the air need few steps.
#[derive(Clone, Debug)]
pub(crate) struct TopGrid {
    cells: Vec<u32>,
    log2_cells: u32,
    /// log2 of the words per cell.
    log2_words: u32,
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
        let cells = (0..side.pow(3))
            .map(|i| [i % side, i / side % side, i / (side * side)].map(|c| c << level))
            .map(|corner| descend(pool, root, log2_resolution, level, corner))
            .collect();
        let root = (root, log2_resolution);
        Self { cells, log2_cells, log2_words: 0, z_shift: level, level, bounds_shift: 0, root }
    }

    /// The same of silhouettes: cells are tiles, whose level that of the grid is at least.
    pub(crate) fn new_flat(pool: &[u32], root: u32, log2_resolution: u32, most_log2: u32, spread: Spread<'_>) -> Self {
        let most = if kind(root) == Kind::Inner { most_log2 } else { 0 };
        let log2_cells = most.min(log2_resolution - MASK_LEVEL);
        let level = log2_resolution - log2_cells;
        let side = 1u32 << log2_cells;
        let bounds_shift = bounds_shift(log2_resolution);
        let cell = |corner| {
            let (tile, _) = silhouette::descend(pool, root, log2_resolution, level, corner);
            let [least, greatest] = silhouette::bounds_below(pool, tile, level, corner, spread);
            let greatest = (greatest + ((1 << bounds_shift) - 1)) >> bounds_shift;
            [tile, (least >> bounds_shift) | (greatest << 16)]
        };
        let cells = (0..side * side).flat_map(|i| cell([i % side, i / side].map(|c| c << level))).collect();
        let root = (root, log2_resolution);
        let mut grid = Self { cells, log2_cells, log2_words: 1, z_shift: u32::BITS - 1, level, bounds_shift, root };
        for wider in 1..=log2_cells {
            let side = side >> wider;
            for i in 0..side * side {
                let corner = [i % side, i / side].map(|c| c << (level + wider));
                let half = 1 << (level + wider - 1);
                let part = |i: u32| grid.bounds(wider - 1, [corner[0] + (i & 1) * half, corner[1] + (i >> 1) * half]);
                let all = [1, 2, 3]
                    .map(part)
                    .into_iter()
                    .fold(part(0), |a, b| (a & 0xffff).min(b & 0xffff) | ((a >> 16).max(b >> 16) << 16));
                grid.cells.push(all);
            }
        }
        grid
    }

    /// The references, and of silhouettes the bounds.
    pub(crate) fn cells(&self) -> &[u32] {
        &self.cells
    }

    /// The node that holds a voxel of the light's volume.
    #[inline(always)]
    pub(crate) fn node(&self, voxel: [u32; 3]) -> u32 {
        self.cells[self.place(voxel)]
    }

    /// Where the cell that holds a voxel begins.
    #[inline(always)]
    fn place(&self, [x, y, z]: [u32; 3]) -> usize {
        let (level, bits) = (self.level, self.log2_cells);
        let cell = ((((z >> self.z_shift) << bits) + (y >> level)) << bits) + (x >> level);
        (cell << self.log2_words) as usize
    }

    /// Of silhouettes: the tile that holds a texel, and whether its slice z is all lit or all shadowed, where that is known.
    #[inline(always)]
    pub(crate) fn tile(&self, [x, y]: [u32; 2], z: u32) -> (u32, Option<bool>) {
        let place = self.place([x, y, 0]);
        (self.cells[place], self.settled(self.cells[place + 1], z))
    }

    /// Whether slice z is all lit or all shadowed, if bounds say so.
    #[inline(always)]
    fn settled(&self, bounds: u32, z: u32) -> Option<bool> {
        let z = z >> self.bounds_shift;
        let is_lit = z < bounds & 0xffff;
        (is_lit || z >= bounds >> 16).then_some(is_lit)
    }

    /// Of silhouettes: bounds of the square of 2^`wider` cells per side that holds a texel.
    #[inline]
    fn bounds(&self, wider: u32, [x, y]: [u32; 2]) -> u32 {
        if wider == 0 {
            return self.cells[self.place([x, y, 0]) + 1];
        }
        let log2 = self.log2_cells - wider;
        // Cells come first, then all squares that are smaller.
        let begin = (2 << (2 * self.log2_cells)) + ((1 << (2 * self.log2_cells)) - (4 << (2 * log2))) / 3;
        let level = self.level + wider;
        self.cells[begin + ((y >> level << log2) + (x >> level)) as usize]
    }

    /// Of silhouettes: whether slice z is all lit or all shadowed from one texel to another, if the least square that holds both says so.
    #[inline]
    pub(crate) fn is_lit_between(&self, first: [u32; 2], last: [u32; 2], z: u32) -> Option<bool> {
        let joint = u32::BITS - ((first[0] ^ last[0]) | (first[1] ^ last[1])).leading_zeros();
        let wider = joint.saturating_sub(self.level);
        self.settled(self.bounds(wider, first), z)
    }

    /// Of silhouettes: the widest square of cells about a texel which is known to be all lit or all shadowed in slice z: log2 of its texels per side, which of
    /// both, and where the slices begin and end in which it is.
    pub(crate) fn widest(&self, texel: [u32; 2], z: u32) -> Option<(u32, bool, [u32; 2])> {
        let mut found = None;
        for wider in 0..=self.log2_cells {
            let bounds = self.bounds(wider, texel);
            let Some(is_lit) = self.settled(bounds, z) else { break };
            let [least, greatest] = [bounds & 0xffff, bounds >> 16].map(|bound| bound << self.bounds_shift);
            found = Some((self.level + wider, is_lit, if is_lit { [0, least] } else { [greatest, 1 << self.root.1] }));
        }
        found
    }

    /// Of silhouettes: whether the cube of 2^`level` voxels per side that holds a voxel is all lit or all shadowed, where that is known; it is no larger
    /// than a cell.
    pub(crate) fn cube_is_lit(&self, [x, y, z]: [u32; 3], level: u32) -> Option<bool> {
        let first = z >> level << level;
        let [near, far] = [first, first + ((1 << level) - 1)].map(|z| self.tile([x, y], z).1);
        near.filter(|_| near == far)
    }
}

/// Bits by which bounds are shifted, so that N fits into 16.
fn bounds_shift(log2_resolution: u32) -> u32 {
    log2_resolution.saturating_sub(15)
}
