//! A light's grid about a point: what lies so many texels aside and so many slices along.

use antumbra::{DepthDistribution, LightKind, LightShadow, VoxelFrame};
use glam::DVec3;

/// log2 of the steps per side of the lattice on which a bake's vertices lie, across the light: see `docs/format.md`.
const LATTICE_LOG2: i32 = 26;
/// The same along a light, over the whole range of its depths.
const DEPTH_LATTICE_LOG2: i32 = 32;
/// By how much more than a slice a bake's depths may be off, slices, if its slices are all as deep: two lattice steps at
/// the finest resolution, and as much again.
const SLACK_SLICES: f64 = 1.0 / 2048.0;

/// The grid about a point.
pub struct Grid {
    center_world: DVec3,
    frame: VoxelFrame,
    local: Option<Local>,
    to_texel_center: [f64; 2],
    /// See [`Grid::lattice_step_texels`].
    lattice_step_texels: f64,
}

/// A local light's grid spreads from its place: all points of a ray lie in one texel.
struct Local {
    position_world: DVec3,
    /// A slice's height over its depth.
    slice_share: f64,
    is_ndc: bool,
    slack_slices: f64,
}

impl Grid {
    pub fn new(light: LightShadow<'_>, center_world: DVec3) -> Self {
        let frame = light.frame(center_world);
        let record = light.record();
        let voxel = light.project(center_world).voxel;
        Self {
            center_world,
            frame,
            local: (light.kind() != LightKind::Directional).then(|| Local::new(light, &frame)),
            to_texel_center: [voxel.x, voxel.y].map(|v| v.floor() + 0.5 - v),
            lattice_step_texels: 2_f64.powi(record.log2_resolution as i32 - LATTICE_LOG2),
        }
    }

    /// From the point so many texels to the right and down, and so many slices away from the light.
    pub fn point(&self, [right, down]: [f64; 2], slices: f64) -> DVec3 {
        let aside = (self.frame.right * right + self.frame.down * down) * self.frame.texel_m;
        match &self.local {
            None => self.center_world + aside + self.frame.along * (slices * self.frame.slice_m),
            Some(local) => {
                let offset = self.center_world - local.position_world + aside;
                local.position_world + offset * local.depth_ratio(slices)
            }
        }
    }

    /// What lies a slice before the point or behind it must count as being there; and so must a little more.
    pub fn slice_and_slack(&self) -> f64 {
        1.0 + self.local.as_ref().map_or(SLACK_SLICES, |local| local.slack_slices)
    }

    /// From the point to the middle of its texel: texels to the right and down.
    pub fn to_texel_center(&self) -> [f64; 2] {
        self.to_texel_center
    }

    /// A step of the lattice across the light, texels.
    pub fn lattice_step_texels(&self) -> f64 {
        self.lattice_step_texels
    }
}

impl Local {
    /// Depth z of a local light is 1 - near/z on the lattice: a step is z^2 / near over 2^32. That is far less than a
    /// slice but where slices are very thin far away. A vertex is off by half a step, where a slice begins by one more.
    fn new(light: LightShadow<'_>, frame: &VoxelFrame) -> Self {
        let record = light.record();
        let depth = frame.texel_m * record.texels_per_tangent;
        let lattice_step_m = depth * depth / record.near_m * 2_f64.powi(-DEPTH_LATTICE_LOG2);
        Self {
            position_world: light.origin_world(),
            slice_share: frame.slice_m / depth,
            is_ndc: record.depth_distribution() == Some(DepthDistribution::Ndc),
            slack_slices: SLACK_SLICES + 2.0 * lattice_step_m / frame.slice_m,
        }
    }

    /// The depth so many slices farther on, in parts of the depth here.
    fn depth_ratio(&self, slices: f64) -> f64 {
        let shares = slices * self.slice_share;
        // Normalized device coordinates end at infinity: far beyond the range will do.
        if self.is_ndc { 1.0 / (1.0 - shares).max(1.0 / 64.0) } else { shares.exp() }
    }
}
