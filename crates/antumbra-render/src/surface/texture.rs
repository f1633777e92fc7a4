//! Base-colour textures: bilinear between texels, linear between the levels of a mip pyramid, glTF's wrap modes.

use antumbra_scene::{Image, TextureRef, Wrap};
use glam::{Vec2, Vec4};
use std::sync::LazyLock;

/// An image and ever smaller copies of it, each half the size, down to 1 x 1. Level 0 is the image.
#[derive(Clone, Debug)]
pub(crate) struct Pyramid {
    levels: Vec<Level>,
}

#[derive(Clone, Debug)]
pub(crate) struct Level {
    pub width: u32,
    pub height: u32,
    /// sRGB colour and linear alpha, as in [`Image`].
    pub rgba: Vec<[u8; 4]>,
}

impl Pyramid {
    /// `None` for an image without pixels, or with fewer than it says.
    pub(crate) fn new(image: &Image) -> Option<Self> {
        let rgba: Vec<[u8; 4]> = image.rgba.as_chunks().0.to_vec();
        if rgba.is_empty() || rgba.len() as u64 != u64::from(image.width) * u64::from(image.height) {
            return None;
        }
        let mut levels = vec![Level { width: image.width, height: image.height, rgba }];
        while let Some(half) = levels.last().and_then(Level::half) {
            levels.push(half);
        }
        Some(Self { levels })
    }

    /// Linear RGBA at a texture coordinate, as the texture reference transforms and wraps it. `level` is the mip
    /// level, clamped: 0 for the full detail; between two it is a blend of both.
    pub(crate) fn sample(&self, reference: &TextureRef, uv: [f32; 2], level: f32) -> Vec4 {
        let last = self.levels.len() - 1;
        let level = level.clamp(0.0, last as f32);
        let [u, v] = reference.transform.map(|row| row[0] * uv[0] + row[1] * uv[1] + row[2]);
        let at = |level: usize| self.levels[level].bilinear(Vec2::new(u, v), reference.wrap_s, reference.wrap_t);
        let (fine, share) = (at(level as usize), level.fract());
        if share > 0.0 { fine.lerp(at(level as usize + 1), share) } else { fine }
    }

    /// Finest first.
    pub(crate) fn levels(&self) -> &[Level] {
        &self.levels
    }

    /// Texels per unit of texture area at full detail.
    pub(crate) fn texels(&self) -> f32 {
        self.levels[0].width as f32 * self.levels[0].height as f32
    }
}

impl Level {
    /// Linear RGB, rows from the top.
    pub(crate) fn colors(&self) -> impl Iterator<Item = glam::Vec3> {
        self.rgba.iter().map(|rgba| glam::Vec3::from([0, 1, 2].map(|i| LINEAR[usize::from(rgba[i])])))
    }

    fn bilinear(&self, uv: Vec2, wrap_s: Wrap, wrap_t: Wrap) -> Vec4 {
        if !uv.is_finite() {
            return Vec4::ONE;
        }
        let (x0, x1, fx) = neighbours(uv.x, self.width, wrap_s);
        let (y0, y1, fy) = neighbours(uv.y, self.height, wrap_t);
        let (top, bottom) =
            (self.texel(x0, y0).lerp(self.texel(x1, y0), fx), self.texel(x0, y1).lerp(self.texel(x1, y1), fx));
        top.lerp(bottom, fy)
    }

    fn texel(&self, x: u32, y: u32) -> Vec4 {
        let [r, g, b, a] = self.rgba[(y * self.width + x) as usize].map(usize::from);
        Vec4::new(LINEAR[r], LINEAR[g], LINEAR[b], a as f32 / 255.0)
    }

    /// The next smaller level: means over 2 x 2 texels (over what there is, where a side is odd or 1).
    fn half(&self) -> Option<Self> {
        if self.width == 1 && self.height == 1 {
            return None;
        }
        let (width, height) = ((self.width / 2).max(1), (self.height / 2).max(1));
        let mean = |i: u32| {
            let (x, y) = (2 * (i % width), 2 * (i / width));
            let (x1, y1) = ((x + 1).min(self.width - 1), (y + 1).min(self.height - 1));
            average([self.texel(x, y), self.texel(x1, y), self.texel(x, y1), self.texel(x1, y1)])
        };
        Some(Self { width, height, rgba: (0..width * height).map(mean).collect() })
    }
}

/// Mean of four texels, colours weighted by alpha: what lies hidden in a cut-out's empty texels must not bleed out.
fn average(texels: [Vec4; 4]) -> [u8; 4] {
    let alpha: f32 = texels.iter().map(|t| t.w).sum::<f32>() * 0.25;
    let weight = |t: &Vec4| if alpha > 0.0 { 0.25 * t.w / alpha } else { 0.25 };
    let color: Vec4 = texels.iter().map(|t| *t * weight(t)).sum();
    let byte = |linear: f32| (srgb_from_linear(linear) * 255.0 + 0.5) as u8;
    [byte(color.x), byte(color.y), byte(color.z), (alpha * 255.0 + 0.5) as u8]
}

/// The two texels on either side of a coordinate, wrapped, and how far it lies from the first to the second.
fn neighbours(coordinate: f32, side: u32, wrap: Wrap) -> (u32, u32, f32) {
    // Texel centres lie at half-integers. Reduced first, so that large coordinates keep their fraction.
    let reduced = match wrap {
        Wrap::Repeat => coordinate.rem_euclid(1.0),
        Wrap::Mirror => coordinate.rem_euclid(2.0),
        Wrap::Clamp => coordinate.clamp(-1.0, 2.0),
    };
    let x = reduced * side as f32 - 0.5;
    let first = x.floor();
    (wrap.texel(first as i64, side), wrap.texel(first as i64 + 1, side), x - first)
}

/// IEC 61966-2-1.
static LINEAR: LazyLock<[f32; 256]> = LazyLock::new(|| {
    core::array::from_fn(|i| {
        let c = i as f64 / 255.0;
        (if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }) as f32
    })
});

/// IEC 61966-2-1: 0..1 to 0..1.
pub(crate) fn srgb_from_linear(linear: f32) -> f32 {
    let c = linear.clamp(0.0, 1.0);
    if c <= 0.003_130_8 { 12.92 * c } else { 1.055 * c.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;

    const IDENTITY: [[f32; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

    fn reference(wrap: Wrap) -> TextureRef {
        TextureRef { image: 0, wrap_s: wrap, wrap_t: wrap, transform: IDENTITY }
    }

    /// 2 x 2: black, white / red, half-transparent blue.
    fn pyramid() -> Pyramid {
        let rgba = vec![0, 0, 0, 255, 255, 255, 255, 255, 255, 0, 0, 255, 0, 0, 255, 128];
        Pyramid::new(&Image { name: String::new(), width: 2, height: 2, rgba }).expect("an image")
    }

    #[test]
    fn texel_centres_give_texels() {
        let (p, r) = (pyramid(), reference(Wrap::Repeat));
        assert_eq!(p.sample(&r, [0.25, 0.25], 0.0), Vec4::new(0.0, 0.0, 0.0, 1.0));
        assert_eq!(p.sample(&r, [0.75, 0.25], 0.0), Vec4::ONE);
        assert_eq!(p.sample(&r, [0.25, 0.75], 0.0), Vec4::new(1.0, 0.0, 0.0, 1.0));
    }

    #[test]
    fn between_centres_light_is_mixed_linearly() {
        let grey = pyramid().sample(&reference(Wrap::Clamp), [0.5, 0.0], 0.0);
        assert!((grey - Vec4::new(0.5, 0.5, 0.5, 1.0)).length() < 1e-6);
    }

    #[test]
    fn wrap_modes() {
        let p = pyramid();
        // A little left of u = 0: the left texel mixes with the right one, with itself, with itself.
        let at = |wrap| p.sample(&reference(wrap), [-0.125, 0.25], 0.0).x;
        assert!((at(Wrap::Repeat) - 0.75).abs() < 1e-6);
        assert!(at(Wrap::Clamp).abs() < 1e-6);
        assert!(at(Wrap::Mirror).abs() < 1e-6);
        // One and a quarter: repeat starts over, mirror comes back, clamp stays.
        let at = |wrap| p.sample(&reference(wrap), [1.25, 0.25], 0.0).x;
        assert_eq!([at(Wrap::Repeat), at(Wrap::Mirror), at(Wrap::Clamp)], [0.0, 1.0, 1.0]);
    }

    #[test]
    fn the_transform_comes_before_wrapping() {
        let r = TextureRef { transform: [[0.5, 0.0, 0.5], [0.0, 1.0, 0.0]], ..reference(Wrap::Repeat) };
        assert_eq!(pyramid().sample(&r, [0.5, 0.25], 0.0), Vec4::ONE);
    }

    #[test]
    fn the_smallest_level_is_the_mean_weighted_by_alpha() {
        let top = pyramid().sample(&reference(Wrap::Repeat), [0.3, 0.6], 9.0);
        let alpha = (3.0 + 128.0 / 255.0) / 4.0;
        let expected = Vec4::new(0.5 / alpha, 0.25 / alpha, (0.25 + 0.25 * 128.0 / 255.0) / alpha, alpha);
        assert!((top - expected).length() < 0.01, "{top} {expected}");
    }

    #[test]
    fn bad_images_and_coordinates_do_no_harm() {
        let short = Image { name: String::new(), width: 2, height: 2, rgba: vec![0; 12] };
        assert!(Pyramid::new(&short).is_none());
        for bad in [f32::NAN, f32::INFINITY, 1e30, -1e30] {
            assert!(pyramid().sample(&reference(Wrap::Mirror), [bad, bad], 0.0).is_finite());
        }
    }
}
