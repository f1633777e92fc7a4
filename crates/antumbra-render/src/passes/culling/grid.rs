//! The grid: cells over a scene.

use antumbra_scene::Bounds;
use glam::{DVec3, IVec3, Vec3};

/// Cells over a scene, equally many along each axis. Positions *in cells* count from its least corner; cells are numbered x
/// fastest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    low_world: DVec3,
    cells_per_m: DVec3,
    side: u32,
}

/// By how much a box of cells is widened on all sides so that rounding loses nothing, in cells: far more than single precision
/// errs by in 128 cells.
pub(super) const HAIR: f32 = 1e-3;

impl Grid {
    /// Cells along each axis.
    pub const SIDES: core::ops::RangeInclusive<u32> = 8..=128;

    /// A grid over a box of the world, with so many cells along each axis ([`Grid::SIDES`]; others are brought into it). Along axes in
    /// which the box is flat it is as large as along its longest.
    #[must_use]
    pub fn new(bounds: &Bounds, side: u32) -> Self {
        let side = side.clamp(*Self::SIDES.start(), *Self::SIDES.end());
        let (low, extent) =
            if bounds.is_empty() { (DVec3::ZERO, DVec3::ONE) } else { (bounds.min, bounds.max - bounds.min) };
        let greatest = if extent.max_element() > 0.0 { extent.max_element() } else { 1.0 };
        // Nothing lies on the rim, and no axis vanishes beside the others.
        let is_flat = extent.cmplt(DVec3::splat(greatest * 1e-3));
        let low = DVec3::select(is_flat, low + 0.5 * (extent - greatest), low);
        let extent = DVec3::select(is_flat, DVec3::splat(greatest), extent);
        let margin = extent * 1e-3;
        Self { low_world: low - margin, cells_per_m: f64::from(side) / (extent + 2.0 * margin), side }
    }

    /// Cells along each axis.
    #[must_use]
    pub fn side(&self) -> u32 {
        self.side
    }

    /// How many cells there are.
    #[must_use]
    pub fn cells(&self) -> usize {
        (self.side as usize).pow(3)
    }

    /// How many cells the grids of so many levels have together: each is of cells twice as wide as the one before, so many that
    /// they cover it. Their cells are numbered one grid after the other.
    #[must_use]
    pub fn cells_to(&self, levels: u32) -> usize {
        (0..levels).map(|level| self.coarser(level).cells()).sum()
    }

    /// Levels of the grid until a single cell covers it.
    #[must_use]
    pub fn levels(&self) -> u32 {
        self.side.next_power_of_two().ilog2() + 1
    }

    /// The grid of a level: cells 2^level times as wide.
    #[must_use]
    pub fn coarser(&self, level: u32) -> Self {
        let width = 1 << level;
        Self { side: self.side.div_ceil(width), cells_per_m: self.cells_per_m / f64::from(width), ..*self }
    }

    /// Cells per metre along each axis.
    #[must_use]
    pub fn cells_per_m(&self) -> DVec3 {
        self.cells_per_m
    }

    /// A point of the world, in cells; it may lie outside.
    #[must_use]
    pub fn at(&self, world: DVec3) -> Vec3 {
        ((world - self.low_world) * self.cells_per_m).as_vec3()
    }

    /// The world box of a cell.
    #[must_use]
    pub fn bounds(&self, cell: IVec3) -> Bounds {
        let corner = |cell: IVec3| self.low_world + cell.as_dvec3() / self.cells_per_m;
        Bounds { min: corner(cell), max: corner(cell + 1) }
    }

    /// The number of a cell, if it is one of the grid's.
    #[must_use]
    pub fn number(&self, cell: IVec3) -> Option<usize> {
        let side = self.side as i32;
        let inside = cell.cmpge(IVec3::ZERO).all() && cell.cmplt(IVec3::splat(side)).all();
        inside.then(|| (cell.x + side * (cell.y + side * cell.z)) as usize)
    }

    /// The cell of a number.
    #[must_use]
    pub fn cell(&self, number: usize) -> IVec3 {
        let side = self.side as usize;
        IVec3::new((number % side) as i32, (number / side % side) as i32, (number / side / side) as i32)
    }
}
