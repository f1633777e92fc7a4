//! Materials and images.

use crate::model::{AlphaMode, Image, Material, TextureRef, Wrap};
use crate::procedural::palette::material;
use crate::procedural::textures;

/// The materials' places in [`crate::Scene::materials`].
pub(super) const ASHLAR: usize = 0;
pub(super) const THIN_ASHLAR: usize = 1;
pub(super) const CARVED: usize = 2;
pub(super) const SLATE: usize = 3;
pub(super) const TURF: usize = 4;
pub(super) const BARK: usize = 5;
pub(super) const IVY: usize = 6;
pub(super) const BEECH: usize = 7;
pub(super) const FERN: usize = 8;
pub(super) const GRASS: usize = 9;

const LEAVES_IMAGE: usize = 0;
const FERN_IMAGE: usize = 1;
const GRASS_IMAGE: usize = 2;
const MASONRY_IMAGE: usize = 3;
const TURF_IMAGE: usize = 4;

/// Side of the masonry's image, metres: eight courses of 0.4 m.
const MASONRY_M: f32 = 3.2;
/// Side of the turf's image, metres.
const TURF_M: f32 = 5.0;

pub(super) fn images(seed: u64) -> Vec<Image> {
    vec![
        textures::leaves(seed),
        textures::fern(seed),
        textures::grass(seed),
        textures::masonry(seed),
        textures::turf(seed),
    ]
}

pub(super) fn materials() -> Vec<Material> {
    let masonry = tiled(MASONRY_IMAGE, MASONRY_M);
    let stone = |name: &str, double_sided: bool| Material {
        base_color_texture: Some(masonry),
        double_sided,
        ..material(name, 0xffffff, 0.0, 0.92)
    };
    // The two tiles of one image.
    let half = |offset: f32| TextureRef {
        image: LEAVES_IMAGE,
        wrap_s: Wrap::Clamp,
        wrap_t: Wrap::Clamp,
        transform: [[0.5, 0.0, offset], [0.0, 1.0, 0.0]],
    };
    // Mirrored about its stem, and turned: along a frond is s on the card but up in the image.
    let frond = TextureRef {
        image: FERN_IMAGE,
        wrap_s: Wrap::Mirror,
        wrap_t: Wrap::Clamp,
        transform: [[0.0, 1.0, 0.0], [-1.0, 0.0, 1.0]],
    };
    let blades = TextureRef {
        image: GRASS_IMAGE,
        wrap_s: Wrap::Repeat,
        wrap_t: Wrap::Clamp,
        transform: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    };
    vec![
        stone("ashlar", false),
        stone("thin ashlar", true),
        Material { double_sided: true, ..material("carved stone", 0xc4b8a2, 0.0, 0.85) },
        Material { base_color_texture: Some(masonry), double_sided: true, ..material("slates", 0x7f8288, 0.0, 0.8) },
        Material { base_color_texture: Some(tiled(TURF_IMAGE, TURF_M)), ..material("turf", 0xffffff, 0.0, 1.0) },
        material("bark", 0x786650, 0.0, 1.0),
        cut_out("ivy", half(0.0)),
        cut_out("beech leaves", half(0.5)),
        cut_out("fern", frond),
        cut_out("grass", blades),
    ]
}

fn tiled(image: usize, side_m: f32) -> TextureRef {
    let transform = [[1.0 / side_m, 0.0, 0.0], [0.0, 1.0 / side_m, 0.0]];
    TextureRef { image, wrap_s: Wrap::Repeat, wrap_t: Wrap::Repeat, transform }
}

fn cut_out(name: &str, texture: TextureRef) -> Material {
    Material {
        base_color_texture: Some(texture),
        alpha_mode: AlphaMode::Mask,
        alpha_cutoff: 0.5,
        double_sided: true,
        ..material(name, 0xffffff, 0.0, 0.9)
    }
}
