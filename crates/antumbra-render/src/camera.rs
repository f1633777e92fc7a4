//! Cameras: rays through pixels, and a camera for a scene that has none.

use antumbra_scene::{Camera, Scene};
use glam::{DVec2, DVec3};

use crate::{RenderError, light::Sun, trace::Ray};

/// A camera that looks from one point at another, with +Y up. `fov_y` is the vertical field of view in radians.
///
/// # Errors
/// [`RenderError::Camera`] when the points coincide or are not finite.
pub fn look_at(eye_world: DVec3, target_world: DVec3, fov_y: f64) -> Result<Camera, RenderError> {
    let name = "eye".to_owned();
    let Some(forward_world) = (target_world - eye_world).try_normalize() else {
        return Err(RenderError::Camera(name));
    };
    // Straight up or down, any direction may be up in the picture: north is.
    let right = forward_world.cross(DVec3::Y).try_normalize().unwrap_or(DVec3::X);
    Ok(Camera { name, eye_world, forward_world, up_world: right.cross(forward_world), fov_y })
}

/// A camera that sees the whole scene from above at an angle, with the sun over its shoulder: shadows then fall
/// sideways and away, where they are seen best.
///
/// # Errors
/// [`RenderError::EmptyScene`] when there are no triangles.
pub fn default_camera(scene: &Scene) -> Result<Camera, RenderError> {
    let bounds = scene.bounds(|_| true);
    if bounds.is_empty() {
        return Err(RenderError::EmptyScene);
    }
    let fov_y = 35_f64.to_radians();
    let center = bounds.center();
    let forward = -towards_viewer(&Sun::of_scene(scene)[0]);
    let camera = look_at(center - forward, center, fov_y)?;
    let right = forward.cross(camera.up_world);
    let tan_y = (fov_y * 0.5).tan();
    let tan_x = tan_y * 16.0 / 9.0;
    // Far enough back that every corner of the box is inside the frame, and a little more.
    let far_enough = |corner: DVec3| {
        let p = corner - center;
        (p.dot(right).abs() / tan_x).max(p.dot(camera.up_world).abs() / tan_y) - p.dot(forward)
    };
    let distance = bounds.corners().map(far_enough).into_iter().fold(0.0, f64::max) * 1.04;
    Ok(Camera { name: "default".to_owned(), eye_world: center - forward * distance, ..camera })
}

/// From the scene to the viewer: 28 degrees up, 55 degrees beside the sun.
fn towards_viewer(sun: &Sun) -> DVec3 {
    let flat = DVec3::new(sun.towards_world.x, 0.0, sun.towards_world.z).try_normalize().unwrap_or(DVec3::Z);
    let (sin, cos) = 55_f64.to_radians().sin_cos();
    let turned = DVec3::new(flat.x * cos - flat.z * sin, 0.0, flat.x * sin + flat.z * cos);
    let (sin_up, cos_up) = 28_f64.to_radians().sin_cos();
    turned * cos_up + DVec3::Y * sin_up
}

/// A camera and a picture's size: knows the ray of every pixel.
#[derive(Clone, Debug)]
pub(crate) struct View {
    pub width: u32,
    pub height: u32,
    pub eye: DVec3,
    pub forward: DVec3,
    /// Half the picture's width and height, at distance 1.
    pub half_right: DVec3,
    pub half_up: DVec3,
    /// Side of a pixel at distance 1.
    pub pixel_size: f64,
}

impl View {
    pub(crate) fn new(camera: &Camera, width: u32, height: u32) -> Result<Self, RenderError> {
        check_size(width, height)?;
        if !(camera.fov_y > 1e-6 && camera.fov_y < std::f64::consts::PI - 1e-6) {
            return Err(RenderError::FieldOfView { degrees: camera.fov_y.to_degrees() });
        }
        let bad = || RenderError::Camera(camera.name.clone());
        let forward = camera.forward_world.try_normalize().ok_or_else(bad)?;
        let right = forward.cross(camera.up_world).try_normalize().ok_or_else(bad)?;
        if !camera.eye_world.is_finite() {
            return Err(bad());
        }
        let half_y = (camera.fov_y * 0.5).tan();
        let half_x = half_y * f64::from(width) / f64::from(height);
        Ok(Self {
            width,
            height,
            eye: camera.eye_world,
            forward,
            half_right: right * half_x,
            half_up: right.cross(forward) * half_y,
            pixel_size: 2.0 * half_y / f64::from(height),
        })
    }

    /// The ray through a point of the picture, in pixels from the upper left corner; its direction has length 1.
    pub(crate) fn ray(&self, pixel: DVec2) -> Ray {
        let x = 2.0 * pixel.x / f64::from(self.width) - 1.0;
        let y = 1.0 - 2.0 * pixel.y / f64::from(self.height);
        Ray::new(self.eye, (self.forward + self.half_right * x + self.half_up * y).normalize())
    }
}

fn check_size(width: u32, height: u32) -> Result<(), RenderError> {
    let side = 1..=16384;
    let fits = side.contains(&width) && side.contains(&height) && u64::from(width) * u64::from(height) <= 1 << 26;
    if fits { Ok(()) } else { Err(RenderError::Size { width, height }) }
}
