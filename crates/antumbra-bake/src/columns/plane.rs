//! Leaves under one open face: digital planes, whose columns recur.
//!
//! Where a single open triangle covers a leaf, its 64 slices are those of a digital plane, and few patterns of them occur
//! however many leaves the triangle covers. A column is remembered by its pattern and used again at other depths: moved
//! by whole blocks, it is the same.

use rustc_hash::FxHashMap;

use super::column::Run;
use super::leaf::{LEAF_LOG2, Leaf};
use super::tile::{COVERS, Entry, SOLID};

/// First shadowed slices of 64 rays, four bits each, counted from the start of a block.
type Pattern = [u64; 4];

/// Slices that a pattern may span.
const SPAN: u32 = 16;
/// Patterns remembered at most; then the memory starts afresh.
const MOST_PATTERNS: usize = 1 << 15;

/// Columns by pattern. Their boundaries count from the pattern's block.
#[derive(Default)]
pub(super) struct PlaneMemo {
    columns: FxHashMap<Pattern, Vec<Run>>,
}

/// A leaf that the memo can answer.
pub(super) struct Remembered {
    pattern: Pattern,
    /// Block from which the pattern counts.
    block: u32,
    nearest: u32,
    farthest: u32,
}

impl Remembered {
    /// Least and greatest first shadowed slice.
    pub fn enters(&self) -> [u32; 2] {
        [self.nearest + 1, self.farthest + 1]
    }
}

impl PlaneMemo {
    /// The leaf's pattern, if one open triangle covers it, is not too steep and stays off the first and last blocks. Only
    /// where rays have no freedom behind it.
    pub fn recognise(leaf: &Leaf<'_>, entries: &[Entry]) -> Option<Remembered> {
        let [entry] = entries else { return None };
        if !entry.has(COVERS) || entry.has(SOLID) || leaf.build.freedom.is_behind_open() {
            return None;
        }
        let triangle = &leaf.build.triangles[entry.triangle as usize];
        let slices = triangle.leaf_slices(leaf.first_center(), u64::MAX, leaf.build.slices);
        let (nearest, farthest) = slices.iter().fold((u32::MAX, 0), |(n, f), &s| (n.min(s), f.max(s)));
        let block = (nearest + 1) >> LEAF_LOG2;
        let start = block << LEAF_LOG2;
        if block == 0 || farthest + 1 >= start + SPAN || start + SPAN >= leaf.build.resolution().texels() {
            return None;
        }
        let mut pattern = [0; 4];
        for (i, slice) in slices.iter().enumerate() {
            pattern[i >> 4] |= u64::from(slice + 1 - start) << (4 * (i & 15));
        }
        Some(Remembered { pattern, block, nearest, farthest })
    }

    /// Appends the leaf's column; `make` makes it where the pattern is new.
    pub fn push_column(
        &mut self,
        leaf: Remembered,
        blocks: u32,
        runs: &mut Vec<Run>,
        make: impl FnOnce(&mut Vec<Run>),
    ) {
        let Remembered { pattern, block, .. } = leaf;
        if let Some(column) = self.columns.get(&pattern) {
            return runs.extend(column.iter().map(|run| moved(*run, blocks, |end| end + block)));
        }
        let begin = runs.len();
        make(runs);
        if self.columns.len() >= MOST_PATTERNS {
            self.columns.clear();
        }
        let column = runs[begin..].iter().map(|run| moved(*run, blocks, |end| end - block)).collect();
        self.columns.insert(pattern, column);
    }
}

/// A run with its end moved; the last run goes on to the column's end wherever the others lie.
fn moved(run: Run, blocks: u32, end: impl Fn(u32) -> u32) -> Run {
    if run.end_last == blocks {
        return run;
    }
    Run { end_first: end(run.end_first), end_last: end(run.end_last), ..run }
}
