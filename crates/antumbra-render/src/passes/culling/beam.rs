//! Beams: the cells between what is seen and a light.

use glam::{IVec3, Vec3};

use super::grid::{Grid, HAIR};

/// Everything between two boxes: their convex hull, in cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// The boxes' least corners: of what is seen, and of the light.
    pub low: [Vec3; 2],
    /// The boxes' greatest corners.
    pub high: [Vec3; 2],
}

/// A bit for each cell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Marks {
    words: Vec<u32>,
}

/// Shares of the way from the one box to the other at which some conditions hold.
#[derive(Clone, Copy)]
struct Span {
    from: f32,
    to: f32,
}

impl Marks {
    /// None of a grid's cells.
    #[must_use]
    pub fn none(grid: &Grid) -> Self {
        Self { words: vec![0; grid.cells().div_ceil(32)] }
    }

    /// 32 cells to a word, in the order of their numbers.
    #[must_use]
    pub fn words(&self) -> &[u32] {
        &self.words
    }

    /// Marks a cell, given its number.
    pub fn set(&mut self, cell: usize) {
        self.words[cell / 32] |= 1 << (cell % 32);
    }

    /// Whether a cell is marked.
    #[must_use]
    pub fn has(&self, cell: usize) -> bool {
        self.words[cell / 32] >> (cell % 32) & 1 != 0
    }

    /// How many are.
    #[must_use]
    pub fn count(&self) -> usize {
        self.words.iter().map(|word| word.count_ones() as usize).sum()
    }
}

impl Beam {
    /// Between two boxes, each a least and a greatest corner, in cells.
    #[must_use]
    pub fn new([low, high]: [Vec3; 2], [light_low, light_high]: [Vec3; 2]) -> Self {
        Self { low: [low - HAIR, light_low - HAIR], high: [high + HAIR, light_high + HAIR] }
    }

    /// Marks the cells that the beam touches.
    ///
    /// At a share t of the way the beam is a box whose sides are linear in t, so a cell is touched exactly if there is a t that
    /// satisfies six linear inequalities. Slices across the axis along which the boxes lie farthest apart are independent
    /// of each other: on the card each has a lane of its own.
    pub fn mark(&self, grid: &Grid, marks: &mut Marks) {
        let way = (self.low[1] + self.high[1] - self.low[0] - self.high[0]).abs();
        let major = way.max_position();
        let (first, last) = self.range(major, Span::ALL, grid);
        for slice in first..=last {
            self.mark_slice(grid, major, slice, marks);
        }
    }

    fn mark_slice(&self, grid: &Grid, major: usize, slice: i32, marks: &mut Marks) {
        let Some(span) = self.over(major, slice, Span::ALL) else { return };
        let (u, v) = ((major + 1) % 3, (major + 2) % 3);
        let (first, last) = self.range(u, span, grid);
        for column in first..=last {
            let Some(span) = self.over(u, column, span) else { continue };
            let (first, last) = self.range(v, span, grid);
            for row in first..=last {
                if self.over(v, row, span).is_some() {
                    let mut cell = IVec3::ZERO;
                    cell[major] = slice;
                    cell[u] = column;
                    cell[v] = row;
                    grid.number(cell).into_iter().for_each(|number| marks.set(number));
                }
            }
        }
    }

    /// The first and the last cell of the grid along an axis that the beam may touch within a span; none: the last is less.
    fn range(&self, axis: usize, span: Span, grid: &Grid) -> (i32, i32) {
        let at = |ends: [Vec3; 2], t: f32| ends[0][axis] + (ends[1][axis] - ends[0][axis]) * t;
        let low = at(self.low, span.from).min(at(self.low, span.to));
        let high = at(self.high, span.from).max(at(self.high, span.to));
        ((low.floor() as i32).max(0), (high.floor() as i32).min(grid.side() as i32 - 1))
    }

    /// The part of a span in which the beam is over a cell's extent along an axis.
    fn over(&self, axis: usize, cell: i32, span: Span) -> Option<Span> {
        let (low, high) = (cell as f32, (cell + 1) as f32);
        span.keep(high - self.low[0][axis], high - self.low[1][axis])?
            .keep(self.high[0][axis] - low, self.high[1][axis] - low)
    }
}

impl Span {
    const ALL: Self = Self { from: 0.0, to: 1.0 };

    /// The part in which a linear function is not negative, given its values at shares 0 and 1.
    fn keep(self, first: f32, last: f32) -> Option<Self> {
        let Self { from, to } = match (first >= 0.0, last >= 0.0) {
            (true, true) => self,
            (false, false) => return None,
            (false, true) => Self { from: self.from.max(first / (first - last)), ..self },
            (true, false) => Self { to: self.to.min(first / (first - last)), ..self },
        };
        (from <= to).then_some(Self { from, to })
    }
}

/// Lights farther away than so many cells are taken to be no farther, where steps are counted.
const FARTHEST: i32 = 1 << 20;

/// The paper's earlier way, to measure beams against: steps from cell to cell along the line between two cells' middles
/// (Amanatides and Woo 1987, *A fast voxel traversal algorithm for ray tracing*), and marks each with all 26 neighbours.
pub fn mark_by_steps(grid: &Grid, from: IVec3, to: IVec3, marks: &mut Marks) {
    let to = to.clamp(IVec3::splat(-FARTHEST), IVec3::splat(FARTHEST));
    let way = (to - from).as_vec3();
    let step = way.signum().as_ivec3();
    // The share of the way at which the next side is met along each axis, and between two sides.
    let between = way.abs().recip();
    let mut next = between * 0.5;
    let mut cell = from;
    mark_ring(grid, cell, marks);
    // Beyond a ring about the grid there is nothing more to mark, however far away a light is.
    let is_near = |cell: IVec3| cell.cmpge(IVec3::NEG_ONE).all() && cell.cmple(IVec3::splat(grid.side() as i32)).all();
    while cell != to && is_near(cell) {
        let axis = next.min_position();
        cell[axis] += step[axis];
        next[axis] = if cell[axis] == to[axis] { f32::INFINITY } else { next[axis] + between[axis] };
        mark_ring(grid, cell, marks);
    }
}

fn mark_ring(grid: &Grid, cell: IVec3, marks: &mut Marks) {
    for i in 0..27 {
        let beside = IVec3::new(i % 3, i / 3 % 3, i / 9) - 1;
        grid.number(cell + beside).into_iter().for_each(|number| marks.set(number));
    }
}
