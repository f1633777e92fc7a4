//! Sharded hash-consing tables, shared by all threads and all lights of a bake.

use std::hash::{BuildHasher, Hasher};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use foldhash::fast::FixedState;

use crate::Pause;

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

/// A node's eight children. Never across two cache lines.
#[derive(Clone, Copy, Debug, Default, Eq)]
#[repr(C, align(32))]
pub struct Children(pub [Id; 8]);

impl PartialEq for Children {
    /// Without a branch or a call per word.
    #[inline]
    fn eq(&self, other: &Self) -> bool {
        let (a, b): ([u64; 4], [u64; 4]) = (bytemuck::cast(self.0), bytemuck::cast(other.0));
        (a[0] ^ b[0]) | (a[1] ^ b[1]) | (a[2] ^ b[2]) | (a[3] ^ b[3]) == 0
    }
}

/// The three tables of a bake. Ids of slice nodes and of inner nodes differ: an inner node over 16 voxels per side holds
/// the former, a greater one the latter, and the two must not be taken for each other.
pub struct Tables {
    /// 8 x 8 masks; bit 8*y + x is 1 where lit.
    pub masks: NodeTable<u64>,
    /// 8 x 8 x 8 nodes: eight slices, each homogeneous or a mask.
    pub slices: NodeTable<Children>,
    /// Greater nodes: eight octants, x fastest, z slowest.
    pub inner: NodeTable<Children>,
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
        homogeneous(&slices).unwrap_or_else(|| self.slices.intern(Children(slices)))
    }

    /// An inner node's id.
    pub fn inner_node(&self, octants: [Id; 8]) -> Id {
        homogeneous(&octants).unwrap_or_else(|| self.inner.intern(Children(octants)))
    }

    /// Whether a table has run out of ids: results are then of no use.
    pub fn are_full(&self) -> bool {
        self.masks.is_full() || self.slices.is_full() || self.inner.is_full()
    }

    /// Bytes that the tables hold, with an eighth more for what the allocator leaves unused between arrays that grow.
    pub fn bytes(&self) -> u64 {
        let held = self.masks.bytes() + self.slices.bytes() + self.inner.bytes();
        held + held / 8
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

/// Keys in the order of their coming, and an open-addressing index of them.
struct Shard<K> {
    keys: Vec<K>,
    /// Half of a key's hash in the upper half, its place plus 1 in the lower; 0 is empty. So a miss in the cache is taken for
    /// keys that are equal only, and growing looks at no key. A power of two of slots, probed one after the other.
    slots: Vec<u64>,
}

/// Slots of a shard with its first key.
const FIRST_SLOTS: usize = 64;

impl<K: Copy + Eq + FastHash> Shard<K> {
    /// The place of an equal key, or else the slot where the key belongs.
    #[inline]
    fn find(&self, key: K, hash: u32) -> Result<u32, usize> {
        let last = self.slots.len() - 1;
        let mut at = hash as usize & last;
        loop {
            let slot = self.slots[at];
            if slot == 0 {
                return Err(at);
            }
            let place = slot as u32 - 1;
            if (slot >> 32) as u32 == hash && self.keys[place as usize] == key {
                return Ok(place);
            }
            at = (at + 1) & last;
        }
    }

    /// Doubles the slots.
    fn grow(&mut self) {
        let length = (2 * self.slots.len()).max(FIRST_SLOTS);
        let mut slots = vec![0u64; length];
        for slot in self.slots.iter().filter(|slot| **slot != 0) {
            let mut at = (slot >> 32) as usize & (length - 1);
            while slots[at] != 0 {
                at = (at + 1) & (length - 1);
            }
            slots[at] = *slot;
        }
        self.slots = slots;
    }

    fn bytes(&self) -> usize {
        self.keys.capacity() * size_of::<K>() + self.slots.len() * size_of::<u64>()
    }
}

impl<K: Copy + Eq + FastHash> NodeTable<K> {
    fn new(tag: u32) -> Self {
        let shard = || Mutex::new(Shard { keys: Vec::new(), slots: Vec::new() });
        Self {
            shards: (0..SHARDS).map(|_| shard()).collect(),
            tag,
            bytes: AtomicU64::new(0),
            full: AtomicBool::new(false),
        }
    }

    /// The key's id, new or old.
    pub fn intern(&self, key: K) -> Id {
        self.intern_hashed(key, key.fast_hash())
    }

    fn intern_hashed(&self, key: K, hash: u64) -> Id {
        // The index uses 32 bits; take others for the shard.
        let shard_number = (hash >> 20) as usize % SHARDS;
        let hash = (hash >> 32) as u32;
        let mut shard = lock(&self.shards[shard_number]);
        // At most three slots in four are taken.
        if 4 * shard.keys.len() >= 3 * shard.slots.len() {
            let before = shard.bytes();
            shard.grow();
            self.account(before, shard.bytes());
        }
        let slot = match shard.find(key, hash) {
            Ok(local) => return self.id(local, shard_number),
            Err(slot) => slot,
        };
        let local = shard.keys.len() as u32;
        if local >= MOST_KEYS {
            self.full.store(true, Ordering::Relaxed);
            return LIT;
        }
        let (before, capacity) = (shard.bytes(), shard.keys.capacity());
        shard.keys.push(key);
        shard.slots[slot] = (u64::from(hash) << 32) | u64::from(local + 1);
        if shard.keys.capacity() != capacity {
            self.account(before, shard.bytes());
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

    fn account(&self, before: usize, after: usize) {
        self.bytes.fetch_add((after - before) as u64, Ordering::Relaxed);
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
    pub fn into_keys(self, pause: Pause<'_>) -> Vec<Vec<K>> {
        let keys = self.shards.into_iter().map(|shard| {
            pause();
            shard.into_inner().unwrap_or_else(PoisonError::into_inner).keys
        });
        keys.collect()
    }
}

/// One thread's way to the tables: what it has met of late it finds in caches of its own, without a lock or a walk
/// through memory. Most nodes are met again soon.
pub struct Interner<'a> {
    tables: &'a Tables,
    masks: Recent<u64, 11>,
    slices: Recent<Children, 12>,
    inner: Recent<Children, 12>,
}

/// The last key that fell into each of 2^`LOG2` places, with its id.
struct Recent<K, const LOG2: u32> {
    places: Box<[(K, Id)]>,
}

impl<K: Copy + Eq + FastHash + Default, const LOG2: u32> Recent<K, LOG2> {
    /// Places without a key hold one that is homogeneous, which is never asked for.
    fn new() -> Self {
        Self { places: vec![(K::default(), LIT); 1 << LOG2].into_boxed_slice() }
    }

    #[inline]
    fn intern(&mut self, key: K, table: &NodeTable<K>) -> Id {
        let hash = key.fast_hash();
        let recent = &mut self.places[hash as usize & ((1 << LOG2) - 1)];
        if recent.0 != key {
            *recent = (key, table.intern_hashed(key, hash));
        }
        recent.1
    }
}

impl<'a> Interner<'a> {
    /// Knows nothing yet.
    #[must_use]
    pub fn new(tables: &'a Tables) -> Self {
        Self { tables, masks: Recent::new(), slices: Recent::new(), inner: Recent::new() }
    }

    /// See [`Tables::mask`].
    #[inline]
    pub fn mask(&mut self, lit: u64) -> Id {
        match lit {
            u64::MAX => LIT,
            0 => SHADOWED,
            _ => self.masks.intern(lit, &self.tables.masks),
        }
    }

    /// See [`Tables::slice_node`].
    #[inline]
    pub fn slice_node(&mut self, slices: [Id; 8]) -> Id {
        homogeneous(&slices).unwrap_or_else(|| self.slices.intern(Children(slices), &self.tables.slices))
    }

    /// See [`Tables::inner_node`].
    #[inline]
    pub fn inner_node(&mut self, octants: [Id; 8]) -> Id {
        homogeneous(&octants).unwrap_or_else(|| self.inner.intern(Children(octants), &self.tables.inner))
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

/// The same on every machine; not that bytes would depend on it.
const HASHER: FixedState = FixedState::with_seed(0);

impl FastHash for u64 {
    #[inline]
    fn fast_hash(&self) -> u64 {
        HASHER.hash_one(self)
    }
}

impl FastHash for Children {
    #[inline]
    fn fast_hash(&self) -> u64 {
        let mut hasher = HASHER.build_hasher();
        for pair in bytemuck::cast_ref::<[u32; 8], [[u32; 2]; 4]>(&self.0) {
            hasher.write_u64(u64::from(pair[0]) | (u64::from(pair[1]) << 32));
        }
        hasher.finish()
    }
}
