//! A walk along a line from one homogeneous box of voxels to the next, on one face of a light.
//!
//! The idea is that of Amanatides, Woo 1987, *A fast voxel traversal algorithm for ray tracing*: whichever boundary the
//! line crosses first says which neighbour is next. Boxes here are nodes of the graph: as large as the graph has them.
//! Unlike theirs, crossings are not summed up but solved one by one, since slices and texels of a local light are not
//! evenly spread; and integers keep the walk in order:
//!
//! - The line's first and last voxel are found first. Between them each coordinate goes one way.
//! - The coordinate across the crossed boundary is set to the neighbour's. The others are computed from the position and
//!   clamped to the box just left, and never turn back.
//!
//! So each step brings one integer closer to its end, and no rounding can make a walk loop: at most 3N steps.

use super::point::{child, slice_mask};
use super::project::line::FaceLine;
use super::silhouette;
use super::top_grid::TopGrid;
use crate::format::dag8::{LIT, SHADOWED, SLICE_LEVEL};
use crate::format::light::MAX_LOG2_RESOLUTION;
use crate::format::silhouette::{Kind, kind};
use crate::format::slices::Spread;

/// A box of voxels that are all lit or all shadowed.
#[derive(Clone, Copy, Debug)]
struct Cell {
    /// Its least voxel.
    first: [u32; 3],
    /// The voxel past its greatest, on every axis.
    end: [u32; 3],
    lit: bool,
}

/// A part of a line, up to a parameter, that is all lit or all shadowed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Span {
    pub to: f64,
    pub lit: bool,
}

/// The nodes of a face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Graph<'a> {
    pub pool: &'a [u32],
    pub root: u32,
    /// log2 of the root's voxels per side.
    pub log2: u32,
    /// Of silhouettes: their slices and the top grid.
    pub silhouettes: Option<(Spread<'a>, &'a TopGrid)>,
}

/// What is left of a walk.
#[derive(Clone, Debug)]
pub(crate) struct Walk<'a> {
    line: FaceLine<'a>,
    descent: Descent<'a>,
    /// Parameters: here, and where the walk ends.
    at: f64,
    end: f64,
    /// Where the walk stands, and where it ends.
    voxel: [u32; 3],
    last: [u32; 3],
    /// By axis: a boundary, and the parameter of its crossing. Many steps leave a boundary ahead as it was.
    ahead: [(u32, f64); 3],
    is_done: bool,
}

/// No boundary: none has so great a number.
const NOWHERE: (u32, f64) = (u32::MAX, f64::INFINITY);

impl<'a> Walk<'a> {
    /// A walk between two parameters, all inside the volume.
    pub fn new(graph: Graph<'a>, line: FaceLine<'a>, [at, end]: [f64; 2]) -> Self {
        let log2 = graph.log2;
        let greatest = (1u32 << log2) - 1;
        // A cast rounds down and saturates: behind the last slice is the last.
        let voxel_at = |t: f64| core::array::from_fn(|axis| (line.coordinate(axis, t) as u32).min(greatest));
        let (voxel, last) = (voxel_at(at), voxel_at(end));
        let descent = Descent::new(graph);
        Self { line, descent, at, end, voxel, last, ahead: [NOWHERE; 3], is_done: false }
    }

    /// The boundary by which the line leaves a cell along an axis, and the coordinate behind it; `None` if the walk ends
    /// before.
    fn way_out(&self, cell: &Cell, axis: usize) -> Option<(u32, u32)> {
        if self.last[axis] >= cell.end[axis] {
            Some((cell.end[axis], cell.end[axis]))
        } else if self.last[axis] < cell.first[axis] {
            Some((cell.first[axis], cell.first[axis] - 1))
        } else {
            None
        }
    }

    /// Where the line crosses a boundary ahead: not before here.
    fn crossing(&mut self, axis: usize, boundary: u32) -> f64 {
        if self.ahead[axis].0 != boundary {
            self.ahead[axis] = (boundary, self.line.crossing(axis, boundary));
        }
        self.ahead[axis].1.max(self.at)
    }

    /// Moves across a boundary at parameter `to`, after which coordinate `axis` is `next`.
    fn cross(&mut self, cell: &Cell, axis: usize, next: u32, to: f64) {
        for other in (0..3).filter(|other| *other != axis) {
            let (here, last) = (self.voxel[other], self.last[other]);
            let (least, greatest) =
                if last >= here { (here, last.min(cell.end[other] - 1)) } else { (last.max(cell.first[other]), here) };
            if least < greatest {
                self.voxel[other] = (self.line.coordinate(other, to) as u32).clamp(least, greatest);
            }
        }
        self.voxel[axis] = next;
        self.at = to;
    }
}

impl Iterator for Walk<'_> {
    type Item = Span;

    /// One cell.
    fn next(&mut self) -> Option<Span> {
        if self.is_done {
            return None;
        }
        let cell = self.descent.cell(self.voxel);
        let mut exit = None;
        let mut to = self.end;
        for axis in 0..3 {
            let Some((boundary, next)) = self.way_out(&cell, axis) else { continue };
            let crossing = self.crossing(axis, boundary);
            if crossing < to {
                (exit, to) = (Some((axis, next)), crossing);
            }
        }
        match exit {
            Some((axis, next)) => self.cross(&cell, axis, next, to),
            None => self.is_done = true,
        }
        Some(Span { to, lit: cell.lit })
    }
}

/// A descent to one voxel after another that begins at the least node which holds both: neighbours share most of their way.
#[derive(Clone, Debug)]
struct Descent<'a> {
    graph: Graph<'a>,
    pool: &'a [u32],
    /// By level: the node that holds the last voxel, from the root's level down to `level`.
    nodes: [u32; MAX_LOG2_RESOLUTION as usize + 1],
    level: u32,
    /// The voxel that was asked for last.
    voxel: [u32; 3],
}

impl<'a> Descent<'a> {
    fn new(graph: Graph<'a>) -> Self {
        let Graph { pool, root, log2, .. } = graph;
        let mut nodes = [LIT; MAX_LOG2_RESOLUTION as usize + 1];
        nodes[log2 as usize] = root;
        Self { graph, pool, nodes, level: log2, voxel: [0; 3] }
    }

    /// The largest homogeneous box that the graph has about a voxel of the volume.
    fn cell(&mut self, voxel: [u32; 3]) -> Cell {
        if let Some((spread, grid)) = self.graph.silhouettes {
            return self.cell_of_cells(voxel, grid).unwrap_or_else(|| self.cell_of_column(voxel, spread));
        }
        let [dx, dy, dz] = [0, 1, 2].map(|axis| voxel[axis] ^ self.voxel[axis]);
        let shared = u32::BITS - (dx | dy | dz).leading_zeros();
        self.voxel = voxel;
        let mut level = self.level.max(shared);
        let mut node = self.nodes[level as usize];
        while node > SHADOWED && level > SLICE_LEVEL {
            level -= 1;
            let [x, y, z] = voxel.map(|c| (c >> level) & 1);
            node = child(self.pool, node, x | (y << 1) | (z << 2));
            self.nodes[level as usize] = node;
        }
        self.level = level;
        if node <= SHADOWED { cube(voxel, level, node == LIT) } else { self.cell_in_slices(node, voxel) }
    }

    /// Cells of the top grid about a voxel before or behind all that they hold.
    fn cell_of_cells(&self, voxel: [u32; 3], grid: &TopGrid) -> Option<Cell> {
        let (level, lit, [first, end]) = grid.widest([voxel[0], voxel[1]], voxel[2])?;
        let mut cell = cube(voxel, level, lit);
        (cell.first[2], cell.end[2]) = (first, end);
        Some(cell)
    }

    /// The column about a voxel before or behind the depths of silhouettes.
    fn cell_of_column(&mut self, voxel: [u32; 3], spread: Spread<'_>) -> Cell {
        let (dx, dy) = (voxel[0] ^ self.voxel[0], voxel[1] ^ self.voxel[1]);
        let shared = u32::BITS - (dx | dy).leading_zeros();
        self.voxel = voxel;
        let mut level = self.level.max(shared);
        let mut tile = self.nodes[level as usize];
        while kind(tile) == Kind::Inner {
            (tile, level) = silhouette::descend(self.pool, tile, level, level - 1, [voxel[0], voxel[1]]);
            self.nodes[level as usize] = tile;
        }
        self.level = level;
        let (level, [least, greatest]) = silhouette::column(self.pool, tile, level, voxel, spread);
        let mut cell = cube(voxel, level, voxel[2] < least);
        (cell.first[2], cell.end[2]) = if cell.lit { (0, least) } else { (greatest, spread.count()) };
        cell
    }

    /// The box about a voxel in a slice node: neighbouring slices that are alike, or a texel of a mask.
    fn cell_in_slices(&self, node: u32, voxel: [u32; 3]) -> Cell {
        let slice = voxel[2] & 7;
        let code = child(self.pool, node, slice);
        if code > SHADOWED {
            let mask = slice_mask(self.pool, node, slice);
            return cube(voxel, 0, (mask >> (8 * (voxel[1] & 7) + (voxel[0] & 7))) & 1 != 0);
        }
        // Two bits for each slice, not both zero where it is unlike this one.
        let unlike = (self.pool[node as usize] ^ (code * 0x5555)) & 0xffff;
        let before = unlike & ((1 << (2 * slice)) - 1);
        let behind = unlike >> (2 * slice);
        let mut cell = cube(voxel, SLICE_LEVEL, code == LIT);
        let corner = cell.first[2];
        cell.first[2] = corner + (u32::BITS - before.leading_zeros()).div_ceil(2);
        cell.end[2] = corner + (slice + behind.trailing_zeros() / 2).min(8);
        cell
    }
}

/// The node of 2^`level` voxels per side that holds a voxel.
fn cube(voxel: [u32; 3], level: u32, lit: bool) -> Cell {
    let first = voxel.map(|c| (c >> level) << level);
    Cell { first, end: first.map(|c| c + (1 << level)), lit }
}
