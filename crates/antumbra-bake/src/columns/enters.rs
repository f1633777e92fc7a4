//! Coarse bounds of enter depths, collected while tiles are settled: the `ENTR` section.

use std::sync::atomic::{AtomicU32, Ordering};

use antumbra::format::enter::{self, Cell, NONE};

use super::tile::Tile;
use crate::light_space::Resolution;

/// A ray without casters.
const NEVER: u32 = u32::MAX;

/// One face's cells. Tiles may come in any order and from any thread: least and greatest do not depend on it.
pub struct EnterGrid {
    least: Vec<AtomicU32>,
    greatest: Vec<AtomicU32>,
    log2_cells: u32,
    resolution: Resolution,
}

impl EnterGrid {
    /// Cells that have met nothing yet.
    #[must_use]
    pub fn new(resolution: Resolution) -> Self {
        let log2_cells = enter::log2_cells(resolution.log2());
        let cells = 1usize << (2 * log2_cells);
        Self {
            least: (0..cells).map(|_| AtomicU32::new(NEVER)).collect(),
            greatest: (0..cells).map(|_| AtomicU32::new(0)).collect(),
            log2_cells,
            resolution,
        }
    }

    /// Bytes that a face of this resolution takes.
    #[must_use]
    pub fn bytes(resolution: Resolution) -> u64 {
        8 << (2 * enter::log2_cells(resolution.log2()))
    }

    /// All rays of a tile are first shadowed in a slice from `least` to `greatest`.
    pub(super) fn insert(&self, tile: Tile, [least, greatest]: [u32; 2]) {
        let shift = self.cell_log2();
        let side = (1 << tile.log2 >> shift).max(1);
        for y in 0..side {
            for x in 0..side {
                let cell = ((((tile.y >> shift) + y) << self.log2_cells) + (tile.x >> shift) + x) as usize;
                self.least[cell].fetch_min(least, Ordering::Relaxed);
                self.greatest[cell].fetch_max(greatest, Ordering::Relaxed);
            }
        }
    }

    /// The same for 8 x 8 texels.
    pub(crate) fn insert_block(&self, [x, y]: [u32; 2], span: [u32; 2]) {
        self.insert(Tile { x, y, log2: 3 }, span);
    }

    /// The finished cells in stored units.
    #[must_use]
    pub fn cells(&self) -> Vec<Cell> {
        let shift = enter::shift(self.resolution.log2());
        let n = self.resolution.texels();
        let stored = |slice: u32, round_up: u32| if slice >= n { NONE } else { ((slice + round_up) >> shift) as u16 };
        let up = (1 << shift) - 1;
        let cell = |(least, greatest): (&AtomicU32, &AtomicU32)| Cell {
            least: stored(least.load(Ordering::Relaxed), 0),
            greatest: stored(greatest.load(Ordering::Relaxed), up),
        };
        self.least.iter().zip(&self.greatest).map(cell).collect()
    }

    /// log2 of a cell's texels per side.
    pub(crate) fn cell_log2(&self) -> u32 {
        self.resolution.log2() - self.log2_cells
    }

    /// log2 of the cells per side.
    #[must_use]
    pub fn log2_cells(&self) -> u32 {
        self.log2_cells
    }
}
