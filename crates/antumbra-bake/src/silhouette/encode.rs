//! From sketches to the words of a pool: [`antumbra::format::silhouette`].

use std::ops::Range;

use antumbra::format::dag8::NodeCounts;
use antumbra::format::silhouette::{
    FORM_WORDS, Form, HEADER_WORDS, Kind, MOST_PAYLOAD, Pair, Turns, kind, payload, plane_of_pair, reference,
};
use arrayvec::ArrayVec;
use rustc_hash::FxHashMap;

use super::accept::Forms;
use super::form::{Plane, Second};
use super::sketch::{Set, Sketch};
use crate::dag::{EncodeError, Encoded};
use crate::pause::Pause;

/// Depths that are chosen again if they will do.
const RECENT: usize = 64;

/// Inner tiles that are written between two rests.
const REST_TILES: u32 = 1 << 10;

/// One face's tree: its nodes begin at word 0, its forms at number 0.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tree {
    forms: Vec<Form>,
    nodes: Vec<u32>,
    root: u32,
}

/// A pool that grows face by face.
#[derive(Default)]
struct Pool {
    forms: Vec<Form>,
    numbers: FxHashMap<Form, u32>,
    words: Vec<u32>,
}

impl Tree {
    /// Chooses depths. The sketch is gone bit by bit.
    pub fn new(sketch: Sketch, forms: &Forms<'_>, pause: Pause<'_>) -> Self {
        let recent = Vec::with_capacity(RECENT);
        let tree = Self::default();
        let mut writer = Writer { tree, numbers: FxHashMap::default(), forms, recent, tiles: 0, pause };
        writer.tree.root = writer.tile(sketch);
        writer.tree
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> u64 {
        (self.forms.len() * size_of::<Form>() + 4 * self.nodes.len()) as u64
    }

    pub fn is_lit(&self, slices: u32) -> bool {
        self.root == slices
    }
}

/// Writes a tree, children before their parents.
struct Writer<'a> {
    tree: Tree,
    numbers: FxHashMap<Form, u32>,
    forms: &'a Forms<'a>,
    /// Depths that were chosen lately, latest first.
    recent: Vec<u32>,
    /// Inner tiles so far.
    tiles: u32,
    pause: Pause<'a>,
}

impl Writer<'_> {
    fn tile(&mut self, sketch: Sketch) -> u32 {
        match sketch {
            Sketch::Flat(set) => self.value(&set),
            Sketch::Cut(cut) => {
                let slices = self.forms.slices.resolution().texels();
                let mut words: ArrayVec<u32, 6> = cut.edges.iter().map(|e| self.form(self.forms.edge(*e))).collect();
                let kind = if words.len() == 1 { Kind::Cut } else { Kind::Cross };
                for region in &cut.regions[..1 << words.len()] {
                    // Any depth will do for a region without texels.
                    words.push(region.as_ref().map_or(reference(Kind::Depth, slices), |set| self.value(set)));
                }
                self.node(kind, &words)
            }
            Sketch::Masks(turns) => {
                let at = self.tree.nodes.len() as u32;
                self.tree.nodes.extend(Turns::to_words(turns.iter().map(|turn| (turn.high, turn.lit))));
                reference(Kind::Masks, at)
            }
            Sketch::Inner(children) => {
                self.tiles += 1;
                if self.tiles.is_multiple_of(REST_TILES) {
                    (self.pause)();
                }
                let children = children.map(|child| self.tile(child));
                self.node(Kind::Inner, &children)
            }
        }
    }

    fn node(&mut self, kind: Kind, words: &[u32]) -> u32 {
        let at = self.tree.nodes.len() as u32;
        self.tree.nodes.extend_from_slice(words);
        reference(kind, at)
    }

    fn value(&mut self, set: &Set) -> u32 {
        let slices = self.forms.slices.resolution().texels();
        if set.low <= set.high {
            return reference(Kind::Depth, self.depth(set.low, set.high.min(slices)));
        }
        let Some(surface) = set.surfaces().next() else { return reference(Kind::Depth, slices) };
        let (pair, second) = match surface.second() {
            Second::None => return self.plane(surface.first),
            Second::Back(back) => (Pair::Wedge, back),
            Second::Nearer(other) => (Pair::Nearer, other),
            Second::Farther(other) => (Pair::Farther, other),
        };
        let planes = [surface.first, second].map(|plane| (payload(self.plane(plane)) as u32, plane.is_deep()));
        self.node(Kind::Pair, &pair.to_words(planes))
    }

    /// A plane of a set, which has a form.
    fn plane(&mut self, plane: Plane) -> u32 {
        let slices = self.forms.slices.resolution().texels();
        let Some(form) = self.forms.plane(plane) else { return reference(Kind::Depth, slices) };
        reference(if plane.is_deep() { Kind::Deep } else { Kind::Plane }, self.form(form))
    }

    /// A depth between two: lit where it may be, or nearly so with a depth that was chosen lately, which takes fewer bytes on disk.
    fn depth(&mut self, low: u32, high: u32) -> u32 {
        let least = low + (high - low).div_ceil(2);
        let known = self.recent.iter().position(|depth| (least..=high).contains(depth));
        let depth = known.map_or(high, |at| self.recent.remove(at));
        self.recent.truncate(RECENT - 1);
        self.recent.insert(0, depth);
        depth
    }

    fn form(&mut self, form: Form) -> u32 {
        number(&mut self.tree.forms, &mut self.numbers, form)
    }
}

fn number(forms: &mut Vec<Form>, numbers: &mut FxHashMap<Form, u32>, form: Form) -> u32 {
    *numbers.entry(form).or_insert_with(|| {
        forms.push(form);
        forms.len() as u32 - 1
    })
}

/// Puts faces' trees into one pool, in order.
///
/// # Errors
/// [`EncodeError`].
pub(crate) fn encode(trees: Vec<Tree>, memory_limit: u64, pause: Pause<'_>) -> Result<Encoded, EncodeError> {
    let held: u64 = trees.iter().map(Tree::bytes).sum();
    // The trees and the pool; then the pool, its streams, and what they are packed into.
    if held.saturating_mul(3) > memory_limit {
        return Err(EncodeError::MemoryLimit);
    }
    let mut pool = Pool::default();
    let mut added_forms = Vec::new();
    let numbers: Vec<Vec<u32>> = trees
        .iter()
        .map(|tree| {
            let before = pool.forms.len();
            let own = tree.forms.iter().map(|form| number(&mut pool.forms, &mut pool.numbers, *form)).collect();
            added_forms.push(pool.forms.len() - before);
            own
        })
        .collect();
    pool.words.push(pool.forms.len() as u32);
    pool.words.resize(HEADER_WORDS, 0);
    pool.words.extend(pool.forms.iter().flat_map(|form| form.to_words()));
    let nodes: usize = trees.iter().map(|tree| tree.nodes.len()).sum();
    if pool.words.len() + nodes > MOST_PAYLOAD as usize {
        return Err(EncodeError::TooManyWords);
    }
    pool.words.reserve_exact(nodes);
    let (mut roots, mut added) = (Vec::new(), Vec::new());
    for ((tree, forms), added_forms) in trees.iter().zip(&numbers).zip(added_forms) {
        let before = pool.words.len();
        pool.words.extend_from_slice(&tree.nodes);
        let nodes = &mut pool.words[before..];
        let mut moved = Moved { nodes, begin: before as u32, forms, counts: NodeCounts::default(), pause };
        roots.push(moved.tile(tree.root));
        let counts = moved.counts;
        added.push((counts, (added_forms * FORM_WORDS + tree.nodes.len()) as u64));
        if !pause() {
            return Err(EncodeError::Cancelled);
        }
    }
    Ok(Encoded { pool: pool.words, roots, added })
}

/// A tree's nodes in the pool, whose references still have to be made the pool's.
struct Moved<'a> {
    nodes: &'a mut [u32],
    /// Where they begin.
    begin: u32,
    /// The pool's number of each of the tree's forms.
    forms: &'a [u32],
    counts: NodeCounts,
    pause: Pause<'a>,
}

impl Moved<'_> {
    /// Makes the references in a tile the pool's; returns the one to it.
    fn tile(&mut self, tile: u32) -> u32 {
        let at = payload(tile);
        match kind(tile) {
            Kind::Inner => {
                self.counts.inner += 1;
                if self.counts.inner.is_multiple_of(REST_TILES.into()) {
                    (self.pause)();
                }
                self.tiles(at..at + 4);
            }
            Kind::Cut | Kind::Cross => {
                self.counts.cuts += 1;
                let edges = if kind(tile) == Kind::Cut { 1 } else { 2 };
                for edge in &mut self.nodes[at..at + edges] {
                    *edge = self.forms[*edge as usize];
                }
                self.tiles(at + edges..at + edges + (1 << edges));
            }
            Kind::Pair => {
                let pair = Pair::of(self.nodes[at]);
                let planes = [self.nodes[at], self.nodes[at + 1]].map(plane_of_pair);
                let words = pair.to_words(planes.map(|(number, is_deep)| (self.forms[number], is_deep)));
                self.nodes[at..at + 2].copy_from_slice(&words);
            }
            Kind::Masks => self.counts.masks += u64::from(self.nodes[at]),
            Kind::Plane | Kind::Deep => return reference(kind(tile), self.forms[at]),
            Kind::Depth => return tile,
        }
        reference(kind(tile), self.begin + at as u32)
    }

    fn tiles(&mut self, places: Range<usize>) {
        for place in places {
            self.nodes[place] = self.tile(self.nodes[place]);
        }
    }
}
