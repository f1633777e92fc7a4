//! glTF 2.0 in: `.glb` and `.gltf`, with what a static scene needs of it.
//!
//! The bytes go through these files in order:
//!
//! ```text
//! container ──► schema ──► nodes ──► primitives (accessors ──► source ──► meshopt)
//! GLB chunks    JSON       world     meshes      elements      bytes      unpacking
//!                            └─────► punctual (lights, cameras), materials (images)
//! ```
//!
//! Morph targets and skins stay in their rest pose; animations, points and lines are ignored.
//!
//! Bytes are hostile: no index is followed, no length believed and nothing allocated on a claim alone.

mod accessors;
mod container;
mod instancing;
mod materials;
mod meshopt;
mod meshopt_filters;
mod nodes;
mod primitives;
mod punctual;
mod schema;
mod skins;
mod source;

use std::path::Path;

use rustc_hash::FxHashMap;

use self::nodes::Placed;
use self::schema::{Root, item};
use self::source::Source;
use crate::error::SceneError;
use crate::model::{Node, Scene};

pub(crate) use self::source::relative_path;

/// Extensions that are understood, or that only refine looks which the model does not have.
const SUPPORTED: &[&str] = &[
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_lights_punctual",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
    "KHR_texture_transform",
];

/// Reads a scene from the bytes of a `.glb` or `.gltf`; `folder` is where relative URIs start from.
pub(crate) fn read(bytes: &[u8], name: &str, folder: Option<&Path>) -> Result<Scene, SceneError> {
    let container = container::open(bytes)?;
    let root = schema::parse(container.json)?;
    check_extensions(&root)?;
    let source = Source::new(&root, container.bin, folder);
    let placed = nodes::place(&root)?;

    let mut scene = Scene {
        name: name.to_owned(),
        lights: punctual::read_lights(&root, &placed)?,
        area_lights: punctual::read_area_lights(&placed)?,
        cameras: punctual::read_cameras(&root, &placed)?,
        copyright: root.asset.copyright.clone(),
        ..Scene::default()
    };
    read_meshes(&source, &placed, &mut scene)?;
    let mut scene = scene.with_something_left()?;
    let frames = scene.area_lights.iter_mut().flat_map(|light| &mut light.frames);
    let (materials, images) = materials::read_materials(&source, frames)?;
    Ok(Scene { materials, images, ..scene })
}

fn check_extensions(root: &Root) -> Result<(), SceneError> {
    let known = |name: &str| SUPPORTED.contains(&name) || name.starts_with("KHR_materials_");
    let Some(extension) = root.extensions_required.iter().find(|name| !known(name)) else {
        return Ok(());
    };
    let advice = match extension.as_str() {
        "KHR_draco_mesh_compression" => "export again without Draco compression (meshopt compression is supported)",
        "KHR_texture_basisu" => "export again with PNG, JPEG or WebP textures",
        _ => "export again without it",
    };
    Err(SceneError::UnsupportedExtension { file: String::new(), extension: extension.clone(), advice })
}

/// Reads the meshes that placed nodes show, each once, and adds those nodes.
fn read_meshes(source: &Source<'_>, placed: &[Placed<'_>], scene: &mut Scene) -> Result<(), SceneError> {
    let texcoord_set = |material| materials::texcoord_set(source.root, material);
    let mut done: FxHashMap<usize, usize> = FxHashMap::default();
    for place in placed {
        let Some(index) = place.node.mesh else { continue };
        let mesh = match done.get(&index) {
            Some(&mesh) => mesh,
            None => {
                let mesh = item(&source.root.meshes, index, "mesh")?;
                scene.meshes.push(primitives::read_mesh(source, mesh, texcoord_set, &mut scene.dropped)?);
                done.insert(index, scene.meshes.len() - 1);
                scene.meshes.len() - 1
            }
        };
        let placements = match skins::world_from_skinned(source, placed, place.node.skin)? {
            Some(world_from_mesh) => vec![world_from_mesh],
            None => instancing::placements(source, place)?,
        };
        scene.nodes.extend(placements.into_iter().map(|world_from_mesh| Node {
            name: place.name.clone(),
            mesh,
            world_from_mesh,
            dynamic: place.dynamic,
        }));
    }
    Ok(())
}
