//! The orthographic grid of a directional light, fitted to the casters.

use antumbra::{LightKind, LightRecord};
use glam::{DMat3, DVec2, DVec3};

use super::{DEPTH_BITS, LATERAL_BITS, Resolution};

/// Axes and extent of a directional light's grid. Texels are square; slices have a size of their own.
///
/// Across the light the grid is the least square about the casters. Along it the casters take slices 1 to N-2: slice 0
/// stays lit, and slice N-1 lies behind every caster, so that it answers for everything behind the grid. So lookups
/// outside the grid are exact and receivers need no room in it.
#[derive(Clone, Copy, Debug)]
pub struct DirectionalSpace {
    resolution: Resolution,
    /// World point that is subtracted first.
    origin_world: DVec3,
    /// Unit axes in the world: right, down, along the light; right-handed.
    axes: [DVec3; 3],
    /// Light-space metres of the grid's corner, relative to the origin.
    corner_m: DVec3,
    texel_size_m: f64,
    slice_size_m: f64,
}

/// Slices before the nearest caster and behind the farthest one's own slice.
const MARGIN_SLICES: f64 = 1.0;

impl DirectionalSpace {
    /// Unit axes (right, down, along the light) for a direction of travel. Plain arithmetic and square roots only: the
    /// same bits on every machine.
    #[must_use]
    pub fn axes(direction_world: DVec3) -> [DVec3; 3] {
        // Scaled first, so that squares neither overflow nor vanish.
        let scaled = direction_world / direction_world.abs().max_element();
        let along = scaled / scaled.dot(scaled).sqrt();
        let helper = if along.y.abs() < 0.99 { DVec3::Y } else { DVec3::Z };
        let right = along.cross(helper);
        let right = right / right.dot(right).sqrt();
        [right, right.cross(along) * -1.0, along]
    }

    /// Least and greatest light-space coordinates of points relative to an origin.
    pub fn extent(axes: &[DVec3; 3], origin_world: DVec3, points: impl Iterator<Item = DVec3>) -> [DVec3; 2] {
        let mut extent = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        for point in points {
            let p = to_light(axes, point - origin_world);
            extent = [extent[0].min(p), extent[1].max(p)];
        }
        extent
    }

    /// The side of the least square about an extent, metres; never zero.
    #[must_use]
    pub fn side_m([min, max]: [DVec3; 2]) -> f64 {
        let size = max - min;
        // A lone edge-on triangle has no width, a single point no size: any positive width serves.
        let greatest = size.max_element();
        let least = if greatest > 0.0 { 1e-6 * greatest } else { 1e-9 };
        size.x.max(size.y).max(least)
    }

    /// Fits the grid to an extent made by [`DirectionalSpace::extent`].
    #[must_use]
    pub fn fit(axes: [DVec3; 3], origin_world: DVec3, extent: [DVec3; 2], resolution: Resolution) -> Self {
        let n = f64::from(resolution.texels());
        let side = Self::side_m(extent);
        let depth = (extent[1].z - extent[0].z).max(1e-6 * side);
        let slice_size_m = depth / (n - 2.0 * MARGIN_SLICES - 1.0);
        let middle = (extent[0] + extent[1]) * 0.5;
        let near = extent[0].z - MARGIN_SLICES * slice_size_m;
        Self {
            resolution,
            origin_world,
            axes,
            corner_m: DVec3::new(middle.x - 0.5 * side, middle.y - 0.5 * side, near),
            texel_size_m: side / n,
            slice_size_m,
        }
    }

    /// The grid's resolution.
    #[must_use]
    pub fn resolution(&self) -> Resolution {
        self.resolution
    }

    /// Rounds a world point to the lattice: x, y in 0..=2^26, depth in 0..2^32.
    #[must_use]
    pub fn snap(&self, world: DVec3) -> ([i32; 2], u32) {
        let p = to_light(&self.axes, world - self.origin_world) - self.corner_m;
        let n = f64::from(self.resolution.texels());
        let lateral = (1u64 << LATERAL_BITS) as f64;
        let depth = (1u64 << DEPTH_BITS) as f64;
        let across = |m: f64| (m / (self.texel_size_m * n) * lateral + 0.5).floor().clamp(0.0, lateral) as i32;
        let along = (p.z / (self.slice_size_m * n) * depth + 0.5).floor().clamp(0.0, depth - 1.0) as u32;
        ([across(p.x), across(p.y)], along)
    }

    /// Depth of a slice, metres.
    #[must_use]
    pub fn slice_size_m(&self) -> f64 {
        self.slice_size_m
    }

    /// A world point across the light, in real-valued lattice steps.
    #[must_use]
    pub fn lattice_point(&self, world: DVec3) -> DVec2 {
        let p = to_light(&self.axes, world - self.origin_world) - self.corner_m;
        DVec2::new(p.x, p.y) / self.texel_size_m * self.resolution.texel_steps() as f64
    }

    /// The light's record but for its name, policy and root.
    #[must_use]
    pub fn record(&self) -> LightRecord {
        let scale = DVec3::new(self.texel_size_m, self.texel_size_m, self.slice_size_m).recip();
        // The record's origin is the grid's centre, so that coordinates relative to it are small.
        let half_m = DVec3::new(self.texel_size_m, self.texel_size_m, self.slice_size_m)
            * (0.5 * f64::from(self.resolution.texels()));
        let origin = self.origin_world + from_light(&self.axes, self.corner_m + half_m);
        let rows = [self.axes[0] * scale.x, self.axes[1] * scale.y, self.axes[2] * scale.z];
        let corner = self.origin_world - origin;
        let offset = to_light(&self.axes, corner) + self.corner_m;
        LightRecord {
            kind: LightKind::Directional as u32,
            log2_resolution: self.resolution.log2(),
            faces: 1,
            texel_size_m: self.texel_size_m,
            slice_size_m: self.slice_size_m,
            origin_world: origin.to_array(),
            linear: rows.map(|r| r.to_array()),
            voxel_of_origin: (offset * scale * -1.0).to_array(),
            direction_world: self.axes[2].to_array(),
            ..bytemuck::Zeroable::zeroed()
        }
    }
}

fn to_light(axes: &[DVec3; 3], offset: DVec3) -> DVec3 {
    DVec3::new(axes[0].dot(offset), axes[1].dot(offset), axes[2].dot(offset))
}

fn from_light(axes: &[DVec3; 3], p: DVec3) -> DVec3 {
    DMat3::from_cols(axes[0], axes[1], axes[2]) * p
}
