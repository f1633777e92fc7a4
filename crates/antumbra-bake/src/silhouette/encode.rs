//! From trees to the words of a pool: [`antumbra::format::silhouette`].

use std::ops::Range;

use antumbra::format::dag8::NodeCounts;
use antumbra::format::silhouette::{
    FORM_WORDS, HEADER_WORDS, Kind, MOST_PAYLOAD, Pair, Turns, kind, payload, plane_of_pair, reference,
};
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::tree::{Part, Tree, number};
use crate::dag::{EncodeError, Encoded};
use crate::pause::Pause;

/// Inner tiles that are moved between two rests.
const REST_TILES: u64 = 1 << 10;

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
    let mut forms = Vec::new();
    let mut known = FxHashMap::default();
    let (mut numbers, mut added_forms) = (Vec::new(), Vec::new());
    for tree in &trees {
        let before = forms.len();
        tree.for_each_part(&mut |part| {
            let own = part.forms.iter().map(|form| number(&mut forms, &mut known, *form));
            numbers.push(own.collect());
        });
        added_forms.push(forms.len() - before);
    }
    let mut pool = vec![forms.len() as u32];
    pool.resize(HEADER_WORDS, 0);
    pool.extend(forms.iter().flat_map(|form| form.to_words()));
    if pool.len() + trees.iter().map(Tree::words).sum::<usize>() > MOST_PAYLOAD as usize {
        return Err(EncodeError::TooManyWords);
    }
    let mut layout = Layout { numbers: numbers.into_iter(), next: pool.len(), pieces: Vec::new() };
    let (mut roots, mut pieces_of) = (Vec::new(), Vec::new());
    for tree in &trees {
        let before = layout.pieces.len();
        roots.push(layout.tile(tree));
        pieces_of.push(before..layout.pieces.len());
    }
    let (first_node, pieces) = (pool.len(), layout.pieces);
    pool.resize(layout.next, 0);
    let mut rest = &mut pool[first_node..];
    let places: Vec<&mut [u32]> = pieces
        .iter()
        .map(|piece| {
            let (place, later) = std::mem::take(&mut rest).split_at_mut(piece.words());
            rest = later;
            place
        })
        .collect();
    let counts: Vec<NodeCounts> =
        pieces.par_iter().zip(places).map(|(piece, place)| piece.write(place, pause)).collect();
    if !pause() {
        return Err(EncodeError::Cancelled);
    }
    let added = pieces_of
        .into_iter()
        .zip(added_forms)
        .map(|(range, forms)| {
            let words: usize = pieces[range.clone()].iter().map(Piece::words).sum();
            (sum(&counts[range]), (forms * FORM_WORDS + words) as u64)
        })
        .collect();
    Ok(Encoded { pool, roots, added })
}

fn sum(counts: &[NodeCounts]) -> NodeCounts {
    counts.iter().fold(NodeCounts::default(), |sum, own| NodeCounts {
        inner: sum.inner + own.inner,
        slices: sum.slices + own.slices,
        masks: sum.masks + own.masks,
        cuts: sum.cuts + own.cuts,
    })
}

/// What lies where in the pool.
struct Layout<'a> {
    /// Of each part of the trees, in order: the pool's numbers of its forms.
    numbers: std::vec::IntoIter<Vec<u32>>,
    /// The word at which the next piece begins.
    next: usize,
    pieces: Vec<Piece<'a>>,
}

/// Words of the pool that follow one another.
enum Piece<'a> {
    Part {
        part: &'a Part,
        /// The pool's number of each of its forms.
        forms: Vec<u32>,
        /// Where its nodes begin.
        begin: u32,
    },
    /// An inner tile.
    Inner([u32; 4]),
}

impl<'a> Layout<'a> {
    /// Lays out a tree; returns the pool's reference to it.
    fn tile(&mut self, tree: &'a Tree) -> u32 {
        let (root, piece) = match tree {
            Tree::Part(part) => {
                let (forms, begin) = (self.numbers.next().unwrap_or_default(), self.next as u32);
                (in_pool(part.root, &forms, begin), Piece::Part { part, forms, begin })
            }
            Tree::Inner(children) => {
                let children = children.each_ref().map(|child| self.tile(child));
                (reference(Kind::Inner, self.next as u32), Piece::Inner(children))
            }
        };
        self.next += piece.words();
        self.pieces.push(piece);
        root
    }
}

impl Piece<'_> {
    fn words(&self) -> usize {
        match self {
            Self::Part { part, .. } => part.nodes.len(),
            Self::Inner(children) => children.len(),
        }
    }

    /// Writes it to its place.
    fn write(&self, place: &mut [u32], pause: Pause<'_>) -> NodeCounts {
        match self {
            Self::Part { part, forms, begin } => {
                pause();
                place.copy_from_slice(&part.nodes);
                let mut moved = Moved { nodes: place, begin: *begin, forms, counts: NodeCounts::default(), pause };
                moved.tile(part.root);
                moved.counts
            }
            Self::Inner(children) => {
                place.copy_from_slice(children);
                NodeCounts { inner: 1, ..NodeCounts::default() }
            }
        }
    }
}

/// The pool's reference for a part's.
fn in_pool(own: u32, forms: &[u32], begin: u32) -> u32 {
    match kind(own) {
        Kind::Depth => own,
        Kind::Plane | Kind::Deep => reference(kind(own), forms[payload(own)]),
        _ => reference(kind(own), begin + payload(own) as u32),
    }
}

/// A part's nodes in the pool, whose references still have to be made the pool's.
struct Moved<'a> {
    nodes: &'a mut [u32],
    /// Where they begin.
    begin: u32,
    /// The pool's number of each of the part's forms.
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
                if self.counts.inner.is_multiple_of(REST_TILES) {
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
            Kind::Masks => self.counts.masks += Turns::read(self.nodes, at).count() as u64,
            Kind::Plane | Kind::Deep | Kind::Depth => {}
        }
        in_pool(tile, self.forms, self.begin)
    }

    fn tiles(&mut self, places: Range<usize>) {
        for place in places {
            self.nodes[place] = self.tile(self.nodes[place]);
        }
    }
}
