//! Lookups in the encoding [`silhouette`](crate::format::silhouette): a descent through a quadtree, then signs of edges and depths
//! of planes, in whole numbers.

use crate::format::dag8::WHOLE;
use crate::format::silhouette::{Form, Kind, MASK_LEVEL, kind, payload};

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
            let [front, back] = [0, 1].map(|i| Form::read(pool, pool[at + i] as usize));
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

/// The 8 x 8 texels of one slice about a texel: bit 8*y + x is 1 where lit.
#[inline]
pub(crate) fn slice_mask(pool: &[u32], tile: u32, level: u32, [x, y]: [u32; 2], z: u32) -> u64 {
    let corner = [x & !7, y & !7];
    let (tile, _) = descend(pool, tile, level, MASK_LEVEL, corner);
    let at = payload(tile);
    let left = |i: usize| not_negative(&Form::read(pool, pool[at + i] as usize), corner);
    let value = |i: usize| value_mask(pool, pool[at + i], corner, z);
    match kind(tile) {
        Kind::Cut => {
            let left = left(0);
            (if left == u64::MAX { 0 } else { value(1) & !left }) | (if left == 0 { 0 } else { value(2) & left })
        }
        Kind::Cross => {
            let (a, b) = (left(0), left(1));
            let parts = [!a & !b, a & !b, !a & b, a & b];
            let of = |(i, part): (usize, u64)| if part == 0 { 0 } else { value(2 + i) & part };
            parts.into_iter().enumerate().map(of).fold(0, |all, part| all | part)
        }
        Kind::Masks => turns(pool, tile).take_while(|(depth, _)| *depth <= z).last().map_or(u64::MAX, |(_, lit)| lit),
        _ => value_mask(pool, tile, corner, z),
    }
}

/// Where a depth lies behind a slice.
#[inline(always)]
fn value_mask(pool: &[u32], value: u32, corner: [u32; 2], z: u32) -> u64 {
    let at = payload(value);
    // A plane lies behind slice z where it is not before z + 1: an edge.
    let behind = |form: Form| not_negative(&Form { c: form.c - (i64::from(z + 1) << form.shift), ..form }, corner);
    match kind(value) {
        Kind::Depth => {
            if z < at as u32 {
                u64::MAX
            } else {
                0
            }
        }
        Kind::Plane => behind(Form::read(pool, at)),
        Kind::Deep => behind(Form::read(pool, at).deep()),
        _ => {
            let [front, back] = [0, 1].map(|i| Form::read(pool, pool[at + i] as usize));
            behind(front) | (behind(front.deep()) & behind(back))
        }
    }
}

/// The texels of an 8 x 8 tile at which a form is not negative.
#[inline]
fn not_negative(form: &Form, corner: [u32; 2]) -> u64 {
    let first = form.at(corner);
    let [a, b] = [i64::from(form.a), i64::from(form.b)];
    let least = first + 7 * (a.min(0) + b.min(0));
    let greatest = first + 7 * (a.max(0) + b.max(0));
    if least >= 0 {
        return u64::MAX;
    }
    if greatest < 0 {
        return 0;
    }
    let mut mask = 0;
    for y in 0..8 {
        let mut row = 0u64;
        let mut value = first + b * y;
        for x in 0..8 {
            row |= u64::from(value >= 0) << x;
            value += a;
        }
        mask |= row << (8 * y);
    }
    mask
}

/// Tile, or texel, about a texel in which one depth holds: its level, and the depth.
pub(crate) fn column(pool: &[u32], root: u32, log2: u32, texel: [u32; 2]) -> (u32, u32) {
    let slices = 1 << log2;
    let (tile, level) = descend(pool, root, log2, 0, texel);
    match kind(tile) {
        Kind::Depth => (level, payload(tile) as u32),
        _ => (0, depth(pool, tile, level, texel, slices)),
    }
}

/// Lit share (of [`WHOLE`]) of the cube of 2^`level` voxels per side that holds a voxel. Looks at every texel of it where depths are
/// not constant.
pub(crate) fn lit_share(pool: &[u32], root: u32, log2: u32, level: u32, [x, y, z]: [u32; 3]) -> u64 {
    let cube = Cube { pool, slices: 1 << log2, first: z >> level << level, side: 1 << level };
    let (tile, at) = descend(pool, root, log2, level, [x, y]);
    let corner = [x >> level << level, y >> level << level];
    let lit = if at > level { cube.lit_of_leaf(tile, level, corner) } else { cube.lit(tile, level, corner) };
    ((lit * u128::from(WHOLE)) >> (3 * level)) as u64
}

struct Cube<'a> {
    pool: &'a [u32],
    slices: u32,
    /// First slice, and how many.
    first: u32,
    side: u32,
}

impl Cube<'_> {
    fn lit(&self, tile: u32, level: u32, [x, y]: [u32; 2]) -> u128 {
        if kind(tile) != Kind::Inner {
            return self.lit_of_leaf(tile, level, [x, y]);
        }
        let half = 1 << (level - 1);
        let of = |i: u32| {
            self.lit(self.pool[payload(tile) + i as usize], level - 1, [x + (i & 1) * half, y + (i >> 1) * half])
        };
        (0..4).map(of).sum()
    }

    fn lit_of_leaf(&self, tile: u32, level: u32, [x, y]: [u32; 2]) -> u128 {
        let lit_of = |depth: u32| u128::from(depth.saturating_sub(self.first).min(self.side));
        if kind(tile) == Kind::Depth {
            return lit_of(payload(tile) as u32) << (2 * level);
        }
        let side = 1u32 << level;
        let texels = (0..side).flat_map(|row| (0..side).map(move |column| [x + column, y + row]));
        texels.map(|texel| lit_of(depth(self.pool, tile, level, texel, self.slices))).sum()
    }
}
