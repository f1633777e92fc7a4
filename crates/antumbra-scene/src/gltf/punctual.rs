//! Lights and cameras, from the nodes that carry them.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::nodes::Placed;
use super::schema::{self, Root, item};
use crate::error::SceneError;
use crate::model::{AreaLight, AreaShape, Camera, Light, LightKind};

/// A spot's cone may not close completely: its projection needs a width.
const MIN_OUTER_ANGLE: f64 = 1e-3;

/// The lights of the placed nodes (KHR_lights_punctual), with unique names.
pub(super) fn read_lights(root: &Root, placed: &[Placed<'_>]) -> Result<Vec<Light>, SceneError> {
    let none = Vec::new();
    let definitions = root.extensions.lights.as_ref().map_or(&none, |l| &l.lights);
    let mut names = Names::default();
    let mut lights = Vec::new();
    for place in placed {
        let Some(light) = &place.node.extensions.light else { continue };
        let definition = item(definitions, light.light, "light")?;
        let own_name = place.node.name.as_ref().or(definition.name.as_ref());
        let name = names.unique(own_name.unwrap_or(&place.name));
        lights.push(read_light(definition, name, place)?);
    }
    Ok(lights)
}

fn read_light(light: &schema::Light, name: String, place: &Placed<'_>) -> Result<Light, SceneError> {
    let world_from_node = &place.world_from_node;
    Ok(Light {
        kind: read_kind(light)?,
        name,
        position_world: world_from_node.translation,
        direction_world: unit_or(world_from_node.transform_vector3(DVec3::NEG_Z), DVec3::NEG_Z),
        color: light.color.unwrap_or([1.0; 3]).map(|c| c.clamp(0.0, f32::MAX)),
        intensity: light.intensity.unwrap_or(1.0).clamp(0.0, f32::MAX),
        range_m: light.range.filter(|&r| r > 0.0 && r.is_finite()),
        dynamic: place.dynamic,
    })
}

fn read_kind(light: &schema::Light) -> Result<LightKind, SceneError> {
    match light.kind.as_str() {
        "directional" => Ok(LightKind::Directional),
        "point" => Ok(LightKind::Point),
        "spot" => {
            let (inner, outer) = light.spot.as_ref().map_or((None, None), |s| (s.inner_cone_angle, s.outer_cone_angle));
            let outer_angle = outer.unwrap_or(FRAC_PI_4).clamp(MIN_OUTER_ANGLE, FRAC_PI_2);
            Ok(LightKind::Spot { inner_angle: inner.unwrap_or(0.0).clamp(0.0, outer_angle), outer_angle })
        }
        other => Err(SceneError::format(format!("a light has the unknown type {other:?}"))),
    }
}

/// The lights with a surface among the placed nodes, by their extras; indices of images are still the file's.
pub(super) fn read_area_lights(placed: &[Placed<'_>]) -> Result<Vec<AreaLight>, SceneError> {
    let is_one = |place: &&Placed<'_>| place.node.extras.get("antumbra").is_some_and(|v| v == "area light");
    placed.iter().filter(is_one).map(read_area_light).collect()
}

fn read_area_light(place: &Placed<'_>) -> Result<AreaLight, SceneError> {
    let extras = &place.node.extras;
    let wrong = |what: String| SceneError::format(format!("the area light {:?} {what}", place.name));
    let number = |key: &str, default: Option<f64>| match extras.get(key) {
        None => default.ok_or_else(|| wrong(format!("lacks its {key}"))),
        Some(value) => {
            let number = value.as_f64().filter(|n| n.is_finite() && *n >= 0.0);
            number.ok_or_else(|| wrong(format!("has a {key} that is no number of 0 or more")))
        }
    };
    let metres = |key: &str| match number(key, None)? {
        0.0 => Err(wrong(format!("has a {key} of 0"))),
        size => Ok(size),
    };
    let list = |key: &str| match extras.get(key) {
        None => Ok(Vec::new()),
        Some(value) => {
            let numbers: Option<Vec<f64>> = value.as_array().and_then(|all| all.iter().map(|v| v.as_f64()).collect());
            numbers.ok_or_else(|| wrong(format!("has {key} that are no list of numbers")))
        }
    };
    let shape = match extras.get("shape").and_then(|v| v.as_str()) {
        Some("rectangle") => AreaShape::Rectangle { width_m: metres("width")?, height_m: metres("height")? },
        Some("disc") => AreaShape::Disc { radius_m: metres("radius")? },
        Some("sphere") => AreaShape::Sphere { radius_m: metres("radius")? },
        Some("environment") => AreaShape::Environment,
        _ => return Err(wrong("is no rectangle, disc, sphere or environment by its shape".to_owned())),
    };
    let luminance = number("luminance", Some(300.0))?;
    let color = match list("color")?[..] {
        [] => [1.0; 3],
        [r, g, b] => [r, g, b].map(|c| c.max(0.0)),
        _ => return Err(wrong("has a color that is not three numbers".to_owned())),
    };
    let direction_world = unit_or(place.world_from_node.transform_vector3(DVec3::NEG_Z), DVec3::NEG_Z);
    Ok(AreaLight {
        name: place.name.clone(),
        shape,
        position_world: place.world_from_node.translation,
        direction_world,
        up_world: upright(place.world_from_node.transform_vector3(DVec3::Y), direction_world),
        luminance: color.map(|c| (c * luminance).min(f64::from(f32::MAX)) as f32),
        // What is no index at all leads nowhere, and is refused with the images.
        frames: list("images")?.into_iter().map(|i| if i >= 0.0 { i as usize } else { usize::MAX }).collect(),
        frames_per_second: number("fps", Some(25.0))?,
    })
}

/// The perspective cameras of the placed nodes, with unique names. Others have no counterpart in the model.
pub(super) fn read_cameras(root: &Root, placed: &[Placed<'_>]) -> Result<Vec<Camera>, SceneError> {
    let mut names = Names::default();
    let mut cameras = Vec::new();
    for place in placed {
        let Some(index) = place.node.camera else { continue };
        let camera = item(&root.cameras, index, "camera")?;
        let Some(perspective) = &camera.perspective else { continue };
        if !(perspective.yfov > 0.0 && perspective.yfov < PI) {
            return Err(SceneError::format(format!("camera {index} has a field of view of {}", perspective.yfov)));
        }
        let own_name = place.node.name.as_ref().or(camera.name.as_ref());
        let forward_world = unit_or(place.world_from_node.transform_vector3(DVec3::NEG_Z), DVec3::NEG_Z);
        cameras.push(Camera {
            name: names.unique(own_name.unwrap_or(&place.name)),
            eye_world: place.world_from_node.translation,
            forward_world,
            up_world: upright(place.world_from_node.transform_vector3(DVec3::Y), forward_world),
            fov_y: perspective.yfov,
        });
    }
    Ok(cameras)
}

/// The part of `up` at a right angle to `forward`, of unit length.
fn upright(up: DVec3, forward: DVec3) -> DVec3 {
    let lean = up.dot(forward);
    let upright = if lean.abs() < 1e-15 { up } else { up - forward * lean };
    unit_or(upright, forward.any_orthonormal_vector())
}

/// Unit length, exactly so where it already was: a scene must survive being written and read again.
fn unit_or(v: DVec3, fallback: DVec3) -> DVec3 {
    if (v.length_squared() - 1.0).abs() < 1e-15 { v } else { v.try_normalize().unwrap_or(fallback) }
}

/// Makes names unique by adding `.2`, `.3`, ...
#[derive(Default)]
struct Names {
    seen: FxHashMap<String, usize>,
}

impl Names {
    /// The name itself the first time.
    fn unique(&mut self, name: &str) -> String {
        let count = self.seen.entry(name.to_owned()).or_insert(0);
        *count += 1;
        if *count == 1 {
            return name.to_owned();
        }
        let mut number = *count;
        loop {
            let candidate = format!("{name}.{number}");
            if !self.seen.contains_key(&candidate) {
                self.seen.insert(candidate.clone(), 1);
                self.seen.insert(name.to_owned(), number);
                return candidate;
            }
            number += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_become_unique() {
        let mut names = Names::default();
        let given = ["lamp", "lamp", "lamp.2", "lamp", "sun", "lamp.2"];
        let unique = given.map(|n| names.unique(n));
        assert_eq!(unique, ["lamp", "lamp.2", "lamp.2.2", "lamp.3", "sun", "lamp.2.3"]);
    }
}
