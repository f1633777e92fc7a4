//! Undefined regions, resolved the old way and the new.
//!
//! Both make a node lit where it holds only lit and undefined voxels, and shadowed where it holds only shadowed and
//! undefined ones. They differ in what is undefined elsewhere:
//!
//! - [`Sintorn2014`]: it is shadowed. So is a node that is undefined throughout, unless a greater one that holds it is
//!   lit. (Talk of the paper; Kämpe et al. 2015, section 3.4, say it again.)
//! - [`Kampe2015`], section 3.4: each 8 x 8 tile of texels gets the fewest masks, by stabbing at the closest exit: a tile is
//!   lit up to its closest exit; there all texels whose enter has been passed turn to shadow, and so on for the rest.

use rayon::prelude::*;

use super::intervals::Intervals;
use super::octree::{Cube, Volume};

/// The rule of Sintorn et al. 2014.
pub struct Sintorn2014<'a> {
    /// What is defined.
    pub intervals: &'a Intervals,
}

impl Volume for Sintorn2014<'_> {
    fn homogeneous(&self, cube: Cube) -> Option<bool> {
        if self.intervals.may_be_shadowed(cube.ends()) {
            return Some(false);
        }
        self.intervals.may_be_lit(cube.ends()).then_some(true)
    }

    fn slices(&self, [x, y, z]: [u32; 3]) -> [u64; 8] {
        core::array::from_fn(|i| resolve_2014(self.intervals.masks([x, y], z + i as u32)))
    }
}

/// The mask of a leaf of which some voxels must be lit and some may be.
pub(crate) fn resolve_2014([must, may]: [u64; 2]) -> u64 {
    if must != 0 && may == u64::MAX { u64::MAX } else { must }
}

/// The rule of Kämpe et al. 2015.
pub struct Kampe2015<'a> {
    intervals: &'a Intervals,
    /// For each tile, row by row.
    tiles: Vec<Vec<Stab>>,
}

/// From a slice on, which of a tile's texels are lit.
struct Stab {
    slice: u32,
    lit: u64,
}

impl<'a> Kampe2015<'a> {
    /// Makes all tiles' masks.
    #[must_use]
    pub fn new(intervals: &'a Intervals) -> Self {
        let log2_tiles = intervals.log2() - 3;
        let tile = |i: u32| stabs(intervals, [(i & ((1 << log2_tiles) - 1)) << 3, (i >> log2_tiles) << 3]);
        Self { intervals, tiles: (0..1u32 << (2 * log2_tiles)).into_par_iter().map(tile).collect() }
    }
}

impl Volume for Kampe2015<'_> {
    fn homogeneous(&self, cube: Cube) -> Option<bool> {
        // Lit first: the masks, too, stay lit as long as they may.
        if self.intervals.may_be_lit(cube.ends()) {
            return Some(true);
        }
        self.intervals.may_be_shadowed(cube.ends()).then_some(false)
    }

    fn slices(&self, [x, y, z]: [u32; 3]) -> [u64; 8] {
        let stabs = &self.tiles[(((y >> 3) << (self.intervals.log2() - 3)) + (x >> 3)) as usize];
        core::array::from_fn(|i| {
            let passed = stabs.partition_point(|stab| stab.slice <= z + i as u32);
            passed.checked_sub(1).map_or(u64::MAX, |last| stabs[last].lit)
        })
    }
}

/// The fewest masks of a tile, in the order of their slices.
fn stabs(intervals: &Intervals, [x, y]: [u32; 2]) -> Vec<Stab> {
    let texels = (0..64).map(|i| (intervals.enter(x + i % 8, y + i / 8), intervals.exit(x + i % 8, y + i / 8)));
    let mut waiting: Vec<(usize, (u32, u32))> = texels.enumerate().collect();
    let (mut lit, mut stabs) = (u64::MAX, Vec::new());
    while let Some(slice) =
        waiting.iter().map(|(_, (_, exit))| *exit).min().filter(|exit| exit >> intervals.log2() == 0)
    {
        waiting.retain(|(texel, (enter, _))| {
            let turns = *enter <= slice;
            lit &= !(u64::from(turns) << texel);
            !turns
        });
        stabs.push(Stab { slice, lit });
    }
    stabs
}
