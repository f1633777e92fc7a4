//! What a surface looks like where a ray meets it: normals, colour, alpha.

mod alpha;
mod material;
mod texture;

pub use alpha::AlphaMasks;
pub(crate) use material::{Surface, Surfaces};
pub(crate) use texture::{Level, Pyramid, srgb_from_linear};
