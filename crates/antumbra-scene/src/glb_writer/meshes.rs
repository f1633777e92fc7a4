//! Meshes: each once, however many nodes show it.

use serde_json::{Value, json};

use super::Written;
use super::binary::Binary;
use crate::model::{Mesh, Primitive, Scene};

/// glTF has no empty meshes, so that not all of a scene's have a counterpart.
pub(super) struct Meshes {
    pub json: Vec<Value>,
    /// Index in the file by index in the scene.
    pub written: Vec<Option<usize>>,
}

pub(super) fn meshes(scene: &Scene, binary: &mut Binary) -> Written<Meshes> {
    let mut out = Meshes { json: Vec::new(), written: Vec::with_capacity(scene.meshes.len()) };
    for mesh in &scene.meshes {
        let primitives = primitives(mesh, scene.materials.len(), binary)?;
        if primitives.is_empty() {
            out.written.push(None);
        } else {
            out.written.push(Some(out.json.len()));
            out.json.push(json!({ "name": mesh.name, "primitives": primitives }));
        }
    }
    Ok(out)
}

fn primitives(mesh: &Mesh, materials: usize, binary: &mut Binary) -> Written<Vec<Value>> {
    let shown = mesh.primitives.iter().filter(|p| !(p.triangles.is_empty() && p.seams.is_empty()));
    shown
        .map(|p| {
            check(p, materials).map_err(|problem| format!("in mesh {:?}, {problem}", mesh.name))?;
            Ok(primitive(p, binary))
        })
        .collect()
}

fn check(primitive: &Primitive, materials: usize) -> Written<()> {
    let vertices = primitive.positions.len();
    for (name, length) in [
        ("normals", primitive.normals.len()),
        ("texture coordinates", primitive.texcoords.len()),
        ("colours", primitive.colors.len()),
    ] {
        if length != 0 && length != vertices {
            return Err(format!("there are {vertices} positions but {length} {name}"));
        }
    }
    let corners = || primitive.triangles.iter().chain(&primitive.seams).flatten();
    if let Some(bad) = corners().find(|&&i| i as usize >= vertices) {
        return Err(format!("a triangle wants vertex {bad} of {vertices}"));
    }
    match primitive.material {
        Some(m) if m >= materials => Err(format!("a primitive wants material {m} of {materials}")),
        _ => Ok(()),
    }
}

fn primitive(primitive: &Primitive, binary: &mut Binary) -> Value {
    let mut attributes = json!({ "POSITION": binary.positions(&primitive.positions) });
    if !primitive.normals.is_empty() {
        attributes["NORMAL"] = binary.attribute(&primitive.normals).into();
    }
    if !primitive.texcoords.is_empty() {
        attributes["TEXCOORD_0"] = binary.attribute(&primitive.texcoords).into();
    }
    if !primitive.colors.is_empty() {
        attributes["COLOR_0"] = binary.attribute(&primitive.colors).into();
    }
    let triangles = primitive.triangles.iter().chain(&primitive.seams).copied();
    let indices = binary.indices(triangles, primitive.positions.len());
    let mut out = json!({ "attributes": attributes, "indices": indices });
    if let Some(material) = primitive.material {
        out["material"] = material.into();
    }
    out
}
