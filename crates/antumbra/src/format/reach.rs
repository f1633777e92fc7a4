//! What each light of a file adds to the shared node pool.
//!
//! Lights share nodes. A node belongs to the first light, in the file's order, from whose roots it is reached; nodes that
//! only coarse levels reach are counted by themselves. So the shares add up to the whole pool.

use alloc::vec;
use alloc::vec::Vec;

use super::dag8::{NodeCounts, SHADOWED, SLICE_LEVEL, reference_count};
use super::silhouette::Check;
use crate::{Encoding, LightKind, ShadowFile};

/// For each light, in the file's order: nodes that it reaches and no earlier light does, and their 32-bit words.
/// Linear in the pool's size.
#[must_use]
pub fn by_light(file: &ShadowFile) -> Vec<(NodeCounts, u64)> {
    shares(file).0
}

/// [`by_light`], and what the coarse levels of all lights add to it.
#[must_use]
pub fn shares(file: &ShadowFile) -> (Vec<(NodeCounts, u64)>, (NodeCounts, u64)) {
    if file.encoding() == Encoding::Silhouette {
        return (silhouette_shares(file), Default::default());
    }
    let mut walk = Walk { pool: &file.pool, met: vec![0; file.pool.len().div_ceil(64)], added: Default::default() };
    let mut share = |record: &crate::LightRecord| {
        walk.added = Default::default();
        record.face_roots().iter().for_each(|root| walk.visit(*root, record.log2_resolution));
        walk.added
    };
    let lights = file.records.iter().map(&mut share).collect();
    walk.added = Default::default();
    for (record, roots) in file.records.iter().zip(&file.level_roots) {
        for (i, root) in roots.iter().flatten().enumerate() {
            walk.visit(*root, record.log2_resolution - 1 - i as u32 / record.faces);
        }
    }
    (lights, walk.added)
}

/// What each light's trees take, with the forms that no earlier light has.
fn silhouette_shares(file: &ShadowFile) -> Vec<(NodeCounts, u64)> {
    let Ok(mut check) = Check::new(&file.pool) else { return Vec::new() };
    let mut before = (NodeCounts::default(), 0);
    let of_light = |record: &crate::LightRecord| {
        let log2 = record.log2_resolution;
        // They were checked when the file was read.
        let is_local = record.light_kind() != Some(LightKind::Directional);
        record.face_roots().iter().for_each(|root| _ = check.tree(*root, log2, is_local));
        let (counts, words) = (check.counts(), check.words());
        let first = core::mem::replace(&mut before, (counts, words));
        let own = NodeCounts {
            inner: counts.inner - first.0.inner,
            slices: 0,
            masks: counts.masks - first.0.masks,
            cuts: counts.cuts - first.0.cuts,
        };
        (own, (words - first.1) as u64)
    };
    file.records.iter().map(of_light).collect()
}

struct Walk<'a> {
    pool: &'a [u32],
    /// One bit per word of the pool.
    met: Vec<u64>,
    added: (NodeCounts, u64),
}

impl Walk<'_> {
    /// Visits a node that validation found fit for `level`; masks stand one level below slice nodes.
    fn visit(&mut self, reference: u32, level: u32) {
        if reference <= SHADOWED || !self.meet(reference as usize) {
            return;
        }
        let (counts, words) = &mut self.added;
        match level {
            SLICE_LEVEL => counts.slices += 1,
            l if l < SLICE_LEVEL => {
                counts.masks += 1;
                *words += 2;
                return;
            }
            _ => counts.inner += 1,
        }
        let at = reference as usize;
        let children = at + 1..at + 1 + reference_count(self.pool[at]);
        *words += 1 + children.len() as u64;
        for child in children {
            self.visit(self.pool[child], level - 1);
        }
    }

    /// Whether this is the first meeting.
    fn meet(&mut self, at: usize) -> bool {
        let bit = 1u64 << (at % 64);
        let word = &mut self.met[at / 64];
        let first = *word & bit == 0;
        *word |= bit;
        first
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::stat::BakeStats;
    use crate::format::write::{Contents, write};
    use crate::{LightKind, LightRecord};

    /// A light of 64 texels per side.
    fn light(root: u32) -> LightRecord {
        let mut record: LightRecord = bytemuck::Zeroable::zeroed();
        record.kind = LightKind::Directional as u32;
        record.log2_resolution = 6;
        (record.texel_size_m, record.slice_size_m, record.faces) = (1.0, 1.0, 1);
        record.roots[0] = root;
        record
    }

    #[test]
    fn a_node_belongs_to_the_first_light_that_reaches_it() {
        // Two masks at 8 and 10, slice nodes at 12 (mask 8) and 14 (masks 8 and 10), then inner nodes of levels
        // 4, 5, 6 over the first and over both.
        let words = [
            [4, 5, 14, 0, 0, 0, 0, 0].as_slice(),
            &[1, 0, 3, 0],
            &[0b10, 8, 0b1010, 8, 10],
            &[0b10, 12, 0b10, 17, 0b10, 19],
            &[0b1010, 12, 14, 0b1010, 17, 23, 0b10, 26],
        ];
        let pool = words.concat();
        let records = [21, 29, 21, SHADOWED].map(light);
        let bytes = write(&Contents::new(&records, "", &pool, BakeStats::default()));
        let shares = by_light(&ShadowFile::from_bytes(&bytes).expect("a sound file"));
        let counts = |inner, slices, masks| NodeCounts { inner, slices, masks, cuts: 0 };
        assert_eq!(shares[0], (counts(3, 1, 1), 2 + 2 + 6));
        assert_eq!(shares[1], (counts(3, 1, 1), 2 + 3 + 8));
        assert_eq!(shares[2..], [(counts(0, 0, 0), 0); 2]);
    }
}
