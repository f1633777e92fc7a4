//! What a tile's list says about the tile as a whole: lit, one plane of constant depth, or more to look at.

use super::freedom::Freedom;
use super::leaf::LEAF_LOG2;
use super::mates::Mates;
use super::tile::{COVERS, ENTERS, EXITS, Entry, SOLID, Tile};
use super::triangle::BuildTriangle;
use crate::light_space::{Resolution, Slices};

/// A tile as its list leaves it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Settled {
    /// No caster before the clamp.
    Lit,
    /// Any depth from `enter` to `exit` is right for every texel; none is first shadowed before `least`. `clamp` as for `Mixed`.
    Plane { least: u32, enter: u32, exit: u32, clamp: u32 },
    /// An open triangle that covers the tile is what every ray meets first, and nothing is free behind it. As for `Mixed`.
    Face { triangle: u32, clamp: u32 },
    /// Texels differ. Every texel is in shadow at slice `clamp` and need not leave a solid later, unless `clamp` lies
    /// behind the last slice; what was dropped lies no nearer than it.
    Mixed { clamp: u32 },
}

/// Longer lists are only handed on, but at leaves: nothing hides so much, and looking takes long.
const LONGEST_LOOKED_AT: usize = 1 << 14;
/// Longer lists are not sorted, and so not resolved, but at leaves: tiles that large are never one plane.
const LONGEST_SORTED: usize = 512;
/// Longer lists are not searched for a face before all others.
const MOST_BEHIND_FACE: usize = 32;

/// What tiles are settled by.
#[derive(Clone, Copy)]
pub(crate) struct Rules<'a> {
    pub triangles: &'a [BuildTriangle],
    pub slices: &'a Slices,
    pub freedom: &'a Freedom,
}

impl Rules<'_> {
    /// Judges a tile and drops from its list what its texels cannot see. What remains is sorted, at leaves in any case.
    ///
    /// `clamp` is a slice from the parent with all its texels inside a solid or behind a surface: a texel's first shadowed
    /// slice is never behind it, so exits from solids count as no later.
    pub fn settle(&self, tile: Tile, entries: &mut Vec<Entry>, clamp: u32) -> Settled {
        if entries.is_empty() {
            return Settled::Lit;
        }
        let is_leaf = tile.log2 == LEAF_LOG2;
        if entries.len() > LONGEST_LOOKED_AT && !is_leaf {
            return Settled::Mixed { clamp };
        }
        let mut clamp = self.hidden_behind(entries).min(clamp);
        entries.retain(|e| e.first < clamp);
        if entries.len() > LONGEST_SORTED && !is_leaf {
            return Settled::Mixed { clamp };
        }
        entries.sort_unstable_by_key(|e| (u64::from(e.first) << 32) | u64::from(e.triangle));
        let Some(nearest) = entries.first() else { return Settled::Lit };
        let least = nearest.first + 1;
        match first_inner_gap(entries, clamp) {
            Gap::None => {}
            Gap::Plane { enter, exit } => return Settled::Plane { least, enter, exit, clamp },
            Gap::Behind { end } => {
                clamp = clamp.min(end);
                entries.truncate(entries.partition_point(|e| e.first < clamp));
            }
        }
        if let Some(triangle) = self.face(tile, entries, clamp) {
            return Settled::Face { triangle, clamp };
        }
        let free = match self.freedom {
            Freedom::None => None,
            Freedom::Thickness(_) => self.behind_cover(entries, least),
            Freedom::Static(_) => self.before_second(tile, entries, clamp),
        };
        let plane = free.filter(|[enter, exit]| enter <= exit);
        plane.map_or(Settled::Mixed { clamp }, |[enter, exit]| Settled::Plane { least, enter, exit, clamp })
    }

    fn resolution(&self) -> Resolution {
        self.slices.resolution()
    }

    /// The triangle that is all that a tile shows: it covers the tile, no solid begins with it, all others lie behind it, and
    /// rays are free nowhere behind it.
    fn face(&self, tile: Tile, entries: &[Entry], clamp: u32) -> Option<u32> {
        if entries.len() > MOST_BEHIND_FACE || matches!(self.freedom, Freedom::Thickness(_)) {
            return None;
        }
        let corners = tile.corners(self.resolution());
        let middle = |e: &Entry| self.depths(e, &corners).0.iter().sum::<f64>();
        let candidates = entries.iter().filter(|e| e.has(COVERS) && !e.has(ENTERS));
        let nearest = candidates.min_by(|a, b| middle(a).total_cmp(&middle(b)))?;
        let (depths, _) = self.depths(nearest, &corners);
        let mut others = entries.iter().filter(|e| e.triangle != nearest.triangle);
        let is_first = others.all(|other| other.first > nearest.last || self.is_behind(nearest, other, &corners));
        if !is_first || nearest.last >= self.resolution().texels() {
            return None;
        }
        let exits_at_once = match self.freedom {
            Freedom::None => true,
            Freedom::Thickness(_) => false,
            Freedom::Static(_) => self.second_is_near(nearest, &depths, entries, &corners, clamp),
        };
        exits_at_once.then_some(nearest.triangle)
    }

    /// Depths of a triangle's plane at the corners of a tile's rectangle of texel centres, and a bound on their errors, in
    /// units.
    fn depths(&self, entry: &Entry, corners: &[[f64; 2]; 4]) -> ([f64; 4], f64) {
        let triangle = &self.triangles[entry.triangle as usize];
        let units = self.slices.units_per_step();
        let side = corners[3][0] - corners[0][0];
        (corners.map(|p| triangle.depth(p, units)), triangle.widening(corners[0], side, self.slices))
    }

    /// Whether a triangle's plane lies behind another's wherever both are over a tile; in later slices if a solid begins
    /// with it, for what is met in one slice is one surface, and a solid's leaves freedom.
    fn is_behind(&self, front: &Entry, back: &Entry, corners: &[[f64; 2]; 4]) -> bool {
        let [a, b] = [front, back].map(|e| &self.triangles[e.triangle as usize]);
        let begins_solid = back.has(ENTERS);
        if b.is_edge_on() || (begins_solid && !self.slices.are_even()) {
            return false;
        }
        let least = if begins_solid { 1.0 } else { 0.0 };
        let ((near, error), (far, more)) = (self.depths(front, corners), self.depths(back, corners));
        (a.has_corners_of(b) && !begins_solid)
            || near.iter().zip(far).all(|(near, far)| far - near > least + error + more)
    }

    /// Whether every ray's second surface lies so near behind the face that its margin reaches it.
    fn second_is_near(
        &self,
        face: &Entry,
        depths: &[f64; 4],
        entries: &[Entry],
        corners: &[[f64; 2]; 4],
        clamp: u32,
    ) -> bool {
        let slices = self.resolution().texels();
        let is_near = |second: u32| second < slices && self.freedom.exit(0, second) <= face.first + 1;
        let Some(margin) = self.freedom.even_margin().filter(|_| self.slices.are_even()) else {
            let behind = entries.iter().filter(|e| e.has(COVERS) && e.first > face.last);
            return is_near(clamp) || behind.map(|e| e.last).min().is_some_and(is_near);
        };
        is_near(clamp)
            || entries.iter().filter(|e| e.has(COVERS) && e.last < slices).any(|e| {
                let (behind, error) = self.depths(e, corners);
                let distances = || behind.iter().zip(depths).map(|(behind, near)| behind - near);
                distances().all(|d| d > 1.0 + 2.0 * error) && distances().all(|d| d + 2.0 * error < f64::from(margin))
            })
    }

    /// A slice from which on nothing matters: behind an open triangle that covers the whole tile nothing can be a first
    /// surface. Where second surfaces matter, it takes two triangles, the one wholly behind the other.
    fn hidden_behind(&self, entries: &[Entry]) -> u32 {
        let covering = || entries.iter().filter(|e| e.has(COVERS));
        let behind = if self.freedom.is_static() {
            let first = covering().map(|e| e.last).min();
            first.and_then(|first| covering().filter(|e| e.first > first).map(|e| e.last).min())
        } else {
            covering().filter(|e| !e.has(SOLID)).map(|e| e.last).min()
        };
        behind.map_or(u32::MAX, |last| last + 1)
    }

    /// The depths that suit all rays where each is free for a length behind its first surface, and some triangle covers
    /// them all.
    fn behind_cover(&self, entries: &[Entry], least: u32) -> Option<[u32; 2]> {
        let cover = entries.iter().filter(|e| e.has(COVERS)).map(|e| e.last).min()?;
        Some([cover + 1, self.freedom.exit(least, u32::MAX)])
    }

    /// The depths that suit all rays where each is free up to its second surface: between the triangles before a gap, of
    /// which every ray meets exactly one, and those behind it.
    fn before_second(&self, tile: Tile, entries: &[Entry], clamp: u32) -> Option<[u32; 2]> {
        let mut before = Mates::new(self.triangles, tile, self.resolution());
        let mut last = 0;
        for (i, entry) in entries.iter().enumerate() {
            before.insert(entry);
            last = last.max(entry.last);
            let next = entries.get(i + 1);
            if next.is_some_and(|next| next.first <= last) {
                continue;
            }
            if !before.is_of_use() {
                return None;
            }
            match before.count() {
                Some(1) => {
                    // What was dropped lies behind the clamp.
                    let second = next.map_or(clamp, |next| next.first.min(clamp));
                    let is_last = next.is_none() && clamp >= self.resolution().texels();
                    // A ray that enters early may be free no farther than the margin says.
                    let exit = if is_last { u32::MAX } else { self.freedom.exit(0, second) };
                    return (last < second).then_some([last + 1, exit]);
                }
                Some(0) | None => {}
                Some(_) => return None,
            }
        }
        None
    }
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
