//! Lights with a surface: screens, lanterns, a whole sky; and how their soft shadows in fog are computed.
//!
//! An area light is sampled as many virtual point lights (VPLs), and from there on nothing knows what it was. Each VPL gets
//! a voxelized shadow volume: see `passes/ivsv`. [`AreaTechnique::Traced`] is the truth that they are compared with.

mod emission;
mod light;
mod showing;

pub use antumbra_scene::AreaShape;
pub use emission::Emission;
pub use light::AreaLight;
pub(crate) use light::{LightPoint, Vpl, sampled};
pub use showing::Showing;

use crate::RenderError;

/// How the light of area lights is computed.
#[derive(Clone, Debug, PartialEq)]
pub struct AreaLighting {
    /// The lights.
    pub lights: Vec<AreaLight>,
    /// How their shadows are found.
    pub technique: AreaTechnique,
    /// Virtual point lights, 1 to 1024, shared out among the lights by their power; rays per sample when traced.
    pub vpls: u32,
    /// How finely the VPLs' shadows are sampled.
    pub voxels: VoxelResolution,
    /// How the light of the fog is integrated.
    pub airlight: Airlight,
    /// How shadows are interpolated between voxels.
    pub interpolation: Interpolation,
    /// Which pixels gather what.
    pub gathering: Gathering,
    /// Most bytes of shadows at a time: VPLs whose shadows need more come in batches. One VPL's are there in any case.
    pub budget_bytes: u64,
}

/// How shadows of area lights are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AreaTechnique {
    /// Not at all: everything is lit.
    None,
    /// Imperfect voxelized shadow volumes: Wyman and Dai (2013).
    #[default]
    Voxels,
    /// The same, one VPL after the other, each with passes of its own: what Wyman and Dai compare theirs with. The same
    /// picture, slowly.
    OneByOne,
    /// No voxels: view rays look up each VPL's shadow map step by step, as often as a texel has bits.
    MarchedMaps,
    /// One shadow ray for each of many points of the light and of the view ray: the truth, but for noise.
    Traced,
}

/// Which samples of a picture gather the light of which VPLs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Gathering {
    /// All of all.
    #[default]
    Full,
    /// Each of 3 x 3 neighbouring pixels that of a ninth; then they share what they found with those that show the same.
    Interleaved,
    /// All, for one of 2 x 2 pixels; then those beside it take what those found that show the same.
    Half,
}

/// How shadows are interpolated between voxels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Interpolation {
    /// Not at all: the nearest voxel.
    None,
    /// Between planes and bits, as one would write it.
    Plain,
    /// The same by few instructions, for graphics cards: Wyman and Dai (2013, appendix A).
    #[default]
    Fast,
}

/// How the light that fog scatters is integrated along a view ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Airlight {
    /// Exactly, over each lit stretch of the ray.
    #[default]
    Exact,
    /// All of it times the share of the ray that is lit, as Wyman and Dai (2013, section 3.1.5) do.
    Average,
}

/// Samples of one VPL's shadows along each axis: 32 to 512, multiples of 32.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VoxelResolution {
    /// Texels per side of the shadow map.
    pub map: u32,
    /// Angles at the eye between its ray and the light.
    pub alpha: u32,
    /// Planes through the eye and the light.
    pub theta: u32,
    /// Angles at the light between its ray and the eye: one bit each.
    pub phi: u32,
    /// Points of the scene that are drawn into each shadow map, 256 to 1048576.
    pub points: u32,
}

impl VoxelResolution {
    /// The same number on every axis.
    #[must_use]
    pub fn cube(side: u32) -> Self {
        Self { map: side, alpha: side, theta: side, phi: side, points: side * side / 2 }
    }

    /// Bytes of one VPL's shadows: its map, its light rays' thresholds and its voxels (in whole texels of 128 bits).
    #[must_use]
    pub fn bytes(&self) -> u64 {
        let [map, alpha, theta, phi] = [self.map, self.alpha, self.theta, self.phi].map(u64::from);
        4 * map * map + 4 * theta * phi + 16 * alpha * theta * phi.div_ceil(128)
    }
}

impl Default for VoxelResolution {
    fn default() -> Self {
        Self::cube(128)
    }
}

/// Memory for shadows unless asked for otherwise: those of 256 VPLs of 128 samples along each axis.
const BUDGET_BYTES: u64 = 128 << 20;

impl AreaLighting {
    /// These lights with 256 VPLs of 128 samples along each axis.
    #[must_use]
    pub fn new(lights: Vec<AreaLight>) -> Self {
        Self {
            lights,
            technique: AreaTechnique::default(),
            vpls: 256,
            voxels: VoxelResolution::default(),
            airlight: Airlight::default(),
            interpolation: Interpolation::default(),
            gathering: Gathering::default(),
            budget_bytes: BUDGET_BYTES,
        }
    }

    /// VPLs at a time.
    pub(crate) fn batch(&self) -> u32 {
        let fit = (self.budget_bytes / self.voxels.bytes()).clamp(1, u64::from(self.vpls)) as u32;
        if self.technique == AreaTechnique::OneByOne { 1 } else { fit }
    }

    pub(crate) fn check(&self) -> Result<(), RenderError> {
        let within = |name, value: u32, least, most| {
            if (least..=most).contains(&value) {
                Ok(())
            } else {
                Err(RenderError::Samples { name, value, least, most })
            }
        };
        within("vpls", self.vpls, 1, 1024)?;
        let VoxelResolution { map, alpha, theta, phi, points } = self.voxels;
        for (name, value) in [("map", map), ("alpha", alpha), ("theta", theta), ("phi", phi)] {
            within(name, value, 32, 512)?;
            if !value.is_multiple_of(32) {
                return Err(RenderError::AreaLight(format!("its {name} resolution is not a multiple of 32")));
            }
        }
        within("points", points, 256, 1 << 20)?;
        self.lights.iter().try_for_each(AreaLight::check)
    }
}
