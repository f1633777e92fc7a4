//! Nodes: placed meshes, then lights, those with a surface, and cameras.

use glam::{DAffine3, DMat3, DVec3};
use serde_json::{Value, json};

use super::Written;
use crate::model::{AreaLight, AreaShape, Camera, Light, LightKind, Node, Scene};

/// glTF wants a near distance for a camera; the model has none.
const CAMERA_NEAR_M: f64 = 0.1;

/// All nodes of the file. `meshes` gives the file's index of a mesh of the scene.
pub(super) fn nodes(scene: &Scene, meshes: &[Option<usize>]) -> Written<Vec<Value>> {
    let mut out = Vec::with_capacity(scene.nodes.len() + scene.lights.len() + scene.cameras.len());
    for node in &scene.nodes {
        out.push(mesh_node(node, meshes)?);
    }
    for (i, light) in scene.lights.iter().enumerate() {
        let extension = json!({ "KHR_lights_punctual": { "light": i } });
        let world_from_light = DAffine3 { matrix3: looking(light.direction_world), translation: light.position_world };
        let mut node = placed(&light.name, &world_from_light)?;
        node["extensions"] = extension;
        if light.dynamic {
            node["extras"] = json!({ "antumbra": "dynamic" });
        }
        out.push(node);
    }
    for light in &scene.area_lights {
        out.push(area_light(light, scene.images.len())?);
    }
    for (i, camera) in scene.cameras.iter().enumerate() {
        let (forward, up) = (camera.forward_world, camera.up_world);
        let matrix3 = DMat3::from_cols(forward.cross(up), up, -forward);
        let mut node = placed(&camera.name, &DAffine3 { matrix3, translation: camera.eye_world })?;
        node["camera"] = i.into();
        out.push(node);
    }
    Ok(out)
}

fn mesh_node(node: &Node, meshes: &[Option<usize>]) -> Written<Value> {
    let mesh = meshes.get(node.mesh);
    let mesh = mesh.ok_or_else(|| format!("node {:?} wants mesh {} of {}", node.name, node.mesh, meshes.len()))?;
    let mut value = placed(&node.name, &node.world_from_mesh)?;
    if let Some(mesh) = mesh {
        value["mesh"] = (*mesh).into();
    }
    if node.dynamic {
        value["extras"] = json!({ "antumbra": "dynamic" });
    }
    Ok(value)
}

fn area_light(light: &AreaLight, images: usize) -> Written<Value> {
    let (forward, up) = (light.direction_world, light.up_world);
    let matrix3 = DMat3::from_cols(forward.cross(up), up, -forward);
    let mut node = placed(&light.name, &DAffine3 { matrix3, translation: light.position_world })?;
    if let Some(lost) = light.frames.iter().find(|frame| **frame >= images) {
        return Err(format!("area light {:?} wants image {lost} of {images}", light.name));
    }
    let brightest = light.luminance.into_iter().fold(0.0, f32::max);
    let color = light.luminance.map(|l| if brightest > 0.0 { f64::from(l) / f64::from(brightest) } else { 1.0 });
    let mut extras = json!({ "antumbra": "area light", "luminance": brightest, "color": color });
    match light.shape {
        AreaShape::Rectangle { width_m, height_m } => {
            (extras["shape"], extras["width"], extras["height"]) =
                ("rectangle".into(), width_m.into(), height_m.into());
        }
        AreaShape::Disc { radius_m } => (extras["shape"], extras["radius"]) = ("disc".into(), radius_m.into()),
        AreaShape::Sphere { radius_m } => (extras["shape"], extras["radius"]) = ("sphere".into(), radius_m.into()),
        AreaShape::Environment => extras["shape"] = "environment".into(),
    }
    if !light.frames.is_empty() {
        (extras["images"], extras["fps"]) = (light.frames.clone().into(), light.frames_per_second.into());
    }
    node["extras"] = extras;
    Ok(node)
}

fn placed(name: &str, world_from_node: &DAffine3) -> Written<Value> {
    let mut node = json!({ "name": name });
    if !world_from_node.is_finite() {
        return Err(format!("the transform of node {name:?} is not finite"));
    }
    if *world_from_node != DAffine3::IDENTITY {
        let columns = world_from_node.to_cols_array_2d();
        let matrix: Vec<f64> =
            columns.iter().zip([0.0, 0.0, 0.0, 1.0]).flat_map(|(c, w)| [c[0], c[1], c[2], w]).collect();
        node["matrix"] = matrix.into();
    }
    Ok(node)
}

/// A rotation that turns -Z, a light's own direction, into `direction`.
fn looking(direction: DVec3) -> DMat3 {
    let z = -direction;
    let x = z.any_orthonormal_vector();
    DMat3::from_cols(x, z.cross(x), z)
}

/// The definition of a light, for the file's list of them.
pub(super) fn light(light: &Light) -> Value {
    let kind = match light.kind {
        LightKind::Directional => "directional",
        LightKind::Point => "point",
        LightKind::Spot { .. } => "spot",
    };
    let mut out = json!({ "name": light.name, "type": kind, "color": light.color, "intensity": light.intensity });
    if let Some(range) = light.range_m {
        out["range"] = range.into();
    }
    if let LightKind::Spot { inner_angle, outer_angle } = light.kind {
        out["spot"] = json!({ "innerConeAngle": inner_angle, "outerConeAngle": outer_angle });
    }
    out
}

/// The definition of a camera, for the file's list of them.
pub(super) fn camera(camera: &Camera) -> Value {
    let perspective = json!({ "yfov": camera.fov_y, "znear": CAMERA_NEAR_M });
    json!({ "name": camera.name, "type": "perspective", "perspective": perspective })
}
