//! Leaves: 8 x 8 texels, from their rays' intervals to the fewest edges that part them into regions of one depth each.

use antumbra::format::silhouette::Form;
use antumbra::format::slices::Spread;

use super::accept::{Forms, corners};
use super::form::{EdgeKey, Plane, Side, Surface};
use super::sketch::{Cut, Set, Sketch, Turn};
use pulp::{Simd, WithSimd};

use crate::columns::{Entry, Lanes, Leaf, LeafScratch, Transition};
use crate::light_space::Slices;

/// Edges and planes that are tried.
const MOST_EDGES: usize = 10;
const MOST_PLANES: usize = 16;
/// Fronts and backs that wedges are tried of.
const MOST_SIDES: usize = 4;
/// Planes of which pairs are tried.
const MOST_SINGLE: usize = 6;
/// Depths over more slices than this are looked up one by one.
const MOST_COUNTED: u32 = 16;
/// Triangles that are looked at.
const MOST_TRIANGLES: usize = 48;

/// A leaf in the making.
struct Parts<'a> {
    enter: &'a Lanes,
    exit: &'a Lanes,
    /// Each surface, and the texels at which it is right.
    surfaces: Vec<(Surface, u64)>,
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
        let parts = Parts { enter, exit, surfaces: surfaces(enter, exit, leaf, entries, forms) };
        if let Some(set) = parts.set(u64::MAX) {
            return Some(Sketch::Flat(set));
        }
        parts.cut(&edges(leaf, entries, forms))
    }
}

impl Parts<'_> {
    /// The depths that suit all texels of a mask.
    #[inline(always)]
    fn set(&self, mask: u64) -> Option<Set> {
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
        let mut set = Set::constants(low, high);
        let fits = self.surfaces.iter().filter(|(_, right)| right & mask == mask);
        fits.for_each(|(surface, _)| set.push(*surface));
        (!set.is_empty()).then_some(set)
    }

    /// One edge that parts the leaf, or two.
    #[inline(always)]
    fn cut(&self, edges: &[(EdgeKey, u64)]) -> Option<Sketch> {
        let cut = |edges: Vec<EdgeKey>, regions| Some(Sketch::Cut(Box::new(Cut { edges, regions })));
        for (edge, left) in edges {
            if let (Some(right), Some(left)) = (self.set(!left), self.set(*left)) {
                return cut(vec![*edge], [Some(right), Some(left), None, None]);
            }
        }
        for (i, (a, left_a)) in edges.iter().enumerate() {
            for (b, left_b) in &edges[i + 1..] {
                let (first, second, left) = if a < b { (left_a, left_b, [*a, *b]) } else { (left_b, left_a, [*b, *a]) };
                let masks = [!first & !second, first & !second, !first & second, first & second];
                let mut regions = [None; 4];
                let fits = masks.iter().zip(&mut regions).all(|(mask, region)| {
                    *region = if *mask == 0 { None } else { self.set(*mask) };
                    *mask == 0 || region.is_some()
                });
                if fits {
                    return cut(left.to_vec(), regions);
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
    found: Vec<(Surface, u64)>,
    /// Triangles where rays enter a solid: depths just behind them, and deep ones.
    fronts: Vec<(u32, [Lanes; 2])>,
    /// Triangles where rays leave: depths just before them.
    backs: Vec<(u32, Lanes)>,
    /// Planes of which two may be right together: where they are right alone, and their depths.
    single: Vec<(Plane, u64, Lanes)>,
}

/// Surfaces of the leaf's triangles that are right somewhere, and where.
#[inline(always)]
fn surfaces(enter: &Lanes, exit: &Lanes, leaf: Leaf<'_>, entries: &[Entry], forms: &Forms<'_>) -> Vec<(Surface, u64)> {
    let (found, fronts, backs, single) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut surfaces = Surfaces { enter, exit, found, fronts, backs, single };
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
            surfaces.backs.push((entry.triangle, own));
        } else if !is_exact {
            let deep = depths_at(&forms.deep(form), leaf, forms.slices, true);
            surfaces.push_plane(plane.deep(), deep);
            surfaces.fronts.extend((winding == 1).then_some((entry.triangle, [own, deep])));
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
            self.single.push((plane, right, depths));
        }
    }

    #[inline(always)]
    fn push_wedges(&mut self) {
        let (fronts, backs) = (std::mem::take(&mut self.fronts), std::mem::take(&mut self.backs));
        for (front, [own, deep]) in fronts.iter().take(MOST_SIDES) {
            for (back, before) in backs.iter().take(MOST_SIDES) {
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
        for (i, (a, right_a, depths_a)) in single.iter().enumerate().take(MOST_SINGLE) {
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

/// A form's values at a leaf's texels.
#[inline(always)]
fn values(form: &Form, leaf: Leaf<'_>) -> [i64; 64] {
    let corner = form.at([leaf.tile.x, leaf.tile.y]);
    let [a, b] = [i64::from(form.a), i64::from(form.b)];
    std::array::from_fn(|i| corner + a * (i & 7) as i64 + b * (i >> 3) as i64)
}

/// A plane's depths at a leaf's texels, or a deep one's.
#[inline(always)]
fn depths_at(form: &Form, leaf: Leaf<'_>, slices: &Slices, is_deep: bool) -> Lanes {
    let spread = slices.spread();
    let values = values(form, leaf).map(|value| value >> form.shift);
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
fn edges(leaf: Leaf<'_>, entries: &[Entry], forms: &Forms<'_>) -> Vec<(EdgeKey, u64)> {
    let mut found: Vec<(EdgeKey, u64, i32)> = Vec::new();
    for entry in entries {
        let triangle = &forms.triangles[entry.triangle as usize];
        if triangle.is_edge_on() {
            continue;
        }
        for i in 0..3 {
            let [from, to] = triangle.edge_ends(i);
            let (key, way) = if from < to { ([from, to], 1) } else { ([to, from], -1) };
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
    let (mut silhouettes, others): (Vec<_>, Vec<_>) = found.into_iter().partition(|(_, _, sum)| *sum != 0);
    silhouettes.extend(others);
    let mut edges: Vec<(EdgeKey, u64)> = Vec::new();
    for (key, left, _) in silhouettes {
        let is_new = edges.iter().all(|(_, known)| *known != left && *known != !left);
        if is_new && edges.len() < MOST_EDGES {
            edges.push((key, left));
        }
    }
    edges
}

/// The texels to the left of an edge.
#[inline(always)]
fn left_of(edge: Form, leaf: Leaf<'_>) -> u64 {
    let at_corners = corners(leaf.tile).map(|texel| edge.at(texel) >= 0);
    match at_corners {
        [true, true, true, true] => u64::MAX,
        [false, false, false, false] => 0,
        _ => mask_of(&values(&edge, leaf).map(|value| u8::from(value >= 0))),
    }
}
