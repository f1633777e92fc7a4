//! Materials, and their base-colour textures as PNG.

use std::io::Cursor;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use serde_json::{Value, json};

use super::Written;
use super::binary::Binary;
use crate::model::{AlphaMode, Image, Material, Scene, TextureRef, Wrap};

const IDENTITY: [[f32; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

/// The JSON of everything about looks.
#[derive(Default)]
pub(super) struct Looks {
    pub materials: Vec<Value>,
    pub textures: Vec<Value>,
    pub samplers: Vec<Value>,
    pub images: Vec<Value>,
    pub extensions: Vec<&'static str>,
}

pub(super) fn materials(scene: &Scene, binary: &mut Binary) -> Written<Looks> {
    let mut looks = Looks::default();
    for image in &scene.images {
        let png = encode_png(image).map_err(|e| format!("image {:?} does not fit into a PNG ({e})", image.name))?;
        let view = binary.add(png);
        looks.images.push(json!({ "name": image.name, "mimeType": "image/png", "bufferView": view }));
    }
    for material in &scene.materials {
        let value = looks.material(material, scene.images.len());
        looks.materials.push(value.map_err(|problem| format!("in material {:?}, {problem}", material.name))?);
    }
    Ok(looks)
}

fn encode_png(image: &Image) -> Result<Vec<u8>, String> {
    if image.rgba.len() as u64 != 4 * u64::from(image.width) * u64::from(image.height) {
        return Err(format!("{} bytes are not {} x {} pixels", image.rgba.len(), image.width, image.height));
    }
    let mut png = Cursor::new(Vec::new());
    let encoder = PngEncoder::new_with_quality(&mut png, CompressionType::Default, FilterType::Adaptive);
    let written = encoder.write_image(&image.rgba, image.width, image.height, ExtendedColorType::Rgba8);
    written.map_err(|e| e.to_string())?;
    Ok(png.into_inner())
}

impl Looks {
    fn material(&mut self, material: &Material, images: usize) -> Written<Value> {
        let mut pbr = json!({
            "baseColorFactor": material.base_color,
            "metallicFactor": material.metallic,
            "roughnessFactor": material.roughness,
        });
        if let Some(texture) = &material.base_color_texture {
            pbr["baseColorTexture"] = self.texture_info(texture, images)?;
        }
        let mut out = json!({ "name": material.name, "pbrMetallicRoughness": pbr });
        self.emission(material, &mut out);
        match material.alpha_mode {
            AlphaMode::Opaque => {}
            AlphaMode::Mask => {
                out["alphaMode"] = "MASK".into();
                out["alphaCutoff"] = material.alpha_cutoff.into();
            }
            AlphaMode::Blend => out["alphaMode"] = "BLEND".into(),
        }
        if material.double_sided {
            out["doubleSided"] = true.into();
        }
        Ok(out)
    }

    fn emission(&mut self, material: &Material, out: &mut Value) {
        if material.emissive == [0.0; 3] {
            return;
        }
        // A power of two, so that dividing by it loses nothing.
        let brightest = material.emissive.into_iter().fold(0.0, f32::max);
        let mut strength = 1.0_f32;
        while strength < brightest && strength < f32::MAX / 2.0 {
            strength *= 2.0;
        }
        out["emissiveFactor"] = json!(material.emissive.map(|c| c / strength));
        if strength > 1.0 {
            self.uses("KHR_materials_emissive_strength");
            out["extensions"] = json!({ "KHR_materials_emissive_strength": { "emissiveStrength": strength } });
        }
    }

    fn texture_info(&mut self, texture: &TextureRef, images: usize) -> Written<Value> {
        if texture.image >= images {
            return Err(format!("the texture wants image {} of {images}", texture.image));
        }
        let sampler = json!({ "wrapS": wrap_code(texture.wrap_s), "wrapT": wrap_code(texture.wrap_t) });
        let sampler = find_or_push(&mut self.samplers, sampler);
        let index = find_or_push(&mut self.textures, json!({ "sampler": sampler, "source": texture.image }));
        let mut info = json!({ "index": index });
        if texture.transform != IDENTITY {
            self.uses("KHR_texture_transform");
            info["extensions"] = json!({ "KHR_texture_transform": transform(&texture.transform)? });
        }
        Ok(info)
    }

    fn uses(&mut self, extension: &'static str) {
        if !self.extensions.contains(&extension) {
            self.extensions.push(extension);
        }
    }
}

fn find_or_push(list: &mut Vec<Value>, value: Value) -> usize {
    list.iter().position(|v| *v == value).unwrap_or_else(|| {
        list.push(value);
        list.len() - 1
    })
}

fn wrap_code(wrap: Wrap) -> u32 {
    match wrap {
        Wrap::Repeat => 10497,
        Wrap::Mirror => 33648,
        Wrap::Clamp => 33071,
    }
}

/// Takes an affine map apart into offset, rotation and scale.
fn transform(m: &[[f32; 3]; 2]) -> Written<Value> {
    let [[a, b, ox], [c, d, oy]] = m.map(|row| row.map(f64::from));
    let (rotation, scale_x) = (libm::atan2(-c, a), libm::hypot(a, c));
    let (sin, cos) = libm::sincos(rotation);
    let scale_y = b * sin + d * cos;
    let shear = b * cos - d * sin;
    if shear.abs() > 1e-5 * (scale_x.abs() + scale_y.abs()) {
        return Err("the texture transform has shear, which glTF cannot express".to_owned());
    }
    Ok(json!({ "offset": [ox, oy], "rotation": rotation, "scale": [scale_x, scale_y] }))
}
