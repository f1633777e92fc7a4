//! Sintorn, Kämpe, Olsson, Assarsson 2014, *Compact precomputed voxelized shadows*: top-down from depth maps and their
//! min-max hierarchy, every node inserted, equal ones merged afterwards.
//!
//! Undefined voxels, in closed objects, make a volume shadowed where nothing in it must be lit, else lit where all of it
//! may be; where neither is so they count as shadowed.
//!
//! Where the time goes: in inserting and merging the nodes along boundaries in mid-air, which are there again and again from
//! front to back.

use super::pyramid::Pyramid;
use super::raster::{DepthMaps, NEVER};
use super::topdown::{Cube, Voxels};
use crate::ablation::undefined::resolve_2014;

/// Depth maps with their min-max hierarchy.
pub(super) struct Sintorn2014 {
    maps: DepthMaps,
    /// Least exit and greatest enter.
    pyramid: Pyramid,
}

impl Sintorn2014 {
    pub fn new(maps: DepthMaps) -> Self {
        let exit = maps.exit.as_ref().unwrap_or(&maps.enter);
        let ends = |block: usize| {
            let least = exit[block].iter().fold(NEVER, |least, exit| least.min(*exit));
            [least, maps.enter[block].iter().fold(0, |greatest, enter| greatest.max(*enter))]
        };
        let pyramid = Pyramid::new(maps.log2_blocks, ends);
        Self { maps, pyramid }
    }
}

impl Voxels for Sintorn2014 {
    fn homogeneous(&self, cube: Cube) -> Option<(bool, u32)> {
        let [least_exit, greatest_enter] = self.pyramid.range(cube.level - 3, cube.x, cube.y);
        if greatest_enter <= cube.z {
            return Some((false, NEVER));
        }
        // Nodes are not culled: where the next surface lies does not matter.
        (least_exit >= cube.end()).then_some((true, NEVER))
    }

    fn slices(&self, cube: Cube) -> ([u64; 8], u32) {
        let block = self.maps.place(cube.x, cube.y);
        let enter = &self.maps.enter[block];
        let exit = self.maps.exit.as_ref().map_or(enter, |exit| &exit[block]);
        let before = |depths: &[u32; 64], z: u32| {
            depths.iter().enumerate().fold(0u64, |lit, (i, depth)| lit | (u64::from(z < *depth) << i))
        };
        let slices = core::array::from_fn(|i| {
            let z = cube.z + i as u32;
            resolve_2014([before(enter, z), before(exit, z)])
        });
        (slices, NEVER)
    }
}
