//! Silhouettes: a light's shadow as a quadtree of tiles that the casters' own edges cut and their own planes bound. Its size
//! follows from the geometry, hardly from the resolution.
//!
//! The recursion is that of [`crate::columns`]: tiles with the triangles that touch them (`build`). At 8 x 8 texels each ray's interval
//! is solved exactly, and the fewest edges are found that part the rays into regions of which one depth suits all (`leaf`): a constant, a
//! triangle's plane (`form`), or two of them, as where a solid ends in an edge and its front and its back meet, or where surfaces cross. What is
//! found is a *sketch*: for each region the set of depths that would do. Four tiles become one while two edges are enough and the
//! sets of each region still meet (`sketch`, `accept`), so tiles grow until geometry stops them. A greater tile that no more than two edges cross
//! is often sketched at once, by the corners of its regions (`direct`). Planes also come from the gaps by which
//! the builder settles greater tiles (`gap`). Depths are chosen once a tile grows no more (`tree`); last comes the pool (`encode`).
//!
//! Ours. Nothing is lost: at every texel the depth lies in the ray's interval, as in the voxel graph.

mod accept;
mod build;
mod direct;
mod encode;
mod form;
mod gap;
mod leaf;
mod sketch;
mod tree;

pub(crate) use build::build;
pub(crate) use encode::encode;
pub(crate) use tree::Tree;
