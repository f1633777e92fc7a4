//! What can be wrong with a window.

use std::path::PathBuf;

use thiserror::Error;

/// Why the window did not open, or closed.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ViewError {
    /// There is no display to open a window on.
    #[error("there is no display to open a window on: run it on one, or draw a picture with `antumbra render`")]
    NoDisplay,
    /// The display opens no window.
    #[error("the display opens no window: {0}")]
    Window(String),
    /// The picture cannot be drawn.
    #[error(transparent)]
    Render(#[from] antumbra_render::RenderError),
    /// The window has no surface to draw on.
    #[error("the graphics card cannot draw in this window: {0}")]
    Surface(String),
    /// The background bake has failed.
    #[error("baking in the background failed: {0}")]
    Bake(String),
    /// A screenshot could not be written.
    #[error("cannot write the screenshot {}: {reason}", path.display())]
    Screenshot {
        /// Where to.
        path: PathBuf,
        /// What the system said.
        reason: String,
    },
    /// A line of a script is wrong.
    #[error("line {line} of the script: {reason}")]
    Script {
        /// Counted from 1.
        line: usize,
        /// What is wrong, and what would be right.
        reason: String,
    },
}
