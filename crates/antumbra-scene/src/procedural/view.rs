//! Lights and cameras of procedural scenes.

use glam::DVec3;

use crate::model::{Camera, Light, LightKind};

/// The sun: a directional light named `sun`. Azimuth is clockwise from north (-Z) seen from above; both in degrees,
/// of the place in the sky that the light comes from.
pub(crate) fn sun(azimuth_deg: f64, elevation_deg: f64) -> Light {
    let color = [1.0, 0.93, 0.82];
    Light { name: "sun".to_owned(), color, intensity: 100_000.0, ..in_the_sky(azimuth_deg, elevation_deg) }
}

/// A full moon: a dim, bluish directional light named `moon`.
pub(crate) fn moon(azimuth_deg: f64, elevation_deg: f64) -> Light {
    let color = [0.62, 0.76, 1.0];
    Light { name: "moon".to_owned(), color, intensity: 0.3, ..in_the_sky(azimuth_deg, elevation_deg) }
}

fn in_the_sky(azimuth_deg: f64, elevation_deg: f64) -> Light {
    let (azimuth, elevation) = (azimuth_deg.to_radians(), elevation_deg.to_radians());
    let flat = libm::cos(elevation);
    let towards_light = DVec3::new(flat * libm::sin(azimuth), libm::sin(elevation), -flat * libm::cos(azimuth));
    Light {
        name: String::new(),
        kind: LightKind::Directional,
        position_world: DVec3::ZERO,
        direction_world: -towards_light.normalize(),
        color: [1.0; 3],
        intensity: 1.0,
        range_m: None,
        dynamic: false,
    }
}

/// A lamp that shines in every direction.
pub(crate) fn point(name: String, position_world: DVec3, range_m: f64, candela: f32, color: [f32; 3]) -> Light {
    Light {
        name,
        kind: LightKind::Point,
        position_world,
        direction_world: DVec3::NEG_Y,
        color,
        intensity: candela,
        range_m: Some(range_m),
        dynamic: false,
    }
}

/// Where a spot light shines: about an axis, out to half angles in degrees.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cone {
    /// Need not have unit length.
    pub(crate) axis: DVec3,
    pub(crate) inner_deg: f64,
    pub(crate) outer_deg: f64,
}

/// A lamp that shines into a cone.
pub(crate) fn spot(
    name: String,
    position_world: DVec3,
    cone: Cone,
    range_m: f64,
    candela: f32,
    color: [f32; 3],
) -> Light {
    let kind = LightKind::Spot { inner_angle: cone.inner_deg.to_radians(), outer_angle: cone.outer_deg.to_radians() };
    let direction_world = cone.axis.normalize();
    Light { kind, direction_world, ..point(name, position_world, range_m, candela, color) }
}

/// A camera that looks from one point at another.
pub(crate) fn camera(name: &str, eye: DVec3, target: DVec3, fov_y_deg: f64) -> Camera {
    let forward = (target - eye).normalize();
    let right = forward.cross(DVec3::Y).normalize();
    Camera {
        name: name.to_owned(),
        eye_world: eye,
        forward_world: forward,
        up_world: right.cross(forward).normalize(),
        fov_y: fov_y_deg.to_radians(),
    }
}
