//! Lookups in the encoding [`silhouette`](crate::format::silhouette): a descent through a quadtree, then signs of edges and depths
//! of planes, in whole numbers.

use crate::format::silhouette::{Form, Kind, Pair, Turns, kind, payload, plane_of_pair};
use crate::format::slices::Spread;

/// Descends from a tile of 2^`from` texels per side towards a texel, until a tile is no inner node or has 2^`to` texels per side.
/// Coordinates may be the whole light's: only their low bits count. Returns the tile and its level.
#[inline(always)]
pub(crate) fn descend(pool: &[u32], mut tile: u32, from: u32, to: u32, [x, y]: [u32; 2]) -> (u32, u32) {
    let mut level = from;
    while kind(tile) == Kind::Inner && level > to {
        level -= 1;
        let quadrant = ((x >> level) & 1) | (((y >> level) & 1) << 1);
        tile = pool[payload(tile) + quadrant as usize];
    }
    (tile, level)
}

/// Which of the references of a cut or a cross a place has, that lies to the left of some edges.
#[inline(always)]
pub(crate) fn region(pool: &[u32], tile: u32, is_left: impl Fn(Form) -> bool) -> u32 {
    let at = payload(tile);
    let left = |i: usize| usize::from(is_left(Form::read(pool, pool[at + i] as usize)));
    if kind(tile) == Kind::Cut { pool[at + 1 + left(0)] } else { pool[at + 2 + left(0) + 2 * left(1)] }
}

/// A plane of a value, or its deep one.
#[derive(Clone, Copy)]
pub(crate) struct Plane {
    pub form: Form,
    pub is_deep: bool,
}

/// What a reference to a depth stands for.
pub(crate) enum Value {
    Depth(u32),
    Plane(Plane),
    /// Two planes: max(least, min(most, other)).
    Pair {
        least: Option<Plane>,
        most: Plane,
        other: Option<Plane>,
    },
}

impl Value {
    #[inline(always)]
    pub fn read(pool: &[u32], value: u32, spread: Spread<'_>) -> Self {
        let at = payload(value);
        let plain = |number: usize| Plane { form: Form::read(pool, number), is_deep: false };
        let deep = |plane: Plane| Plane { form: spread.deep(plane.form), is_deep: true };
        match kind(value) {
            Kind::Depth => Self::Depth(at as u32),
            Kind::Plane => Self::Plane(plain(at)),
            Kind::Deep => Self::Plane(deep(plain(at))),
            _ => {
                let words = [pool[at], pool[at + 1]];
                let [first, second] = words.map(plane_of_pair).map(|(number, is_deep)| {
                    let plane = plain(number);
                    if is_deep { deep(plane) } else { plane }
                });
                match Pair::of(words[0]) {
                    Pair::Wedge => Self::Pair { least: Some(first), most: deep(first), other: Some(second) },
                    Pair::Nearer => Self::Pair { least: None, most: first, other: Some(second) },
                    Pair::Farther => Self::Pair { least: Some(first), most: second, other: None },
                }
            }
        }
    }
}

impl Value {
    /// Whether a place in a slice is lit, which lies before some planes.
    #[inline(always)]
    pub fn is_lit(&self, slice: u32, is_before: impl Fn(&Plane) -> bool) -> bool {
        match self {
            Self::Depth(depth) => slice < *depth,
            Self::Plane(plane) => is_before(plane),
            Self::Pair { least, most, other } => {
                least.as_ref().is_some_and(&is_before) || (other.as_ref().is_none_or(&is_before) && is_before(most))
            }
        }
    }
}

impl Plane {
    /// The first shadowed slice where the form has some value.
    #[inline(always)]
    fn depth(&self, value: i64, spread: Spread<'_>) -> u32 {
        let whole = value >> self.form.shift;
        if self.is_deep { spread.depth_of_deep(whole) } else { spread.depth(whole) }
    }
}

/// First shadowed slice of a texel, 0 to N, below a tile of 2^`level` texels per side.
#[inline(always)]
pub(crate) fn depth(pool: &[u32], tile: u32, level: u32, texel: [u32; 2], spread: Spread<'_>) -> u32 {
    let (tile, _) = descend(pool, tile, level, 0, texel);
    let value = match kind(tile) {
        Kind::Cut | Kind::Cross => region(pool, tile, |edge| edge.at(texel) >= 0),
        Kind::Masks => return Turns::read(pool, payload(tile)).depth(texel).unwrap_or(spread.count()),
        _ => tile,
    };
    let of = |plane: Plane| plane.depth(plane.form.at(texel), spread);
    match Value::read(pool, value, spread) {
        Value::Depth(depth) => depth,
        Value::Plane(plane) => of(plane),
        Value::Pair { least, most, other } => of(most).min(other.map_or(u32::MAX, of)).max(least.map_or(0, of)),
    }
}

/// The least and the greatest first shadowed slice over a rectangle of a leaf's texels, both ends in it; of masks the whole range.
pub(crate) fn bounds(pool: &[u32], leaf: u32, rectangle: [[u32; 2]; 2], spread: Spread<'_>) -> [u32; 2] {
    let at = payload(leaf);
    // Which sides of an edge the rectangle touches: right, left.
    let touched = |i: usize| {
        let [least, greatest] = ends(&Form::read(pool, pool[at + i] as usize), rectangle);
        [least < 0, greatest >= 0]
    };
    let part = |i: usize| bounds_of_value(pool, pool[at + i], rectangle, spread);
    match kind(leaf) {
        Kind::Cut => match touched(0) {
            [true, false] => part(1),
            [false, _] => part(2),
            _ => joint(part(1), part(2)),
        },
        Kind::Cross => {
            let sides = [touched(0), touched(1)];
            let parts = (0..4).filter(|i| sides[0][i & 1] && sides[1][i >> 1]);
            parts.map(|i| part(2 + i)).fold([spread.count(), 0], joint)
        }
        Kind::Masks => [0, spread.count()],
        _ => bounds_of_value(pool, leaf, rectangle, spread),
    }
}

/// The same over a square of 2^`level` texels per side at a corner, below a tile that holds it, or is as large.
pub(crate) fn bounds_below(pool: &[u32], tile: u32, level: u32, corner: [u32; 2], spread: Spread<'_>) -> [u32; 2] {
    match kind(tile) {
        Kind::Inner => {
            let side = 1 << (level - 1);
            let child = |i: usize| {
                let corner = [corner[0] + (i as u32 & 1) * side, corner[1] + (i as u32 >> 1) * side];
                bounds_below(pool, pool[payload(tile) + i], level - 1, corner, spread)
            };
            [1, 2, 3].into_iter().map(child).fold(child(0), joint)
        }
        Kind::Masks => {
            let turns = Turns::read(pool, payload(tile));
            let (first, last) = (turns.depth_of(0), turns.depth_of(turns.count() - 1));
            [first, if turns.lit(last) == 0 { last } else { spread.count() }]
        }
        _ => bounds(pool, tile, [corner, corner.map(|c| c + (1 << level) - 1)], spread),
    }
}

fn joint(p: [u32; 2], q: [u32; 2]) -> [u32; 2] {
    [p[0].min(q[0]), p[1].max(q[1])]
}

fn bounds_of_value(pool: &[u32], value: u32, rectangle: [[u32; 2]; 2], spread: Spread<'_>) -> [u32; 2] {
    let of = |plane: Plane| ends(&plane.form, rectangle).map(|value| plane.depth(value, spread));
    match Value::read(pool, value, spread) {
        Value::Depth(depth) => [depth; 2],
        Value::Plane(plane) => of(plane),
        Value::Pair { least, most, other } => {
            let (least, most, other) = (least.map_or([0; 2], of), of(most), other.map_or([u32::MAX; 2], of));
            [0, 1].map(|end| least[end].max(most[end].min(other[end])))
        }
    }
}

/// The least and the greatest value of a form over a rectangle of texels, both ends in it.
#[inline(always)]
fn ends(form: &Form, [first, last]: [[u32; 2]; 2]) -> [i64; 2] {
    let falls = [form.a < 0, form.b < 0];
    let corner = |at_last: [bool; 2]| [0, 1].map(|axis| if at_last[axis] { last[axis] } else { first[axis] });
    [form.at(corner(falls)), form.at(corner(falls.map(|falls| !falls)))]
}

/// The face's texel, or slice, in the middle of a coarse level's.
#[inline(always)]
pub(crate) fn middle(c: u32, stride: u32) -> u32 {
    (c << stride) + ((1 << stride) >> 1)
}

/// A column about a voxel that no depth ends, below a tile of 2^`level` texels per side that is no inner node: as wide as the quadtree
/// allows. Its level, and the least and the greatest depth in it, which are both before the voxel or both behind it.
pub(crate) fn column(
    pool: &[u32],
    leaf: u32,
    mut level: u32,
    [x, y, z]: [u32; 3],
    spread: Spread<'_>,
) -> (u32, [u32; 2]) {
    while level > 0 {
        let first = [x, y].map(|c| c >> level << level);
        let last = first.map(|c| c + (1 << level) - 1);
        let found = bounds(pool, leaf, [first, last], spread);
        if z < found[0] || z >= found[1] {
            return (level, found);
        }
        level -= 1;
    }
    (0, [depth(pool, leaf, 0, [x, y], spread); 2])
}

/// log2 of the columns per side by which a cube's mean is measured.
const COLUMNS_LOG2: u32 = 3;

/// Mean visibility of the cube of 2^`level` voxels per side that holds a voxel, below a tile of 2^`from` texels per side: over the lit
/// length of each of its columns up to 8 x 8, and of wider ones over that of the 64 in the middles of its parts.
pub(crate) fn mean(pool: &[u32], (tile, from): (u32, u32), level: u32, [x, y, z]: [u32; 3], spread: Spread<'_>) -> f32 {
    let (tile, at) = descend(pool, tile, from, level, [x, y]);
    let first = z >> level << level;
    let lit_of = |depth: u32| depth.saturating_sub(first).min(1 << level);
    if kind(tile) == Kind::Depth {
        return lit_of(payload(tile) as u32) as f32 * power_of_two(-(level as i32));
    }
    let log2 = level.min(COLUMNS_LOG2);
    let stride = level - log2;
    let corner = [x, y].map(|c| c >> level << log2);
    let columns = (0..1 << (2 * log2)).map(|i| [corner[0] + (i & ((1 << log2) - 1)), corner[1] + (i >> log2)]);
    let depths = columns.map(|texel| depth(pool, tile, at, texel.map(|c| middle(c, stride)), spread));
    let lit: u32 = depths.map(lit_of).sum();
    // No more bits than single precision holds.
    let bits = 2 * log2 + level;
    let dropped = bits.saturating_sub(24);
    (lit >> dropped) as f32 * power_of_two((dropped as i32) - (bits as i32))
}

#[inline]
fn power_of_two(exponent: i32) -> f32 {
    f32::from_bits(((127 + exponent) as u32) << 23)
}
