//! The columns builder: from caster triangles to a light's graph in proportion to silhouettes, not texels.
//!
//! A shadow-map tile's whole depth range is one run-length-encoded *column* of blocks as wide as the tile. The builder
//! recurses over a quadtree of tiles, each with the triangles that touch it (`tile`). Where a plane of constant depth
//! answers for a whole tile, the recursion ends (`settle`), by what a policy leaves free (`freedom`, `mates`). At 8 x 8 texels it solves each ray exactly (`leaf`) and
//! stabs the rays' intervals by the closest exit. Four columns merge into their parent's by walking run boundaries
//! (`column`); a run of identical blocks of any length costs one look-up in a table, so identical nodes are never
//! made twice.
//!
//! Sources: intervals and minimal masks, Kämpe, Sintorn, Assarsson 2015, sections 3.2 to 3.4. The columns, the tiles
//! that gaps resolve, and transitions that stay intervals until a block boundary is lost are ours; no depth map is
//! ever made.

mod block;
mod build;
mod column;
mod cutout;
mod enters;
mod faces;
mod freedom;
mod lanes;
mod leaf;
mod mates;
mod rays;
mod settle;
mod tile;
mod triangle;

pub(crate) use block::Block;
pub(crate) use build::root_entries;
pub use build::{Build, BuildError, build};
pub use cutout::{Cutout, CutoutCorners};
pub use enters::EnterGrid;
pub use freedom::{Freedom, Shift};
pub(crate) use lanes::{Lanes, mask, select, spread};
pub(crate) use leaf::{LEAF_LOG2, Leaf, LeafScratch, Transition};
pub(crate) use settle::Settled;
pub(crate) use tile::{COVERS, CUTOUT, Entry, Tile, split};
pub use triangle::BuildTriangle;
