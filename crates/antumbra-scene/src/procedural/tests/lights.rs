//! Lights and cameras: how many, what they are called, and that nothing shuts them in.

use glam::DVec3;

use super::{NAMES, PALACE, fingerprint, scene};
use crate::model::{LightKind, Scene};
use crate::procedural::{Options, build};

fn lit_city(scale: f64, lamps: u32) -> Scene {
    build("city", &Options { scale, lamps, ..Options::default() }).expect("a city")
}

/// How many solids hold a point, by the crossings of a ray in a direction that no wall or edge has.
pub(super) fn winding(scene: &Scene, point: DVec3) -> i64 {
    let direction = DVec3::new(0.612_37, 0.531_71, 0.585_13).normalize();
    let mut sum = 0;
    for node in &scene.nodes {
        for primitive in &scene.meshes[node.mesh].primitives {
            let place = |i: u32| node.world_point(primitive.positions[i as usize]) - point;
            for &triangle in &primitive.triangles {
                let [a, b, c] = triangle.map(place);
                // The ray passes where all three edges turn the same way about it.
                let turns = [a.cross(b), b.cross(c), c.cross(a)].map(|n| n.dot(direction));
                let (out, into) = (turns.iter().all(|&t| t > 0.0), turns.iter().all(|&t| t < 0.0));
                let ahead = a.dot((b - a).cross(c - a)) * if out { 1.0 } else { -1.0 } > 0.0;
                sum += i64::from(out && ahead) - i64::from(into && ahead);
            }
        }
    }
    sum
}

#[test]
fn the_winding_number_tells_inside_from_outside() {
    let village = scene("village", 1, 0.05);
    assert_eq!(winding(&village, DVec3::new(0.0, -5.0, 0.0)), 1);
    assert_eq!(winding(&village, DVec3::new(9.0, 60.0, 3.0)), 0);
}

#[test]
fn no_light_is_inside_a_solid() {
    let mut scenes = vec![lit_city(0.1, 20), lit_city(0.4, 60)];
    scenes.extend([(1, 0.05), (2, 0.5), (3, 1.0), (4, 1.5)].map(|(seed, scale)| scene("village", seed, scale)));
    for scene in &scenes {
        for light in scene.lights.iter().filter(|l| l.kind != LightKind::Directional) {
            let held_by = winding(scene, light.position_world);
            assert_eq!(held_by, 0, "{} of {} is inside something", light.name, scene.name);
        }
    }
}

#[test]
fn lights_and_cameras_are_there_and_well_formed() {
    for &(name, _) in NAMES {
        for scale in [0.05, 0.3, 1.0] {
            let scene = scene(name, 1, scale);
            let first = if ["hairball", "market", "screen", "village"].contains(&name) { "moon" } else { "sun" };
            // In the palace it is night, without a moon.
            if !PALACE.contains(&name) {
                assert_eq!((scene.lights[0].name.as_str(), scene.lights[0].kind), (first, LightKind::Directional));
            }
            assert_eq!(scene.cameras[0].name, "overview");
            all_different(scene.cameras.iter().map(|c| c.name.as_str()));
            all_different(scene.lights.iter().map(|l| l.name.as_str()));
            check_lights(&scene);
            for camera in &scene.cameras {
                assert!((camera.forward_world.length() - 1.0).abs() < 1e-12);
                assert!((camera.up_world.length() - 1.0).abs() < 1e-12);
                assert!(camera.forward_world.dot(camera.up_world).abs() < 1e-12);
            }
        }
    }
}

fn all_different<'a>(names: impl Iterator<Item = &'a str>) {
    let mut names: Vec<_> = names.collect();
    let count = names.len();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), count);
}

fn check_lights(scene: &Scene) {
    for light in &scene.lights {
        assert!((light.direction_world.length() - 1.0).abs() < 1e-12, "{}", light.name);
        assert!(light.position_world.is_finite() && light.intensity > 0.0, "{}", light.name);
        assert_eq!(light.range_m.is_none(), light.kind == LightKind::Directional, "{}", light.name);
        if let LightKind::Spot { inner_angle, outer_angle } = light.kind {
            assert!(0.0 < inner_angle && inner_angle < outer_angle && outer_angle < 1.2, "{}", light.name);
        }
    }
}

#[test]
fn the_village_is_lit_by_lamps_windows_and_a_dim_moon() {
    for seed in [1, 2, 3, 7, 12_345] {
        let village = scene("village", seed, 1.0);
        let count = |prefix: &str| village.lights.iter().filter(|l| l.name.starts_with(prefix)).count();
        let (lamps, windows) = (count("lamp"), count("window"));
        assert_eq!(lamps + windows + 1, village.lights.len());
        assert!((25..=50).contains(&(lamps + windows)) && windows >= 8, "{lamps} lamps, {windows} windows");
        let kinds = |is: fn(&LightKind) -> bool| village.lights.iter().filter(|l| is(&l.kind)).count();
        assert!(kinds(|k| matches!(k, LightKind::Point)) >= 6);
        assert!(kinds(|k| matches!(k, LightKind::Spot { .. })) >= 12);
        assert_eq!(village.lights[0].intensity, 0.3);
        let lamp = |l: &&crate::model::Light| l.kind != LightKind::Directional;
        assert!(village.lights.iter().filter(lamp).all(|l| (100.0..=800.0).contains(&l.intensity)));
        assert!(village.materials.iter().any(|m| m.emissive[0] > 1.0));
    }
}

#[test]
fn the_city_gets_exactly_the_lamps_asked_for() {
    for (scale, lamps) in [(0.1, 1), (0.1, 400), (0.3, 1), (0.3, 165), (0.3, 400), (1.0, 165)] {
        let city = lit_city(scale, lamps);
        let spots = &city.lights[1..];
        assert_eq!(spots.len(), lamps as usize);
        for (i, light) in spots.iter().enumerate() {
            assert_eq!(light.name, format!("spot{:03}", i + 1));
            let LightKind::Spot { outer_angle, .. } = light.kind else { panic!("{} is no spot", light.name) };
            assert!((50.0..=60.0).contains(&outer_angle.to_degrees()), "{}", light.name);
            assert!((25.0..=40.0).contains(&light.range_m.expect("a range")), "{}", light.name);
            assert!((8.0..=12.0).contains(&light.position_world.y), "{}", light.name);
        }
        all_different(city.lights.iter().map(|l| l.name.as_str()));
        check_lights(&city);
    }
}

#[test]
fn lamps_are_spread_evenly_and_more_of_them_leave_the_earlier_ones() {
    let (few, many) = (lit_city(1.0, 100), lit_city(1.0, 165));
    for (a, b) in few.lights.iter().zip(&many.lights) {
        assert_eq!((a.position_world, a.direction_world, a.kind), (b.position_world, b.direction_world, b.kind));
    }
    let at: Vec<DVec3> = many.lights[1..].iter().map(|l| l.position_world).collect();
    for (i, a) in at.iter().enumerate() {
        let nearest = at.iter().enumerate().filter(|(k, _)| *k != i).map(|(_, b)| (*a - *b).length());
        let nearest = nearest.fold(f64::INFINITY, f64::min);
        assert!((40.0..150.0).contains(&nearest), "the nearest of spot {i} is {nearest} m away");
    }
}

#[test]
fn lamps_leave_the_rest_of_the_city_as_it_was() {
    let (dark, mut lit) = (lit_city(0.3, 0), lit_city(0.3, 30));
    assert_eq!(dark.lights.len(), 1);
    let posts = lit.nodes.pop().expect("nodes");
    assert!(posts.name.starts_with("lamps-") && posts.mesh == lit.meshes.len() - 1);
    super::check_closed(&lit);
    super::check_sound(&lit);
    lit.meshes.pop();
    assert_eq!(fingerprint(&dark), fingerprint(&lit));
}
