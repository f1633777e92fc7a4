//! Imperfect voxelized shadow volumes: soft shadows of area lights on surfaces and in fog, nothing precomputed.
//!
//! Wyman and Dai (2013), "Imperfect Voxelized Shadow Volumes", on Wyman (2011), "Voxelized Shadow Volumes", and Ritschel et
//! al. (2008), "Imperfect Shadow Maps for Efficient Computation of Indirect Illumination".
//!
//! ```text
//! area lights -> VPLs -> [ splat -> fill -> rectify -> scan ] for each VPL -> gather
//!                          points   holes   thresholds voxels                 pixels
//! ```
//!
//! Each VPL has an epipolar space (`epipolar.rs`): planes through the eye and the light, numbered by the angle theta about
//! the line between them; in a plane, eye rays by the angle alpha at the eye and light rays by the angle phi at the light. A
//! texel (alpha, theta) holds one bit per phi: all shadows along an eye ray lie in one texel. Along a light ray alpha grows,
//! and shadow begins at one place: so a light ray is one *threshold*, and the scan expands thresholds to bits.
//!
//! Departures from the paper: points are chosen by the solid angle in which lights see what they stand for (`cloud.rs`, its
//! future work); rectifying stores thresholds, a quarter of the voxels' memory, and needs no atomics; airlight is
//! integrated exactly over lit stretches (`airlight.rs`).

pub(crate) mod airlight;
pub(crate) mod cloud;
pub(crate) mod epipolar;
pub(crate) mod gather;
pub(crate) mod rectify;
pub(crate) mod reference;
pub(crate) mod scan;
pub(crate) mod splat;
pub(crate) mod traced;

#[cfg(test)]
mod tests;

use glam::Vec3;

/// What area lights do to a sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct AreaLit {
    /// What the surface reflects of them towards the eye.
    pub reflected: Vec3,
    /// What fog before it scatters towards the eye.
    pub airlight: Vec3,
}
