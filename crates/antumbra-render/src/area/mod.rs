//! Lights with a surface: screens, lanterns, a whole sky; and how their soft shadows in fog are computed.
//!
//! An area light is sampled as many virtual point lights (VPLs), and from there on nothing knows what it was. Each VPL gets
//! a voxelized shadow volume: see `passes/ivsv`. [`AreaTechnique::Traced`] is the truth that they are compared with.

mod emission;
mod light;

pub use emission::Emission;
pub use light::{AreaLight, AreaShape};
pub(crate) use light::{LightPoint, Vpl, sampled};

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
    /// Whether shadows are interpolated between voxels.
    pub interpolate: bool,
}

/// How shadows of area lights are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AreaTechnique {
    /// Not at all: everything is lit.
    None,
    /// Imperfect voxelized shadow volumes: Wyman and Dai (2013).
    #[default]
    Voxels,
    /// One shadow ray for each of many points of the light and of the view ray: the truth, but for noise.
    Traced,
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

/// Samples of one VPL's shadows along each axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VoxelResolution {
    /// Texels per side of the shadow map, 32 to 512.
    pub map: u32,
    /// Angles at the eye between its ray and the light, 32 to 512.
    pub alpha: u32,
    /// Planes through the eye and the light, 32 to 512.
    pub theta: u32,
    /// Angles at the light between its ray and the eye, 32 to 512, a multiple of 32: one bit each.
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
}

impl Default for VoxelResolution {
    fn default() -> Self {
        Self::cube(128)
    }
}

/// Most memory for voxels, all VPLs together: 4 GiB.
const MOST_BYTES: u64 = 4 << 30;

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
            interpolate: true,
        }
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
        }
        within("points", points, 256, 1 << 20)?;
        if !phi.is_multiple_of(32) {
            return Err(RenderError::AreaLight("its phi resolution is not a multiple of 32".to_owned()));
        }
        let bytes = u64::from(self.vpls) * u64::from(alpha) * u64::from(theta) * u64::from(phi) / 8;
        if self.technique == AreaTechnique::Voxels && bytes > MOST_BYTES {
            let words =
                format!("its voxels take {bytes} bytes, more than {MOST_BYTES}: give fewer VPLs, or fewer voxels");
            return Err(RenderError::AreaLight(words));
        }
        self.lights.iter().try_for_each(AreaLight::check)
    }
}
