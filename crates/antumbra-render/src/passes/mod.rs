//! The renderer's passes, in the order the data flows: what is seen, which lights reach it, how much of the rest of
//! the world's light does, what that looks like, and what a screen makes of it.
//!
//! Each pass has a folder: its data in `mod.rs`, and `reference.rs`, which computes it on the CPU one row of pixels
//! at a time. Rows depend on nothing but earlier passes, so that any number of threads makes the same picture.

pub(crate) mod ambient;
pub mod csm;
pub mod culling;
pub(crate) mod fog;
pub(crate) mod gbuffer;
pub(crate) mod ivsv;
pub mod lamp_maps;
pub(crate) mod shade;
pub(crate) mod shadow;
pub(crate) mod tonemap;

mod world;

#[cfg(feature = "gpu")]
pub(crate) use shadow::baked_light;
pub(crate) use world::{Lighting, World, lamplit};
