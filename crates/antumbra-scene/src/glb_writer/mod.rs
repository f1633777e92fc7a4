//! glTF out: one self-contained `.glb`, the same bytes for the same scene on every machine.
//!
//! What [`crate::load`] reads back is the same model, bit for bit where positions and transforms are concerned. Seams go
//! among the triangles, where loading finds them again.

mod binary;
mod materials;
mod meshes;
mod nodes;

use serde_json::{Map, Value, json};

use self::binary::Binary;
use crate::error::SceneError;
use crate::model::Scene;

/// Writes a scene as a binary glTF 2.0 file with everything inside it.
///
/// # Errors
/// [`SceneError::Unwritable`] where the scene breaks the rules of its model (an index or length that does not fit), has a
/// texture transform with shear, or needs more than the 4 GiB that a GLB can have.
pub fn to_glb(scene: &Scene) -> Result<Vec<u8>, SceneError> {
    write(scene).map_err(|problem| SceneError::Unwritable { scene: scene.name.clone(), problem })
}

/// Why a scene cannot be written; the scene's name is added at the end.
type Written<T> = Result<T, String>;

fn write(scene: &Scene) -> Written<Vec<u8>> {
    let mut binary = Binary::default();
    let meshes = meshes::meshes(scene, &mut binary)?;
    let looks = materials::materials(scene, &mut binary)?;
    let nodes = nodes::nodes(scene, &meshes.written)?;
    let cameras = scene.cameras.iter().map(nodes::camera).collect();
    let lights: Vec<Value> = scene.lights.iter().map(nodes::light).collect();

    let mut root = Map::new();
    root.insert("asset".into(), asset(scene));
    let mut used = looks.extensions;
    if !lights.is_empty() {
        used.push("KHR_lights_punctual");
        root.insert("extensions".into(), json!({ "KHR_lights_punctual": { "lights": lights } }));
    }
    put(&mut root, "extensionsUsed", used.into_iter().map(Value::from).collect());
    root.insert("scene".into(), 0.into());
    root.insert("scenes".into(), json!([scene_of(scene, nodes.len())]));
    put(&mut root, "nodes", nodes);
    put(&mut root, "meshes", meshes.json);
    put(&mut root, "cameras", cameras);
    put(&mut root, "materials", looks.materials);
    put(&mut root, "textures", looks.textures);
    put(&mut root, "samplers", looks.samplers);
    put(&mut root, "images", looks.images);
    put(&mut root, "accessors", binary.accessors);
    put(&mut root, "bufferViews", binary.views);
    if !binary.bytes.is_empty() {
        root.insert("buffers".into(), json!([{ "byteLength": binary.bytes.len() }]));
    }
    assemble(&Value::Object(root), &binary.bytes)
}

/// glTF does not allow empty lists.
fn put(root: &mut Map<String, Value>, key: &str, list: Vec<Value>) {
    if !list.is_empty() {
        root.insert(key.into(), list.into());
    }
}

fn asset(scene: &Scene) -> Value {
    let mut asset = json!({ "version": "2.0", "generator": "antumbra" });
    if let Some(copyright) = &scene.copyright {
        asset["copyright"] = copyright.as_str().into();
    }
    asset
}

fn scene_of(scene: &Scene, nodes: usize) -> Value {
    let mut value = json!({ "name": scene.name });
    if nodes > 0 {
        value["nodes"] = (0..nodes).collect();
    }
    value
}

/// Header, JSON chunk padded with spaces, BIN chunk (already padded).
fn assemble(root: &Value, binary: &[u8]) -> Written<Vec<u8>> {
    let mut json = root.to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let binary_chunk = if binary.is_empty() { 0 } else { 8 + binary.len() };
    let length = 12 + 8 + json.len() + binary_chunk;
    let total = u32::try_from(length).map_err(|_| format!("it needs {length} bytes, more than the 4 GiB of a GLB"))?;

    let mut out = Vec::with_capacity(length);
    out.extend_from_slice(b"glTF");
    out.extend_from_slice(&2_u32.to_le_bytes());
    out.extend_from_slice(&total.to_le_bytes());
    // Both lengths are below the total, which fits.
    out.extend_from_slice(&(json.len() as u32).to_le_bytes());
    out.extend_from_slice(b"JSON");
    out.extend_from_slice(&json);
    if binary_chunk > 0 {
        out.extend_from_slice(&(binary.len() as u32).to_le_bytes());
        out.extend_from_slice(b"BIN\0");
        out.extend_from_slice(binary);
    }
    Ok(out)
}
