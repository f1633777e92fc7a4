//! Windows of silhouettes: which texels of a rectangle are lit in one slice. Leaf by leaf, since edges and planes are linear: a corner or two often
//! answer for all of a leaf's part, and else each row of it is lit at one end.

use super::silhouette::{Plane, Value, descend, middle, region};
use crate::format::silhouette::{Form, Kind, Turns, kind, payload};
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

    /// The slice, as the face counts them.
    #[inline(always)]
    pub fn z(&self) -> u32 {
        self.z
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
            Kind::Masks => {
                return Turns::read(self.pool, payload(tile)).depth(texel).is_none_or(|depth| self.z < depth);
            }
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
        if kind(tile) == Kind::Inner {
            if joint == self.stride {
                // One of the level's texels.
                let is_lit = self.is_lit(tile, level, self.middle(first));
                window.add_all(rectangle, is_lit);
            } else {
                self.add_lit_of_children(window, tile, level - 1, rectangle);
            }
        } else if [0, 1].iter().all(|axis| last[*axis] - first[*axis] < <u64 as Rows>::SIDE) {
            window.add(rectangle, self.lit_of_leaf::<u64>(tile, rectangle));
        } else {
            window.add(rectangle, self.lit_of_leaf::<WideRows>(tile, rectangle));
        }
    }

    fn add_lit_of_children(&self, window: &mut Window, tile: u32, below: u32, [first, last]: [[u32; 2]; 2]) {
        let bits = below - self.stride;
        let children = payload(tile);
        // Where the second half begins, if the rectangle is in both.
        let [x, y] = [0, 1].map(|axis| {
            let middle = last[axis] >> bits << bits;
            (first[axis] < middle).then_some(middle)
        });
        let half = |axis: usize| (first[axis] >> bits & 1) as usize;
        let mut add = |column: usize, row: usize, [x0, x1]: [u32; 2], [y0, y1]: [u32; 2]| {
            self.add_lit(window, self.pool[children + column + 2 * row], below, [[x0, y0], [x1, y1]]);
        };
        let mut add_row = |row: usize, ys: [u32; 2]| match x {
            None => add(half(0), row, [first[0], last[0]], ys),
            Some(middle) => {
                add(0, row, [first[0], middle - 1], ys);
                add(1, row, [middle, last[0]], ys);
            }
        };
        match y {
            None => add_row(half(1), [first[1], last[1]]),
            Some(middle) => {
                add_row(0, [first[1], middle - 1]);
                add_row(1, [middle, last[1]]);
            }
        }
    }

    #[inline]
    fn lit_of_leaf<R: Rows>(&self, leaf: u32, rectangle: [[u32; 2]; 2]) -> Lit<R> {
        let at = payload(leaf);
        let left = |i: usize| self.not_negative(Form::read(self.pool, self.pool[at + i] as usize), rectangle);
        let value = |i: usize| self.lit_of_value(self.pool[at + i], rectangle);
        match kind(leaf) {
            Kind::Cut => left(0).choose(|| value(1), || value(2)),
            Kind::Cross => {
                let (a, b) = (left(0), left(1));
                b.choose(|| a.choose(|| value(2), || value(3)), || a.choose(|| value(4), || value(5)))
            }
            Kind::Masks => Lit::Rows(R::of_mask(self.mask_from(Turns::read(self.pool, at).lit(self.z), rectangle))),
            _ => self.lit_of_value(leaf, rectangle),
        }
    }

    /// The mask of a rectangle's texels in a tile whose mask is given: byte y is its row y, of rows and columns past its sides anything.
    #[inline]
    fn mask_from(&self, mask: u64, [first, last]: [[u32; 2]; 2]) -> u64 {
        if self.stride == 0 {
            return mask >> (8 * (first[1] & 7) + (first[0] & 7));
        }
        let mut found = 0;
        for y in first[1]..=last[1] {
            for x in first[0]..=last[0] {
                let [column, line] = self.middle([x, y]).map(|c| c & 7);
                found |= (mask >> (8 * line + column) & 1) << (8 * (y - first[1]) + x - first[0]);
            }
        }
        found
    }

    /// Where a depth lies behind this slice.
    #[inline]
    fn lit_of_value<R: Rows>(&self, value: u32, rectangle: [[u32; 2]; 2]) -> Lit<R> {
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
    fn not_negative<R: Rows>(&self, form: Form, [first, last]: [[u32; 2]; 2]) -> Lit<R> {
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
        Lit::Rows(R::of_values([corner, a, b], steps.map(|step| step + 1)))
    }
}

/// Which texels of a rectangle are lit, row by row, first column in bit 0; of rows and columns past its sides nothing is said.
trait Rows: Copy {
    /// Most texels per side.
    const SIDE: u32;

    /// All of them, or none.
    fn same(is_lit: bool) -> Self;

    /// Those at which corner + a x + b y is not negative.
    fn of_values(values: [i64; 3], sides: [u32; 2]) -> Self;

    /// Those of a mask of up to 8 x 8, of which byte y is row y.
    fn of_mask(mask: u64) -> Self;

    /// Where this is set another's, else a second one's.
    fn select(self, own: Self, others: Self) -> Self;

    fn row(&self, y: usize) -> u32;

    /// How many there are.
    fn count(&self, sides: [u32; 2]) -> u32;
}

/// Byte y is row y.
impl Rows for u64 {
    const SIDE: u32 = 8;

    #[inline(always)]
    fn same(is_lit: bool) -> Self {
        u64::from(is_lit).wrapping_neg()
    }

    #[inline(always)]
    fn of_values(values: [i64; 3], [width, _]: [u32; 2]) -> Self {
        let quotients = Quotients::new(values, width);
        let counts: [u32; 8] = core::array::from_fn(|y| quotients.count(y));
        let rows = counts.iter().rev().fold(0u64, |rows, count| (rows << 8) | u64::from(!(u32::MAX << count)));
        if values[1] < 0 { rows } else { !rows }
    }

    #[inline(always)]
    fn of_mask(mask: u64) -> Self {
        mask
    }

    #[inline(always)]
    fn select(self, own: Self, others: Self) -> Self {
        (own & self) | (others & !self)
    }

    #[inline(always)]
    fn row(&self, y: usize) -> u32 {
        (self >> (8 * y)) as u32
    }

    #[inline(always)]
    fn count(&self, [width, height]: [u32; 2]) -> u32 {
        let columns = ((1u64 << width) - 1) * 0x0101_0101_0101_0101;
        (self & columns & (u64::MAX >> (64 - 8 * height))).count_ones()
    }
}

type WideRows = [u32; Window::SIDE];

impl Rows for WideRows {
    const SIDE: u32 = Window::SIDE as u32;

    #[inline(always)]
    fn same(is_lit: bool) -> Self {
        [u32::from(is_lit).wrapping_neg(); Window::SIDE]
    }

    #[inline(always)]
    fn of_values(values: [i64; 3], [width, height]: [u32; 2]) -> Self {
        const GROUP: usize = 8;
        let quotients = Quotients::new(values, width);
        let flip = if values[1] < 0 { 0 } else { u32::MAX };
        let mut rows = [0; Window::SIDE];
        for group in (0..height as usize).step_by(GROUP) {
            let counts: [u32; GROUP] = core::array::from_fn(|y| quotients.count(group + y));
            rows.iter_mut().skip(group).zip(counts).for_each(|(row, count)| *row = !(u32::MAX << count) ^ flip);
        }
        rows
    }

    #[inline(always)]
    fn of_mask(mask: u64) -> Self {
        core::array::from_fn(|y| if y < 8 { mask.row(y) } else { 0 })
    }

    #[inline(always)]
    fn select(self, own: Self, others: Self) -> Self {
        core::array::from_fn(|i| (own[i] & self[i]) | (others[i] & !self[i]))
    }

    #[inline(always)]
    fn row(&self, y: usize) -> u32 {
        self[y]
    }

    #[inline(always)]
    fn count(&self, [width, height]: [u32; 2]) -> u32 {
        let run = (1u32 << width) - 1;
        self[..height as usize].iter().map(|row| (row & run).count_ones()).sum()
    }
}

/// Of each row of the values corner + a x + b y: how many are not negative where a is negative, else how many are negative.
#[derive(Clone, Copy)]
struct Quotients {
    corner: f64,
    b: f64,
    factor: f64,
    most: f64,
}

impl Quotients {
    #[inline(always)]
    fn new([corner, a, b]: [i64; 3], width: u32) -> Self {
        // Half a unit off, so that no quotient lies near a whole number. Of a level row all, or none.
        let factor = if a == 0 { -1e30 } else { -1.0 / a as f64 };
        Self { corner: corner as f64 + 0.5, b: b as f64, factor, most: f64::from(width) - 0.75 }
    }

    /// Row y's, 0 to the width.
    #[inline(always)]
    fn count(&self, y: usize) -> u32 {
        /// 1.5 * 2^52: doubles near it are whole numbers, in their low bits.
        const ROUNDER: f64 = (3u64 << 51) as f64;
        let quotient = (self.corner + self.b * y as f64) * self.factor;
        ((quotient.clamp(-0.75, self.most) + 0.5) + ROUNDER).to_bits() as u32 & 0x1f
    }
}

/// Which texels of a rectangle are lit.
#[derive(Clone, Copy)]
enum Lit<R> {
    None,
    All,
    Rows(R),
}

impl<R: Rows> Lit<R> {
    /// Of two others, the second where this one is, else the first; they are made only where they are needed.
    #[inline(always)]
    fn choose(self, others: impl FnOnce() -> Self, own: impl FnOnce() -> Self) -> Self {
        let Self::Rows(mask) = self else {
            return if matches!(self, Self::All) { own() } else { others() };
        };
        let rows = |lit: Self| match lit {
            Self::None => R::same(false),
            Self::All => R::same(true),
            Self::Rows(rows) => rows,
        };
        Self::Rows(mask.select(rows(own()), rows(others())))
    }
}

/// A window of texels, of which some are lit.
pub(crate) struct Window {
    /// Its first texel.
    first: [u32; 2],
    /// Whether they are only counted.
    is_counted: bool,
    /// How many, if they are.
    pub count: u32,
    /// If they are not, row by row, first column in bit 0.
    pub rows: [u32; Self::SIDE],
}

impl Window {
    /// Most texels per side.
    pub const SIDE: usize = 17;

    pub fn new(first: [u32; 2], is_counted: bool) -> Self {
        Self { first, is_counted, count: 0, rows: [0; Self::SIDE] }
    }

    /// Adds all of a rectangle's texels, or none.
    #[inline]
    pub fn add_all(&mut self, rectangle: [[u32; 2]; 2], is_lit: bool) {
        self.add::<u64>(rectangle, if is_lit { Lit::All } else { Lit::None });
    }

    #[inline]
    fn add<R: Rows>(&mut self, [first, last]: [[u32; 2]; 2], lit: Lit<R>) {
        let sides = [0, 1].map(|axis| last[axis] + 1 - first[axis]);
        if self.is_counted {
            self.count += match lit {
                Lit::None => 0,
                Lit::All => sides[0] * sides[1],
                Lit::Rows(lit) => lit.count(sides),
            };
            return;
        }
        let run = (1 << sides[0]) - 1;
        let [column, row] = [0, 1].map(|axis| first[axis] - self.first[axis]);
        let rows = self.rows.iter_mut().skip(row as usize).take(sides[1] as usize);
        match lit {
            Lit::None => {}
            Lit::All => rows.for_each(|row| *row |= run << column),
            Lit::Rows(lit) => rows.enumerate().for_each(|(y, row)| *row |= (lit.row(y) & run) << column),
        }
    }
}
