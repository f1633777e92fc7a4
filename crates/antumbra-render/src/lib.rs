//! Antumbra's renderer: pictures of scenes with their shadows, and the ray tracing that they are checked against.
//!
//! - [`trace`] traces rays through a scene in world space, exact about what is hit: the ground truth that bakes are
//!   compared with.
//! - [`Renderer`] draws a scene on the CPU, in daylight or lit by its lamps at night, with shadows that are traced or looked
//!   up in a bake.
//! - [`AlphaMasks`] says where masked surfaces are there at all.
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

pub mod area;
mod camera;
mod error;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod light;
mod passes;
mod picture;
mod render;
mod sampling;
mod surface;
pub mod trace;

pub use camera::{default_camera, look_at};
pub use error::RenderError;
pub use light::Time;
pub use passes::csm::{Cascades, MapFilter};
pub use passes::culling;
pub use passes::fog::Fog;
pub use passes::lamp_maps::{Clustering, Culling, LampMaps, MapProjection, Marking};
pub use passes::shadow::ShadowSource;
pub use picture::Picture;
pub use render::{Progress, RenderOptions, Renderer, render};
pub use surface::AlphaMasks;
pub use trace::{Hit, Ray, Source, Tracer, TriangleId};
