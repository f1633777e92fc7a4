//! The least or the greatest of a depth map over squares: the papers' min-max hierarchy, one half at a time.

/// A depth map and its coarser levels.
pub(super) struct Pyramid {
    /// From the map itself to a single square.
    levels: Vec<Vec<u32>>,
    log2: u32,
    fold: fn(u32, u32) -> u32,
}

impl Pyramid {
    /// Of a map with 2^log2 texels per side, row by row; `fold` is the lesser or the greater of two.
    pub fn new(log2: u32, map: Vec<u32>, fold: fn(u32, u32) -> u32) -> Self {
        assert_eq!(map.len(), 1 << (2 * log2));
        let mut levels = vec![map];
        for level in 1..=log2 {
            levels.push(coarser(&levels[level as usize - 1], 1 << (log2 - level), fold));
        }
        Self { levels, log2, fold }
    }

    pub fn texel(&self, x: u32, y: u32) -> u32 {
        self.square(0, x, y)
    }

    /// Over a rectangle of texels (the last included), or a little more: over at most three squares each way.
    pub fn over(&self, first: [u32; 2], last: [u32; 2]) -> u32 {
        let side = 1 + (last[0] - first[0]).max(last[1] - first[1]);
        // The least level at which a square is half as wide, or wider; squares of the octree's own come out exact.
        let level = side.next_power_of_two().ilog2().saturating_sub(1);
        let span = |axis: usize| (first[axis] >> level)..=(last[axis] >> level);
        let squares = span(1).flat_map(|y| span(0).map(move |x| (x, y)));
        squares.map(|(x, y)| self.square(level, x, y)).reduce(self.fold).unwrap_or(0)
    }

    fn square(&self, level: u32, x: u32, y: u32) -> u32 {
        self.levels[level as usize][((y << (self.log2 - level)) + x) as usize]
    }
}

fn coarser(finer: &[u32], side: usize, fold: fn(u32, u32) -> u32) -> Vec<u32> {
    let square = |i: usize| {
        let at = 4 * side * (i / side) + 2 * (i % side);
        fold(fold(finer[at], finer[at + 1]), fold(finer[at + 2 * side], finer[at + 2 * side + 1]))
    };
    (0..side * side).map(square).collect()
}
