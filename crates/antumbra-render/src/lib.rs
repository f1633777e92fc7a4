//! Antumbra's renderer.
//!
//! [`trace`] is world-space ray tracing, exact about what is hit: the ground truth that bakes are compared with.

pub mod trace;

pub use trace::{Hit, Ray, Source, Tracer, TriangleId};
