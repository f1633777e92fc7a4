//! A small grid of references that stands for a light's top levels (Kämpe et al. 2015, section 4): made when a file is
//! loaded, never stored.

use alloc::vec::Vec;

use super::{point::descend, silhouette};
use crate::format::dag8::{SHADOWED, SLICE_LEVEL};
use crate::format::silhouette::{Kind, MASK_LEVEL, kind};

/// log2 of the cells per side, where the light is large enough.
pub(crate) const MAX_LOG2_CELLS: u32 = 5;

/// log2 of the cells per side of a grid of tiles that takes about as much as one of cubes, 256 per side for a light of one face; or more,
/// while it stays below a sixteenth of a face's share of the pool, where every level costs a miss of the cache.
pub(crate) fn flat_log2(log2_cells: u32, words_per_face: usize) -> u32 {
    let least = if log2_cells == MAX_LOG2_CELLS { 8 } else { log2_cells * 3 / 2 };
    (words_per_face / 16).checked_ilog2().map_or(least, |log2| least.max(log2 / 2))
}

/// References to the nodes at the level with min(32, N/8) nodes per side (or fewer, where many grids are made), x fastest,
/// z slowest: 128 KiB at N >= 256. A homogeneous face has a single cell.
#[derive(Clone, Debug)]
pub(crate) struct TopGrid {
    cells: Vec<u32>,
    log2_cells: u32,
    /// Bits to shift a slice right by for its cell; so many that none is left where cells are tiles.
    z_shift: u32,
    /// log2 of the voxels per side of a cell's node.
    pub level: u32,
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
        Self { cells, log2_cells, z_shift: level, level, root: (root, log2_resolution) }
    }

    /// The same of silhouettes: cells are tiles, whose level that of the grid is at least.
    pub(crate) fn new_flat(pool: &[u32], root: u32, log2_resolution: u32, most_log2: u32) -> Self {
        let most = if kind(root) == Kind::Inner { most_log2 } else { 0 };
        let log2_cells = most.min(log2_resolution - MASK_LEVEL);
        let level = log2_resolution - log2_cells;
        let side = 1u32 << log2_cells;
        let corners = (0..side * side).map(|i| [i % side, i / side].map(|c| c << level));
        let cells = corners.map(|corner| silhouette::descend(pool, root, log2_resolution, level, corner).0).collect();
        Self { cells, log2_cells, z_shift: u32::BITS - 1, level, root: (root, log2_resolution) }
    }

    /// The references.
    pub(crate) fn cells(&self) -> &[u32] {
        &self.cells
    }

    /// The node that holds a voxel of the light's volume.
    #[inline(always)]
    pub(crate) fn node(&self, [x, y, z]: [u32; 3]) -> u32 {
        let (level, bits) = (self.level, self.log2_cells);
        self.cells[((((z >> self.z_shift) << bits) + (y >> level)) << bits) as usize + (x >> level) as usize]
    }
}
