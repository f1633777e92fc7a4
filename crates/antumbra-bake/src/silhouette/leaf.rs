//! Leaves: 8 x 8 texels, from their rays' intervals to the fewest edges that part them into regions of one depth each.

use antumbra::format::silhouette::Form;
use antumbra::format::slices::Spread;
use arrayvec::ArrayVec;

use super::accept::{Forms, corners};
use super::form::{EdgeKey, FRACTION_BITS, Plane, ROUNDER, Side, Surface, edge_of};
use super::sketch::{Cut, Set, Sketch, Turn};
use pulp::{Simd, WithSimd};

use crate::columns::{Build, COVERS, Entry, LEAF_LOG2, Lanes, Leaf, LeafScratch, Tile, Transition};
use crate::light_space::Slices;

/// Edges and planes that are tried.
const MOST_EDGES: usize = 10;
const MOST_PLANES: usize = 16;
/// Those, one more, and what wedges and pairs add.
const MOST_FOUND: usize = MOST_PLANES + 1 + MOST_SIDES * MOST_SIDES + MOST_SINGLE * (MOST_SINGLE - 1);
/// Fronts and backs that wedges are tried of.
const MOST_SIDES: usize = 4;
/// Planes of which pairs are tried.
const MOST_SINGLE: usize = 6;
/// Depths over more slices than this are looked up one by one.
const MOST_COUNTED: u32 = 16;
/// Triangles that are looked at.
const MOST_TRIANGLES: usize = 48;

/// Surfaces, and the texels at which each is right.
type Found = ArrayVec<(Surface, u64), MOST_FOUND>;

/// Pairs of texels that are remembered because no constant suits both.
const MOST_CONFLICTS: usize = 8;

/// A leaf in the making.
struct Parts<'a> {
    enter: &'a Lanes,
    exit: &'a Lanes,
    /// Each surface, and the texels at which it is right.
    surfaces: Found,
    /// Pairs of texels that no constant suits, and how many were found.
    conflicts: [u64; MOST_CONFLICTS],
    found: usize,
}

/// A leaf's sketch; `entries` are sorted by their first slices.
pub(crate) fn sketch(
    scratch: &mut LeafScratch,
    leaf: Leaf<'_>,
    entries: &[Entry],
    clamp: u32,
    forms: &Forms<'_>,
) -> Sketch {
    let slices = forms.slices.resolution().texels();
    let [mut enter, mut exit] = scratch.intervals(leaf, entries, clamp);
    enter.iter_mut().chain(&mut exit).for_each(|depth| *depth = (*depth).min(slices));
    let entries = &entries[..entries.len().min(MOST_TRIANGLES)];
    scratch.arch().dispatch(Regions { enter: &enter, exit: &exit, leaf, entries, forms }).unwrap_or_else(|| {
        let turn = |t: &Transition| Turn { low: t.first, high: t.last, lit: t.lit };
        Sketch::Masks(scratch.transitions(&enter, &exit, slices).iter().map(turn).collect())
    })
}

/// A tile that one open triangle hides, whose plane is right at all of its texels: the least and the greatest first shadowed slice. `None` where it
/// is not.
pub(crate) struct Face<'a> {
    pub build: &'a Build<'a>,
    pub tile: Tile,
    pub triangle: u32,
    /// Its plane, just behind it.
    pub form: Form,
}

impl WithSimd for Face<'_> {
    type Output = Option<[u32; 2]>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let Self { build, tile, triangle, form } = self;
        let triangle = &build.triangles[triangle as usize];
        let steps = || (0..1 << tile.log2).step_by(1 << LEAF_LOG2);
        let mut span = [u32::MAX, 0];
        for y in steps() {
            for x in steps() {
                let leaf = Leaf { build, tile: Tile { x: tile.x + x, y: tile.y + y, log2: LEAF_LOG2 } };
                let (enter, [least, greatest]) = leaf.enters_of_face(triangle);
                if depths_at(&form, leaf, build.slices, false) != enter {
                    return None;
                }
                span = [span[0].min(least), span[1].max(greatest)];
            }
        }
        Some(span)
    }
}

/// Finds a leaf's regions.
struct Regions<'a> {
    enter: &'a Lanes,
    exit: &'a Lanes,
    leaf: Leaf<'a>,
    entries: &'a [Entry],
    forms: &'a Forms<'a>,
}

impl WithSimd for Regions<'_> {
    /// `None` if there are too many.
    type Output = Option<Sketch>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> Self::Output {
        let Self { enter, exit, leaf, entries, forms } = self;
        let surfaces = surfaces(enter, exit, leaf, entries, forms);
        let mut parts = Parts { enter, exit, surfaces, conflicts: [0; MOST_CONFLICTS], found: 0 };
        if let Some(set) = parts.set(u64::MAX) {
            return Some(Sketch::Flat(set));
        }
        parts.cut(&edges(leaf, entries, forms))
    }
}

impl Parts<'_> {
    /// The depths that suit all texels of a mask.
    #[inline(always)]
    fn set(&mut self, mask: u64) -> Option<Set> {
        if self.is_hopeless(mask) {
            return None;
        }
        let (mut lows, mut highs) = ([0; 8], [u32::MAX; 8]);
        for y in 0..8 {
            let row = (mask >> (8 * y)) as u32 & 0xff;
            for x in 0..8 {
                let on = (row >> x & 1).wrapping_neg();
                lows[x] = lows[x].max(self.enter[8 * y + x] & on);
                highs[x] = highs[x].min(self.exit[8 * y + x] | !on);
            }
        }
        let low = lows.into_iter().fold(0, u32::max);
        let high = highs.into_iter().fold(u32::MAX, u32::min);
        let fits = self.surfaces.iter().filter(|(_, right)| right & mask == mask);
        let set = Set::new([low, high], fits.map(|(surface, _)| *surface));
        if set.is_empty() {
            self.remember(mask, [low, high]);
            return None;
        }
        Some(set)
    }

    /// Whether no depth suits all texels of a mask: two are in it that no constant suits, and no surface is right at all of them.
    #[inline(always)]
    fn is_hopeless(&self, mask: u64) -> bool {
        let conflicts = &self.conflicts[..self.found.min(MOST_CONFLICTS)];
        conflicts.iter().any(|pair| mask & pair == *pair)
            && !self.surfaces.iter().any(|(_, right)| right & mask == mask)
    }

    /// Remembers two texels of a mask that no constant suits: the one that enters last, and the one that leaves first.
    #[inline(always)]
    fn remember(&mut self, mask: u64, [last, first]: [u32; 2]) {
        let texel = |depths: &Lanes, depth: u32| {
            let found = depths.iter().enumerate().find(|(i, d)| mask >> i & 1 != 0 && **d == depth);
            found.map_or(0, |(i, _)| 1u64 << i)
        };
        self.conflicts[self.found % MOST_CONFLICTS] = texel(self.enter, last) | texel(self.exit, first);
        self.found += 1;
    }

    /// One edge that parts the leaf, or two.
    #[inline(always)]
    fn cut(&mut self, edges: &[(EdgeKey, u64)]) -> Option<Sketch> {
        let cut = |edges: &[EdgeKey], regions| {
            let edges = edges.iter().copied().collect();
            Some(Sketch::Cut(Box::new(Cut { edges, regions })))
        };
        for (edge, left) in edges {
            if !self.is_hopeless(*left)
                && let Some(right) = self.set(!left)
                && let Some(left) = self.set(*left)
            {
                return cut(&[*edge], [Some(right), Some(left), None, None]);
            }
        }
        for (i, (a, left_a)) in edges.iter().enumerate() {
            for (b, left_b) in &edges[i + 1..] {
                let (first, second, left) = if a < b { (left_a, left_b, [*a, *b]) } else { (left_b, left_a, [*b, *a]) };
                let masks = [!first & !second, first & !second, !first & second, first & second];
                if masks.iter().any(|mask| *mask != 0 && self.is_hopeless(*mask)) {
                    continue;
                }
                let mut regions = [None; 4];
                let fits = masks.iter().zip(&mut regions).all(|(mask, region)| {
                    *region = if *mask == 0 { None } else { self.set(*mask) };
                    *mask == 0 || region.is_some()
                });
                if fits {
                    return cut(&left, regions);
                }
            }
        }
        None
    }
}

/// A leaf's surfaces in the making.
struct Surfaces<'a> {
    enter: &'a Lanes,
    exit: &'a Lanes,
    /// Each that is right somewhere, and the texels where it is.
    found: Found,
    /// The first triangles where rays enter a solid: depths just behind them, and deep ones.
    fronts: ArrayVec<(u32, [Lanes; 2]), MOST_SIDES>,
    /// The first ones where rays leave: depths just before them.
    backs: ArrayVec<(u32, Lanes), MOST_SIDES>,
    /// The first planes of which two may be right together, none of them deep: where they are right alone, and their depths.
    single: ArrayVec<(Plane, u64, Lanes), MOST_SINGLE>,
}

/// Surfaces of the leaf's triangles that are right somewhere, and where.
#[inline(always)]
fn surfaces(enter: &Lanes, exit: &Lanes, leaf: Leaf<'_>, entries: &[Entry], forms: &Forms<'_>) -> Found {
    let (fronts, backs, single) = (ArrayVec::new(), ArrayVec::new(), ArrayVec::new());
    let mut surfaces = Surfaces { enter, exit, found: Found::new(), fronts, backs, single };
    // Where there is no slack no depth but the surface's own is right.
    let is_exact = enter == exit;
    for entry in entries {
        if surfaces.found.len() >= MOST_PLANES || entry.triangle > Plane::MOST_TRIANGLES {
            break;
        }
        let winding = forms.triangles[entry.triangle as usize].winding();
        let side = match winding {
            1 => Side::Past,
            -1 => Side::Before,
            _ => Side::Behind,
        };
        let plane = Plane::new(entry.triangle, side);
        let Some(form) = forms.plane(plane) else { continue };
        let own = depths_at(&form, leaf, forms.slices, false);
        if winding == -1 {
            if !surfaces.backs.is_full() {
                surfaces.backs.push((entry.triangle, own));
            }
        } else if !is_exact {
            let deep = depths_at(&forms.deep(form), leaf, forms.slices, true);
            surfaces.push_plane(plane.deep(), deep);
            if winding == 1 && !surfaces.fronts.is_full() {
                surfaces.fronts.push((entry.triangle, [own, deep]));
            }
        }
        if winding == 0 {
            surfaces.push_plane(plane, own);
        } else {
            surfaces.push(Surface::plane(plane), &own);
        }
    }
    surfaces.push_wedges();
    surfaces.push_pairs();
    surfaces.found
}

impl Surfaces<'_> {
    /// The texels at which depths are right.
    #[inline(always)]
    fn right(&self, depths: &Lanes) -> u64 {
        let is_right = |i: usize| self.enter[i] <= depths[i] && depths[i] <= self.exit[i];
        mask_of(&std::array::from_fn(|i| u8::from(is_right(i))))
    }

    #[inline(always)]
    fn push(&mut self, surface: Surface, depths: &Lanes) {
        let right = self.right(depths);
        if right != 0 {
            self.found.push((surface, right));
        }
    }

    /// A plane that may be one of two.
    #[inline(always)]
    fn push_plane(&mut self, plane: Plane, depths: Lanes) {
        let right = self.right(&depths);
        if right != 0 {
            self.found.push((Surface::plane(plane), right));
            if !self.single.is_full() && !plane.is_deep() {
                self.single.push((plane, right, depths));
            }
        }
    }

    #[inline(always)]
    fn push_wedges(&mut self) {
        let (fronts, backs) = (std::mem::take(&mut self.fronts), std::mem::take(&mut self.backs));
        for (front, [own, deep]) in &fronts {
            for (back, before) in &backs {
                let mut depths = *own;
                for (i, depth) in depths.iter_mut().enumerate() {
                    *depth = (*depth).max(deep[i].min(before[i]));
                }
                self.push(Surface::wedge(*front, *back), &depths);
            }
        }
    }

    /// The nearer and the farther of two planes, where neither alone is right wherever the other is.
    #[inline(always)]
    fn push_pairs(&mut self) {
        let single = std::mem::take(&mut self.single);
        for (i, (a, right_a, depths_a)) in single.iter().enumerate() {
            for (b, right_b, depths_b) in &single[..i] {
                if right_a & !right_b == 0 || right_b & !right_a == 0 {
                    continue;
                }
                let of = |choose: fn(u32, u32) -> u32| std::array::from_fn(|i| choose(depths_a[i], depths_b[i]));
                self.push(Surface::nearer(*a, *b), &of(u32::min));
                self.push(Surface::farther(*a, *b), &of(u32::max));
            }
        }
    }
}

/// A form's values at the texels of a leaf that begins at one.
#[inline(always)]
fn values(form: &Form, first: [u32; 2]) -> [i64; 64] {
    let corner = form.at(first);
    let [a, b] = [i64::from(form.a), i64::from(form.b)];
    let across: [i64; 8] = std::array::from_fn(|x| a * x as i64);
    let mut values = [0; 64];
    for (y, row) in (0..).zip(values.chunks_exact_mut(8)) {
        let begin = corner + b * y;
        row.iter_mut().zip(&across).for_each(|(value, step)| *value = begin + step);
    }
    values
}

/// Most bits of numbers that doubles hold whole, with one more for a sum's carry.
const EXACT_BITS: u32 = 51;

/// A plane's depths at the texels of a leaf that begins at one, where slices are even, 0 to N: whole numbers in doubles, whose products by
/// powers of two are exact. `None` where they may be too great for that.
#[inline(always)]
fn even_depths_at(form: &Form, first: [u32; 2], slices: u32) -> Option<Lanes> {
    let corner = form.at(first);
    if corner.unsigned_abs() >> EXACT_BITS != 0 || form.shift > FRACTION_BITS {
        return None;
    }
    let unit = 1.0 / (1u64 << form.shift) as f64;
    let [a, b, corner] = [f64::from(form.a), f64::from(form.b), corner as f64].map(|factor| factor * unit);
    let across: [f64; 8] = std::array::from_fn(|x| a * x as f64);
    let most = f64::from(slices);
    // Half less than nothing rounds down what is whole, too.
    let down = 0.5 - 0.5 / (1u64 << FRACTION_BITS) as f64;
    let mut depths = [0; 64];
    for (y, row) in (0..8).zip(depths.chunks_exact_mut(8)) {
        let begin = corner + b * f64::from(y);
        for (depth, step) in row.iter_mut().zip(&across) {
            let value = begin + step;
            let value = if value > 0.0 { value } else { 0.0 };
            let value = if value < most { value } else { most };
            // Adding so much rounds to a whole number and leaves it in the low bits.
            *depth = ((value - down) + ROUNDER).to_bits() as u32;
        }
    }
    Some(depths)
}

/// A plane's depths at a leaf's texels, or a deep one's.
#[inline(always)]
pub(super) fn depths_at(form: &Form, leaf: Leaf<'_>, slices: &Slices, is_deep: bool) -> Lanes {
    let (spread, texel) = (slices.spread(), [leaf.tile.x, leaf.tile.y]);
    if let Spread::Even(count) = spread
        && let Some(depths) = even_depths_at(form, texel, count)
    {
        return depths;
    }
    let values = values(form, texel).map(|value| value >> form.shift);
    if matches!(spread, Spread::Even(_)) {
        return values.map(|value| spread.depth(value));
    }
    let of = |value: i64| {
        // By the builder's own table, which is faster than a search.
        let step = value.clamp(0, u32::MAX.into()) as u32;
        let depth = if value < 0 { 0 } else { (slices.of_step(step) + 1).min(spread.count()) };
        let is_next = is_deep && depth < spread.count() && spread.least_behind(depth)[1] <= value;
        depth + u32::from(is_next)
    };
    // Values are linear: corners bound the depths.
    let at_corners = [values[0], values[7], values[56], values[63]];
    let first = of(at_corners.into_iter().fold(i64::MAX, i64::min));
    let last = of(at_corners.into_iter().fold(i64::MIN, i64::max));
    if last - first > MOST_COUNTED {
        return values.map(of);
    }
    let mut depths = [first; 64];
    for slice in first..last {
        let least = spread.least_behind(slice)[usize::from(is_deep)];
        for (depth, value) in depths.iter_mut().zip(&values) {
            *depth += u32::from(*value >= least);
        }
    }
    depths
}

/// The mask whose bits are given as bytes, 0 or 1.
#[inline(always)]
fn mask_of(bits: &[u8; 64]) -> u64 {
    let (rows, _) = bits.as_chunks::<8>();
    // Byte i of a row comes to bit 56 + i: no two meet.
    let bits = |row: &[u8; 8]| u64::from_le_bytes(*row).wrapping_mul(0x0102_0408_1020_4080) >> 56;
    rows.iter().rev().fold(0, |mask, row| (mask << 8) | bits(row))
}

/// The edges that cross the leaf, and the texels to the left of each: silhouettes first, then others, from front to back.
#[inline(always)]
fn edges(leaf: Leaf<'_>, entries: &[Entry], forms: &Forms<'_>) -> ArrayVec<(EdgeKey, u64), MOST_EDGES> {
    let mut found: ArrayVec<(EdgeKey, u64, i32), { 3 * MOST_TRIANGLES }> = ArrayVec::new();
    for entry in entries {
        let triangle = &forms.triangles[entry.triangle as usize];
        if triangle.is_edge_on() || entry.has(COVERS) {
            continue;
        }
        for i in 0..3 {
            let (key, is_left) = edge_of(triangle, i);
            let way = if is_left { 1 } else { -1 };
            if let Some((_, _, sum)) = found.iter_mut().find(|(known, _, _)| *known == key) {
                *sum += way;
                continue;
            }
            let left = left_of(forms.edge(key), leaf);
            if left != 0 && left != u64::MAX {
                found.push((key, left, way));
            }
        }
    }
    let of = |is_silhouette: bool| found.iter().filter(move |(_, _, sum)| (*sum != 0) == is_silhouette);
    let mut edges: ArrayVec<(EdgeKey, u64), MOST_EDGES> = ArrayVec::new();
    for (key, left, _) in of(true).chain(of(false)) {
        let is_new = edges.iter().all(|(_, known)| known != left && *known != !left);
        if is_new && !edges.is_full() {
            edges.push((*key, *left));
        }
    }
    edges
}

/// The texels to the left of an edge.
#[inline(always)]
pub(super) fn left_of(edge: Form, leaf: Leaf<'_>) -> u64 {
    let at_corners = corners(leaf.tile).map(|texel| edge.at(texel) >= 0);
    match at_corners {
        [true, true, true, true] => u64::MAX,
        [false, false, false, false] => 0,
        _ => mask_of(&values(&edge, [leaf.tile.x, leaf.tile.y]).map(|value| u8::from(value >= 0))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In doubles as in whole numbers: at random, level and steep, whole and a hair beside it, before the first slice and behind the last.
    #[test]
    fn depths_in_doubles_are_those_of_whole_numbers() {
        let mut state = 0x9e37_79b9_7f4a_7c15u64;
        let mut random = |below: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 20) % below
        };
        let mut in_doubles = 0;
        for round in 0..20_000u32 {
            let slices = 64 << random(15);
            let shift = random(u64::from(FRACTION_BITS) + 1) as u32;
            let mut slope = || (random(1 << 31) as i32).wrapping_sub(1 << 30) >> random(31);
            let [a, b] = if round % 8 == 0 { [0, 0] } else { [slope(), slope()] };
            let first = [random(1 << 17), random(1 << 17)].map(|c| 8 * c as u32);
            // Near some slice at the first texel.
            let at_first = ((random(u64::from(slices) + 40) as i64 - 20) << shift) + random(3) as i64 - 1;
            let form = Form { a, b, c: at_first - Form { a, b, c: 0, shift }.at(first), shift };
            let whole = values(&form, first).map(|value| Spread::Even(slices).depth(value >> shift));
            let Some(depths) = even_depths_at(&form, first, slices) else { continue };
            in_doubles += 1;
            assert_eq!(depths, whole, "{form:?} at {first:?}, {slices} slices");
        }
        assert!(in_doubles > 15_000, "{in_doubles}");
        let far = Form { a: 1, b: 1, c: 1 << EXACT_BITS, shift: 30 };
        assert!(even_depths_at(&far, [0, 0], 1 << 20).is_none());
    }
}
