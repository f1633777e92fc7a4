//! Antumbra's renderer: pictures of scenes with their shadows, and the ray tracing that they are checked against.
//!
//! - [`trace`] traces rays through a scene in world space, exact about what is hit: the ground truth that bakes are
//!   compared with.
//! - [`Renderer`] draws a scene in daylight on the CPU, with shadows that are traced or looked up in a bake.
//!
//! ```no_run
//! use antumbra_render::{RenderOptions, ShadowSource, default_camera, render};
//!
//! # fn picture(scene: &antumbra_scene::Scene) -> Result<(), Box<dyn std::error::Error>> {
//! let camera = default_camera(scene)?;
//! let picture = render(scene, &camera, &RenderOptions::default(), ShadowSource::Traced, &|_, _| {})?;
//! picture.write_png(std::fs::File::create("picture.png")?)?;
//! # Ok(()) }
//! ```

mod camera;
mod error;
pub mod light;
mod passes;
mod picture;
mod render;
mod sampling;
mod surface;
pub mod trace;

pub use camera::{default_camera, look_at};
pub use error::RenderError;
pub use passes::shadow::{ShadowSource, SunVisibility};
pub use picture::Picture;
pub use render::{Progress, RenderOptions, Renderer, render};
pub use trace::{Hit, Ray, Source, Tracer, TriangleId};
