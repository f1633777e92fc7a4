//! The builder against the oracle on triangles put on the lattice by hand: corners at texel centres and on slice
//! boundaries, where every tie must be broken alike.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use antumbra::format::stat::BakeStats;
use antumbra::format::write::{Contents, write};
use antumbra::{LightRecord, ShadowFile};
use antumbra_bake::columns::{Build, BuildTriangle, Freedom, build};
use antumbra_bake::dag::{Tables, encode};
use antumbra_bake::light_space::{LatticeTriangle, Resolution, Slices};
use antumbra_bake::oracle::{Free, Oracle, View};
use proptest::prelude::*;

const SIDE: u32 = 64;

fn bake_on_lattice(triangles: &[LatticeTriangle], resolution: Resolution) -> ShadowFile {
    let slices = Slices::even(resolution);
    let built: Vec<_> = triangles.iter().filter_map(|t| BuildTriangle::new(t, &slices)).collect();
    let tables = Tables::default();
    let all = Build {
        triangles: &built,
        cutouts: &[],
        slices: &slices,
        freedom: &Freedom::None,
        enters: None,
        tables: &tables,
        memory_limit: u64::MAX,
        progress: &|_| {},
        pause: &antumbra_bake::never_pause,
    };
    let root = build(&all).unwrap();
    let encoded = encode(tables, &[(root, resolution.log2())], u64::MAX, &antumbra_bake::never_pause).unwrap();
    let mut record: LightRecord = bytemuck::Zeroable::zeroed();
    record.log2_resolution = resolution.log2();
    (record.texel_size_m, record.slice_size_m, record.faces) = (1.0, 1.0, 1);
    record.roots[0] = encoded.roots[0];
    let bytes = write(&Contents::new(&[record], "", &encoded.pool, BakeStats::default()));
    ShadowFile::from_bytes(&bytes).unwrap()
}

fn check(triangles: &[LatticeTriangle]) -> Result<(), String> {
    let resolution = Resolution::new(SIDE).unwrap();
    let file = bake_on_lattice(triangles, resolution);
    antumbra::format::canonical::check(&file).map_err(|e| e.to_string())?;
    let light = file.lights().next().unwrap();
    let slice = |step: u32| step >> resolution.slice_shift();
    let view = View { resolution, slice: &slice, keeps: &|_, _| true, free: Free::Nothing };
    let oracle = Oracle::new(triangles, view);
    for i in 0..SIDE * SIDE {
        let (x, y) = (i % SIDE, i / SIDE);
        let interval = oracle.interval(x, y);
        let wrong = |z: &u32| {
            if light.is_lit(0, [x, y, *z]) { *z >= interval.exit } else { *z < interval.enter }
        };
        if let Some(z) = (0..SIDE).find(wrong) {
            return Err(format!("texel ({x}, {y}) is wrong at slice {z}: {interval:?}"));
        }
    }
    Ok(())
}

type Corner = (i32, i32, u32);

fn corner() -> impl Strategy<Value = Corner> {
    // Half texels: odd ones are centres.
    let lateral = || prop_oneof![4 => (0i32..=128).prop_map(|c| c << 19), 1 => 0i32..=1 << 26];
    let depth = prop_oneof![
        2 => (0u32..64).prop_map(|c| c << 26),
        1 => (1u32..64).prop_map(|c| (c << 26) - 1),
        2 => 0u32..63 << 26,
        1 => 0u32..3 << 26,
    ];
    (lateral(), lateral(), depth)
}

fn triangle(corners: [Corner; 3], solid: bool) -> LatticeTriangle {
    LatticeTriangle { x: corners.map(|c| c.0), y: corners.map(|c| c.1), z: corners.map(|c| c.2), solid }
}

fn tetrahedron([a, b, c, d]: [Corner; 4]) -> Vec<LatticeTriangle> {
    [[a, b, c], [a, d, b], [b, d, c], [c, d, a]].map(|t| triangle(t, true)).to_vec()
}

fn triangles() -> impl Strategy<Value = Vec<LatticeTriangle>> {
    let open = prop::collection::vec(prop::array::uniform3(corner()).prop_map(|c| triangle(c, false)), 0..6);
    let solids = prop::collection::vec(prop::array::uniform4(corner()).prop_map(tetrahedron), 0..5);
    (open, solids).prop_map(|(open, solids)| open.into_iter().chain(solids.into_iter().flatten()).collect())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, ..ProptestConfig::default() })]

    #[test]
    fn agrees_on_the_lattice(triangles in triangles()) {
        check(&triangles).map_err(TestCaseError::fail)?;
    }
}

#[test]
fn a_slope_in_the_first_slices() {
    let slope = |z: [u32; 4]| {
        let corner = |i: usize| (((i & 1) as i32) << 26, ((i >> 1) as i32) << 26, z[i]);
        vec![triangle([corner(0), corner(1), corner(2)], false), triangle([corner(1), corner(3), corner(2)], false)]
    };
    check(&slope([1 << 22, 1 << 25, 1 << 24, 3 << 26])).unwrap();
    check(&slope([0, 0, 0, 0])).unwrap();
}
