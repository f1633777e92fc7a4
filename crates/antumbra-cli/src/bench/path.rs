//! A camera's way through a scene, for tables that measure frames.

use antumbra_render::{RenderError, default_camera, look_at};
use antumbra_scene::{Camera, Light, Scene};
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

/// So many cameras along a way from lamp to lamp, always to the nearest that was not yet visited, as one walks along streets:
/// a little above each, looking ahead. As [`cameras`] where there are fewer than two.
pub fn cameras_among(scene: &Scene, lamps: &[Light], frames: usize) -> Result<Vec<Camera>, RenderError> {
    let mut left: Vec<DVec3> = lamps.iter().map(|lamp| lamp.position_world).collect();
    let middle = scene.bounds(|_| true).center();
    let mut way: Vec<DVec3> = Vec::new();
    while way.len() < MOST_LAMPS && !left.is_empty() {
        let here = *way.last().unwrap_or(&middle);
        let nearest = |i: &usize, j: &usize| left[*i].distance(here).total_cmp(&left[*j].distance(here));
        let next = (0..left.len()).min_by(nearest).unwrap_or(0);
        way.push(left.swap_remove(next));
    }
    let key = |pair: &[DVec3]| look_at(pair[0] + DVec3::Y * 1.5, pair[1] - DVec3::Y * 1.5, 1.0).ok();
    let keys: Vec<Camera> = way.windows(2).filter_map(key).collect();
    if keys.len() < 2 {
        return cameras(scene, frames);
    }
    let step = (keys.len() - 1) as f64 / frames.max(1) as f64;
    Ok((0..frames).map(|i| between(&keys, i as f64 * step)).collect())
}

/// Lamps that a way passes.
const MOST_LAMPS: usize = 24;

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
    fn a_way_among_lamps_looks_ahead() {
        let scene =
            procedural::build("city", &Options { scale: 0.1, lamps: 9, ..Options::default() }).expect("a scene");
        let way = cameras_among(&scene, &scene.lights[1..], 30).expect("a way");
        assert_eq!(way.len(), 30);
        assert!(way.iter().all(|camera| camera.eye_world.is_finite() && camera.forward_world.is_normalized()));
        assert_eq!(cameras_among(&scene, &[], 5).expect("a way").len(), 5);
    }

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
