//! The same shadows in world space: an octree over a cube along the world's axes instead of the light's (Sintorn et al.
//! 2014 try this first, and leave it because nothing repeats along a slanted shadow volume).
//!
//! A world voxel is what the light's voxel at its middle is: lit, shadowed or undefined, by the light's intervals at a
//! resolution at least as fine. Where nothing is undefined that is what `LightShadow::visibility_many` of a bake says.
//! Undefined regions are resolved by the rule of 2014, in the world's own nodes.
//!
//! Pruning: the eight corners of a cube of world voxels span a box in light space; if all of that box may be lit, or all may
//! be shadowed, so may the cube, and nothing in it is looked at.

use antumbra::LightShadow;
use antumbra_scene::Bounds;
use glam::DVec3;

use super::intervals::Intervals;
use super::octree::{Cube, Volume};
use super::undefined::resolve_2014;

/// Voxels along the world's axes.
#[derive(Clone, Copy, Debug)]
pub struct WorldGrid {
    /// Its least corner, world metres.
    pub corner_m: DVec3,
    /// Side of a voxel.
    pub voxel_m: f64,
    /// log2 of the voxels per side.
    pub log2: u32,
}

impl WorldGrid {
    /// The least cube about a box, which lies in its middle.
    #[must_use]
    pub fn about(bounds: Bounds, log2: u32) -> Self {
        let side_m = (bounds.max - bounds.min).max_element();
        let corner_m = (bounds.min + bounds.max - DVec3::splat(side_m)) * 0.5;
        Self { corner_m, voxel_m: side_m / f64::from(1u32 << log2), log2 }
    }

    /// The middle of a voxel, world metres.
    #[must_use]
    pub fn center(&self, voxel: [u32; 3]) -> DVec3 {
        self.corner_m + (DVec3::from(voxel.map(f64::from)) + 0.5) * self.voxel_m
    }
}

/// A directional light's shadows on a world grid.
pub struct WorldVolume<'a> {
    /// The grid.
    pub grid: WorldGrid,
    /// A bake of the light, for its projection.
    pub light: LightShadow<'a>,
    /// The light's intervals, at the bake's resolution.
    pub intervals: &'a Intervals,
}

impl WorldVolume<'_> {
    fn light_voxel(&self, voxel: [u32; 3]) -> DVec3 {
        self.light.project(self.grid.center(voxel)).voxel
    }

    /// Slices of the light, and the last for all that lies behind it.
    fn slice(&self, z: f64) -> u32 {
        (z as u32).min((1 << self.intervals.log2()) - 1)
    }

    /// Whether a world voxel must be lit and whether it may be.
    fn state(&self, voxel: [u32; 3]) -> [bool; 2] {
        let side = f64::from(1u32 << self.intervals.log2());
        let at = self.light_voxel(voxel);
        if at.min_element() < 0.0 || at.x >= side || at.y >= side {
            return [true; 2];
        }
        let (x, y, z) = (at.x as u32, at.y as u32, self.slice(at.z));
        [z < self.intervals.enter(x, y), z < self.intervals.exit(x, y)]
    }
}

impl Volume for WorldVolume<'_> {
    fn homogeneous(&self, cube: Cube) -> Option<bool> {
        let [first, last] = cube.ends();
        let corner = |i: usize| core::array::from_fn(|axis| if i >> axis & 1 == 0 { first[axis] } else { last[axis] });
        let corners: [DVec3; 8] = core::array::from_fn(|i| self.light_voxel(corner(i)));
        let (min, max) = corners.iter().fold((corners[0], corners[0]), |(min, max), c| (min.min(*c), max.max(*c)));
        let side = f64::from(1u32 << self.intervals.log2());
        if max.min_element() < 0.0 || min.x >= side || min.y >= side {
            return Some(true);
        }
        let is_inside = min.min_element() >= 0.0 && max.x < side && max.y < side;
        // A cast of what is negative gives 0.
        let index = |v: f64| (v as u32).min((1 << self.intervals.log2()) - 1);
        let ends = [min, max].map(|p| [index(p.x), index(p.y), index(p.z)]);
        if is_inside && self.intervals.may_be_shadowed(ends) {
            return Some(false);
        }
        self.intervals.may_be_lit(ends).then_some(true)
    }

    fn slices(&self, [x, y, z]: [u32; 3]) -> [u64; 8] {
        core::array::from_fn(|slice| {
            let mut masks = [0; 2];
            for i in 0..64u32 {
                let state = self.state([x + i % 8, y + i / 8, z + slice as u32]);
                masks[0] |= u64::from(state[0]) << i;
                masks[1] |= u64::from(state[1]) << i;
            }
            resolve_2014(masks)
        })
    }
}
