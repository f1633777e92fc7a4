//! Node pools, records and sections made by hand to be wrong in one way each, behind right checksums.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use antumbra::format::stat::BakeStats;
use antumbra::format::write::{Contents, write};
use antumbra::format::{MAX_LIGHTS, canonical};
use antumbra::{FormatError, LightRecord, ShadowFile};

fn record(root: u32, log2_resolution: u32) -> LightRecord {
    let mut record: LightRecord = bytemuck::Zeroable::zeroed();
    (record.texel_size_m, record.slice_size_m, record.faces) = (1.0, 1.0, 1);
    record.log2_resolution = log2_resolution;
    record.roots[0] = root;
    record
}

fn file(records: &[LightRecord], pool: &[u32]) -> Result<ShadowFile, FormatError> {
    ShadowFile::from_bytes(&write(&Contents::new(records, "", pool, BakeStats::default())))
}

/// A pool of one mask (word 8), the given slice nodes (from word 10) and inner nodes behind them.
fn pool(slices: &[u32], inner: &[u32]) -> Vec<u32> {
    let header = [2, slices.len() as u32, inner.len() as u32, 0, 0, 0, 0, 0, 1, 0];
    [&header, slices, inner].concat()
}

/// A light of 64 texels whose root is the chain's last node.
fn chain(links: usize) -> (Vec<u32>, u32) {
    let mut inner = Vec::new();
    let mut last = 10;
    for _ in 0..links {
        let at = 12 + inner.len() as u32;
        inner.extend([0b10, last]);
        last = at;
    }
    (pool(&[0b10, 8], &inner), last)
}

#[test]
fn a_sound_pool_is_accepted() {
    let (mut pool, root) = chain(3);
    let without_means = file(&[record(root, 6)], &pool).unwrap();
    assert!(canonical::check(&without_means).is_err());
    canonical::set_means(&mut pool).unwrap();
    let file = file(&[record(root, 6)], &pool).unwrap();
    canonical::check(&file).unwrap();
    let light = file.lights().next().unwrap();
    // The mask's one bit is lit; the nodes' other children are lit because their codes are 0.
    assert!(
        light.is_lit(0, [0, 0, 0])
            && !light.is_lit(0, [1, 0, 0])
            && light.is_lit(0, [1, 0, 1])
            && light.is_lit(0, [8, 0, 0])
    );
}

#[test]
fn chains_of_the_wrong_length_are_refused() {
    for links in [0, 1, 2, 4, 14, 252, 253, 254, 255, 256, 259, 273, 600] {
        let (pool, root) = chain(links);
        for log2 in [6, 20] {
            let fits = links + 3 == log2 as usize;
            assert_eq!(file(&[record(root, log2)], &pool).is_ok(), fits, "{links} links at 2^{log2}");
        }
    }
}

#[test]
fn malformed_pools_are_refused() {
    let wrong: [(&str, Vec<u32>, u32); 13] = [
        ("a pool that is cut off", vec![0; 7], 0),
        ("stray words in the header", vec![0, 0, 0, 1, 0, 0, 0, 0], 0),
        ("parts that do not fill the pool", vec![2, 0, 0, 0, 0, 0, 0, 0], 0),
        ("half a mask", vec![1, 0, 0, 0, 0, 0, 0, 0, 0], 0),
        ("an odd reference to a mask", pool(&[0b10, 9], &[]), 0),
        ("a reference before the masks", pool(&[0b10, 7], &[]), 0),
        ("a slice node that refers to a slice node", pool(&[0b10, 10], &[]), 0),
        ("a child code of 3", pool(&[0b11, 8], &[]), 0),
        ("a slice node that runs into the inner nodes", pool(&[0b10], &[0b10, 10]), 0),
        ("a node that runs past the pool's end", pool(&[0b10, 8], &[0b1010, 10]), 0),
        ("a node that refers to itself", pool(&[0b10, 8], &[0b10, 12]), 0),
        ("a reference into the middle of a node", pool(&[0b10, 8], &[0b10, 11]), 0),
        ("references of two levels", pool(&[0b10, 8], &[0b10, 10, 0b1010, 10, 12]), 0),
    ];
    for (what, pool, root) in wrong {
        assert!(matches!(file(&[record(root, 6)], &pool), Err(FormatError::Malformed(_))), "{what} was accepted");
    }
    for (what, root) in [("a mask", 8), ("a slice node", 10), ("a reference", 13), ("nothing", 99)] {
        let (pool, _) = chain(3);
        assert!(file(&[record(root, 6)], &pool).is_err(), "{what} was accepted for a root");
    }
}

#[test]
fn malformed_records_are_refused() {
    type Change = fn(&mut LightRecord);
    let wrong: [(&str, Change); 16] = [
        ("a name outside the names", |r| r.name_length = 1),
        ("an endless name", |r| (r.name_offset, r.name_length) = (u32::MAX, u32::MAX)),
        ("an unknown kind", |r| r.kind = 7),
        ("a spot light without a range", |r| (r.kind, r.depth) = (1, 1)),
        ("a resolution of 32", |r| r.log2_resolution = 5),
        ("a resolution of 2^21", |r| r.log2_resolution = 21),
        ("an unknown policy", |r| r.interior = 5),
        ("an unknown encoding", |r| r.encoding = 2),
        ("a second root", |r| r.roots[1] = 1),
        ("no texel size", |r| r.texel_size_m = 0.0),
        ("a negative slice size", |r| r.slice_size_m = -1.0),
        ("an endless near distance", |r| r.near_m = f64::INFINITY),
        ("an origin that is no number", |r| r.origin_world[1] = f64::NAN),
        ("a map that is no number", |r| r.linear[2][0] = f64::NAN),
        ("an endless offset", |r| r.voxel_of_origin[0] = f64::NEG_INFINITY),
        ("a directional light with a tangent", |r| r.texels_per_tangent = 1.0),
    ];
    for (what, change) in wrong {
        let mut record = record(0, 6);
        change(&mut record);
        assert!(file(&[record], &[0; 8]).is_err(), "{what} was accepted");
    }
    assert!(file(&[], &[0; 8]).is_err(), "a file without lights was accepted");
}

#[test]
fn many_homogeneous_lights_are_cheap_and_too_many_refused() {
    let file_of = |lights: usize| file(&vec![record(1, 20); lights], &[0; 8]);
    let most = file_of(MAX_LIGHTS).unwrap();
    assert!(most.lights().all(|light| !light.is_lit(0, [5, 6, 7])));
    assert!(file_of(MAX_LIGHTS + 1).is_err());
}

#[test]
fn doubled_and_homogeneous_nodes_are_not_canonical() {
    let twice_a_mask = vec![4, 3, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 0b1010, 8, 10];
    let all_lit_mask = vec![2, 2, 0, 0, 0, 0, 0, 0, u32::MAX, u32::MAX, 0b10, 8];
    for (what, mut pool) in [("a doubled mask", twice_a_mask), ("a homogeneous mask", all_lit_mask)] {
        let mut last = if what.contains("doubled") { 12 } else { 10 };
        for _ in 0..3 {
            let at = pool.len() as u32;
            pool.extend([0b10, last]);
            pool[2] += 2;
            last = at;
        }
        canonical::set_means(&mut pool).unwrap();
        let file = file(&[record(last, 6)], &pool).unwrap();
        let error = canonical::check(&file).expect_err(what).to_string();
        assert!(error.contains("stored twice"), "{what}: {error}");
    }
    let (mut pool, _) = chain(3);
    canonical::set_means(&mut pool).unwrap();
    let unreachable = file(&[record(0, 6)], &pool).unwrap();
    let error = canonical::check(&unreachable).unwrap_err().to_string();
    assert!(error.contains("no light reaches"), "{error}");
}

/// A light of 128 texels, one coarse level, and cells of enter depths.
fn with_sections(levels: Option<&[u32]>, enters: Option<&[u8]>) -> Result<ShadowFile, FormatError> {
    let (pool, root) = chain(4);
    let records = [record(root, 7)];
    let mut contents = Contents::new(&records, "", &pool, BakeStats::default());
    contents.levels = levels;
    contents.enters = enters;
    ShadowFile::from_bytes(&write(&contents))
}

#[test]
fn coarse_levels_must_fit() {
    let (_, root) = chain(3);
    let file = with_sections(Some(&[root]), None).unwrap();
    let light = file.lights().next().unwrap();
    assert!(light.has_levels() && light.is_lit_on_level(1, 0, [0, 0, 0]));
    let (_, own) = chain(4);
    for wrong in [&[][..], &[own], &[root, root], &[7], &[u32::MAX], &[root + 1]] {
        assert!(with_sections(Some(wrong), None).is_err(), "{wrong:?} was accepted");
    }
}

#[test]
fn enter_depths_must_fit() {
    // Two cells per side.
    let cells =
        |log2: u32, shift: u32, bytes: usize| [&log2.to_le_bytes()[..], &shift.to_le_bytes(), &vec![5; bytes]].concat();
    let file = with_sections(None, Some(&cells(1, 0, 16))).unwrap();
    let light = file.lights().next().unwrap();
    assert_eq!(light.enter_bounds(0, [100, 3]), Some([0x0505; 2]));
    // A depth behind the last slice is nobody's blocker, wherever one asks.
    for x in [-1e9, 0.0, 63.9, 127.0, f64::NAN, f64::INFINITY] {
        for radius in [0.0, 3.0, 1e9, f64::NAN, f64::INFINITY] {
            let _ = light.blocker(glam::DVec3::new(x, 1.0, x), radius);
        }
    }
    for wrong in [
        vec![],
        vec![0; 7],
        cells(1, 0, 12),
        cells(1, 0, 20),
        cells(5, 0, 4096),
        cells(9, 0, 16),
        cells(31, 0, 16),
        cells(u32::MAX, 0, 16),
        cells(1, 9, 16),
        cells(1, u32::MAX, 16),
    ] {
        assert!(with_sections(None, Some(&wrong)).is_err(), "{} bytes were accepted", wrong.len());
    }
}

#[test]
fn local_lights_must_make_sense() {
    type Change = fn(&mut LightRecord);
    let lamp = || LightRecord {
        kind: 2,
        slice_size_m: 0.0,
        near_m: 0.01,
        far_m: 10.0,
        faces: 6,
        depth: 1,
        texels_per_tangent: 24.0,
        linear: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        ..record(1, 6)
    };
    assert!(file(&[lamp()], &[0; 8]).is_ok());
    let wrong: [(&str, Change); 12] = [
        ("a lamp with one face", |r| r.faces = 1),
        ("a lamp without faces", |r| r.faces = 0),
        ("a lamp with many faces", |r| r.faces = 7),
        ("a spot with two faces", |r| (r.kind, r.faces) = (1, 2)),
        ("even slices", |r| r.depth = 0),
        ("unknown slices", |r| r.depth = 3),
        ("no near distance", |r| r.near_m = 0.0),
        ("a near distance behind the far one", |r| r.near_m = 11.0),
        ("no far distance", |r| r.far_m = f64::NAN),
        ("no tangent", |r| r.texels_per_tangent = 0.0),
        ("an endless tangent", |r| r.texels_per_tangent = f64::INFINITY),
        ("a cone that is none", |r| r.cone_cosine = 1.5),
    ];
    for (what, change) in wrong {
        let mut record = lamp();
        change(&mut record);
        assert!(file(&[record], &[0; 8]).is_err(), "{what} was accepted");
    }
}
