//! The market: what moves, what stays, and that nothing shuts a light in.

use glam::DVec3;

use super::lights::winding;
use super::palace::blocked;
use super::scene;
use crate::model::{AreaShape, Light, LightKind, Scene};

/// Lights but the moon that move, or that do not.
fn lamps(scene: &Scene, dynamic: bool) -> impl Iterator<Item = &Light> {
    scene.lights.iter().filter(move |l| l.kind != LightKind::Directional && l.dynamic == dynamic)
}

#[test]
fn it_has_moving_and_still_lights_and_casters() {
    for (seed, scale) in [(1, 0.05), (2, 0.5), (7, 1.0), (12_345, 2.0)] {
        let market = scene("market", seed, scale);
        let (moving, still) = (lamps(&market, true).count(), lamps(&market, false).count());
        assert!((8..=12).contains(&moving) && (10..=16).contains(&still), "{moving} move, {still} stay");
        assert_eq!(moving + still + 1, market.lights.len());
        assert!(!market.lights[0].dynamic);
        let casters = market.nodes.iter().filter(|n| n.dynamic).count() - moving;
        assert!((6..=10).contains(&casters), "{casters} people and carts");
        let kinds = |is: fn(&LightKind) -> bool| lamps(&market, false).filter(|l| is(&l.kind)).count();
        assert!(kinds(|k| *k == LightKind::Point) >= 6 && kinds(|k| matches!(k, LightKind::Spot { .. })) >= 3);
    }
}

#[test]
fn each_moving_light_is_the_middle_of_the_moving_node_of_its_name() {
    let market = scene("market", 3, 1.0);
    for light in lamps(&market, true) {
        let named: Vec<_> = market.nodes.iter().filter(|n| n.name == light.name).collect();
        assert_eq!(named.len(), 1, "{}", light.name);
        assert!(named[0].dynamic && named[0].world_from_mesh.translation == light.position_world, "{}", light.name);
        assert_eq!(light.kind, LightKind::Point);
        assert!((15.0..=60.0).contains(&light.intensity), "{}: {} cd", light.name, light.intensity);
        assert!(light.range_m.is_some_and(|r| (10.0..=14.0).contains(&r)), "{}", light.name);
        assert!((1.2..5.0).contains(&light.position_world.y), "{} is {} high", light.name, light.position_world.y);
    }
}

#[test]
fn lights_and_cameras_stand_outside_solids() {
    for (seed, scale) in [(1, 0.05), (2, 0.3), (3, 1.0), (4, 1.5)] {
        let market = scene("market", seed, scale);
        for light in market.lights.iter().filter(|l| l.kind != LightKind::Directional) {
            assert_eq!(winding(&market, light.position_world), 0, "{} is inside something", light.name);
        }
        for camera in &market.cameras {
            assert_eq!(winding(&market, camera.eye_world), 0, "{} is inside something", camera.name);
        }
    }
}

/// Most ways out of a lamp, to where the next thing may stand, are free; of those of a lantern not all.
#[test]
fn light_gets_out_between_the_ribs() {
    let market = scene("market", 1, 0.4);
    let free = |light: &Light| {
        let way = |i: u32| {
            // Directions spread evenly over the sphere, by the golden angle.
            let (up, turn) = (1.0 - (2.0 * f64::from(i) + 1.0) / 200.0, 2.399_963 * f64::from(i));
            let flat = (1.0 - up * up).sqrt();
            DVec3::new(flat * libm::cos(turn), up, flat * libm::sin(turn))
        };
        let from = light.position_world;
        (0..200).map(way).filter(|way| !blocked(&market, from, from + *way * 0.5)).count()
    };
    for light in lamps(&market, true) {
        assert!((120..196).contains(&free(light)), "{}: {} of 200", light.name, free(light));
    }
    for light in lamps(&market, false) {
        assert!(free(light) > 140, "{}: {} of 200", light.name, free(light));
    }
}

#[test]
fn the_screen_shows_a_video_to_the_square() {
    let market = scene("market", 1, 0.3);
    let [screen] = market.area_lights.as_slice() else { panic!("one screen") };
    assert_eq!(screen.shape, AreaShape::Rectangle { width_m: 4.0, height_m: 2.25 });
    assert_eq!(screen.luminance, [500.0; 3]);
    assert!(screen.frames.len() > 1 && screen.frames.iter().all(|&f| f < market.images.len()));
    let before = screen.position_world + screen.direction_world * 1e-3;
    assert!(!blocked(&market, before, before + screen.direction_world * 1.5));
}

/// Some of the moon's light comes through the aqueduct to the square, and some does not.
#[test]
fn the_moon_shines_through_the_aqueduct() {
    let market = scene("market", 1, 0.3);
    let back = -market.lights[0].direction_world * 60.0;
    let spots = (0..400).map(|i| DVec3::new(-14.5 + 0.5 * f64::from(i % 20), 1.0, -8.0 + 0.7 * f64::from(i / 20)));
    let lit = spots.filter(|&spot| !blocked(&market, spot, spot + back)).count();
    assert!((40..360).contains(&lit), "{lit} of 400");
}

#[test]
fn triangles_grow_with_the_square_of_the_scale() {
    let count = |scale: f64| scene("market", 1, scale).triangle_count() as f64;
    let growth = count(3.0) / count(1.5);
    assert!((2.9..4.1).contains(&growth), "the market grows by {growth}");
}
