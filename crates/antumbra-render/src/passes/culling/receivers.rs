//! Source cells: where what is seen lies, and what lookups read beside it.

use std::collections::BTreeMap;

use glam::{DVec3, IVec3, Vec3};

use super::beam::{Beam, Marks};
use super::grid::Grid;

/// A cell that something seen lies in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SourceCell {
    /// The cell.
    pub cell: IVec3,
    /// The box of what is seen in it, in cells.
    pub low: Vec3,
    /// Its greatest corner.
    pub high: Vec3,
}

/// The source cells of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Receivers {
    /// In the order of their numbers.
    pub cells: Vec<SourceCell>,
}

/// How far beside its point a lookup of a cube map reads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint {
    /// Metres per metre of distance from the light.
    pub per_m: f64,
}

impl Footprint {
    /// Of maps with so many texels per face's side, filtered with so many taps per axis.
    ///
    /// A texel of a face is 2/N of the distance along the face's axis, which is at most the point's own. A lookup moves off
    /// its surface by up to the filter's half width along each axis, and a sixteenth of a texel; then it reads texels whose centres
    /// lie up to half the filter and half a texel aside. Both along two axes of the face, hence a diagonal.
    #[must_use]
    pub fn of_cube(texels: u32, taps: u32) -> Self {
        let reach = (0.5 * f64::from(taps) + 0.5) + (0.5 * f64::from(taps) + 0.0625) * std::f64::consts::SQRT_2;
        Self { per_m: reach * std::f64::consts::SQRT_2 * 2.0 / f64::from(texels.max(1)) }
    }

    /// None: points are looked up where they are.
    pub const NONE: Self = Self { per_m: 0.0 };
}

impl Receivers {
    /// Of points that are seen, in the world; what lies outside the grid belongs to the nearest cell, what lies nowhere is left
    /// out.
    #[must_use]
    pub fn new(grid: &Grid, points: impl IntoIterator<Item = DVec3>) -> Self {
        let mut cells: BTreeMap<usize, SourceCell> = BTreeMap::new();
        for point in points {
            let at = grid.at(point);
            if !at.is_finite() {
                continue;
            }
            let last = Vec3::splat((grid.side() - 1) as f32);
            let cell = at.floor().clamp(Vec3::ZERO, last).as_ivec3();
            let Some(number) = grid.number(cell) else { continue };
            let own = cells.entry(number).or_insert(SourceCell { cell, low: at, high: at });
            (own.low, own.high) = (own.low.min(at), own.high.max(at));
        }
        Self { cells: cells.into_values().collect() }
    }

    /// Marks all cells between what is seen and the lights of one light cell, given the box of those lights in the world.
    pub fn mark(&self, grid: &Grid, lights: [DVec3; 2], footprint: Footprint, marks: &mut Marks) {
        let [low, high] = lights.map(|p| grid.at(p));
        for source in &self.cells {
            let farthest = (source.high - low).abs().max((high - source.low).abs()).as_dvec3() / grid.cells_per_m();
            // What is read beside a point lies no farther from the light than the point, and as far from it.
            let reach_m = footprint.per_m * farthest.length();
            let reach = (grid.cells_per_m() * reach_m).as_vec3();
            Beam::new([source.low - reach, source.high + reach], [low, high]).mark(grid, marks);
        }
    }

    /// The same between whole cells, as in the paper: widened as well.
    pub fn mark_cells(&self, grid: &Grid, light: DVec3, footprint: Footprint, marks: &mut Marks) {
        let of_light = grid.at(light).floor();
        for source in &self.cells {
            let own = source.cell.as_vec3();
            let farthest = ((own - of_light).abs() + 1.0).as_dvec3() / grid.cells_per_m();
            let reach = (grid.cells_per_m() * footprint.per_m * farthest.length()).as_vec3();
            Beam::new([own - reach, own + 1.0 + reach], [of_light, of_light + 1.0]).mark(grid, marks);
        }
    }
}
