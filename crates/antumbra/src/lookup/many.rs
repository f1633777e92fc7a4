//! Point lookups side by side: descents of several points take turns, level by level, so that one's memory reads run
//! while another's are under way and no branch depends on a single point's depth.

use alloc::sync::Arc;

use super::project::Place;
use super::top_grid::TopGrid;
use crate::format::dag8::{LIT, SHADOWED, SLICE_LEVEL, child_code, child_slot};

/// Points that descend together.
const LANES: usize = 8;

/// Visibility at places of a light, whose faces have the given grids.
pub(crate) fn visibility(
    pool: &[u32],
    grids: &[Arc<TopGrid>],
    mut places: impl Iterator<Item = Place>,
    visibility: &mut [f32],
) {
    // Grids of homogeneous faces are smaller: their lanes end at once.
    let level = grids.iter().map(|grid| grid.level).min().unwrap_or(0);
    for answers in visibility.chunks_mut(LANES) {
        let mut lanes = Lanes { nodes: [LIT; LANES], voxels: [[0; 3]; LANES] };
        let mut filled = 0;
        for (lane, place) in places.by_ref().take(answers.len()).enumerate() {
            filled += 1;
            match place {
                Place::Lit => {}
                Place::Unlit => lanes.nodes[lane] = SHADOWED,
                Place::At { face, voxel } => {
                    lanes.voxels[lane] = voxel;
                    lanes.nodes[lane] = grids[face].node(voxel);
                }
            }
        }
        lanes.descend(pool, level);
        for (lane, answer) in answers.iter_mut().enumerate().take(filled) {
            *answer = f32::from(lanes.is_lit(pool, lane));
        }
    }
}

struct Lanes {
    nodes: [u32; LANES],
    voxels: [[u32; 3]; LANES],
}

impl Lanes {
    /// Descends to the slices' masks.
    #[inline(always)]
    fn descend(&mut self, pool: &[u32], from: u32) {
        let mut level = from;
        while level > SLICE_LEVEL {
            level -= 1;
            if !self.step(pool, |[x, y, z]| ((x >> level) & 1) | (((y >> level) & 1) << 1) | (((z >> level) & 1) << 2))
            {
                return;
            }
        }
        self.step(pool, |[_, _, z]| z & 7);
    }

    /// Takes every lane that is not homogeneous to a child; whether any is left.
    #[inline(always)]
    fn step(&mut self, pool: &[u32], child: impl Fn([u32; 3]) -> u32) -> bool {
        let mut any = 0;
        for (node, voxel) in self.nodes.iter_mut().zip(&self.voxels) {
            // Homogeneous lanes read the pool's own header in vain: cheaper than a branch that cannot be foreseen.
            let mixed = *node > SHADOWED;
            let at = if mixed { *node as usize } else { 0 };
            let (header, i) = (pool[at], child(*voxel));
            let code = child_code(header, i);
            let reference = pool.get(at + 1 + child_slot(header, i)).copied().unwrap_or(LIT);
            let next = if code > SHADOWED { reference } else { code };
            *node = if mixed { next } else { *node };
            any |= *node;
        }
        any > SHADOWED
    }

    #[inline(always)]
    fn is_lit(&self, pool: &[u32], lane: usize) -> bool {
        let [x, y, _] = self.voxels[lane];
        match self.nodes[lane] {
            LIT => true,
            SHADOWED => false,
            mask => {
                let word = pool[mask as usize + ((y >> 2) & 1) as usize];
                (word >> (8 * (y & 3) + (x & 7))) & 1 != 0
            }
        }
    }
}
