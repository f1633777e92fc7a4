//! The encoding `silhouette`: its lookups against single voxels, its size, and bytes that are no file.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod common;

use std::sync::LazyLock;

use antumbra::format::packed;
use antumbra::format::silhouette::{self, Kind};
use antumbra::format::write::{Contents, write};
use antumbra::{FacePoint, Filter, Interior, Kernel, LightKind, LightShadow, ShadowFile};
use antumbra_bake::{BakeError, BakeOptions, Encoding, Method, Silent, bake};
use antumbra_scene::{Light, Scene, procedural};
use common::{Checked, bake_for_check, cuboid, lamp, options, scene, spot, sun};
use glam::{DAffine3, DMat3, DVec3};
use proptest::prelude::*;

static CITY: LazyLock<Scene> = LazyLock::new(|| {
    procedural::build("city", &procedural::Options { seed: 5, scale: 0.15, ..Default::default() }).unwrap()
});

fn baked(light: &Light, encoding: Encoding, resolution: u32) -> Checked<'static> {
    bake_for_check(&CITY, light, &BakeOptions { encoding: Some(encoding), ..options(Interior::Auto, resolution, 0) })
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
    fn means_count_voxels(x in 0u32..1024, y in 0u32..1024, z in 0u32..1024, level in 0u32..6) {
        let light = SUN.light();
        let [x0, y0, z0] = [x, y, z].map(|c| c >> level << level);
        let side = 1u32 << level;
        // Every column of small nodes, those in the middles of 8 x 8 parts of large ones.
        let (columns, apart) = (side.min(8), side / side.min(8));
        let at = |i: u32| i * apart + apart / 2;
        let voxels = (0..columns * columns * side).map(|i| [i % columns, i / columns % columns, i / columns / columns]);
        let lit = voxels.filter(|v| light.is_lit(0, [x0 + at(v[0]), y0 + at(v[1]), z0 + v[2]])).count();
        let mean = light.voxel_mean(0, [x, y, z], level);
        prop_assert_eq!(mean, lit as f32 / (columns * columns * side) as f32);
    }

    #[test]
    fn coarse_levels_are_points_in_the_middles(
        x in 0.0f64..1024.0, y in 0.0f64..1024.0, off in -60.0f64..60.0, half in 0u32..=8, level in 1u32..=4,
    ) {
        let light = SUN.light();
        prop_assert!(light.has_levels() && light.levels() == 4);
        let filter = Filter::new(2 * half + 1, Kernel::Tent).unwrap();
        let texel = [x, y].map(|c| c as u32);
        let turn = (0..1024).position(|z| !light.is_lit(0, [texel[0], texel[1], z])).unwrap_or(1023);
        let at = FacePoint { face: 0, voxel: DVec3::new(x, y, (turn as f64 + off).clamp(0.0, 1023.0)) };
        let point = light.unproject(at).unwrap();
        let scale = f64::from(1u32 << level);
        let coarse = (light.project(point).voxel / scale).floor();
        let radius = half as i32;
        let (mut lit, mut all) = (0, 0);
        for (dx, dy) in (-radius..=radius).flat_map(|y| (-radius..=radius).map(move |x| (x, y))) {
            let weight = filter.weight(dx.unsigned_abs()) * filter.weight(dy.unsigned_abs());
            let middle = (coarse + DVec3::new(f64::from(dx) + 0.5, f64::from(dy) + 0.5, 0.5)) * scale;
            all += weight;
            lit += if light.voxel_visibility(FacePoint { face: 0, voxel: middle }) == 1.0 { weight } else { 0 };
        }
        let found = light.level_filtered(point, None, filter, f64::from(level));
        prop_assert_eq!(found, lit as f32 / all as f32, "{} of {:?}", coarse, light.project(point));
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
    let [a, b] = [Encoding::Dag8, Encoding::Silhouette].map(|encoding| {
        bake_for_check(&CITY, &light, &BakeOptions { encoding: Some(encoding), ..options(Interior::Open, 128, 0) })
    });
    for face in 0..6 {
        for i in 0..128u32.pow(3) {
            let voxel = [i % 128, i / 128 % 128, i / 16384];
            assert_eq!(a.light().is_lit(face, voxel), b.light().is_lit(face, voxel), "face {face}, {voxel:?}");
        }
    }
}

/// In the middle of a texel and at the end of a slice a continuous answer is the voxel's.
#[test]
fn continuous_lookups_pass_through_the_voxels() {
    for light in
        [sun([0.5, -0.6, 0.3]), lamp([3.0, 12.0, -4.0], 200.0), spot([10.0, 60.0, 5.0], [0.2, -1.0, 0.1], 40.0, 200.0)]
    {
        let baked = baked(&light, Encoding::Silhouette, 256);
        let light = baked.light();
        let mut lit = 0;
        for face in 0..light.faces() {
            for i in 0..256u32.pow(3) / 7 {
                let voxel = [7 * i % 256, 7 * i / 256 % 256, 7 * i / 65536];
                let [x, y, z] = voxel.map(f64::from);
                let at = FacePoint { face, voxel: DVec3::new(x + 0.5, y + 0.5, z + 1.0 - 1e-9) };
                assert_eq!(light.voxel_continuous(at), f32::from(light.is_lit(face, voxel)), "{face}, {voxel:?}");
                lit += u32::from(light.is_lit(face, voxel));
            }
        }
        assert!(lit > 1000);
    }
}

/// Where shadows of a few boxes end, continuous lookups are wrong an order of magnitude less often than voxels.
#[test]
fn continuous_lookups_follow_the_casters_edges() {
    let boxes = [([1.0, 2.0, -2.0], [0.7, 2.0, 0.5], 0.3), ([-3.0, 1.0, 1.0], [1.0, 1.0, 0.6], 1.1)];
    let casters = boxes.map(|(center, half, turn)| cuboid(center, half, turn));
    let scene = scene(casters.to_vec(), DAffine3::IDENTITY);
    let direction = [0.37, -0.81, 0.45];
    for light in [sun(direction), lamp([0.5, 9.0, 0.2], 30.0)] {
        let options = BakeOptions { encoding: Some(Encoding::Silhouette), ..options(Interior::Auto, 512, 0) };
        let baked = bake_for_check(&scene, &light, &options);
        let shadow = baked.light();
        let mut wrong = [0; 2];
        for i in 0..2_000_000u32 {
            // Spread evenly below the casters.
            let part = |step: f64| (f64::from(i) * step).fract() * 16.0 - 8.0;
            let point = DVec3::new(part(0.754_877_666), -2.0, part(0.569_840_291));
            let towards = match shadow.kind() {
                LightKind::Directional => -shadow.direction_world(),
                _ => shadow.origin_world() - point,
            };
            let is_lit = !boxes.iter().any(|(center, half, turn)| {
                let turned = DMat3::from_rotation_y(-turn);
                let [from, to] = [turned * (point - DVec3::from_array(*center)), turned * towards];
                let [a, b] = [-1.0, 1.0].map(|sign| (sign * DVec3::from_array(*half) - from) / to);
                let (enter, exit) = (a.min(b).max_element(), a.max(b).min_element());
                exit > enter.max(0.0)
            });
            for (wrong, filter) in wrong.iter_mut().zip([Filter::default(), Filter::continuous()]) {
                *wrong += u32::from((shadow.filtered(point, None, filter) == 1.0) != is_lit);
            }
        }
        println!("{}: {} of 2,000,000 wrong by voxels, {} between them", shadow.kind().name(), wrong[0], wrong[1]);
        assert!(wrong[0] > 300 && wrong[1] * 8 < wrong[0], "{wrong:?}");
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
        let options = BakeOptions { encoding: Some(encoding), ..options(Interior::Auto, resolution, 0) };
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
        let options = BakeOptions { encoding: Some(Encoding::Silhouette), ..options };
        bake(&CITY, &[sun([0.5, -0.6, 0.3])], &options, &Silent).map(|_| ())
    };
    let others = refused(BakeOptions { method: Method::Kampe2015, ..options(Interior::Auto, 64, 1) });
    assert!(matches!(others, Err(BakeError::Method("kampe2015"))));
    let small = BakeOptions { memory_limit: Some(8 << 20), ..options(Interior::Open, 8192, 1) };
    assert!(matches!(refused(small), Err(BakeError::Memory { stage: "building", .. })));
    // 65 tables of a million slices each: more than readers hold.
    let lamps: Vec<Light> = (0..65).map(|i| lamp([3.0, 12.0, -4.0], 80.0 + f64::from(i))).collect();
    let encoding = Some(Encoding::Silhouette);
    let fine = BakeOptions { encoding, near_m: Some(0.1), ..options(Interior::Open, 1 << 20, 1) };
    assert!(matches!(bake(&CITY, &lamps, &fine, &Silent), Err(BakeError::Slices { mib: 260 })));
}

/// Any word of a pool may be anything: it is refused, or lookups in it stay inside.
#[test]
fn no_word_of_a_pool_can_do_harm() {
    let boxes = vec![cuboid([0.0, 0.5, 0.0], [0.5, 0.5, 0.5], 0.3), cuboid([0.0, -0.1, 0.0], [2.0, 0.1, 2.0], 0.0)];
    let scene = scene(boxes, DAffine3::IDENTITY);
    let options = BakeOptions { encoding: Some(Encoding::Silhouette), ..options(Interior::Auto, 256, 1) };
    for light in [sun([0.37, -0.81, 0.45]), spot([1.0, 4.0, 0.5], [-0.2, -1.0, 0.1], 40.0, 20.0)] {
        let baked = bake(&scene, &[light], &options, &Silent).unwrap();
        let file = ShadowFile::from_bytes(&baked.bytes).unwrap();
        let (mut refused, mut read) = (0, 0);
        let words = file.pool().len();
        for at in (0..words).step_by(1 + words / 4000) {
            let inner = silhouette::reference(Kind::Inner, at as u32);
            for word in [0, 1, u32::MAX, 0x16ff_ffff, file.pool()[at] ^ (1 << (at % 32)), inner] {
                let mut pool = file.pool().to_vec();
                pool[at] = word;
                let records = [*file.lights().next().unwrap().record()];
                let contents = Contents::new(&records, "sun", &pool, file.stats().unwrap());
                match ShadowFile::from_bytes(&write(&contents)) {
                    Err(_) => refused += 1,
                    Ok(changed) => {
                        read += 1;
                        look_around(changed.lights().next().unwrap());
                    }
                }
            }
        }
        assert!(refused > 100 && read > 100, "{refused} refused, {read} read");
    }
}

/// All kinds of lookups at places in a light of 256 texels per side.
fn look_around(light: LightShadow<'_>) {
    for i in 0..64u32 {
        let voxel = [i * 4, i * 29 % 256, i * 13 % 256];
        let voxel_at = DVec3::from_array(voxel.map(f64::from));
        let at = FacePoint { face: 0, voxel: DVec3 { z: 99.0, ..voxel_at } };
        let answers = [
            f32::from(light.is_lit(0, voxel)),
            light.voxel_filtered(at, Filter::new_tent(9).unwrap()),
            light.voxel_filtered(FacePoint { voxel: voxel_at + 0.3, ..at }, Filter::continuous()),
            light.voxel_mean(0, voxel, 4),
        ];
        assert!(answers.iter().all(|a| (0.0..=1.0).contains(a)));
    }
    let ends = [0.0, 255.0].map(|c| light.unproject(FacePoint { face: 0, voxel: DVec3::new(c, 128.0, c) }).unwrap());
    assert!((0.0..=1.0).contains(&light.lit_share(ends[0], ends[1])));
}

/// Packing changes no word, whatever lights and policies there are.
#[test]
fn packed_pools_unpack_to_the_same_words() {
    let lamps = [lamp([3.0, 12.0, -4.0], 80.0), spot([10.0, 60.0, 5.0], [0.2, -1.0, 0.1], 40.0, 200.0)];
    let lights = [&[sun([0.5, -0.6, 0.3]), sun([0.0, -1.0, 0.0])][..], &lamps].concat();
    for interior in [Interior::Auto, Interior::Open] {
        let with = |is_unpacked| {
            let encoding = Encoding::Silhouette;
            let options = BakeOptions { encoding: Some(encoding), is_unpacked, ..options(interior, 512, 0) };
            let bytes = bake(&CITY, &lights, &options, &Silent).unwrap().bytes;
            (bytes.len(), ShadowFile::from_bytes(&bytes).unwrap())
        };
        let ((packed_bytes, packed), (bytes, plain)) = (with(false), with(true));
        assert!(packed.pool() == plain.pool());
        let section = |file: &ShadowFile, kind: &[u8; 4]| file.sections().iter().any(|(other, _)| other == kind);
        assert!(section(&packed, b"SILP") && section(&plain, b"SILH"));
        assert!(2 * packed_bytes < bytes, "{packed_bytes} of {bytes} bytes");
        let roots = plain.lights().flat_map(|light| light.record().face_roots().to_vec());
        let levels: Vec<u32> =
            plain.lights().flat_map(|light| vec![light.record().log2_resolution; light.faces()]).collect();
        let bytes = packed::pack(plain.pool(), roots);
        assert!(packed::unpack(&bytes, &levels).unwrap() == plain.pool());
    }
}

/// Any byte of a packed pool's streams may be anything: it is refused, or gives a pool that is checked as any other.
#[test]
fn no_byte_of_a_packed_pool_can_do_harm() {
    let checked = baked(&sun([0.37, -0.81, 0.45]), Encoding::Silhouette, 128);
    let (pool, root) = (checked.file.pool(), checked.light().record().roots[0]);
    let good = packed::pack(pool, [root]);
    let streams = miniz_oxide::inflate::decompress_to_vec(&good[8..]).unwrap();
    let packed_again = |header: &[u8], streams: &[u8]| {
        packed::unpack(&[header, &miniz_oxide::deflate::compress_to_vec(streams, 1)].concat(), &[7])
    };
    assert!(packed_again(&good[..8], &streams).unwrap() == pool);
    let (mut refused, mut other) = (0, 0);
    let mut count = |result: Result<Vec<u32>, _>| match result {
        Err(_) => refused += 1,
        Ok(words) if words == pool => {}
        Ok(words) => {
            let check =
                silhouette::Check::new(&words).and_then(|mut check| check.tree(root, 7, false).and(check.finish()));
            other += usize::from(check.is_ok());
        }
    };
    for at in (0..streams.len()).step_by(1 + streams.len() / 3000) {
        for byte in [0, 1, 7, 128, 255, streams[at] ^ (1 << (at % 8))] {
            let mut changed = streams.clone();
            changed[at] = byte;
            count(packed_again(&good[..8], &changed));
        }
        count(packed_again(&good[..8], &streams[..at]));
    }
    for at in 0..good.len().min(4000) {
        let mut changed = good.clone();
        changed[at] ^= 1 << (at % 8);
        count(packed::unpack(&changed, &[7]));
        count(packed::unpack(&good[..at], &[7]));
    }
    for words in [0, 8, u32::MAX] {
        count(packed_again(&[words.to_le_bytes(), pool[0].to_le_bytes()].concat(), &streams));
        count(packed_again(&[(pool.len() as u32).to_le_bytes(), words.to_le_bytes()].concat(), &streams));
    }
    assert!(refused > 1000 && other > 10, "{refused} refused, {other} valid ones of other words");
}
