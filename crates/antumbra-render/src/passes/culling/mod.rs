//! Voxel culling: which triangles can cast a shadow from a light onto anything that is seen, found before the light's
//! shadow map is drawn.
//!
//! Selgrad, Müller, Reintges, Stamminger 2016, *Fast shadow map rendering for many-lights settings*. A coarse grid over the
//! scene holds each cell's triangles ([`Bins`]); the cells that what is seen lies in are *source cells* ([`Receivers`]). Whatever
//! lies between a source cell and a light lies in the convex hull of the two, a [`Beam`], so only triangles of the cells that
//! some beam touches are drawn ([`Marks`]).
//!
//! Beyond the paper: beams join boxes, not cells. A source cell's is the box of what is seen in it, widened by what a lookup
//! reads beside its point; a light cell's is the box of the lights that share it. A beam is tested exactly, so boxes within
//! their cells mark no ring of neighbours.

mod beam;
mod bins;
mod frustum;
mod grid;
mod receivers;
#[cfg(test)]
mod tests;

pub use beam::{Beam, Marks, mark_by_steps};
pub use bins::{Binning, Bins};
pub use frustum::{Hull, faces_of};
pub use grid::Grid;
pub use receivers::{Footprint, Receivers, SourceCell};
