//! The canonical order of nodes: masks and slice nodes as first met by a depth-first walk from the roots, inner nodes
//! behind their children.
//!
//! The walk is split into stretches that threads walk side by side, each as if it were the first: it then meets what the
//! earlier stretches meet, too. A node that one of those has met stands there, with everything below it; what is left of a
//! stretch's own order is exactly what one walk would have met in it.

use std::sync::atomic::{AtomicU64, Ordering};

use antumbra::format::dag8::{NodeCounts, SLICE_LEVEL, WHOLE, slice_node_share};
use bytemuck::allocation::zeroed_vec;
use rayon::prelude::*;

use super::table::{self, Children, FastHash, Id, LIT, NodeTable, SHADOWED, Tables};
use crate::Pause;

/// Stretches per thread: more would balance better, and meet more nodes twice.
const STRETCHES_PER_THREAD: usize = 8;
/// A root is taken apart into subtrees down to so many levels below it.
const SPLIT_LEVELS: u32 = 3;

/// Every node that the roots reach, in order.
pub(super) struct Order {
    pub masks: Part<u64>,
    pub slices: Part<Children>,
    pub inner: Part<Children>,
    /// Whether each inner node in `inner.order` holds slice nodes.
    pub holds_slices: Vec<bool>,
    /// Lit shares of nodes, by their index: see [`WHOLE`].
    slice_shares: Vec<AtomicU64>,
    inner_shares: Vec<AtomicU64>,
    /// For each root, nodes first met there and their words.
    pub added: Vec<(NodeCounts, u64)>,
}

/// One kind of node.
pub(super) struct Part<K> {
    keys: Vec<Vec<K>>,
    /// Index of each shard's first key.
    begins: Vec<usize>,
    /// First word of each node within the part plus 1, by the node's index; [`UNMET`] before.
    words_at: Vec<u32>,
    pub order: Vec<Id>,
    pub words: u64,
}

/// No word: the node has not been met. Zero, because zeroed memory costs nothing until it is touched.
const UNMET: u32 = 0;

pub(super) fn is_homogeneous(id: Id) -> bool {
    id == LIT || id == SHADOWED
}

/// Words of a node: a header and a reference per mixed child.
pub(super) fn node_words(children: &[Id; 8]) -> usize {
    1 + children.iter().filter(|c| !is_homogeneous(**c)).count()
}

impl<K: Copy + Eq + FastHash> Part<K> {
    fn new(table: NodeTable<K>, pause: Pause<'_>) -> Self {
        let keys = table.into_keys(pause);
        let begins: Vec<usize> = keys
            .iter()
            .scan(0, |begin, shard| {
                *begin += shard.len();
                Some(*begin - shard.len())
            })
            .collect();
        let length = keys.iter().map(Vec::len).sum();
        Self { keys, begins, words_at: vec![UNMET; length], order: Vec::with_capacity(length), words: 0 }
    }

    fn length(&self) -> usize {
        self.words_at.len()
    }

    fn index(&self, id: Id) -> usize {
        let (shard, local) = table::place(id);
        self.begins[shard] + local
    }

    pub fn key(&self, id: Id) -> K {
        let (shard, local) = table::place(id);
        self.keys[shard][local]
    }

    /// First word of a node within the part.
    pub fn word(&self, id: Id) -> u32 {
        self.words_at[self.index(id)] - 1
    }

    /// Appends a node of so many words, unless it has been met; whether it had not.
    fn meet(&mut self, id: Id, words: u8) -> bool {
        let index = self.index(id);
        let is_new = self.words_at[index] == UNMET;
        if is_new {
            self.words_at[index] = self.words as u32 + 1;
            self.words += u64::from(words);
            self.order.push(id);
        }
        is_new
    }
}

/// Nodes between two rests.
const PAUSE_NODES: u32 = 1 << 11;

/// Whether to go on.
#[inline]
fn rest_now_and_then(count: &mut u32, pause: Pause<'_>) -> bool {
    *count += 1;
    !count.is_multiple_of(PAUSE_NODES) || pause()
}

/// A part of the walk.
#[derive(Clone, Copy)]
struct Item {
    root: usize,
    id: Id,
    level: u32,
    /// The node alone: what is below it are earlier items.
    alone: bool,
}

/// A node as a stretch meets it.
#[derive(Clone, Copy)]
struct MetNode {
    id: Id,
    level: u8,
    words: u8,
    /// See [`Item`].
    alone: bool,
}

/// What a stretch has met, in its own order.
#[derive(Default)]
struct Met {
    masks: Vec<Id>,
    slices: Vec<MetNode>,
    inner: Vec<MetNode>,
    /// Item by item: its root, and how many of each kind have been met when it ends.
    ends: Vec<(usize, [usize; 3])>,
}

/// A thread's walk.
struct Walk<'a> {
    order: &'a Order,
    pause: Pause<'a>,
    count: u32,
    /// The pause said to give up.
    stopped: bool,
    met: Met,
    met_masks: Bits,
    met_slices: Bits,
    met_inner: Bits,
}

/// A set of indices.
struct Bits {
    words: Vec<u64>,
}

impl Bits {
    fn new(length: usize) -> Self {
        Self { words: vec![0; length.div_ceil(64)] }
    }

    /// Whether the index was not there.
    fn insert(&mut self, index: usize) -> bool {
        let (word, bit) = (&mut self.words[index / 64], 1 << (index % 64));
        let is_new = *word & bit == 0;
        *word |= bit;
        is_new
    }
}

impl Order {
    /// Orders what is reachable from (root, level) pairs; `None` if the pause says so.
    pub fn new(tables: Tables, roots: &[(Id, u32)], pause: Pause<'_>) -> Option<Self> {
        let masks = Part::new(tables.masks, pause);
        let slices = Part::new(tables.slices, pause);
        let inner = Part::new(tables.inner, pause);
        let mut order = Self {
            slice_shares: zeroed_vec(slices.length()),
            inner_shares: zeroed_vec(inner.length()),
            holds_slices: Vec::with_capacity(inner.length()),
            masks,
            slices,
            inner,
            added: vec![(NodeCounts::default(), 0); roots.len()],
        };
        let mut items = Vec::new();
        let threads = rayon::current_num_threads();
        let split_levels = if threads > 1 { SPLIT_LEVELS } else { 0 };
        for (root, &(id, level)) in roots.iter().enumerate() {
            order.push_items(root, id, level, split_levels, &mut items);
        }
        let stretches = if threads > 1 { STRETCHES_PER_THREAD * threads } else { 1 };
        let length = items.len().div_ceil(stretches).max(1);
        let met: Vec<Met> =
            items.par_chunks(length).with_max_len(1).map(|stretch| Walk::new(&order, pause).stretch(stretch)).collect();
        met.into_iter().for_each(|stretch| order.append(&stretch, pause));
        pause().then_some(order)
    }

    fn push_items(&self, root: usize, id: Id, level: u32, split_levels: u32, items: &mut Vec<Item>) {
        if is_homogeneous(id) {
            return;
        }
        if split_levels == 0 || level <= SLICE_LEVEL + 1 {
            return items.push(Item { root, id, level, alone: false });
        }
        for child in self.inner.key(id).0 {
            self.push_items(root, child, level - 1, split_levels - 1, items);
        }
        items.push(Item { root, id, level, alone: true });
    }

    /// Appends those nodes of a stretch that no earlier one has met.
    fn append(&mut self, stretch: &Met, pause: Pause<'_>) {
        let mut count = 0;
        let mut begin = [0; 3];
        for &(root, end) in &stretch.ends {
            let words = self.words();
            let mut counts = NodeCounts::default();
            for &id in &stretch.masks[begin[0]..end[0]] {
                rest_now_and_then(&mut count, pause);
                counts.masks += u64::from(self.masks.meet(id, 2));
            }
            for node in &stretch.slices[begin[1]..end[1]] {
                rest_now_and_then(&mut count, pause);
                counts.slices += u64::from(self.slices.meet(node.id, node.words));
            }
            for node in &stretch.inner[begin[2]..end[2]] {
                rest_now_and_then(&mut count, pause);
                if self.inner.meet(node.id, node.words) {
                    counts.inner += 1;
                    self.holds_slices.push(u32::from(node.level) == SLICE_LEVEL + 1);
                    if node.alone {
                        // Its children's shares are known by now.
                        self.set_inner_share(node.id, node.level.into());
                    }
                }
            }
            let words = self.words() - words;
            let added = &mut self.added[root];
            added.0.masks += counts.masks;
            added.0.slices += counts.slices;
            added.0.inner += counts.inner;
            added.1 += words;
            begin = end;
        }
    }

    /// Gives the memory back, bit by bit; what each root added is left.
    pub fn discard(mut self, pause: Pause<'_>) -> Vec<(NodeCounts, u64)> {
        self.slices.keys.drain(..).chain(self.inner.keys.drain(..)).for_each(|shard| {
            drop(shard);
            pause();
        });
        self.added
    }

    pub fn words(&self) -> u64 {
        self.masks.words + self.slices.words + self.inner.words
    }

    /// The lit share of a node of 2^level voxels per side: see [`WHOLE`].
    pub fn share(&self, id: Id, level: u32) -> u64 {
        match id {
            LIT => WHOLE,
            SHADOWED => 0,
            _ if level == SLICE_LEVEL => self.slice_shares[self.slices.index(id)].load(Ordering::Relaxed),
            _ => self.inner_shares[self.inner.index(id)].load(Ordering::Relaxed),
        }
    }

    fn set_inner_share(&self, id: Id, level: u32) {
        let share = self.inner.key(id).0.iter().map(|child| self.share(*child, level - 1) / 8).sum();
        self.inner_shares[self.inner.index(id)].store(share, Ordering::Relaxed);
    }
}

impl<'a> Walk<'a> {
    fn new(order: &'a Order, pause: Pause<'a>) -> Self {
        Self {
            order,
            pause,
            count: 0,
            stopped: false,
            met: Met::default(),
            met_masks: Bits::new(order.masks.length()),
            met_slices: Bits::new(order.slices.length()),
            met_inner: Bits::new(order.inner.length()),
        }
    }

    fn stretch(mut self, items: &[Item]) -> Met {
        for item in items {
            if item.alone {
                let words = node_words(&self.order.inner.key(item.id).0) as u8;
                self.met.inner.push(MetNode { id: item.id, level: item.level as u8, words, alone: true });
            } else {
                self.visit(item.id, item.level);
            }
            let lengths = [self.met.masks.len(), self.met.slices.len(), self.met.inner.len()];
            self.met.ends.push((item.root, lengths));
        }
        self.met
    }

    /// Visits a node and what is below it, unless that has been done; its lit share.
    fn visit(&mut self, id: Id, level: u32) -> u64 {
        if level == SLICE_LEVEL {
            return self.visit_slices(id);
        }
        let order = self.order;
        let index = order.inner.index(id);
        let share_of_node = &order.inner_shares[index];
        if self.stopped || !self.met_inner.insert(index) {
            return share_of_node.load(Ordering::Relaxed);
        }
        self.stopped |= !rest_now_and_then(&mut self.count, self.pause);
        let (mut share, mut words) = (0, 1);
        for child in order.inner.key(id).0 {
            share += match child {
                LIT => WHOLE / 8,
                SHADOWED => 0,
                child => {
                    words += 1;
                    self.visit(child, level - 1) / 8
                }
            };
        }
        share_of_node.store(share, Ordering::Relaxed);
        self.met.inner.push(MetNode { id, level: level as u8, words, alone: false });
        share
    }

    fn visit_slices(&mut self, id: Id) -> u64 {
        let order = self.order;
        let index = order.slices.index(id);
        let share_of_node = &order.slice_shares[index];
        if !self.met_slices.insert(index) {
            return share_of_node.load(Ordering::Relaxed);
        }
        let (mut lit, mut words) = (0, 1);
        for mask in order.slices.key(id).0 {
            lit += match mask {
                LIT => 64,
                SHADOWED => 0,
                mask => {
                    words += 1;
                    if self.met_masks.insert(order.masks.index(mask)) {
                        self.met.masks.push(mask);
                    }
                    order.masks.key(mask).count_ones()
                }
            };
        }
        let share = slice_node_share(lit);
        share_of_node.store(share, Ordering::Relaxed);
        self.met.slices.push(MetNode { id, level: SLICE_LEVEL as u8, words, alone: false });
        share
    }
}
