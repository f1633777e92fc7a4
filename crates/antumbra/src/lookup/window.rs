//! Windows of silhouettes: which texels of a rectangle are lit in one slice. Leaf by leaf, since edges and planes are linear: a corner or two often
//! answer for all of a leaf's part, and else each row of it is lit at one end.

use super::silhouette::{Plane, Value, descend, middle, region, turn};
use crate::format::silhouette::{Form, Kind, kind, payload};
use crate::format::slices::Spread;

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
            Kind::Cut | Kind::Cross => region(self.pool, tile, |edge| edge.at(texel) >= 0),
            Kind::Masks => return turn(self.pool, tile, self.z) >> (8 * (texel[1] & 7) + (texel[0] & 7)) & 1 != 0,
            _ => tile,
        };
        Value::read(self.pool, value, self.spread).is_lit(self.z, |plane| self.behind(*plane).at(texel) >= 0)
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
