//! Blocker depth: how far before a point its shadow is cast, for penumbrae that harden on contact.
//!
//! Answers come from the coarse enter depths of the optional `ENTR` section, never from the node pool: a transition there
//! may lie anywhere inside a solid.

use glam::DVec3;

use super::light::LightShadow;
use crate::format::enter::{Cell, EnterPyramid, NONE};

/// Bounds on how far before a point the surfaces lie that the light meets first and that shadow it, metres along the axis
/// of the light's face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Blocker {
    /// No such surface is nearer to the point (never less than 0).
    pub least_m: f64,
    /// None is farther.
    pub greatest_m: f64,
}

/// Cells per side of the pyramid's level that a window may touch.
const MOST_CELLS: u32 = 4;

impl LightShadow<'_> {
    /// Whether the file holds enter depths, without which [`LightShadow::blocker`] finds nothing.
    #[must_use]
    pub fn has_enter_depths(self) -> bool {
        self.file.enters.is_some()
    }

    /// Bounds on the first shadowed slice of a texel's ray, `u32::MAX` for none: those of the cell that holds the texel.
    /// `None` without enter depths.
    ///
    /// # Panics
    /// When the light has no such face.
    #[must_use]
    pub fn enter_bounds(self, face: usize, texel: [u32; 2]) -> Option<[u32; 2]> {
        let enters = &self.file.enters.as_ref()?[self.index];
        let pyramid = &enters.faces[face];
        let shift = self.record().log2_resolution - pyramid.log2_cells;
        let [x, y] = texel.map(|c| (c & (self.record().resolution() - 1)) >> shift);
        let Cell { least, greatest } = pyramid.levels[0][((y << pyramid.log2_cells) + x) as usize];
        Some([least, greatest].map(|stored| if stored == NONE { u32::MAX } else { u32::from(stored) << enters.shift }))
    }

    /// Least and greatest enter depth, in the units of the `ENTR` section, of all cells of a face from the first texel's to
    /// the last's that hold something before a slice, or in it. `None` where nothing does, and without enter depths.
    ///
    /// # Panics
    /// When the light has no such face, or a texel lies outside it.
    #[must_use]
    pub fn enter_window(self, face: usize, first: [u32; 2], last: [u32; 2], slice: u32) -> Option<[u16; 2]> {
        let enters = &self.file.enters.as_ref()?[self.index];
        let pyramid = &enters.faces[face];
        let shift = self.record().log2_resolution - pyramid.log2_cells;
        let [first, last] = [first, last].map(|texel| texel.map(|c| c >> shift));
        window(pyramid, first, last, slice >> enters.shift).map(|cell| [cell.least, cell.greatest])
    }

    /// Bounds on the blockers' distance within a square window about a point: `radius_m` to every side across the light,
    /// widened to whole cells. `None` where nothing there lies before the point, outside the volume, and without enter
    /// depths.
    ///
    /// Cost: at most 16 reads.
    #[must_use]
    pub fn blocker(self, point_world: DVec3, radius_m: f64) -> Option<Blocker> {
        let enters = &self.file.enters.as_ref()?[self.index];
        let at = self.project(point_world);
        let side = f64::from(self.record().resolution());
        let inside = at.voxel.x >= 0.0 && at.voxel.x < side && at.voxel.y >= 0.0 && at.voxel.y < side;
        if !inside || at.voxel.z.is_nan() || at.voxel.z < 0.0 {
            return None;
        }
        let radius = radius_m.max(0.0) / self.frame(point_world).texel_m;
        // A cast rounds down and saturates.
        let texel = |c: f64| c.clamp(0.0, side - 1.0) as u32;
        let [first, last] = [-radius, radius].map(|r| [texel(at.voxel.x + r), texel(at.voxel.y + r)]);
        let [least, greatest] = self.enter_window(at.face, first, last, at.voxel.z as u32)?;
        let unit = f64::from(1u32 << enters.shift);
        // A ray that is first shadowed in slice s meets its caster in slice s - 1.
        let nearest_to_light = (f64::from(least) * unit - 1.0).max(0.0);
        let nearest_to_point = (f64::from(greatest) * unit).min(at.voxel.z);
        let here = self.depth_of_slice(at.voxel.z);
        Some(Blocker {
            least_m: (here - self.depth_of_slice(nearest_to_point)).max(0.0),
            greatest_m: here - self.depth_of_slice(nearest_to_light),
        })
    }
}

/// The union of all cells from one to another that hold something at or before a depth.
fn window(pyramid: &EnterPyramid, first: [u32; 2], last: [u32; 2], depth: u32) -> Option<Cell> {
    let mut level = 0;
    while (0..2).any(|a| (last[a] >> level) - (first[a] >> level) >= MOST_CELLS) {
        level += 1;
    }
    let mut found = None;
    for y in first[1] >> level..=last[1] >> level {
        for x in first[0] >> level..=last[0] >> level {
            let cell = pyramid.levels[level as usize][((y << (pyramid.log2_cells - level)) + x) as usize];
            if cell.least != NONE && u32::from(cell.least) <= depth {
                found = Some(found.map_or(cell, |f: Cell| f.union(cell)));
            }
        }
    }
    found
}
