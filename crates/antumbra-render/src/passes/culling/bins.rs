//! Triangles by the cells that they touch.

use glam::{DVec3, IVec3, Vec3};
use rayon::prelude::*;

use super::Marks;
use super::grid::{Grid, HAIR};

/// What becomes of triangles that touch many cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Binning {
    /// Kept whole, in every cell that they touch: drawn once, however many of those are marked.
    Whole,
    /// Cut at the cells' sides: each cell has its own piece, as triangles. What paraboloid maps want.
    Clip,
    /// Kept whole in a list that nothing culls, if they touch more than so many cells; the paper: 2.
    NoCull {
        /// Most cells that a triangle may touch and be culled.
        most_cells: u32,
    },
    /// Kept whole, in the cells of the first of ever coarser grids ([`Grid::coarser`]) in which they touch no more than so many
    /// cells. A cell of a coarser grid counts as marked if any cell in it is.
    Levels {
        /// Most cells that a triangle lies in; those that touch more of the coarsest grid with so many are culled by nothing.
        most_cells: u32,
    },
}

impl Binning {
    /// Levels of a grid that triangles are binned in.
    #[must_use]
    pub fn levels(self, grid: &Grid) -> u32 {
        if matches!(self, Self::Levels { .. }) { grid.levels() } else { 1 }
    }
}

/// The triangles of each cell.
#[derive(Clone, Debug, PartialEq)]
pub struct Bins {
    grid: Grid,
    levels: u32,
    /// Where each cell's triangles begin, and where the last one's end.
    begins: Vec<usize>,
    /// Indices of triangles, cell by cell, ascending in each.
    triangles: Vec<u32>,
    /// Pieces of each cell's triangles; empty where nothing is clipped.
    pieces: Vec<[Vec3; 3]>,
    /// Triangles that nothing culls, ascending.
    unculled: Vec<u32>,
}

/// A triangle's part in a cell.
struct Piece {
    cell: u32,
    triangle: u32,
    corners: [Vec3; 3],
}

impl Bins {
    /// Bins triangles, given by their corners in the world: on all threads, and the same whatever their number. Triangles that
    /// do not lie in the grid, all of them, are culled by nothing.
    ///
    /// A triangle is held against the cells of its box that its plane runs through: up to 50 thousand in the finest grid. Each of
    /// its cells takes 48 bytes while binning, and 4 afterwards (40 if it is clipped).
    #[must_use]
    pub fn new(grid: &Grid, triangles: &[[DVec3; 3]], binning: Binning) -> Self {
        let pieces_of = |i: usize| pieces(grid, i as u32, triangles[i], binning);
        let binned: Vec<Option<Vec<Piece>>> = (0..triangles.len()).into_par_iter().map(pieces_of).collect();
        let unculled = (0..).zip(&binned).filter(|(_, pieces)| pieces.is_none()).map(|(i, _)| i).collect();
        let mut pieces: Vec<Piece> = binned.into_iter().flatten().flatten().collect();
        // In the order of triangles within each cell: the sort is stable.
        pieces.sort_by_key(|piece| piece.cell);
        let levels = binning.levels(grid);
        let begins =
            (0..=grid.cells_to(levels)).map(|cell| pieces.partition_point(|piece| (piece.cell as usize) < cell));
        let is_clipped = binning == Binning::Clip;
        Self {
            grid: *grid,
            levels,
            begins: begins.collect(),
            triangles: pieces.iter().map(|piece| piece.triangle).collect(),
            pieces: if is_clipped { pieces.iter().map(|piece| piece.corners).collect() } else { Vec::new() },
            unculled,
        }
    }

    /// A cell's triangles, as indices; cells of coarser grids are numbered after those of finer ones.
    #[must_use]
    pub fn of_cell(&self, cell: usize) -> &[u32] {
        &self.triangles[self.begins[cell]..self.begins[cell + 1]]
    }

    /// A cell's pieces of triangles, corners in cells, where they are clipped.
    #[must_use]
    pub fn pieces_of_cell(&self, cell: usize) -> &[[Vec3; 3]] {
        if self.pieces.is_empty() {
            return &[];
        }
        &self.pieces[self.begins[cell]..self.begins[cell + 1]]
    }

    /// Triangles that nothing culls.
    #[must_use]
    pub fn unculled(&self) -> &[u32] {
        &self.unculled
    }

    /// Numbers of the cells that have triangles, ascending.
    pub fn occupied(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.begins.len() - 1).filter(|cell| self.begins[*cell] < self.begins[cell + 1])
    }

    /// Triangles to draw for marked cells: each cell's, and those that nothing culls. A triangle of several marked cells counts
    /// in each, as it is drawn in each.
    #[must_use]
    pub fn drawn(&self, marks: &Marks) -> usize {
        self.marked(marks).map(|cell| self.of_cell(cell).len()).sum::<usize>() + self.unculled.len()
    }

    /// Cells that have triangles and are marked, or, of a coarser grid, in which some cell is.
    fn marked(&self, marks: &Marks) -> impl Iterator<Item = usize> + '_ {
        let mut known = vec![(0..self.grid.cells()).map(|cell| marks.has(cell)).collect::<Vec<_>>()];
        for level in 1..self.levels {
            let [finer, own] = [level - 1, level].map(|level| self.grid.coarser(level));
            let mut coarser = vec![false; own.cells()];
            for (cell, _) in known.last().into_iter().flatten().enumerate().filter(|(_, is_marked)| **is_marked) {
                own.number(finer.cell(cell) / 2).into_iter().for_each(|number| coarser[number] = true);
            }
            known.push(coarser);
        }
        let known = known.concat();
        self.occupied().filter(move |cell| known[*cell])
    }

    /// Indices of the triangles of marked cells and of those that nothing culls: ascending, each once.
    #[must_use]
    pub fn survivors(&self, marks: &Marks) -> Vec<u32> {
        let marked = self.marked(marks).flat_map(|cell| self.of_cell(cell));
        let mut all: Vec<u32> = marked.chain(&self.unculled).copied().collect();
        all.sort_unstable();
        all.dedup();
        all
    }
}

/// A triangle's parts; `None` for one that nothing culls.
fn pieces(grid: &Grid, triangle: u32, world: [DVec3; 3], binning: Binning) -> Option<Vec<Piece>> {
    let corners = world.map(|p| grid.at(p));
    let side = Vec3::splat(grid.side() as f32);
    if !corners.iter().all(|p| p.cmpge(Vec3::ZERO).all() && p.cmple(side).all()) {
        return None;
    }
    let numbered = touched(grid, &corners).filter_map(|cell| Some((cell, grid.number(cell)? as u32)));
    match binning {
        Binning::Whole => Some(numbered.map(|(_, cell)| Piece { cell, triangle, corners }).collect()),
        Binning::NoCull { most_cells } => {
            let own: Vec<Piece> =
                numbered.take(most_cells as usize + 1).map(|(_, cell)| Piece { cell, triangle, corners }).collect();
            (own.len() <= most_cells as usize).then_some(own)
        }
        Binning::Levels { most_cells } => {
            let most = most_cells as usize;
            let of_level = |level| {
                let coarser = grid.coarser(level);
                let corners = corners.map(|p| p / (1 << level) as f32);
                let own = touched(&coarser, &corners).filter_map(|cell| coarser.number(cell)).take(most + 1).collect();
                Some(own).filter(|own: &Vec<usize>| own.len() <= most).map(|own| (grid.cells_to(level), own))
            };
            let (first, own) = (0..grid.levels()).find_map(of_level)?;
            Some(own.into_iter().map(|n| Piece { cell: (first + n) as u32, triangle, corners }).collect())
        }
        Binning::Clip => {
            let own =
                |(at, cell)| clipped(&corners, at).into_iter().map(move |corners| Piece { cell, triangle, corners });
            Some(numbered.flat_map(own).collect())
        }
    }
}

/// The cells that a triangle touches, corners in cells: those of its box whose own box it is not separated from. In each column along
/// the axis that its plane faces most, the plane runs through a few of them.
fn touched(grid: &Grid, corners: &[Vec3; 3]) -> impl Iterator<Item = IVec3> {
    let last = (grid.side() - 1) as f32;
    let low = corners.iter().copied().fold(Vec3::INFINITY, Vec3::min);
    let high = corners.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
    let [low, high] = [low - HAIR, high + HAIR].map(|p| p.floor().clamp(Vec3::ZERO, Vec3::splat(last)).as_ivec3());
    let [ab, ac] = [corners[1] - corners[0], corners[2] - corners[0]];
    let normal = ab.cross(ac);
    let w = normal.abs().max_position();
    let (u, v) = ((w + 1) % 3, (w + 2) % 3);
    // A sliver's plane says too little about where it is.
    let is_sliver = normal[w].abs() < 1e-2 * ab.length_squared().max(ac.length_squared());
    let (slope_u, slope_v) = (normal[u] / normal[w], normal[v] / normal[w]);
    let reach = (0.5 + HAIR) * (slope_u.abs() + slope_v.abs()) + 2.0 * HAIR;
    let start = corners[0];
    let column = move |i: i32, j: i32| {
        let (first, final_) = if is_sliver {
            (low[w], high[w])
        } else {
            let middle = start[w] - slope_u * (i as f32 + 0.5 - start[u]) - slope_v * (j as f32 + 0.5 - start[v]);
            let cell = |at: f32| at.clamp(-1.0, last + 1.0).floor() as i32;
            (cell(middle - reach).max(low[w]), cell(middle + reach).min(high[w]))
        };
        (first..=final_).map(move |k| {
            let mut cell = IVec3::ZERO;
            (cell[u], cell[v], cell[w]) = (i, j, k);
            cell
        })
    };
    let all = (low[u]..=high[u]).flat_map(move |i| (low[v]..=high[v]).flat_map(move |j| column(i, j)));
    all.filter(|cell| touches(corners, *cell))
}

/// Whether a triangle and a cell touch, corners in cells; a hair apart counts as touching. Separating axes: Akenine-Möller
/// 2001, *Fast 3D triangle-box overlap testing*.
pub(super) fn touches(corners: &[Vec3; 3], cell: IVec3) -> bool {
    let half = 0.5 + HAIR;
    let [a, b, c] = corners.map(|p| p - (cell.as_vec3() + 0.5));
    let edges = [b - a, c - b, a - c];
    let apart = |axis: Vec3| {
        let [p, q, r] = [a, b, c].map(|corner| axis.dot(corner));
        let reach = half * axis.abs().element_sum();
        p.min(q).min(r) > reach || p.max(q).max(r) < -reach
    };
    let axes = [Vec3::X, Vec3::Y, Vec3::Z];
    let by_edges = || edges.iter().any(|edge| axes.iter().any(|axis| apart(axis.cross(*edge))));
    !(axes.into_iter().any(apart) || apart(edges[0].cross(edges[1])) || by_edges())
}

/// A triangle's piece in a cell, as triangles; corners in cells. Sutherland and Hodgman 1974, *Reentrant polygon clipping*.
fn clipped(corners: &[Vec3; 3], cell: IVec3) -> Vec<[Vec3; 3]> {
    let mut polygon = corners.to_vec();
    for axis in 0..3 {
        polygon = clipped_at(&polygon, axis, cell[axis] as f32, 1.0);
        polygon = clipped_at(&polygon, axis, (cell[axis] + 1) as f32, -1.0);
    }
    let fan = polygon.windows(2).skip(1).map(|pair| [polygon[0], pair[0], pair[1]]);
    fan.collect()
}

/// The part of a convex polygon beyond a plane across an axis, seen along a sign of the axis. A cut of an edge is the same,
/// to the bit, for both triangles that share the edge and for both cells that share the plane; what other planes have cut before
/// may be cut a rounding apart.
fn clipped_at(polygon: &[Vec3], axis: usize, plane: f32, sign: f32) -> Vec<Vec3> {
    let mut out = Vec::with_capacity(polygon.len() + 1);
    for (i, &from) in polygon.iter().enumerate() {
        let to = polygon[(i + 1) % polygon.len()];
        let (f, g) = ((from[axis] - plane) * sign, (to[axis] - plane) * sign);
        if f >= 0.0 {
            out.push(from);
        }
        if f * g < 0.0 {
            let (low, high) = if from[axis] < to[axis] { (from, to) } else { (to, from) };
            let mut cut = low + (high - low) * ((plane - low[axis]) / (high[axis] - low[axis]));
            cut[axis] = plane;
            out.push(cut);
        }
    }
    out
}
