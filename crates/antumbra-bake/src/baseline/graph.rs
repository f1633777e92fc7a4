//! A graph in the making, as the papers make it: nodes are inserted level by level as they come, equal ones too, and merged
//! afterwards, level by level from the bottom up, by sorting.

use antumbra::format::dag8::SLICE_LEVEL;
use rayon::prelude::*;

use crate::dag::{Id, LIT, SHADOWED, Tables};

/// A child: lit, shadowed, or the node or mask with this number less 2 on the level below.
pub(super) type Reference = u32;
const FIRST: Reference = 2;

/// Nodes by level.
#[derive(Default)]
pub(super) struct Graph {
    masks: Vec<u64>,
    /// From slice nodes up.
    levels: Vec<Vec<[Reference; 8]>>,
}

impl Graph {
    /// With room for nodes of up to 2^log2 voxels per side.
    pub fn new(log2: u32) -> Self {
        Self { masks: Vec::new(), levels: vec![Vec::new(); (log2 + 1 - SLICE_LEVEL) as usize] }
    }

    /// Bytes held.
    pub fn bytes(&self) -> u64 {
        let nodes: usize = self.levels.iter().map(Vec::capacity).sum();
        (8 * self.masks.capacity() + 32 * nodes) as u64
    }

    pub fn mask(&mut self, lit: u64) -> Reference {
        match lit {
            u64::MAX => LIT,
            0 => SHADOWED,
            _ => {
                self.masks.push(lit);
                self.masks.len() as u32 - 1 + FIRST
            }
        }
    }

    /// A node of 2^level voxels per side.
    pub fn node(&mut self, level: u32, children: [Reference; 8]) -> Reference {
        if children[0] < FIRST && children.iter().all(|child| *child == children[0]) {
            return children[0];
        }
        let nodes = &mut self.levels[(level - SLICE_LEVEL) as usize];
        nodes.push(children);
        nodes.len() as u32 - 1 + FIRST
    }

    /// Removes all but one of equal nodes; `roots` stand on one level.
    pub fn merge(&mut self, roots: &mut [Reference], roots_level: u32) {
        let mut renamed = merge_equal(&mut self.masks);
        for (level, nodes) in (SLICE_LEVEL..).zip(&mut self.levels) {
            nodes.par_iter_mut().flatten().for_each(|child| rename(child, &renamed));
            renamed = merge_equal(nodes);
            if level == roots_level {
                roots.iter_mut().for_each(|root| rename(root, &renamed));
            }
        }
    }

    /// Adds another graph's nodes; its roots, on one level, are renamed.
    pub fn append(&mut self, other: Self, roots: &mut [Reference], roots_level: u32) {
        let mut shift = self.masks.len() as u32;
        self.masks.extend(other.masks);
        let moved = |child: Reference, shift: u32| if child < FIRST { child } else { child + shift };
        for (level, (nodes, others)) in (SLICE_LEVEL..).zip(self.levels.iter_mut().zip(other.levels)) {
            let before = nodes.len() as u32;
            nodes.extend(others.into_iter().map(|children| children.map(|child| moved(child, shift))));
            shift = before;
            if level == roots_level {
                roots.iter_mut().for_each(|root| *root = moved(*root, shift));
            }
        }
    }

    /// Nodes by level, from slice nodes up.
    #[cfg(test)]
    pub fn counts(&self) -> Vec<usize> {
        self.levels.iter().map(Vec::len).collect()
    }

    /// Hands a merged graph's nodes over to tables that many lights share; the root's id.
    pub fn hand_over(&self, tables: &Tables, root: Reference, level: u32) -> Id {
        let id = |ids: &[Id], child: Reference| if child < FIRST { child } else { ids[(child - FIRST) as usize] };
        let mut ids: Vec<Id> = self.masks.iter().map(|mask| tables.mask(*mask)).collect();
        for (of, nodes) in (SLICE_LEVEL..=level).zip(&self.levels) {
            let intern = |children: &[Reference; 8]| {
                let children = children.map(|child| id(&ids, child));
                if of == SLICE_LEVEL { tables.slice_node(children) } else { tables.inner_node(children) }
            };
            ids = nodes.iter().map(intern).collect();
        }
        id(&ids, root)
    }
}

fn rename(reference: &mut Reference, renamed: &[u32]) {
    if *reference >= FIRST {
        *reference = renamed[(*reference - FIRST) as usize] + FIRST;
    }
}

/// Sorts, keeps one of each, and tells what has become of each.
fn merge_equal<K: Copy + Ord + Send + Sync>(keys: &mut Vec<K>) -> Vec<u32> {
    let mut order: Vec<(K, u32)> = keys.par_iter().copied().zip(0..keys.len() as u32).collect();
    order.par_sort_unstable();
    let mut renamed = vec![0; keys.len()];
    keys.clear();
    for equal in order.chunk_by(|a, b| a.0 == b.0) {
        equal.iter().for_each(|(_, place)| renamed[*place as usize] = keys.len() as u32);
        keys.push(equal[0].0);
    }
    keys.shrink_to_fit();
    renamed
}
