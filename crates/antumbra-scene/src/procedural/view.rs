//! Lights and cameras of procedural scenes.

use glam::DVec3;

use crate::model::{Camera, Light, LightKind};

/// The sun: a directional light named `sun`. Azimuth is clockwise from north (-Z) seen from above; both in degrees,
/// of the place in the sky that the light comes from.
pub(crate) fn sun(azimuth_deg: f64, elevation_deg: f64) -> Light {
    let (azimuth, elevation) = (azimuth_deg.to_radians(), elevation_deg.to_radians());
    let flat = libm::cos(elevation);
    let towards_sun = DVec3::new(flat * libm::sin(azimuth), libm::sin(elevation), -flat * libm::cos(azimuth));
    Light {
        name: "sun".to_owned(),
        kind: LightKind::Directional,
        position_world: DVec3::ZERO,
        direction_world: -towards_sun.normalize(),
        color: [1.0, 0.93, 0.82],
        intensity: 100_000.0,
        range_m: None,
    }
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
