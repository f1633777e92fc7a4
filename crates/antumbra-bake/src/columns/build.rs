//! The recursion: tiles down, columns up, on many threads.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use pulp::Arch;
use rayon::prelude::*;

use super::column::{Run, merge, push_plane};
use super::cutout::Cutout;
use super::enters::EnterGrid;
use super::faces::{FaceMemo, Known, ParentKey};
use super::freedom::Freedom;
use super::leaf::{LEAF_LOG2, Leaf, LeafScratch};
use super::settle::{Rules, Settled};
use super::tile::{Entry, Tile, root_entry, split};
use super::triangle::BuildTriangle;
use crate::Pause;
use crate::dag::{Id, Interner, LIT, Tables};
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
    /// See [`Pause`].
    pub pause: Pause<'a>,
    /// See [`crate::BakeOptions::plain_code`].
    pub plain_code: bool,
}

impl<'a> Build<'a> {
    pub(crate) fn resolution(&self) -> Resolution {
        self.slices.resolution()
    }

    /// The instructions to use.
    pub(crate) fn arch(&self) -> Arch {
        if self.plain_code { Arch::Scalar } else { Arch::new() }
    }

    pub(crate) fn rules(&self) -> Rules<'a> {
        Rules { triangles: self.triangles, slices: self.slices, freedom: self.freedom }
    }

    /// Blocks in the column of a tile of 2^`log2` texels per side.
    pub(super) fn blocks(&self, log2: u32) -> u32 {
        self.resolution().texels() >> log2
    }

    /// Notes that all rays of a tile are first shadowed in a slice of the span.
    pub(crate) fn record_enters(&self, tile: Tile, span: [u32; 2]) {
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
    /// [`Build::pause`] said so.
    #[error("the construction was cancelled")]
    Cancelled,
}

/// Tiles whose lists are longer than this share of all triangles are split over threads.
const SPLIT_SHARE: usize = 256;
/// Tiles of at least this share of the light's side (as a power of two) are split over threads.
const SPLIT_LEVELS: u32 = 5;

/// Tiles of this size look at the limits: often enough to stop in time, seldom enough to cost nothing.
const LIMITS_LOG2: u32 = 8;
/// Tiles of this size may rest.
const PAUSE_LOG2: u32 = 5;
/// Triangles that are looked at between two rests.
pub(super) const PAUSE_TRIANGLES: usize = 1 << 12;

/// Builds a light's graph; returns its root. Runs on the current rayon pool; the root stands for the same graph
/// whatever the number of threads.
///
/// # Errors
/// [`BuildError`].
pub fn build(build: &Build<'_>) -> Result<Id, BuildError> {
    let resolution = build.resolution();
    let root = Tile::root(resolution);
    let entries = root_entries(build);
    let shared = Shared {
        build,
        split_length: (entries.len() / SPLIT_SHARE).max(256),
        split_log2: root.log2.saturating_sub(SPLIT_LEVELS).max(LEAF_LOG2 + 1),
        workers: Mutex::new(Vec::new()),
        stopped: AtomicBool::new(false),
        done: AtomicU64::new(0),
    };
    let column = shared.tile(root, entries, resolution.texels());
    if build.tables.are_full() {
        return Err(BuildError::TooManyNodes);
    }
    if shared.stopped.load(Ordering::Relaxed) {
        return Err(if (build.pause)() { BuildError::MemoryLimit } else { BuildError::Cancelled });
    }
    Ok(column.first().map_or(LIT, |run| run.node))
}

/// The root tile's list.
pub(crate) fn root_entries(build: &Build<'_>) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::with_capacity(build.triangles.len());
    for (i, triangles) in build.triangles.chunks(PAUSE_TRIANGLES).enumerate() {
        let casters = ((i * PAUSE_TRIANGLES) as u32..).zip(triangles);
        entries.extend(casters.filter_map(|(i, t)| root_entry(i, t, build.slices)));
        (build.pause)();
    }
    entries
}

struct Shared<'a> {
    build: &'a Build<'a>,
    split_length: usize,
    split_log2: u32,
    /// Those without work: there are as many as threads have been at work at once.
    workers: Mutex<Vec<Worker<'a>>>,
    stopped: AtomicBool,
    /// Texels whose columns are done.
    done: AtomicU64,
}

impl<'a> Shared<'a> {
    /// The column of a tile, given its parent's list.
    fn tile(&self, tile: Tile, mut entries: Vec<Entry>, clamp: u32) -> Vec<Run> {
        let settled = self.build.rules().settle(tile, &mut entries, clamp);
        let clamp = match settled {
            // Great faces are work for all threads, too: their children are faces again.
            Settled::Mixed { clamp } | Settled::Face { clamp, .. } if self.is_split(tile, entries.len()) => clamp,
            _ => {
                let column = self.with_worker(|worker| worker.settled(tile, &entries, settled));
                self.report(tile);
                return column;
            }
        };
        let mut lists = [const { Vec::new() }; 4];
        split(self.build.arch(), self.build, tile, &entries, &mut lists);
        drop(entries);
        let children: Vec<Vec<Run>> =
            lists.into_par_iter().enumerate().map(|(i, list)| self.tile(tile.child(i as u32), list, clamp)).collect();
        let children = [0, 1, 2, 3].map(|i| &children[i][..]);
        self.with_worker(|worker| merge(children, self.build.blocks(tile.log2), &mut worker.nodes, &mut worker.runs))
    }

    fn is_split(&self, tile: Tile, list: usize) -> bool {
        tile.log2 > self.split_log2 || (list > self.split_length && tile.log2 > LEAF_LOG2 + 2)
    }

    /// The runs that a worker appends. Workers are used again: they remember what they have met.
    fn with_worker(&self, work: impl FnOnce(&mut Worker<'a>)) -> Vec<Run> {
        let workers = || self.workers.lock().unwrap_or_else(PoisonError::into_inner);
        let idle = workers().pop();
        let mut worker = idle.unwrap_or_else(|| Worker::new(self.build));
        worker.stopped = self.stopped.load(Ordering::Relaxed);
        work(&mut worker);
        self.stopped.fetch_or(worker.stopped, Ordering::Relaxed);
        let column = std::mem::take(&mut worker.runs);
        workers().push(worker);
        column
    }

    fn report(&self, tile: Tile) {
        let texels = 1u64 << (2 * tile.log2);
        let done = self.done.fetch_add(texels, Ordering::Relaxed) + texels;
        let all = 1u64 << (2 * self.build.resolution().log2());
        (self.build.progress)(done as f64 / all as f64);
    }
}

/// Builds tiles one after the other. Columns live on a stack, lists in one set per level.
struct Worker<'a> {
    build: &'a Build<'a>,
    arch: Arch,
    nodes: Interner<'a>,
    lists: Vec<[Vec<Entry>; 4]>,
    runs: Vec<Run>,
    merged: Vec<Run>,
    leaf: LeafScratch,
    faces: FaceMemo,
    /// A limit has been met: results are of no use.
    stopped: bool,
}

impl<'a> Worker<'a> {
    fn new(build: &'a Build<'a>) -> Self {
        Self {
            build,
            arch: build.arch(),
            nodes: Interner::new(build.tables),
            lists: (0..=build.resolution().log2()).map(|_| [const { Vec::new() }; 4]).collect(),
            runs: Vec::new(),
            merged: Vec::new(),
            leaf: LeafScratch::new(build.arch()),
            faces: FaceMemo::default(),
            stopped: false,
        }
    }

    /// Appends the column of a tile, given its list.
    fn child(&mut self, tile: Tile, list: &mut Vec<Entry>, clamp: u32) {
        let settled = self.build.rules().settle(tile, list, clamp);
        self.settled(tile, list, settled);
    }

    fn settled(&mut self, tile: Tile, entries: &[Entry], settled: Settled) {
        match settled {
            _ if self.stopped => self.push_lit(tile),
            Settled::Lit => {
                self.build.record_enters(tile, [u32::MAX; 2]);
                self.push_lit(tile);
            }
            Settled::Plane { least, enter, exit, .. } => {
                self.build.record_enters(tile, [least, enter]);
                let log2 = self.build.resolution().log2();
                push_plane(&mut self.runs, &mut self.nodes, [enter, exit], tile.log2, log2);
            }
            Settled::Face { triangle, .. } => {
                self.faces.trim();
                if let Some(known) = self.face(tile, triangle) {
                    self.faces.push(known, self.build.blocks(tile.log2), &mut self.runs);
                }
            }
            Settled::Mixed { clamp } => self.mixed(tile, entries, clamp),
        }
    }

    fn push_lit(&mut self, tile: Tile) {
        let blocks = self.build.blocks(tile.log2);
        self.runs.push(Run { node: LIT, end_first: blocks, end_last: blocks });
    }

    /// Appends the column of a tile whose texels differ.
    fn mixed(&mut self, tile: Tile, entries: &[Entry], clamp: u32) {
        if tile.log2 == LEAF_LOG2 {
            let leaf = Leaf { build: self.build, tile };
            return self.leaf.push_column(leaf, entries, clamp, &mut self.nodes, &mut self.runs);
        }
        self.look_at_limits(tile);
        let mut lists = std::mem::take(&mut self.lists[tile.log2 as usize]);
        lists.iter_mut().for_each(Vec::clear);
        split(self.arch, self.build, tile, entries, &mut lists);
        let base = self.runs.len();
        let mut begins = [base; 5];
        for (i, list) in lists.iter_mut().enumerate() {
            self.child(tile.child(i as u32), list, clamp);
            begins[i + 1] = self.runs.len();
        }
        self.lists[tile.log2 as usize] = lists;
        self.merge(tile, begins);
    }

    /// Replaces four children's columns, the last on the stack, by their parent's.
    fn merge(&mut self, parent: Tile, begins: [usize; 5]) {
        let column = |i: usize| &self.runs[begins[i]..begins[i + 1]];
        let columns = [column(0), column(1), column(2), column(3)];
        self.merged.clear();
        merge(columns, self.build.blocks(parent.log2), &mut self.nodes, &mut self.merged);
        self.runs.truncate(begins[0]);
        self.runs.extend_from_slice(&self.merged);
    }

    /// The column of a tile that one open face hides; appended, with `None`, where it is not remembered.
    fn face(&mut self, tile: Tile, triangle: u32) -> Option<Known> {
        if tile.log2 == LEAF_LOG2 {
            let leaf = Leaf { build: self.build, tile };
            return self.leaf.face(leaf, triangle, &mut self.faces, &mut self.nodes, &mut self.runs);
        }
        self.look_at_limits(tile);
        if self.stopped {
            self.push_lit(tile);
            return None;
        }
        let base = self.runs.len();
        let children = [0, 1, 2, 3].map(|i| {
            let known = self.face(tile.child(i), triangle);
            (known, self.runs.len())
        });
        if let [(Some(a), _), (Some(b), _), (Some(c), _), (Some(d), _)] = children {
            return self.parent_of_known(tile, [a, b, c, d]);
        }
        self.merge_partly_known(tile, base, children);
        None
    }

    fn parent_of_known(&mut self, tile: Tile, children: [Known; 4]) -> Option<Known> {
        let blocks = self.build.blocks(tile.log2);
        let key = ParentKey::new(&children);
        if let Some(known) = key.as_ref().and_then(|key| self.faces.parent(key, blocks)) {
            return Some(known);
        }
        let base = self.runs.len();
        self.merge_partly_known(tile, base, children.map(|child| (Some(child), base)));
        let known = self.faces.insert_parent(&key?, &self.runs[base..])?;
        self.runs.truncate(base);
        Some(known)
    }

    /// Merges four columns, of which some are known and the others lie on the stack from `base` on, each up to its end.
    fn merge_partly_known(&mut self, tile: Tile, base: usize, children: [(Option<Known>, usize); 4]) {
        let blocks = self.build.blocks(tile.log2 - 1);
        let stacked = self.runs.split_off(base);
        let mut begins = [base; 5];
        let mut begin = base;
        for (i, (known, end)) in children.into_iter().enumerate() {
            match known {
                Some(known) => self.faces.push(known, blocks, &mut self.runs),
                None => self.runs.extend_from_slice(&stacked[begin - base..end - base]),
            }
            begin = end;
            begins[i + 1] = self.runs.len();
        }
        self.merge(tile, begins);
    }

    fn look_at_limits(&mut self, tile: Tile) {
        if tile.log2 == LIMITS_LOG2 {
            let tables = self.build.tables;
            self.stopped |= tables.bytes() > self.build.memory_limit || tables.are_full();
        }
        if tile.log2 == PAUSE_LOG2 {
            self.stopped |= !(self.build.pause)();
        }
    }
}
