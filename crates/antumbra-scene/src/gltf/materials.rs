//! Materials and the base-colour textures they use.

use rustc_hash::FxHashMap;

use super::schema::{self, Root, TextureInfo, TextureTransform, item};
use super::source::Source;
use crate::error::SceneError;
use crate::images::ImageStore;
use crate::model::{AlphaMode, Image, Material, TextureRef, Wrap};

/// Reads all materials and decodes the images they show; and `others`, which then are indices of what was decoded.
pub(super) fn read_materials<'i>(
    source: &Source<'_>,
    others: impl Iterator<Item = &'i mut usize>,
) -> Result<(Vec<Material>, Vec<Image>), SceneError> {
    let mut textures = Textures { source, store: ImageStore::default(), decoded: FxHashMap::default() };
    let materials = source.root.materials.iter().map(|m| read_material(m, &mut textures)).collect::<Result<_, _>>()?;
    for image in others {
        *image = textures.image(*image)?;
    }
    Ok((materials, textures.store.images))
}

/// The set of texture coordinates that a material's base-colour texture uses.
pub(super) fn texcoord_set(root: &Root, material: Option<usize>) -> Result<usize, SceneError> {
    let Some(index) = material else { return Ok(0) };
    let material = item(&root.materials, index, "material")?;
    Ok(base_color_texture(material)
        .map_or(0, |info| info.extensions.transform.as_ref().and_then(|t| t.tex_coord).unwrap_or(info.tex_coord)))
}

fn base_color_texture(material: &schema::Material) -> Option<&TextureInfo> {
    match &material.extensions.specular_glossiness {
        Some(old) => old.diffuse_texture.as_ref(),
        None => material.pbr_metallic_roughness.base_color_texture.as_ref(),
    }
}

fn read_material(material: &schema::Material, textures: &mut Textures<'_, '_>) -> Result<Material, SceneError> {
    let pbr = &material.pbr_metallic_roughness;
    let old = material.extensions.specular_glossiness.as_ref();
    let base_color_texture = base_color_texture(material).map(|info| textures.texture(info)).transpose()?.flatten();
    let base_color = old.map_or(pbr.base_color_factor, |o| o.diffuse_factor).unwrap_or([1.0; 4]);
    let metallic = if old.is_some() { 0.0 } else { pbr.metallic_factor.unwrap_or(1.0) };
    let roughness = old.map_or(pbr.roughness_factor, |o| Some(1.0 - o.glossiness_factor.unwrap_or(1.0))).unwrap_or(1.0);
    let strength = material.extensions.emissive_strength.as_ref().and_then(|e| e.emissive_strength).unwrap_or(1.0);
    Ok(Material {
        name: material.name.clone().unwrap_or_default(),
        base_color: base_color.map(|c| c.clamp(0.0, 1.0)),
        base_color_texture,
        emissive: material.emissive_factor.map(|c| (c * strength).clamp(0.0, f32::MAX)),
        metallic: metallic.clamp(0.0, 1.0),
        roughness: roughness.clamp(0.0, 1.0),
        alpha_mode: match material.alpha_mode.as_deref() {
            Some("MASK") => AlphaMode::Mask,
            Some("BLEND") => AlphaMode::Blend,
            _ => AlphaMode::Opaque,
        },
        alpha_cutoff: material.alpha_cutoff.unwrap_or(0.5),
        double_sided: material.double_sided,
    })
}

/// Images by their index in the file; each is decoded once however many textures show it.
struct Textures<'t, 'a> {
    source: &'t Source<'a>,
    store: ImageStore,
    decoded: FxHashMap<usize, usize>,
}

impl Textures<'_, '_> {
    /// `None` where the texture exists only in a form that an optional extension brings (Basis, for example).
    fn texture(&mut self, info: &TextureInfo) -> Result<Option<TextureRef>, SceneError> {
        let root = self.source.root;
        let texture = item(&root.textures, info.index, "texture")?;
        let webp = texture.extensions.webp.as_ref().and_then(|w| w.source);
        let Some(image) = webp.or(texture.source) else {
            return Ok(None);
        };
        let sampler = texture.sampler.map(|s| item(&root.samplers, s, "sampler")).transpose()?;
        Ok(Some(TextureRef {
            image: self.image(image)?,
            wrap_s: wrap(sampler.and_then(|s| s.wrap_s)),
            wrap_t: wrap(sampler.and_then(|s| s.wrap_t)),
            transform: info.extensions.transform.as_ref().map_or(IDENTITY, affine),
        }))
    }

    fn image(&mut self, index: usize) -> Result<usize, SceneError> {
        if let Some(&done) = self.decoded.get(&index) {
            return Ok(done);
        }
        let image = item(&self.source.root.images, index, "image")?;
        let name = match (&image.name, &image.uri) {
            (Some(name), _) => name.clone(),
            (None, Some(uri)) if !uri.starts_with("data:") => uri.clone(),
            _ => format!("image{index}"),
        };
        let done = match (image.buffer_view, &image.uri) {
            (Some(view), _) => self.store.add(name, self.source.view(view)?.bytes)?,
            (None, Some(uri)) => self.store.add(name, &self.source.resource(uri)?)?,
            (None, None) => return Err(SceneError::format(format!("image {index} has no data"))),
        };
        self.decoded.insert(index, done);
        Ok(done)
    }
}

fn wrap(code: Option<u32>) -> Wrap {
    match code {
        Some(33071) => Wrap::Clamp,
        Some(33648) => Wrap::Mirror,
        _ => Wrap::Repeat,
    }
}

const IDENTITY: [[f32; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

/// Offset times rotation times scale. The rotation is counter-clockwise as seen on an image whose v runs downwards.
fn affine(t: &TextureTransform) -> [[f32; 3]; 2] {
    let ([ox, oy], [sx, sy]) = (t.offset.unwrap_or([0.0; 2]), t.scale.unwrap_or([1.0; 2]));
    let (sin, cos) = libm::sincos(t.rotation);
    [[cos * sx, sin * sy, ox], [-sin * sx, cos * sy, oy]].map(|row| row.map(|v| v as f32))
}
