//! Materials of the palace, after those of the palette.

use crate::model::Material;
use crate::procedural::palette::{self, material};

/// A material that the palette lacks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Look {
    Oak,
    DarkOak,
    Walnut,
    Iron,
    BottleGreen,
    BottleAmber,
    Wax,
    Carpet,
    CarpetBorder,
    Parchment,
    ClothRed,
    ClothBlue,
    ClothOchre,
    ClothGreen,
    Flame,
}

impl From<Look> for usize {
    fn from(look: Look) -> Self {
        palette::materials().len() + look as Self
    }
}

pub(super) fn materials() -> Vec<Material> {
    let mut all = palette::materials();
    for (name, rgb, metallic, roughness) in [
        ("oak", 0xc49a6a, 0.0, 0.8),
        ("dark oak", 0xa27c56, 0.0, 0.8),
        ("walnut", 0x96704f, 0.0, 0.6),
        ("iron", 0x77736e, 0.3, 0.6),
        ("green bottle", 0x6e8a5e, 0.0, 0.2),
        ("amber bottle", 0xa57440, 0.0, 0.2),
        ("sealing wax", 0xa8483c, 0.0, 0.5),
        ("carpet", 0xd09274, 0.0, 1.0),
        ("carpet border", 0xd8b98c, 0.0, 1.0),
        ("parchment", 0xd9cba8, 0.0, 0.9),
        ("red cloth", 0xbd5546, 0.0, 1.0),
        ("blue cloth", 0x6b83ac, 0.0, 1.0),
        ("ochre cloth", 0xd9ab5c, 0.0, 1.0),
        ("green cloth", 0x7d9a6a, 0.0, 1.0),
    ] {
        all.push(material(name, rgb, metallic, roughness));
    }
    all.push(Material { emissive: [40.0, 22.0, 8.0], ..material("flame", 0xfff0d0, 0.0, 0.9) });
    all
}
