//! Lookups: from a world point to visibility.
//!
//! A lookup has two halves. *Projection* takes a world point to real-valued voxel coordinates. From integer voxel
//! coordinates on everything is integer arithmetic on the node pool, so that every processor gives the same answer.
//!
//! Outside the light's volume: sideways or before its first slice is lit; behind its last slice is as the last slice;
//! outside a spot light's cone is shadowed.

pub mod blocker;
pub(crate) mod continuous;
pub mod filter;
pub mod light;
pub(crate) mod many;
pub(crate) mod pcf;
pub mod penumbra;
pub(crate) mod point;
pub mod prefilter;
pub mod project;
pub mod segment;
pub mod silhouette;
pub(crate) mod top_grid;
pub(crate) mod walk;
pub(crate) mod window;
