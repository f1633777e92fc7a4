//! Small scenes, one camera, and hand-made shadow files.

use antumbra::{LightRecord, ShadowFile, format};
use antumbra_render::{Picture, RenderOptions, ShadowSource, look_at, render};
use antumbra_scene::{Camera, Light, LightKind, Material, Mesh, Node, Primitive, Scene};
use glam::{DAffine3, DVec3};

pub const SILENT: &(dyn Fn(usize, usize) + Sync) = &|_, _| {};

pub fn sun(direction: DVec3) -> Light {
    Light {
        name: "sun".into(),
        kind: LightKind::Directional,
        position_world: DVec3::ZERO,
        direction_world: direction.normalize(),
        color: [1.0; 3],
        intensity: 1.0,
        range_m: None,
        dynamic: false,
    }
}

pub fn quad(corners: [[f32; 3]; 4], material: usize) -> Primitive {
    Primitive {
        positions: corners.to_vec(),
        texcoords: vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        material: Some(material),
        ..Primitive::default()
    }
}

/// Level, facing up, by its extent in x and z.
pub fn level(x: [f32; 2], y: f32, z: [f32; 2], material: usize) -> Primitive {
    quad([[x[0], y, z[1]], [x[1], y, z[1]], [x[1], y, z[0]], [x[0], y, z[0]]], material)
}

pub fn scene(primitives: Vec<Primitive>, materials: Vec<Material>, light: Light) -> Scene {
    let node = Node { name: "node".into(), mesh: 0, world_from_mesh: DAffine3::IDENTITY, dynamic: false };
    Scene {
        meshes: vec![Mesh { name: "mesh".into(), primitives }],
        nodes: vec![node],
        materials,
        lights: vec![light],
        ..Scene::default()
    }
}

/// Looks straight down from 10 m: a picture of 64 x 64 pixels shows x and z from -4 to 4, an eighth of a metre each.
pub fn from_above() -> Camera {
    let fov_y = 2.0 * 0.4_f64.atan();
    look_at(DVec3::Y * 10.0, DVec3::ZERO, fov_y).expect("a camera")
}

pub fn options() -> RenderOptions {
    RenderOptions { width: 64, height: 64, samples: 4, ao_samples: 0, ..RenderOptions::default() }
}

pub fn picture(scene: &Scene, options: &RenderOptions, shadows: ShadowSource<'_>) -> Picture {
    render(scene, &from_above(), options, shadows, SILENT).expect("a picture")
}

/// Green radiance at the pixel that shows a point of the ground.
pub fn at(picture: &Picture, x: f64, z: f64) -> f32 {
    let pixel = |c: f64| ((c + 4.0) * 8.0) as usize;
    picture.hdr()[pixel(z) * 64 + pixel(x)][1]
}

pub fn cluttered() -> Scene {
    let plates = (0..40).map(|i| {
        let (x, y, z) = ((i % 7) as f32 - 3.0, 0.3 + (i % 5) as f32 * 0.4, (i / 7) as f32 - 3.0);
        level([x, x + 0.6], y, [z, z + 0.7], 0)
    });
    let mut primitives: Vec<Primitive> = plates.collect();
    primitives.push(level([-9.0, 9.0], 0.0, [-9.0, 9.0], 0));
    scene(primitives, vec![Material::default()], sun(DVec3::new(0.3, -1.0, -0.5)))
}

/// A file whose light is all lit or all shadowed.
pub fn uniform_file(name: &str, root: u32) -> ShadowFile {
    file(sun_record(name, root), name)
}

fn sun_record(name: &str, root: u32) -> LightRecord {
    LightRecord {
        name_offset: 0,
        name_length: name.len() as u32,
        kind: 0,
        log2_resolution: 6,
        interior: 0,
        encoding: 0,
        roots: [root, 0, 0, 0, 0, 0],
        interior_parameter_m: 0.0,
        texel_size_m: 1.0,
        slice_size_m: 1.0,
        near_m: 0.0,
        far_m: 0.0,
        cone_cosine: 0.0,
        origin_world: [0.0; 3],
        linear: [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]],
        voxel_of_origin: [32.0; 3],
        direction_world: [0.0, -1.0, 0.0],
        faces: 1,
        depth: 0,
        texels_per_tangent: 0.0,
    }
}

/// A file whose point light has the given roots: of the faces +x, -x, +y, -y, +z, -z.
pub fn point_file(name: &str, origin_world: DVec3, roots: [u32; 6]) -> ShadowFile {
    let light = LightRecord {
        kind: 2,
        roots,
        slice_size_m: 0.0,
        near_m: 0.01,
        far_m: 100.0,
        origin_world: origin_world.to_array(),
        linear: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        voxel_of_origin: [0.0; 3],
        direction_world: [0.0; 3],
        faces: 6,
        depth: 1,
        texels_per_tangent: f64::from(32 - antumbra::FACE_BORDER),
        ..sun_record(name, 0)
    };
    file(light, name)
}

fn file(light: LightRecord, name: &str) -> ShadowFile {
    // No nodes: just the pool's header.
    let pool = [0; format::dag8::POOL_HEADER_WORDS];
    let lights = [light];
    let contents = format::write::Contents::new(&lights, name, &pool, Default::default());
    ShadowFile::from_bytes(&format::write::write(&contents)).expect("a valid file")
}
