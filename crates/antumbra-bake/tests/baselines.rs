//! The papers' own methods: the same depths give the same nodes, whatever the method and the threads; where solids leave a
//! choice, every texel keeps to its interval.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod common;

use antumbra::Interior;
use antumbra_bake::{BakeError, BakeOptions, Encoding, Method, Silent, bake};
use antumbra_scene::procedural::{self, Options};
use antumbra_scene::{Light, Scene};
use common::{TestMesh as Mesh, bake_for_check, check_all, cuboid, lamp, options, scene, solid, soup, spot, sun};
use glam::DAffine3;
use proptest::prelude::*;

fn meshes() -> impl Strategy<Value = Vec<Mesh>> {
    (prop::collection::vec(solid(), 0..6), soup(12)).prop_map(|(mut meshes, soup)| {
        meshes.push(soup);
        meshes
    })
}

fn light() -> impl Strategy<Value = Light> {
    prop_oneof![
        3 => prop::array::uniform3(-1.0f64..1.0).prop_filter("not zero", |d| d.iter().any(|c| c.abs() > 0.01)).prop_map(sun),
        1 => prop::array::uniform3(-1.5f64..1.5).prop_map(|p| lamp(p, 4.0)),
        1 => prop::array::uniform3(-1.5f64..1.5).prop_map(|p| spot(p, [0.1, -1.0, 0.2], 40.0, 4.0)),
    ]
}

/// Every method, with culling and without.
fn methods() -> [(Method, bool); 3] {
    [(Method::Kampe2015, true), (Method::Kampe2015, false), (Method::Sintorn2014, true)]
}

fn with(method: (Method, bool), interior: Interior, resolution: u32, threads: usize) -> BakeOptions {
    BakeOptions {
        encoding: Some(Encoding::Dag8),
        method: method.0,
        cull_identical: method.1,
        enter_depths: true,
        ..options(interior, resolution, threads)
    }
}

fn bytes(scene: &Scene, light: &Light, options: &BakeOptions) -> Vec<u8> {
    bake(scene, std::slice::from_ref(light), options, &Silent).unwrap().bytes
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    #[test]
    fn where_nothing_is_free_all_methods_make_the_same_bytes(meshes in meshes(), light in light(), fine in prop::bool::weighted(0.1)) {
        let (scene, resolution) = (scene(meshes, DAffine3::IDENTITY), if fine { 256 } else { 64 });
        let ours = bytes(&scene, &light, &with((Method::Columns, true), Interior::Open, resolution, 1));
        for (i, method) in methods().into_iter().enumerate() {
            let theirs = bytes(&scene, &light, &with(method, Interior::Open, resolution, 1 + i));
            prop_assert!(ours == theirs, "{method:?} at {resolution}");
        }
    }

    #[test]
    fn solids_keep_to_their_intervals(meshes in meshes(), light in light()) {
        let scene = scene(meshes, DAffine3::IDENTITY);
        let checked = methods().map(|method| bake_for_check(&scene, &light, &with(method, Interior::Auto, 64, 2)));
        for (checked, method) in checked.iter().zip(methods()) {
            check_all(checked).map_err(|e| TestCaseError::fail(format!("{method:?}: {e}")))?;
            let other = bake_for_check(&scene, &light, &with(method, Interior::Auto, 64, 3));
            prop_assert!(checked.bytes == other.bytes, "{method:?}: threads change the bytes");
        }
        prop_assert!(checked[0].bytes == checked[1].bytes, "culling changes the nodes");
    }
}

#[test]
fn squares_and_map_tiles_fit_together() {
    // 16384 has four map tiles of 8192 and more squares.
    let boxes = vec![
        cuboid([0.0, -0.2, 0.0], [1.0, 0.1, 1.0], 0.0),
        cuboid([0.1, 0.2, -0.1], [0.4, 0.3, 0.2], 0.5),
        cuboid([-0.5, 0.0, 0.5], [0.1, 0.4, 0.1], 0.9),
    ];
    let (scene, light) = (scene(boxes, DAffine3::IDENTITY), sun([0.37, -0.81, 0.45]));
    for resolution in [2048, 16384] {
        let of = |method: Method| bytes(&scene, &light, &with((method, true), Interior::Open, resolution, 2));
        assert!(of(Method::Columns) == of(Method::Kampe2015), "at {resolution}");
    }
}

#[test]
fn alpha_masks_and_coarse_levels() {
    let scene = procedural::build("ruins", &Options { scale: 0.05, ..Options::default() }).unwrap();
    let of = |method: (Method, bool)| {
        let options = BakeOptions { levels: true, ..with(method, Interior::Open, 256, 2) };
        bytes(&scene, &scene.lights[0], &options)
    };
    let ours = of((Method::Columns, true));
    methods().into_iter().for_each(|method| assert!(ours == of(method), "{method:?}"));
}

#[test]
fn what_the_methods_cannot_do_is_said() {
    let scene = scene(vec![cuboid([0.0; 3], [1.0; 3], 0.3)], DAffine3::IDENTITY);
    let light = sun([0.37, -0.81, 0.45]);
    for method in methods() {
        let failure = |options: BakeOptions| bake(&scene, std::slice::from_ref(&light), &options, &Silent).unwrap_err();
        let error = failure(with(method, Interior::Static(0.1), 64, 1));
        assert!(matches!(error, BakeError::MethodInterior { policy: "static", .. }), "{error}");
        let error = failure(BakeOptions { memory_limit: Some(1 << 20), ..with(method, Interior::Auto, 4096, 1) });
        assert!(matches!(error, BakeError::Memory { .. }), "{error}");
    }
}
