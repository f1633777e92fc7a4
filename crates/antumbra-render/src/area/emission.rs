//! What an area light shows: a picture, and so each frame of a video.

use antumbra_scene::Image;
use glam::{DVec2, Vec3};

use crate::surface::Pyramid;

/// Texels of the longer side: finer detail is lost in soft light.
const MOST: u32 = 64;

/// A picture that a light shows, reduced to what light and shadow can tell.
#[derive(Clone, Debug, PartialEq)]
pub struct Emission {
    width: u32,
    height: u32,
    /// Linear RGB, rows from the top.
    texels: Vec<Vec3>,
}

impl Emission {
    /// Of an image: sRGB, reduced to at most 64 texels a side. `None` for an image without pixels, or with fewer than it
    /// says.
    #[must_use]
    pub fn of_image(image: &Image) -> Option<Self> {
        let pyramid = Pyramid::new(image)?;
        let small = |level: &&crate::surface::Level| level.width.max(level.height) <= MOST;
        let level = pyramid.levels().iter().find(small)?;
        let texels = level.colors().collect();
        Some(Self { width: level.width, height: level.height, texels })
    }

    /// Of linear RGB, rows from the top, such as a high dynamic range picture of a sky has: reduced to at most 64 texels a
    /// side by means. `None` where pixels are missing.
    #[must_use]
    pub fn of_linear(width: u32, height: u32, rgb: &[[f32; 3]]) -> Option<Self> {
        if width == 0 || height == 0 || rgb.len() as u64 != u64::from(width) * u64::from(height) {
            return None;
        }
        let side =
            |pixels: u32| pixels.min((u64::from(pixels) * u64::from(MOST)).div_ceil(width.max(height).into()) as u32);
        let (across, down) = (side(width).max(1), side(height).max(1));
        let mut texels = vec![(Vec3::ZERO, 0.0_f32); (across * down) as usize];
        for (i, pixel) in (0_u64..).zip(rgb) {
            let (x, y) = (i % u64::from(width), i / u64::from(width));
            let (column, row) = (x * u64::from(across) / u64::from(width), y * u64::from(down) / u64::from(height));
            let (sum, count) = &mut texels[(row * u64::from(across) + column) as usize];
            // What is no number gives no light.
            *sum += Vec3::from(pixel.map(|c| if c.is_finite() { c.max(0.0) } else { 0.0 }));
            *count += 1.0;
        }
        let texels = texels.into_iter().map(|(sum, count)| sum / count).collect();
        Some(Self { width: across, height: down, texels })
    }

    /// Linear RGB at a point of the unit square, from the upper left corner; bilinear, clamped at the edges.
    #[must_use]
    pub fn at(&self, uv: DVec2) -> Vec3 {
        let place = |u: f64, side: u32| {
            let x = (u.clamp(0.0, 1.0) * f64::from(side) - 0.5).clamp(0.0, f64::from(side - 1));
            let first = x.floor();
            (first as u32, (first as u32 + 1).min(side - 1), (x - first) as f32)
        };
        let ((x0, x1, fx), (y0, y1, fy)) = (place(uv.x, self.width), place(uv.y, self.height));
        let texel = |x: u32, y: u32| self.texels[(y * self.width + x) as usize];
        texel(x0, y0).lerp(texel(x1, y0), fx).lerp(texel(x0, y1).lerp(texel(x1, y1), fx), fy)
    }

    /// Texels across and down.
    #[cfg(feature = "gpu")]
    pub(crate) fn size(&self) -> [u32; 2] {
        [self.width, self.height]
    }

    /// Linear RGB, rows from the top.
    #[cfg(feature = "gpu")]
    pub(crate) fn texels(&self) -> &[Vec3] {
        &self.texels
    }

    /// The mean over all of it.
    #[must_use]
    pub fn mean(&self) -> Vec3 {
        self.texels.iter().sum::<Vec3>() / self.texels.len() as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn large_images_keep_their_light() {
        let (width, height) = (300, 150);
        let texel = |i: u32| if i % width < width / 2 { [255, 255, 255, 255] } else { [0, 0, 0, 255] };
        let rgba = (0..width * height).flat_map(texel).collect();
        let emission = Emission::of_image(&Image { name: String::new(), width, height, rgba }).expect("an image");
        assert!(emission.width <= MOST && (emission.mean().x - 0.5).abs() < 0.02, "{}", emission.mean());
        assert!(emission.at(DVec2::new(0.1, 0.5)).x > 0.98 && emission.at(DVec2::new(0.9, 0.5)).x < 0.02);
        assert!(Emission::of_image(&Image { name: String::new(), width, height, rgba: vec![0; 4] }).is_none());
        let rgb: Vec<[f32; 3]> =
            (0..width * height).map(|i| [if i % width < width / 2 { 9.0 } else { 0.0 }; 3]).collect();
        let sky = Emission::of_linear(width, height, &rgb).expect("an image");
        assert!(sky.width == MOST && sky.height == MOST / 2 && (sky.mean().x - 4.5).abs() < 0.1, "{sky:?}");
        assert!(Emission::of_linear(width, height, &rgb[1..]).is_none());
    }
}
