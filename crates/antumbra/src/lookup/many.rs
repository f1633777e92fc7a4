//! Point lookups side by side: descents of several points take turns, level by level, so that one's memory reads run
//! while another's are under way and no branch depends on a single point's depth.

use alloc::sync::Arc;

use super::project::Place;
use super::top_grid::TopGrid;
use super::window::Slice;
use crate::format::dag8::{LIT, SHADOWED, SLICE_LEVEL, child_code, child_slot};
use crate::format::silhouette::{Kind, kind, payload};
use crate::format::slices::Spread;

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

/// Visibility at places of a light in silhouettes, whose faces have the given grids.
pub(crate) fn visibility_of_silhouettes(
    pool: &[u32],
    grids: &[Arc<TopGrid>],
    spread: Spread<'_>,
    places: impl Iterator<Item = Place>,
    visibility: &mut [f32],
) {
    let mut descents = Descents { pool, spread, lanes: [Lane::default(); LANES], count: 0 };
    for (answer, place) in places.take(visibility.len()).enumerate() {
        let settled = match place {
            Place::Lit => Some(true),
            Place::Unlit => Some(false),
            Place::At { face, voxel: [x, y, z] } => {
                let grid = &grids[face];
                let settled = grid.settled(0, [x, y], z);
                if settled.is_none() {
                    let (tile, level) = (grid.node([x, y, z]), grid.level);
                    descents.lanes[descents.count] = Lane { tile, level, voxel: [x, y, z], answer };
                    descents.count += 1;
                }
                settled
            }
        };
        if let Some(is_lit) = settled {
            visibility[answer] = f32::from(is_lit);
        }
        if descents.count == LANES {
            descents.finish(visibility);
        }
    }
    descents.finish(visibility);
}

/// Descents to leaves that are under way.
struct Descents<'a> {
    pool: &'a [u32],
    spread: Spread<'a>,
    lanes: [Lane; LANES],
    count: usize,
}

#[derive(Clone, Copy, Default)]
struct Lane {
    tile: u32,
    /// log2 of the tile's texels per side.
    level: u32,
    voxel: [u32; 3],
    /// Which of the answers it is for.
    answer: usize,
}

impl Descents<'_> {
    fn finish(&mut self, visibility: &mut [f32]) {
        let Self { pool, spread, .. } = *self;
        let lanes = &mut self.lanes[..self.count];
        let mut is_any_inner = true;
        while is_any_inner {
            is_any_inner = false;
            for lane in lanes.iter_mut() {
                // Leaves read the pool's first word in vain: cheaper than a branch that cannot be foreseen.
                let is_inner = kind(lane.tile) == Kind::Inner;
                let level = lane.level.wrapping_sub(u32::from(is_inner));
                let [x, y] = [0, 1].map(|axis| (lane.voxel[axis] >> (level & 31)) & 1);
                let child = pool[if is_inner { payload(lane.tile) + (x | (y << 1)) as usize } else { 0 }];
                lane.tile = if is_inner { child } else { lane.tile };
                lane.level = level;
                is_any_inner |= is_inner;
            }
        }
        for lane in lanes {
            let [x, y, z] = lane.voxel;
            let is_lit = Slice::new(pool, z, 0, spread).is_lit(lane.tile, 0, [x, y]);
            visibility[lane.answer] = f32::from(is_lit);
        }
        self.count = 0;
    }
}
