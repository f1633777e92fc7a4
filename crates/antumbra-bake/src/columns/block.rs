//! What of a leaf's work others need as well: one triangle over 8 x 8 texels, and the fewest masks for 64 intervals.

use pulp::Arch;

use super::build::Build;
use super::lanes::{Lanes, any};
use super::leaf::{Leaf, Stab, Transition};
use super::tile::{Tile, root_entry};

/// A triangle over a block of 8 x 8 texels; ray 8*y + x is number 8*y + x.
pub(crate) struct Block {
    /// Mask of the rays that it covers: all bits or none.
    pub covered: Lanes,
    /// Its slice on each ray that it covers.
    pub slices: Lanes,
    /// What crossing it adds to the winding number.
    pub winding: i32,
}

impl Block {
    /// Draws a triangle over the block from a texel on, for the rays that a mask holds; `None` if it covers none of them.
    #[inline(always)]
    pub fn draw(build: &Build<'_>, triangle: u32, [x, y]: [u32; 2], wanted: &Lanes) -> Option<Self> {
        let leaf = Leaf { build, tile: Tile { x, y, log2: 3 } };
        let t = &build.triangles[triangle as usize];
        let covered = leaf.coverage(t, root_entry(triangle, t, build.slices)?, wanted);
        if !any(&covered) {
            return None;
        }
        let slices = t.leaf_slices(leaf.first_center(), &covered, build.slices);
        Some(Self { covered, slices, winding: t.winding() })
    }

    /// The fewest masks that satisfy 64 intervals of so many slices, by the closest exit: from a slice on, the rays still
    /// lit.
    pub fn stab(mut enter: Lanes, exit: Lanes, slices: u32) -> Vec<(u32, u64)> {
        let mut transitions: Vec<Transition> = Vec::new();
        Arch::new().dispatch(Stab { enter: &mut enter, exit, slices, transitions: &mut transitions });
        transitions.iter().map(|t| (t.last, t.lit)).collect()
    }
}
