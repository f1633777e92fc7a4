//! The recursion: tiles down, sketches up, on many threads.

use std::sync::Mutex;
use std::sync::PoisonError;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use rayon::prelude::*;

use antumbra::format::silhouette::Form;

use super::accept::{Candidates, Forms};
use super::form::{Plane, Side, Surface};
use super::gap::{Gap, add_planes};
use super::leaf;
use super::sketch::{Set, Sketch};
use crate::columns::{Build, BuildError, Entry, LEAF_LOG2, Leaf, LeafScratch, Settled, Tile, root_entries, split};

/// Tiles whose lists are longer than this share of all triangles are split over threads.
const SPLIT_SHARE: usize = 256;
/// Tiles of at least this share of the light's side (as a power of two) are split over threads.
const SPLIT_LEVELS: u32 = 5;
/// Tiles of this size may rest.
const PAUSE_LOG2: u32 = 5;

/// Sketches one face of a light.
///
/// # Errors
/// [`BuildError`].
pub(crate) fn sketch(build: &Build<'_>) -> Result<Sketch, BuildError> {
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
    let sketch = shared.tile(root, entries, resolution.texels());
    if shared.is_out_of_memory.load(Ordering::Relaxed) {
        return Err(BuildError::MemoryLimit);
    }
    if shared.stopped.load(Ordering::Relaxed) {
        return Err(BuildError::Cancelled);
    }
    Ok(sketch)
}

struct Shared<'a> {
    build: &'a Build<'a>,
    forms: Forms<'a>,
    split_length: usize,
    split_log2: u32,
    workers: Mutex<Vec<Worker<'a>>>,
    stopped: AtomicBool,
    done: AtomicU64,
    /// Bytes of sketches that no longer change.
    held: AtomicU64,
    is_out_of_memory: AtomicBool,
}

impl<'a> Shared<'a> {
    fn tile(&self, tile: Tile, mut entries: Vec<Entry>, clamp: u32) -> Sketch {
        let settled = self.build.rules().settle(tile, &mut entries, clamp);
        let clamp = match settled {
            Settled::Mixed { clamp } | Settled::Face { clamp, .. } if self.is_split(tile, entries.len()) => clamp,
            _ => {
                let sketch = self.with_worker(|worker| worker.settled(tile, &entries, settled));
                self.report(tile);
                return sketch;
            }
        };
        let mut lists = [const { Vec::new() }; 4];
        split(self.build.arch(), self.build, tile, &entries, &mut lists);
        drop(entries);
        let children: Vec<Sketch> =
            lists.into_par_iter().enumerate().map(|(i, list)| self.tile(tile.child(i as u32), list, clamp)).collect();
        match <[Sketch; 4]>::try_from(children) {
            Ok(children) => self.with_worker(|worker| Sketch::of(children, tile, &mut worker.candidates)),
            Err(_) => lit(self.build.resolution().texels()),
        }
    }

    fn is_split(&self, tile: Tile, list: usize) -> bool {
        tile.log2 > self.split_log2 || (list > self.split_length && tile.log2 > LEAF_LOG2 + 2)
    }

    fn with_worker(&self, work: impl FnOnce(&mut Worker<'a>) -> Sketch) -> Sketch {
        let workers = || self.workers.lock().unwrap_or_else(PoisonError::into_inner);
        let idle = workers().pop();
        let mut worker = idle.unwrap_or_else(|| Worker::new(self.build, self.forms));
        worker.stopped = self.stopped.load(Ordering::Relaxed);
        let sketch = work(&mut worker);
        let held = self.held.fetch_add(std::mem::take(&mut worker.held), Ordering::Relaxed);
        if held > self.build.memory_limit {
            self.is_out_of_memory.store(true, Ordering::Relaxed);
            worker.stopped = true;
        }
        self.stopped.fetch_or(worker.stopped, Ordering::Relaxed);
        workers().push(worker);
        sketch
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
    /// Bytes of sketches that no longer change, not yet told.
    held: u64,
    stopped: bool,
}

impl<'a> Worker<'a> {
    fn new(build: &'a Build<'a>, forms: Forms<'a>) -> Self {
        let lists = (0..=build.resolution().log2()).map(|_| [const { Vec::new() }; 4]).collect();
        let (candidates, leaf) = (Candidates::new(forms), LeafScratch::new(build.arch()));
        Self { build, forms, candidates, gap: Gap::default(), lists, leaf, held: 0, stopped: false }
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
        self.held += sketch.own_bytes();
        sketch
    }
}
