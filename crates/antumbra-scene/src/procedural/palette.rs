//! The paints that procedural scenes share: a few harmonious families, told apart by small steps.

use glam::DVec3;

use crate::model::Material;

macro_rules! palette {
    ($($paint:ident $name:literal $rgb:literal $metallic:literal $roughness:literal)*) => {
        /// A material of the shared palette; its number is its place in [`materials`].
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(crate) enum Paint { $($paint),* }

        /// (name, sRGB colour, metallic, roughness), in the order of [`Paint`].
        const TABLE: &[(&str, u32, f32, f32)] = &[$(($name, $rgb, $metallic, $roughness)),*];
    };
}

palette! {
    Asphalt     "asphalt"         0x56575a 0.0 0.95
    Marking     "road marking"    0xd9d6cc 0.0 0.90
    Paving      "paving"          0xb9b2a5 0.0 0.90
    Plaza       "plaza stone"     0xcdbfa4 0.0 0.85
    Quay        "quay stone"      0x958c7e 0.0 0.90
    Gravel      "gravel path"     0xd2c19c 0.0 1.00
    Grass       "grass"           0x7c9350 0.0 1.00
    Water       "water"           0x4d7284 0.0 0.08
    Trunk       "bark"            0x6e5844 0.0 1.00
    LeafDeep    "deep leaves"     0x4e6d3a 0.0 1.00
    LeafGreen   "green leaves"    0x67863f 0.0 1.00
    LeafOlive   "olive leaves"    0x8b9148 0.0 1.00
    LeafRust    "rust leaves"     0xb07a3c 0.0 1.00
    Marble      "marble"          0xe8e1d2 0.0 0.55
    Limestone   "limestone"       0xd9c9aa 0.0 0.80
    Sandstone   "sandstone"       0xcba97c 0.0 0.85
    Granite     "granite"         0x9c968e 0.0 0.70
    BrickRed    "red brick"       0x965443 0.0 0.90
    BrickBrown  "brown brick"     0x775448 0.0 0.90
    BrickOchre  "ochre brick"     0xb58c66 0.0 0.90
    StuccoCream "cream stucco"    0xdfcfb0 0.0 0.90
    StuccoRose  "rose stucco"     0xdcae93 0.0 0.90
    StuccoWhite "white stucco"    0xeee9de 0.0 0.90
    Concrete    "concrete"        0xb0aba1 0.0 0.90
    GlassBlue   "blue glass"      0x6b8ea3 0.0 0.10
    GlassGrey   "grey glass"      0x5f6e78 0.0 0.10
    GlassDark   "dark glass"      0x39444d 0.0 0.10
    GlassGreen  "green glass"     0x769b92 0.0 0.10
    Bronze      "bronze"          0x86694a 0.6 0.45
    Steel       "steel"           0xa7acb0 0.6 0.40
    White       "white metal"     0xe9e7e1 0.0 0.50
    Copper      "green copper"    0x7dad96 0.1 0.70
    Slate       "slate"           0x60656e 0.0 0.80
    Terracotta  "terracotta"      0xa9644a 0.0 0.90
    Felt        "roofing felt"    0x7d776f 0.0 0.95
    Ballast     "roof gravel"     0xa59d92 0.0 0.95
    Timber      "timber"          0x8a6444 0.0 0.90
    CarRed      "red car"         0xa53d31 0.2 0.35
    CarBlue     "blue car"        0x40597a 0.2 0.35
    CarWhite    "white car"       0xe4e2dc 0.0 0.35
    CarYellow   "yellow taxi"     0xe3ab35 0.0 0.35
}

impl From<Paint> for usize {
    fn from(paint: Paint) -> Self {
        paint as Self
    }
}

/// The materials of the palette, for [`crate::Scene::materials`].
pub(crate) fn materials() -> Vec<Material> {
    TABLE.iter().map(|&(name, rgb, metallic, roughness)| material(name, rgb, metallic, roughness)).collect()
}

/// An opaque material of one sRGB colour.
pub(crate) fn material(name: &str, rgb: u32, metallic: f32, roughness: f32) -> Material {
    let [r, g, b] = linear_color(rgb).to_array().map(|v| v as f32);
    Material { name: name.to_owned(), base_color: [r, g, b, 1.0], metallic, roughness, ..Material::default() }
}

/// A colour written 0xrrggbb in sRGB, made linear.
pub(crate) fn linear_color(rgb: u32) -> DVec3 {
    let channel = |shift: u32| {
        let c = f64::from((rgb >> shift) & 0xff) / 255.0;
        if c <= 0.04045 { c / 12.92 } else { libm::pow((c + 0.055) / 1.055, 2.4) }
    };
    DVec3::new(channel(16), channel(8), channel(0))
}
