//! The node graph: hash-consed while it is built, then numbered and encoded.
//!
//! Identical nodes never exist twice: a node is looked up by its children as it is made ("culling construction of
//! identical nodes", Kämpe et al. 2015, section 3.2, without their adjacency test).

mod encode;
mod levels;
mod order;
mod table;

pub use encode::{EncodeError, Encoded, encode};
pub use levels::{LevelsError, coarse_levels};
pub use table::{Id, Interner, LIT, NodeTable, SHADOWED, Tables};
