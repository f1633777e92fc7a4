//! Scenes for Antumbra: the model, files in and out, and procedural scenes.

pub mod model;

pub use model::*;
