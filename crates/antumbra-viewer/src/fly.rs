//! A camera that flies.

use std::collections::HashSet;

use antumbra_scene::Camera;
use glam::DVec3;
use winit::keyboard::KeyCode;

/// Where the user is and looks.
#[derive(Clone, Debug)]
pub(crate) struct Fly {
    pub camera: Camera,
    /// Metres per second.
    pub speed: f64,
    held: HashSet<KeyCode>,
}

/// Radians per pixel that the mouse is dragged.
const TURN: f64 = 0.003;
/// The steepest that the camera looks up or down: the sine.
const STEEPEST: f64 = 0.995;

impl Fly {
    /// At a camera, as fast as suits a scene of a size.
    pub fn new(camera: Camera, diagonal_m: f64) -> Self {
        Self { camera, speed: (diagonal_m / 12.0).clamp(0.1, 1e4), held: HashSet::new() }
    }

    pub fn key(&mut self, key: KeyCode, is_down: bool) {
        if is_down {
            self.held.insert(key);
        } else {
            self.held.remove(&key);
        }
    }

    /// All keys are up: the window lost the keyboard.
    pub fn let_go(&mut self) {
        self.held.clear();
    }

    /// Looks elsewhere: the mouse was dragged by so many pixels.
    pub fn drag(&mut self, x: f64, y: f64) {
        let forward = self.camera.forward_world;
        let yaw = forward.x.atan2(-forward.z) + x * TURN;
        let pitch = forward.y.clamp(-STEEPEST, STEEPEST).asin() - y * TURN;
        let limit = STEEPEST.asin();
        self.look(yaw, pitch.clamp(-limit, limit));
    }

    fn look(&mut self, yaw: f64, pitch: f64) {
        let ((sin_yaw, cos_yaw), (sin_pitch, cos_pitch)) = (yaw.sin_cos(), pitch.sin_cos());
        let forward = DVec3::new(sin_yaw * cos_pitch, sin_pitch, -cos_yaw * cos_pitch);
        let right = DVec3::new(cos_yaw, 0.0, sin_yaw);
        self.camera.forward_world = forward;
        self.camera.up_world = right.cross(forward);
    }

    /// The wheel was turned by so many notches.
    pub fn scroll(&mut self, notches: f64) {
        self.speed = (self.speed * 1.2_f64.powf(notches)).clamp(1e-3, 1e6);
    }

    /// Moves for so many seconds.
    pub fn advance(&mut self, seconds: f64) {
        let pushed = |plus: KeyCode, minus: KeyCode| {
            f64::from(u8::from(self.held.contains(&plus))) - f64::from(u8::from(self.held.contains(&minus)))
        };
        let right = self.camera.forward_world.cross(self.camera.up_world);
        let way = self.camera.forward_world * pushed(KeyCode::KeyW, KeyCode::KeyS)
            + right * pushed(KeyCode::KeyD, KeyCode::KeyA)
            + DVec3::Y * pushed(KeyCode::KeyE, KeyCode::KeyQ);
        let faster = if self.held.contains(&KeyCode::ShiftLeft) { 5.0 } else { 1.0 };
        self.camera.eye_world += way.normalize_or_zero() * (self.speed * faster * seconds);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_flies_where_it_looks_and_never_overturns() {
        let camera = Camera {
            name: String::new(),
            eye_world: DVec3::ZERO,
            forward_world: DVec3::NEG_Z,
            up_world: DVec3::Y,
            fov_y: 1.0,
        };
        let mut fly = Fly::new(camera, 12.0);
        fly.key(KeyCode::KeyW, true);
        fly.advance(2.0);
        assert!((fly.camera.eye_world - DVec3::NEG_Z * 2.0).length() < 1e-9);
        fly.drag(std::f64::consts::FRAC_PI_2 / TURN, 0.0);
        fly.advance(1.0);
        assert!((fly.camera.eye_world - DVec3::new(1.0, 0.0, -2.0)).length() < 1e-9);
        fly.drag(0.0, -1e9);
        assert!(fly.camera.forward_world.y <= STEEPEST + 1e-9 && fly.camera.up_world.y > 0.0);
        fly.let_go();
        let before = fly.camera.eye_world;
        fly.advance(1.0);
        assert_eq!(fly.camera.eye_world, before);
    }
}
