//! Lookups in the encoding [`silhouette`](crate::format::silhouette): a descent through a quadtree, then signs of edges and depths
//! of planes, in whole numbers.

use crate::format::silhouette::{Form, Kind, kind, payload};

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

/// The two planes of a wedge.
#[inline(always)]
fn planes(pool: &[u32], wedge: u32) -> [Form; 2] {
    [0, 1].map(|i| Form::read(pool, pool[payload(wedge) + i] as usize))
}

/// First shadowed slice of a texel, 0 to `slices`, below a tile of 2^`level` texels per side.
#[inline(always)]
pub(crate) fn depth(pool: &[u32], tile: u32, level: u32, texel: [u32; 2], slices: u32) -> u32 {
    let (tile, _) = descend(pool, tile, level, 0, texel);
    let value = match kind(tile) {
        Kind::Cut | Kind::Cross => region(pool, tile, texel),
        Kind::Masks => return depth_by_masks(pool, tile, texel, slices),
        _ => tile,
    };
    let at = payload(value);
    match kind(value) {
        Kind::Depth => at as u32,
        Kind::Plane => Form::read(pool, at).depth(texel, slices),
        Kind::Deep => Form::read(pool, at).deep().depth(texel, slices),
        _ => {
            let [front, back] = planes(pool, value);
            wedge(&front, &back, texel, slices)
        }
    }
}

/// The depth between a front plane and a back plane.
#[inline(always)]
#[must_use]
pub fn wedge(front: &Form, back: &Form, texel: [u32; 2], slices: u32) -> u32 {
    let deep = front.deep().depth(texel, slices).min(back.depth(texel, slices));
    deep.max(front.depth(texel, slices))
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

/// The texels of a mask in the quadrants to the left of none of two edges, of the first, of the second, of both.
fn quadrants(a: u64, b: u64) -> [u64; 4] {
    [!a & !b, a & !b, !a & b, a & b]
}

/// One slice of a face, at all of its texels or at every 2^`stride`-th along both axes: the middles of a coarse level's.
#[derive(Clone, Copy)]
pub(crate) struct Slice<'a> {
    pool: &'a [u32],
    /// The slice, as the face counts them.
    z: u32,
    stride: u32,
}

impl<'a> Slice<'a> {
    /// Slice `z` of a level whose voxels are 2^`stride` of the face's wide.
    #[inline(always)]
    pub fn new(pool: &'a [u32], z: u32, stride: u32) -> Self {
        Self { pool, z: middle(z, stride), stride }
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
            Kind::Masks => return self.turn(tile) >> (8 * (texel[1] & 7) + (texel[0] & 7)) & 1 != 0,
            _ => tile,
        };
        let is_before = |form: Form| self.behind(form).at(texel) >= 0;
        let at = payload(value);
        match kind(value) {
            Kind::Depth => self.z < at as u32,
            Kind::Plane => is_before(Form::read(self.pool, at)),
            Kind::Deep => is_before(Form::read(self.pool, at).deep()),
            _ => {
                let [front, back] = planes(self.pool, value);
                is_before(front) || (is_before(back) && is_before(front.deep()))
            }
        }
    }

    /// Whether a leaf is all lit or all shadowed over a rectangle of the face's texels, both ends in it. `None`: neither, or not
    /// known without a closer look.
    #[inline]
    pub fn over(&self, leaf: u32, rectangle: [[u32; 2]; 2], slices: u32) -> Option<bool> {
        let [least, greatest] = bounds(self.pool, leaf, rectangle, slices);
        if self.z < least {
            Some(true)
        } else if self.z >= greatest {
            Some(false)
        } else {
            None
        }
    }

    /// 8 x 8 of the level's texels, from a corner that is a multiple of 8, below a tile of 2^`level` of the face's texels per side:
    /// bit 8*y + x is 1 where lit. Of bits that are not wanted nothing is said.
    #[inline]
    pub fn mask(&self, tile: u32, level: u32, corner: [u32; 2], wanted: u64) -> u64 {
        let (tile, level) = descend(self.pool, tile, level, 3 + self.stride, self.middle(corner));
        let at = payload(tile);
        let left = |i: usize| self.not_negative(Form::read(self.pool, self.pool[at + i] as usize), corner);
        let value = |i: usize| self.value_mask(self.pool[at + i], corner);
        match kind(tile) {
            Kind::Inner => self.gathered(tile, level, corner, wanted),
            Kind::Cut => {
                let left = left(0);
                (if left == u64::MAX { 0 } else { value(1) & !left }) | (if left == 0 { 0 } else { value(2) & left })
            }
            Kind::Cross => {
                let parts = quadrants(left(0), left(1));
                let of = |(i, part): (usize, u64)| if part & wanted == 0 { 0 } else { value(2 + i) & part };
                parts.into_iter().enumerate().map(of).fold(0, |all, part| all | part)
            }
            Kind::Masks => self.turn(tile),
            _ => self.value_mask(tile, corner),
        }
    }

    /// A mask texel by texel.
    fn gathered(&self, tile: u32, level: u32, [x, y]: [u32; 2], wanted: u64) -> u64 {
        let texel = |bit: u32| self.middle([x + (bit & 7), y + (bit >> 3)]);
        let bits = (0..64).filter(|bit| wanted >> bit & 1 != 0);
        bits.map(|bit| u64::from(self.is_lit(tile, level, texel(bit))) << bit).fold(0, |all, bit| all | bit)
    }

    /// A tile's texels that are lit in this slice.
    #[inline]
    fn turn(&self, tile: u32) -> u64 {
        turns(self.pool, tile).take_while(|(depth, _)| *depth <= self.z).last().map_or(u64::MAX, |(_, lit)| lit)
    }

    /// Where a depth lies behind this slice.
    #[inline(always)]
    fn value_mask(&self, value: u32, corner: [u32; 2]) -> u64 {
        let behind = |form: Form| self.not_negative(self.behind(form), corner);
        let at = payload(value);
        match kind(value) {
            Kind::Depth if self.z < at as u32 => u64::MAX,
            Kind::Depth => 0,
            Kind::Plane => behind(Form::read(self.pool, at)),
            Kind::Deep => behind(Form::read(self.pool, at).deep()),
            _ => {
                let [front, back] = planes(self.pool, value);
                behind(front) | (behind(front.deep()) & behind(back))
            }
        }
    }

    /// The edge between the texels at which a plane lies behind this slice, to its left, and others: there it is not before the next.
    #[inline(always)]
    fn behind(&self, plane: Form) -> Form {
        Form { c: plane.c - (i64::from(self.z + 1) << plane.shift), ..plane }
    }

    /// The texels of an 8 x 8 tile at which a form is not negative.
    #[inline]
    fn not_negative(&self, form: Form, corner: [u32; 2]) -> u64 {
        let first = form.at(self.middle(corner));
        let [a, b] = [form.a, form.b].map(|rise| i64::from(rise) << self.stride);
        let least = first + 7 * (a.min(0) + b.min(0));
        let greatest = first + 7 * (a.max(0) + b.max(0));
        if least >= 0 {
            return u64::MAX;
        }
        if greatest < 0 {
            return 0;
        }
        // Along a row the texels that count lie together at one end, and there is one whose value is of another sign than the first's:
        // all lie within the sum of rises.
        let counts = if greatest - least <= i64::from(i32::MAX) {
            counts_of_rows(first as i32, a as i32, b as i32)
        } else {
            counts_of_rows(first, a, b)
        };
        let row = |count: u8| if a < 0 { (0xff >> (8 - count)) as u8 } else { (0xff00 >> count) as u8 };
        u64::from_le_bytes(counts.map(row))
    }
}

/// How many of the eight numbers first + a x + b y of each row are not negative.
#[inline]
fn counts_of_rows<T: Copy + Default + PartialOrd + core::ops::Add<Output = T>>(first: T, a: T, b: T) -> [u8; 8] {
    let mut values = [first; 8];
    for y in 1..8 {
        values[y] = values[y - 1] + b;
    }
    let mut counts = [0; 8];
    for _ in 0..7 {
        for y in 0..8 {
            counts[y] += u8::from(values[y] >= T::default());
            values[y] = values[y] + a;
        }
    }
    core::array::from_fn(|y| counts[y] + u8::from(values[y] >= T::default()))
}

/// The least and the greatest first shadowed slice over a rectangle of a leaf's texels, both ends in it; of masks the whole range.
pub(crate) fn bounds(pool: &[u32], leaf: u32, rectangle: [[u32; 2]; 2], slices: u32) -> [u32; 2] {
    let at = payload(leaf);
    // Which sides of an edge the rectangle touches: right, left.
    let touched = |i: usize| {
        let [least, greatest] = ends(&Form::read(pool, pool[at + i] as usize), rectangle);
        [least < 0, greatest >= 0]
    };
    let part = |i: usize| bounds_of_value(pool, pool[at + i], rectangle, slices);
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
            parts.map(|i| part(2 + i)).fold([slices, 0], joint)
        }
        Kind::Masks => [0, slices],
        _ => bounds_of_value(pool, leaf, rectangle, slices),
    }
}

fn bounds_of_value(pool: &[u32], value: u32, rectangle: [[u32; 2]; 2], slices: u32) -> [u32; 2] {
    let of = |form: &Form| ends(form, rectangle).map(|v| (v >> form.shift).clamp(0, i64::from(slices)) as u32);
    let at = payload(value);
    match kind(value) {
        Kind::Depth => [at as u32; 2],
        Kind::Plane => of(&Form::read(pool, at)),
        Kind::Deep => of(&Form::read(pool, at).deep()),
        _ => {
            let [front, back] = planes(pool, value);
            let [before, deep, behind] = [of(&front), of(&front.deep()), of(&back)];
            [0, 1].map(|end| before[end].max(deep[end].min(behind[end])))
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
pub(crate) fn column(pool: &[u32], leaf: u32, mut level: u32, [x, y, z]: [u32; 3], slices: u32) -> (u32, [u32; 2]) {
    while level > 0 {
        let first = [x, y].map(|c| c >> level << level);
        let last = first.map(|c| c + (1 << level) - 1);
        let found = bounds(pool, leaf, [first, last], slices);
        if z < found[0] || z >= found[1] {
            return (level, found);
        }
        level -= 1;
    }
    (0, [depth(pool, leaf, 0, [x, y], slices); 2])
}

/// log2 of the columns per side by which a cube's mean is measured.
const COLUMNS_LOG2: u32 = 3;

/// Mean visibility of the cube of 2^`level` voxels per side that holds a voxel, below a tile of 2^`from` texels per side: over the lit
/// length of each of its columns up to 8 x 8, and of wider ones over that of the 64 in the middles of its parts.
pub(crate) fn mean(pool: &[u32], tile: u32, from: u32, level: u32, [x, y, z]: [u32; 3], slices: u32) -> f32 {
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
    let depths = columns.map(|texel| depth(pool, tile, at, texel.map(|c| middle(c, stride)), slices));
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
