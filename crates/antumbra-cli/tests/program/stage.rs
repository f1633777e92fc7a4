//! A stage with every kind of light and caster: a floor and walls, pillars that are solid, a sheet, a card full of holes.

use std::f64::consts::PI;

use antumbra_scene::{
    AlphaMode, Image, Light, LightKind, Material, Mesh, Node, Primitive, Scene, TextureRef, Wrap, to_glb,
};
use glam::{DAffine3, DVec3};

/// What may differ from the stage as it is baked.
#[derive(Clone, Copy, Default)]
pub struct Stage {
    /// How far everything but the floor and the walls is moved aside, metres.
    pub moved_m: f64,
    /// The card's holes are elsewhere.
    pub other_holes: bool,
}

/// Names of the stage's lights: a directional one, a point light, a spot light with one face and one with six.
pub const LIGHTS: [&str; 4] = ["sun", "lamp", "spot", "wide"];

impl Stage {
    /// The stage as a GLB file.
    pub fn glb(self) -> Vec<u8> {
        to_glb(&self.scene()).expect("a scene that can be written")
    }

    fn scene(self) -> Scene {
        let mut scene = Scene { name: "stage".into(), lights: lights(), ..Scene::default() };
        scene.images.push(holes(self.other_holes));
        let texture = TextureRef {
            image: 0,
            wrap_s: Wrap::Repeat,
            wrap_t: Wrap::Mirror,
            transform: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        };
        scene.materials.push(Material {
            name: "holes".into(),
            base_color_texture: Some(texture),
            alpha_mode: AlphaMode::Mask,
            double_sided: true,
            ..Material::default()
        });
        let aside = DVec3::new(self.moved_m, 0.0, 0.0);
        put(&mut scene, "floor", quad([-4.0, 0.0, -4.0], [0.0, 0.0, 8.0], [8.0, 0.0, 0.0]), DVec3::ZERO);
        put(&mut scene, "back", quad([-4.0, 0.0, -4.0], [8.0, 0.0, 0.0], [0.0, 3.5, 0.0]), DVec3::ZERO);
        put(&mut scene, "side", quad([-4.0, 0.0, -4.0], [0.0, 3.5, 0.0], [0.0, 0.0, 8.0]), DVec3::ZERO);
        put(&mut scene, "tall", cuboid([-1.5, 1.05, -1.0], [0.3, 1.0, 0.4]), aside);
        put(&mut scene, "low", cuboid([1.2, 0.5, 1.4], [0.5, 0.5, 0.2]), aside);
        put(&mut scene, "sheet", quad([-0.4, 0.9, -0.9], [0.1, 0.1, 0.9], [1.3, 0.05, 0.1]), aside);
        let card = Primitive {
            texcoords: vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.5], [0.0, 1.5]],
            material: Some(0),
            ..quad([1.6, 0.2, -2.4], [0.3, 0.1, 1.6], [0.1, 1.5, 0.0])
        };
        put(&mut scene, "card", card, aside);
        scene
    }
}

fn put(scene: &mut Scene, name: &str, primitive: Primitive, place: DVec3) {
    let mesh = scene.meshes.len();
    scene.meshes.push(Mesh { name: name.into(), primitives: vec![primitive] });
    let world_from_mesh = DAffine3::from_translation(place);
    scene.nodes.push(Node { name: name.into(), mesh, world_from_mesh, dynamic: false });
}

/// An open sheet between two edges.
fn quad(corner: [f32; 3], a: [f32; 3], b: [f32; 3]) -> Primitive {
    let at = |u: f32, v: f32| [0, 1, 2].map(|i| corner[i] + a[i] * u + b[i] * v);
    Primitive {
        positions: vec![at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Primitive::default()
    }
}

/// A solid box.
fn cuboid(center: [f32; 3], half: [f32; 3]) -> Primitive {
    let corner =
        |i: usize| [0, 1, 2].map(|axis| center[axis] + if i >> axis & 1 == 0 { -half[axis] } else { half[axis] });
    let faces: [[u32; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    Primitive {
        positions: (0..8).map(corner).collect(),
        triangles: faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect(),
        ..Primitive::default()
    }
}

/// Blots of alpha.
fn holes(elsewhere: bool) -> Image {
    let alpha = |i: u32| if (i % 8 / 3 + i / 8 / 2) % 2 == u32::from(elsewhere) { 255 } else { (i * 7 % 90) as u8 };
    let rgba = (0..64).flat_map(|i| [120, 160, 60, alpha(i)]).collect();
    Image { name: "holes".into(), width: 8, height: 8, rgba }
}

fn lights() -> Vec<Light> {
    let light = |name: &str, kind, place: [f64; 3], towards: [f64; 3], range_m| Light {
        name: name.into(),
        kind,
        position_world: DVec3::from_array(place),
        direction_world: (DVec3::from_array(towards) - DVec3::from_array(place)).normalize(),
        color: [1.0; 3],
        intensity: 10.0,
        range_m,
        dynamic: false,
    };
    let cone = |degrees: f64| LightKind::Spot { inner_angle: 0.0, outer_angle: degrees * PI / 180.0 };
    let [sun, lamp, spot, wide] = LIGHTS;
    vec![
        light(sun, LightKind::Directional, [0.0, 9.0, 0.0], [3.6, 0.0, 2.7], None),
        light(lamp, LightKind::Point, [0.1, 2.2, 0.2], [0.1, 0.0, 0.2], Some(6.0)),
        light(spot, cone(32.0), [-3.1, 2.9, -2.7], [0.2, 0.4, -0.1], Some(9.0)),
        light(wide, cone(74.0), [2.8, 2.6, 2.9], [-0.3, 0.2, -0.4], Some(8.0)),
    ]
}
