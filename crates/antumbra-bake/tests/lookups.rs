//! The runtime's lookups on baked files: filters against single taps, and lit surfaces without acne.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod common;

use antumbra::{Filter, Interior, Kernel, LightShadow};
use antumbra_scene::{Scene, procedural};
use common::{bake_for_check, cuboid, options, scene, sun};
use glam::{DAffine3, DQuat, DVec3};
use proptest::prelude::*;
use std::sync::LazyLock;

fn city() -> Scene {
    procedural::build("city", &procedural::Options { seed: 5, scale: 0.15, ..Default::default() }).unwrap()
}

static BAKED: LazyLock<common::Checked> =
    LazyLock::new(|| bake_for_check(&city(), &sun([0.5, -0.6, 0.3]), &options(Interior::Auto, 1024, 0)));

/// Filtered visibility tap by tap.
fn tap_by_tap(light: LightShadow<'_>, voxel: DVec3, taps: u32, kernel: Kernel) -> f32 {
    let radius = i64::from(taps / 2);
    let (mut lit, mut all) = (0, 0);
    for dy in -radius..=radius {
        for dx in -radius..=radius {
            let weight = match kernel {
                Kernel::Box => 1,
                Kernel::Tent => (radius + 1 - dx.abs()) * (radius + 1 - dy.abs()),
            };
            let tap = DVec3::new(voxel.x.floor() + dx as f64 + 0.5, voxel.y.floor() + dy as f64 + 0.5, voxel.z);
            lit += if light.voxel_visibility(tap) == 1.0 { weight } else { 0 };
            all += weight;
        }
    }
    lit as f32 / all as f32
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20_000, ..ProptestConfig::default() })]

    #[test]
    fn filters_equal_their_taps(
        x in -20.0f64..1044.0, y in -20.0f64..1044.0, z in -4.0f64..1100.0, half in 0u32..=8, tent in any::<bool>(),
    ) {
        let light = BAKED.file.light("sun").unwrap();
        let (taps, kernel) = (2 * half + 1, if tent { Kernel::Tent } else { Kernel::Box });
        let voxel = DVec3::new(x, y, z);
        let filter = Filter::new(taps, kernel).unwrap();
        prop_assert_eq!(light.voxel_filtered(voxel, filter), tap_by_tap(light, voxel, taps, kernel));
    }
}

proptest! {
    #[test]
    fn many_lookups_equal_single_ones(
        points in prop::collection::vec(prop::array::uniform3(-400.0f64..400.0), 0..40), room in 0usize..40,
    ) {
        let light = BAKED.file.light("sun").unwrap();
        let points: Vec<DVec3> = points.into_iter().map(DVec3::from_array).collect();
        let mut many = vec![-1.0; room];
        light.visibility_many(&points, &mut many);
        for (i, answer) in many.iter().enumerate() {
            let expected = points.get(i).map_or(-1.0, |p| light.visibility(*p));
            prop_assert_eq!(*answer, expected);
        }
    }
}

#[test]
fn filters_are_odd_and_at_most_17() {
    for taps in [0, 2, 16, 18, 19] {
        assert!(Filter::new_tent(taps).is_err() && Filter::new_box(taps).is_err());
    }
}

#[test]
fn points_that_are_no_numbers_or_far_away_are_lit_or_as_the_last_slice() {
    let light = BAKED.file.light("sun").unwrap();
    for strange in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300] {
        let filter = Filter::new_tent(9).unwrap();
        assert_eq!(light.visibility(DVec3::new(strange, 0.0, 0.0)), 1.0);
        assert_eq!(light.filtered(DVec3::splat(strange), Some(DVec3::Y), filter), 1.0);
    }
    let deep = DVec3::new(500.5, 500.5, 1e30);
    assert_eq!(light.voxel_visibility(deep), light.voxel_visibility(DVec3::new(500.5, 500.5, 1023.5)));
}

/// A slab of four metres' side whose upper face slopes by so many degrees, and the face's normal and axes.
fn sloped_slab(degrees: f64, half_thickness: f64) -> (Scene, DVec3, [DVec3; 2]) {
    let turn = DQuat::from_rotation_z(degrees.to_radians());
    let scene = scene(vec![cuboid([0.0; 3], [2.0, half_thickness, 2.0], 0.0)], DAffine3::from_quat(turn));
    (scene, turn * DVec3::Y, [turn * DVec3::X, turn * DVec3::Z])
}

/// Points of the slab's upper face, a margin off its edges.
fn face_points(offset: DVec3, [u, v]: [DVec3; 2], half: f64) -> impl Iterator<Item = DVec3> {
    (0..10_000).map(move |i| {
        let (a, b) = (f64::from(i % 100) / 99.0 * 2.0 - 1.0, f64::from(i / 100) / 99.0 * 2.0 - 1.0);
        offset + u * (a * half) + v * (b * half)
    })
}

#[test]
fn closed_surfaces_have_no_acne_without_bias() {
    // Along the light the slab is a few texels thick or many: thin ones leave the builder little choice.
    for (resolution, half_thickness) in [(64, 0.3), (128, 0.15), (256, 0.1), (256, 0.3), (1024, 1.5)] {
        for degrees in [0.0, 5.0, 20.0, 45.0, 60.0, 70.0, 80.0] {
            let (scene, normal, axes) = sloped_slab(degrees, half_thickness);
            for direction in [[0.0, -1.0, 0.0], [0.01, -1.0, 0.02]] {
                let baked = bake_for_check(&scene, &sun(direction), &options(Interior::Auto, resolution, 1));
                let light = baked.file.light("sun").unwrap();
                let points = face_points(normal * half_thickness, axes, 1.6);
                let dark = points.filter(|p| light.visibility(*p) == 0.0).count();
                assert_eq!(dark, 0, "{degrees} degrees, {half_thickness} m at {resolution}");
            }
        }
    }
}

#[test]
fn biased_filters_have_no_acne_on_open_slopes() {
    for degrees in [0.0, 20.0, 45.0, 60.0, 75.0] {
        let (scene, normal, axes) = sloped_slab(degrees, 1.5);
        let baked = bake_for_check(&scene, &sun([0.15, -1.0, 0.4]), &options(Interior::Open, 1024, 1));
        let light = baked.file.light("sun").unwrap();
        for taps in [1, 3, 9, 17] {
            let filter = Filter::new_box(taps).unwrap();
            let dark = face_points(normal * 1.5, axes, 1.6).filter(|p| light.filtered(*p, Some(normal), filter) < 1.0);
            assert_eq!(dark.count(), 0, "{degrees} degrees, {taps} taps");
        }
    }
}
