//! Where the light comes from: the suns of a scene and its sky.
//!
//! Light is measured relative to the sun outside the atmosphere: a surface that faces it there gets an irradiance
//! of 1. Pictures are exposed to suit, so a file's lux matter only between its own directional lights.

mod sky;
mod sun;

pub use sky::Sky;
pub use sun::Sun;
