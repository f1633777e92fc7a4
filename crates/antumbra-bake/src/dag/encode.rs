//! Numbers the nodes in canonical order and writes them as `dag8` words: see [`antumbra::format::dag8`].

use antumbra::format::dag8::{NodeCounts, POOL_HEADER_WORDS, SLICE_LEVEL, mean_bits};
use rayon::prelude::*;

use super::order::{Order, is_homogeneous, node_words};
use super::table::{Id, Tables};
use crate::Pause;

/// A pool of words with the lights' roots.
pub struct Encoded {
    /// The `DAG8` section.
    pub pool: Vec<u32>,
    /// One reference per root that was given.
    pub roots: Vec<u32>,
    /// For each root: nodes first met there (what earlier roots reach is theirs) and their words.
    pub added: Vec<(NodeCounts, u64)>,
}

/// Why nodes cannot be encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EncodeError {
    /// References have 32 bits.
    #[error("the pool would have 2^32 words or more")]
    TooManyWords,
    /// The nodes, their order and the file together outgrow the limit.
    #[error("encoding needs more than the memory limit")]
    MemoryLimit,
    /// The pause said so.
    #[error("encoding was cancelled")]
    Cancelled,
}

/// Encodes what is reachable from (root, level) pairs, in time and memory in proportion to the tables.
///
/// # Errors
/// [`EncodeError`]; the limit, in bytes, holds for the tables, the work on them and the finished file.
pub fn encode(
    tables: Tables,
    roots: &[(Id, u32)],
    memory_limit: u64,
    pause: Pause<'_>,
) -> Result<Encoded, EncodeError> {
    let tables_bytes = tables.bytes();
    let fits = |bytes: u64| if bytes <= memory_limit { Ok(()) } else { Err(EncodeError::MemoryLimit) };
    // A word, a share and an entry in the order, and in a stretch's, for every key of some 40 bytes with its slots, which
    // are given back.
    let order_bytes = tables_bytes / 5 * 2;
    fits(tables_bytes + order_bytes)?;
    let order = Order::new(tables, roots, pause).ok_or(EncodeError::Cancelled)?;
    let words = order.words() + POOL_HEADER_WORDS as u64;
    u32::try_from(words).map_err(|_| EncodeError::TooManyWords)?;
    fits((tables_bytes + order_bytes + 4 * words).max(8 * words))?;
    let layout = Layout::new(&order);
    let roots = roots.iter().map(|&(id, level)| layout.reference(id, level)).collect();
    let pool = layout.write(pause);
    let added = order.discard(pause);
    Ok(Encoded { pool, roots, added })
}

/// Where the parts of a pool begin.
struct Layout<'a> {
    order: &'a Order,
    slices_at: u32,
    inner_at: u32,
}

/// Nodes that a thread writes at a time.
const PIECE: usize = 1 << 12;

impl<'a> Layout<'a> {
    fn new(order: &'a Order) -> Self {
        let slices_at = POOL_HEADER_WORDS as u32 + order.masks.words as u32;
        Self { order, slices_at, inner_at: slices_at + order.slices.words as u32 }
    }

    /// Reference to a node of 2^level voxels per side.
    fn reference(&self, id: Id, level: u32) -> u32 {
        match level {
            _ if is_homogeneous(id) => id,
            SLICE_LEVEL => self.slices_at + self.order.slices.word(id),
            _ => self.inner_at + self.order.inner.word(id),
        }
    }

    fn write(&self, pause: Pause<'_>) -> Vec<u32> {
        let Self { order, .. } = *self;
        let parts = [order.masks.words, order.slices.words, order.inner.words].map(|words| words as usize);
        let mut pool = vec![0; POOL_HEADER_WORDS + parts.iter().sum::<usize>()];
        let (header, rest) = pool.split_at_mut(POOL_HEADER_WORDS);
        header[..3].copy_from_slice(&parts.map(|words| words as u32));
        let (masks, rest) = rest.split_at_mut(parts[0]);
        let (slices, inner) = rest.split_at_mut(parts[1]);
        masks.par_chunks_mut(2 * PIECE).zip(order.masks.order.par_chunks(PIECE)).for_each(|(words, masks)| {
            for (words, &id) in words.chunks_exact_mut(2).zip(masks) {
                let lit = order.masks.key(id);
                words.copy_from_slice(&[lit as u32, (lit >> 32) as u32]);
            }
            pause();
        });
        let mask = |id| POOL_HEADER_WORDS as u32 + order.masks.word(id);
        pieces(slices, &order.slices.order, |id| order.slices.word(id)).into_par_iter().for_each(|piece| {
            piece.write(|id, _| (order.slices.key(id).0, order.share(id, SLICE_LEVEL)), |id, _| mask(id));
            pause();
        });
        pieces(inner, &order.inner.order, |id| order.inner.word(id)).into_par_iter().for_each(|piece| {
            // Any level above the children's will do.
            let level = |place: usize| if order.holds_slices[place] { SLICE_LEVEL + 1 } else { SLICE_LEVEL + 2 };
            piece.write(
                |id, place| (order.inner.key(id).0, order.share(id, level(place))),
                |child, place| self.reference(child, level(place) - 1),
            );
            pause();
        });
        pool
    }
}

/// Nodes that follow one another, and their words.
struct Piece<'a> {
    words: &'a mut [u32],
    nodes: &'a [Id],
    /// Place in the order of the first node.
    first: usize,
}

/// Cuts a part of the pool where pieces of its order begin.
fn pieces<'a>(mut words: &'a mut [u32], order: &'a [Id], word: impl Fn(Id) -> u32) -> Vec<Piece<'a>> {
    let mut pieces = Vec::new();
    let mut begin = 0;
    for (i, nodes) in order.chunks(PIECE).enumerate() {
        let first = i * PIECE;
        let next = order.get(first + PIECE).map_or(begin + words.len(), |id| word(*id) as usize);
        let (own, rest) = words.split_at_mut(next - begin);
        pieces.push(Piece { words: own, nodes, first });
        (words, begin) = (rest, next);
    }
    pieces
}

impl Piece<'_> {
    /// Writes each node: a header word, then a reference per mixed child.
    fn write(self, node: impl Fn(Id, usize) -> ([Id; 8], u64), reference: impl Fn(Id, usize) -> u32) {
        let mut words = self.words;
        for (place, &id) in (self.first..).zip(self.nodes) {
            let (children, share) = node(id, place);
            let (own, rest) = words.split_at_mut(node_words(&children));
            let code = |child: Id| if is_homogeneous(child) { child } else { 2 };
            let codes = children.iter().enumerate().fold(0, |header, (i, child)| header | (code(*child) << (2 * i)));
            own[0] = codes | mean_bits(share);
            let mixed = children.iter().filter(|child| !is_homogeneous(**child));
            own[1..].iter_mut().zip(mixed).for_each(|(word, child)| *word = reference(*child, place));
            words = rest;
        }
    }
}
