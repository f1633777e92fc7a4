//! Sharded hash-consing tables, shared by all threads and all lights of a bake.

use std::hash::{BuildHasher, Hash, Hasher};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use hashbrown::HashTable;
use rustc_hash::FxBuildHasher;

/// A node, a mask, or one of the homogeneous volumes. Ids depend on the threads' timing; bytes never do, because
/// [`super::encode`] numbers afresh.
pub type Id = u32;
/// A lit volume.
pub const LIT: Id = 0;
/// A shadowed volume.
pub const SHADOWED: Id = 1;
/// Ids below this one are no table's.
const FIRST_ID: u32 = 2;

const SHARD_BITS: u32 = 6;
const SHARDS: usize = 1 << SHARD_BITS;
/// Most keys per shard: an id has 32 bits for the key's place, the shard and the tag.
const MOST_KEYS: u32 = (1 << (31 - SHARD_BITS)) - 1;

/// The three tables of a bake. Ids of slice nodes and of inner nodes differ: an inner node over 16 voxels per side holds
/// the former, a greater one the latter, and the two must not be taken for each other.
pub struct Tables {
    /// 8 x 8 masks; bit 8*y + x is 1 where lit.
    pub masks: NodeTable<u64>,
    /// 8 x 8 x 8 nodes: eight slices, each homogeneous or a mask.
    pub slices: NodeTable<[Id; 8]>,
    /// Greater nodes: eight octants, x fastest, z slowest.
    pub inner: NodeTable<[Id; 8]>,
}

impl Default for Tables {
    fn default() -> Self {
        Self { masks: NodeTable::new(0), slices: NodeTable::new(0), inner: NodeTable::new(1) }
    }
}

impl Tables {
    /// The mask's id; homogeneous masks have fixed ones.
    pub fn mask(&self, lit: u64) -> Id {
        match lit {
            u64::MAX => LIT,
            0 => SHADOWED,
            _ => self.masks.intern(lit),
        }
    }

    /// A slice node's id.
    pub fn slice_node(&self, slices: [Id; 8]) -> Id {
        homogeneous(&slices).unwrap_or_else(|| self.slices.intern(slices))
    }

    /// An inner node's id.
    pub fn inner_node(&self, octants: [Id; 8]) -> Id {
        homogeneous(&octants).unwrap_or_else(|| self.inner.intern(octants))
    }

    /// Whether a table has run out of ids: results are then of no use.
    pub fn are_full(&self) -> bool {
        self.masks.is_full() || self.slices.is_full() || self.inner.is_full()
    }

    /// Bytes that the tables hold.
    pub fn bytes(&self) -> u64 {
        self.masks.bytes() + self.slices.bytes() + self.inner.bytes()
    }
}

fn homogeneous(children: &[Id; 8]) -> Option<Id> {
    let first = children[0];
    (first < FIRST_ID && children.iter().all(|c| *c == first)).then_some(first)
}

/// Keys with ids; equal keys have equal ids.
pub struct NodeTable<K> {
    shards: Vec<Mutex<Shard<K>>>,
    /// Lowest bit of the table's ids, before [`FIRST_ID`] is added.
    tag: u32,
    bytes: AtomicU64,
    full: AtomicBool,
}

struct Shard<K> {
    keys: Vec<K>,
    index: HashTable<u32>,
}

impl<K: Copy + Eq + FastHash> NodeTable<K> {
    fn new(tag: u32) -> Self {
        let shard = || Mutex::new(Shard { keys: Vec::new(), index: HashTable::new() });
        Self {
            shards: (0..SHARDS).map(|_| shard()).collect(),
            tag,
            bytes: AtomicU64::new(0),
            full: AtomicBool::new(false),
        }
    }

    /// The key's id, new or old.
    pub fn intern(&self, key: K) -> Id {
        let hash = key.fast_hash();
        // The index uses the hash's low and highest bits; take others for the shard.
        let shard_number = (hash >> 40) as usize % SHARDS;
        let mut shard = lock(&self.shards[shard_number]);
        let Shard { keys, index } = &mut *shard;
        if let Some(&local) = index.find(hash, |&i| keys[i as usize] == key) {
            return self.id(local, shard_number);
        }
        let local = keys.len() as u32;
        if local >= MOST_KEYS {
            self.full.store(true, Ordering::Relaxed);
            return LIT;
        }
        let capacity = keys.capacity();
        keys.push(key);
        index.insert_unique(hash, local, |&i| keys[i as usize].fast_hash());
        if keys.capacity() != capacity {
            self.account(keys.capacity() - capacity);
        }
        self.id(local, shard_number)
    }

    /// The key of an id that this table gave.
    pub fn key(&self, id: Id) -> K {
        let (shard, local) = place(id);
        lock(&self.shards[shard]).keys[local]
    }

    fn id(&self, local: u32, shard: usize) -> Id {
        ((local << (SHARD_BITS + 1)) | ((shard as u32) << 1) | self.tag) + FIRST_ID
    }

    fn account(&self, added_keys: usize) {
        // A key, and up to two slots in the index with their control bytes.
        let per_key = size_of::<K>() + 2 * (size_of::<u32>() + 1);
        self.bytes.fetch_add((added_keys * per_key) as u64, Ordering::Relaxed);
    }

    /// Whether a key found no room; ids are then wrong and the bake must end.
    fn is_full(&self) -> bool {
        self.full.load(Ordering::Relaxed)
    }

    /// Bytes held, to within the allocator's rounding.
    pub fn bytes(&self) -> u64 {
        self.bytes.load(Ordering::Relaxed)
    }

    /// Keys by shard, for reading once all threads are done.
    pub fn into_keys(self) -> Vec<Vec<K>> {
        self.shards.into_iter().map(|s| s.into_inner().unwrap_or_else(PoisonError::into_inner).keys).collect()
    }
}

/// Shard and place in it of an id that is not homogeneous.
pub(super) fn place(id: Id) -> (usize, usize) {
    let number = (id - FIRST_ID) >> 1;
    (number as usize % SHARDS, (number >> SHARD_BITS) as usize)
}

/// A panic elsewhere leaves the table whole: keys are only ever added.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A hash in few instructions.
pub trait FastHash {
    /// 64 well-mixed bits.
    fn fast_hash(&self) -> u64;
}

impl FastHash for u64 {
    fn fast_hash(&self) -> u64 {
        FxBuildHasher.hash_one(self)
    }
}

impl FastHash for [Id; 8] {
    fn fast_hash(&self) -> u64 {
        let mut hasher = FxBuildHasher.build_hasher();
        for pair in bytemuck::cast_ref::<[u32; 8], [[u32; 2]; 4]>(self) {
            (u64::from(pair[0]) | (u64::from(pair[1]) << 32)).hash(&mut hasher);
        }
        hasher.finish()
    }
}
