//! The encoding `silhouette`: its lookups against single voxels, its size, and bytes that are no file.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod common;

use std::sync::LazyLock;

use antumbra::format::silhouette::{self, Kind};
use antumbra::{FacePoint, Filter, Interior, Kernel, LightShadow, ShadowFile};
use antumbra_bake::{BakeError, BakeOptions, Encoding, Method, Silent, bake};
use antumbra_scene::{Light, Scene, procedural};
use common::{Checked, bake_for_check, cuboid, lamp, options, scene, spot, sun};
use glam::{DAffine3, DVec3};
use proptest::prelude::*;

static CITY: LazyLock<Scene> = LazyLock::new(|| {
    procedural::build("city", &procedural::Options { seed: 5, scale: 0.15, ..Default::default() }).unwrap()
});

fn baked(light: &Light, encoding: Encoding, resolution: u32) -> Checked<'static> {
    bake_for_check(&CITY, light, &BakeOptions { encoding, ..options(Interior::Auto, resolution, 0) })
}

static SUN: LazyLock<Checked<'static>> = LazyLock::new(|| baked(&sun([0.5, -0.6, 0.3]), Encoding::Silhouette, 1024));

fn voxel_by_voxel(light: LightShadow<'_>, at: FacePoint, filter: Filter) -> f32 {
    let radius = filter.radius() as i32;
    let (mut lit, mut all) = (0, 0);
    for y in -radius..=radius {
        for x in -radius..=radius {
            let weight = filter.weight(x.unsigned_abs()) * filter.weight(y.unsigned_abs());
            let voxel = at.voxel.floor() + DVec3::new(f64::from(x) + 0.5, f64::from(y) + 0.5, at.voxel.z.fract());
            let is_lit = light.voxel_visibility(FacePoint { voxel, ..at }) == 1.0;
            lit += if is_lit { weight } else { 0 };
            all += weight;
        }
    }
    lit as f32 / all as f32
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 10_000, ..ProptestConfig::default() })]

    #[test]
    fn filters_equal_their_taps(
        x in -20.0f64..1044.0, y in -20.0f64..1044.0, off in -30.0f64..30.0, half in 0u32..=8, tent in any::<bool>(),
    ) {
        let light = SUN.light();
        let filter = Filter::new(2 * half + 1, if tent { Kernel::Tent } else { Kernel::Box }).unwrap();
        // About where the ray turns.
        let texel = [x, y].map(|c| (c.max(0.0) as u32).min(1023));
        let turn = (0..1024).position(|z| !light.is_lit(0, [texel[0], texel[1], z])).unwrap_or(1023);
        let at = FacePoint { face: 0, voxel: DVec3::new(x, y, turn as f64 + off) };
        prop_assert_eq!(light.voxel_filtered(at, filter), voxel_by_voxel(light, at, filter));
    }

    #[test]
    fn means_count_voxels(x in 0u32..1024, y in 0u32..1024, z in 0u32..1024, level in 0u32..5) {
        let light = SUN.light();
        let corner = [x, y, z].map(|c| c >> level << level);
        let side = 1u32 << level;
        let voxels = (0..side.pow(3)).map(|i| [i % side, i / side % side, i / side / side]);
        let lit = voxels.filter(|v| light.is_lit(0, [corner[0] + v[0], corner[1] + v[1], corner[2] + v[2]])).count();
        let mean = light.voxel_mean(0, [x, y, z], level);
        prop_assert!((mean - lit as f32 / side.pow(3) as f32).abs() < 1e-6);
    }
}

/// Every run of a segment is as lit as the points on it.
#[test]
fn segments_are_made_of_their_points() {
    let lights =
        [sun([0.5, -0.6, 0.3]), lamp([3.0, 12.0, -4.0], 200.0), spot([10.0, 60.0, 5.0], [0.2, -1.0, 0.1], 40.0, 200.0)];
    for light in lights {
        let checked = baked(&light, Encoding::Silhouette, 256);
        let light = checked.light();
        let mut runs = 0;
        for i in 0..400u32 {
            let at = |k: u32| f64::from((i * 7919 + k * 104_729) % 1000) / 10.0 - 50.0;
            let [from, to] = [DVec3::new(at(1), at(2).abs(), at(3)), DVec3::new(at(4), at(5).abs(), at(6))];
            let mut end = 0.0;
            for run in light.segment(from, to) {
                assert_eq!(run.from, end);
                end = run.to;
                runs += 1;
                let middle = from.lerp(to, 0.5 * (run.from + run.to));
                let is_long = (run.to - run.from) * from.distance(to) > 1e-6;
                assert!(!is_long || (light.visibility(middle) == 1.0) == run.lit, "{from} to {to}: {run:?}");
            }
            assert_eq!(end, 1.0);
        }
        assert!(runs > 500, "{runs} runs");
    }
}

/// Both encodings take any depth that a policy allows; where it allows one alone they are equal voxel by voxel.
#[test]
fn what_is_exact_is_the_same_in_both_encodings() {
    let light = lamp([3.0, 12.0, -4.0], 80.0);
    let [a, b] = [Encoding::Dag8, Encoding::Silhouette]
        .map(|encoding| bake_for_check(&CITY, &light, &BakeOptions { encoding, ..options(Interior::Open, 128, 0) }));
    for face in 0..6 {
        for i in 0..128u32.pow(3) {
            let voxel = [i % 128, i / 128 % 128, i / 16384];
            assert_eq!(a.light().is_lit(face, voxel), b.light().is_lit(face, voxel), "face {face}, {voxel:?}");
        }
    }
}

/// Sixteen times as fine a bake takes a few times as much, a voxel graph many times.
#[test]
fn bytes_hardly_grow() {
    let boxes = (0..40).map(|i| {
        let (x, z) = (f64::from(i % 8) * 3.0, f64::from(i / 8) * 4.0);
        cuboid([x, 1.0, z], [0.8, 1.0 + 0.1 * f64::from(i), 0.9], 0.1 * f64::from(i))
    });
    let ground = cuboid([10.0, -0.5, 8.0], [20.0, 0.5, 20.0], 0.0);
    let scene = scene(boxes.chain([ground]).collect(), DAffine3::IDENTITY);
    let bytes = |encoding, resolution| {
        let options = BakeOptions { encoding, ..options(Interior::Auto, resolution, 0) };
        bake(&scene, &[sun([0.37, -0.81, 0.45])], &options, &Silent).unwrap().bytes.len() as f64
    };
    let growth = |encoding| bytes(encoding, 65536) / bytes(encoding, 4096);
    let (ours, graph) = (growth(Encoding::Silhouette), growth(Encoding::Dag8));
    println!("{ours} and {graph} times as many bytes at 65536 as at 4096");
    assert!(ours < 3.5 && graph > 2.0 * ours, "{ours} and {graph}");
}

#[test]
fn what_the_encoding_does_not_know_is_refused() {
    let refused = |options: BakeOptions| {
        let options = BakeOptions { encoding: Encoding::Silhouette, ..options };
        bake(&CITY, &[sun([0.5, -0.6, 0.3])], &options, &Silent).map(|_| ())
    };
    let is_refused = |result| matches!(result, Err(BakeError::Encoding { encoding: "silhouette", .. }));
    assert!(is_refused(refused(BakeOptions { levels: true, ..options(Interior::Auto, 64, 1) })));
    assert!(is_refused(refused(BakeOptions { method: Method::Kampe2015, ..options(Interior::Auto, 64, 1) })));
    let small = BakeOptions { memory_limit: Some(40 << 20), ..options(Interior::Open, 8192, 1) };
    assert!(matches!(refused(small), Err(BakeError::Memory { .. })));
}

/// Any word of a pool may be anything: it is refused, or lookups in it stay inside.
#[test]
fn no_word_of_a_pool_can_do_harm() {
    let boxes = vec![cuboid([0.0, 0.5, 0.0], [0.5, 0.5, 0.5], 0.3), cuboid([0.0, -0.1, 0.0], [2.0, 0.1, 2.0], 0.0)];
    let scene = scene(boxes, DAffine3::IDENTITY);
    let options = BakeOptions { encoding: Encoding::Silhouette, ..options(Interior::Auto, 256, 1) };
    let baked = bake(&scene, &[sun([0.37, -0.81, 0.45])], &options, &Silent).unwrap();
    let file = ShadowFile::from_bytes(&baked.bytes).unwrap();
    let (mut refused, mut read) = (0, 0);
    let words = file.pool().len();
    for at in (0..words).step_by(1 + words / 4000) {
        for word in [0, 1, u32::MAX, file.pool()[at] ^ (1 << (at % 32)), silhouette::reference(Kind::Inner, at as u32)]
        {
            let mut pool = file.pool().to_vec();
            pool[at] = word;
            let records = [*file.lights().next().unwrap().record()];
            let contents = antumbra::format::write::Contents::new(&records, "sun", &pool, file.stats().unwrap());
            match ShadowFile::from_bytes(&antumbra::format::write::write(&contents)) {
                Err(_) => refused += 1,
                Ok(changed) => {
                    read += 1;
                    let light = changed.lights().next().unwrap();
                    for i in 0..64u32 {
                        let voxel = [i * 4, i * 29 % 256, i * 13 % 256];
                        let point =
                            FacePoint { face: 0, voxel: DVec3::new(f64::from(voxel[0]), f64::from(voxel[1]), 99.0) };
                        let filter = Filter::new_tent(9).unwrap();
                        let answers = [f32::from(light.is_lit(0, voxel)), light.voxel_filtered(point, filter)];
                        assert!(answers.iter().all(|a| (0.0..=1.0).contains(a)));
                    }
                }
            }
        }
    }
    assert!(refused > 100 && read > 100, "{refused} refused, {read} read");
}
