//! The directional lights of a scene: suns by day, moons at night.

use antumbra_scene::{Light, LightKind, Scene};
use glam::{DVec3, Vec3};

use super::{LUX, sky, time::MOON_BELOW_LUX};

/// A directional light.
#[derive(Clone, Debug)]
pub struct Sun {
    /// The light's name in the scene, by which a shadow file knows it; `None` for the sun of a scene without one.
    pub name: Option<String>,
    /// Unit vector towards the light.
    pub towards_world: DVec3,
    /// Linear RGB irradiance of a surface that faces the light, after the atmosphere, in the unit of pictures.
    pub irradiance: Vec3,
}

impl Sun {
    /// The scene's directional lights, the first at the strength of the sun and the others in proportion to it; at
    /// least one. A scene without a directional light gets a sun 45 degrees up in the south-west.
    #[must_use]
    pub fn of_scene(scene: &Scene) -> Vec<Self> {
        Self::of_lights(&scene.lights)
    }

    /// As [`Sun::of_scene`].
    pub(crate) fn of_lights(lights: &[Light]) -> Vec<Self> {
        let shines = |l: &&Light| l.kind == LightKind::Directional && l.intensity > 0.0;
        let first_lux = lights.iter().find(shines).map_or(1.0, |l| l.intensity);
        let mut suns: Vec<Self> =
            lights.iter().filter(shines).filter_map(|l| Self::of_light(l, l.intensity / first_lux)).collect();
        if suns.is_empty() {
            suns.push(Self::new(None, DVec3::new(-1.0, 1.414, 1.0).normalize(), Vec3::ONE));
        }
        suns
    }

    /// The directional lights that are dim enough for a moon, each as bright as the file says.
    pub(crate) fn moons(lights: &[Light]) -> Vec<Self> {
        let is_moon =
            |l: &&Light| l.kind == LightKind::Directional && l.intensity > 0.0 && l.intensity < MOON_BELOW_LUX;
        lights.iter().filter(is_moon).filter_map(Self::of_moon).collect()
    }

    fn of_moon(light: &Light) -> Option<Self> {
        let towards_world = (-light.direction_world).try_normalize()?;
        let irradiance = Vec3::from(light.color) * (light.intensity * LUX);
        Some(Self { name: Some(light.name.clone()), towards_world, irradiance })
    }

    fn of_light(light: &Light, strength: f32) -> Option<Self> {
        let towards = (-light.direction_world).try_normalize()?;
        Some(Self::new(Some(light.name.clone()), towards, Vec3::from(light.color) * strength))
    }

    fn new(name: Option<String>, towards_world: DVec3, color: Vec3) -> Self {
        let irradiance = color * sky::sun_transmittance(towards_world.y as f32);
        Self { name, towards_world, irradiance }
    }
}
