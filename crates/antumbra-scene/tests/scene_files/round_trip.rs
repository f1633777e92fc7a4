//! What is written comes back.

use antumbra_scene::procedural::{Options, build};
use antumbra_scene::{
    AlphaMode, AreaLight, AreaShape, Camera, Dropped, Image, Light, LightKind, Material, Mesh, Node, Primitive, Scene,
    SceneError, TextureRef, Wrap, load_glb_slice, to_glb,
};
use glam::{DAffine3, DMat3, DVec3};

/// A scene that uses everything the model has.
fn sample() -> Scene {
    let positions = vec![[0.1, 0.2, 0.3], [1.0, -0.0, 1e-30], [7.0, 1e20, 0.7], [0.0; 3], [1.0; 3], [2.0; 3]];
    let primitive = Primitive {
        normals: vec![[0.0, 1.0, 0.0]; 6],
        texcoords: vec![[0.3, 0.7]; 6],
        colors: vec![[0.1, 0.2, 0.3, 0.4]; 6],
        triangles: vec![[0, 1, 2], [2, 1, 4]],
        seams: vec![[3, 4, 5]],
        material: Some(0),
        positions,
    };
    let plain = Primitive { normals: vec![], texcoords: vec![], colors: vec![], material: None, ..primitive.clone() };
    let direction = DVec3::new(0.3, -0.8, 0.1).normalize();
    let forward = DVec3::new(1.0, -2.0, 3.0).normalize();
    let world_from_mesh = DAffine3 {
        matrix3: DMat3::from_cols(
            DVec3::new(0.1, 0.2, 0.3),
            DVec3::new(-1.0, 0.7, 1e-9),
            DVec3::new(5.0, 1.0 / 3.0, 2.0),
        ),
        translation: DVec3::new(123_456.789, 0.1, -1e7),
    };
    let light = |name: &str, kind| Light {
        name: name.to_owned(),
        kind,
        position_world: DVec3::new(0.1, 2.0, 1.0 / 3.0),
        direction_world: direction,
        color: [0.1, 0.9, 1.0],
        intensity: 12.3,
        range_m: (kind != LightKind::Directional).then_some(0.7),
        dynamic: false,
    };
    Scene {
        name: "sample".to_owned(),
        meshes: vec![
            Mesh { name: "first".to_owned(), primitives: vec![primitive, plain.clone()] },
            Mesh { name: "second".to_owned(), primitives: vec![plain] },
        ],
        nodes: vec![
            Node { name: "a".to_owned(), mesh: 0, world_from_mesh, dynamic: true },
            Node { name: "b".to_owned(), mesh: 1, world_from_mesh: DAffine3::IDENTITY, dynamic: false },
            Node { name: "a".to_owned(), mesh: 0, world_from_mesh: DAffine3::IDENTITY, dynamic: false },
        ],
        materials: vec![
            Material {
                name: "leaf".to_owned(),
                base_color: [0.1, 0.2, 0.3, 0.4],
                base_color_texture: Some(TextureRef {
                    image: 0,
                    wrap_s: Wrap::Clamp,
                    wrap_t: Wrap::Mirror,
                    transform: [[0.6, 0.8, 0.25], [-1.2, 0.9, 3.0]].map(|[a, b, c]| [a, b * 0.5, c]),
                }),
                emissive: [9.7, 0.1, 0.0],
                metallic: 0.3,
                roughness: 0.7,
                alpha_mode: AlphaMode::Mask,
                alpha_cutoff: 0.4,
                double_sided: true,
            },
            Material { name: "glass".to_owned(), alpha_mode: AlphaMode::Blend, ..Material::default() },
        ],
        images: vec![Image { name: "p".to_owned(), width: 2, height: 1, rgba: vec![1, 2, 3, 4, 250, 251, 252, 253] }],
        lights: vec![
            light("sun", LightKind::Directional),
            Light { dynamic: true, ..light("lamp", LightKind::Point) },
            light("spot", LightKind::Spot { inner_angle: 0.1, outer_angle: 0.7 }),
        ],
        area_lights: vec![AreaLight {
            name: "screen".to_owned(),
            shape: AreaShape::Rectangle { width_m: 1.0 / 3.0, height_m: 0.7 },
            position_world: DVec3::new(0.1, 2.0, 1.0 / 3.0),
            direction_world: forward,
            up_world: (DVec3::Y - forward * forward.y).normalize(),
            luminance: [0.1, 300.7, 1.0 / 3.0],
            frames: vec![0, 0],
            frames_per_second: 0.1,
        }],
        cameras: vec![Camera {
            name: "overview".to_owned(),
            eye_world: DVec3::new(0.1, 0.2, 0.3),
            forward_world: forward,
            up_world: (DVec3::Y - forward * forward.y).normalize(),
            fov_y: 0.9,
        }],
        dropped: Dropped { zero_area: 3, ..Dropped::default() },
        copyright: Some("(c) somebody".to_owned()),
    }
}

/// Floats compare by their digits, which `Debug` writes in full.
fn same(a: impl std::fmt::Debug, b: impl std::fmt::Debug) {
    assert_eq!(format!("{a:?}"), format!("{b:?}"));
}

#[test]
fn everything_comes_back() {
    let mut scene = sample();
    // A rotation and a scale, as glTF would have it.
    let (sin, cos) = 0.7_f32.sin_cos();
    scene.materials[0].base_color_texture.as_mut().expect("has one").transform =
        [[cos * 2.0, sin * 0.5, 0.25], [-sin * 2.0, cos * 0.5, 3.0]];
    let bytes = to_glb(&scene).expect("writes");
    let mut back = load_glb_slice(&bytes, "sample").expect("loads");
    let (texture, texture_back) = (
        scene.materials[0].base_color_texture.take().expect("had one"),
        back.materials[0].base_color_texture.take().expect("came back"),
    );
    for (a, b) in texture.transform.iter().flatten().zip(texture_back.transform.iter().flatten()) {
        assert!((a - b).abs() < 1e-6, "{a} {b}");
    }
    same(
        (texture.image, texture.wrap_s, texture.wrap_t),
        (texture_back.image, texture_back.wrap_s, texture_back.wrap_t),
    );
    same(&back.meshes, &scene.meshes);
    same(&back.nodes, &scene.nodes);
    same(&back.materials, &scene.materials);
    same(&back.images, &scene.images);
    same(&back.cameras, &scene.cameras);
    same(&back.area_lights, &scene.area_lights);
    same(&back.copyright, &scene.copyright);
    same(back.dropped, scene.dropped);
    for (a, b) in back.lights.iter().zip(&scene.lights) {
        assert_eq!(a.direction_world, b.direction_world);
        same((&a.name, a.kind, a.position_world, a.color), (&b.name, b.kind, b.position_world, b.color));
        same((a.intensity, a.range_m, a.dynamic), (b.intensity, b.range_m, b.dynamic));
    }
    assert_eq!(to_glb(&scene).expect("writes"), to_glb(&back).expect("writes"));
}

#[test]
fn large_meshes_get_wide_indices() {
    let mut scene = sample();
    let primitive = &mut scene.meshes[1].primitives[0];
    primitive.positions = (0..70_000_u32).map(|i| [i as f32, (i % 2) as f32, (i % 3) as f32]).collect();
    primitive.triangles = (0..69_998).map(|i| [i, i + 1, i + 2]).collect();
    primitive.seams.clear();
    scene.materials[0].base_color_texture = None;
    let back = load_glb_slice(&to_glb(&scene).expect("writes"), "sample").expect("loads");
    same(&back.meshes[1], &scene.meshes[1]);
}

#[test]
fn the_header_and_bounds_are_right() {
    let mut scene = sample();
    scene.materials[0].base_color_texture = None;
    let bytes = to_glb(&scene).expect("writes");
    assert_eq!(bytes, to_glb(&scene).expect("writes"));
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().expect("four bytes")) as usize;
    assert_eq!((word(4), word(8)), (2, bytes.len()));
    let json: serde_json::Value = serde_json::from_slice(&bytes[20..20 + word(12)]).expect("JSON");
    assert_eq!(json["asset"]["generator"], "antumbra");
    assert_eq!(json["accessors"][0]["min"], serde_json::json!([0.0, -0.0, 0.0]));
    assert_eq!(json["accessors"][0]["max"], serde_json::json!([7.0, 1e20_f32, 2.0]));
    assert_eq!(word(20 + word(12)), json["buffers"][0]["byteLength"].as_u64().expect("a length") as usize);
}

#[test]
fn scenes_that_break_the_model_are_refused() {
    type Break = fn(&mut Scene);
    let breaks: [(&str, Break); 7] = [
        ("vertex 6", |s| s.meshes[0].primitives[0].triangles.push([0, 1, 6])),
        ("1 normals", |s| s.meshes[0].primitives[0].normals.truncate(1)),
        ("material 2", |s| s.meshes[0].primitives[0].material = Some(2)),
        ("mesh 9", |s| s.nodes[0].mesh = 9),
        ("not finite", |s| s.nodes[0].world_from_mesh.translation.x = f64::NAN),
        ("pixels", |s| s.images[0].width = 3),
        ("shear", |_| ()),
    ];
    for (part, damage) in breaks {
        let mut scene = sample();
        if part != "shear" {
            scene.materials[0].base_color_texture = None;
        }
        damage(&mut scene);
        match to_glb(&scene) {
            Err(error @ SceneError::Unwritable { .. }) => {
                assert!(error.to_string().contains(part) && error.to_string().contains("sample"), "{error}");
            }
            other => panic!("{part}: {:?}", other.map(|b| b.len())),
        }
    }
}

#[test]
fn procedural_scenes_come_back() {
    for (name, lamps) in [("ruins", 0), ("village", 0), ("market", 0), ("city", 7)] {
        let options = Options { scale: 0.1, lamps, ..Options::default() };
        let scene = build(name, &options).expect("a scene");
        let back = load_glb_slice(&to_glb(&scene).expect("writes"), name).expect("loads");
        assert_eq!(back.dropped.total(), 0, "{name}");
        // Meshes come back in the order in which nodes show them.
        assert_eq!((back.meshes.len(), back.nodes.len()), (scene.meshes.len(), scene.nodes.len()));
        for (a, b) in back.nodes.iter().zip(&scene.nodes) {
            same(&back.meshes[a.mesh], &scene.meshes[b.mesh]);
            same((&a.name, a.world_from_mesh, a.dynamic), (&b.name, b.world_from_mesh, b.dynamic));
        }
        same(&back.lights, &scene.lights);
        same(&back.cameras, &scene.cameras);
        same(&back.area_lights, &scene.area_lights);
        // Images come back in the order in which materials show them.
        assert_eq!((back.materials.len(), back.images.len()), (scene.materials.len(), scene.images.len()));
        for (a, b) in back.materials.iter().zip(&scene.materials) {
            same_looks(a, b);
            let image = |s: &Scene, m: &Material| m.base_color_texture.map(|t| s.images[t.image].clone());
            same(image(&back, a), image(&scene, b));
        }
    }
}

/// All the same; a texture's transform but for rounding, for it is written as offset, rotation and scale.
fn same_looks(back: &Material, written: &Material) {
    let without_texture = |m: &Material| Material { base_color_texture: None, ..m.clone() };
    same(without_texture(back), without_texture(written));
    let textures = (back.base_color_texture, written.base_color_texture);
    let (Some(back), Some(written)) = textures else {
        return assert!(textures.0.is_none() && textures.1.is_none(), "{}", written.name);
    };
    same((back.wrap_s, back.wrap_t), (written.wrap_s, written.wrap_t));
    for (a, b) in back.transform.iter().flatten().zip(written.transform.iter().flatten()) {
        assert!((a - b).abs() < 1e-6, "{a} {b}");
    }
}
