//! Exact, compact, precomputed shadows: the runtime.
//!
//! A `.antumbra` file answers one question for any point of a scene: *does this light reach it?* This crate reads and
//! validates such files and answers point lookups, segment lookups and percentage-closer filtering (PCF) on the CPU. It is
//! what a game ships: no unsafe code, no I/O, `no_std` with `alloc` when the `std` feature is off.
//!
//! ```no_run
//! use antumbra::{Filter, ShadowFile};
//! use glam::DVec3;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let file = ShadowFile::from_bytes(&std::fs::read("city.antumbra")?)?;
//! let sun = file.light("sun").ok_or("the file has no light named sun")?;
//! let point = DVec3::new(10.0, 1.5, -4.0);
//! let hard = sun.visibility(point); // 0 = shadowed, 1 = lit
//! let soft = sun.filtered(point, Some(DVec3::Y), Filter::new_tent(9)?);
//! # let _ = (hard, soft); Ok(()) }
//! ```
//!
//! # The structure
//! The light's volume is an N x N x N grid of voxels: a texel (x, y) is a light ray, slice 0 is nearest the light.
//! Voxel (x, y, z) is lit iff `z < t(x, y)`. The grid is stored as a directed acyclic graph of octree nodes whose
//! leaves are flat 8 x 8 x 1 visibility masks: Sintorn, Kämpe, Olsson, Assarsson 2014, *Compact precomputed voxelized
//! shadows*. The bytes are described in [`format`](mod@format).

#![cfg_attr(not(feature = "std"), no_std)]
#![forbid(unsafe_code)]

extern crate alloc;

mod error;
pub mod format;
pub mod lookup;
pub mod shaders;

pub use error::{FilterError, FormatError};
pub use format::file::ShadowFile;
pub use format::light::{DepthDistribution, Encoding, Interior, LightKind, LightRecord};
pub use lookup::blocker::Blocker;
pub use lookup::filter::{Filter, Kernel};
pub use lookup::light::LightShadow;
pub use lookup::prefilter::Prefilter;
pub use lookup::project::{FACE_BORDER, FacePoint, VoxelFrame};
pub use lookup::segment::{Run, Segment};
