//! Reads a scene file of any supported kind.

use std::path::Path;

use crate::error::SceneError;
use crate::gltf;
use crate::model::Scene;
use crate::obj;

/// Reads a scene from a `.glb`, `.gltf` or `.obj` file.
///
/// Files that it refers to are looked for in its folder. The scene is named after the file's stem. Triangles that cannot
/// be used are counted in [`Scene::dropped`].
///
/// # Errors
/// Says what is wrong with the file and what to do about it; see [`SceneError`].
pub fn load(path: &Path) -> Result<Scene, SceneError> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    let folder = path.parent();
    let bytes = || std::fs::read(path).map_err(|source| SceneError::Read { path: path.to_owned(), source });
    let scene = match extension.as_str() {
        "glb" | "gltf" => gltf::read(&bytes()?, &name, folder),
        "obj" => obj::read(&bytes()?, &name, folder),
        _ => return Err(SceneError::UnknownFileType { path: path.to_owned() }),
    };
    scene.map_err(|e| e.in_file(&path.display().to_string()))
}

/// Reads a scene from the bytes of a `.glb` that needs no other file.
///
/// # Errors
/// As [`load`].
pub fn load_glb_slice(bytes: &[u8], name: &str) -> Result<Scene, SceneError> {
    gltf::read(bytes, name, None).map_err(|e| e.in_file(name))
}
