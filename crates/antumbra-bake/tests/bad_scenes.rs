//! Scenes, lights and options that are broken or absurd: a clear error or a sane bake, never a panic.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod common;

use antumbra::{Interior, ShadowFile};
use antumbra_bake::light_space::Resolution;
use antumbra_bake::{BakeError, BakeOptions, Baked, ResolutionRequest, Silent, bake};
use antumbra_scene::Scene;
use common::{cuboid, options, scene, sun};
use glam::{DAffine3, DVec3};

fn bake_at_64(scene: &Scene, direction: [f64; 3]) -> Result<Baked, BakeError> {
    let light = antumbra_scene::Light { direction_world: DVec3::from_array(direction), ..sun([0.0, -1.0, 0.0]) };
    let baked = bake(scene, &[light], &options(Interior::Auto, 64, 1), &Silent)?;
    ShadowFile::from_bytes(&baked.bytes).expect("a bake that succeeds is a valid file");
    Ok(baked)
}

fn placed(place: DAffine3) -> Scene {
    scene(vec![cuboid([0.0; 3], [1.0; 3], 0.3)], place)
}

const DOWN: [f64; 3] = [0.3, -0.8, 0.2];

#[test]
fn nodes_at_no_place_are_named() {
    for scale in [1e308, f64::INFINITY, f64::NAN] {
        let error = bake_at_64(&placed(DAffine3::from_scale(DVec3::splat(scale))), DOWN).unwrap_err();
        assert_eq!(error, BakeError::Misplaced("node0".into()));
    }
    for x in [1e200, f64::INFINITY, f64::NEG_INFINITY, f64::NAN] {
        let place = DAffine3::from_translation(DVec3::new(x, 0.0, 0.0));
        assert!(matches!(bake_at_64(&placed(place), DOWN), Err(BakeError::Misplaced(_))));
    }
}

#[test]
fn any_scale_gives_the_same_shadow() {
    let dark = |scale: f64| {
        let baked = bake_at_64(&placed(DAffine3::from_scale(DVec3::splat(scale))), DOWN).unwrap();
        let file = ShadowFile::from_bytes(&baked.bytes).unwrap();
        let light = file.lights().next().unwrap();
        (0..64 * 64).filter(|i| !light.is_lit(0, [i & 63, i >> 6, 63])).count()
    };
    let at_one = dark(1.0);
    assert!(at_one > 500);
    for power in [-60, -20, -10, 10, 20, 60] {
        assert_eq!(dark(2.0f64.powi(power)), at_one, "at scale 2^{power}");
    }
}

#[test]
fn directions_of_any_length_serve_and_none_is_an_error() {
    for length in [1e-300, 1e-160, 1.0, 1e160, 1e300] {
        bake_at_64(&placed(DAffine3::IDENTITY), DOWN.map(|c| c * length)).unwrap();
    }
    for none in [[0.0; 3], [f64::NAN, 0.0, 1.0], [0.0, f64::INFINITY, 0.0]] {
        let error = bake_at_64(&placed(DAffine3::IDENTITY), none).unwrap_err();
        assert_eq!(error, BakeError::LightDirection("sun".into()));
    }
}

#[test]
fn casters_that_cover_nothing_are_reported() {
    let flat = DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0));
    let squashed = bake_at_64(&placed(flat), [1.0, 0.0, 0.0]).unwrap();
    assert!(squashed.warnings.iter().any(|w| w.contains("no caster covers a texel")), "{:?}", squashed.warnings);
    let point = bake_at_64(&placed(DAffine3::from_scale(DVec3::ZERO)), DOWN).unwrap();
    assert!(point.warnings.iter().any(|w| w.contains("no caster covers a texel")));
}

#[test]
fn nothing_to_bake_is_an_error() {
    assert_eq!(bake_at_64(&Scene::default(), DOWN).unwrap_err(), BakeError::NoCasters);
    let mut moving = placed(DAffine3::IDENTITY);
    moving.nodes[0].dynamic = true;
    assert_eq!(bake_at_64(&moving, DOWN).unwrap_err(), BakeError::NoCasters);
    let none = bake(&placed(DAffine3::IDENTITY), &[], &BakeOptions::default(), &Silent);
    assert_eq!(none.unwrap_err(), BakeError::NoLights);
}

#[test]
fn lamps_and_policies_of_impossible_sizes_are_refused() {
    let scene = placed(DAffine3::IDENTITY);
    let bake_lamp = |lamp: antumbra_scene::Light, near_m: Option<f64>| {
        bake(&scene, &[lamp], &BakeOptions { near_m, ..options(Interior::Auto, 64, 1) }, &Silent)
    };
    let lamp = |range_m: f64| common::lamp([0.0, 2.0, 0.0], range_m);
    assert!(bake_lamp(lamp(5.0), None).is_ok() && bake_lamp(lamp(5.0), Some(4.9)).is_ok());
    for near_m in [0.0, -1.0, 5.0, 1e-9, f64::NAN, f64::INFINITY] {
        assert!(matches!(bake_lamp(lamp(5.0), Some(near_m)), Err(BakeError::Near { .. })), "near {near_m}");
    }
    for range_m in [0.0, -2.0, f64::NAN, f64::INFINITY, 1e300] {
        assert!(matches!(bake_lamp(lamp(range_m), None), Err(BakeError::LightPlace(_))), "range {range_m}");
    }
    for y in [f64::NAN, f64::INFINITY, 1e200] {
        assert!(matches!(bake_lamp(common::lamp([0.0, y, 0.0], 5.0), None), Err(BakeError::LightPlace(_))), "at {y}");
    }
    let nowhere = common::spot([0.0; 3], [0.0, -1.0, 0.0], 30.0, 5.0);
    let nowhere = antumbra_scene::Light { direction_world: DVec3::NAN, ..nowhere };
    assert!(matches!(bake_lamp(nowhere, None), Err(BakeError::LightDirection(_))));
    for interior in [Interior::Thickness(-0.1), Interior::Static(f64::NAN), Interior::Thickness(f64::INFINITY)] {
        let options = BakeOptions { interior, ..BakeOptions::default() };
        assert!(matches!(bake(&scene, &[sun(DOWN)], &options, &Silent), Err(BakeError::Interior(_))));
    }
}

#[test]
fn resolutions_and_texel_sizes() {
    for texels in [0, 1, 32, 63, 100, 1 << 21, u32::MAX] {
        assert_eq!(Resolution::new(texels), None, "{texels}");
    }
    let scene = placed(DAffine3::IDENTITY);
    let with = |texel_m: f64| {
        let options = BakeOptions { resolution: ResolutionRequest::TexelSize(texel_m), ..BakeOptions::default() };
        bake(&scene, &[sun(DOWN)], &options, &Silent)
    };
    let baked = with(0.01).unwrap();
    assert!(baked.lights[0].texel_size_m <= 0.01 && baked.lights[0].texel_size_m > 0.005);
    assert_eq!(with(1e9).unwrap().lights[0].resolution, 64);
    assert!(matches!(with(1e-9), Err(BakeError::TexelSize { .. })));
    for texel_m in [0.0, -1.0, f64::INFINITY] {
        assert_eq!(with(texel_m).unwrap_err(), BakeError::TexelSizeSign(texel_m));
    }
}

#[test]
fn memory_limits_are_errors_until_they_suffice() {
    let small = antumbra_scene::procedural::Options { scale: 0.2, ..Default::default() };
    let scene = antumbra_scene::procedural::build("city", &small);
    let scene = scene.unwrap();
    let free = bake(&scene, &scene.lights, &options(Interior::Auto, 4096, 2), &Silent).unwrap();
    let mut refused = 0;
    for limit in [0, 1 << 16, 1 << 20, 1 << 22, 1 << 23, 1 << 24, 1 << 25, 1 << 28] {
        let options = BakeOptions { memory_limit: Some(limit), ..options(Interior::Auto, 4096, 2) };
        match bake(&scene, &scene.lights, &options, &Silent) {
            Ok(baked) => assert!(baked.bytes == free.bytes),
            Err(BakeError::Memory { limit: stated, .. }) if stated == limit => refused += 1,
            Err(other) => panic!("{other}"),
        }
    }
    assert!((4..8).contains(&refused), "{refused} of the limits were refused");
}
