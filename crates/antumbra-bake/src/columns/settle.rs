//! What a tile's list says about the tile as a whole: lit, one plane of constant depth, or more to look at.

use super::tile::{COVERS, EXITS, Entry, SOLID};

/// A tile as its list leaves it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Settled {
    /// No caster before the clamp.
    Lit,
    /// Any depth from `enter` to `exit` is right for every texel.
    Plane { enter: u32, exit: u32 },
    /// Texels differ. Every texel is in shadow at slice `clamp` and need not enter it later, unless `clamp` lies behind
    /// the last slice.
    Mixed { clamp: u32 },
}

/// Longer lists are not sorted, and so not resolved: tiles that large are never one plane.
const LONGEST_SORTED: usize = 512;

/// Judges a tile and drops from its list what its texels cannot see. What remains is sorted, at leaves in any case.
///
/// `clamp` is a slice from the parent with all its texels inside a solid or behind a surface: a texel's first shadowed
/// slice is never behind it, so exits count as no later.
pub(super) fn settle(entries: &mut Vec<Entry>, is_leaf: bool, clamp: u32) -> Settled {
    if entries.is_empty() {
        return Settled::Lit;
    }
    // Behind an open triangle that covers the whole tile nothing can be a first surface.
    let covering = entries.iter().filter(|e| e.has(COVERS) && !e.has(SOLID));
    let mut clamp = covering.map(|e| e.last + 1).min().map_or(clamp, |c| c.min(clamp));
    entries.retain(|e| e.first < clamp);
    if entries.len() > LONGEST_SORTED && !is_leaf {
        return Settled::Mixed { clamp };
    }
    entries.sort_unstable_by_key(|e| (u64::from(e.first) << 32) | u64::from(e.triangle));
    match first_inner_gap(entries, clamp) {
        Gap::None => {}
        Gap::Plane { enter, exit } => return Settled::Plane { enter, exit },
        Gap::Behind { end } => {
            clamp = clamp.min(end);
            entries.truncate(entries.partition_point(|e| e.first < clamp));
        }
    }
    Settled::Mixed { clamp }
}

enum Gap {
    None,
    /// Every ray enters before the gap and leaves nothing: the gap answers for the tile.
    Plane {
        enter: u32,
        exit: u32,
    },
    /// All texels are inside a solid up to `end`, but the surfaces before it must be told apart.
    Behind {
        end: u32,
    },
}

/// The first gap between the triangles' depth intervals in which the winding number is positive. No surface lies in a
/// gap, so the number is the same at each of the tile's texels: that of the first texel serves.
fn first_inner_gap(sorted: &[Entry], clamp: u32) -> Gap {
    let mut winding = 0;
    let mut behind_last = 0;
    let mut solids_before = sorted.len();
    for (i, entry) in sorted.iter().enumerate().filter(|(_, e)| e.has(SOLID)) {
        if winding > 0 && behind_last <= entry.first {
            solids_before = i;
            break;
        }
        winding += entry.winding_at_first();
        behind_last = behind_last.max(entry.last + 1);
    }
    // What lies behind the clamp has been dropped: a last gap may reach it.
    if winding <= 0 || behind_last > clamp {
        return Gap::None;
    }
    let (before, after) = sorted.split_at(solids_before);
    let end = inside_until(after, winding).min(clamp);
    let leaves = before.iter().any(|e| e.has(EXITS));
    // An open surface may come first where it can lie before the solid's.
    let open_before = sorted.iter().any(|e| !e.has(SOLID) && e.first < behind_last);
    if leaves || open_before { Gap::Behind { end } } else { Gap::Plane { enter: behind_last, exit: end } }
}

/// A slice up to which every ray stays inside, given the winding number before `after`: a ray must leave as often as
/// it has entered, and meets each triangle once.
fn inside_until(after: &[Entry], winding: i32) -> u32 {
    let mut exits = after.iter().filter(|e| e.has(EXITS));
    exits.nth(winding as usize - 1).map_or(u32::MAX, |e| e.first)
}
