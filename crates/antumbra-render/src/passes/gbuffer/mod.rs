//! What each sample of each pixel sees.

pub(crate) mod reference;

use glam::Vec3;

use crate::surface::Surface;

/// One sample of a pixel: a surface, or the sky behind everything.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Texel {
    /// Unit vector from the eye.
    pub direction: Vec3,
    pub surface: Option<Surface>,
}
