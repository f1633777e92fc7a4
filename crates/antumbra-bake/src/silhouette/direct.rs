//! Tiles that are solved at once, however large, where the recursion would go down to each of their texels along an edge.
//!
//! Where no more than two edges of triangles that may be seen first cross a tile, one front covers each of the regions between them, or nothing does. A
//! ray of a region enters by that front, if all others lie behind it, and leaves no sooner than by the nearest triangle where rays leave
//! solids. All are planes, so that corners of regions tell which depths are right. Where front and back meet in an edge there is no
//! slack: there the wedge between them is held against the exact slices of the texels along the edge.

use antumbra::format::silhouette::Form;
use arrayvec::ArrayVec;
use pulp::{Simd, WithSimd};

use super::accept::{CORNER_ERROR, Ends, Forms, MOST_CORNERS, Polygon, ROUNDING, corners};
use super::form::{EdgeKey, Plane, Side, Surface, edge_of};
use super::gap::depth_error;
use super::leaf::{depths_at, left_of};
use super::sketch::{Cut, Set, Sketch};
use crate::columns::{Build, BuildTriangle, COVERS, CUTOUT, EnterGrid, Entry, LEAF_LOG2, Leaf, Tile, spread};

/// log2 of the least tiles that are tried: at half that side four leaves are as quick, and find more.
const LEAST_LOG2: u32 = 5;
/// Longer lists are not looked at.
const MOST_ENTRIES: usize = 48;
/// Triangles where rays leave a region that count as planes; others by the slice where they begin.
const MOST_BACKS: usize = 4;
/// Fronts and backs of which planes are tried.
const MOST_SIDES: usize = 4;
/// Leaves along an edge that are looked at, for each that lies on a side of the tile.
const MOST_LEAVES: u32 = 4;
/// Parts of a tile of so many texels may rest.
const PAUSE_LOG2: u32 = 8;

/// A tile that at most two edges part into regions with one front each.
///
/// `entries` are sorted by their first slices; what was dropped lies no nearer than `clamp`, where all texels are in shadow.
pub(crate) fn sketch(build: &Build<'_>, tile: Tile, entries: &[Entry], clamp: u32, forms: Forms<'_>) -> Option<Sketch> {
    let is_simple = tile.log2 >= LEAST_LOG2 && entries.len() <= MOST_ENTRIES && !build.freedom.is_behind_open();
    if !is_simple || entries.iter().any(|e| e.has(CUTOUT) || e.triangle > Plane::MOST_TRIANGLES) {
        return None;
    }
    let none = Direct {
        build,
        forms,
        tile,
        entries,
        clamp,
        edges: ArrayVec::new(),
        fronts: ArrayVec::new(),
        backs: ArrayVec::new(),
    };
    let edges = none.crossing_edges()?;
    let (fronts, backs) = (none.sides(Side::Past, 1), none.sides(Side::Before, -1));
    Direct { edges, fronts, backs, ..none }.sketch()
}

struct Direct<'a> {
    build: &'a Build<'a>,
    forms: Forms<'a>,
    tile: Tile,
    entries: &'a [Entry],
    clamp: u32,
    edges: ArrayVec<(EdgeKey, Form), 2>,
    /// The first triangles where rays enter solids, and planes past them.
    fronts: ArrayVec<(u32, Form), MOST_SIDES>,
    /// The first ones where rays leave, and planes before them.
    backs: ArrayVec<(u32, Form), MOST_SIDES>,
}

/// A triangle's depths at a region's corners, in units, and by how much they may be off.
#[derive(Clone, Copy)]
struct Depths {
    entry: Entry,
    at: [f64; MOST_CORNERS],
    error: f64,
}

/// Whether a triangle is there in a region.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Presence {
    Absent,
    /// At some of its texels, perhaps.
    Partial,
    Whole,
}

impl Direct<'_> {
    /// The edges that cross the tile of triangles that may be seen first; `None` if there are more than two.
    fn crossing_edges(&self) -> Option<ArrayVec<(EdgeKey, Form), 2>> {
        let mut edges: ArrayVec<(EdgeKey, Form), 2> = ArrayVec::new();
        let polygon = Polygon::of_tile(self.tile);
        let cover = self.nearest(self.entries.iter().filter(|entry| entry.has(COVERS)), &polygon);
        for entry in self.entries {
            let triangle = self.triangle(entry);
            if triangle.is_edge_on() || entry.has(COVERS) || triangle.winding() == -1 {
                continue;
            }
            if cover.as_ref().is_some_and(|cover| self.is_behind(cover, entry, None, &polygon)) {
                continue;
            }
            for i in 0..3 {
                let (key, _) = edge_of(triangle, i);
                if edges.iter().any(|(known, _)| *known == key) {
                    continue;
                }
                let form = self.forms.edge(key);
                let [a, rest @ ..] = corners(self.tile).map(|texel| form.at(texel) >= 0);
                if rest.iter().any(|other| *other != a) {
                    edges.try_push((key, form)).ok()?;
                }
            }
        }
        edges.sort_unstable();
        Some(edges)
    }

    /// The first triangles of a winding that have planes on a side.
    fn sides(&self, side: Side, winding: i32) -> ArrayVec<(u32, Form), MOST_SIDES> {
        let of_winding = self.entries.iter().filter(|entry| self.triangle(entry).winding() == winding);
        let form = |entry: &Entry| Some((entry.triangle, self.forms.plane(Plane::new(entry.triangle, side))?));
        of_winding.filter_map(form).take(MOST_SIDES).collect()
    }

    fn triangle(&self, entry: &Entry) -> &BuildTriangle {
        &self.forms.triangles[entry.triangle as usize]
    }

    /// The nearest one of some triangles in the middle of a polygon.
    fn nearest<'e>(&self, entries: impl Iterator<Item = &'e Entry>, polygon: &Polygon) -> Option<Depths> {
        let middle = |depths: &Depths| depths.at[..polygon.count].iter().sum::<f64>();
        entries.map(|entry| self.depths(entry, polygon)).min_by(|a, b| middle(a).total_cmp(&middle(b)))
    }

    fn sketch(&self) -> Option<Sketch> {
        let count = self.edges.len();
        let mut regions: [Option<Set>; 4] = [None; 4];
        let mut fronts: ArrayVec<(usize, Option<Entry>), 4> = ArrayVec::new();
        for (number, region) in regions.iter_mut().enumerate().take(1 << count) {
            if count < 2 || self.has_texels(number) {
                let (front, set) = self.set(number, &Polygon::of_part(self.tile, self.bounds(number)))?;
                fronts.push((number, front));
                *region = Some(set);
            }
        }
        if let Some(grid) = self.build.enters {
            self.record_enters(self.tile, &fronts, grid);
        }
        // As few edges as will do. All planes were tried in all regions.
        let joint = |is_wanted: &dyn Fn(usize) -> bool| {
            let mut wanted = (0..4).filter(|number| is_wanted(*number)).filter_map(|number| regions[number]);
            let first = wanted.next()?;
            wanted.try_fold(first, |joint, set| joint.common(&set))
        };
        if let Some(set) = joint(&|_| true) {
            return Some(Sketch::Flat(set));
        }
        let cut = |edges: &[(EdgeKey, Form)], regions| {
            let edges = edges.iter().map(|(key, _)| *key).collect();
            Some(Sketch::Cut(Box::new(Cut { edges, regions })))
        };
        if count == 2 {
            for bit in 0..2 {
                let [right, left] = [0, 1].map(|side| joint(&|number| number >> bit & 1 == side));
                if right.is_some() && left.is_some() {
                    return cut(&self.edges[bit..=bit], [right, left, None, None]);
                }
            }
        }
        cut(&self.edges, regions)
    }

    /// The edges that bound a region, and whether it lies to the left of each.
    fn bounds(&self, number: usize) -> impl Iterator<Item = (Form, bool)> {
        self.edges.iter().enumerate().map(move |(bit, (_, form))| (*form, number >> bit & 1 != 0))
    }

    /// Notes between which slices rays of a part of the tile are first shadowed, given each region's front.
    fn record_enters(&self, part: Tile, fronts: &[(usize, Option<Entry>)], grid: &EnterGrid) {
        if part.log2 > grid.cell_log2().max(LEAF_LOG2) {
            return (0..4).for_each(|i| self.record_enters(part.child(i), fronts, grid));
        }
        for (number, front) in fronts.iter().filter(|(number, _)| !self.is_elsewhere(*number, part)) {
            let span = front.map_or([u32::MAX; 2], |front| {
                let polygon = Polygon::of_part(part, self.bounds(*number));
                let depths = self.depths(&front, &polygon);
                let slices = depths.at.map(|depth| {
                    [-1.0, 1.0].map(|sign| self.build.slices.of_units(depth + sign * depths.error).saturating_add(1))
                });
                slices[1..polygon.count].iter().fold(slices[0], |a, b| [a[0].min(b[0]), a[1].max(b[1])])
            });
            self.build.record_enters(part, span);
        }
    }

    /// Whether a part of the tile has no texel of a region, as far as its corners tell.
    fn is_elsewhere(&self, number: usize, part: Tile) -> bool {
        let is_beyond =
            |(form, is_left): (Form, bool)| corners(part).iter().all(|texel| (form.at(*texel) >= 0) != is_left);
        self.bounds(number).any(is_beyond)
    }

    /// Whether a region between two edges has any texel.
    fn has_texels(&self, number: usize) -> bool {
        let Tile { x, y, log2 } = self.tile;
        let last = x + (1 << log2) - 1;
        let is_in = |texel: [u32; 2]| self.bounds(number).all(|(form, is_left)| (form.at(texel) >= 0) == is_left);
        let has_any = |y: u32| {
            let row = [i64::from(x), i64::from(last)];
            let [first, last] = self.bounds(number).fold(row, |row, (form, is_left)| on_side(&form, y, is_left, row));
            first <= last
        };
        corners(self.tile).into_iter().any(is_in) || (y..y + (1 << log2)).any(has_any)
    }

    fn presence(&self, entry: &Entry, number: usize) -> Presence {
        let triangle = self.triangle(entry);
        if triangle.is_edge_on() {
            return Presence::Absent;
        }
        let mut presence = Presence::Whole;
        for i in (0..3).filter(|_| !entry.has(COVERS)) {
            let (key, is_left) = edge_of(triangle, i);
            let is_inside = match self.edges.iter().position(|(edge, _)| *edge == key) {
                Some(bit) => Some((number >> bit & 1 != 0) == is_left),
                None => {
                    let form = self.forms.edge(key);
                    let [a, rest @ ..] = corners(self.tile).map(|texel| (form.at(texel) >= 0) == is_left);
                    rest.iter().all(|other| *other == a).then_some(a)
                }
            };
            match is_inside {
                Some(false) => return Presence::Absent,
                Some(true) => {}
                None => presence = Presence::Partial,
            }
        }
        presence
    }

    fn depths(&self, entry: &Entry, polygon: &Polygon) -> Depths {
        let slices = self.build.slices;
        let t = self.triangle(entry);
        let (units, steps) = (slices.units_per_step(), slices.resolution().texel_steps() as f64);
        let points = polygon.corners.map(|corner| corner.map(|c| (c + 0.5) * steps));
        let error = depth_error(t, &points, slices) + (t.slope[0].abs() + t.slope[1].abs()) * steps * CORNER_ERROR;
        let at = points.map(|point| t.depth(point, units));
        Depths { entry: *entry, at, error }
    }

    /// The front by which all of a region's rays enter, and the depths that suit them, as far as its corners tell, and texels along its edges.
    fn set(&self, number: usize, polygon: &Polygon) -> Option<(Option<Entry>, Set)> {
        let all = self.build.slices.resolution().texels();
        let present: ArrayVec<(&Entry, Presence), MOST_ENTRIES> = self
            .entries
            .iter()
            .map(|entry| (entry, self.presence(entry, number)))
            .filter(|(_, presence)| *presence != Presence::Absent)
            .collect();
        if present.is_empty() {
            return (self.clamp >= all).then(|| (None, Set::constants(all, all)));
        }
        let whole = present.iter().filter(|(_, presence)| *presence == Presence::Whole);
        let front = self.nearest(whole.map(|(entry, _)| *entry), polygon)?;
        let others = present.iter().map(|(entry, _)| *entry).filter(|e| e.triangle != front.entry.triangle);
        let is_first = others.clone().all(|other| self.is_behind(&front, other, Some(number), polygon));
        if self.triangle(&front.entry).winding() != 1 || !is_first {
            return None;
        }
        let mut backs: ArrayVec<Depths, MOST_BACKS> = ArrayVec::new();
        let mut clamp = self.clamp;
        for back in others.filter(|other| self.triangle(other).winding() == -1) {
            if backs.is_full() {
                clamp = clamp.min(back.first);
            } else {
                backs.push(self.depths(back, polygon));
            }
        }
        let set = self.set_between(Between { number, polygon, front: &front, backs: &backs, clamp })?;
        Some((Some(front.entry), set))
    }

    /// Whether a triangle lies behind a front wherever both are in a region, or in the tile.
    fn is_behind(&self, front: &Depths, other: &Entry, number: Option<usize>, polygon: &Polygon) -> bool {
        if other.first > front.entry.last || self.triangle(other).is_edge_on() {
            return true;
        }
        let behind = self.depths(other, polygon);
        let error = front.error + behind.error;
        let distance = |i: usize| behind.at[i] - front.at[i];
        if (0..polygon.count).all(|i| distance(i) >= error) {
            return true;
        }
        // Planes that meet in an edge do so nowhere else: the farthest corner tells which is behind.
        let Some(number) = number else { return false };
        self.edges.iter().enumerate().any(|(bit, (key, form))| {
            let sign = if number >> bit & 1 != 0 { 1.0 } else { -1.0 };
            let off = |[x, y]: [f64; 2]| sign * (f64::from(form.a) * x + f64::from(form.b) * y + form.c as f64);
            let offs = polygon.corners.map(off);
            let farthest = (0..polygon.count).max_by(|i, j| offs[*i].total_cmp(&offs[*j]));
            let is_off = |i: usize| offs[i] > 2.0 + (form.c as f64).abs() * (4.0 * ROUNDING);
            share_edge(self.triangle(&front.entry), self.triangle(other), *key)
                && farthest.is_some_and(|i| is_off(i) && distance(i) >= error)
        })
    }

    /// What is right behind a front and before the backs, and before the clamp.
    fn set_between(&self, between: Between<'_>) -> Option<Set> {
        let Between { polygon, front, backs, clamp, .. } = between;
        let (forms, slices) = (&self.forms, self.build.slices);
        let resolution = slices.resolution();
        let all = resolution.texels();
        let (next, own) = (slices.value_of(true), slices.value_of(false));
        let rise = self.triangle(&front.entry).rise(resolution.texel_steps() as f64, slices);
        let count = polygon.count;
        let deepest = polygon.values(front.at.map(|d| next.of(d + rise)), front.error);
        let entered = polygon.values(front.at.map(|d| next.of(d)), front.error);
        let mut behind: ArrayVec<Ends, { MOST_BACKS + 1 }> =
            backs.iter().map(|back| polygon.values(back.at.map(|d| own.of(d)), back.error)).collect();
        if clamp < all {
            behind.push(polygon.constant(forms.first_value(clamp + 1)));
        }
        let is_before_all = |ends: &Ends| behind.iter().all(|other| ends.is_before(other));
        let at_corners = |depths: &Depths, more: f64| depths.at.map(|depth| slices.of_units(depth + more));
        let low = at_corners(front, rise + front.error)[..count].iter().max()?.saturating_add(1);
        let of_back = |back: &Depths| at_corners(back, -back.error)[..count].iter().copied().min();
        let high = backs.iter().filter_map(of_back).min().unwrap_or(all).min(clamp).min(all);
        let mut set = Set::constants(low.min(all), high);
        // Planes of neighbours may do, too: where they do in both regions no edge is needed.
        let mut pasts: ArrayVec<(u32, [Form; 2], [Ends; 2]), MOST_SIDES> = ArrayVec::new();
        for (triangle, past) in &self.fronts {
            let deep = forms.deep(*past);
            let Some(deep_ends) = Ends::of_deep(deep, polygon, forms) else { continue };
            if !deepest.is_before(&deep_ends) {
                continue;
            }
            if is_before_all(&deep_ends) {
                set.push(Surface::plane(Plane::new(*triangle, Side::Past).deep()));
            }
            let past_ends = Ends::new(*past, polygon);
            if entered.is_before(&past_ends) {
                pasts.push((*triangle, [*past, deep], [past_ends, deep_ends]));
            }
        }
        let mut leaves = MOST_LEAVES << (self.tile.log2 - LEAF_LOG2);
        for (back, before) in &self.backs {
            let before_ends = Ends::new(*before, polygon);
            if deepest.is_before(&before_ends) && is_before_all(&before_ends) {
                set.push(Surface::plane(Plane::new(*back, Side::Before)));
            }
            for (triangle, [past, deep], [past_ends, deep_ends]) in &pasts {
                let wedge = Wedge { planes: [*past, *deep, *before], between };
                let fits = |other: &Ends| wedge_is_before([past_ends, deep_ends, &before_ends], other);
                let is_own = *triangle == front.entry.triangle;
                if behind.iter().all(fits) || (is_own && self.holds(&wedge, self.tile, &mut leaves)) {
                    set.push(Surface::wedge(*triangle, *back));
                }
            }
        }
        (!set.is_empty()).then_some(set)
    }

    /// Whether a wedge is right at all of a region's texels in a part of the tile, if that takes no more than so many leaves to tell.
    fn holds(&self, wedge: &Wedge<'_>, part: Tile, leaves: &mut u32) -> bool {
        if self.is_elsewhere(wedge.between.number, part) || self.is_clear(wedge, part) {
            return true;
        }
        if part.log2 > LEAF_LOG2 {
            if part.log2 == PAUSE_LOG2 {
                (self.build.pause)();
            }
            return (0..4).all(|i| self.holds(wedge, part.child(i), leaves));
        }
        *leaves = leaves.saturating_sub(1);
        let leaf = Leaf { build: self.build, tile: part };
        *leaves > 0 && self.build.arch().dispatch(Along { direct: self, wedge, leaf })
    }

    /// Whether a wedge is right throughout a part of the tile by its corners.
    fn is_clear(&self, wedge: &Wedge<'_>, part: Tile) -> bool {
        let slices = self.build.slices;
        let polygon = Polygon::of_tile(part);
        let [past, deep, before] = wedge.planes;
        let (past, before) = (Ends::new(past, &polygon), Ends::new(before, &polygon));
        let Some(deep) = Ends::of_deep(deep, &polygon, &self.forms) else { return false };
        let fits = |other: &Ends| wedge_is_before([&past, &deep, &before], other);
        let of_back = |back: &Depths| {
            let depths = self.depths(&back.entry, &polygon);
            polygon.values(depths.at.map(|d| slices.value_of(false).of(d)), depths.error)
        };
        let Between { backs, clamp, .. } = wedge.between;
        let of_clamp = || polygon.constant(self.forms.first_value(clamp + 1));
        backs.iter().map(of_back).all(|other| fits(&other))
            && (clamp >= slices.resolution().texels() || fits(&of_clamp()))
    }
}

/// Whether a wedge, max(past, min(deep, before)), lies before a plane throughout: past is the nearer of past and deep.
fn wedge_is_before([past, deep, before]: [&Ends; 3], other: &Ends) -> bool {
    deep.is_before(other) || (past.is_before(other) && before.is_before(other))
}

/// Of a row of texels from one to another: those on a side of an edge, if they are not none.
fn on_side(form: &Form, y: u32, is_left: bool, [first, last]: [i64; 2]) -> [i64; 2] {
    let at = |x: i64| (form.at([x as u32, y]) >= 0) == is_left;
    if first > last {
        return [first, last];
    }
    match [at(first), at(last)] {
        [true, true] => [first, last],
        [false, false] => [last + 1, last],
        [starts_in, _] => {
            // The first one on the other side than the first of all.
            let (mut here, mut there) = (first, last);
            while there - here > 1 {
                let middle = here + (there - here) / 2;
                if at(middle) == starts_in { here = middle } else { there = middle }
            }
            if starts_in { [first, here] } else { [there, last] }
        }
    }
}

/// Whether two triangles have an edge in common, on the lattice and in depth.
fn share_edge(a: &BuildTriangle, b: &BuildTriangle, key: EdgeKey) -> bool {
    let depth_at = |t: &BuildTriangle, end: [i32; 2]| (0..3).find(|i| [t.x[*i], t.y[*i]] == end).map(|i| t.z[i]);
    key.iter().all(|end| depth_at(a, *end).is_some_and(|depth| depth_at(b, *end) == Some(depth)))
}

/// A region, the front by which its rays enter a solid, and triangles by one of which they leave it, or not before `clamp`.
#[derive(Clone, Copy)]
struct Between<'a> {
    number: usize,
    polygon: &'a Polygon,
    front: &'a Depths,
    backs: &'a [Depths],
    clamp: u32,
}

/// A wedge that is to be right in a region: the planes past its front, deep behind it and before its back.
struct Wedge<'a> {
    planes: [Form; 3],
    between: Between<'a>,
}

/// Whether a wedge is right at all of a region's texels in a leaf.
struct Along<'a> {
    direct: &'a Direct<'a>,
    wedge: &'a Wedge<'a>,
    leaf: Leaf<'a>,
}

impl WithSimd for Along<'_> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> bool {
        let Self { direct, wedge, leaf } = self;
        let slices = direct.build.slices;
        let all = slices.resolution().texels();
        let mut texels = u64::MAX;
        for (form, is_left) in direct.bounds(wedge.between.number) {
            let left = left_of(form, leaf);
            texels &= if is_left { left } else { !left };
        }
        let covered = spread(texels);
        let first = leaf.first_center();
        let of = |depths: &Depths| direct.triangle(&depths.entry).leaf_slices(first, &covered, slices);
        let enter = of(wedge.between.front).map(|slice| slice.wrapping_add(1).min(all));
        let mut exit = [wedge.between.clamp.min(all); 64];
        for back in wedge.between.backs {
            for (exit, slice) in exit.iter_mut().zip(of(back)) {
                *exit = (*exit).min(slice);
            }
        }
        let [past, deep, before] = wedge.planes;
        let past = depths_at(&past, leaf, slices, false);
        let deep = depths_at(&deep, leaf, slices, true);
        let before = depths_at(&before, leaf, slices, false);
        let mut is_right = true;
        for i in 0..64 {
            let depth = past[i].max(deep[i].min(before[i]));
            is_right &= covered[i] == 0 || (enter[i] <= depth && depth <= exit[i].max(enter[i]));
        }
        is_right
    }
}
