//! Coarse levels of a light, made from its finished graph: level L is a volume of N / 2^L voxels per side, whose voxel is
//! lit iff at least half of the 8^L voxels that it stands for are (multi-resolution prefiltering, Sintorn et al. 2014).
//!
//! A coarse level is a height field again, for a block's lit share only falls along the light. Each distinct node is
//! made coarse once, so the work goes with the graph's size, not the volume's.

use antumbra::format::dag8::{SLICE_LEVEL, WHOLE, slice_node_share};
use antumbra::format::light::MIN_LOG2_RESOLUTION;
use rustc_hash::FxHashMap;

use super::table::{Id, LIT, SHADOWED, Tables};
use crate::Pause;

/// Why there are no coarse levels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LevelsError {
    /// The tables and the work on them outgrew the limit.
    #[error("coarse levels need more than the memory limit")]
    MemoryLimit,
    /// The tables ran out of ids.
    #[error("there are more distinct nodes than ids")]
    TooManyNodes,
    /// The pause said so.
    #[error("making coarse levels was cancelled")]
    Cancelled,
}

/// Nodes that are made between two rests.
const PAUSE_NODES: usize = 64;
/// Bytes that a remembered node takes.
const MEMO_BYTES: u64 = 40;

/// Roots of the coarse levels, with their own levels: light by light, from level 1 to the one with 64 voxels per side,
/// face by face.
///
/// # Errors
/// [`LevelsError`]; the limit, in bytes, holds for the tables and what is remembered of their nodes.
pub fn coarse_levels<'a>(
    tables: &Tables,
    lights: impl Iterator<Item = (&'a [Id], u32)>,
    memory_limit: u64,
    pause: Pause<'_>,
) -> Result<Vec<(Id, u32)>, LevelsError> {
    let mut shares = FxHashMap::default();
    let mut roots = Vec::new();
    for (faces, log2_resolution) in lights {
        for by in 1..=log2_resolution - MIN_LOG2_RESOLUTION {
            let mut coarse = Coarse { tables, by, shares: &mut shares, made: FxHashMap::default(), pause };
            for face in faces {
                roots.push((coarse.node(*face, log2_resolution), log2_resolution - by));
            }
            let remembered = (coarse.made.len() + coarse.shares.len()) as u64;
            if tables.bytes() + MEMO_BYTES * remembered > memory_limit {
                return Err(LevelsError::MemoryLimit);
            }
            if tables.are_full() {
                return Err(LevelsError::TooManyNodes);
            }
            if !pause() {
                return Err(LevelsError::Cancelled);
            }
        }
    }
    Ok(roots)
}

struct Coarse<'a> {
    tables: &'a Tables,
    /// Levels by which nodes shrink.
    by: u32,
    /// Lit share of inner nodes: see [`WHOLE`].
    shares: &'a mut FxHashMap<Id, u64>,
    /// Coarse nodes by node and level: a node of homogeneous children can stand at several.
    made: FxHashMap<(Id, u32), Id>,
    pause: Pause<'a>,
}

impl Coarse<'_> {
    /// The coarse counterpart of a node of 2^`level` voxels per side, `level` at least three above `by`.
    fn node(&mut self, id: Id, level: u32) -> Id {
        if id <= SHADOWED {
            return id;
        }
        if let Some(made) = self.made.get(&(id, level)) {
            return *made;
        }
        let made = if level == self.by + SLICE_LEVEL {
            let mut masks = [0u64; 8];
            self.fill(&mut masks, id, level, [0; 3], 8);
            self.tables.slice_node(masks.map(|mask| self.tables.mask(mask)))
        } else {
            let octants = self.tables.inner.key(id);
            let octants = octants.map(|octant| self.node(octant, level - 1));
            self.tables.inner_node(octants)
        };
        self.made.insert((id, level), made);
        if self.made.len().is_multiple_of(PAUSE_NODES) {
            (self.pause)();
        }
        made
    }

    /// Sets the lit ones of `side`^3 coarse voxels from `corner` on, which a node of 2^`level` voxels per side stands for.
    fn fill(&mut self, masks: &mut [u64; 8], id: Id, level: u32, corner: [u32; 3], side: u32) {
        match id {
            LIT => set_cube(masks, corner, side),
            SHADOWED => {}
            _ if side == 1 => {
                if 2 * self.share(id, level) >= WHOLE {
                    set_cube(masks, corner, 1);
                }
            }
            _ if level == SLICE_LEVEL => self.fill_from_slices(masks, id, corner, side),
            _ => {
                let half = side / 2;
                for (i, octant) in (0..).zip(self.tables.inner.key(id)) {
                    let at = [corner[0] + half * (i & 1), corner[1] + half * (i >> 1 & 1), corner[2] + half * (i >> 2)];
                    self.fill(masks, octant, level - 1, at, half);
                }
            }
        }
    }

    /// The same where the node's slices must be looked into: coarse voxels of 2 or 4 voxels per side.
    fn fill_from_slices(&self, masks: &mut [u64; 8], id: Id, corner: [u32; 3], side: u32) {
        let width = 8 / side;
        let slices = self.tables.slices.key(id).map(|mask| self.mask(mask));
        let square = (0..width).fold(0u64, |square, row| square | (((1 << width) - 1) << (8 * row)));
        for z in 0..side {
            for y in 0..side {
                for x in 0..side {
                    let square = square << (8 * width * y + width * x);
                    let of_voxel = &slices[(width * z) as usize..(width * (z + 1)) as usize];
                    let lit: u32 = of_voxel.iter().map(|mask| (mask & square).count_ones()).sum();
                    if 2 * lit >= width.pow(3) {
                        set_cube(masks, [corner[0] + x, corner[1] + y, corner[2] + z], 1);
                    }
                }
            }
        }
    }

    fn mask(&self, id: Id) -> u64 {
        match id {
            LIT => u64::MAX,
            SHADOWED => 0,
            _ => self.tables.masks.key(id),
        }
    }

    /// The lit share of a node: see [`WHOLE`].
    fn share(&mut self, id: Id, level: u32) -> u64 {
        match id {
            LIT => return WHOLE,
            SHADOWED => return 0,
            _ if level == SLICE_LEVEL => {
                let slices = self.tables.slices.key(id);
                return slice_node_share(slices.iter().map(|mask| self.mask(*mask).count_ones()).sum());
            }
            _ => {}
        }
        if let Some(share) = self.shares.get(&id) {
            return *share;
        }
        let octants = self.tables.inner.key(id);
        let share = octants.iter().map(|octant| self.share(*octant, level - 1) / 8).sum();
        self.shares.insert(id, share);
        share
    }
}

/// Sets `side`^3 bits of eight masks.
fn set_cube(masks: &mut [u64; 8], [x, y, z]: [u32; 3], side: u32) {
    let row = ((1u64 << side) - 1) << x;
    let square = (y..y + side).fold(0u64, |square, y| square | (row << (8 * y)));
    masks[z as usize..(z + side) as usize].iter_mut().for_each(|mask| *mask |= square);
}
