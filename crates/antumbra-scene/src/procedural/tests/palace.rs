//! The five scenes in the palace: one building, closed, at night, that differs in lamps and in what moves.

use glam::DVec3;

use super::lights::winding;
use super::{PALACE, scene};
use crate::model::{LightKind, Scene};

/// Whether something solid lies on the way from one point to another.
pub(super) fn blocked(scene: &Scene, from: DVec3, to: DVec3) -> bool {
    let way = to - from;
    scene.nodes.iter().any(|node| {
        scene.meshes[node.mesh].primitives.iter().any(|primitive| {
            let place = |i: u32| node.world_point(primitive.positions[i as usize]) - from;
            primitive.triangles.iter().any(|&triangle| {
                let [a, b, c] = triangle.map(place);
                let turns = [a.cross(b), b.cross(c), c.cross(a)].map(|n| n.dot(way));
                let normal = (b - a).cross(c - a);
                let t = a.dot(normal) / way.dot(normal);
                let within = turns.iter().all(|&t| t > 0.0) || turns.iter().all(|&t| t < 0.0);
                within && (1e-6..1.0).contains(&t)
            })
        })
    })
}

#[test]
fn all_but_what_moves_and_the_flags_is_the_same_palace() {
    let counts: Vec<(u64, usize)> = PALACE
        .iter()
        .map(|name| scene(name, 1, 0.3))
        .map(|s| {
            let still = s.nodes.iter().filter(|n| !n.name.starts_with("flag") && !n.name.starts_with("footlight"));
            (still.clone().map(|n| s.meshes[n.mesh].triangle_count()).sum(), still.count())
        })
        .collect();
    assert!(counts.iter().all(|count| *count == counts[0]), "{counts:?}");
}

#[test]
fn triangles_grow_with_the_square_of_the_scale() {
    for name in PALACE {
        let count = |scale: f64| scene(name, 1, scale).triangle_count() as f64;
        let growth = count(3.0) / count(1.5);
        assert!((2.9..4.1).contains(&growth), "{name} grows by {growth}");
    }
}

#[test]
fn lamps_are_in_the_palace_and_outside_its_solids() {
    for name in PALACE {
        for (seed, scale) in [(1, 0.1), (2, 1.0)] {
            let scene = scene(name, seed, scale);
            let bounds = scene.bounds(|_| true);
            assert!((1..=3).contains(&scene.lights.len()), "{name}");
            for light in &scene.lights {
                let at = light.position_world;
                assert_ne!(light.kind, LightKind::Directional, "{name}");
                assert!(at.cmpgt(bounds.min).all() && at.cmplt(bounds.max).all(), "{name}");
                assert_eq!(winding(&scene, at), 0, "{} of {name} is inside something", light.name);
            }
        }
    }
}

#[test]
fn cameras_stand_free_and_the_first_does_not_see_the_lamp() {
    for name in PALACE {
        let scene = scene(name, 1, 1.0);
        for camera in &scene.cameras {
            assert_eq!(winding(&scene, camera.eye_world), 0, "{} of {name} is inside something", camera.name);
        }
        for light in &scene.lights {
            assert!(blocked(&scene, scene.cameras[0].eye_world, light.position_world), "{name} shows {}", light.name);
        }
    }
}

#[test]
fn lamps_reach_what_they_are_aimed_at() {
    for (name, reach) in [("door", 2.0), ("grille", 2.2), ("room", 1.6), ("flag", 1.4)] {
        let scene = scene(name, 1, 1.0);
        let lamp = &scene.lights[0];
        let to = lamp.position_world + lamp.direction_world * reach;
        assert!(!blocked(&scene, lamp.position_world, to), "{name}'s lamp is shut in");
    }
}

#[test]
fn one_kind_of_thing_moves_in_each() {
    for (name, mover) in [
        ("door", Some("gallery door")),
        ("flag", Some("flag")),
        ("cellar", Some("lantern")),
        ("room", Some("chair")),
        ("grille", None),
    ] {
        let scene = scene(name, 1, 0.2);
        let moving: Vec<_> = scene.nodes.iter().filter(|n| n.dynamic).collect();
        assert_eq!(moving.is_empty(), mover.is_none(), "{name}");
        assert!(moving.iter().all(|n| mover.is_some_and(|kind| n.name.starts_with(kind))), "{name}");
    }
}
