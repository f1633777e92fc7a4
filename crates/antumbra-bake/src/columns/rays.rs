//! The 64 rays of a leaf while they meet triangles from front to back: enter and exit depths (Kämpe et al. 2015, section
//! 3.3), and what else a policy asks for.
//!
//! Triangles are met in *clusters*, sets whose depth intervals overlap: clusters follow one another along every ray
//! alike. Within a cluster each triangle gives a row of crossings, one per ray; rows are sorted ray by ray as they come,
//! and then met in order.

use super::freedom::Freedom;
use super::lanes::{Lanes, TEXELS, any, least, map, map2, mask, select};

/// First shadowed slice of a ray without casters.
pub(super) const NEVER: u32 = u32::MAX;
/// Slice of a ray that does not cross.
pub(super) const ABSENT: u32 = i32::MAX as u32;

/// A triangle's crossings, or each ray's next ones.
#[derive(Clone, Copy)]
pub(super) struct Row {
    /// Slice, or [`ABSENT`].
    slice: Lanes,
    /// Winding plus 1 in two bits; above them the first slice behind the plane's deepest point in the whole texel, if rays
    /// may enter a solid here first, else 0.
    payload: Lanes,
}

/// Enter and exit depths in the making.
pub(super) struct Rays {
    /// First shadowed slice.
    pub enter: Lanes,
    /// First slice that must be shadowed.
    pub exit: Lanes,
    /// Slice of the second surface, where that counts.
    second: Lanes,
    /// First slice behind the entering surface's deepest point in the whole texel.
    deepest: Lanes,
    winding: Lanes,
    /// Masks of rays that have met nothing, of rays inside a solid that they met first, and of rays that look for their
    /// second surface. The others are done.
    outside: Lanes,
    inside: Lanes,
    seeking: Lanes,
}

impl Row {
    /// No crossings.
    pub const EMPTY: Self = Self { slice: [ABSENT; TEXELS], payload: [0; TEXELS] };

    /// Crossings of the rays that a mask holds; `deepest` are slices, if they count.
    #[inline(always)]
    pub fn new(covered: &Lanes, slices: &Lanes, deepest: Option<&Lanes>, winding: i32) -> Self {
        let winding = (winding + 1) as u32;
        let payload = match deepest {
            Some(deepest) => map(deepest, |slice| (slice.wrapping_add(1) << 2) | winding),
            None => [winding; TEXELS],
        };
        Self { slice: map2(covered, slices, |covered, slice| select(covered, slice, ABSENT)), payload }
    }

    #[inline(always)]
    fn is_empty(&self) -> bool {
        least(&self.slice) == ABSENT
    }

    /// Puts the nearer of each ray's two crossings here, the farther one there.
    #[inline(always)]
    fn sort_with(&mut self, other: &mut Self) {
        for i in 0..TEXELS {
            let swap = mask((other.slice[i] as i32) < self.slice[i] as i32);
            let (near, far) = (self.slice[i], other.slice[i]);
            self.slice[i] = select(swap, far, near);
            other.slice[i] = select(swap, near, far);
            let (near, far) = (self.payload[i], other.payload[i]);
            self.payload[i] = select(swap, far, near);
            other.payload[i] = select(swap, near, far);
        }
    }
}

/// Inserts a triangle's crossings into rows that are sorted ray by ray, and keeps each ray's nearest `most`.
#[inline(always)]
pub(super) fn insert(rows: &mut Vec<Row>, mut row: Row, most: usize) {
    for sorted in rows.iter_mut() {
        if row.is_empty() {
            return;
        }
        sorted.sort_with(&mut row);
    }
    if rows.len() < most && !row.is_empty() {
        rows.push(row);
    }
}

impl Rays {
    #[inline(always)]
    pub fn new() -> Self {
        Self {
            enter: [NEVER; TEXELS],
            exit: [NEVER; TEXELS],
            second: [NEVER; TEXELS],
            deepest: [0; TEXELS],
            winding: [0; TEXELS],
            outside: [u32::MAX; TEXELS],
            inside: [0; TEXELS],
            seeking: [0; TEXELS],
        }
    }

    /// Mask of rays for which further triangles matter.
    #[inline(always)]
    pub fn open(&self) -> Lanes {
        let begun = map2(&self.inside, &self.seeking, |inside, seeking| inside | seeking);
        map2(&self.outside, &begun, |outside, begun| outside | begun)
    }

    /// Whether any of the rays in a mask has met nothing yet.
    #[inline(always)]
    pub fn meet_first(&self, covered: &Lanes) -> bool {
        any(&map2(covered, &self.outside, |covered, outside| covered & outside))
    }

    /// Meets a triangle that lies alone in its depth interval, if only counts change: no ray enters, leaves or sees a second
    /// surface. False, and nothing done, otherwise.
    #[inline(always)]
    pub fn only_count(&mut self, covered: &Lanes, winding: i32) -> bool {
        let mut matters = 0;
        let mut counted = self.winding;
        for i in 0..TEXELS {
            counted[i] = counted[i].wrapping_add(winding as u32 & covered[i]);
            let leaves = self.inside[i] & mask(counted[i] as i32 <= 0);
            matters |= covered[i] & (self.outside[i] | self.seeking[i] | leaves);
        }
        if matters == 0 {
            self.winding = counted;
        }
        matters == 0
    }

    /// Meets a cluster's crossings, row after row. Within a slice entries come before exits, so touching solids leave no
    /// slit: only the sum counts, once the last crossing of the slice is met.
    #[inline(always)]
    pub fn meet(&mut self, rows: &[Row], freedom: &Freedom) {
        let seeks = mask(freedom.is_static());
        for (i, row) in rows.iter().enumerate() {
            self.meet_row(row, rows.get(i + 1).map_or(&Row::EMPTY.slice, |next| &next.slice), seeks);
        }
    }

    #[inline(always)]
    fn meet_row(&mut self, row: &Row, next: &Lanes, seeks: u32) {
        for (i, next) in next.iter().enumerate() {
            let slice = row.slice[i];
            let here = mask(slice != ABSENT) & (self.outside[i] | self.inside[i] | self.seeking[i]);
            let winding = self.winding[i].wrapping_add((row.payload[i] & 3).wrapping_sub(1) & here);
            self.winding[i] = winding;
            let enters = here & self.outside[i];
            let enter = select(enters, slice + 1, self.enter[i]);
            self.enter[i] = enter;
            let is_first = mask(slice + 1 == enter) & here;
            let is_second = here & self.seeking[i] & !is_first;
            self.second[i] = select(is_second, slice, self.second[i]);
            self.deepest[i] = self.deepest[i].max((row.payload[i] >> 2) & is_first);
            self.outside[i] &= !enters;
            self.seeking[i] = (self.seeking[i] & !is_second) | (enters & seeks);
            let inside = self.inside[i] | enters;
            let leaves = here & inside & mask(*next != slice) & mask(winding as i32 <= 0);
            self.exit[i] = select(leaves, slice.max(enter), self.exit[i]);
            self.inside[i] = inside & !leaves;
        }
    }

    /// Rays still inside a solid leave it no earlier than at the clamp, and what they would meet next lies no nearer. What
    /// then lies between enter and exit is the interval of every policy. Where there is slack, the whole texel's lit
    /// surface is left lit: shadows without acne and without bias. `spare` slices of slack are left beside.
    #[inline(always)]
    pub fn finish(&mut self, freedom: &Freedom, clamp: u32, slices: u32, spare: u32) {
        for i in 0..TEXELS {
            self.exit[i] = self.exit[i].min(clamp.max(self.enter[i]));
        }
        if freedom.is_behind_open() {
            self.free_behind_open(freedom, clamp, slices);
        }
        for i in 0..TEXELS {
            let (enter, deepest) = (self.enter[i], self.deepest[i]);
            let narrows = mask(deepest >= enter) & mask(deepest.saturating_add(spare) <= self.exit[i]);
            self.enter[i] = select(narrows, deepest, enter);
        }
    }

    #[inline(always)]
    fn free_behind_open(&mut self, freedom: &Freedom, clamp: u32, slices: u32) {
        for i in 0..TEXELS {
            // Surfaces behind the last slice do not count; nothing was dropped where the clamp lies there.
            let second = self.second[i].min(clamp);
            let second = if second >= slices { NEVER } else { second };
            if self.enter[i] != NEVER {
                self.exit[i] = self.exit[i].max(freedom.exit(self.enter[i], second));
            }
        }
    }
}
