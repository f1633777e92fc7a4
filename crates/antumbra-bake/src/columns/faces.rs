//! Tiles under one open face: digital planes, whose columns recur.
//!
//! Where a single open triangle is what every ray of a tile meets first, and nothing is free behind it, the tile's slices are
//! those of a digital plane. Few patterns of them occur at a leaf, however many leaves a face covers, so a leaf's column is
//! remembered by its pattern, and a greater tile's by its four children's columns and their places. Moved by whole blocks,
//! a column is the same.

use rustc_hash::FxHashMap;

use super::column::Run;
use crate::dag::SHADOWED;

/// First shadowed slices of 64 rays, counted from the start of a block.
pub(super) type Pattern = [u64; 8];

/// Slices that a pattern may span.
const SPAN: u32 = 256;
/// Runs remembered at most; with the next face the memory starts afresh.
const MOST_RUNS: usize = 1 << 17;

/// A remembered column, and the block of its tile's size from which its boundaries count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Known {
    column: u32,
    pub block: u32,
}

/// Columns of faces, by what makes them.
#[derive(Default)]
pub(super) struct FaceMemo {
    runs: Vec<Run>,
    columns: Vec<Remembered>,
    leaves: FxHashMap<Pattern, u32>,
    /// By the four children's columns, and their blocks counted from the parent's.
    parents: FxHashMap<[u32; 8], u32>,
}

/// A column's runs but for the last one, which is in shadow up to the column's end.
#[derive(Clone, Copy)]
struct Remembered {
    begin: u32,
    end: u32,
    /// Greatest boundary.
    reach: u32,
}

/// What a leaf is remembered by.
pub(super) struct LeafKey {
    pattern: Pattern,
    pub block: u32,
}

impl LeafKey {
    /// Of rays that are first shadowed in the given slices, `nearest` to `farthest`, on a light with so many slices; `None`
    /// for a pattern that is too deep or touches the first block or the last.
    #[inline(always)]
    pub fn new(enter: &[u32; 64], [nearest, farthest]: [u32; 2], slices: u32) -> Option<Self> {
        let start = nearest & !7;
        if start == 0 || farthest >= slices - 8 || farthest - start >= SPAN {
            return None;
        }
        let mut bytes = [0u8; 64];
        for (byte, slice) in bytes.iter_mut().zip(enter) {
            *byte = slice.wrapping_sub(start) as u8;
        }
        Some(Self { pattern: bytemuck::cast(bytes), block: start >> 3 })
    }
}

/// What a greater tile is remembered by.
pub(super) struct ParentKey {
    children: [u32; 8],
    pub block: u32,
}

impl ParentKey {
    /// Of a tile whose four children are known; `None` if one of them touches the parent's first block.
    pub fn new(children: &[Known; 4]) -> Option<Self> {
        let block = children.iter().fold(u32::MAX, |least, child| least.min(child.block)) >> 1;
        let key = core::array::from_fn(|i| match i {
            0..4 => children[i].column,
            _ => children[i - 4].block - 2 * block,
        });
        (block > 0).then_some(Self { children: key, block })
    }
}

impl FaceMemo {
    /// Forgets all if that is too much; no [`Known`] may be in use.
    pub fn trim(&mut self) {
        if self.runs.len() > MOST_RUNS {
            *self = Self::default();
        }
    }

    pub fn leaf(&self, key: &LeafKey, blocks: u32) -> Option<Known> {
        self.known(*self.leaves.get(&key.pattern)?, key.block, blocks)
    }

    pub fn parent(&self, key: &ParentKey, blocks: u32) -> Option<Known> {
        self.known(*self.parents.get(&key.children)?, key.block, blocks)
    }

    /// A column of so many blocks, if what is remembered ends before it does.
    fn known(&self, column: u32, block: u32, blocks: u32) -> Option<Known> {
        (block + self.columns[column as usize].reach < blocks).then_some(Known { column, block })
    }

    pub fn insert_leaf(&mut self, key: &LeafKey, column: &[Run]) -> Option<Known> {
        let known = self.insert(key.block, column)?;
        self.leaves.insert(key.pattern, known.column);
        Some(known)
    }

    pub fn insert_parent(&mut self, key: &ParentKey, column: &[Run]) -> Option<Known> {
        let known = self.insert(key.block, column)?;
        self.parents.insert(key.children, known.column);
        Some(known)
    }

    /// Remembers a column, unless it is not in shadow for certain where it ends (rays may turn in its last block, which
    /// another column must not repeat up to its own end), or there is too much to remember.
    fn insert(&mut self, block: u32, column: &[Run]) -> Option<Known> {
        if self.runs.len() > MOST_RUNS {
            return None;
        }
        let (last, before) = column.split_last()?;
        let reach = before.last()?.end_last - block;
        if last.node != SHADOWED || before.last()?.end_last >= last.end_last {
            return None;
        }
        let begin = self.runs.len() as u32;
        self.runs.extend(before.iter().map(|run| run.moved_by(block.wrapping_neg())));
        self.columns.push(Remembered { begin, end: self.runs.len() as u32, reach });
        Some(Known { column: self.columns.len() as u32 - 1, block })
    }

    /// Appends a known column of so many blocks.
    pub fn push(&self, known: Known, blocks: u32, runs: &mut Vec<Run>) {
        let Remembered { begin, end, .. } = self.columns[known.column as usize];
        let before = &self.runs[begin as usize..end as usize];
        runs.extend(before.iter().map(|run| run.moved_by(known.block)));
        runs.push(Run { node: SHADOWED, end_first: blocks, end_last: blocks });
    }
}
