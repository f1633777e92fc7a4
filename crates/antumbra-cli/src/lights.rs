//! Which lights a bake is for.

use antumbra::{Interior, LightShadow};
use antumbra_scene::{Light, LightKind, Scene};
use anyhow::{Result, bail};
use glam::DVec3;

use crate::args::SunAngles;
use crate::inputs::listed;
use crate::table::printable;

/// Name of the light that `--sun` adds.
pub const SUN: &str = "sun";

/// Lux of a light that is added to a scene: the sun's on a clear day.
const DAYLIGHT_LUX: f32 = 100_000.0;

/// A white directional light.
#[must_use]
pub fn directional(name: &str, direction_world: DVec3) -> Light {
    Light {
        name: name.to_owned(),
        kind: LightKind::Directional,
        position_world: DVec3::ZERO,
        direction_world,
        color: [1.0; 3],
        intensity: DAYLIGHT_LUX,
        range_m: None,
        dynamic: false,
    }
}

/// Puts a light into a scene, in place of the one of its name or behind all others.
pub fn put(scene: &mut Scene, light: Light) {
    match scene.lights.iter_mut().find(|old| old.name == light.name) {
        Some(old) => *old = light,
        None => scene.lights.push(light),
    }
}

/// Warns where a bake's policy leaves undefined what is asked for.
#[must_use]
pub fn policy_warnings(light: LightShadow<'_>, asked: &str) -> Vec<String> {
    let defined = match light.interior() {
        Interior::Static(m) => format!(
            "on the scene's own surfaces only (up to {m} m before them): between a ray's first and second surface, where \
             light shafts and moving receivers look, its answers mean nothing"
        ),
        Interior::Thickness(m) => format!("everywhere but within {m} m behind a surface"),
        Interior::Open | Interior::Closed | Interior::Auto => return Vec::new(),
    };
    let (name, policy) = (printable(light.name()), light.interior().name());
    vec![format!("\"{name}\" was baked with --interior {policy}, and {asked} are asked for: it is defined {defined}")]
}

/// The lights to bake, in the scene's order: those named and the added sun, or all that do not move.
pub fn choose(scene: &mut Scene, names: &[String], sun: Option<SunAngles>) -> Result<Vec<Light>> {
    if let Some(angles) = sun {
        put(scene, directional(SUN, angles.direction_world()));
    }
    if !names.is_empty() {
        return named(&scene.lights, names, sun.is_some());
    }
    if scene.lights.is_empty() {
        bail!("the scene has no light; add a directional one with --sun AZIMUTH,ELEVATION");
    }
    let still: Vec<Light> = scene.lights.iter().filter(|light| !light.dynamic).cloned().collect();
    if still.is_empty() {
        bail!("all lights of the scene move; name those to bake with --light");
    }
    Ok(still)
}

fn named(lights: &[Light], names: &[String], with_sun: bool) -> Result<Vec<Light>> {
    for name in names {
        if !lights.iter().any(|light| light.name == *name) {
            bail!(
                "the scene has no light \"{name}\" to bake; it has: {}",
                listed(lights.iter().map(|light| light.name.as_str()))
            );
        }
    }
    let wanted = |light: &&Light| names.contains(&light.name) || (with_sun && light.name == SUN);
    Ok(lights.iter().filter(wanted).cloned().collect())
}
