//! Bakes a scene and its lights into Antumbra's shadow bytes.
//!
//! Data flows through the folders in this order: [`casters`] (which triangles cast, which bound solids) →
//! [`light_space`] (a light's grid, and vertices on its fixed-point lattice) → [`columns`] (the builder) → [`dag`]
//! (hash-consed nodes, canonical order, words) → bytes ([`antumbra::format`]). [`oracle`] answers the same questions
//! slowly and exactly, and everything is tested against it.
//!
//! A light's shadow is a height field with slack: voxel (x, y, z) is lit iff z < t(x, y), and t may be anything from
//! the ray's enter depth to its exit depth. Open geometry has enter = exit; the inside of a solid only widens the
//! interval.
//!
//! Sources: Sintorn, Kämpe, Olsson, Assarsson 2014, *Compact precomputed voxelized shadows*; Kämpe, Sintorn, Assarsson
//! 2015, *Fast, memory-efficient construction of voxelized shadows*.

#![forbid(unsafe_code)]

pub mod ablation;
mod bake;
mod baseline;
pub mod casters;
pub mod columns;
pub mod dag;
pub mod light_space;
mod lights;
pub mod oracle;
mod pause;
pub mod place;
mod silhouette;
mod stepped;

pub use antumbra::Encoding;
pub use bake::{BakeError, BakeOptions, Baked, LightReport, Method, Progress, ResolutionRequest, Silent, Stage, bake};
pub use casters::{Blend, Inverted};
pub use pause::{Pause, never_pause};
pub use stepped::{Step, SteppedBaker};
