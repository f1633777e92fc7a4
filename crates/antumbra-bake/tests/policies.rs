//! Every kind of light under every policy, against the oracle: every texel of every face, on random and nasty scenes with
//! alpha-masked triangles.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod common;

use std::f64::consts::{PI, TAU};

use antumbra::{DepthDistribution, Interior};
use antumbra_bake::casters::{Blend, CasterOptions, Casters, Inverted};
use antumbra_bake::{BakeOptions, Encoding};
use antumbra_scene::{AlphaMode, Image, Light, Material, Scene, TextureRef, Wrap};
use common::{
    TestMesh, bake_for_check, check_all, cuboid, lamp, loose, options, scene, solid, soup, spot, sun, turned,
};
use glam::{DAffine3, DVec3};
use proptest::prelude::*;

/// A wavy sheet of many triangles that share their edges.
fn sheet() -> impl Strategy<Value = TestMesh> {
    (prop::array::uniform4(-0.6f32..0.6), -1.0f32..1.0).prop_map(|([a, b, c, d], height)| {
        let point = |i: u32| {
            let (x, z) = ((i % 9) as f32 / 4.0 - 1.0, (i / 9) as f32 / 4.0 - 1.0);
            [x, height + a * x * z + b * x * x + c * z + d * x, z]
        };
        let cell = |i: u32| {
            let at = i / 8 * 9 + i % 8;
            [[at, at + 9, at + 1], [at + 1, at + 9, at + 10]]
        };
        ((0..81).map(point).collect(), (0..64).flat_map(cell).collect())
    })
}

fn meshes() -> impl Strategy<Value = Vec<TestMesh>> {
    let few_solids = prop::collection::vec(solid(), 0..4);
    (few_solids, prop::option::of(soup(16)), prop::option::of(sheet())).prop_map(|(mut meshes, soup, sheet)| {
        meshes.extend(soup);
        meshes.extend(sheet);
        meshes
    })
}

fn light() -> impl Strategy<Value = Light> {
    let place = || {
        prop_oneof![
            3 => prop::array::uniform3(-1.2f64..1.2),
            1 => prop::array::uniform3((-4i32..=4).prop_map(|c| f64::from(c) * 0.25)),
        ]
    };
    let direction = || prop::array::uniform3(-1.0f64..1.0).prop_filter("zero", |d| d.iter().any(|c| c.abs() > 0.01));
    prop_oneof![
        direction().prop_map(sun),
        (place(), 0.3f64..6.0).prop_map(|(p, range)| lamp(p, range)),
        (place(), direction(), 2.0f64..90.0, 0.3f64..6.0).prop_map(|(p, d, angle, range)| spot(p, d, angle, range)),
    ]
}

fn interior() -> impl Strategy<Value = Interior> {
    prop_oneof![
        Just(Interior::Open),
        Just(Interior::Auto),
        prop_oneof![Just(0.0), 0.0f64..0.5].prop_map(Interior::Thickness),
        prop_oneof![Just(0.0), 0.0f64..0.3].prop_map(Interior::Static),
    ]
}

fn distribution() -> impl Strategy<Value = DepthDistribution> {
    prop_oneof![4 => Just(DepthDistribution::Logarithmic), 1 => Just(DepthDistribution::Ndc)]
}

/// Gives a share of the nodes' meshes a texture full of holes, with coordinates all over it.
fn mask(scene: &mut Scene, seed: u32) {
    let noise = |i: u32| (i ^ seed).wrapping_mul(0x9e37_79b9).rotate_left(13).wrapping_mul(0x85eb_ca6b);
    let rgba = (0..16 * 8).flat_map(|i| [90, 160, 60, if noise(i) & 1 == 0 { 0 } else { (noise(i) >> 8) as u8 | 64 }]);
    scene.images.push(Image { name: "holes".into(), width: 16, height: 8, rgba: rgba.collect() });
    let wraps = [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp];
    let transform = [[1.3, 0.2, 0.1], [-0.4, 0.9, 0.3]];
    let (wrap_s, wrap_t) = (wraps[seed as usize % 3], wraps[(seed / 3) as usize % 3]);
    let texture = TextureRef { image: 0, wrap_s, wrap_t, transform };
    scene.materials.push(Material {
        base_color_texture: Some(texture),
        alpha_mode: AlphaMode::Mask,
        alpha_cutoff: 0.4,
        ..Material::default()
    });
    for (m, mesh) in scene.meshes.iter_mut().enumerate() {
        if (seed >> m) & 1 == 1 {
            continue;
        }
        let primitive = &mut mesh.primitives[0];
        let place = |p: &[f32; 3]| [p[0] * 1.7 + p[1] * 0.3, p[2] * 1.1 - p[1] * 0.8];
        primitive.texcoords = primitive.positions.iter().map(place).collect();
        if seed & 64 != 0 {
            primitive.colors =
                (0..primitive.positions.len()).map(|i| [1.0, 1.0, 1.0, 0.5 + 0.1 * (i % 6) as f32]).collect();
        }
        primitive.material = Some(0);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, ..ProptestConfig::default() })]

    #[test]
    fn agrees_with_the_oracle(
        meshes in meshes(), light in light(), interior in interior(), local_depth in distribution(),
        near in prop::option::of(0.01f64..0.25), masked in prop::option::of(any::<u32>()), is_dag8 in any::<bool>(),
    ) {
        let mut scene = scene(meshes, DAffine3::IDENTITY);
        prop_assume!(!scene.nodes.is_empty());
        if let Some(seed) = masked {
            mask(&mut scene, seed);
        }
        let encoding = if is_dag8 { Encoding::Dag8 } else { Encoding::Silhouette };
        let own = BakeOptions { near_m: near, local_depth, encoding: Some(encoding), ..options(interior, 64, 1) };
        let options = BakeOptions { enter_depths: true, levels: is_dag8, ..own };
        check_all(&bake_for_check(&scene, &light, &options)).map_err(TestCaseError::fail)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 16, ..ProptestConfig::default() })]

    #[test]
    fn agrees_at_greater_resolutions(meshes in meshes(), light in light(), interior in interior(), seed in any::<u32>()) {
        let mut scene = scene(meshes, DAffine3::IDENTITY);
        prop_assume!(!scene.nodes.is_empty());
        mask(&mut scene, seed);
        check_all(&bake_for_check(&scene, &light, &options(interior, 512, 1))).map_err(TestCaseError::fail)?;
    }

    #[test]
    fn threads_and_instructions_do_not_change_the_bytes(meshes in meshes(), light in light(), interior in interior(), seed in any::<u32>()) {
        let mut scene = scene(meshes, DAffine3::IDENTITY);
        prop_assume!(!scene.nodes.is_empty());
        mask(&mut scene, seed);
        let with = |threads| BakeOptions { levels: true, enter_depths: true, ..options(interior, 256, threads) };
        let bytes = |options: BakeOptions| bake_for_check(&scene, &light, &options).bytes;
        let one = bytes(with(1));
        prop_assert!(one == bytes(with(2)) && one == bytes(with(3)), "bytes differ between thread counts");
        let plain = BakeOptions { plain_code: true, ..with(2) };
        prop_assert!(one == bytes(plain), "bytes differ between vector code and plain code");
    }
}

/// A tile under the face turns in its last block; the tile that repeats its column ends later.
#[test]
fn shadowed_rays_stay_shadowed_in_perspective() {
    let triangle = [[-0.7881387, -0.6722997, 0.5493732], [0.82977086, 0.18861821, 0.64383173], [1.0, 0.0, 0.0]];
    let light = spot(
        [0.16587505049139775, -0.5981680174424306, 0.6243548302259364],
        [-0.7308619792463192, 0.6152132002421843, -0.29555623075807985],
        0.35974637928657777f64.to_degrees(),
        4.9442698087213754,
    );
    let meshes = vec![cuboid([-0.7666, 0.2774, 0.7264], [0.1710, 0.1909, 0.4386], 0.0), loose(vec![triangle])];
    let scene = scene(meshes, DAffine3::IDENTITY);
    let options = BakeOptions {
        near_m: Some(0.051096790034321174),
        local_depth: DepthDistribution::Ndc,
        ..options(Interior::Open, 256, 1)
    };
    check_all(&bake_for_check(&scene, &light, &options)).unwrap();
}

fn assert_agrees(meshes: &[TestMesh], light: &Light, interior: Interior) {
    let scene = scene(meshes.to_vec(), DAffine3::IDENTITY);
    for resolution in [64, 256] {
        check_all(&bake_for_check(&scene, light, &options(interior, resolution, 1))).unwrap();
    }
}

/// A box whose sides are grids of n x n cells.
fn fine_cuboid(half: f64, n: u32) -> TestMesh {
    let (corners, sides) = cuboid([0.0; 3], [half; 3], 0.3);
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for side in sides.chunks(2) {
        let [a, b, c, d] =
            [side[0][0], side[0][1], side[0][2], side[1][2]].map(|i| glam::Vec3::from_array(corners[i as usize]));
        let first = positions.len() as u32;
        for i in 0..(n + 1) * (n + 1) {
            let (u, v) = ((i % (n + 1)) as f32 / n as f32, (i / (n + 1)) as f32 / n as f32);
            // The same number on an edge from either side.
            let edge = |from: glam::Vec3, to: glam::Vec3, t: f32| {
                if from.to_array() < to.to_array() { from + (to - from) * t } else { to + (from - to) * (1.0 - t) }
            };
            let p = if v == 0.0 {
                edge(a, b, u)
            } else if v == 1.0 {
                edge(d, c, u)
            } else if u == 0.0 {
                edge(a, d, v)
            } else if u == 1.0 {
                edge(b, c, v)
            } else {
                a + (b - a) * u + (d - a) * v
            };
            positions.push(p.to_array());
        }
        for i in 0..n * n {
            let at = first + i / n * (n + 1) + i % n;
            triangles.extend([[at, at + 1, at + n + 2], [at, at + n + 2, at + n + 1]]);
        }
    }
    (positions, triangles)
}

#[test]
fn more_triangles_in_a_texel_than_lists_are_looked_at() {
    // Some 20,000 specks over few texels, before and behind a sheet; a leaf's list is as long.
    let speck = |i: u32| {
        let share = |k: u32| f32::from((i.wrapping_mul(k) >> 7) as u16 % 1000) / 1000.0;
        let [x, y, z] = [0.2 + 0.02 * share(7919), share(104_729) - 0.5, 0.2 + 0.02 * share(15_485_863)];
        [[x, y, z], [x + 0.05, y + 0.002, z], [x, y - 0.001, z + 0.05]]
    };
    let specks = loose((0..20_000).map(speck).collect());
    let sheet = loose(vec![
        [[-1.0, 0.1, -1.0], [1.0, 0.0, -1.0], [-1.0, -0.1, 1.0]],
        [[1.0, 0.0, -1.0], [1.0, 0.1, 1.0], [-1.0, -0.1, 1.0]],
    ]);
    for light in [sun([0.2, -0.9, 0.1]), lamp([0.3, 1.5, 0.2], 4.0)] {
        for interior in POLICIES {
            let scene = scene(vec![specks.clone(), sheet.clone()], DAffine3::IDENTITY);
            check_all(&bake_for_check(&scene, &light, &options(interior, 64, 1))).unwrap();
        }
    }
}

#[test]
fn sheets_close_behind_one_another() {
    // Decals off a slanted wall and off a solid: faces are told by planes, where depth intervals overlap. The margin
    // reaches some seconds surfaces, and not others.
    let quad = |height: f32, half: f32| {
        let corner = |x: f32, z: f32| [half * x, height + 0.4 * half * x + 0.2 * half * z, half * z];
        loose(vec![
            [corner(-1.0, -1.0), corner(1.0, -1.0), corner(-1.0, 1.0)],
            [corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
        ])
    };
    let meshes = vec![
        quad(0.0, 1.0),
        quad(-0.004, 1.0),
        quad(0.006, 0.5),
        quad(-0.1, 0.9),
        quad(-0.4, 0.8),
        cuboid([0.1, -0.6, 0.2], [0.6, 0.1, 0.5], 0.4),
        quad(0.0, 1.0),
    ];
    for light in [
        sun([0.37, -0.81, 0.45]),
        sun([0.0, -1.0, 0.0]),
        lamp([0.2, 1.0, -0.3], 4.0),
        spot([0.1, 1.2, 0.1], [0.1, -1.0, 0.0], 50.0, 4.0),
    ] {
        for interior in [Interior::Open, Interior::Auto, Interior::Static(0.02), Interior::Static(0.2)] {
            let scene = scene(meshes.clone(), DAffine3::IDENTITY);
            for resolution in [64, 512] {
                let checked = bake_for_check(&scene, &light, &options(interior, resolution, 2));
                check_all(&checked).unwrap_or_else(|e| panic!("{interior:?} at {resolution}: {e}"));
            }
        }
    }
}

#[test]
fn a_lamp_far_from_all_walls_of_the_solid_about_it() {
    // The solid's triangles lie in many chunks, none of them near the lamp.
    let scene = scene(vec![fine_cuboid(1.0, 20)], DAffine3::IDENTITY);
    let caster_options =
        CasterOptions { find_solids: true, inverted: Inverted::Open, blend: Blend::Skip, memory_limit: u64::MAX };
    let casters = Casters::new(&scene, caster_options).unwrap();
    assert_eq!(casters.counts.closed, 4800);
    let opened = |at: DVec3| casters.opened_parts(at, [DVec3::X, DVec3::Y, DVec3::Z], 1e-3).count();
    for at in [[0.0; 3], [0.5, 0.1, -0.4], [-0.6, -0.7, 0.2]] {
        assert_eq!(opened(DVec3::from_array(at)), 1, "{at:?}");
    }
    // Within the solid's box, but outside it: it is turned.
    for at in [[1.25, 0.0, 1.25], [-1.25, 0.3, -1.25], [3.0, 0.0, 0.0]] {
        assert_eq!(opened(DVec3::from_array(at)), 0, "{at:?}");
    }
    assert_agrees(&[fine_cuboid(1.0, 20)], &lamp([0.1, 0.2, -0.3], 4.0), Interior::Auto);
}

const POLICIES: [Interior; 4] = [Interior::Open, Interior::Auto, Interior::Thickness(0.07), Interior::Static(0.02)];

#[test]
fn a_lamp_at_the_corner_of_many_boxes() {
    // The light stands on corners, edges and faces' planes of solids about it: near planes cut them, rays run along walls.
    let boxes: Vec<TestMesh> = [[0.5, 0.5, 0.5], [-0.5, 0.5, 0.5], [-0.5, -0.5, 0.5], [0.5, -0.5, -0.5]]
        .into_iter()
        .map(|center| cuboid(center, [0.5; 3], 0.0))
        .collect();
    for interior in POLICIES {
        assert_agrees(&boxes, &lamp([0.0; 3], 3.0), interior);
        assert_agrees(&boxes, &lamp([0.0, 0.0, -0.5], 3.0), interior);
    }
}

#[test]
fn a_lamp_in_a_room_in_a_house() {
    let house = cuboid([0.0; 3], [1.0; 3], 0.2);
    let room = turned(cuboid([0.0; 3], [0.8; 3], 0.2));
    let table = cuboid([0.2, -0.5, 0.1], [0.3, 0.05, 0.2], 0.7);
    for interior in POLICIES {
        assert_agrees(&[house.clone(), room.clone(), table.clone()], &lamp([0.1, 0.3, -0.05], 4.0), interior);
        // Inside a solid, it counts as open.
        assert_agrees(&[house.clone(), table.clone()], &lamp([0.1, 0.3, -0.05], 4.0), interior);
    }
}

#[test]
fn spots_of_every_width() {
    let scene = [cuboid([0.0, -0.6, 0.0], [1.0, 0.1, 1.0], 0.0), cuboid([0.1, -0.2, 0.2], [0.2, 0.3, 0.1], 0.4)];
    for degrees in [0.1, 1.0, 30.0, 59.9, 60.1, 75.0, 90.0] {
        for direction in [[0.0, -1.0, 0.0], [0.3, -0.9, 0.1], [1.0, 0.0, 0.0]] {
            assert_agrees(&scene, &spot([0.0, 0.9, 0.0], direction, degrees, 3.0), Interior::Auto);
        }
    }
}

#[test]
fn lamps_far_from_the_origin() {
    let place = DAffine3::from_translation(DVec3::new(4.3e6, -2.1e5, 7.7e6));
    let scene = scene(vec![cuboid([0.0; 3], [0.4; 3], 0.5), cuboid([0.0, -1.0, 0.0], [2.0, 0.1, 2.0], 0.0)], place);
    for interior in POLICIES {
        let light = lamp([4.3e6 + 0.3, -2.1e5 + 1.2, 7.7e6 - 0.2], 5.0);
        check_all(&bake_for_check(&scene, &light, &options(interior, 128, 1))).unwrap();
    }
}

#[test]
fn a_casters_beyond_the_range_casts_nothing_within() {
    let far = [cuboid([0.0, -3.0, 0.0], [2.0, 0.1, 2.0], 0.0)];
    let scene = scene(far.to_vec(), DAffine3::IDENTITY);
    let checked = bake_for_check(&scene, &lamp([0.0; 3], 1.0), &options(Interior::Auto, 64, 1));
    check_all(&checked).unwrap();
    assert_eq!(checked.light().record().roots, [0; 6]);
}

/// A ball of triangles with irregular corners about the origin.
fn ball(seed: u32) -> TestMesh {
    let (rings, sides) = (9u32, 14u32);
    let noise = |i: u32| 0.7 + 0.6 * f64::from((i ^ seed).wrapping_mul(2_654_435_761) >> 8) / f64::from(1u32 << 24);
    let point = |i: u32| {
        if i < 2 {
            return [0.0, if i == 0 { 1.1 } else { -0.9 }, 0.0];
        }
        let (ring, side) = ((i - 2) / sides, (i - 2) % sides);
        let (a, b) = (f64::from(ring + 1) / f64::from(rings + 1) * PI, f64::from(side) / f64::from(sides) * TAU);
        [a.sin() * b.cos(), a.cos(), a.sin() * b.sin()].map(|c| (c * noise(i)) as f32)
    };
    let at = |ring: u32, side: u32| 2 + ring * sides + side % sides;
    let mut triangles = Vec::new();
    for s in 0..sides {
        triangles.extend([[0, at(0, s + 1), at(0, s)], [1, at(rings - 1, s), at(rings - 1, s + 1)]]);
        for r in 0..rings - 1 {
            triangles.extend([[at(r, s), at(r, s + 1), at(r + 1, s)], [at(r + 1, s), at(r, s + 1), at(r + 1, s + 1)]]);
        }
    }
    ((0..2 + rings * sides).map(point).collect(), triangles)
}

/// Cuts at the guard band and rounding leave no crack: from within, every ray of every face ends at the hull.
#[test]
fn a_lamp_within_a_hull_sees_no_crack() {
    for seed in 0..12u32 {
        let hull = if seed % 3 == 0 { cuboid([0.1, -0.2, 0.05], [0.9, 0.7, 1.1], f64::from(seed)) } else { ball(seed) };
        let place = DAffine3::from_scale(DVec3::new(1.0, 1.0 + f64::from(seed) * 0.3, 0.8));
        let scene = scene(vec![hull], place);
        let position = [0.05 * f64::from(seed % 5) - 0.1, 0.1, -0.07 * f64::from(seed % 4)];
        for (light, near_m) in [(lamp(position, 50.0), 0.002), (spot(position, [0.2, 1.0, -0.3], 80.0, 50.0), 0.002)] {
            let options = BakeOptions { near_m: Some(near_m), ..options(Interior::Open, 256, 1) };
            let checked = bake_for_check(&scene, &light, &options);
            for face in 0..6 {
                let lit = (0..256 * 256).filter(|i| checked.light().is_lit(face, [i % 256, i / 256, 255])).count();
                assert_eq!(lit, 0, "seed {seed}, face {face}: rays pass through the hull");
            }
        }
    }
}

/// The same at the near plane: what a closed hull loses before it, its own far side shows to every ray exactly once, for
/// neighbours agree on the cuts.
#[test]
fn near_cuts_of_neighbours_agree() {
    for seed in 0..6u32 {
        let scene = scene(vec![ball(seed)], DAffine3::IDENTITY);
        // The near planes cut the ball on all sides: a ray meets either nothing behind them or the ball once.
        let options = BakeOptions { near_m: Some(0.75), ..options(Interior::Open, 256, 1) };
        let checked = bake_for_check(&scene, &lamp([0.02, 0.03, -0.01], 50.0), &options);
        for face in 0..6 {
            let triangles = &checked.faces[face].triangles;
            let resolution = checked.resolution();
            let covers = |t: &antumbra_bake::light_space::LatticeTriangle, p: [i64; 2]| {
                let area = t.doubled_area();
                area != 0
                    && (0..3).all(|i| {
                        let (a, b) = ((i + 1) % 3, (i + 2) % 3);
                        let [ax, ay, bx, by] = [t.x[a], t.y[a], t.x[b], t.y[b]].map(i64::from);
                        let side = (bx - ax) * (p[1] - ay) - (by - ay) * (p[0] - ax);
                        let moved = [side, -(by - ay), bx - ax].into_iter().find(|v| *v != 0).unwrap_or(0);
                        (moved > 0) == (area > 0)
                    })
            };
            for i in (0..256u32 * 256).step_by(5) {
                let p = [i % 256, i / 256].map(|c| resolution.texel_center(c));
                let times = triangles.iter().filter(|t| covers(t, p)).count();
                assert!(times <= 1, "seed {seed}, face {face}, texel {i}: covered {times} times");
            }
        }
    }
}
