//! Depth maps on the CPU: what the papers' pipelines get from a graphics card.
//!
//! A map is cut into bins of 64 x 64 texels, which threads fill side by side; a bin's depths stay in the nearest cache. In
//! a bin each triangle is drawn in blocks of 8 x 8 texels, all 64 at once in vector code, with the coverage and the depths
//! of our own leaves: the same lattice, the same slices, the same alpha masks.
//!
//! The exit depth is found by depth peeling (Kämpe et al. 2015, section 3.3): pass after pass finds, for each ray still inside
//! solids, the surface behind the last one, by drawing the bin's triangles again. Where the paper peels front and back
//! faces apart, a pass here takes all surfaces of the next slice and adds up their windings; so overlapping, touching and
//! nested solids come out as everywhere else in this crate.

use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use crate::columns::{Block, Build};
use crate::light_space::Resolution;

/// Texels per side of a bin.
pub(super) const BIN: u32 = 64;
/// Texels per side of a block.
const BLOCK: u32 = 8;
const BLOCKS: usize = ((BIN / BLOCK) * (BIN / BLOCK)) as usize;
/// Nothing is met.
pub(super) const NEVER: u32 = u32::MAX;

/// A square of texels whose depth maps are made at a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct MapTile {
    /// First texel.
    pub x: u32,
    /// First texel.
    pub y: u32,
    /// Texels per side: a multiple of [`BIN`].
    pub side: u32,
}

/// Enter and exit depths of a map tile, block after block: row by row of blocks, and of texels in each.
pub(super) struct DepthMaps {
    /// First shadowed slice.
    pub enter: Vec<[u32; 64]>,
    /// First slice that must be shadowed; `None` where nothing is free, and it is the enter depth.
    pub exit: Option<Vec<[u32; 64]>>,
    /// log2 of the blocks per side.
    pub log2_blocks: u32,
}

/// A bin's rays between two passes.
struct Bin {
    /// The last surface's slice.
    current: [[u32; 64]; BLOCKS],
    winding: [[u32; 64]; BLOCKS],
    /// Masks of rays that are inside a solid.
    inside: [[u32; 64]; BLOCKS],
}

/// The nearest surfaces of a pass.
struct Nearest {
    slice: [[u32; 64]; BLOCKS],
    /// Sum of windings at that slice.
    winding: [[u32; 64]; BLOCKS],
}

impl DepthMaps {
    /// Bytes that the maps of a tile take, and their binned triangles.
    pub fn bytes(side: u32, with_exit: bool, triangles: usize) -> u64 {
        let maps = if with_exit { 8 } else { 4 };
        u64::from(side) * u64::from(side) * (maps + 1) + 24 * triangles as u64
    }

    /// A block's place in the maps.
    pub fn place(&self, x: u32, y: u32) -> usize {
        ((y << self.log2_blocks) + x) as usize
    }

    /// Draws the enter depths of a tile.
    pub fn draw_enter(build: &Build<'_>, tile: MapTile, bins: &Bins) -> Self {
        let log2_blocks = (tile.side / BLOCK).ilog2();
        let mut enter = vec![[NEVER; 64]; 1 << (2 * log2_blocks)];
        bins.for_each_row(&mut enter, |bin, rows| {
            let nearest = Pass { build, bins, bin, behind: None }.run();
            for (block, slices) in nearest.slice.iter().enumerate() {
                let enter = slices.map(|slice| if slice == NEVER { NEVER } else { slice + 1 });
                if let Some(grid) = build.enters {
                    let [x, y] = bins.first_texel(bin);
                    let texel = [x + BLOCK * (block as u32 % 8), y + BLOCK * (block as u32 / 8)];
                    let ends = |[least, greatest]: [u32; 2], e: &u32| [least.min(*e), greatest.max(*e)];
                    grid.insert_block(texel, enter.iter().fold([NEVER, 0], ends));
                }
                *rows.block(bin, block) = enter;
            }
            (build.pause)();
        });
        Self { enter, exit: None, log2_blocks }
    }

    /// Peels the exit depths: where rays leave all solids.
    pub fn peel_exit(&mut self, build: &Build<'_>, bins: &Bins) {
        let mut exit = self.enter.clone();
        bins.for_each_row(&mut exit, |bin, rows| {
            let mut enter = [[NEVER; 64]; BLOCKS];
            (0..BLOCKS).for_each(|block| enter[block] = *rows.block(bin, block));
            let peeled = peel(build, bins, bin, &enter);
            (0..BLOCKS).for_each(|block| *rows.block(bin, block) = peeled[block]);
            (build.pause)();
        });
        self.exit = Some(exit);
    }
}

/// The exit depths of a bin, given its enter depths.
fn peel(build: &Build<'_>, bins: &Bins, bin: usize, enter: &[[u32; 64]; BLOCKS]) -> [[u32; 64]; BLOCKS] {
    let mut exit = *enter;
    let mut rays = Bin { current: [[0; 64]; BLOCKS], winding: [[0; 64]; BLOCKS], inside: [[u32::MAX; 64]; BLOCKS] };
    // The first pass meets the first surfaces again, for their windings.
    let mut nearest = Pass { build, bins, bin, behind: None }.run();
    loop {
        let mut any = 0;
        for block in 0..BLOCKS {
            for i in 0..64 {
                let (inside, slice) = (rays.inside[block][i] != 0, nearest.slice[block][i]);
                let winding = rays.winding[block][i].wrapping_add(nearest.winding[block][i]);
                let leaves = inside && (slice == NEVER || winding as i32 <= 0);
                if leaves {
                    // A ray that never leaves is free to its end.
                    exit[block][i] = if slice == NEVER { NEVER } else { slice.max(enter[block][i]) };
                }
                rays.inside[block][i] = if inside && !leaves { u32::MAX } else { 0 };
                rays.winding[block][i] = winding;
                rays.current[block][i] = slice;
                any |= rays.inside[block][i];
            }
        }
        if any == 0 {
            return exit;
        }
        nearest = Pass { build, bins, bin, behind: Some(&rays) }.run();
    }
}

/// One pass over a bin's triangles: for each ray the nearest surface, or the nearest behind its last one.
struct Pass<'a> {
    build: &'a Build<'a>,
    bins: &'a Bins,
    bin: usize,
    behind: Option<&'a Bin>,
}

impl Pass<'_> {
    fn run(self) -> Nearest {
        Arch::new().dispatch(self)
    }
}

impl WithSimd for Pass<'_> {
    type Output = Nearest;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Nearest {
        let mut nearest = Nearest { slice: [[NEVER; 64]; BLOCKS], winding: [[0; 64]; BLOCKS] };
        let (first, resolution) = (self.bins.first_texel(self.bin), self.build.resolution());
        for &triangle in self.bins.triangles(self.bin) {
            for block in self.bins.blocks_of(self.build, triangle, first, resolution) {
                let texel = [first[0] + BLOCK * (block as u32 % 8), first[1] + BLOCK * (block as u32 / 8)];
                let wanted = self.behind.map_or([u32::MAX; 64], |rays| rays.inside[block]);
                let Some(drawn) = Block::draw(self.build, triangle, texel, &wanted) else { continue };
                let (slices, windings) = (&mut nearest.slice[block], &mut nearest.winding[block]);
                for i in 0..64 {
                    let slice = drawn.slices[i];
                    let is_behind = self.behind.is_none_or(|rays| slice > rays.current[block][i]);
                    let counts = drawn.covered[i] != 0 && is_behind && slice <= slices[i];
                    let sum = if slice < slices[i] { 0 } else { windings[i] };
                    windings[i] = if counts { sum.wrapping_add(drawn.winding as u32) } else { windings[i] };
                    slices[i] = if counts { slice } else { slices[i] };
                }
            }
        }
        nearest
    }
}

/// A tile's triangles by bin.
pub(super) struct Bins {
    tile: MapTile,
    /// log2 of the bins per side.
    log2: u32,
    /// Where each bin's triangles begin, and the last one's end.
    begins: Vec<u32>,
    triangles: Vec<u32>,
}

/// A row of bins' blocks.
pub(super) struct Rows<'a> {
    blocks: &'a mut [[u32; 64]],
    log2_blocks: u32,
    log2_bins: u32,
}

impl Rows<'_> {
    fn block(&mut self, bin: usize, block: usize) -> &mut [u32; 64] {
        let column = bin & ((1 << self.log2_bins) - 1);
        &mut self.blocks[((block / 8) << self.log2_blocks) + 8 * column + block % 8]
    }
}

impl Bins {
    /// Sorts the triangles whose boxes touch a tile into bins.
    pub fn new(build: &Build<'_>, tile: MapTile) -> Self {
        let log2 = (tile.side / BIN).ilog2();
        let mut bins = Self { tile, log2, begins: Vec::new(), triangles: Vec::new() };
        let spans: Vec<(u32, [[u32; 2]; 2])> = (0..build.triangles.len() as u32)
            .into_par_iter()
            .filter_map(|triangle| Some((triangle, bins.span(build, triangle)?)))
            .collect();
        let mut begins = vec![0u32; (1 << (2 * log2)) + 1];
        let cells = |[columns, rows]: [[u32; 2]; 2]| {
            (rows[0]..=rows[1])
                .flat_map(move |row| (columns[0]..=columns[1]).map(move |c| ((row << log2) + c) as usize))
        };
        spans.iter().for_each(|(_, span)| cells(*span).for_each(|cell| begins[cell + 1] += 1));
        (1..begins.len()).for_each(|cell| begins[cell] += begins[cell - 1]);
        let mut next = begins.clone();
        bins.triangles = vec![0; begins[begins.len() - 1] as usize];
        for (triangle, span) in spans {
            for cell in cells(span) {
                bins.triangles[next[cell] as usize] = triangle;
                next[cell] += 1;
            }
        }
        bins.begins = begins;
        bins
    }

    /// Columns and rows of bins that a triangle's box touches.
    fn span(&self, build: &Build<'_>, triangle: u32) -> Option<[[u32; 2]; 2]> {
        let texels = build.triangles[triangle as usize].texels(build.resolution())?;
        let clipped = |[first, last]: [i64; 2], begin: u32| {
            let (begin, end) = (i64::from(begin), i64::from(begin + self.tile.side) - 1);
            let (first, last) = (first.max(begin) - begin, last.min(end) - begin);
            (first <= last).then_some([first as u32 / BIN, last as u32 / BIN])
        };
        Some([clipped(texels[0], self.tile.x)?, clipped(texels[1], self.tile.y)?])
    }

    /// Triangles in all bins together.
    pub fn length(&self) -> usize {
        self.triangles.len()
    }

    fn triangles(&self, bin: usize) -> &[u32] {
        &self.triangles[self.begins[bin] as usize..self.begins[bin + 1] as usize]
    }

    fn first_texel(&self, bin: usize) -> [u32; 2] {
        let mask = (1 << self.log2) - 1;
        [self.tile.x + BIN * (bin as u32 & mask), self.tile.y + BIN * (bin as u32 >> self.log2)]
    }

    /// The blocks of a bin that a triangle's box touches.
    fn blocks_of(
        &self,
        build: &Build<'_>,
        triangle: u32,
        first: [u32; 2],
        resolution: Resolution,
    ) -> impl Iterator<Item = usize> + use<> {
        let texels = build.triangles[triangle as usize].texels(resolution).unwrap_or([[0, -1]; 2]);
        let clipped = |axis: usize| {
            let begin = i64::from(first[axis]);
            let [low, high] = texels[axis].map(|texel| (texel - begin).clamp(-1, i64::from(BIN)));
            (low.max(0) / 8, high.min(i64::from(BIN) - 1).div_euclid(8))
        };
        let ((left, right), (top, bottom)) = (clipped(0), clipped(1));
        (top..=bottom).flat_map(move |row| (left..=right).map(move |column| (8 * row + column) as usize))
    }

    /// Calls `each` with every bin and the blocks of its row, rows of bins side by side on threads.
    fn for_each_row(&self, blocks: &mut [[u32; 64]], each: impl Fn(usize, &mut Rows<'_>) + Sync) {
        let log2_blocks = (self.tile.side / BLOCK).ilog2();
        let of_row = 8usize << log2_blocks;
        blocks.par_chunks_mut(of_row).enumerate().for_each(|(row, blocks)| {
            let mut rows = Rows { blocks, log2_blocks, log2_bins: self.log2 };
            (0..1usize << self.log2).for_each(|column| each((row << self.log2) + column, &mut rows));
        });
    }
}
