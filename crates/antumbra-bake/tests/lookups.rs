//! The runtime's lookups on baked files: filters against single taps, and lit surfaces without acne.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod common;

use antumbra::{Encoding, FacePoint, Filter, Interior, Kernel, LightShadow};
use antumbra_bake::BakeOptions;
use antumbra_bake::oracle::Oracle;
use antumbra_scene::{Scene, procedural};
use common::{bake_for_check, cuboid, lamp, options, scene, sun};
use glam::{DAffine3, DQuat, DVec3};
use proptest::prelude::*;
use std::sync::LazyLock;

fn city() -> Scene {
    procedural::build("city", &procedural::Options { seed: 5, scale: 0.15, ..Default::default() }).unwrap()
}

static CITY: LazyLock<Scene> = LazyLock::new(city);

static BAKED: LazyLock<common::Checked<'static>> =
    LazyLock::new(|| bake_for_check(&CITY, &sun([0.5, -0.6, 0.3]), &options(Interior::Auto, 1024, 0)));

/// A sun and a lamp in either encoding.
static LIGHTS: LazyLock<[common::Checked<'static>; 4]> = LazyLock::new(|| {
    let lights = [sun([0.5, -0.6, 0.3]), lamp([3.0, 40.0, 5.0], 150.0)];
    [0, 1, 2, 3].map(|i| {
        let encoding = Some(if i < 2 { Encoding::Silhouette } else { Encoding::Dag8 });
        bake_for_check(&CITY, &lights[i % 2], &BakeOptions { encoding, ..options(Interior::Auto, 256, 0) })
    })
});

/// A point on a directional light's only face.
fn at(voxel: DVec3) -> FacePoint {
    FacePoint { face: 0, voxel }
}

/// Filtered visibility tap by tap.
fn tap_by_tap(light: LightShadow<'_>, voxel: DVec3, taps: u32, kernel: Kernel) -> f32 {
    let radius = i64::from(taps / 2);
    let (mut lit, mut all) = (0, 0);
    for dy in -radius..=radius {
        for dx in -radius..=radius {
            let weight = match kernel {
                Kernel::Box | Kernel::Continuous => 1,
                Kernel::Tent => (radius + 1 - dx.abs()) * (radius + 1 - dy.abs()),
            };
            let tap = DVec3::new(voxel.x.floor() + dx as f64 + 0.5, voxel.y.floor() + dy as f64 + 0.5, voxel.z);
            lit += if light.voxel_visibility(at(tap)) == 1.0 { weight } else { 0 };
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
        prop_assert_eq!(light.voxel_filtered(at(voxel), filter), tap_by_tap(light, voxel, taps, kernel));
    }
}

proptest! {
    #[test]
    fn many_lookups_equal_single_ones(
        which in 0usize..4,
        anywhere in prop::collection::vec(prop::array::uniform3(-400.0f64..400.0), 0..20),
        turns in prop::collection::vec((0usize..6, 0u32..256, 0u32..256, -3.0f64..3.0), 0..40),
        room in 0usize..60,
    ) {
        let light = LIGHTS[which].light();
        // Where texels turn from lit to shadowed, or nearly.
        let turn = |(face, x, y, off): (usize, u32, u32, f64)| {
            let face = face % light.faces();
            let turn = (0..256).position(|z| !light.is_lit(face, [x, y, z])).unwrap_or(255);
            light.unproject(FacePoint { face, voxel: DVec3::new(f64::from(x) + 0.5, f64::from(y) + 0.5, turn as f64 + off) })
        };
        let anywhere = anywhere.into_iter().map(DVec3::from_array);
        let points: Vec<DVec3> = anywhere.chain(turns.into_iter().filter_map(turn)).collect();
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
    assert_eq!(light.voxel_visibility(at(deep)), light.voxel_visibility(at(DVec3::new(500.5, 500.5, 1023.5))));
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

/// Filtered visibility as rays give it: each tap's own ray, towards the light from the sample's depth.
fn traced_filter(
    checked: &common::Checked<'_>,
    oracle: &Oracle<'_>,
    point: DVec3,
    normal: DVec3,
    filter: Filter,
) -> f32 {
    let light = checked.light();
    let voxel = light.project(point + normal * light.bias_m(point, normal, filter)).voxel;
    let radius = i64::from(filter.radius());
    let taps = (-radius..=radius).flat_map(|y| (-radius..=radius).map(move |x| (x, y)));
    let lit = taps.filter(|(x, y)| {
        let texel = [voxel.x.floor() as i64 + x, voxel.y.floor() as i64 + y].map(|c| c as u32);
        voxel.z.floor() < f64::from(oracle.interval(texel[0], texel[1]).enter)
    });
    lit.count() as f32 / (filter.taps() * filter.taps()) as f32
}

/// Under a roof of boards, on the boards and on sloping ground: what `static` promises to receivers on the scene's own
/// surfaces.
#[test]
fn static_bakes_filter_as_rays_do_on_slopes_with_enough_margin() {
    for degrees in [0.0, 25.0, 50.0, 65.0] {
        let turn = DQuat::from_rotation_z(f64::to_radians(degrees));
        let ground = cuboid([0.0; 3], [2.0, 0.0, 2.0], 0.0);
        let boards = (0..6).map(|i| cuboid([f64::from(i) * 0.7 - 1.75, 0.8, 0.0], [0.2, 0.0, 1.6], 0.1));
        // Sheets, not boxes: only their upper faces.
        let sheet = |(positions, triangles): common::TestMesh| (positions, vec![triangles[6], triangles[7]]);
        let scene = scene(std::iter::once(ground).chain(boards).map(sheet).collect(), DAffine3::from_quat(turn));
        let sun = sun([0.1, -1.0, 0.06]);
        let texel_m = {
            let probe = bake_for_check(&scene, &sun, &options(Interior::Open, 256, 1));
            probe.light().record().texel_size_m
        };
        let (normal, axes) = (turn * DVec3::Y, [turn * DVec3::X, turn * DVec3::Z]);
        let mut mismatches = [0; 2];
        for taps in [1, 5, 9, 17] {
            let filter = Filter::new_box(taps).unwrap();
            // Half the filter's width times the slope for the taps, and as much for the bias; two slices for rounding.
            let along = -sun.direction_world.dot(normal);
            let slope = (1.0 - along * along).sqrt() * 1.42 / along;
            let enough = f64::from(taps) * texel_m * slope + 0.02;
            for (which, margin) in [enough, 0.0].into_iter().enumerate() {
                let checked = bake_for_check(&scene, &sun, &options(Interior::Static(margin), 256, 1));
                common::with_oracle(&checked, 0, |oracle| {
                    let on_ground = face_points(DVec3::ZERO, axes, 1.5);
                    let on_boards = face_points(normal * 0.8, axes, 1.5).filter(|p| {
                        (0..6).any(|i| ((turn.inverse() * *p).x - (f64::from(i) * 0.7 - 1.75)).abs() < 0.1)
                    });
                    for point in on_ground.chain(on_boards).step_by(7) {
                        let expected = traced_filter(&checked, oracle, point, normal, filter);
                        let got = checked.light().filtered(point, Some(normal), filter);
                        mismatches[which] += u32::from(got != expected);
                    }
                });
            }
        }
        assert_eq!(mismatches[0], 0, "{degrees} degrees");
        assert!(mismatches[1] > 0 || degrees == 0.0, "{degrees} degrees: a margin makes no difference");
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
