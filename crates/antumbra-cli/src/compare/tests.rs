//! Random scenes under every kind of light and every policy: a right bake is never called wrong.

use antumbra::{DepthDistribution, Interior, ShadowFile};
use antumbra_bake::light_space::Resolution;
use antumbra_bake::{BakeOptions, Blend, Inverted, ResolutionRequest, Silent, bake};
use antumbra_scene::{AlphaMode, Image, Light, LightKind, Material, Mesh, Node, Primitive, Scene, TextureRef, Wrap};
use glam::{DAffine3, DVec3};
use proptest::prelude::*;

use super::{Wish, compare};
use crate::progress::Progress;

const IDENTITY: [[f32; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

/// Triangles anywhere.
fn soup() -> impl Strategy<Value = Primitive> {
    let corner = prop_oneof![
        3 => prop::array::uniform3(-1.0f32..1.0),
        1 => prop::array::uniform3((-4i32..=4).prop_map(|c| c as f32 * 0.25)),
    ];
    prop::collection::vec(prop::array::uniform3(corner), 1..12).prop_map(|corners| Primitive {
        triangles: (0..corners.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        positions: corners.into_iter().flatten().collect(),
        ..Primitive::default()
    })
}

/// A box, sheared so that its sides have every slope, or now and then turned inside out.
fn solid() -> impl Strategy<Value = Primitive> {
    let shape = (prop::array::uniform3(-0.9f32..0.9), prop::array::uniform3(0.02f32..0.5), -0.6f32..0.6);
    (shape, prop::bool::weighted(0.15)).prop_map(|((center, half, shear), is_turned)| {
        let corner = |i: usize| {
            let [x, y, z] = [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { -half[axis] } else { half[axis] });
            [center[0] + x + shear * z, center[1] + y + shear * x, center[2] + z - shear * y]
        };
        let faces: [[u32; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        let turn = |[a, b, c]: [u32; 3]| if is_turned { [a, c, b] } else { [a, b, c] };
        Primitive {
            positions: (0..8).map(corner).collect(),
            triangles: triangles.map(turn).collect(),
            ..Primitive::default()
        }
    })
}

fn light() -> impl Strategy<Value = Light> {
    let place = prop::array::uniform3(-1.2f64..1.2);
    let direction = prop::array::uniform3(-1.0f64..1.0).prop_filter("zero", |d| d.iter().any(|c| c.abs() > 0.01));
    let cone =
        (2.0f64..90.0).prop_map(|degrees| LightKind::Spot { inner_angle: 0.0, outer_angle: degrees.to_radians() });
    let kind = prop_oneof![Just(LightKind::Directional), Just(LightKind::Point), cone];
    (kind, place, direction, 0.3f64..6.0).prop_map(|(kind, place, direction, range)| Light {
        name: "light".into(),
        kind,
        position_world: DVec3::from_array(place),
        direction_world: DVec3::from_array(direction).normalize(),
        color: [1.0; 3],
        intensity: 1.0,
        range_m: Some(range),
        dynamic: false,
    })
}

fn interior() -> impl Strategy<Value = Interior> {
    prop_oneof![
        Just(Interior::Open),
        Just(Interior::Auto),
        prop_oneof![Just(0.0), 0.0f64..0.5].prop_map(Interior::Thickness),
        prop_oneof![Just(0.0), 0.0f64..0.3].prop_map(Interior::Static),
    ]
}

/// One node for each primitive; those whose bit is set in the seed are full of holes.
fn scene(primitives: Vec<Primitive>, seed: u32) -> Scene {
    let alpha = |i: u32| (i ^ seed).wrapping_mul(0x9e37_79b9).rotate_left(13) as u8;
    let rgba = (0..16 * 8).flat_map(|i| [90, 160, 60, alpha(i)]).collect();
    let texture = TextureRef { image: 0, wrap_s: Wrap::Repeat, wrap_t: Wrap::Mirror, transform: IDENTITY };
    let holes = Material {
        base_color_texture: Some(texture),
        alpha_mode: AlphaMode::Mask,
        alpha_cutoff: 0.4,
        ..Material::default()
    };
    let mut scene = Scene {
        images: vec![Image { name: String::new(), width: 16, height: 8, rgba }],
        materials: vec![holes],
        ..Scene::default()
    };
    for (i, mut primitive) in primitives.into_iter().enumerate() {
        if seed >> i & 1 == 1 {
            primitive.texcoords =
                primitive.positions.iter().map(|p| [p[0] * 0.7 + p[1] * 0.3, p[2] * 0.5 - p[1] * 0.4]).collect();
            primitive.material = Some(0);
        }
        scene.meshes.push(Mesh { name: String::new(), primitives: vec![primitive] });
        scene.nodes.push(Node { name: String::new(), mesh: i, world_from_mesh: DAffine3::IDENTITY, dynamic: false });
    }
    scene
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 4000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_right_bake_is_never_called_wrong(
        solids in prop::collection::vec(solid(), 0..4), soup in soup(), light in light(), interior in interior(),
        near_m in prop::option::of(0.01f64..0.2), is_ndc in prop::bool::weighted(0.2), log2 in 6u32..10,
        is_masked in any::<bool>(), seed in any::<u32>(),
    ) {
        let is_sun_thickness = light.kind == LightKind::Directional && matches!(interior, Interior::Thickness(_));
        let interior = if is_sun_thickness { Interior::Auto } else { interior };
        let mut primitives = solids;
        primitives.push(soup);
        let scene = scene(primitives, if is_masked { seed } else { 0 });
        let resolution = ResolutionRequest::Texels(Resolution::new(1 << log2).expect("in range"));
        let local_depth = if is_ndc { DepthDistribution::Ndc } else { DepthDistribution::Logarithmic };
        let options = BakeOptions { interior, resolution, near_m, local_depth, threads: 1, ..BakeOptions::default() };
        let baked = bake(&scene, std::slice::from_ref(&light), &options, &Silent).expect("a bake");
        let file = ShadowFile::from_bytes(&baked.bytes).expect("a sound file");
        let wish = Wish { samples: 1000, seed: u64::from(seed), blend: Blend::Skip, inverted: Inverted::Open };
        let found = compare(&file, &scene, wish, &Progress::new(true)).expect("a comparison");
        prop_assert!(found.total().too_far == 0, "{}", found.text());
    }
}
