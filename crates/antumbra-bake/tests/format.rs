//! Files as attackers and bad disks leave them: an error or the same answers, never a panic. And golden bytes.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod common;

use antumbra::format::write::{Contents, write};
use antumbra::format::{canonical, dag8};
use antumbra::{FacePoint, Filter, Interior, LightRecord, ShadowFile};
use common::{bake_for_check, cuboid, options, scene, sun};
use glam::{DAffine3, DVec3};
use proptest::prelude::*;
use std::sync::LazyLock;

/// A few solids and an open triangle, small enough to try every byte.
fn small_bytes() -> Vec<u8> {
    let meshes = vec![
        cuboid([0.0, -0.1, 0.0], [1.0, 0.1, 1.0], 0.0),
        cuboid([0.2, 0.3, 0.1], [0.2, 0.3, 0.25], 0.6),
        (vec![[-0.8, 0.5, -0.5], [-0.2, 0.7, -0.4], [-0.6, 0.6, 0.5]], vec![[0, 1, 2]]),
    ];
    let scene = scene(meshes, DAffine3::IDENTITY);
    bake_for_check(&scene, &sun([0.4, -0.8, 0.3]), &options(Interior::Auto, 64, 1)).bytes
}

static SMALL: LazyLock<Vec<u8>> = LazyLock::new(small_bytes);

/// Everything that a lookup can answer at the small resolution.
fn answers(file: &ShadowFile) -> Vec<bool> {
    let all = |light: antumbra::LightShadow<'_>| {
        (0..64 * 64 * 64).map(move |i| light.is_lit(0, [i & 63, (i >> 6) & 63, i >> 12])).collect::<Vec<_>>()
    };
    file.lights().flat_map(all).collect()
}

#[test]
fn golden_bytes() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/golden/small.antumbra");
    if std::env::var_os("ANTUMBRA_BLESS").is_some() {
        std::fs::write(path, &*SMALL).unwrap();
    }
    let golden = std::fs::read(path).expect("tests/golden/small.antumbra; make it with `cargo xtask bless`");
    assert!(golden == *SMALL, "the bytes of a small bake have changed: raise the format version or mend the bake");
}

#[test]
fn every_flipped_byte_is_noticed_or_harmless() {
    let file = ShadowFile::from_bytes(&SMALL).unwrap();
    let right = answers(&file);
    for at in 0..SMALL.len() {
        for flip in [0x01, 0x80, 0xff] {
            let mut bytes = SMALL.clone();
            bytes[at] ^= flip;
            if let Ok(file) = ShadowFile::from_bytes(&bytes) {
                assert!(answers(&file) == right, "byte {at} xor {flip:#x} changed an answer unnoticed");
            }
        }
    }
}

#[test]
fn every_truncation_and_extension_is_noticed() {
    for length in 0..SMALL.len() {
        assert!(ShadowFile::from_bytes(&SMALL[..length]).is_err(), "cut to {length} bytes");
    }
    let mut longer = SMALL.clone();
    longer.push(0);
    assert!(ShadowFile::from_bytes(&longer).is_err());
}

#[test]
fn errors_say_what_to_do() {
    let error = |bytes: &[u8]| ShadowFile::from_bytes(bytes).unwrap_err().to_string();
    assert!(error(b"glTF").contains("not an .antumbra file"));
    assert!(error(&SMALL[..SMALL.len() - 1]).contains("cut off"));
    let mut later = SMALL.clone();
    later[8] = 3;
    assert!(error(&later).contains("version 3.0"));
    let mut damaged = SMALL.clone();
    *damaged.last_mut().unwrap() ^= 1;
    assert!(error(&damaged).contains("checksum"));
}

#[test]
fn bakes_are_canonical_and_reordered_pools_are_not() {
    let file = ShadowFile::from_bytes(&SMALL).unwrap();
    canonical::check(&file).unwrap();
    let mut pool = file.pool().to_vec();
    let first = dag8::POOL_HEADER_WORDS;
    // Swap the first two masks and all references to them: the same answers, out of order.
    pool.swap(first, first + 2);
    pool.swap(first + 1, first + 3);
    let layout = dag8::layout(&pool).unwrap();
    let mut at = layout.slices;
    while at < layout.inner {
        let references = dag8::reference_count(pool[at]);
        for word in &mut pool[at + 1..=at + references] {
            *word = match *word as usize {
                w if w == first => first as u32 + 2,
                w if w == first + 2 => first as u32,
                w => w as u32,
            };
        }
        at += 1 + references;
    }
    let reordered = ShadowFile::from_bytes(&with_pool(&file, &pool)).unwrap();
    assert!(answers(&reordered) == answers(&file));
    assert!(canonical::check(&reordered).is_err());
}

/// The same file with other words, its checksums right.
fn with_pool(file: &ShadowFile, pool: &[u32]) -> Vec<u8> {
    let records: Vec<LightRecord> = file.lights().map(|l| *l.record()).collect();
    write(&Contents::new(&records, "sun", pool, file.stats().unwrap()))
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 20_000, ..ProptestConfig::default() })]

    /// Hostile words behind right checksums: validation alone must keep lookups in bounds.
    #[test]
    fn hostile_pools_never_panic(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u32>(), 0u8..4), 1..4),
    ) {
        let file = ShadowFile::from_bytes(&SMALL).unwrap();
        let mut pool = file.pool().to_vec();
        for (index, value, how) in changes {
            let at = index.index(pool.len());
            pool[at] = match how {
                0 => value,
                1 => pool[at] ^ (1 << (value % 32)),
                2 => value % pool.len() as u32,
                _ => pool[at].wrapping_add(value % 16).wrapping_sub(8),
            };
        }
        if let Ok(file) = ShadowFile::from_bytes(&with_pool(&file, &pool)) {
            let _ = canonical::check(&file);
            let light = file.light("sun").unwrap();
            let filter = Filter::new_tent(17).unwrap();
            for i in 0..512 {
                let voxel = [i & 7, (i >> 3) & 7, i >> 6].map(|c| c * 8 + 3);
                let _ = light.is_lit(0, voxel);
                let _ = light.voxel_filtered(FacePoint { face: 0, voxel: DVec3::from_array(voxel.map(f64::from)) }, filter);
            }
            for end in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_ONE] {
                let _ = light.lit_share(light.origin_world() - end * 9.0, light.origin_world() + end * 9.0);
            }
        }
    }

    #[test]
    fn hostile_records_never_panic(at in 0usize..256, value in any::<u8>(), point in prop::array::uniform3(-3.0f64..3.0)) {
        let file = ShadowFile::from_bytes(&SMALL).unwrap();
        let mut record = *file.lights().next().unwrap().record();
        bytemuck::bytes_of_mut(&mut record)[at] = value;
        let bytes = write(&Contents::new(&[record], "sun", file.pool(), file.stats().unwrap()));
        if let Ok(file) = ShadowFile::from_bytes(&bytes) {
            for light in file.lights() {
                let _ = light.visibility(DVec3::from_array(point));
                let _ = light.lit_share(DVec3::from_array(point), -DVec3::from_array(point));
                let _ = light.filtered(DVec3::from_array(point), Some(DVec3::Y), Filter::new_tent(9).unwrap());
            }
        }
    }
}
