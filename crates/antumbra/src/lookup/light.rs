//! One light of a file, and the lookups that it answers.

use glam::DVec3;

use super::filter::Filter;
use super::many;
use super::pcf;
use super::point::is_lit;
use super::top_grid::TopGrid;
use crate::{Interior, LightKind, LightRecord, ShadowFile};

/// A light of a [`ShadowFile`]. Cheap to copy.
#[derive(Clone, Copy, Debug)]
pub struct LightShadow<'a> {
    pub(crate) file: &'a ShadowFile,
    pub(crate) index: usize,
}

/// Extra bias beside the filter's half width, in texels: swallows the snapping of vertices to the bake's lattice.
const SNAP_BIAS_TEXELS: f64 = 1.0 / 16.0;

impl<'a> LightShadow<'a> {
    /// The light's name.
    #[must_use]
    pub fn name(self) -> &'a str {
        self.file.name(self.index)
    }

    /// The light's record: placement, resolution, policy.
    #[must_use]
    pub fn record(self) -> &'a LightRecord {
        &self.file.records[self.index]
    }

    /// The light's kind.
    #[must_use]
    pub fn kind(self) -> LightKind {
        self.record().light_kind().unwrap_or(LightKind::Directional)
    }

    /// Where the bake was free to choose.
    #[must_use]
    pub fn interior(self) -> Interior {
        self.record().interior_policy().unwrap_or(Interior::Open)
    }

    /// Unit direction along which the light travels, world space.
    #[must_use]
    pub fn direction_world(self) -> DVec3 {
        DVec3::from_array(self.record().direction_world)
    }

    /// Real-valued voxel coordinates of a world point.
    #[inline]
    #[must_use]
    pub fn voxel_from_world(self, point_world: DVec3) -> DVec3 {
        self.record().voxel_from_world(point_world)
    }

    /// Visibility at a world point, metres: 0 shadowed, 1 lit. A point that is not finite is lit.
    ///
    /// Cost: a projection, one read of the top grid and at most log2(N) - 5 dependent reads of two words each.
    #[inline]
    #[must_use]
    pub fn visibility(self, point_world: DVec3) -> f32 {
        self.voxel_visibility(self.voxel_from_world(point_world))
    }

    /// [`LightShadow::visibility`] of many points: the same answers, two to three times as many per second, because
    /// several descents run side by side. Writes as many answers as both slices have room for.
    pub fn visibility_many(self, points_world: &[DVec3], visibility: &mut [f32]) {
        let side = self.record().resolution();
        let voxels = points_world.iter().map(|p| clamp_to_volume(self.voxel_from_world(*p), side));
        many::visibility(&self.file.pool, self.top_grid(), voxels, visibility);
    }

    /// Visibility at real-valued voxel coordinates.
    #[inline]
    #[must_use]
    pub fn voxel_visibility(self, voxel: DVec3) -> f32 {
        let side = self.record().resolution();
        match clamp_to_volume(voxel, side) {
            Some(voxel) => f32::from(self.is_lit(voxel)),
            None => 1.0,
        }
    }

    /// Whether a voxel is lit; indices are less than the resolution (only their low bits count).
    #[inline]
    #[must_use]
    pub fn is_lit(self, voxel: [u32; 3]) -> bool {
        let mask = self.record().resolution() - 1;
        let voxel = voxel.map(|c| c & mask);
        let grid = self.top_grid();
        is_lit(&self.file.pool, grid.node(voxel), grid.level, voxel)
    }

    /// Filtered visibility (percentage-closer filtering, K x K taps at the point's own depth): 0 to 1.
    ///
    /// With a unit surface normal (world space) the sample first moves off the surface, just far enough that a plane
    /// with that normal does not shadow itself under any tap; where geometry is closed a single tap needs none.
    /// Taps outside the volume sideways count as lit. Cost: two to four point lookups for 9 x 9 taps, at most 4 masks (9
    /// for 17 x 17).
    #[inline]
    #[must_use]
    pub fn filtered(self, point_world: DVec3, normal_world: Option<DVec3>, filter: Filter) -> f32 {
        let point = normal_world.map_or(point_world, |n| point_world + n * self.bias_m(n, filter));
        self.voxel_filtered(self.voxel_from_world(point), filter)
    }

    /// Filtered visibility at real-valued voxel coordinates, without bias.
    #[inline]
    #[must_use]
    pub fn voxel_filtered(self, voxel: DVec3, filter: Filter) -> f32 {
        if filter.taps() == 1 {
            return self.voxel_visibility(voxel);
        }
        pcf::filtered(&self.file.pool, self.top_grid(), self.record().resolution(), voxel, filter)
    }

    /// How far along a unit normal a filtered lookup moves off its surface, metres: see [`LightShadow::filtered`].
    ///
    /// A plane of normal n rises by |n_x| + |n_y| over |n_z| in depth from the middle of a unit square to its corner,
    /// so a step of half the filter's width times |n_x| + |n_y| clears every tap (n in the light's axes). The papers
    /// step half a width for every normal (Kämpe et al. 2015, section 4): too little for diagonal slopes, too much
    /// for surfaces that face the light.
    #[must_use]
    pub fn bias_m(self, normal_world: DVec3, filter: Filter) -> f64 {
        let record = self.record();
        let [row_x, row_y, _] = record.voxel_from_offset.map(DVec3::from_array);
        let lateral = (row_x.dot(normal_world).abs() + row_y.dot(normal_world).abs()) * record.texel_size_m;
        let half_width_m = (0.5 * f64::from(filter.taps()) + SNAP_BIAS_TEXELS) * record.texel_size_m;
        half_width_m * lateral + 0.5 * record.slice_size_m
    }

    pub(crate) fn top_grid(self) -> &'a TopGrid {
        &self.file.top_grids[self.index]
    }
}

/// The voxel that holds a point of the volume; points behind the last slice take the last one. `None` sideways of or
/// before the volume, and for coordinates that are not numbers: lit.
#[inline(always)]
fn clamp_to_volume(voxel: DVec3, side: u32) -> Option<[u32; 3]> {
    let n = f64::from(side);
    let inside = voxel.x >= 0.0 && voxel.x < n && voxel.y >= 0.0 && voxel.y < n && voxel.z >= 0.0;
    // A cast of a non-negative number rounds down and saturates.
    inside.then(|| [voxel.x as u32, voxel.y as u32, (voxel.z as u32).min(side - 1)])
}
