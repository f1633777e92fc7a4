//! Antumbra's window: walk around in a scene, drag its sun, switch and time its shadows.
//!
//! ```no_run
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let scene = antumbra_scene::load("city.glb".as_ref())?;
//! antumbra_viewer::run(antumbra_viewer::ViewOptions::new(scene))?;
//! # Ok(()) }
//! ```
//!
//! A frame goes through `app` (what the user did), `stage` (scene, lights and bake on the graphics card) and `screen` (the
//! window's surface, and `panel` over the picture). `rebuild` bakes in the background, [`script`] replays a camera's way.

mod app;
mod area;
mod error;
mod fly;
mod lamps;
mod panel;
mod rebuild;
mod screen;
pub mod script;
mod settings;
mod stage;
mod video;

pub use error::ViewError;
pub use script::Script;

use antumbra::ShadowFile;
use antumbra_render::gpu::PassTime;
use antumbra_scene::Scene;

/// What to open.
#[derive(Debug)]
pub struct ViewOptions {
    /// The scene.
    pub scene: Scene,
    /// A bake of it; without one its lights are baked in the background.
    pub bake: Option<ShadowFile>,
    /// Texels per side of bakes in the background: a power of two.
    pub resolution: u32,
    /// The window's size, pixels.
    pub size: [u32; 2],
    /// A camera's way to replay instead of what a user does; the window closes at its end.
    pub script: Option<Script>,
}

impl ViewOptions {
    /// A scene without a bake, in a window of 1280 x 720.
    #[must_use]
    pub fn new(scene: Scene) -> Self {
        Self { scene, bake: None, resolution: 4096, size: [1280, 720], script: None }
    }
}

/// Opens the window and returns when it is closed. Must be called on the main thread.
///
/// # Errors
/// [`ViewError`] when there is no display or no graphics card, something does not fit the card, or a script's step fails.
pub fn run(options: ViewOptions) -> Result<Closed, ViewError> {
    app::run(options)
}

/// How it went.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Closed {
    /// Frames drawn.
    pub frames: usize,
    /// Their mean time, milliseconds.
    pub mean_ms: f64,
    /// Mean times of the last 120 frames' passes, in the order of the last frame.
    pub passes: Vec<PassTime>,
}
