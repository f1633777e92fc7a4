//! What can be wrong with a wish for a picture.

use thiserror::Error;

/// Why there is no picture. Each says which parameter to change.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RenderError {
    /// A side is zero or too long, or the picture has too many pixels.
    #[error(
        "a picture of {width}x{height} cannot be made: give sides of 1 to 16384, and at most 67108864 pixels in all"
    )]
    Size {
        /// Pixels per row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// No samples, or absurdly many.
    #[error("{name} is {value}: give {least} to {most}")]
    Samples {
        /// Which option.
        name: &'static str,
        /// What it was.
        value: u32,
        /// The least that makes sense.
        least: u32,
        /// The most that is allowed.
        most: u32,
    },
    /// The camera's position or orientation is not usable.
    #[error("the camera `{0}` has a position or an orientation that is not finite, or does not look anywhere")]
    Camera(String),
    /// The field of view is not between 0 and 180 degrees.
    #[error("a vertical field of view of {degrees} degrees: give more than 0 and less than 180")]
    FieldOfView {
        /// What it was.
        degrees: f64,
    },
    /// The exposure is not a positive number.
    #[error("an exposure of {0}: give a positive number")]
    Exposure(f32),
    /// Fog that is no fog.
    #[error("fog of density {0} per metre: give a density above 0, and an anisotropy between -1 and 1")]
    Fog(f64),
    /// An area light that cannot be.
    #[error("an area light cannot be drawn: {0}")]
    AreaLight(String),
    /// The shadow file has none of the scene's lights.
    #[error("the shadow file has no light `{light}`; it has: {present}")]
    LightNotInFile {
        /// The scene's first directional light, or its first light.
        light: String,
        /// The names in the file, separated by commas.
        present: String,
    },
    /// There is no graphics card that can be used.
    #[error("there is no graphics card to draw with ({reason}): {advice}; or draw on the processor")]
    NoGpu {
        /// What the system said.
        reason: String,
        /// What to install.
        advice: &'static str,
    },
    /// The graphics card went away in the middle of its work.
    #[error("the graphics card was lost (its driver was reset or updated): start again")]
    GpuLost,
    /// Something does not fit the graphics card.
    #[error("{what} takes {bytes} bytes, and this graphics card reads at most {most} at a time: draw on the processor")]
    TooLargeForGpu {
        /// What it is.
        what: &'static str,
        /// Its size.
        bytes: u64,
        /// The card's limit.
        most: u64,
    },
    /// The scene has nothing to frame.
    #[error("the scene has no triangles, so there is nothing to point a camera at")]
    EmptyScene,
}
