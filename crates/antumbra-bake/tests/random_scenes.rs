//! The builder against the oracle on random and nasty scenes: every texel, every slice.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod common;

use antumbra::Interior;
use antumbra_bake::{BakeOptions, Encoding};
use antumbra_scene::Scene;
use common::{
    Checked, TestMesh as Mesh, bake_for_check, check_all, check_texels, cuboid, loose, options, scene, solid, soup,
    sun, turned, with_oracle,
};
use glam::{DAffine3, DVec3};
use proptest::prelude::*;

/// Triangles anywhere, some of them thin.
fn some_thin() -> impl Strategy<Value = Mesh> {
    let thin = (prop::array::uniform3(-1.0f32..1.0), prop::array::uniform3(-1.0f32..1.0), 0.0f32..1e-3)
        .prop_map(|(a, b, e)| [a, b, [(a[0] + b[0]) * 0.5 + e, (a[1] + b[1]) * 0.5, (a[2] + b[2]) * 0.5 - e]]);
    (soup(20), prop::collection::vec(thin, 0..6)).prop_map(|((mut positions, mut triangles), thin)| {
        let (corners, indices) = loose(thin);
        let first = positions.len() as u32;
        positions.extend(corners);
        triangles.extend(indices.into_iter().map(|t| t.map(|i| i + first)));
        (positions, triangles)
    })
}

fn meshes() -> impl Strategy<Value = Vec<Mesh>> {
    prop_oneof![
        prop::collection::vec(some_thin(), 1..2),
        prop::collection::vec(solid(), 1..7),
        (prop::collection::vec(solid(), 1..5), some_thin()).prop_map(|(mut solids, soup)| {
            solids.push(soup);
            solids
        }),
    ]
}

fn direction() -> impl Strategy<Value = [f64; 3]> {
    prop_oneof![
        4 => prop::array::uniform3(-1.0f64..1.0).prop_filter("not zero", |d| d.iter().any(|c| c.abs() > 0.01)),
        1 => Just([0.0, -1.0, 0.0]),
        1 => Just([1.0, 0.0, 0.0]),
        1 => Just([0.0, -1.0, 1.0]),
        1 => Just([1.0, -1.0, -1.0]),
    ]
}

fn interior() -> impl Strategy<Value = Interior> {
    prop_oneof![Just(Interior::Open), Just(Interior::Closed), Just(Interior::Auto)]
}

fn encoding() -> impl Strategy<Value = Encoding> {
    prop_oneof![Just(Encoding::Dag8), Just(Encoding::Silhouette)]
}

fn check(scene: &Scene, direction: [f64; 3], interior: Interior, resolution: u32) -> Result<(), String> {
    [Encoding::Dag8, Encoding::Silhouette].into_iter().try_for_each(|encoding| {
        let options = BakeOptions { encoding: Some(encoding), ..options(interior, resolution, 1) };
        check_all(&bake_for_check(scene, &sun(direction), &options)).map_err(|e| format!("{}: {e}", encoding.name()))
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn agrees_with_the_oracle(meshes in meshes(), direction in direction(), interior in interior()) {
        let scene = scene(meshes, DAffine3::IDENTITY);
        check(&scene, direction, interior, 64).map_err(TestCaseError::fail)?;
    }

    #[test]
    fn agrees_far_from_the_origin(meshes in meshes(), direction in direction()) {
        let place = DAffine3::from_translation(DVec3::new(4.3e6, -2.1e5, 7.7e6)) * DAffine3::from_scale(DVec3::splat(900.0));
        check(&scene(meshes, place), direction, Interior::Auto, 64).map_err(TestCaseError::fail)?;
    }

    #[test]
    fn agrees_when_mirrored_and_squashed(meshes in meshes(), direction in direction()) {
        let place = DAffine3::from_scale(DVec3::new(-1.0, 3.0, 0.01));
        check(&scene(meshes, place), direction, Interior::Auto, 64).map_err(TestCaseError::fail)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    #[test]
    fn agrees_at_greater_resolutions(meshes in meshes(), direction in direction(), interior in interior()) {
        let scene = scene(meshes, DAffine3::IDENTITY);
        check(&scene, direction, interior, 512).map_err(TestCaseError::fail)?;
    }

    /// Great tiles are solved at once there: texels along all edges, and rows through everything. Enter depths bound every ray.
    #[test]
    fn silhouettes_agree_at_great_resolutions(
        meshes in meshes(), direction in direction(), interior in interior(), rows in prop::array::uniform4(0u32..16384)
    ) {
        let scene = scene(meshes, DAffine3::IDENTITY);
        let options = BakeOptions { encoding: Some(Encoding::Silhouette), ..options(interior, 16384, 1) };
        let options = BakeOptions { enter_depths: true, ..options };
        let checked = bake_for_check(&scene, &sun(direction), &options);
        let in_rows = || rows.into_iter().flat_map(|row| (0..16384).flat_map(move |i| [[i, row], [row, i]]));
        check_texels(&checked, in_rows).map_err(TestCaseError::fail)?;
        check_texels(&checked, || along_edges(&checked).into_iter()).map_err(TestCaseError::fail)?;
        let unbounded = with_oracle(&checked, 0, |oracle| {
            in_rows().chain(along_edges(&checked)).find(|[x, y]| {
                let enter = oracle.interval(*x, *y).enter;
                let [least, greatest] = checked.light().enter_bounds(0, [*x, *y]).unwrap();
                enter < least || enter > greatest
            })
        });
        prop_assert_eq!(unbounded, None, "a ray enters outside its bounds");
    }

    #[test]
    fn threads_do_not_change_the_bytes(meshes in meshes(), direction in direction(), encoding in encoding()) {
        let scene = scene(meshes, DAffine3::IDENTITY);
        let with = |threads| BakeOptions { encoding: Some(encoding), ..options(Interior::Auto, 1024, threads) };
        let bytes = |threads| bake_for_check(&scene, &sun(direction), &with(threads)).bytes;
        let one = bytes(1);
        prop_assert!(one == bytes(2) && one == bytes(3), "bytes differ between thread counts");
    }
}

/// Texels at a thousand places along each edge of a sun's casters, and their neighbours.
fn along_edges(checked: &Checked<'_>) -> Vec<[u32; 2]> {
    let steps = checked.resolution().texel_steps();
    let last = i64::from(checked.resolution().texels()) - 1;
    let mut texels = Vec::new();
    for t in &checked.faces[0].triangles {
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            for k in 0..1000 {
                let along = |c: [i32; 3]| (i64::from(c[i]) * (1000 - k) + i64::from(c[j]) * k) / (1000 * steps);
                for aside in -1..=1 {
                    texels.push([along(t.x) + aside, along(t.y)].map(|c| c.clamp(0, last) as u32));
                }
            }
        }
    }
    texels.sort_unstable();
    texels.dedup();
    texels
}

const SLANT: [f64; 3] = [0.37, -0.81, 0.45];

fn assert_agrees(meshes: Vec<Mesh>, direction: [f64; 3], interior: Interior) {
    let scene = scene(meshes, DAffine3::IDENTITY);
    for resolution in [64, 256] {
        check(&scene, direction, interior, resolution).unwrap();
    }
}

#[test]
fn one_triangle() {
    let triangle = (vec![[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [0.2, 0.3, 1.0]], vec![[0, 1, 2]]);
    assert_agrees(vec![triangle], SLANT, Interior::Auto);
}

#[test]
fn a_triangle_smaller_than_a_texel() {
    let speck = (vec![[0.5, 0.5, 0.5], [0.5001, 0.5, 0.5], [0.5, 0.5, 0.5001]], vec![[0, 1, 2]]);
    assert_agrees(vec![cuboid([0.0; 3], [1.0, 0.1, 1.0], 0.0), speck], SLANT, Interior::Auto);
}

#[test]
fn edge_on_walls() {
    let walls = vec![cuboid([0.0, 0.5, 0.0], [0.5, 0.5, 0.5], 0.3), cuboid([0.0, -0.1, 0.0], [2.0, 0.1, 2.0], 0.0)];
    assert_agrees(walls.clone(), [0.0, -1.0, 0.0], Interior::Auto);
    assert_agrees(walls, [1.0, 0.0, 0.0], Interior::Open);
}

#[test]
fn t_junctions_stay_closed() {
    // The top is split in two along x; the long sides keep their whole edges, closed by two zero-area seams.
    let (mut positions, mut triangles) = cuboid([0.0; 3], [1.0, 0.5, 1.0], 0.0);
    let (a, b) = (positions.len() as u32, positions.len() as u32 + 1);
    positions.extend([[0.0, 0.5, -1.0], [0.0, 0.5, 1.0]]);
    triangles.retain(|t| !t.iter().all(|i| [2, 6, 7, 3].contains(i)));
    triangles.extend([[2, 6, b], [2, b, a], [a, b, 7], [a, 7, 3]]);
    let mut scene = scene(vec![(positions, triangles)], DAffine3::IDENTITY);
    let open = bake_for_check(&scene, &sun(SLANT), &options(Interior::Auto, 256, 1));
    assert_eq!(open.file.stats().unwrap().triangles_closed, 0);
    check_all(&open).unwrap();
    scene.meshes[0].primitives[0].seams = vec![[2, a, 3], [6, 7, b]];
    let closed = bake_for_check(&scene, &sun(SLANT), &options(Interior::Auto, 256, 1));
    assert_eq!(closed.file.stats().unwrap().triangles_open, 0);
    check_all(&closed).unwrap();
}

#[test]
fn touching_solids_leave_no_slit() {
    let stack = (0..5).map(|i| cuboid([0.0, f64::from(i) * 0.2, 0.0], [0.5, 0.1, 0.5], 0.0)).collect();
    assert_agrees(stack, [0.0, -1.0, 0.0], Interior::Closed);
}

/// Where something hides part of a thin folded sheet, its underside is dropped from the lists of the tiles beside: planes of one fold,
/// carried on beyond it, must not end up below the sheet.
#[test]
fn thin_folded_sheets_under_specks() {
    let (folds, thickness) = (24u32, 0.032);
    let corner = |i: u32| {
        let (fold, rest) = (i / 4, i % 4);
        let x = 2.0 * fold as f32 / folds as f32 - 1.0;
        let height = if fold.is_multiple_of(2) { 0.0 } else { 0.12 };
        [x, height - if rest & 1 == 0 { 0.0 } else { thickness }, if rest & 2 == 0 { -1.0 } else { 1.0 }]
    };
    let quad = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
    let of_fold = |i: u32| {
        let (a, b) = (4 * i, 4 * i + 4);
        let sides =
            [[a, a + 2, b + 2, b], [a + 1, b + 1, b + 3, a + 3], [a, b, b + 1, a + 1], [a + 2, a + 3, b + 3, b + 2]];
        sides.into_iter().flat_map(quad)
    };
    let end = 4 * folds;
    let ends = [[0, 1, 3, 2], [end, end + 2, end + 3, end + 1]].into_iter().flat_map(quad);
    let sheet = ((0..end + 4).map(corner).collect(), (0..folds).flat_map(of_fold).chain(ends).collect());
    let specks = (0..1600).map(|i| {
        let at = |k: u32| f64::from((i * 7919 + k * 104_729) % 1000) / 500.0 - 1.0;
        cuboid([at(1), 0.3 + 0.02 * at(2), f64::from(i / 40) / 20.0 - 1.0], [0.002, 0.002, 0.002], at(4))
    });
    let scene = scene(specks.chain([sheet]).collect(), DAffine3::IDENTITY);
    let options = BakeOptions { encoding: Some(Encoding::Silhouette), ..options(Interior::Auto, 1024, 0) };
    for direction in [[0.0, -1.0, 0.0], [0.1, -1.0, 0.05], SLANT] {
        let checked = bake_for_check(&scene, &sun(direction), &options);
        assert_eq!(checked.file.stats().unwrap().triangles_open, 0);
        check_all(&checked).unwrap();
    }
}

#[test]
fn cavities_are_told_from_lone_inverted_parts() {
    let outer = cuboid([0.0; 3], [1.0; 3], 0.0);
    let inner = turned(cuboid([0.1, 0.0, 0.0], [0.5; 3], 0.4));
    let stats = |meshes: Vec<Mesh>| {
        let scene = scene(meshes, DAffine3::IDENTITY);
        bake_for_check(&scene, &sun(SLANT), &options(Interior::Auto, 64, 1)).file.stats().unwrap()
    };
    let room = stats(vec![outer.clone(), inner.clone()]);
    assert_eq!((room.triangles_closed, room.triangles_cavity, room.triangles_open), (24, 12, 0));
    let lone = stats(vec![inner.clone()]);
    assert_eq!((lone.triangles_closed, lone.triangles_cavity, lone.triangles_open), (0, 0, 12));
    assert_agrees(vec![outer, inner], SLANT, Interior::Auto);
}

#[test]
fn a_part_spread_over_nodes_is_closed() {
    let (positions, triangles) = cuboid([0.0; 3], [1.0; 3], 0.2);
    let halves = triangles.chunks(6).map(|t| (positions.clone(), t.to_vec())).collect();
    let scene = scene(halves, DAffine3::IDENTITY);
    let checked = bake_for_check(&scene, &sun(SLANT), &options(Interior::Auto, 64, 1));
    assert_eq!(checked.file.stats().unwrap().triangles_closed, 12);
    check_all(&checked).unwrap();
}
