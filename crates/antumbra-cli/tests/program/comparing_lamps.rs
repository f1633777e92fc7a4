//! compare on lamps, policies and alpha masks: what is right passes, what lies a few texels aside does not.

use std::fs;
use std::path::Path;

use antumbra_scene::{
    AlphaMode, Image, Light, LightKind, Material, Mesh, Node, Primitive, Scene, TextureRef, Wrap, to_glb,
};
use glam::{DAffine3, DVec3};
use serde_json::Value;

use crate::folder::{folder, run};

/// A box from one corner to another.
fn cuboid(min: [f32; 3], max: [f32; 3]) -> Primitive {
    let corner = |i: usize| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { min[axis] } else { max[axis] });
    let faces: [[u32; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Primitive { positions: (0..8).map(corner).collect(), triangles, ..Primitive::default() }
}

/// An upright sheet full of holes.
fn leaves() -> Primitive {
    Primitive {
        positions: vec![[-1.5, 0.2, 0.8], [1.5, 0.2, 1.1], [1.5, 2.2, 1.0], [-1.5, 2.2, 0.7]],
        texcoords: vec![[0.0, 2.0], [3.0, 2.0], [3.0, 0.0], [0.0, 0.0]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        material: Some(0),
        ..Primitive::default()
    }
}

fn light(name: &str, kind: LightKind, position: DVec3) -> Light {
    Light {
        name: name.into(),
        kind,
        position_world: position,
        direction_world: DVec3::new(0.3, -1.0, -0.5).normalize(),
        color: [1.0; 3],
        intensity: 100.0,
        range_m: Some(9.0),
    }
}

/// A yard with solids, open sheets and leaves, casters moved aside by so much, lights not.
fn yard(aside_m: f64) -> Scene {
    let opaque_board =
        Primitive { positions: leaves().positions.iter().map(|p| [p[0], p[1], -p[2]]).collect(), ..leaves() };
    let opaque_board = Primitive { material: None, texcoords: Vec::new(), ..opaque_board };
    let primitives = vec![
        cuboid([-4.0, -0.3, -4.0], [4.0, 0.0, 4.0]),
        cuboid([-0.6, 0.0, -2.4], [0.3, 1.7, -2.0]),
        cuboid([1.2, 0.0, -0.9], [1.5, 0.6, -0.2]),
        opaque_board,
        leaves(),
    ];
    let holes =
        |i: u32| [60, 120, 40, if (i / 16 / 4 + i % 16 / 3).is_multiple_of(2) { 255 } else { (i * 7 % 120) as u8 }];
    let image = Image { name: "leaves".into(), width: 16, height: 16, rgba: (0..256).flat_map(holes).collect() };
    // Turned and stretched.
    let transform = [[1.0, 0.6, 0.05], [-0.75, 0.8, 0.2]];
    let texture = TextureRef { image: 0, wrap_s: Wrap::Mirror, wrap_t: Wrap::Repeat, transform };
    let material = Material {
        alpha_mode: AlphaMode::Mask,
        alpha_cutoff: 0.5,
        base_color_texture: Some(texture),
        ..Material::default()
    };
    let spot = |degrees: f64| LightKind::Spot { inner_angle: 0.1, outer_angle: degrees.to_radians() };
    Scene {
        meshes: primitives.into_iter().map(|p| Mesh { name: String::new(), primitives: vec![p] }).collect(),
        nodes: (0..5)
            .map(|mesh| Node {
                name: format!("node{mesh}"),
                mesh,
                world_from_mesh: DAffine3::from_translation(DVec3::new(aside_m, 0.0, 0.0)),
                dynamic: false,
            })
            .collect(),
        materials: vec![material],
        images: vec![image],
        lights: vec![
            light("sun", LightKind::Directional, DVec3::ZERO),
            light("lamp", LightKind::Point, DVec3::new(0.4, 2.6, 0.3)),
            light("narrow", spot(40.0), DVec3::new(-0.5, 3.5, 1.9)),
            light("wide", spot(80.0), DVec3::new(0.2, 3.0, -0.4)),
        ],
        ..Scene::default()
    }
}

fn write_yard(path: &Path, aside_m: f64) {
    fs::write(path, to_glb(&yard(aside_m)).expect("a scene that fits")).expect("a file");
}

const POLICIES: [&str; 4] = ["open", "auto", "thickness=0.3", "static=0.1"];

#[test]
fn every_light_agrees_under_every_policy_and_is_found_out_when_aside() {
    let folder = folder();
    write_yard(&folder.path().join("yard.glb"), 0.0);
    write_yard(&folder.path().join("moved.glb"), 0.15);
    for policy in POLICIES {
        run(folder.path(), &format!("bake {{yard.glb}} -o {{b}} --resolution 512 --interior {policy}")).ok();
        let right = run(folder.path(), "compare {b} {yard.glb} --samples 4000 --json").json();
        assert_eq!((&right["ok"], right["lights"].as_array().map(Vec::len)), (&true.into(), Some(4)), "{policy}");
        assert_eq!(right["left_open"] == 0, !policy.contains('='), "{policy}");
        let wrong = run(folder.path(), "compare {b} {moved.glb} --samples 4000 --json");
        assert_eq!(wrong.code, 1, "{policy}");
        let wrong: Value = serde_json::from_str(&wrong.stdout).expect("JSON alone on stdout");
        for light in wrong["lights"].as_array().expect("lights") {
            let found = ["air", "off_surfaces"].iter().any(|kind| light[kind]["too_far"] != 0);
            assert!(found, "{policy}: {} passed although the casters have moved", light["name"]);
        }
    }
}

/// Leaves that are held against a scene where they are a board, or the other way round.
#[test]
fn masks_count() {
    let folder = folder();
    write_yard(&folder.path().join("yard.glb"), 0.0);
    let mut solid = yard(0.0);
    solid.materials[0].alpha_mode = AlphaMode::Opaque;
    fs::write(folder.path().join("solid.glb"), to_glb(&solid).expect("a scene that fits")).expect("a file");
    for (baked, compared) in [("yard.glb", "solid.glb"), ("solid.glb", "yard.glb")] {
        run(folder.path(), &format!("bake {{{baked}}} -o {{b}} --resolution 512")).ok();
        run(folder.path(), &format!("compare {{b}} {{{baked}}} --samples 2000")).ok();
        let done = run(folder.path(), &format!("compare {{b}} {{{compared}}} --samples 4000 --json"));
        assert_eq!(done.code, 1, "{baked} passed for {compared}");
    }
}

/// A bake that leaves more open than it says, or less shadow than a margin promises, is found out.
#[test]
fn a_policy_is_held_to_its_word() {
    let folder = folder();
    write_yard(&folder.path().join("yard.glb"), 0.0);
    let lies: [(&str, f64); 2] = [("thickness=1.5", 0.2), ("static=0.02", 1.2)];
    for (policy, said) in lies {
        run(folder.path(), &format!("bake {{yard.glb}} -o {{b}} --resolution 512 --interior {policy}")).ok();
        run(folder.path(), "compare {b} {yard.glb} --samples 4000").ok();
        let bytes = fs::read(folder.path().join("b")).expect("a bake");
        let file = antumbra::ShadowFile::from_bytes(&bytes).expect("a sound bake");
        let records: Vec<antumbra::LightRecord> = file
            .lights()
            .map(|light| antumbra::LightRecord { interior_parameter_m: said, ..*light.record() })
            .collect();
        let names: String = file.lights().map(antumbra::LightShadow::name).collect();
        let stats = file.stats().expect("statistics");
        let contents = antumbra::format::write::Contents::new(&records, &names, file.pool(), stats);
        fs::write(folder.path().join("lie"), antumbra::format::write::write(&contents)).expect("a file");
        let done = run(folder.path(), "compare {lie} {yard.glb} --samples 20000 --json");
        assert_eq!(done.code, 1, "{policy} passed for {said} m");
    }
}
