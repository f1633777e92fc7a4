//! Scenes for Antumbra: the model, files in and out, and procedural scenes.

mod alpha;
pub mod clean;
mod error;
mod exclude;
mod glb_writer;
mod gltf;
mod images;
mod load;
pub mod model;
mod obj;
pub mod procedural;

pub use alpha::AlphaTest;
pub use error::SceneError;
pub use exclude::glob_matches;
pub use glb_writer::to_glb;
pub use images::decode_image;
pub use load::{load, load_glb_slice};
pub use model::*;
