//! Numbers the nodes in canonical order and writes them as `dag8` words: see [`antumbra::format::dag8`].

use antumbra::format::dag8::{NodeCounts, POOL_HEADER_WORDS, SLICE_LEVEL, WHOLE, mean_bits, slice_node_share};

use super::table::{self, Id, LIT, SHADOWED, Tables};

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
}

/// Encodes what is reachable from (root, level) pairs, in time and memory in proportion to the tables.
///
/// # Errors
/// [`EncodeError`]; the limit, in bytes, holds for the tables, the work on them and the finished file.
pub fn encode(tables: Tables, roots: &[(Id, u32)], memory_limit: u64) -> Result<Encoded, EncodeError> {
    let tables_bytes = tables.bytes();
    let fits = |bytes: u64| if bytes <= memory_limit { Ok(()) } else { Err(EncodeError::MemoryLimit) };
    // A rank, a word and an entry in the order for every key, and for nodes, which are longer, a share.
    let order_bytes = tables_bytes / 3 * 2;
    fits(tables_bytes + order_bytes)?;
    let mut order = Order::new(tables);
    let mut added = Vec::with_capacity(roots.len());
    for &(root, level) in roots {
        let (counts, words) = (order.counts(), order.words());
        order.visit(root, level);
        let now = order.counts();
        let counts = NodeCounts {
            inner: now.inner - counts.inner,
            slices: now.slices - counts.slices,
            masks: now.masks - counts.masks,
        };
        added.push((counts, order.words() - words));
    }
    let words = order.words() + POOL_HEADER_WORDS as u64;
    u32::try_from(words).map_err(|_| EncodeError::TooManyWords)?;
    fits((tables_bytes + order_bytes + 4 * words).max(8 * words))?;
    let (pool, roots) = order.write(roots);
    Ok(Encoded { pool, roots, added })
}

/// The canonical order: masks and slice nodes as first met by a depth-first walk, inner nodes behind their children.
struct Order {
    masks: Part<u64>,
    slices: Part<[Id; 8]>,
    inner: Part<[Id; 8]>,
    /// Level of each inner node in `inner.order`.
    levels: Vec<u8>,
}

/// One kind of node, in the order of meeting.
struct Part<K> {
    keys: Vec<Vec<K>>,
    /// Place in the order of each key, once met.
    rank: Vec<Vec<u32>>,
    order: Vec<Id>,
    /// Word within the part, by rank.
    words_at: Vec<u32>,
    words: u64,
}

const UNMET: u32 = u32::MAX;

impl<K: Copy> Part<K> {
    fn new(keys: Vec<Vec<K>>) -> Self {
        let rank = keys.iter().map(|shard| vec![UNMET; shard.len()]).collect();
        Self { keys, rank, order: Vec::new(), words_at: Vec::new(), words: 0 }
    }

    fn key(&self, id: Id) -> K {
        let (shard, local) = table::place(id);
        self.keys[shard][local]
    }

    fn rank(&self, id: Id) -> usize {
        let (shard, local) = table::place(id);
        self.rank[shard][local] as usize
    }

    fn word(&self, id: Id) -> u32 {
        self.words_at[self.rank(id)]
    }

    fn is_met(&self, id: Id) -> bool {
        self.rank(id) != UNMET as usize
    }

    fn meet(&mut self, id: Id, words: usize) {
        let (shard, local) = table::place(id);
        self.rank[shard][local] = self.order.len() as u32;
        self.order.push(id);
        self.words_at.push(self.words as u32);
        self.words += words as u64;
    }
}

fn is_homogeneous(id: Id) -> bool {
    id == LIT || id == SHADOWED
}

fn node_words(children: &[Id; 8]) -> usize {
    1 + children.iter().filter(|c| !is_homogeneous(**c)).count()
}

impl Order {
    fn new(tables: Tables) -> Self {
        Self {
            masks: Part::new(tables.masks.into_keys()),
            slices: Part::new(tables.slices.into_keys()),
            inner: Part::new(tables.inner.into_keys()),
            levels: Vec::new(),
        }
    }

    fn words(&self) -> u64 {
        self.masks.words + self.slices.words + self.inner.words
    }

    fn counts(&self) -> NodeCounts {
        let count = |order: &[Id]| order.len() as u64;
        NodeCounts {
            inner: count(&self.inner.order),
            slices: count(&self.slices.order),
            masks: count(&self.masks.order),
        }
    }

    fn visit(&mut self, id: Id, level: u32) {
        if is_homogeneous(id) {
            return;
        }
        if level == SLICE_LEVEL {
            self.visit_slices(id);
        } else if !self.inner.is_met(id) {
            let children = self.inner.key(id);
            children.iter().for_each(|child| self.visit(*child, level - 1));
            self.inner.meet(id, node_words(&children));
            self.levels.push(level as u8);
        }
    }

    fn visit_slices(&mut self, id: Id) {
        if self.slices.is_met(id) {
            return;
        }
        let children = self.slices.key(id);
        for mask in children {
            if !is_homogeneous(mask) && !self.masks.is_met(mask) {
                self.masks.meet(mask, 2);
            }
        }
        self.slices.meet(id, node_words(&children));
    }

    /// The lit share of a slice node.
    fn slice_share(&self, slices: &[Id; 8]) -> u64 {
        let lit = |id: &Id| match *id {
            LIT => 64,
            SHADOWED => 0,
            mask => self.masks.key(mask).count_ones(),
        };
        slice_node_share(slices.iter().map(lit).sum())
    }

    /// The pool, and the roots' references.
    fn write(&self, roots: &[(Id, u32)]) -> (Vec<u32>, Vec<u32>) {
        let sizes = [self.masks.words, self.slices.words, self.inner.words].map(|w| w as u32);
        let masks_at = POOL_HEADER_WORDS as u32;
        let slices_at = masks_at + sizes[0];
        let inner_at = slices_at + sizes[1];
        let mask = |id| masks_at + self.masks.word(id);
        let node = |id, level| match level {
            SLICE_LEVEL => slices_at + self.slices.word(id),
            _ => inner_at + self.inner.word(id),
        };
        let mut pool = Vec::with_capacity(POOL_HEADER_WORDS + self.words() as usize);
        pool.extend(sizes);
        pool.resize(POOL_HEADER_WORDS, 0);
        for &id in &self.masks.order {
            let lit = self.masks.key(id);
            pool.extend([lit as u32, (lit >> 32) as u32]);
        }
        let slice_shares: Vec<u64> =
            self.slices.order.iter().map(|id| self.slice_share(&self.slices.key(*id))).collect();
        for (&id, &share) in self.slices.order.iter().zip(&slice_shares) {
            push_node(&mut pool, self.slices.key(id), share, mask);
        }
        let mut shares: Vec<u64> = Vec::with_capacity(self.inner.order.len());
        for (&id, &level) in self.inner.order.iter().zip(&self.levels) {
            let (children, below) = (self.inner.key(id), u32::from(level) - 1);
            let share = |child: &Id| match *child {
                LIT => WHOLE / 8,
                SHADOWED => 0,
                child if below == SLICE_LEVEL => slice_shares[self.slices.rank(child)] / 8,
                child => shares[self.inner.rank(child)] / 8,
            };
            let share = children.iter().map(share).sum();
            push_node(&mut pool, children, share, |child| node(child, below));
            shares.push(share);
        }
        let root = |&(id, level): &(Id, u32)| if is_homogeneous(id) { id } else { node(id, level) };
        (pool, roots.iter().map(root).collect())
    }
}

/// A header word, then a reference per mixed child.
fn push_node(pool: &mut Vec<u32>, children: [Id; 8], share: u64, reference: impl Fn(Id) -> u32) {
    let code = |child: Id| if is_homogeneous(child) { child } else { 2 };
    let codes = children.iter().enumerate().fold(0, |header, (i, child)| header | (code(*child) << (2 * i)));
    pool.push(codes | mean_bits(share));
    pool.extend(children.iter().filter(|c| !is_homogeneous(**c)).map(|c| reference(*c)));
}
