//! One light of a file, and the lookups that it answers.

use glam::DVec3;

use super::continuous;
use super::filter::{Filter, Kernel};
use super::many;
use super::pcf;
use super::point::is_lit;
use super::project::{FacePoint, Place, Projection, VoxelFrame, clamp_to_volume};
use super::top_grid::TopGrid;
use super::window::Slice;
use crate::format::slices::Spread;
use crate::{Encoding, Interior, LightKind, LightRecord, ShadowFile};

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

    /// Where the light stands in the file's order, from 0.
    #[must_use]
    pub fn index(self) -> usize {
        self.index
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

    /// Unit direction along which the light travels, world space; zero for a point light.
    #[must_use]
    pub fn direction_world(self) -> DVec3 {
        DVec3::from_array(self.record().direction_world)
    }

    /// Where a local light stands, or the middle of a directional light's volume: world, metres.
    #[must_use]
    pub fn origin_world(self) -> DVec3 {
        DVec3::from_array(self.record().origin_world)
    }

    /// Faces of the light's volume: 1, or 6 for point lights and wide spot lights.
    #[must_use]
    pub fn faces(self) -> usize {
        self.record().faces as usize
    }

    /// The face that sees a world point, and real-valued voxel coordinates on it.
    #[inline]
    #[must_use]
    pub fn project(self, point_world: DVec3) -> FacePoint {
        self.projection().project(point_world)
    }

    /// The world point with real-valued voxel coordinates on a face: the inverse of [`LightShadow::project`], on whose
    /// face the point need not lie. `None` where there is none.
    #[must_use]
    pub fn unproject(self, at: FacePoint) -> Option<DVec3> {
        self.projection().unproject(at)
    }

    /// Whether a world point lies outside a spot light's cone: lookups there give 0.
    #[inline]
    #[must_use]
    pub fn is_outside_cone(self, point_world: DVec3) -> bool {
        self.projection().is_outside_cone(point_world)
    }

    /// Axes and size of the light's voxels about a world point.
    #[must_use]
    pub fn frame(self, point_world: DVec3) -> VoxelFrame {
        self.projection().frame(point_world)
    }

    /// Visibility at a world point, metres: 0 shadowed, 1 lit. A point that is not finite is lit; one outside a spot
    /// light's cone is not.
    ///
    /// Cost: a projection, one read of the top grid and at most log2(N) - 5 dependent reads of two words each.
    #[inline]
    #[must_use]
    pub fn visibility(self, point_world: DVec3) -> f32 {
        match self.projection().place(point_world) {
            Place::Lit => 1.0,
            Place::Unlit => 0.0,
            Place::At { face, voxel } => f32::from(self.is_lit(face, voxel)),
        }
    }

    /// [`LightShadow::visibility`] of many points: the same answers, up to three times as many per second, because
    /// several descents run side by side. Writes as many answers as both slices have room for.
    pub fn visibility_many(self, points_world: &[DVec3], visibility: &mut [f32]) {
        let places = points_world.iter().map(|p| self.projection().place(*p));
        let (pool, grids) = (&self.file.pool, &self.file.top_grids[self.index]);
        if self.is_silhouette() {
            many::visibility_of_silhouettes(pool, grids, self.spread(), places, visibility);
        } else {
            many::visibility(pool, grids, places, visibility);
        }
    }

    /// Visibility at real-valued voxel coordinates of a face; cones do not count.
    #[inline]
    #[must_use]
    pub fn voxel_visibility(self, at: FacePoint) -> f32 {
        let side = f64::from(self.record().resolution());
        clamp_to_volume(at.voxel, side).map_or(1.0, |voxel| f32::from(self.is_lit(at.face, voxel)))
    }

    /// Whether a voxel of a face is lit; indices are less than the resolution (only their low bits count).
    ///
    /// # Panics
    /// When the light has no such face.
    #[inline]
    #[must_use]
    pub fn is_lit(self, face: usize, voxel: [u32; 3]) -> bool {
        let mask = self.record().resolution() - 1;
        let voxel = voxel.map(|c| c & mask);
        let grid = self.top_grid(face);
        if self.is_silhouette() {
            let [x, y, z] = voxel;
            let slice = || Slice::new(&self.file.pool, z, 0, self.spread());
            let settled = grid.settled(0, [x, y], z);
            return settled.unwrap_or_else(|| slice().is_lit(grid.node(voxel), grid.level, [x, y]));
        }
        is_lit(&self.file.pool, grid.node(voxel), grid.level, voxel)
    }

    /// Filtered visibility (percentage-closer filtering, K x K taps at the point's own depth): 0 to 1.
    ///
    /// With a unit surface normal (world space) the sample first moves off the surface, just far enough that a plane
    /// with that normal does not shadow itself under any tap; where geometry is closed a single tap needs none.
    /// Taps outside the volume sideways count as lit; taps across the edge of a cube's face see what lies there, and taps
    /// outside a spot light's cone what casts there. Cost: two to four point lookups for 9 x 9 taps, at most 4 masks (9
    /// for 17 x 17).
    #[inline]
    #[must_use]
    pub fn filtered(self, point_world: DVec3, normal_world: Option<DVec3>, filter: Filter) -> f32 {
        if self.is_outside_cone(point_world) {
            return 0.0;
        }
        let point = normal_world.map_or(point_world, |n| point_world + n * self.bias_m(point_world, n, filter));
        self.voxel_filtered(self.project(point), filter)
    }

    /// Filtered visibility at real-valued voxel coordinates of a face, without bias; cones do not count.
    #[inline]
    #[must_use]
    pub fn voxel_filtered(self, at: FacePoint, filter: Filter) -> f32 {
        if filter.kernel() == Kernel::Continuous {
            return self.voxel_continuous(at);
        }
        if filter.taps() == 1 {
            return self.voxel_visibility(at);
        }
        pcf::filtered(self.source(at.face), self.record().resolution(), at.voxel, filter)
    }

    /// Visibility at real-valued voxel coordinates of a face by the edges and planes of silhouettes, at these coordinates themselves rather
    /// than in the middle of their voxel: 0 or 1; cones do not count. Of the encoding `dag8` that of the voxel. See [`Filter::continuous`].
    #[must_use]
    pub fn voxel_continuous(self, at: FacePoint) -> f32 {
        if !self.is_silhouette() || clamp_to_volume(at.voxel, f64::from(self.record().resolution())).is_none() {
            return self.voxel_visibility(at);
        }
        f32::from(continuous::is_lit(&self.file.pool, self.top_grid(at.face), at.voxel, self.spread()))
    }

    /// How far along a unit normal a filtered lookup moves off its surface, metres: see [`LightShadow::filtered`].
    ///
    /// A plane of normal n rises by |n_x| + |n_y| over |n_z| in depth from the middle of a unit square to its corner,
    /// so a step of half the filter's width times |n_x| + |n_y| clears every tap (n in the axes of the light's face, the
    /// width as it is at the point's depth: all taps share a depth, so the same holds in perspective). The papers
    /// step half a width for every normal (Kämpe et al. 2015, section 4): too little for diagonal slopes, too much
    /// for surfaces that face the light.
    #[must_use]
    pub fn bias_m(self, point_world: DVec3, normal_world: DVec3, filter: Filter) -> f64 {
        let frame = self.frame(point_world);
        let lateral = frame.right.dot(normal_world).abs() + frame.down.dot(normal_world).abs();
        (0.5 * f64::from(filter.taps()) + SNAP_BIAS_TEXELS) * frame.texel_m * lateral + 0.5 * frame.slice_m
    }

    /// Depth along the axis of a face, metres, at a real-valued slice: from the light, or from the volume's first slice.
    pub(crate) fn depth_of_slice(self, slice: f64) -> f64 {
        self.projection().depth_of_slice(slice)
    }

    /// Whether rays spread from a point.
    pub(crate) fn is_local(self) -> bool {
        self.kind() != LightKind::Directional
    }

    /// Whether its nodes are of the encoding [`silhouette`](crate::format::silhouette).
    #[inline(always)]
    pub(crate) fn is_silhouette(self) -> bool {
        self.record().encoding == Encoding::Silhouette as u32
    }

    /// How its slices follow one another, for planes.
    #[inline(always)]
    pub(crate) fn spread(self) -> Spread<'a> {
        Spread::new(self.record().resolution(), &self.file.slices[self.index])
    }

    /// The nodes of a face.
    pub(crate) fn source(self, face: usize) -> pcf::Source<'a> {
        let silhouette = self.is_silhouette().then(|| (0, self.spread()));
        pcf::Source { pool: &self.file.pool, grid: self.top_grid(face), silhouette }
    }

    pub(crate) fn projection(self) -> &'a Projection {
        &self.file.projections[self.index]
    }

    pub(crate) fn top_grid(self, face: usize) -> &'a TopGrid {
        &self.file.top_grids[self.index][face]
    }
}
