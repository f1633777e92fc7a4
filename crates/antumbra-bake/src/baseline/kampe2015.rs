//! Kämpe, Sintorn, Assarsson 2015, *Fast, memory-efficient construction of voxelized shadows*, section 3.
//!
//! Per map tile: enter and exit depths; for every 8 x 8 texels the fewest visibility masks, by the closest exit (section
//! 3.4); a min-max hierarchy of the depths that the masks stand for; then top-down construction in z-order. A volume that
//! is identical to the one in front of it, because no surface lies in either, uses that one's node again (section 3.2):
//! every completed node keeps the depth of the next surface behind its beginning.
//!
//! Where the time goes: at small resolutions of closed scenes in peeling exit depths, as in the paper; of open ones in
//! inserting and merging nodes along the surfaces.

use rayon::prelude::*;

use super::pyramid::Pyramid;
use super::raster::{DepthMaps, NEVER};
use super::topdown::{Cube, Voxels};
use crate::columns::Block;

/// A map tile's visibility masks and the hierarchy above them.
pub(super) struct Masks {
    /// Where each block's masks begin, and the last one's end.
    begins: Vec<u32>,
    /// From a slice on, which rays are lit.
    masks: Vec<(u32, u64)>,
    log2_blocks: u32,
}

impl Masks {
    /// The fewest masks of every block.
    pub fn new(maps: &DepthMaps, slices: u32) -> Self {
        let exit = maps.exit.as_ref().unwrap_or(&maps.enter);
        let of_block: Vec<Vec<(u32, u64)>> =
            maps.enter.par_iter().zip(exit).map(|(enter, exit)| Block::stab(*enter, *exit, slices)).collect();
        let mut begins = Vec::with_capacity(of_block.len() + 1);
        begins.push(0);
        for masks in &of_block {
            begins.push(begins[begins.len() - 1] + masks.len() as u32);
        }
        Self { begins, masks: of_block.concat(), log2_blocks: maps.log2_blocks }
    }

    /// Bytes that a map tile's masks may take, when each block has as many as its texels allow.
    pub fn bytes(&self) -> u64 {
        (16 * self.masks.len() + 4 * self.begins.len()) as u64
    }

    fn of_block(&self, block: usize) -> &[(u32, u64)] {
        &self.masks[self.begins[block] as usize..self.begins[block + 1] as usize]
    }
}

/// Masks with their min-max hierarchy.
pub(super) struct Kampe2015 {
    masks: Masks,
    pyramid: Pyramid,
}

impl Kampe2015 {
    pub fn new(masks: Masks) -> Self {
        let ends = |block: usize| {
            let masks = masks.of_block(block);
            let last = masks.last().map_or(NEVER, |(slice, lit)| if *lit == 0 { *slice } else { NEVER });
            [masks.first().map_or(NEVER, |(slice, _)| *slice), last]
        };
        let pyramid = Pyramid::new(masks.log2_blocks, ends);
        Self { masks, pyramid }
    }
}

impl Voxels for Kampe2015 {
    fn homogeneous(&self, cube: Cube) -> Option<(bool, u32)> {
        let [least, greatest] = self.pyramid.range(cube.level - 3, cube.x, cube.y);
        if least >= cube.end() {
            return Some((true, least));
        }
        (greatest <= cube.z).then_some((false, NEVER))
    }

    fn slices(&self, cube: Cube) -> ([u64; 8], u32) {
        let masks = self.masks.of_block(((cube.y << self.masks.log2_blocks) + cube.x) as usize);
        let passed = |z: u32| masks.partition_point(|(slice, _)| *slice <= z);
        let slices = core::array::from_fn(|i| match passed(cube.z + i as u32) {
            0 => u64::MAX,
            behind => masks[behind - 1].1,
        });
        (slices, masks.get(passed(cube.z)).map_or(NEVER, |(slice, _)| *slice))
    }
}
