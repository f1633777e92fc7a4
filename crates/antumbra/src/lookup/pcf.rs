//! Percentage-closer filtering on flat masks (Sintorn et al. 2014, section 5): all taps share a depth, so a K x K
//! window touches few 8 x 8 masks: at most 4 for K <= 9, at most 9 for K <= 17. Descents to them share their common
//! part, and a mask is weighed as a whole: by a population count (box) or row by row (tent).

use glam::DVec3;

use super::filter::{Filter, Kernel};
use super::point::{child, descend, slice_mask};
use super::top_grid::TopGrid;
use super::window::{self, Slice};
use crate::format::dag8::{LIT, SHADOWED, SLICE_LEVEL};
use crate::format::silhouette::MASK_LEVEL;
use crate::format::slices::Spread;

/// Texels per side of a mask.
const TILE: i32 = 8;

/// A window of taps about a texel, at one depth.
struct Window<'a> {
    pool: &'a [u32],
    filter: Filter,
    /// The middle tap.
    center: [i32; 2],
    /// First and last texel inside the volume, inclusive.
    first: [i32; 2],
    last: [i32; 2],
    /// Depth slice.
    z: u32,
}

/// Where a window's masks are.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    pub pool: &'a [u32],
    pub grid: &'a TopGrid,
    /// Of silhouettes: log2 of how far the taps lie apart, on a coarse level, and their slices.
    pub silhouette: Option<(u32, Spread<'a>)>,
}

/// Weights of a window's taps.
pub(crate) struct Weights {
    /// Of the lit taps inside the volume.
    pub lit: u32,
    /// Of all taps inside the volume.
    pub inside: u32,
    /// Of all taps.
    pub all: u32,
}

/// Filtered visibility at real-valued voxel coordinates in a light of `side` texels per side; taps outside are lit.
#[inline]
pub(crate) fn filtered(source: Source<'_>, side: u32, voxel: DVec3, filter: Filter) -> f32 {
    let Weights { lit, inside, all } = weights(source, side, voxel, filter);
    (lit + all - inside) as f32 / all as f32
}

/// The same, weight by weight. Before the first slice no tap is inside.
#[inline]
pub(crate) fn weights(source: Source<'_>, side: u32, voxel: DVec3, filter: Filter) -> Weights {
    let all = filter.axis_weight() * filter.axis_weight();
    let Some(window) = Window::new(source.pool, side, voxel, filter) else { return Weights { lit: 0, inside: 0, all } };
    let grid = source.grid;
    let lit = source.silhouette.map_or_else(|| window.lit_weight(grid), |s| window.silhouette_weight(grid, s));
    Weights { lit, inside: window.rectangle_weight(window.first, window.last), all }
}

/// Calls `each` with the middle of every tap outside the volume sideways, at the window's depth, and its weight.
pub(crate) fn for_each_outside(side: u32, voxel: DVec3, filter: Filter, mut each: impl FnMut(DVec3, u32)) {
    let radius = filter.radius() as i32;
    let center = DVec3::new(libm::floor(voxel.x) + 0.5, libm::floor(voxel.y) + 0.5, voxel.z);
    let inside = |c: f64| c >= 0.0 && c < f64::from(side);
    for y in -radius..=radius {
        for x in -radius..=radius {
            let tap = center + DVec3::new(f64::from(x), f64::from(y), 0.0);
            if !(inside(tap.x) && inside(tap.y)) {
                each(tap, filter.weight(x.unsigned_abs()) * filter.weight(y.unsigned_abs()));
            }
        }
    }
}

impl<'a> Window<'a> {
    /// `None` where all taps are lit because they lie outside the volume.
    #[inline]
    fn new(pool: &'a [u32], side: u32, voxel: DVec3, filter: Filter) -> Option<Self> {
        let (n, radius) = (f64::from(side), f64::from(filter.radius()));
        let reach = |c: f64| c >= -radius && c < n + radius;
        if !(reach(voxel.x) && reach(voxel.y) && voxel.z >= 0.0) {
            return None;
        }
        let center = [libm::floor(voxel.x) as i32, libm::floor(voxel.y) as i32];
        let radius = filter.radius() as i32;
        let first = center.map(|c| (c - radius).max(0));
        let last = center.map(|c| (c + radius).min(side as i32 - 1));
        let touches = first[0] <= last[0] && first[1] <= last[1];
        touches.then(|| Self { pool, filter, center, first, last, z: (voxel.z as u32).min(side - 1) })
    }

    /// Weight of the lit taps inside the volume.
    #[inline]
    fn lit_weight(&self, grid: &TopGrid) -> u32 {
        let [x0, y0] = self.first.map(|c| c as u32);
        let [x1, y1] = self.last.map(|c| c as u32);
        // The least level whose one node holds the whole window.
        let common = 32 - ((x0 ^ x1) | (y0 ^ y1)).leading_zeros();
        if common > grid.level {
            return self.sum_tiles(|tile| (grid.node(tile), grid.level));
        }
        let corner = [x0, y0, self.z];
        let to = common.max(SLICE_LEVEL);
        match descend(self.pool, grid.node(corner), grid.level, to, corner) {
            LIT => self.rectangle_weight(self.first, self.last),
            SHADOWED => 0,
            node if to == SLICE_LEVEL => self.mask_weight(node, [x0, y0]),
            node => self.node_weight(node, to),
        }
    }

    /// Sums over the masks that the window touches, each reached from the node that `start` gives for its corner.
    #[inline]
    fn sum_tiles(&self, start: impl Fn([u32; 3]) -> (u32, u32)) -> u32 {
        let mut sum = 0;
        for y in (self.first[1] & -TILE..=self.last[1]).step_by(TILE as usize) {
            for x in (self.first[0] & -TILE..=self.last[0]).step_by(TILE as usize) {
                let corner = [x as u32, y as u32, self.z];
                let (node, level) = start(corner);
                let node = descend(self.pool, node, level, SLICE_LEVEL, corner);
                sum += self.mask_weight(node, [x as u32, y as u32]);
            }
        }
        sum
    }

    /// As [`Window::sum_tiles`] below one node of 2^`level` voxels per side that holds the whole window and is split
    /// by it: its (two or four) children in the window's slice are looked up once.
    #[inline]
    fn node_weight(&self, node: u32, level: u32) -> u32 {
        let below = level - 1;
        let z_bit = ((self.z >> below) & 1) << 2;
        let children: [u32; 4] = core::array::from_fn(|i| child(self.pool, node, i as u32 | z_bit));
        self.sum_tiles(|[x, y, _]| {
            let quadrant = ((x >> below) & 1) | (((y >> below) & 1) << 1);
            (children[quadrant as usize], below)
        })
    }

    /// The same of silhouettes, at texels 2^`stride` apart.
    #[inline]
    fn silhouette_weight(&self, grid: &TopGrid, (stride, spread): (u32, Spread<'_>)) -> u32 {
        let slice = Slice::new(self.pool, self.z, stride, spread);
        let [first, last] = [self.first, self.last].map(|texel| texel.map(|c| c as u32));
        if let Some(is_lit) = grid.is_lit_between(slice.middle(first), slice.middle(last), slice.z()) {
            return if is_lit { self.rectangle_weight(self.first, self.last) } else { 0 };
        }
        let is_box = self.filter.kernel() != Kernel::Tent;
        let mut window = window::Window::new(first, is_box);
        // The least squares of which something is known, of 8 x 8 texels at least, or all of a coarse level whose texels are wider than they.
        let squares = (grid.level - 1).max(MASK_LEVEL);
        let is_in_squares = stride < squares;
        let (cell, level) =
            if is_in_squares { (squares - stride, grid.level) } else { (grid.root.1 - stride, grid.root.1) };
        for y in first[1] >> cell..=last[1] >> cell {
            for x in first[0] >> cell..=last[0] >> cell {
                let corner = [x, y].map(|c| c << cell);
                let from = [0, 1].map(|axis| first[axis].max(corner[axis]));
                let to = [0, 1].map(|axis| last[axis].min(corner[axis] + (1 << cell) - 1));
                let settled = if is_in_squares { grid.settled(squares, slice.middle(corner), slice.z()) } else { None };
                match settled {
                    Some(is_lit) => window.add_all([from, to], is_lit),
                    None => {
                        let [x, y] = slice.middle(corner);
                        let tile = if is_in_squares { grid.node([x, y, 0]) } else { grid.root.0 };
                        slice.add_lit(&mut window, tile, level, [from, to]);
                    }
                }
            }
        }
        if is_box { window.count } else { self.tent_weight_of_rows(&window.rows) }
    }

    /// Tent weight of the window's taps that are set, row by row from its first on.
    #[inline]
    fn tent_weight_of_rows(&self, rows: &[u32; window::Window::SIDE]) -> u32 {
        let [width, height] = [0, 1].map(|axis| (self.last[axis] - self.first[axis]) as usize + 1);
        let rows = &rows[..height];
        let all = (1u32 << width) - 1;
        if rows.iter().all(|row| *row == all) {
            return self.rectangle_weight(self.first, self.last);
        }
        if rows.iter().all(|row| *row == 0) {
            return 0;
        }
        let weight =
            |axis: usize, i: usize| self.filter.weight(self.center[axis].abs_diff(self.first[axis] + i as i32));
        // Each column's weights: eight to a word, 81 of each at most.
        let mut columns = [0u64; window::Window::SIDE.div_ceil(TILE as usize)];
        for (y, row) in rows.iter().enumerate() {
            for (i, sums) in columns.iter_mut().enumerate().take(width.div_ceil(TILE as usize)) {
                *sums += spread_to_ones(u64::from(row >> (TILE as usize * i)) & 0xff) * u64::from(weight(1, y));
            }
        }
        let sum_of = |x: usize| (columns[x / TILE as usize] >> (TILE as usize * (x % TILE as usize))) as u32 & 0xff;
        (0..width).map(|x| sum_of(x) * weight(0, x)).sum()
    }

    /// Weight of the window's lit taps in one tile, given the node that holds it.
    #[inline]
    fn mask_weight(&self, node: u32, corner: [u32; 2]) -> u32 {
        self.weight_of(slice_mask(self.pool, node, self.z), corner)
    }

    /// First and last texel of the window in the tile at a corner.
    #[inline]
    fn within(&self, corner: [i32; 2]) -> [[i32; 2]; 2] {
        let first = [self.first[0].max(corner[0]), self.first[1].max(corner[1])];
        [first, [self.last[0].min(corner[0] + TILE - 1), self.last[1].min(corner[1] + TILE - 1)]]
    }

    /// Weight of the window's taps in one tile whose mask is given.
    #[inline]
    fn weight_of(&self, mask: u64, [x, y]: [u32; 2]) -> u32 {
        let corner = [x as i32 & -TILE, y as i32 & -TILE];
        let [first, last] = self.within(corner);
        match mask {
            0 => 0,
            u64::MAX => self.rectangle_weight(first, last),
            mask => match self.filter.kernel() {
                Kernel::Box | Kernel::Continuous => (mask & rectangle_mask(corner, first, last)).count_ones(),
                Kernel::Tent => self.tent_weight(mask & rectangle_mask(corner, first, last), corner),
            },
        }
    }

    /// Weighs a mask row by row: a row's eight bits spread to bytes select its columns' weights.
    #[inline]
    fn tent_weight(&self, mask: u64, corner: [i32; 2]) -> u32 {
        let weight = |axis: usize, i: i32| self.filter.weight(self.center[axis].abs_diff(corner[axis] + i));
        let columns = (0..TILE).fold(0u64, |all, i| all | (u64::from(weight(0, i)) << (8 * i)));
        let mut sum = 0;
        for row in 0..TILE {
            let bits = (mask >> (TILE * row)) & 0xff;
            if bits != 0 {
                let chosen = columns & spread_to_bytes(bits);
                // Eight weights of at most 9 each add up to less than 256.
                let row_sum = (chosen.wrapping_mul(0x0101_0101_0101_0101) >> 56) as u32;
                sum += row_sum * weight(1, row);
            }
        }
        sum
    }

    /// Weight of all taps of a rectangle of texels, inclusive.
    #[inline]
    fn rectangle_weight(&self, first: [i32; 2], last: [i32; 2]) -> u32 {
        let axis = |a: usize| match self.filter.kernel() {
            Kernel::Box | Kernel::Continuous => (last[a] + 1 - first[a]) as u32,
            Kernel::Tent => (first[a]..=last[a]).map(|c| self.filter.weight(self.center[a].abs_diff(c))).sum(),
        };
        axis(0) * axis(1)
    }
}

/// Bits of a tile's mask that lie in a rectangle of texels, inclusive, within the tile at `corner`.
#[inline]
fn rectangle_mask(corner: [i32; 2], first: [i32; 2], last: [i32; 2]) -> u64 {
    let run = |a: usize| {
        let length = (last[a] + 1 - first[a]) as u32;
        ((1u64 << length) - 1) << (first[a] - corner[a])
    };
    let columns = run(0);
    // One bit per row, then every row's first bit, then the columns in each chosen row.
    (spread_to_bytes(run(1)) & 0x0101_0101_0101_0101) * columns
}

/// Byte i is 0xff where bit i is set, else 0.
#[inline]
fn spread_to_bytes(bits: u64) -> u64 {
    spread_to_ones(bits) * 0xff
}

/// Byte i is 1 where bit i is set, else 0.
#[inline]
fn spread_to_ones(bits: u64) -> u64 {
    // Copy the bits to every byte, keep bit i in byte i, turn each non-zero byte to 1.
    let copies = bits.wrapping_mul(0x0101_0101_0101_0101) & 0x8040_2010_0804_0201;
    ((copies + 0x7f7f_7f7f_7f7f_7f7f) | copies) >> 7 & 0x0101_0101_0101_0101
}
