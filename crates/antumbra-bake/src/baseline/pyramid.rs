//! Min-max hierarchies of depths: for each block of 8 x 8 texels, and each square of twice, four times ... its side, the
//! least and the greatest of a number per texel.

use rayon::prelude::*;

/// Levels from blocks up.
pub(super) struct Pyramid {
    /// Level by level, the finest first: squares row by row, with their least and greatest.
    levels: Vec<Vec<[u32; 2]>>,
    /// log2 of the blocks per side.
    log2: u32,
}

impl Pyramid {
    /// Over `4^log2` blocks.
    pub fn new(log2: u32, block: impl Fn(usize) -> [u32; 2] + Send + Sync) -> Self {
        let finest: Vec<[u32; 2]> = (0..1usize << (2 * log2)).into_par_iter().map(block).collect();
        let mut levels = vec![finest];
        for log2_side in (0..log2).rev() {
            let finer = &levels[levels.len() - 1];
            let square = |i: usize| {
                let (x, y) = (i & ((1 << log2_side) - 1), i >> log2_side);
                let at = |dx: usize, dy: usize| finer[((2 * y + dy) << (log2_side + 1)) + 2 * x + dx];
                let four = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
                four.iter().fold([u32::MAX, 0], |[least, greatest], s| [least.min(s[0]), greatest.max(s[1])])
            };
            levels.push((0..1usize << (2 * log2_side)).into_par_iter().map(square).collect());
        }
        Self { levels, log2 }
    }

    /// Least and greatest over a square of 2^level blocks per side, numbered in such squares.
    pub fn range(&self, level: u32, x: u32, y: u32) -> [u32; 2] {
        self.levels[level as usize][((y << (self.log2 - level)) + x) as usize]
    }
}
