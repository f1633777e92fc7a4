//! Alpha masks: which points of a surface are there at all (glTF 2.0, `alphaMode` MASK).
//!
//! One rule for bakes, pictures and comparisons: alpha is the material's factor times the vertices' alpha times the
//! base-colour texture's, bilinear between texel centres at the finest level, after KHR_texture_transform and the wrap
//! modes. A surface is there where that is at least the cutoff; without a usable texture it is there everywhere. Computed
//! in `f64` by plain arithmetic: the same answer on every machine.

use crate::model::{AlphaMode, Image, Material, Primitive, Scene, TextureRef, Wrap};

/// The alpha test of one masked material.
#[derive(Clone, Copy, Debug)]
pub struct AlphaTest<'a> {
    image: &'a Image,
    reference: &'a TextureRef,
    factor: f64,
    cutoff: f64,
}

impl<'a> AlphaTest<'a> {
    /// `None` where nothing is to be tested: the material is not of [`AlphaMode::Mask`], or has no texture, or one whose
    /// image is broken, or the primitive has no texture coordinates.
    #[must_use]
    pub fn new(scene: &'a Scene, primitive: &Primitive) -> Option<Self> {
        let material: &Material = scene.materials.get(primitive.material?)?;
        let reference = material.base_color_texture.as_ref()?;
        let image = scene.images.get(reference.image)?;
        let texels = u64::from(image.width) * u64::from(image.height);
        let is_whole = texels > 0 && image.rgba.len() as u64 == 4 * texels;
        let has_places = primitive.texcoords.len() == primitive.positions.len();
        let masked = material.alpha_mode == AlphaMode::Mask;
        (masked && is_whole && has_places).then(|| Self {
            image,
            reference,
            factor: f64::from(material.base_color[3]),
            cutoff: f64::from(material.alpha_cutoff),
        })
    }

    /// Whether the surface is there, at a texture coordinate and an interpolated vertex alpha (1 without vertex colours).
    /// At coordinates that are not finite it is.
    #[must_use]
    pub fn keeps(&self, uv: [f64; 2], vertex_alpha: f64) -> bool {
        let [u, v] = self.reference.transform.map(|row| {
            let [a, b, c] = row.map(f64::from);
            a * uv[0] + b * uv[1] + c
        });
        if !(u.is_finite() && v.is_finite()) {
            return true;
        }
        self.factor * vertex_alpha * self.bilinear(u, v) >= self.cutoff
    }

    fn bilinear(&self, u: f64, v: f64) -> f64 {
        let Image { width, height, .. } = *self.image;
        let (x0, x1, fx) = neighbours(u, width, self.reference.wrap_s);
        let (y0, y1, fy) = neighbours(v, height, self.reference.wrap_t);
        let row = |y| {
            let (left, right) = (self.texel(x0, y), self.texel(x1, y));
            left + (right - left) * fx
        };
        let (top, bottom) = (row(y0), row(y1));
        (top + (bottom - top) * fy) / 255.0
    }

    fn texel(&self, x: u32, y: u32) -> f64 {
        let index = u64::from(y) * u64::from(self.image.width) + u64::from(x);
        f64::from(self.image.rgba[4 * index as usize + 3])
    }
}

/// The two texels on either side of a coordinate, wrapped, and how far it lies from the first to the second. Texel centres
/// lie at half-integers.
fn neighbours(coordinate: f64, side: u32, wrap: Wrap) -> (u32, u32, f64) {
    // Reduced first, so that large coordinates keep their fraction.
    let reduced = match wrap {
        Wrap::Repeat => coordinate.rem_euclid(1.0),
        Wrap::Mirror => coordinate.rem_euclid(2.0),
        Wrap::Clamp => coordinate.clamp(-1.0, 2.0),
    };
    let x = reduced * f64::from(side) - 0.5;
    let first = x.floor();
    (wrap.texel(first as i64, side), wrap.texel(first as i64 + 1, side), x - first)
}

#[cfg(test)]
mod tests {
    use super::*;

    const IDENTITY: [[f32; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

    /// A row of four texels with alphas 255, 0, 0, 255.
    fn scene(wrap_s: Wrap, transform: [[f32; 3]; 2]) -> Scene {
        let alphas = [255, 0, 0, 255];
        let rgba = alphas.iter().flat_map(|&a| [10, 200, 30, a]).collect();
        let reference = TextureRef { image: 0, wrap_s, wrap_t: Wrap::Repeat, transform };
        let material =
            Material { alpha_mode: AlphaMode::Mask, base_color_texture: Some(reference), ..Material::default() };
        Scene {
            images: vec![Image { name: String::new(), width: 4, height: 1, rgba }],
            materials: vec![material],
            ..Scene::default()
        }
    }

    fn primitive() -> Primitive {
        Primitive {
            positions: vec![[0.0; 3]; 3],
            texcoords: vec![[0.0; 2]; 3],
            material: Some(0),
            ..Primitive::default()
        }
    }

    fn keeps(scene: &Scene, u: f64) -> bool {
        AlphaTest::new(scene, &primitive()).expect("a masked material").keeps([u, 0.3], 1.0)
    }

    #[test]
    fn alpha_is_bilinear_between_texel_centres() {
        let scene = scene(Wrap::Clamp, IDENTITY);
        // Half way between the centres at 1/8 and 3/8 alpha is one half: just there.
        assert!(keeps(&scene, 0.25) && !keeps(&scene, 0.2501) && keeps(&scene, 0.2499));
        assert!(!keeps(&scene, 0.5) && keeps(&scene, 0.75) && keeps(&scene, 0.9));
    }

    #[test]
    fn wrap_modes_go_on_outside() {
        let at = |wrap, u| keeps(&scene(wrap, IDENTITY), u);
        assert!(at(Wrap::Clamp, -7.0) && at(Wrap::Clamp, 1e9));
        assert!(at(Wrap::Repeat, 3.1) && !at(Wrap::Repeat, 3.4) && !at(Wrap::Repeat, -0.6));
        let lopsided = {
            let mut scene = scene(Wrap::Mirror, IDENTITY);
            scene.images[0].rgba[3] = 0;
            scene
        };
        // Only the last texel is there: mirrored, it lies on both sides of 1.
        assert!(keeps(&lopsided, 0.9) && keeps(&lopsided, 1.1) && !keeps(&lopsided, 1.6) && keeps(&lopsided, -0.9));
    }

    #[test]
    fn the_transform_comes_first() {
        let shifted = scene(Wrap::Repeat, [[1.0, 0.0, 0.5], [0.0, 1.0, 0.0]]);
        assert!(!keeps(&shifted, 0.0) && keeps(&shifted, 0.5));
    }

    #[test]
    fn factor_vertex_alpha_and_cutoff_count() {
        let mut scene = scene(Wrap::Clamp, IDENTITY);
        scene.materials[0].base_color[3] = 0.6;
        scene.materials[0].alpha_cutoff = 0.4;
        let test = AlphaTest::new(&scene, &primitive()).expect("a masked material");
        assert!(test.keeps([0.0; 2], 0.7) && !test.keeps([0.0; 2], 0.6));
    }

    #[test]
    fn without_anything_to_test_there_is_no_test() {
        let whole = scene(Wrap::Clamp, IDENTITY);
        let mut plain = whole.clone();
        plain.materials[0].alpha_mode = AlphaMode::Opaque;
        let mut bare = whole.clone();
        bare.materials[0].base_color_texture = None;
        let mut broken = whole.clone();
        broken.images[0].rgba.pop();
        assert!([plain, bare, broken].iter().all(|s| AlphaTest::new(s, &primitive()).is_none()));
        assert!(AlphaTest::new(&whole, &Primitive { texcoords: vec![], ..primitive() }).is_none());
        assert!(AlphaTest::new(&whole, &primitive()).expect("a test").keeps([f64::NAN, 0.0], 1.0));
    }
}
