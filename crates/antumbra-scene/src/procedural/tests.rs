//! Every procedural scene is sound, complete, and the same every time; all but the ruins are closed.

mod lights;
mod market;
mod palace;
mod ruins;

use std::collections::HashMap;

use glam::DVec3;

use super::{NAMES, Options, ProceduralError, build};
use crate::model::{Mesh, Scene};

/// The scenes that are made of closed solids.
const CLOSED: [&str; 11] =
    ["cellar", "city", "door", "flag", "grille", "hairball", "landscape", "market", "room", "screen", "village"];

/// The scenes that are set in the palace.
const PALACE: [&str; 5] = ["cellar", "door", "flag", "grille", "room"];

type Corner = [u32; 3];

fn corners(mesh: &Mesh) -> impl Iterator<Item = [[f32; 3]; 3]> + '_ {
    mesh.primitives.iter().flat_map(|p| p.triangles.iter().map(|t| t.map(|i| p.positions[i as usize])))
}

/// Edges that are not used equally often in both directions.
fn unbalanced_edges(mesh: &Mesh) -> usize {
    let mut balance: HashMap<(Corner, Corner), i64> = HashMap::new();
    for triangle in corners(mesh) {
        let [a, b, c] = triangle.map(|p| p.map(f32::to_bits));
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *balance.entry((from.min(to), from.max(to))).or_default() += if from < to { 1 } else { -1 };
        }
    }
    balance.values().filter(|&&count| count != 0).count()
}

/// Solids (triangles that hang together by exact position) that are inside out.
fn inside_out_parts(mesh: &Mesh) -> usize {
    let mut index_of: HashMap<Corner, usize> = HashMap::new();
    let mut parent: Vec<usize> = Vec::new();
    let mut rooted = Vec::new();
    for triangle in corners(mesh) {
        let ids = triangle.map(|p| {
            *index_of.entry(p.map(f32::to_bits)).or_insert_with(|| {
                parent.push(parent.len());
                parent.len() - 1
            })
        });
        let roots = ids.map(|i| root(&mut parent, i));
        parent[roots[1]] = roots[0];
        let third = root(&mut parent, roots[2]);
        parent[third] = root(&mut parent, roots[0]);
        rooted.push((ids[0], triangle));
    }
    let mut volumes = vec![0.0; parent.len()];
    for (id, triangle) in rooted {
        volumes[root(&mut parent, id)] += volume_under(triangle);
    }
    (0..parent.len()).filter(|&i| root(&mut parent, i) == i && volumes[i] <= 0.0).count()
}

fn root(parent: &mut [usize], mut i: usize) -> usize {
    while parent[i] != i {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    i
}

fn volume_under(triangle: [[f32; 3]; 3]) -> f64 {
    let [a, b, c] = triangle.map(|p| DVec3::from_array(p.map(f64::from)));
    a.dot(b.cross(c)) / 6.0
}

fn zero_areas(mesh: &Mesh) -> usize {
    let area = |triangle: [[f32; 3]; 3]| {
        let [a, b, c] = triangle.map(|p| DVec3::from_array(p.map(f64::from)));
        (b - a).cross(c - a).length()
    };
    corners(mesh).filter(|&t| area(t) < 1e-9).count()
}

fn check_closed(scene: &Scene) {
    for mesh in &scene.meshes {
        assert_eq!(unbalanced_edges(mesh), 0, "`{}` is open", mesh.name);
        assert_eq!(inside_out_parts(mesh), 0, "`{}` has inside-out parts", mesh.name);
    }
}

fn check_sound(scene: &Scene) {
    assert!(!scene.nodes.is_empty());
    for mesh in &scene.meshes {
        assert_eq!(zero_areas(mesh), 0, "`{}` has triangles without area", mesh.name);
        for primitive in &mesh.primitives {
            let count = primitive.positions.len();
            assert!(primitive.triangles.iter().flatten().all(|&i| (i as usize) < count));
            assert!(primitive.positions.iter().flatten().all(|v| v.is_finite()));
            let attributes = [
                (primitive.normals.len(), primitive.normals.as_flattened()),
                (primitive.texcoords.len(), primitive.texcoords.as_flattened()),
                (primitive.colors.len(), primitive.colors.as_flattened()),
            ];
            for (length, values) in attributes {
                assert!(length == 0 || length == count, "{}: {length} of {count}", mesh.name);
                assert!(values.iter().all(|v| v.is_finite()), "{}", mesh.name);
            }
            assert!(primitive.material.is_some_and(|m| m < scene.materials.len()));
        }
    }
    for node in &scene.nodes {
        assert!(node.mesh < scene.meshes.len());
        assert!(!node.mirrors());
    }
}

/// FNV-1a over everything that makes up the geometry and the images.
fn fingerprint(scene: &Scene) -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut eat = |bits: u64| hash = (hash ^ bits).wrapping_mul(0x0100_0000_01b3);
    for mesh in &scene.meshes {
        for p in &mesh.primitives {
            p.positions.iter().flatten().for_each(|v| eat(v.to_bits().into()));
            p.normals.iter().flatten().for_each(|v| eat(v.to_bits().into()));
            p.texcoords.iter().flatten().for_each(|v| eat(v.to_bits().into()));
            p.colors.iter().flatten().for_each(|v| eat(v.to_bits().into()));
            p.triangles.iter().flatten().for_each(|&i| eat(i.into()));
        }
    }
    for node in &scene.nodes {
        node.world_from_mesh.to_cols_array().iter().for_each(|v| eat(v.to_bits()));
    }
    scene.images.iter().flat_map(|image| &image.rgba).for_each(|&byte| eat(byte.into()));
    hash
}

fn scene(name: &str, seed: u64, scale: f64) -> Scene {
    build(name, &Options { seed, scale, ..Options::default() }).expect("a scene of the table")
}

#[test]
fn every_node_is_sound_and_most_scenes_are_closed() {
    for &(name, _) in NAMES {
        for (seed, scale) in [(1, 0.05), (2, 0.1), (3, 0.25), (4, 0.33), (5, 0.5)] {
            let scene = scene(name, seed, scale);
            check_sound(&scene);
            if CLOSED.contains(&name) {
                check_closed(&scene);
            }
        }
    }
}

#[test]
fn whole_size_scenes_are_sound_and_of_the_promised_size() {
    for (name, lowest, highest) in [
        ("cellar", 100_000, 250_000),
        ("city", 900_000, 1_200_000),
        ("door", 100_000, 250_000),
        ("flag", 100_000, 250_000),
        ("grille", 100_000, 250_000),
        ("hairball", 340_000, 370_000),
        ("landscape", 1_900_000, 2_100_000),
        ("market", 150_000, 200_000),
        ("room", 100_000, 250_000),
        ("ruins", 150_000, 210_000),
        ("screen", 15_000, 60_000),
        ("village", 150_000, 210_000),
    ] {
        for seed in [1, 7, 12_345] {
            let scene = scene(name, seed, 1.0);
            let count = scene.triangle_count();
            assert!((lowest..=highest).contains(&count), "{name} with seed {seed} has {count} triangles");
            if seed != 7 {
                check_sound(&scene);
                if CLOSED.contains(&name) {
                    check_closed(&scene);
                }
            }
        }
    }
}

#[test]
fn small_scenes_are_small_but_not_empty() {
    let triangles = scene("city", 1, 0.1).triangle_count();
    assert!((1_000..60_000).contains(&triangles), "{triangles} triangles");
    assert!(scene("landscape", 1, 0.05).triangle_count() < 10_000);
    for name in ["market", "ruins", "village"].into_iter().chain(PALACE) {
        let triangles = scene(name, 1, 0.1).triangle_count();
        assert!((1_000..60_000).contains(&triangles), "{name}: {triangles} triangles");
    }
}

#[test]
fn the_seed_decides() {
    for &(name, _) in NAMES {
        let first = fingerprint(&scene(name, 1, 0.3));
        assert_eq!(first, fingerprint(&scene(name, 1, 0.3)), "{name}");
        assert_ne!(first, fingerprint(&scene(name, 2, 0.3)), "{name}");
    }
}

/// Bakes and figures of these scenes exist: what makes them must go on making the same bits, on every machine.
#[test]
fn scenes_stay_as_they_are() {
    for (name, expected) in [
        ("cellar", 0x2302_7fb2_8b20_bcf4_u64),
        ("city", 0xcb8a_fabe_868c_602c),
        ("door", 0x1b05_6182_4911_79e4),
        ("flag", 0x339f_9c13_e7cd_203b),
        ("grille", 0x2302_7fb2_8b20_bcf4),
        ("hairball", 0xc2e0_c043_d885_9109),
        ("landscape", 0xd247_b9b7_0d65_eb5e),
        ("market", 0xdd15_dc85_71a1_dcb1),
        ("room", 0x2968_cf55_2bd8_0424),
        ("ruins", 0xba57_dfcb_6680_b884),
        ("screen", 0x3c3f_6571_cc4c_a010),
        ("village", 0xd2ae_aeeb_ed66_4e92),
    ] {
        let got = fingerprint(&scene(name, 1, 0.15));
        assert_eq!(got, expected, "{name} has become {got:#018x}");
    }
}

#[test]
fn bad_requests_are_refused_with_a_reason() {
    let unknown = build("atlantis", &Options::default()).expect_err("no such scene");
    assert!(unknown.to_string().contains("city"));
    for scale in [0.0, -1.0, 0.01, 5.0, f64::NAN, f64::INFINITY] {
        let error = build("city", &Options { scale, ..Options::default() }).expect_err("out of range");
        assert!(matches!(error, ProceduralError::Scale { .. }));
    }
    let lamps = |lamps: u32| Options { lamps, ..Options::default() };
    for name in ["hairball", "landscape", "market", "ruins", "screen", "village"].into_iter().chain(PALACE) {
        let error = build(name, &lamps(1)).expect_err("no lamps");
        assert!(error.to_string().contains(name), "{error}");
    }
    let error = build("city", &lamps(super::MAX_LAMPS + 1)).expect_err("too many");
    assert!(matches!(error, ProceduralError::TooManyLamps { .. }));
}
