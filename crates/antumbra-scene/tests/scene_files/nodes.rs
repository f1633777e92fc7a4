//! The hierarchy, lights and cameras.

use antumbra_scene::{AreaShape, LightKind};
use glam::{DQuat, DVec3};
use serde_json::json;

use crate::builder::{FLOAT, Glb, float_bytes};

fn close(a: DVec3, b: [f64; 3]) {
    assert!(a.abs_diff_eq(DVec3::from_array(b), 1e-12), "{a} {b:?}");
}

/// A quarter turn about Y.
const TURN: [f64; 4] = [0.0, std::f64::consts::FRAC_1_SQRT_2, 0.0, std::f64::consts::FRAC_1_SQRT_2];

#[test]
fn transforms_compose_and_meshes_are_shared() {
    let mut glb = Glb::triangle();
    glb.json["nodes"] = json!([
        { "children": [2, 1], "translation": [1e7, 0.25, 0.0] },
        { "name": "leaf", "mesh": 0, "rotation": TURN, "scale": [2.0, 1.0, 1.0] },
        { "mesh": 0, "matrix": [0, 0, -1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 5, 6, 7, 1] },
    ]);
    glb.json["scenes"] = json!([{ "nodes": [0] }]);
    let scene = glb.load();
    assert_eq!(scene.meshes.len(), 1);
    let names: Vec<_> = scene.nodes.iter().map(|n| n.name.as_str()).collect();
    assert_eq!(names, ["leaf", "node2"]);
    close(scene.nodes[0].world_point([1.0, 0.0, 0.0]), [1e7, 0.25, -2.0]);
    close(scene.nodes[1].world_point([1.0, 0.0, 0.0]), [1e7 + 5.0, 6.25, 6.0]);
    assert_eq!(scene.triangle_count(), 2);
}

#[test]
fn the_default_scene_decides() {
    let mut glb = Glb::triangle();
    glb.json["nodes"] = json!([{ "name": "a", "mesh": 0 }, { "name": "b", "mesh": 0 }, { "name": "c", "mesh": 0 }]);
    let names = |glb: &Glb| glb.load().nodes.into_iter().map(|n| n.name).collect::<Vec<_>>();
    assert_eq!(names(&glb), ["a", "b", "c"]);
    glb.json["scenes"] = json!([{ "nodes": [1] }, { "nodes": [2, 0] }]);
    assert_eq!(names(&glb), ["b"]);
    glb.json["scene"] = 1.into();
    assert_eq!(names(&glb), ["a", "c"]);
    glb.json["scene"] = 2.into();
    assert!(glb.error().contains("scene 2"));
}

#[test]
fn dynamic_is_inherited() {
    let mut glb = Glb::triangle();
    glb.json["nodes"] = json!([
        { "children": [1], "extras": { "antumbra": "dynamic" } },
        { "mesh": 0 },
        { "mesh": 0, "extras": { "antumbra": "static", "other": [1] } },
        { "mesh": 0, "extras": 7 },
    ]);
    assert_eq!(glb.load().nodes.iter().map(|n| n.dynamic).collect::<Vec<_>>(), [true, false, false]);
}

#[test]
fn lights_inherit_dynamic_too() {
    let mut glb = Glb::triangle();
    glb.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{ "type": "point" }] } });
    let shines = json!({ "KHR_lights_punctual": { "light": 0 } });
    glb.json["nodes"] = json!([
        { "children": [1], "extras": { "antumbra": "dynamic" } },
        { "children": [2], "mesh": 0 },
        { "name": "carried", "extensions": shines },
        { "name": "own", "extensions": shines, "extras": { "antumbra": "dynamic" } },
        { "name": "still", "extensions": shines, "extras": { "antumbra": "static" } },
    ]);
    let scene = glb.load();
    let lights: Vec<_> = scene.lights.iter().map(|l| (l.name.as_str(), l.dynamic)).collect();
    assert_eq!(lights, [("carried", true), ("own", true), ("still", false)]);
}

#[test]
fn cycles_and_shared_children_are_errors() {
    let mut glb = Glb::triangle();
    for (nodes, scenes) in [
        (json!([{ "children": [1] }, { "children": [0] }]), json!(null)),
        (json!([{ "children": [0] }]), json!([{ "nodes": [0] }])),
        (json!([{ "children": [1] }, { "children": [2] }, { "children": [1], "mesh": 0 }]), json!([{ "nodes": [0] }])),
        (json!([{ "children": [2] }, { "children": [2] }, { "mesh": 0 }]), json!(null)),
        (json!([{ "children": [1, 1] }, { "mesh": 0 }]), json!(null)),
    ] {
        glb.json["nodes"] = nodes;
        glb.json["scenes"] = scenes.as_array().cloned().unwrap_or_default().into();
        let message = glb.error();
        assert!(message.contains("no tree"), "{message}");
    }
    glb.json["nodes"] = json!([{ "children": [7] }]);
    assert!(glb.error().contains("node 7"));
}

#[test]
fn absurd_depth_is_an_error() {
    let mut glb = Glb::triangle();
    glb.json["nodes"] = (0..100_000).map(|i| json!({ "children": [i + 1] })).collect();
    glb.push("nodes", json!({ "mesh": 0 }));
    assert!(glb.error().contains("nested deeper"));
}

#[test]
fn impossible_transforms_are_errors() {
    let mut glb = Glb::triangle();
    for (node, part) in [
        (json!({ "mesh": 0, "rotation": [0, 0, 0, 0] }), "quaternion"),
        (json!({ "mesh": 0, "matrix": [1, 0, 0, 0.5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] }), "affine"),
        (json!({ "mesh": 0, "scale": [1e200, 1, 1] }), "absurdly large"),
        (json!({ "mesh": 0, "translation": [0, 1] }), "JSON"),
    ] {
        glb.json["nodes"] = json!([node]);
        let message = glb.error();
        assert!(message.contains(part), "{message}");
    }
}

#[test]
fn instances_become_nodes() {
    let mut glb = Glb::triangle();
    let translations = glb.floats(&[[1.0, 0.0, 0.0], [0.0, 2.0, 0.0]]);
    let scales = glb.floats(&[[1.0_f32; 3], [3.0; 3]]);
    glb.json["nodes"][0] = json!({
        "mesh": 0, "translation": [10, 0, 0], "name": "tree",
        "extensions": { "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": translations, "SCALE": scales } } },
    });
    let scene = glb.load();
    assert_eq!(scene.nodes.iter().map(|n| n.name.as_str()).collect::<Vec<_>>(), ["tree", "tree"]);
    close(scene.nodes[0].world_point([1.0, 0.0, 0.0]), [12.0, 0.0, 0.0]);
    close(scene.nodes[1].world_point([1.0, 0.0, 0.0]), [13.0, 2.0, 0.0]);
}

#[test]
fn skinned_meshes_stand_where_their_joints_put_them() {
    let mut glb = Glb::triangle();
    let bind = [[1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, -1.0, 0.0, 1.0]];
    let bind = glb.accessor(&float_bytes(&bind), FLOAT, 1, "MAT4");
    glb.json["skins"] = json!([{ "joints": [1], "inverseBindMatrices": bind }]);
    glb.json["nodes"] = json!([
        { "mesh": 0, "skin": 0, "translation": [1000, 0, 0] },
        { "translation": [0, 3, 0], "scale": [2, 2, 2] },
    ]);
    close(glb.load().nodes[0].world_point([1.0, 1.0, 0.0]), [2.0, 3.0, 0.0]);
    glb.json["skins"] = json!([{ "joints": [] }]);
    close(glb.load().nodes[0].world_point([0.0; 3]), [1000.0, 0.0, 0.0]);
    glb.json["nodes"][0]["skin"] = 1.into();
    assert!(glb.error().contains("skin 1"));
}

#[test]
fn hidden_branches_do_not_show() {
    let mut glb = Glb::triangle();
    glb.json["nodes"] = json!([
        { "children": [1], "extensions": { "KHR_node_visibility": { "visible": false } } },
        { "mesh": 0 },
        { "mesh": 0, "name": "shown", "extensions": { "KHR_node_visibility": {} } },
    ]);
    assert_eq!(glb.load().nodes.iter().map(|n| n.name.as_str()).collect::<Vec<_>>(), ["shown"]);
}

#[test]
fn lights() {
    let mut glb = Glb::triangle();
    glb.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [
        { "type": "directional", "name": "sun", "intensity": 3, "color": [1, 0.5, 0.25] },
        { "type": "point", "range": 12.5 },
        { "type": "spot", "spot": { "innerConeAngle": 0.1, "outerConeAngle": 0.5 } },
        { "type": "spot" },
    ] } });
    let light = |i: usize| json!({ "KHR_lights_punctual": { "light": i } });
    let down = DQuat::from_rotation_arc(DVec3::NEG_Z, DVec3::NEG_Y).to_array();
    glb.push("nodes", json!({ "extensions": light(0), "rotation": down, "scale": [2, 2, 2] }));
    glb.push("nodes", json!({ "extensions": light(1), "name": "lamp", "translation": [1, 2, 3] }));
    glb.push("nodes", json!({ "extensions": light(1), "name": "lamp" }));
    glb.push("nodes", json!({ "extensions": light(2), "name": "lamp" }));
    glb.push("nodes", json!({ "extensions": light(3) }));
    let lights = glb.load().lights;
    let names: Vec<_> = lights.iter().map(|l| l.name.as_str()).collect();
    assert_eq!(names, ["sun", "lamp", "lamp.2", "lamp.3", "node5"]);
    close(lights[0].direction_world, [0.0, -1.0, 0.0]);
    assert_eq!((lights[0].kind, lights[0].intensity, lights[0].color), (LightKind::Directional, 3.0, [1.0, 0.5, 0.25]));
    assert_eq!((lights[1].kind, lights[1].range_m, lights[1].intensity), (LightKind::Point, Some(12.5), 1.0));
    close(lights[1].position_world, [1.0, 2.0, 3.0]);
    assert_eq!(lights[3].kind, LightKind::Spot { inner_angle: 0.1, outer_angle: 0.5 });
    assert_eq!(lights[4].kind, LightKind::Spot { inner_angle: 0.0, outer_angle: std::f64::consts::FRAC_PI_4 });
    glb.push("nodes", json!({ "extensions": light(4) }));
    assert!(glb.error().contains("light 4"));
}

#[test]
fn area_lights() {
    let mut glb = Glb::triangle();
    let down = DQuat::from_rotation_arc(DVec3::NEG_Z, DVec3::NEG_Y).to_array();
    let extras = |more: serde_json::Value| {
        let mut extras = json!({ "antumbra": "area light", "shape": "rectangle", "width": 1.6, "height": 0.9 });
        extras.as_object_mut().expect("an object").extend(more.as_object().expect("an object").clone());
        json!({ "name": "lantern", "rotation": down, "translation": [1, 2, 3], "extras": extras })
    };
    glb.push("nodes", extras(json!({})));
    let more = json!({ "shape": "disc", "radius": 2, "luminance": 10, "color": [1, 0.5, -4], "fps": 12 });
    glb.push("nodes", extras(more));
    glb.push("nodes", json!({ "extras": { "antumbra": "something else", "shape": "rectangle" } }));
    glb.push("nodes", json!({ "extras": "no object" }));
    let lights = glb.load().area_lights;
    assert_eq!(lights.len(), 2);
    assert_eq!(lights[0].shape, AreaShape::Rectangle { width_m: 1.6, height_m: 0.9 });
    close(lights[0].position_world, [1.0, 2.0, 3.0]);
    close(lights[0].direction_world, [0.0, -1.0, 0.0]);
    assert_eq!((lights[0].luminance, lights[0].frames_per_second), ([300.0; 3], 25.0));
    assert_eq!(lights[1].shape, AreaShape::Disc { radius_m: 2.0 });
    assert_eq!((lights[1].luminance, lights[1].frames_per_second), ([10.0, 5.0, 0.0], 12.0));
    // Each wrong in one thing, which the error names.
    let wrong = [
        (json!({ "shape": "cube" }), "rectangle, disc, sphere or environment"),
        (json!({ "shape": 3 }), "rectangle, disc, sphere or environment"),
        (json!({ "shape": "disc" }), "lacks its radius"),
        (json!({ "width": 0 }), "width of 0"),
        (json!({ "height": -1 }), "height that is no number"),
        (json!({ "height": "tall" }), "height that is no number"),
        (json!({ "luminance": [1, 2, 3] }), "luminance that is no number"),
        (json!({ "fps": -25 }), "fps that is no number"),
        (json!({ "color": [1, 1] }), "not three numbers"),
        (json!({ "color": "red" }), "no list of numbers"),
        (json!({ "images": 0 }), "no list of numbers"),
        (json!({ "images": [0] }), "image 0"),
        (json!({ "images": [-1] }), "image"),
        (json!({ "images": [1e30] }), "image"),
    ];
    for (more, word) in wrong {
        let mut glb = Glb::triangle();
        glb.push("nodes", extras(more.clone()));
        let error = glb.error();
        assert!(error.contains(word), "{more}: {error}");
    }
}

#[test]
fn cameras() {
    let mut glb = Glb::triangle();
    glb.json["cameras"] = json!([
        { "type": "perspective", "name": "eye", "perspective": { "yfov": 0.7, "znear": 0.1 } },
        { "type": "orthographic", "orthographic": { "xmag": 1, "ymag": 1, "znear": 0, "zfar": 1 } },
        { "type": "perspective", "perspective": { "yfov": 7, "znear": 0.1 } },
    ]);
    glb.push("nodes", json!({ "camera": 0, "translation": [0, 5, 0], "rotation": TURN }));
    glb.push("nodes", json!({ "camera": 1 }));
    glb.push("nodes", json!({ "camera": 0, "name": "eye" }));
    let cameras = glb.load().cameras;
    assert_eq!(cameras.iter().map(|c| c.name.as_str()).collect::<Vec<_>>(), ["eye", "eye.2"]);
    close(cameras[0].eye_world, [0.0, 5.0, 0.0]);
    close(cameras[0].forward_world, [-1.0, 0.0, 0.0]);
    close(cameras[0].up_world, [0.0, 1.0, 0.0]);
    assert_eq!(cameras[0].fov_y, 0.7);
    glb.push("nodes", json!({ "camera": 2 }));
    assert!(glb.error().contains("field of view"));
}
