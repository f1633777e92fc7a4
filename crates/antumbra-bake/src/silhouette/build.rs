//! The recursion: tiles down, sketches up, on many threads; what grows no more becomes part of a tree.

use std::ops::AddAssign;
use std::sync::Mutex;
use std::sync::PoisonError;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use rayon::prelude::*;

use antumbra::format::silhouette::Form;

use super::accept::{Candidates, Forms};
use super::direct;
use super::form::{Plane, Side, Surface};
use super::gap::{Gap, add_planes};
use super::leaf;
use super::sketch::{Set, Sketch};
use super::tree::Tree;
use crate::columns::{Build, BuildError, Entry, LEAF_LOG2, Leaf, LeafScratch, Settled, Tile, root_entries, split};

/// Tiles whose lists are longer than this share of all triangles are split over threads.
const SPLIT_SHARE: usize = 256;
/// Tiles of at least this share of the light's side (as a power of two) are split over threads.
const SPLIT_LEVELS: u32 = 5;
/// Tiles of this size may rest.
const PAUSE_LOG2: u32 = 5;

/// Tiles with so many inner ones are written, with what lies beside them: about a mebibyte of sketches. Parts share no choice of depths.
const PART_TILES: u64 = 1 << 11;

/// Builds one face of a light.
///
/// # Errors
/// [`BuildError`].
pub(crate) fn build(build: &Build<'_>) -> Result<Tree, BuildError> {
    let resolution = build.resolution();
    let root = Tile::root(resolution);
    let entries = root_entries(build);
    let shared = Shared {
        build,
        forms: Forms { triangles: build.triangles, slices: build.slices },
        split_length: (entries.len() / SPLIT_SHARE).max(256),
        split_log2: root.log2.saturating_sub(SPLIT_LEVELS).max(LEAF_LOG2 + 1),
        workers: Mutex::new(Vec::new()),
        stopped: AtomicBool::new(false),
        done: AtomicU64::new(0),
        held: AtomicU64::new(0),
        is_out_of_memory: AtomicBool::new(false),
    };
    let tree = shared.tile(root, entries, resolution.texels()).written(&shared);
    if shared.is_out_of_memory.load(Ordering::Relaxed) {
        return Err(BuildError::MemoryLimit);
    }
    if shared.stopped.load(Ordering::Relaxed) {
        return Err(BuildError::Cancelled);
    }
    Ok(tree)
}

/// A tile so far.
enum Grown {
    /// It may become part of a greater one, or be written with its neighbours.
    Sketch(Sketch, Size),
    Tree(Tree),
}

/// What a sketch takes.
#[derive(Clone, Copy, Default)]
struct Size {
    /// Inner tiles.
    tiles: u64,
    bytes: u64,
}

impl Size {
    /// A tile's own, but for inner tiles in it.
    fn of(sketch: &Sketch) -> Self {
        Self { tiles: matches!(sketch, Sketch::Inner(_)).into(), bytes: sketch.own_bytes() }
    }
}

impl AddAssign for Size {
    fn add_assign(&mut self, other: Self) {
        self.tiles += other.tiles;
        self.bytes += other.bytes;
    }
}

impl Grown {
    /// A sketch, or a tree if it grows no more and is worth it.
    fn new(sketch: Sketch, size: Size, shared: &Shared<'_>) -> Self {
        let grown = Self::Sketch(sketch, size);
        if size.tiles < PART_TILES { grown } else { Self::Tree(grown.written(shared)) }
    }

    fn written(self, shared: &Shared<'_>) -> Tree {
        match self {
            Self::Tree(tree) => tree,
            Self::Sketch(sketch, size) => {
                let tree = Tree::new(sketch, &shared.forms, shared.build.pause);
                shared.hold(tree.bytes());
                shared.held.fetch_sub(size.bytes, Ordering::Relaxed);
                tree
            }
        }
    }

    /// A tile of four.
    fn of(children: [Self; 4], tile: Tile, shared: &Shared<'_>) -> Self {
        match children {
            [Self::Sketch(a, i), Self::Sketch(b, j), Self::Sketch(c, k), Self::Sketch(d, l)] => {
                let sketch = shared.with_worker(|worker| Sketch::of([a, b, c, d], tile, &mut worker.candidates));
                let mut size = Size::of(&sketch);
                shared.hold(size.bytes);
                [i, j, k, l].into_iter().for_each(|part| size += part);
                Self::new(sketch, size, shared)
            }
            children => Self::Tree(Tree::Inner(Box::new(children.map(|child| child.written(shared))))),
        }
    }
}

struct Shared<'a> {
    build: &'a Build<'a>,
    forms: Forms<'a>,
    split_length: usize,
    split_log2: u32,
    workers: Mutex<Vec<Worker<'a>>>,
    stopped: AtomicBool,
    done: AtomicU64,
    /// Bytes of sketches' inner tiles, and of trees.
    held: AtomicU64,
    is_out_of_memory: AtomicBool,
}

impl<'a> Shared<'a> {
    fn tile(&self, tile: Tile, mut entries: Vec<Entry>, clamp: u32) -> Grown {
        let settled = self.build.rules().settle(tile, &mut entries, clamp);
        let clamp = match settled {
            Settled::Mixed { clamp } | Settled::Face { clamp, .. } if self.is_split(tile, entries.len()) => clamp,
            _ => {
                let (sketch, size) = self.with_worker(|worker| {
                    let sketch = worker.settled(tile, &entries, settled);
                    (sketch, std::mem::take(&mut worker.size))
                });
                self.hold(size.bytes);
                self.report(tile);
                return Grown::new(sketch, size, self);
            }
        };
        if let Some(sketch) = direct::sketch(self.build, tile, &entries, clamp, self.forms) {
            self.report(tile);
            return Grown::Sketch(sketch, Size::default());
        }
        let mut lists = [const { Vec::new() }; 4];
        split(self.build.arch(), self.build, tile, &entries, &mut lists);
        drop(entries);
        let children: Vec<Grown> =
            lists.into_par_iter().enumerate().map(|(i, list)| self.tile(tile.child(i as u32), list, clamp)).collect();
        match <[Grown; 4]>::try_from(children) {
            Ok(children) => Grown::of(children, tile, self),
            Err(_) => Grown::Sketch(lit(self.build.resolution().texels()), Size::default()),
        }
    }

    fn is_split(&self, tile: Tile, list: usize) -> bool {
        tile.log2 > self.split_log2 || (list > self.split_length && tile.log2 > LEAF_LOG2 + 2)
    }

    fn with_worker<R>(&self, work: impl FnOnce(&mut Worker<'a>) -> R) -> R {
        let workers = || self.workers.lock().unwrap_or_else(PoisonError::into_inner);
        let idle = workers().pop();
        let mut worker = idle.unwrap_or_else(|| Worker::new(self.build, self.forms));
        worker.stopped = self.stopped.load(Ordering::Relaxed);
        let done = work(&mut worker);
        self.stopped.fetch_or(worker.stopped, Ordering::Relaxed);
        workers().push(worker);
        done
    }

    /// Counts bytes that are held from now on.
    fn hold(&self, bytes: u64) {
        let held = self.held.fetch_add(bytes, Ordering::Relaxed) + bytes;
        if held > self.build.memory_limit {
            self.is_out_of_memory.store(true, Ordering::Relaxed);
            self.stopped.store(true, Ordering::Relaxed);
        }
    }

    fn report(&self, tile: Tile) {
        let texels = 1u64 << (2 * tile.log2);
        let done = self.done.fetch_add(texels, Ordering::Relaxed) + texels;
        let all = 1u64 << (2 * self.build.resolution().log2());
        (self.build.progress)(done as f64 / all as f64);
    }
}

fn lit(slices: u32) -> Sketch {
    Sketch::Flat(Set::constants(slices, slices))
}

struct Worker<'a> {
    build: &'a Build<'a>,
    forms: Forms<'a>,
    candidates: Candidates<'a>,
    gap: Gap,
    lists: Vec<[Vec<Entry>; 4]>,
    leaf: LeafScratch,
    /// Of the sketch in the making.
    size: Size,
    stopped: bool,
}

impl<'a> Worker<'a> {
    fn new(build: &'a Build<'a>, forms: Forms<'a>) -> Self {
        let lists = (0..=build.resolution().log2()).map(|_| [const { Vec::new() }; 4]).collect();
        let (candidates, leaf) = (Candidates::new(forms), LeafScratch::new(build.arch()));
        Self { build, forms, candidates, gap: Gap::default(), lists, leaf, size: Size::default(), stopped: false }
    }

    fn settled(&mut self, tile: Tile, entries: &[Entry], settled: Settled) -> Sketch {
        let slices = self.build.resolution().texels();
        match settled {
            _ if self.stopped => lit(slices),
            Settled::Lit => {
                self.build.record_enters(tile, [u32::MAX; 2]);
                lit(slices)
            }
            Settled::Plane { least, enter, exit, clamp } => {
                self.build.record_enters(tile, [least, enter]);
                let mut set = Set::constants(enter.min(slices), exit.min(slices));
                if !self.build.freedom.is_behind_open() {
                    add_planes(&self.forms, &mut self.gap, &mut set, tile, (entries, clamp));
                }
                Sketch::Flat(set)
            }
            Settled::Face { triangle, clamp } => {
                let span = self.face(tile, triangle);
                span.map_or_else(|| self.mixed(tile, entries, clamp), Sketch::Flat)
            }
            Settled::Mixed { clamp } => self.mixed(tile, entries, clamp),
        }
    }

    /// The depths of a tile that one open triangle hides, if its plane is right throughout.
    fn face(&mut self, tile: Tile, triangle: u32) -> Option<Set> {
        let plane = Plane::new(triangle, Side::Behind);
        let of_solid = self.build.triangles[triangle as usize].is_solid();
        let form = self.forms.plane(plane).filter(|_| !of_solid && triangle <= Plane::MOST_TRIANGLES)?;
        let [least, greatest] = self.span_of_face(tile, triangle, form)?;
        Some(Set::new([greatest, least], std::iter::once(Surface::plane(plane))))
    }

    fn span_of_face(&mut self, tile: Tile, triangle: u32, form: Form) -> Option<[u32; 2]> {
        if tile.log2 <= PAUSE_LOG2 {
            self.rest(tile);
            return self.build.arch().dispatch(leaf::Face { build: self.build, tile, triangle, form });
        }
        let mut span = [u32::MAX, 0];
        for i in 0..4 {
            let [least, greatest] = self.span_of_face(tile.child(i), triangle, form)?;
            span = [span[0].min(least), span[1].max(greatest)];
        }
        (!self.stopped).then_some(span)
    }

    fn rest(&mut self, tile: Tile) {
        if tile.log2 == PAUSE_LOG2 {
            self.stopped |= !(self.build.pause)();
        }
    }

    fn mixed(&mut self, tile: Tile, entries: &[Entry], clamp: u32) -> Sketch {
        if tile.log2 == LEAF_LOG2 {
            return leaf::sketch(&mut self.leaf, Leaf { build: self.build, tile }, entries, clamp, &self.forms);
        }
        self.rest(tile);
        if let Some(sketch) = direct::sketch(self.build, tile, entries, clamp, self.forms) {
            return sketch;
        }
        let mut lists = std::mem::take(&mut self.lists[tile.log2 as usize]);
        lists.iter_mut().for_each(Vec::clear);
        split(self.build.arch(), self.build, tile, entries, &mut lists);
        let rules = self.build.rules();
        let children = [0, 1, 2, 3].map(|i| {
            let (child, list) = (tile.child(i), &mut lists[i as usize]);
            let settled = rules.settle(child, list, clamp);
            self.settled(child, list, settled)
        });
        self.lists[tile.log2 as usize] = lists;
        let sketch = Sketch::of(children, tile, &mut self.candidates);
        self.size += Size::of(&sketch);
        sketch
    }
}
