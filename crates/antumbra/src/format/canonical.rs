//! The canonical order: equal scenes give equal bytes, whatever threads built them.
//!
//! Walk each light's graph depth first from its faces' roots, lights in the file's order, children in theirs, then the
//! coarse levels of each light in turn; a node met before is skipped. Masks and slice nodes are stored in the order of first meeting, inner nodes when all their
//! children are stored. Nothing is stored that no light reaches, and nothing twice.

use alloc::collections::BTreeSet;
use alloc::vec;
use alloc::vec::Vec;

use super::dag8::{self, LIT, SHADOWED, SLICE_LEVEL, WHOLE, child_code};
use crate::{Encoding, FormatError, ShadowFile};

/// Checks that a file's pool is in canonical order, with nothing unreachable and nothing twice. Time n log n in the nodes;
/// memory about that of the pool.
///
/// # Errors
/// [`FormatError::Malformed`] with what is out of order.
pub fn check(file: &ShadowFile) -> Result<(), FormatError> {
    if file.encoding() == Encoding::Silhouette {
        // Their order is checked when a file is read.
        return Ok(());
    }
    let layout = dag8::layout(&file.pool)?;
    let mut walk = Walk { pool: &file.pool, mask: dag8::POOL_HEADER_WORDS, slice: layout.slices, inner: layout.inner };
    for record in &file.records {
        for root in record.face_roots() {
            walk.visit(*root, record.log2_resolution)?;
        }
    }
    for (record, roots) in file.records.iter().zip(&file.level_roots) {
        for (i, root) in roots.iter().flatten().enumerate() {
            walk.visit(*root, record.log2_resolution - 1 - i as u32 / record.faces)?;
        }
    }
    if (walk.mask, walk.slice, walk.inner) != (layout.slices, layout.inner, layout.end) {
        return Err(FormatError::Malformed("the node pool holds nodes that no light reaches"));
    }
    check_means(&file.pool, layout)?;
    check_unique(&file.pool, layout)
}

/// Every node's header holds the mean of its voxels.
fn check_means(pool: &[u32], layout: dag8::Layout) -> Result<(), FormatError> {
    let right = node_shares(pool, layout).all(|(at, share)| pool[at] & 0xffff_0000 == dag8::mean_bits(share));
    if right { Ok(()) } else { Err(FormatError::Malformed("a node's mean visibility is not that of its voxels")) }
}

/// Puts into every node's header the mean of its voxels, for pools that were not made by a bake.
///
/// # Errors
/// [`FormatError::Malformed`] unless [`dag8::check`] accepts the pool.
pub fn set_means(pool: &mut [u32]) -> Result<(), FormatError> {
    dag8::check(pool)?;
    let means: Vec<(usize, u64)> = node_shares(pool, dag8::layout(pool)?).collect();
    for (at, share) in means {
        pool[at] = (pool[at] & 0xffff) | dag8::mean_bits(share);
    }
    Ok(())
}

/// Word and lit share (of [`WHOLE`]) of every node of a checked pool. Children stand before their parents.
fn node_shares(pool: &[u32], layout: dag8::Layout) -> impl Iterator<Item = (usize, u64)> {
    let mut shares = vec![0u64; layout.end - layout.slices];
    let mut next = layout.slices;
    core::iter::from_fn(move || {
        let at = next;
        let header = *pool.get(at)?;
        let share = (0..8).map(|i| match (child_code(header, i), pool.get(at + 1 + dag8::child_slot(header, i))) {
            (LIT, _) => WHOLE / 8,
            (SHADOWED, _) | (_, None) => 0,
            (_, Some(&mask)) if at < layout.inner => {
                let mask = mask as usize;
                dag8::slice_node_share(pool[mask].count_ones() + pool[mask + 1].count_ones())
            }
            (_, Some(&node)) => shares[node as usize - layout.slices] / 8,
        });
        let share = share.sum();
        shares[at - layout.slices] = share;
        next = at + 1 + dag8::reference_count(header);
        Some((at, share))
    })
}

/// The next unvisited word of each part.
struct Walk<'a> {
    pool: &'a [u32],
    mask: usize,
    slice: usize,
    inner: usize,
}

const OUT_OF_ORDER: FormatError = FormatError::Malformed("nodes are not in canonical order");

impl Walk<'_> {
    /// Visits a node that [`dag8::check`] found fit for `level`.
    fn visit(&mut self, reference: u32, level: u32) -> Result<(), FormatError> {
        let at = reference as usize;
        if reference == LIT || reference == SHADOWED {
            return Ok(());
        }
        if level == SLICE_LEVEL {
            return self.visit_slices(at);
        }
        if at < self.inner {
            return Ok(());
        }
        for r in self.references(at) {
            self.visit(self.pool[r], level - 1)?;
        }
        let next = self.inner;
        self.inner += 1 + dag8::reference_count(self.pool[at]);
        if at == next { Ok(()) } else { Err(OUT_OF_ORDER) }
    }

    fn visit_slices(&mut self, at: usize) -> Result<(), FormatError> {
        if at < self.slice {
            return Ok(());
        }
        if at != self.slice {
            return Err(OUT_OF_ORDER);
        }
        self.slice += 1 + dag8::reference_count(self.pool[at]);
        for r in self.references(at) {
            let mask = self.pool[r] as usize;
            if mask > self.mask {
                return Err(OUT_OF_ORDER);
            }
            self.mask = self.mask.max(mask + 2);
        }
        Ok(())
    }

    fn references(&self, at: usize) -> core::ops::Range<usize> {
        at + 1..at + 1 + dag8::reference_count(self.pool[at])
    }
}

/// No two masks and no two nodes of a part are equal, and no mask or node is all lit or all shadowed.
fn check_unique(pool: &[u32], layout: dag8::Layout) -> Result<(), FormatError> {
    let (masks, _) = pool[dag8::POOL_HEADER_WORDS..layout.slices].as_chunks::<2>();
    let mut seen = BTreeSet::new();
    if masks.iter().any(|m| *m == [0; 2] || *m == [u32::MAX; 2] || !seen.insert(&m[..])) {
        return Err(FormatError::Malformed("a mask is stored twice or is homogeneous"));
    }
    for part in [layout.slices..layout.inner, layout.inner..layout.end] {
        seen.clear();
        let mut at = part.start;
        while at < part.end {
            let end = at + 1 + dag8::reference_count(pool[at]);
            let first = child_code(pool[at], 0);
            let homogeneous = first < 2 && (1..8).all(|i| child_code(pool[at], i) == first);
            if homogeneous || !seen.insert(&pool[at..end]) {
                return Err(FormatError::Malformed("a node is stored twice or is homogeneous"));
            }
            at = end;
        }
    }
    Ok(())
}
