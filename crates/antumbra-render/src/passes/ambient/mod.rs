//! Light that reaches a surface otherwise than straight from a light: from the sky, and from other surfaces that the
//! lights and the sky light. Both occlude, so that corners, courtyards and the ground under trees grow dark.
//!
//! Final gathering with one bounce: each pixel sends a few rays about its normal with a density of cosine. A ray that
//! escapes brings the sky's light; one that hits brings what that surface reflects of the suns and of one lamp (with their
//! shadows, from the picture's own source of shadows) and of the sky. The few rays' noise is then smoothed along surfaces.

pub(crate) mod reference;

use glam::Vec3;

/// One pixel's gathered light, and the surface that it belongs to.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Gathered {
    /// Position relative to the eye, metres.
    pub position: Vec3,
    /// Unit shading normal; zero where the pixel shows the sky.
    pub normal: Vec3,
    /// What a white surface would reflect: irradiance over pi.
    pub light: Vec3,
    /// Side of the pixel where it meets the surface, metres; 0 for the sky.
    pub pixel_m: f32,
}

impl Gathered {
    /// How much this pixel's light is worth to a surface with the given place and normal: 1 on the same plane, to 0.
    pub(crate) fn affinity(&self, position: Vec3, normal: Vec3) -> f32 {
        if self.pixel_m == 0.0 {
            return 0.0;
        }
        let off_plane = (position - self.position).dot(self.normal).abs() / (3.0 * self.pixel_m);
        self.normal.dot(normal).max(0.0).powi(16) * (-off_plane).exp()
    }
}

/// How many times to smooth: more rays need less. Each time reaches twice as far.
pub(crate) fn smoothing_steps(rays: u32) -> u32 {
    match rays {
        0..=24 => 3,
        25..=96 => 2,
        _ => 1,
    }
}
