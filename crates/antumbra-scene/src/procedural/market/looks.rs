//! Materials of the market, after those of the village (which begin with the palette).

use crate::model::Material;
use crate::procedural::palette::material;
use crate::procedural::village;

/// A material that the village lacks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Look {
    CanvasRed,
    CanvasBlue,
    CanvasGreen,
    CanvasOchre,
    CanvasWhite,
    Wicker,
    Plank,
    Apple,
    Orange,
    Lemon,
    Plum,
    Cabbage,
    Loaf,
    Bulb,
    PaperAmber,
    PaperOrange,
    PaperRose,
    PaperGreen,
}

impl From<Look> for usize {
    fn from(look: Look) -> Self {
        village::materials().len() + look as Self
    }
}

pub(super) fn materials() -> Vec<Material> {
    let mut all = village::materials();
    for (name, rgb) in [
        ("red canvas", 0xb8402f),
        ("blue canvas", 0x3f6a93),
        ("green canvas", 0x4f7f58),
        ("ochre canvas", 0xd79a3c),
        ("white canvas", 0xeadfc8),
        ("wicker", 0xa87f4e),
        ("planks", 0x9a7450),
        ("apples", 0xb23a2a),
        ("oranges", 0xe08a2c),
        ("lemons", 0xe6cf4a),
        ("plums", 0x5b3f63),
        ("cabbages", 0x86a65a),
        ("loaves", 0xc08a4e),
    ] {
        all.push(material(name, rgb, 0.0, 0.85));
    }
    // Glowing paper, in candela per square metre.
    for (name, rgb, emissive) in [
        ("bulb", 0xfff0d0, [10.0, 7.0, 3.8]),
        ("amber paper", 0xf2c06a, [2.4, 0.95, 0.17]),
        ("orange paper", 0xf0904a, [2.5, 0.68, 0.1]),
        ("rose paper", 0xee8a90, [2.4, 0.5, 0.38]),
        ("green paper", 0xbcd890, [0.95, 1.7, 0.32]),
    ] {
        all.push(Material { emissive, ..material(name, rgb, 0.0, 0.9) });
    }
    all
}
