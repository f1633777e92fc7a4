//! The recursion: tiles down, columns up, on many threads.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use rayon::prelude::*;

use super::column::{Run, merge, push_plane};
use super::cutout::Cutout;
use super::enters::EnterGrid;
use super::freedom::Freedom;
use super::leaf::{LEAF_LOG2, Leaf, LeafScratch};
use super::settle::{Rules, Settled};
use super::tile::{Entry, Split, Tile, root_entry};
use super::triangle::BuildTriangle;
use crate::dag::{Id, LIT, Tables};
use crate::light_space::{Resolution, Slices};

/// The construction of one face of a light.
pub struct Build<'a> {
    /// The casters.
    pub triangles: &'a [BuildTriangle],
    /// What the casters' cutouts refer to.
    pub cutouts: &'a [Cutout<'a>],
    /// The light's slices, and with them its resolution.
    pub slices: &'a Slices,
    /// What is free behind open surfaces.
    pub freedom: &'a Freedom,
    /// Where enter depths are noted, if they are wanted.
    pub enters: Option<&'a EnterGrid>,
    /// Tables that this light shares with others.
    pub tables: &'a Tables,
    /// Bytes that the tables and the triangles' lists may take together.
    pub memory_limit: u64,
    /// Called with the share of the light's area that is done, 0 to 1.
    pub progress: &'a (dyn Fn(f64) + Sync),
}

impl<'a> Build<'a> {
    pub(super) fn resolution(&self) -> Resolution {
        self.slices.resolution()
    }

    fn rules(&self) -> Rules<'a> {
        Rules { triangles: self.triangles, resolution: self.resolution(), freedom: self.freedom }
    }

    /// Notes that all rays of a tile are first shadowed in a slice of the span.
    fn record_enters(&self, tile: Tile, span: [u32; 2]) {
        if let Some(grid) = self.enters {
            grid.insert(tile, span);
        }
    }
}

/// Why a construction ended early.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BuildError {
    /// The tables outgrew the limit.
    #[error("the nodes outgrow the memory limit")]
    MemoryLimit,
    /// The tables ran out of ids.
    #[error("there are more distinct nodes than ids")]
    TooManyNodes,
}

/// Tiles whose lists are longer than this share of all triangles are split over threads.
const SPLIT_SHARE: usize = 256;
/// Tiles of at least this share of the light's side (as a power of two) are split over threads.
const SPLIT_LEVELS: u32 = 5;

/// Tiles of this size look at the limits: often enough to stop in time, seldom enough to cost nothing.
const LIMITS_LOG2: u32 = 8;

/// Builds a light's graph; returns its root. Runs on the current rayon pool; the root stands for the same graph
/// whatever the number of threads.
///
/// # Errors
/// [`BuildError`].
pub fn build(build: &Build<'_>) -> Result<Id, BuildError> {
    let resolution = build.resolution();
    let root = Tile::root(resolution);
    let casters = build.triangles.iter().enumerate();
    let entries: Vec<Entry> = casters.filter_map(|(i, t)| root_entry(i as u32, t, build.slices)).collect();
    let shared = Shared {
        build,
        split_length: (entries.len() / SPLIT_SHARE).max(256),
        split_log2: root.log2.saturating_sub(SPLIT_LEVELS).max(LEAF_LOG2 + 1),
        stopped: AtomicBool::new(false),
        done: AtomicU64::new(0),
    };
    let column = shared.tile(root, entries, resolution.texels());
    if build.tables.are_full() {
        return Err(BuildError::TooManyNodes);
    }
    if shared.stopped.load(Ordering::Relaxed) {
        return Err(BuildError::MemoryLimit);
    }
    Ok(column.first().map_or(LIT, |run| run.node))
}

struct Shared<'a> {
    build: &'a Build<'a>,
    split_length: usize,
    split_log2: u32,
    stopped: AtomicBool,
    /// Texels whose columns are done.
    done: AtomicU64,
}

impl Shared<'_> {
    /// The column of a tile, given its parent's list.
    fn tile(&self, tile: Tile, mut entries: Vec<Entry>, clamp: u32) -> Vec<Run> {
        let mut column = Vec::new();
        match self.build.rules().settle(tile, &mut entries, tile.log2 == LEAF_LOG2, clamp) {
            Settled::Lit => self.push_lit(&mut column, tile),
            Settled::Plane { least, enter, exit } => self.push_plane(&mut column, tile, least, [enter, exit]),
            Settled::Mixed { clamp } if self.is_split(tile, entries.len()) => {
                let lists = self.child_lists(tile, entries);
                let children: Vec<Vec<Run>> = lists
                    .into_par_iter()
                    .enumerate()
                    .map(|(i, list)| self.tile(tile.child(i as u32), list, clamp))
                    .collect();
                let blocks = self.build.resolution().texels() >> tile.log2;
                merge([0, 1, 2, 3].map(|i| &children[i][..]), blocks, self.build.tables, &mut column);
                return column;
            }
            Settled::Mixed { clamp } => {
                let mut worker = Worker::new(self);
                worker.mixed(tile, &entries, clamp);
                column = worker.runs;
            }
        }
        self.report(tile);
        column
    }

    fn is_split(&self, tile: Tile, list: usize) -> bool {
        tile.log2 > self.split_log2 || (list > self.split_length && tile.log2 > LEAF_LOG2 + 2)
    }

    fn child_lists(&self, tile: Tile, entries: Vec<Entry>) -> [Vec<Entry>; 4] {
        let mut lists = [const { Vec::new() }; 4];
        split(self.build, tile, &entries, &mut lists);
        lists
    }

    fn push_lit(&self, runs: &mut Vec<Run>, tile: Tile) {
        self.build.record_enters(tile, [u32::MAX; 2]);
        let blocks = self.build.resolution().texels() >> tile.log2;
        runs.push(Run { node: LIT, end_first: blocks, end_last: blocks });
    }

    fn push_plane(&self, runs: &mut Vec<Run>, tile: Tile, least: u32, span: [u32; 2]) {
        self.build.record_enters(tile, [least, span[0]]);
        push_plane(runs, self.build.tables, span, tile.log2, self.build.resolution().log2());
    }

    fn report(&self, tile: Tile) {
        let texels = 1u64 << (2 * tile.log2);
        let done = self.done.fetch_add(texels, Ordering::Relaxed) + texels;
        let all = 1u64 << (2 * self.build.resolution().log2());
        (self.build.progress)(done as f64 / all as f64);
        self.check_limits();
    }

    fn check_limits(&self) {
        if self.build.tables.bytes() > self.build.memory_limit || self.build.tables.are_full() {
            self.stopped.store(true, Ordering::Relaxed);
        }
    }
}

/// Appends to each child's list those of a tile's entries that touch it.
fn split(build: &Build<'_>, tile: Tile, entries: &[Entry], lists: &mut [Vec<Entry>; 4]) {
    let split = Split::new(tile, build.slices);
    for entry in entries {
        split.classify(&build.triangles[entry.triangle as usize], *entry, |child, e| lists[child].push(e));
    }
}

/// Builds tiles one after the other. Columns live on a stack, lists in one set per level.
struct Worker<'a> {
    shared: &'a Shared<'a>,
    lists: Vec<[Vec<Entry>; 4]>,
    runs: Vec<Run>,
    merged: Vec<Run>,
    leaf: LeafScratch,
}

impl<'a> Worker<'a> {
    fn new(shared: &'a Shared<'a>) -> Self {
        let lists = (0..=shared.build.resolution().log2()).map(|_| [const { Vec::new() }; 4]).collect();
        Self { shared, lists, runs: Vec::new(), merged: Vec::new(), leaf: LeafScratch::default() }
    }

    /// Appends the column of a tile whose texels differ.
    fn mixed(&mut self, tile: Tile, entries: &[Entry], clamp: u32) {
        let build = self.shared.build;
        if tile.log2 == LEAF_LOG2 {
            let leaf = Leaf { build, tile, clamp };
            return self.leaf.push_column(leaf, entries, &mut self.runs);
        }
        if tile.log2 == LIMITS_LOG2 {
            self.shared.check_limits();
        }
        let mut lists = std::mem::take(&mut self.lists[tile.log2 as usize]);
        lists.iter_mut().for_each(Vec::clear);
        split(build, tile, entries, &mut lists);
        let base = self.runs.len();
        let mut begins = [base; 5];
        for (i, list) in lists.iter_mut().enumerate() {
            self.child(tile.child(i as u32), list, clamp);
            begins[i + 1] = self.runs.len();
        }
        self.lists[tile.log2 as usize] = lists;
        let column = |i: usize| &self.runs[begins[i]..begins[i + 1]];
        self.merged.clear();
        let columns = [column(0), column(1), column(2), column(3)];
        merge(columns, build.resolution().texels() >> tile.log2, build.tables, &mut self.merged);
        self.runs.truncate(base);
        self.runs.extend_from_slice(&self.merged);
    }

    /// Appends the column of a tile, given its list.
    fn child(&mut self, tile: Tile, list: &mut Vec<Entry>, clamp: u32) {
        match self.shared.build.rules().settle(tile, list, tile.log2 == LEAF_LOG2, clamp) {
            Settled::Lit => self.shared.push_lit(&mut self.runs, tile),
            Settled::Plane { least, enter, exit } => self.shared.push_plane(&mut self.runs, tile, least, [enter, exit]),
            Settled::Mixed { .. } if self.shared.stopped.load(Ordering::Relaxed) => {
                self.shared.push_lit(&mut self.runs, tile);
            }
            Settled::Mixed { clamp } => self.mixed(tile, list, clamp),
        }
    }
}
