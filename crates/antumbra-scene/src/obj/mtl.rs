//! Material libraries: `.mtl` files and the pictures they name.

use std::path::{Path, PathBuf};

use rustc_hash::FxHashMap;

use crate::error::SceneError;
use crate::gltf::relative_path;
use crate::images::ImageStore;
use crate::model::{AlphaMode, Image, Material, TextureRef, Wrap};

/// The materials of all libraries that an OBJ names.
pub(super) struct Library<'f> {
    folder: Option<&'f Path>,
    materials: Vec<Material>,
    by_name: FxHashMap<String, usize>,
    images: ImageStore,
    /// Images by path; `None` where there is nothing to show.
    decoded: FxHashMap<PathBuf, Option<usize>>,
}

impl<'f> Library<'f> {
    pub fn new(folder: Option<&'f Path>) -> Self {
        Self {
            folder,
            materials: Vec::new(),
            by_name: FxHashMap::default(),
            images: ImageStore::default(),
            decoded: FxHashMap::default(),
        }
    }

    pub fn index(&self, name: &str) -> Option<usize> {
        self.by_name.get(name).copied()
    }

    pub fn into_parts(self) -> (Vec<Material>, Vec<Image>) {
        (self.materials, self.images.images)
    }

    /// Adds a library's materials. One that is not there leaves its materials unknown.
    pub fn load(&mut self, file: &str) -> Result<(), SceneError> {
        let Some((bytes, _)) = self.read(file) else { return Ok(()) };
        let mut alpha_map = None;
        for line in String::from_utf8_lossy(&bytes).lines() {
            let (keyword, arguments) = line.trim().split_once(char::is_whitespace).unwrap_or((line.trim(), ""));
            if keyword == "newmtl" {
                alpha_map = None;
                let material =
                    Material { name: arguments.trim().to_owned(), double_sided: true, ..Material::default() };
                self.by_name.insert(material.name.clone(), self.materials.len());
                self.materials.push(material);
            } else if let Some(index) = self.materials.len().checked_sub(1) {
                self.property(index, keyword, arguments.trim(), &mut alpha_map)?;
            }
        }
        Ok(())
    }

    fn property(
        &mut self,
        index: usize,
        keyword: &str,
        arguments: &str,
        alpha_map: &mut Option<String>,
    ) -> Result<(), SceneError> {
        match keyword {
            "Kd" => self.materials[index].base_color[..3].copy_from_slice(&color(arguments)),
            "Ke" => self.materials[index].emissive = color(arguments),
            "d" => self.materials[index].set_opacity(super::numbers::<1>(arguments, 1.0)[0]),
            "Tr" => self.materials[index].set_opacity(1.0 - super::numbers::<1>(arguments, 0.0)[0]),
            "map_Kd" => {
                let (file, clamp) = strip_options(arguments);
                let texture = self.texture(file, clamp)?;
                let material = &mut self.materials[index];
                material.base_color_texture = texture;
                // Exporters often leave the factor black where the picture is to show.
                if texture.is_some() && material.base_color[..3] == [0.0; 3] {
                    material.base_color[..3].fill(1.0);
                }
                if alpha_map.as_deref() == Some(file) {
                    material.alpha_mode = AlphaMode::Mask;
                }
                alpha_map.get_or_insert_with(|| file.to_owned());
            }
            // Cut-out leaves name the same picture twice: for its colour and for its alpha.
            "map_d" => {
                let (file, _) = strip_options(arguments);
                if alpha_map.as_deref() == Some(file) {
                    self.materials[index].alpha_mode = AlphaMode::Mask;
                }
                alpha_map.get_or_insert_with(|| file.to_owned());
            }
            _ => {}
        }
        Ok(())
    }

    /// A picture that cannot be had only costs looks, but one beyond the limits is refused.
    fn texture(&mut self, file: &str, clamp: bool) -> Result<Option<TextureRef>, SceneError> {
        let Some((bytes, path)) = self.read(file) else { return Ok(None) };
        let image = match self.decoded.get(&path) {
            Some(&done) => done,
            None => match self.images.add(file.to_owned(), &bytes) {
                Ok(image) => Some(image),
                Err(error @ SceneError::Limit { .. }) => return Err(error),
                Err(_) => None,
            },
        };
        self.decoded.insert(path, image);
        let wrap = if clamp { Wrap::Clamp } else { Wrap::Repeat };
        let transform = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        Ok(image.map(|image| TextureRef { image, wrap_s: wrap, wrap_t: wrap, transform }))
    }

    /// Reads a file beside the OBJ. A path from the author's machine is tried by its last part.
    fn read(&self, file: &str) -> Option<(Vec<u8>, PathBuf)> {
        let folder = self.folder?;
        let last_part = file.rsplit(['/', '\\']).next().unwrap_or(file);
        [file, last_part].into_iter().find_map(|name| {
            let path = folder.join(relative_path(name).ok()?);
            Some((std::fs::read(&path).ok()?, path))
        })
    }
}

impl Material {
    fn set_opacity(&mut self, opacity: f32) {
        self.base_color[3] = opacity.clamp(0.0, 1.0);
        if opacity < 1.0 {
            self.alpha_mode = AlphaMode::Blend;
        }
    }
}

fn color(arguments: &str) -> [f32; 3] {
    super::numbers::<3>(arguments, 0.0).map(|c| if c.is_finite() { c.clamp(0.0, 1.0) } else { 0.0 })
}

/// Takes options such as `-s 2 2 1` off the front of a picture's name; says whether `-clamp on` was among them.
fn strip_options(arguments: &str) -> (&str, bool) {
    let (mut rest, mut clamp) = (arguments.trim(), false);
    while rest.starts_with('-') {
        let (option, tail) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
        rest = tail.trim_start();
        let named = matches!(option, "-imfchan" | "-type");
        for place in 0.. {
            let (word, tail) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
            let value = word.parse::<f32>().is_ok() || matches!(word, "on" | "off") || (named && place == 0);
            if !value || tail.is_empty() {
                break;
            }
            clamp |= option == "-clamp" && word == "on";
            rest = tail.trim_start();
        }
    }
    (rest, clamp)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options_come_off() {
        assert_eq!(strip_options("brick wall.png"), ("brick wall.png", false));
        assert_eq!(strip_options("-s 2 2 1 -o 0.5 0 brick.png"), ("brick.png", false));
        assert_eq!(strip_options("-clamp on -imfchan r a.png"), ("a.png", true));
        assert_eq!(strip_options("-clamp"), ("", false));
        assert_eq!(strip_options("-s 1 1 1"), ("1", false));
    }
}
