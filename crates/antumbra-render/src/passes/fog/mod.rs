//! Sunlight in the air: fog that is the same everywhere, and the shafts of light and shadow in it.
//!
//! Light is scattered once. A bake says exactly which parts of a view ray the sun reaches, so nothing is marched and no
//! number of steps shows: the fog between two crossings of a shadow's border is integrated in closed form.

pub(crate) mod reference;

use crate::RenderError;

/// Fog that is the same everywhere within the scene's size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fog {
    /// Share of light that a metre of it takes out of a ray, all of which it scatters.
    pub density_per_m: f64,
    /// Henyey and Greenstein's g: 0 scatters to all sides, towards 1 ever more forwards.
    pub anisotropy: f64,
}

impl Fog {
    pub(crate) fn check(&self) -> Result<(), RenderError> {
        let dense = self.density_per_m.is_finite() && self.density_per_m > 0.0;
        if dense && self.anisotropy.abs() < 1.0 { Ok(()) } else { Err(RenderError::Fog(self.density_per_m)) }
    }
}

/// What fog does to a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Veil {
    /// Radiance of the fog before it.
    pub light: glam::Vec3,
    /// Share of its own light that comes through.
    pub clear: f32,
}

impl Veil {
    /// No fog.
    pub const NONE: Self = Self { light: glam::Vec3::ZERO, clear: 1.0 };

    /// A sample's light behind the fog.
    pub fn over(self, light: glam::Vec3) -> glam::Vec3 {
        light * self.clear + self.light
    }
}
