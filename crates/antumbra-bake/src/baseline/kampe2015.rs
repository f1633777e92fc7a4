//! Kämpe, Sintorn, Assarsson 2015, *Fast, memory-efficient construction of voxelized shadows*, section 3.
//!
//! Per map tile: enter and exit depths; for every 8 x 8 texels the fewest visibility masks, by the closest exit (section
//! 3.4); a min-max hierarchy of the depths; then top-down construction in z-order. A volume is lit throughout where all of
//! it may be, else shadowed where all of it may be. One that is identical to the volume in front of it, because no surface
//! lies in either, uses that one's node again (section 3.2): every completed node keeps the depth of the next surface
//! behind its beginning.
//!
//! Where the time goes: at small resolutions of closed scenes in peeling exit depths, as in the paper; of open ones in
//! inserting and merging nodes along the surfaces.

use std::sync::atomic::{AtomicU64, Ordering};

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
    /// The fewest masks of every block; `None` if they take more than so many bytes while they are made.
    pub fn new(maps: &DepthMaps, slices: u32, limit: u64) -> Option<Self> {
        let exit = maps.exit.as_ref().unwrap_or(&maps.enter);
        let row = 1 << maps.log2_blocks;
        let taken = AtomicU64::new(4 * maps.enter.len() as u64);
        // Row by row: how many masks each block has, and all of them.
        let rows = maps.enter.par_chunks(row).zip(exit.par_chunks(row)).map(|(enter, exit)| {
            let (mut lengths, mut masks) = (Vec::with_capacity(row), Vec::new());
            for (enter, exit) in enter.iter().zip(exit) {
                let of_block = Block::stab(*enter, *exit, slices);
                lengths.push(of_block.len() as u32);
                masks.extend(of_block);
            }
            // They are there twice for a moment, and arrays that grow have room to spare.
            let bytes = 3 * size_of_val(&masks[..]) as u64;
            (taken.fetch_add(bytes, Ordering::Relaxed) + bytes <= limit).then_some((lengths, masks))
        });
        let rows = rows.collect::<Option<Vec<_>>>()?;
        let mut begins = Vec::with_capacity(maps.enter.len() + 1);
        begins.push(0);
        rows.iter().flat_map(|(lengths, _)| lengths).for_each(|length| begins.push(begins[begins.len() - 1] + length));
        let mut masks = Vec::with_capacity(begins[begins.len() - 1] as usize);
        rows.into_iter().for_each(|(_, of_row)| masks.extend(of_row));
        Some(Self { begins, masks, log2_blocks: maps.log2_blocks })
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
    /// From masks and the hierarchy of the depths that they were made of.
    pub fn new(masks: Masks, pyramid: Pyramid) -> Self {
        Self { masks, pyramid }
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        // A block has a beginning and, with the levels above, a third more than one pair in the hierarchy.
        (16 * self.masks.masks.len() + 16 * self.masks.begins.len()) as u64
    }
}

impl Voxels for Kampe2015 {
    fn homogeneous(&self, cube: Cube) -> Option<(bool, u32)> {
        let [least_exit, greatest_enter] = self.pyramid.range(cube.level - 3, cube.x, cube.y);
        if least_exit >= cube.end() {
            return Some((true, least_exit));
        }
        (greatest_enter <= cube.z).then_some((false, NEVER))
    }

    fn shadowed_from(&self, cube: Cube) -> u32 {
        self.pyramid.range(cube.level - 3, cube.x, cube.y)[1]
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
