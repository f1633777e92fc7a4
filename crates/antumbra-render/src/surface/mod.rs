//! What a surface looks like where a ray meets it: normals, colour, alpha.

mod alpha;
mod material;
mod texture;

pub use alpha::AlphaMasks;
pub(crate) use material::{Surface, Surfaces};
#[cfg(feature = "gpu")]
pub(crate) use texture::Pyramid;
pub(crate) use texture::srgb_from_linear;
