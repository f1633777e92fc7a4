//! A camera's way through a scene, for tables that measure frames.

use antumbra_render::{RenderError, default_camera};
use antumbra_scene::{Camera, Scene};
use glam::DVec3;

/// So many cameras along a closed way through the scene's own ones, evenly timed; round the scene where it has fewer than
/// two.
pub fn cameras(scene: &Scene, frames: usize) -> Result<Vec<Camera>, RenderError> {
    let keys = match &scene.cameras[..] {
        own @ [_, _, ..] => own.to_vec(),
        _ => around(scene)?,
    };
    Ok((0..frames).map(|i| between(&keys, i as f64 * keys.len() as f64 / frames as f64)).collect())
}

/// Eight views of the scene from all round.
fn around(scene: &Scene) -> Result<Vec<Camera>, RenderError> {
    let camera = default_camera(scene)?;
    let middle = scene.bounds(|_| true).center();
    let view = |i: u32| {
        let (sin, cos) = (f64::from(i) * std::f64::consts::FRAC_PI_4).sin_cos();
        let turned = |v: DVec3| DVec3::new(v.x * cos + v.z * sin, v.y, v.z * cos - v.x * sin);
        Camera {
            eye_world: middle + turned(camera.eye_world - middle),
            forward_world: turned(camera.forward_world),
            up_world: turned(camera.up_world),
            ..camera.clone()
        }
    };
    Ok((0..8).map(view).collect())
}

/// The camera at a place on a way: keys lie at whole numbers, and after the last comes the first.
fn between(keys: &[Camera], at: f64) -> Camera {
    let (index, share) = (at as usize, at.fract());
    let [a, b] = [&keys[index % keys.len()], &keys[(index + 1) % keys.len()]];
    // Slow at the keys.
    let share = share * share * (3.0 - 2.0 * share);
    let forward = a.forward_world.lerp(b.forward_world, share).try_normalize().unwrap_or(a.forward_world);
    let right = forward.cross(DVec3::Y).try_normalize().unwrap_or(DVec3::X);
    Camera {
        name: a.name.clone(),
        eye_world: a.eye_world.lerp(b.eye_world, share),
        forward_world: forward,
        up_world: right.cross(forward),
        fov_y: a.fov_y + (b.fov_y - a.fov_y) * share,
    }
}

#[cfg(test)]
mod tests {
    use antumbra_scene::procedural::{self, Options};

    use super::*;

    #[test]
    fn the_way_passes_the_scenes_cameras() {
        let scene = procedural::build("village", &Options { scale: 0.2, ..Options::default() }).expect("a scene");
        let keys = scene.cameras.len();
        let way = cameras(&scene, 4 * keys).expect("a way");
        for (key, camera) in scene.cameras.iter().zip(way.iter().step_by(4)) {
            assert!(camera.eye_world.distance(key.eye_world) < 1e-9);
        }
        let bare = Scene { cameras: Vec::new(), ..scene };
        assert_eq!(cameras(&bare, 5).expect("a way").len(), 5);
    }
}
