//! Imperfect voxelized shadow volumes: soft shadows of area lights on surfaces and in fog, nothing precomputed.
//!
//! Wyman and Dai (2013), "Imperfect Voxelized Shadow Volumes", on Wyman (2011), "Voxelized Shadow Volumes", and Ritschel et
//! al. (2008), "Imperfect Shadow Maps for Efficient Computation of Indirect Illumination".
//!
//! ```text
//! area lights -> VPLs -> [ splat -> rectify -> scan ] for each VPL -> gather
//!                          points   thresholds voxels                pixels
//! ```
//!
//! Each VPL has an epipolar space (`epipolar.rs`): planes through the eye and the light, numbered by the angle theta about
//! the line between them; in a plane, eye rays by the angle alpha at the eye and light rays by the angle phi at the light. A
//! texel (alpha, theta) holds one bit per phi: all shadows along an eye ray lie in one texel. Along a light ray alpha grows,
//! and shadow begins at one place: so a light ray is one *threshold*, and the scan expands thresholds to bits.
//!
//! Departures from the paper: points are chosen by the solid angle in which lights see what they stand for (`cloud.rs`, its
//! future work), and drawn as discs that end where their neighbourhood does, so that holes are few and are filled when maps
//! are read, not by push and pull, which makes shadows grow; rectifying stores thresholds, a quarter of the voxels' memory, and needs no atomics; airlight is
//! integrated exactly over lit stretches (`airlight.rs`).

pub(crate) mod airlight;
pub(crate) mod cloud;
pub(crate) mod epipolar;
pub(crate) mod filter;
pub(crate) mod gather;
pub(crate) mod rectify;
pub(crate) mod reference;
pub(crate) mod scan;
pub(crate) mod splat;
pub(crate) mod traced;

#[cfg(test)]
pub(crate) mod tests;

use std::f32::consts::PI;

use glam::Vec3;

use crate::passes::shade;
use crate::surface::Surface;

/// What area lights do to a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct AreaLit {
    /// Light that its surface gets, times the cosine of where it comes from.
    pub irradiance: Vec3,
    /// What the surface mirrors of it towards the eye.
    pub glossy: Vec3,
    /// What fog before it scatters towards the eye.
    pub airlight: Vec3,
}

impl AreaLit {
    /// Adds light that falls on a surface: its irradiance at right angles.
    pub fn receive(&mut self, surface: &Surface, towards: Vec3, irradiance: Vec3) {
        let irradiance = irradiance * shade::reference::incidence(surface, towards);
        self.irradiance += irradiance;
        self.glossy += shade::reference::highlight(surface, towards) * irradiance;
    }

    /// What a surface sends to the eye of it.
    pub fn reflected(&self, surface: &Surface) -> Vec3 {
        surface.albedo * (1.0 - surface.metallic) / PI * self.irradiance + self.glossy
    }
}
