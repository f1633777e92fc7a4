//! Depth maps on the CPU: what the papers' pipelines get from a graphics card.
//!
//! A map is cut into bins of 64 x 64 texels, which threads fill side by side; a bin's depths stay in the nearest cache. In
//! a bin each triangle is drawn in blocks of 8 x 8 texels, all 64 at once in vector code, with the coverage and the depths
//! of our own leaves: the same lattice, the same slices, the same alpha masks.
//!
//! The exit depth is found by depth peeling (Kämpe et al. 2015, section 3.3): pass after pass finds, for each ray still inside
//! solids, the surface behind the last one. Where the paper draws all triangles in every pass, a bin's are drawn once and
//! what they show is kept. Where it peels front and back faces apart, a pass here takes all surfaces of the next slice and
//! adds up their windings; so overlapping, touching and nested solids come out as everywhere else in this crate.

use pulp::{Simd, WithSimd};
use rayon::prelude::*;

use super::pyramid::Pyramid;
use crate::columns::{Block, Build, mask, select};
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

/// The nearest surfaces of a pass over a bin.
struct Nearest {
    slice: [[u32; 64]; BLOCKS],
    /// Sum of windings at that slice.
    winding: [[u32; 64]; BLOCKS],
}

/// A bin's rays between two passes.
struct Rays {
    /// The last surface's slice plus 1; nothing is met before.
    behind: [[u32; 64]; BLOCKS],
    winding: [[u32; 64]; BLOCKS],
    /// Masks of rays that are inside a solid.
    inside: [[u32; 64]; BLOCKS],
}

impl DepthMaps {
    /// Bytes that the maps of a tile take, with their hierarchy and what a bin's triangles show.
    pub fn bytes(side: u32, with_exit: bool) -> u64 {
        let maps = if with_exit { 8 } else { 4 };
        u64::from(side) * u64::from(side) * (maps + 1)
    }

    /// A block's place in the maps.
    pub fn place(&self, x: u32, y: u32) -> usize {
        ((y << self.log2_blocks) + x) as usize
    }

    /// The min-max hierarchy: least exits and greatest enters.
    pub fn pyramid(&self) -> Pyramid {
        let exit = self.exit.as_ref().unwrap_or(&self.enter);
        Pyramid::new(self.log2_blocks, |block| {
            let least = exit[block].iter().fold(NEVER, |least, exit| least.min(*exit));
            [least, self.enter[block].iter().fold(0, |greatest, enter| greatest.max(*enter))]
        })
    }

    /// Draws the enter depths of a tile.
    pub fn draw_enter(build: &Build<'_>, tile: MapTile, bins: &Bins) -> Self {
        let log2_blocks = (tile.side / BLOCK).ilog2();
        let mut enter = vec![[NEVER; 64]; 1 << (2 * log2_blocks)];
        bins.for_each_row(&mut enter, |bin, rows| {
            let first = build.arch().dispatch(FirstSurfaces { build, bins, bin });
            for (block, slices) in first.iter().enumerate() {
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
            let peeled = build.arch().dispatch(Peel { build, bins, bin, enter: &enter });
            (0..BLOCKS).for_each(|block| *rows.block(bin, block) = peeled[block]);
            (build.pause)();
        });
        self.exit = Some(exit);
    }
}

/// Peels a bin: its exit depths, given its enter depths. What the triangles show is drawn once and kept: each pass looks for
/// the next surface in it.
struct Peel<'a> {
    build: &'a Build<'a>,
    bins: &'a Bins,
    bin: usize,
    enter: &'a [[u32; 64]; BLOCKS],
}

impl WithSimd for Peel<'_> {
    type Output = [[u32; 64]; BLOCKS];

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let mut exit = *self.enter;
        let nothing = [[0; 64]; BLOCKS];
        let mut rays = Rays { behind: nothing, winding: nothing, inside: [[u32::MAX; 64]; BLOCKS] };
        let mut drawn: Vec<(usize, Block)> = Vec::new();
        self.bins.for_each_fragment(self.build, self.bin, |block, fragment| drawn.push((block, fragment)));
        let mut left: Vec<u32> = (0..drawn.len() as u32).collect();
        loop {
            let nearest = rays.next_surfaces(left.iter().map(|&i| &drawn[i as usize]));
            if !rays.pass(&nearest, self.enter, &mut exit) {
                return exit;
            }
            // Open surfaces count only where they come first; what lies in front of all rays is passed.
            left.retain(|&i| {
                let (block, fragment) = &drawn[i as usize];
                fragment.winding != 0 && rays.may_meet(*block, fragment)
            });
        }
    }
}

impl Rays {
    /// For each ray that is inside, the nearest surface that it has not met.
    #[inline(always)]
    fn next_surfaces<'a>(&self, drawn: impl Iterator<Item = &'a (usize, Block)>) -> Nearest {
        let mut nearest = Nearest { slice: [[NEVER; 64]; BLOCKS], winding: [[0; 64]; BLOCKS] };
        for (block, fragment) in drawn {
            let (inside, behind) = (&self.inside[*block], &self.behind[*block]);
            let (slices, windings) = (&mut nearest.slice[*block], &mut nearest.winding[*block]);
            for i in 0..64 {
                let slice = fragment.slices[i];
                let is_met =
                    mask(fragment.covered[i] & inside[i] != 0) & mask(slice >= behind[i]) & mask(slice <= slices[i]);
                let sum = windings[i] & mask(slice == slices[i]);
                windings[i] = select(is_met, sum.wrapping_add(fragment.winding as u32), windings[i]);
                slices[i] = select(is_met, slice, slices[i]);
            }
        }
        nearest
    }

    /// Moves all rays behind their next surfaces; whether any is still inside a solid. Of those that leave, the exit is set; a
    /// ray that never leaves is free to its end.
    #[inline(always)]
    fn pass(&mut self, nearest: &Nearest, enter: &[[u32; 64]; BLOCKS], exit: &mut [[u32; 64]; BLOCKS]) -> bool {
        let mut any = 0;
        for block in 0..BLOCKS {
            for i in 0..64 {
                let (inside, slice) = (self.inside[block][i], nearest.slice[block][i]);
                let winding = self.winding[block][i].wrapping_add(nearest.winding[block][i]);
                let leaves = inside & (mask(slice == NEVER) | mask(winding as i32 <= 0));
                let at = slice.max(enter[block][i]);
                exit[block][i] = select(leaves, at, exit[block][i]);
                self.inside[block][i] = inside & !leaves;
                self.winding[block][i] = winding;
                self.behind[block][i] = slice.saturating_add(1);
                any |= inside & !leaves;
            }
        }
        any != 0
    }

    /// Whether a ray that is inside a solid may yet meet a fragment.
    #[inline(always)]
    fn may_meet(&self, block: usize, fragment: &Block) -> bool {
        let (inside, behind) = (&self.inside[block], &self.behind[block]);
        let mut any = 0;
        for i in 0..64 {
            any |= inside[i] & fragment.covered[i] & mask(fragment.slices[i] >= behind[i]);
        }
        any != 0
    }
}

/// Draws a bin's first surfaces.
struct FirstSurfaces<'a> {
    build: &'a Build<'a>,
    bins: &'a Bins,
    bin: usize,
}

impl WithSimd for FirstSurfaces<'_> {
    /// Slices by block.
    type Output = [[u32; 64]; BLOCKS];

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let mut slices = [[NEVER; 64]; BLOCKS];
        self.bins.for_each_fragment(self.build, self.bin, |block, fragment| {
            for (slice, (new, covered)) in slices[block].iter_mut().zip(fragment.slices.iter().zip(fragment.covered)) {
                *slice = (*slice).min(*new | !covered);
            }
        });
        slices
    }
}

/// A tile's triangles by bin.
pub(super) struct Bins {
    tile: MapTile,
    /// log2 of the bins per side.
    log2: u32,
    /// Where each bin's triangles begin, and the last one's end.
    begins: Vec<usize>,
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
    /// Sorts the triangles whose boxes touch a tile into bins; `None` if that takes more than so many bytes.
    pub fn new(build: &Build<'_>, tile: MapTile, limit: u64) -> Option<Self> {
        let log2 = (tile.side / BIN).ilog2();
        let mut bins = Self { tile, log2, begins: Vec::new(), triangles: Vec::new() };
        let spans: Vec<(u32, [[u32; 2]; 2])> = (0..build.triangles.len() as u32)
            .into_par_iter()
            .filter_map(|triangle| Some((triangle, bins.span(build, triangle)?)))
            .collect();
        let mut begins = vec![0usize; (1 << (2 * log2)) + 1];
        let cells = |[columns, rows]: [[u32; 2]; 2]| {
            (rows[0]..=rows[1])
                .flat_map(move |row| (columns[0]..=columns[1]).map(move |c| ((row << log2) + c) as usize))
        };
        spans.iter().for_each(|(_, span)| cells(*span).for_each(|cell| begins[cell + 1] += 1));
        (1..begins.len()).for_each(|cell| begins[cell] += begins[cell - 1]);
        let bytes = 4 * begins[begins.len() - 1] + 16 * begins.len() + size_of_val(&spans[..]);
        if bytes as u64 > limit {
            return None;
        }
        let mut next = begins.clone();
        bins.triangles = vec![0; begins[begins.len() - 1]];
        for (triangle, span) in spans {
            for cell in cells(span) {
                bins.triangles[next[cell]] = triangle;
                next[cell] += 1;
            }
        }
        bins.begins = begins;
        Some(bins)
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

    fn triangles(&self, bin: usize) -> &[u32] {
        &self.triangles[self.begins[bin]..self.begins[bin + 1]]
    }

    fn first_texel(&self, bin: usize) -> [u32; 2] {
        let mask = (1 << self.log2) - 1;
        [self.tile.x + BIN * (bin as u32 & mask), self.tile.y + BIN * (bin as u32 >> self.log2)]
    }

    /// Calls `each` with what every triangle of a bin shows in every block.
    #[inline(always)]
    fn for_each_fragment(&self, build: &Build<'_>, bin: usize, mut each: impl FnMut(usize, Block)) {
        let (first, resolution) = (self.first_texel(bin), build.resolution());
        for &triangle in self.triangles(bin) {
            for block in self.blocks_of(build, triangle, first, resolution) {
                let texel = [first[0] + BLOCK * (block as u32 % 8), first[1] + BLOCK * (block as u32 / 8)];
                if let Some(fragment) = Block::draw(build, triangle, texel, &[u32::MAX; 64]) {
                    each(block, fragment);
                }
            }
        }
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
