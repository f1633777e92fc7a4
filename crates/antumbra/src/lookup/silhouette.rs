//! Lookups in the encoding [`silhouette`](crate::format::silhouette): a descent through a quadtree, then signs of edges and depths
//! of planes, in whole numbers.

use crate::format::silhouette::{Form, Kind, Pair, kind, payload, plane_of_pair};
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

/// Which of the references of a cut or a cross a texel has.
#[inline(always)]
fn region(pool: &[u32], tile: u32, texel: [u32; 2]) -> u32 {
    let at = payload(tile);
    let left = |i: usize| usize::from(Form::read(pool, pool[at + i] as usize).at(texel) >= 0);
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
        Kind::Cut | Kind::Cross => region(pool, tile, texel),
        Kind::Masks => return depth_by_masks(pool, tile, texel, spread.count()),
        _ => tile,
    };
    let of = |plane: Plane| plane.depth(plane.form.at(texel), spread);
    match Value::read(pool, value, spread) {
        Value::Depth(depth) => depth,
        Value::Plane(plane) => of(plane),
        Value::Pair { least, most, other } => of(most).min(other.map_or(u32::MAX, of)).max(least.map_or(0, of)),
    }
}

/// How many edges cut a leaf.
pub(crate) fn edges(leaf: u32) -> usize {
    match kind(leaf) {
        Kind::Cut => 1,
        Kind::Cross => 2,
        _ => 0,
    }
}

/// The texels of a tile of masks that are lit in a slice.
#[inline]
pub(crate) fn turn(pool: &[u32], tile: u32, slice: u32) -> u64 {
    turns(pool, tile).take_while(|(depth, _)| *depth <= slice).last().map_or(u64::MAX, |(_, lit)| lit)
}

fn turns(pool: &[u32], tile: u32) -> impl Iterator<Item = (u32, u64)> + '_ {
    let at = payload(tile);
    let words = &pool[at + 1..at + 1 + 3 * pool[at] as usize];
    words.chunks_exact(3).map(|turn| (turn[0], u64::from(turn[1]) | (u64::from(turn[2]) << 32)))
}

fn depth_by_masks(pool: &[u32], tile: u32, [x, y]: [u32; 2], slices: u32) -> u32 {
    let bit = 8 * (y & 7) + (x & 7);
    turns(pool, tile).find(|(_, lit)| lit >> bit & 1 == 0).map_or(slices, |(depth, _)| depth)
}

/// One slice of a face, at all of its texels or at every 2^`stride`-th along both axes: the middles of a coarse level's.
#[derive(Clone, Copy)]
pub(crate) struct Slice<'a> {
    pool: &'a [u32],
    /// The slice, as the face counts them.
    z: u32,
    stride: u32,
    spread: Spread<'a>,
    /// The least whole values with which planes, and deep ones, lie behind it.
    least_behind: [i64; 2],
}

impl<'a> Slice<'a> {
    /// Slice `z` of a level whose voxels are 2^`stride` of the face's wide.
    #[inline(always)]
    pub fn new(pool: &'a [u32], z: u32, stride: u32, spread: Spread<'a>) -> Self {
        let z = middle(z, stride);
        Self { pool, z, stride, spread, least_behind: spread.least_behind(z) }
    }

    /// The face's texel in the middle of a level's.
    #[inline(always)]
    pub fn middle(&self, texel: [u32; 2]) -> [u32; 2] {
        texel.map(|c| middle(c, self.stride))
    }

    /// Whether the slice is lit at one of the face's texels, below a tile of 2^`level` of them per side.
    #[inline(always)]
    pub fn is_lit(&self, tile: u32, level: u32, texel: [u32; 2]) -> bool {
        let (tile, _) = descend(self.pool, tile, level, 0, texel);
        let value = match kind(tile) {
            Kind::Cut | Kind::Cross => region(self.pool, tile, texel),
            Kind::Masks => return turn(self.pool, tile, self.z) >> (8 * (texel[1] & 7) + (texel[0] & 7)) & 1 != 0,
            _ => tile,
        };
        let is_before = |plane: Plane| self.behind(plane).at(texel) >= 0;
        match Value::read(self.pool, value, self.spread) {
            Value::Depth(depth) => self.z < depth,
            Value::Plane(plane) => is_before(plane),
            Value::Pair { least, most, other } => {
                least.is_some_and(is_before) || (other.is_none_or(is_before) && is_before(most))
            }
        }
    }

    /// Adds the lit ones of a window's texels below a tile of 2^`level` of the face's texels per side: those of a rectangle of the level's
    /// texels, both ends in it.
    #[inline]
    pub fn add_lit(&self, window: &mut Window, tile: u32, level: u32, rectangle: [[u32; 2]; 2]) {
        let [first, last] = rectangle;
        // The least level whose one tile holds the whole rectangle.
        let joint = u32::BITS - ((first[0] ^ last[0]) | (first[1] ^ last[1])).leading_zeros() + self.stride;
        let (tile, level) = descend(self.pool, tile, level, joint, self.middle(first));
        if kind(tile) != Kind::Inner {
            window.add(rectangle, self.lit_of_leaf(tile, rectangle));
        } else if joint == self.stride {
            // One of the level's texels.
            let is_lit = self.is_lit(tile, level, self.middle(first));
            window.add(rectangle, if is_lit { Lit::All } else { Lit::None });
        } else {
            self.add_lit_of_children(window, tile, level - 1, rectangle);
        }
    }

    fn add_lit_of_children(&self, window: &mut Window, tile: u32, below: u32, [first, last]: [[u32; 2]; 2]) {
        let bits = below - self.stride;
        // Halves that the rectangle touches, and where the second begins.
        let halves = [0, 1].map(|axis| (first[axis] >> bits & 1)..=(last[axis] >> bits & 1));
        let middles = last.map(|c| c >> bits << bits);
        for y in halves[1].clone() {
            for x in halves[0].clone() {
                let of = |axis: usize, half: u32| {
                    let is_split = halves[axis].start() != halves[axis].end();
                    match (is_split, half) {
                        (false, _) => [first[axis], last[axis]],
                        (true, 0) => [first[axis], middles[axis] - 1],
                        (true, _) => [middles[axis], last[axis]],
                    }
                };
                let ([x0, x1], [y0, y1]) = (of(0, x), of(1, y));
                let child = self.pool[payload(tile) + (x + 2 * y) as usize];
                self.add_lit(window, child, below, [[x0, y0], [x1, y1]]);
            }
        }
    }

    #[inline]
    fn lit_of_leaf(&self, leaf: u32, rectangle: [[u32; 2]; 2]) -> Lit {
        let at = payload(leaf);
        let left = |i: usize| self.not_negative(Form::read(self.pool, self.pool[at + i] as usize), rectangle);
        let value = |i: usize| self.lit_of_value(self.pool[at + i], rectangle);
        match kind(leaf) {
            Kind::Cut => left(0).choose(|| value(1), || value(2)),
            Kind::Cross => {
                let (a, b) = (left(0), left(1));
                b.choose(|| a.choose(|| value(2), || value(3)), || a.choose(|| value(4), || value(5)))
            }
            Kind::Masks => self.lit_of_mask(turn(self.pool, leaf, self.z), rectangle),
            _ => self.lit_of_value(leaf, rectangle),
        }
    }

    /// A rectangle's texels in a tile whose mask is given.
    #[inline]
    fn lit_of_mask(&self, mask: u64, [first, last]: [[u32; 2]; 2]) -> Lit {
        let mut rows = [0; Window::SIDE];
        for (y, row) in (first[1]..=last[1]).zip(&mut rows) {
            for x in first[0]..=last[0] {
                let [column, line] = self.middle([x, y]).map(|c| c & 7);
                *row |= ((mask >> (8 * line + column) & 1) as u32) << (x - first[0]);
            }
        }
        Lit::Rows(rows)
    }

    /// Where a depth lies behind this slice.
    #[inline]
    fn lit_of_value(&self, value: u32, rectangle: [[u32; 2]; 2]) -> Lit {
        let behind = |plane: Plane| self.not_negative(self.behind(plane), rectangle);
        match Value::read(self.pool, value, self.spread) {
            Value::Depth(depth) if self.z < depth => Lit::All,
            Value::Depth(_) => Lit::None,
            Value::Plane(plane) => behind(plane),
            Value::Pair { least, most, other } => {
                let nearer = || other.map_or(Lit::All, behind).choose(|| Lit::None, || behind(most));
                least.map_or(Lit::None, behind).choose(nearer, || Lit::All)
            }
        }
    }

    /// The edge between the texels at which a plane lies behind this slice, to its left, and others: there it is not before the next.
    #[inline(always)]
    fn behind(&self, Plane { form, is_deep }: Plane) -> Form {
        Form { c: form.c - (self.least_behind[usize::from(is_deep)] << form.shift), ..form }
    }

    /// The texels of a rectangle at which a form is not negative.
    #[inline]
    fn not_negative(&self, form: Form, [first, last]: [[u32; 2]; 2]) -> Lit {
        let corner = form.at(self.middle(first));
        let [a, b] = [form.a, form.b].map(|rise| i64::from(rise) << self.stride);
        let steps = [0, 1].map(|axis| last[axis] - first[axis]);
        let rises = [a * i64::from(steps[0]), b * i64::from(steps[1])];
        let least = corner + rises[0].min(0) + rises[1].min(0);
        let greatest = corner + rises[0].max(0) + rises[1].max(0);
        if least >= 0 {
            return Lit::All;
        }
        if greatest < 0 {
            return Lit::None;
        }
        // Along a row those that are not negative lie together at one end: at the first one's if values fall.
        let [width, height] = steps.map(|step| step + 1);
        let counts = row_counts([corner, a, b], width, height);
        let all = (1u32 << width) - 1;
        Lit::Rows(counts.map(|count| if a < 0 { !(u32::MAX << count) } else { all << count & all }))
    }
}

/// Of each row of the values corner + a x + b y: how many are not negative where a is negative, else how many are negative. Of rows past the
/// height anything.
#[inline]
fn row_counts([corner, a, b]: [i64; 3], width: u32, height: u32) -> [u32; Window::SIDE] {
    /// 1.5 * 2^52: doubles near it are whole numbers, in their low bits.
    const ROUNDER: f64 = (3u64 << 51) as f64;
    const GROUP: usize = 8;
    // Half a unit off, so that no quotient lies near a whole number. Of a level row all, or none.
    let factor = if a == 0 { -1e30 } else { -1.0 / a as f64 };
    let (corner, b, most) = (corner as f64 + 0.5, b as f64, f64::from(width) - 0.75);
    let mut counts = [0; Window::SIDE];
    for group in (0..height as usize).step_by(GROUP) {
        let quotient = |y: usize| (corner + b * (group + y) as f64) * factor;
        let count = |y: usize| ((quotient(y).clamp(-0.75, most) + 0.5) + ROUNDER).to_bits() as u32 & 0x1f;
        let found: [u32; GROUP] = core::array::from_fn(count);
        counts.iter_mut().skip(group).zip(found).for_each(|(count, found)| *count = found);
    }
    counts
}

/// Which texels of a rectangle are lit.
#[derive(Clone, Copy)]
enum Lit {
    None,
    All,
    /// Row by row, first column in bit 0; of rows and columns past its sides nothing is said.
    Rows([u32; Window::SIDE]),
}

impl Lit {
    /// Of two others, the second where this one is, else the first; they are made only where they are needed.
    #[inline(always)]
    fn choose(self, others: impl FnOnce() -> Self, own: impl FnOnce() -> Self) -> Self {
        let Self::Rows(mask) = self else {
            return if matches!(self, Self::All) { own() } else { others() };
        };
        let rows = |lit: Self| match lit {
            Self::None => [0; Window::SIDE],
            Self::All => [u32::MAX; Window::SIDE],
            Self::Rows(rows) => rows,
        };
        let (own, others) = (rows(own()), rows(others()));
        Self::Rows(core::array::from_fn(|i| (own[i] & mask[i]) | (others[i] & !mask[i])))
    }
}

/// A window of texels, of which some are lit.
pub(crate) struct Window {
    /// Its first texel.
    first: [u32; 2],
    /// Row by row, first column in bit 0.
    pub rows: [u32; Self::SIDE],
}

impl Window {
    /// Most texels per side.
    pub const SIDE: usize = 17;

    pub fn new(first: [u32; 2]) -> Self {
        Self { first, rows: [0; Self::SIDE] }
    }

    #[inline]
    fn add(&mut self, [first, last]: [[u32; 2]; 2], lit: Lit) {
        let run = (2 << (last[0] - first[0])) - 1;
        let [column, row] = [0, 1].map(|axis| first[axis] - self.first[axis]);
        let rows = &mut self.rows[row as usize..=(last[1] - self.first[1]) as usize];
        match lit {
            Lit::None => {}
            Lit::All => rows.iter_mut().for_each(|row| *row |= run << column),
            Lit::Rows(lit) => rows.iter_mut().zip(&lit).for_each(|(row, lit)| *row |= (lit & run) << column),
        }
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
    let joint = |p: [u32; 2], q: [u32; 2]| [p[0].min(q[0]), p[1].max(q[1])];
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
