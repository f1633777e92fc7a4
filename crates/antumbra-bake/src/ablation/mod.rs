//! Ablations: the papers' own alternatives to what the baker does, small and plain, to measure the difference.
//!
//! Nothing here is on the way from a scene to its bytes. [`Intervals`] are a light's exact per-texel intervals, from the
//! oracle. What is built from them goes top down, as in the papers, through [`octree`] and the baker's own tables and
//! encoder, so that bytes can be compared: with undefined regions resolved the way of 2014 and of 2015 ([`undefined`]),
//! and in world space instead of light space ([`world`]). [`cubic`] rewrites a finished pool with 4 x 4 x 4 leaves.
//!
//! Sources: Sintorn, Kämpe, Olsson, Assarsson 2014, *Compact precomputed voxelized shadows*; Kämpe, Sintorn, Assarsson
//! 2015, *Fast, memory-efficient construction of voxelized shadows*, sections 3.3 and 3.4.

pub mod cubic;
mod graph;
mod intervals;
pub mod octree;
mod pyramid;
pub mod undefined;
pub mod world;

pub use graph::Graph;
pub use intervals::Intervals;
