//! Segment lookups against point lookups: every light kind, random segments and nasty ones.
//!
//! The oracle bisects a segment until both ends of a piece project to the same voxel. It knows of no planes and no nodes:
//! only that on one face each voxel coordinate goes one way.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod common;

use std::sync::LazyLock;

use antumbra::format::stat::BakeStats;
use antumbra::format::write::{Contents, write};
use antumbra::{
    DepthDistribution, FACE_BORDER, FacePoint, Interior, LightKind, LightRecord, LightShadow, Run, ShadowFile,
};
use antumbra_scene::{Scene, procedural};
use common::{bake_for_check, cuboid, options, scene, sun, turned};
use glam::{DAffine3, DMat3, DQuat, DVec3};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

fn city() -> Scene {
    procedural::build("city", &procedural::Options { seed: 5, scale: 0.15, ..Default::default() }).unwrap()
}

/// A room seen from inside, a plate edge-on to the light, thin walls, boxes that touch, a slope.
fn nasty() -> Scene {
    let meshes = vec![
        turned(cuboid([0.0, 2.0, 0.0], [9.0, 4.0, 9.0], 0.1)),
        cuboid([3.0, 1.0, 0.0], [1.0, 1.0, 1.0], 0.0),
        cuboid([5.0, 1.0, 0.0], [1.0, 1.0, 1.0], 0.0),
        cuboid([-3.0, 2.0, -2.0], [0.01, 2.0, 3.0], 0.4),
        cuboid([0.0, 3.5, 4.0], [4.0, 0.0, 2.0], 0.7),
        (vec![[-8.0, 0.0, -8.0], [8.0, 3.0, -8.0], [-8.0, 1.0, 8.0]], vec![[0, 1, 2]]),
    ];
    scene(meshes, DAffine3::IDENTITY)
}

fn baked(scene: &Scene, direction: [f64; 3], resolution: u32) -> ShadowFile {
    bake_for_check(scene, &sun(direction), &options(Interior::Auto, resolution, 0)).file
}

static CITY: LazyLock<ShadowFile> = LazyLock::new(|| baked(&city(), [0.5, -0.6, 0.3], 1024));
static NASTY: LazyLock<ShadowFile> = LazyLock::new(|| baked(&nasty(), [0.2, -1.0, 0.35], 64));

/// A light of each kind and shape that a file may hold, all over the nodes of one directional bake.
static LOCAL: LazyLock<ShadowFile> = LazyLock::new(|| {
    let mut records = Vec::new();
    for depth in [DepthDistribution::Logarithmic, DepthDistribution::Ndc] {
        // A narrow spot light, one wider than its grid, one without a cone (which sees what lies behind it).
        records.push(local(LightKind::Spot, 1, 0.7f64.cos(), tangent_scale(0.7f64.tan()), depth));
        records.push(local(LightKind::Spot, 1, 0.9f64.cos(), tangent_scale(0.5), depth));
        records.push(local(LightKind::Spot, 1, -1.0, tangent_scale(1.0), depth));
        for cosine in [0.5, 1e-9, 0.0, -0.4, 1.0] {
            records.push(local(LightKind::Spot, 6, cosine, tangent_scale(1.0), depth));
        }
        // A point light, and one whose faces are greater than their grids.
        records.push(local(LightKind::Point, 6, 0.0, tangent_scale(1.0), depth));
        records.push(local(LightKind::Point, 6, 0.0, tangent_scale(0.6), depth));
    }
    let file = ShadowFile::from_bytes(&write(&Contents::new(&records, "sun", NASTY.pool(), BakeStats::default())));
    file.unwrap()
});

/// Texels per unit of tangent of a grid that reaches that tangent and a border.
fn tangent_scale(tangent: f64) -> f64 {
    (f64::from(NASTY.lights().next().unwrap().record().resolution() / 2) - f64::from(FACE_BORDER)) / tangent
}

fn local(
    kind: LightKind,
    faces: u32,
    cone_cosine: f64,
    texels_per_tangent: f64,
    depth: DepthDistribution,
) -> LightRecord {
    let sun = NASTY.lights().next().unwrap().record();
    let axes = DMat3::from_quat(DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -1.1, 2.0));
    let mut roots = [0; 6];
    roots[..faces as usize].fill(sun.roots[0]);
    if kind == LightKind::Point {
        // Homogeneous faces beside the others.
        (roots[1], roots[2]) = (0, 1);
    }
    LightRecord {
        kind: kind as u32,
        roots,
        slice_size_m: 0.0,
        near_m: NEAR_M,
        far_m: FAR_M,
        cone_cosine,
        origin_world: ORIGIN.to_array(),
        linear: axes.to_cols_array_2d(),
        voxel_of_origin: [0.0; 3],
        direction_world: if kind == LightKind::Spot { axes.z_axis.to_array() } else { [0.0; 3] },
        faces,
        depth: depth as u32,
        texels_per_tangent,
        ..*sun
    }
}

const NEAR_M: f64 = 0.25;
const FAR_M: f64 = 30.0;
const ORIGIN: DVec3 = DVec3::new(1.5, 2.0, -0.75);

/// What a point lookup depends on: outside the cone, face and voxel; coordinates outside the grid are alike.
type Place = (bool, usize, [i64; 3]);

fn place(light: LightShadow<'_>, point: DVec3) -> Place {
    let n = i64::from(light.record().resolution());
    let at = light.project(point);
    let mut voxel = at.voxel.to_array().map(|c| (c.floor() as i64).clamp(-1, n));
    voxel[2] = voxel[2].min(n - 1);
    if voxel[2] < 0 {
        voxel = [-1; 3];
    }
    (light.is_outside_cone(point), at.face, voxel)
}

/// Pieces of the segment that are in one voxel each, and whether they are lit.
fn pieces(light: LightShadow<'_>, from: DVec3, to: DVec3) -> Vec<Run> {
    let point = |t: f64| from + (to - from) * t;
    // The outside of a cone of more than 90 degrees is convex: a segment's ends may both lie inside and its middle not.
    // Many starts, for a narrow cone is soon passed.
    let starts = if light.kind() == LightKind::Spot { 2048 } else { 64 };
    let mut pieces = Vec::new();
    for i in 0..starts {
        let [t0, t1] = [i, i + 1].map(|i| f64::from(i) / f64::from(starts));
        bisect(light, &point, [t0, t1], [t0, t1].map(|t| place(light, point(t))), &mut pieces);
    }
    pieces
}

fn bisect(
    light: LightShadow<'_>,
    point: &dyn Fn(f64) -> DVec3,
    [t0, t1]: [f64; 2],
    places: [Place; 2],
    pieces: &mut Vec<Run>,
) {
    let middle = 0.5 * (t0 + t1);
    if places[0] == places[1] || t1 - t0 < 1e-13 {
        let lit = light.visibility(point(middle)) == 1.0;
        match pieces.last_mut() {
            Some(last) if last.lit == lit => last.to = t1,
            _ => pieces.push(Run { from: t0, to: t1, lit }),
        }
        return;
    }
    let place = place(light, point(middle));
    bisect(light, point, [t0, middle], [places[0], place], pieces);
    bisect(light, point, [middle, t1], [place, places[1]], pieces);
}

/// Runs cover 0 to 1 and differ from their neighbours.
fn runs(light: LightShadow<'_>, from: DVec3, to: DVec3) -> Vec<Run> {
    let mut segment = light.segment(from, to);
    let runs: Vec<Run> = segment.by_ref().collect();
    assert_eq!(segment.next(), None);
    let most = 3 * 9 * u64::from(light.record().resolution());
    assert!(segment.steps() <= most, "{} steps", segment.steps());
    assert_eq!((runs[0].from, runs.last().unwrap().to), (0.0, 1.0));
    assert!(runs.iter().all(|run| run.from < run.to));
    assert!(runs.is_sorted_by(|a, b| a.to == b.from && a.lit != b.lit), "{runs:?}");
    runs
}

fn lit_at(runs: &[Run], t: f64) -> bool {
    runs.iter().find(|run| t <= run.to).unwrap().lit
}

/// Parameters nearer to a boundary may be judged either way.
const CLOSE: f64 = 1e-9;

/// Holds a segment against the oracle: every piece that is not tiny, a whisker inside its ends, and the lit share.
fn check(light: LightShadow<'_>, from: DVec3, to: DVec3) -> Result<(), String> {
    let runs = runs(light, from, to);
    let pieces = pieces(light, from, to);
    for piece in pieces.iter().filter(|piece| piece.to - piece.from > 2.0 * CLOSE) {
        for t in [piece.from + CLOSE, 0.5 * (piece.from + piece.to), piece.to - CLOSE] {
            if lit_at(&runs, t) != piece.lit {
                return Err(format!("at {t}: the segment says lit {}, the piece is {piece:?}", !piece.lit));
            }
        }
    }
    let [share, lit] = [light.lit_share(from, to), lit_share(&pieces)];
    let length = light.lit_length_m(from, to);
    if (share - lit).abs() > CLOSE || (length - share * from.distance(to)).abs() > 1e-9 * from.distance(to) {
        return Err(format!("the lit share is {share}, the pieces' {lit}, the lit length {length}"));
    }
    Ok(())
}

fn lit_share(runs: &[Run]) -> f64 {
    runs.iter().filter(|run| run.lit).map(|run| run.to - run.from).sum()
}

/// Holds runs against point lookups at evenly spaced parameters, for segments that run along boundaries, where a point's last
/// digit decides: any answer a hair's breadth beside the point will do, on any face that is so near.
fn check_loosely(light: LightShadow<'_>, from: DVec3, to: DVec3) -> Result<(), String> {
    let runs = runs(light, from, to);
    let samples = 3000;
    for i in 0..=samples {
        let t = f64::from(i) / f64::from(samples);
        let point = from + (to - from) * t;
        let reach = 1e-9 * (1.0 + point.abs().max_element() + from.distance(to));
        let lit = lit_at(&runs, t);
        let agrees = |answer: f32| (answer == 1.0) == lit;
        let near = |point: DVec3| {
            let at = light.project(point);
            // Farther than the reach moves a point close to the light: on a cube's edge a face's border counts, too.
            let beside = |offset| FacePoint { voxel: at.voxel + 1e-5 * offset, ..at };
            agrees(light.visibility(point))
                || !light.is_outside_cone(point) && offsets().any(|o| agrees(light.voxel_visibility(beside(o))))
        };
        // Along the segment too: at a narrow cone's apex no other way leads into it.
        let along = (to - from).normalize_or_zero();
        let about = offsets().chain([along, -along]);
        if !about.into_iter().any(|offset| near(point + offset * reach)) {
            return Err(format!("at {t}: the segment says lit {lit}, no point about it does; runs {runs:?}"));
        }
    }
    Ok(())
}

/// No offset, then one to all sides, edges and corners.
fn offsets() -> impl Iterator<Item = DVec3> {
    (0..27).map(|i| (i + 13) % 27).map(|i| DVec3::new((i % 3).into(), (i / 3 % 3).into(), (i / 9).into()) - 1.0)
}

/// World point of voxel coordinates of a directional light.
fn world(light: LightShadow<'_>, voxel: DVec3) -> DVec3 {
    let record = light.record();
    let rows = DMat3::from_cols_array_2d(&record.linear).transpose();
    DVec3::from_array(record.origin_world) + rows.inverse() * (voxel - DVec3::from_array(record.voxel_of_origin))
}

/// The same random cases in every run.
fn same_cases() -> ProptestConfig {
    ProptestConfig { rng_seed: RngSeed::Fixed(2014), failure_persistence: None, ..ProptestConfig::default() }
}

fn points(reach: f64) -> impl Strategy<Value = [DVec3; 2]> {
    prop::array::uniform6(-reach..reach).prop_map(|c| [DVec3::new(c[0], c[1], c[2]), DVec3::new(c[3], c[4], c[5])])
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 1500, ..same_cases() })]

    #[test]
    fn through_a_city(ends in points(1.3), far in any::<bool>()) {
        let light = CITY.lights().next().unwrap();
        let reach = 0.5 * 1024.0 * light.record().texel_size_m * if far { 1.0 } else { 0.05 };
        let [from, to] = ends.map(|p| light.origin_world() + p * reach);
        prop_assert_eq!(check(light, from, to), Ok(()));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 10_000, ..same_cases() })]

    #[test]
    fn through_nasty_scenes(ends in points(20.0), exponent in -3i32..5) {
        let light = NASTY.lights().next().unwrap();
        let [from, to] = [ends[0], ends[0] + (ends[1] - ends[0]) * 10f64.powi(exponent.min(1))];
        prop_assert_eq!(check(light, from, to), Ok(()));
    }

    #[test]
    fn past_local_lights(ends in points(1.0), which in 0usize..20, reach in -2i32..6) {
        let light = LOCAL.lights().nth(which).unwrap();
        let reach = FAR_M * 2f64.powi(reach - 3);
        let [from, to] = ends.map(|p| ORIGIN + p * reach);
        prop_assert_eq!(check(light, from, to), Ok(()), "light {}", which);
    }

    #[test]
    fn along_voxel_boundaries(c in prop::array::uniform6(-4i32..69), along in 0usize..3) {
        let light = NASTY.lights().next().unwrap();
        let from = DVec3::new(c[0].into(), c[1].into(), c[2].into());
        let mut to = from;
        to[along] = c[3].into();
        prop_assert_eq!(check_loosely(light, world(light, from), world(light, to)), Ok(()));
        // Diagonally: through corners of voxels.
        let to = from + DVec3::new(1.0, f64::from(c[4].signum()), f64::from(c[5].signum())) * f64::from(c[3]);
        prop_assert_eq!(check_loosely(light, world(light, from), world(light, to)), Ok(()));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, ..same_cases() })]

    /// In the axes of a local light whole numbers are edges of its cube and rays through its origin.
    #[test]
    fn along_local_boundaries(c in prop::array::uniform6(-2i32..3), which in 0usize..20, scale in -2i32..4) {
        let light = LOCAL.lights().nth(which).unwrap();
        let axes = DMat3::from_cols_array_2d(&light.record().linear);
        let place = |i: usize| DVec3::new(c[i].into(), c[i + 1].into(), c[i + 2].into()) * 2f64.powi(scale);
        let [from, to] = [0, 3].map(|i| ORIGIN + axes * place(i));
        prop_assert_eq!(check_loosely(light, from, to), Ok(()), "light {}", which);
    }

    #[test]
    fn nothing_panics(c in prop::array::uniform6(0usize..12), which in 0usize..20) {
        let values = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, f64::MIN, 1e300, -1e160, 1e-320, 0.0, -0.0, 7.0, -1e20];
        let from = DVec3::new(values[c[0]], values[c[1]], values[c[2]]);
        let to = DVec3::new(values[c[3]], values[c[4]], values[c[5]]);
        for light in [NASTY.lights().next().unwrap(), LOCAL.lights().nth(which).unwrap()] {
            let runs = runs(light, from, to);
            if !(from.is_finite() && to.is_finite()) || from == to {
                let lit = light.visibility(from) == 1.0;
                prop_assert_eq!(runs, [Run { from: 0.0, to: 1.0, lit }]);
            }
        }
    }
}

/// Segments through the light itself, along its axes and across them, with samples at its very place.
#[test]
fn through_the_light_itself() {
    for light in LOCAL.lights() {
        let axes = DMat3::from_cols_array_2d(&light.record().linear);
        for axis in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(1.0, 1.0, 0.0), DVec3::new(-1.0, 1.0, 1.0), DVec3::ONE] {
            for (before, behind) in [(1.0, -2.0), (-2.0, 1.0), (4.0, -4.0), (-8.0, 4.0), (0.0, 3.0), (-3.0, 0.0)] {
                let [from, to] = [before, behind].map(|at| ORIGIN + axes * axis * at);
                check_loosely(light, from, to).unwrap();
            }
        }
    }
}

#[test]
fn segments_of_no_length_are_as_their_point() {
    for light in LOCAL.lights().chain(NASTY.lights()) {
        for i in 0..2000 {
            let p = f64::from(i) * DVec3::new(0.819_172_5, 0.671_043_6, 0.549_700_5);
            let p = ORIGIN + (p.fract() - 0.5) * 20.0;
            let lit = light.visibility(p) == 1.0;
            assert_eq!(runs(light, p, p), [Run { from: 0.0, to: 1.0, lit }]);
            assert_eq!(light.lit_share(p, p), f64::from(u8::from(lit)));
            assert_eq!(light.lit_length_m(p, p), 0.0);
        }
    }
    let light = NASTY.lights().next().unwrap();
    assert!(light.lit_length_m(DVec3::NAN, DVec3::ZERO).is_nan());
    assert_eq!(light.lit_share(DVec3::NAN, DVec3::ZERO), 1.0);
}

#[test]
fn along_the_light_across_it_and_through_the_whole_volume() {
    let light = CITY.lights().next().unwrap();
    let n = 1024.0;
    for i in 1..=60 {
        let [a, b] = [0.819_172_5, 0.671_043_6].map(|step| (f64::from(i) * step).fract() * n);
        let ways = [
            // A texel's ray, whole and backwards; past the volume's end, and from there; one inside.
            [DVec3::new(a, b, -50.0), DVec3::new(a, b, n + 50.0)],
            [DVec3::new(a, b, n), DVec3::new(a, b, 0.0)],
            [DVec3::new(a, b, n + 9.0), DVec3::new(b, a, n + 700.0)],
            [DVec3::new(a, b, 0.3 * n), DVec3::new(a, b, 0.9 * n)],
            // Across: along an axis of the grid, and not.
            [DVec3::new(-9.0, a, b), DVec3::new(n + 9.0, a, b)],
            [DVec3::new(a, n + 9.0, b), DVec3::new(a, -9.0, b)],
            [DVec3::new(a, -9.0, b), DVec3::new(b, n + 9.0, b)],
            // Beside the volume, and before it.
            [DVec3::new(-1.0, a, b), DVec3::new(-1.0, b, a)],
            [DVec3::new(a, b, -1.0), DVec3::new(b, a, -0.5)],
        ];
        for way in ways {
            let [from, to] = way.map(|voxel| world(light, voxel));
            assert_eq!(check(light, from, to), Ok(()), "{way:?}");
        }
    }
}

#[test]
fn along_the_axes_of_the_world() {
    let light = CITY.lights().next().unwrap();
    for i in 0..600 {
        let p = f64::from(i) * DVec3::new(0.819_172_5, 0.671_043_6, 0.549_700_5);
        let from = light.origin_world() + (p.fract() - 0.5) * 100.0;
        for step in [DVec3::X, DVec3::NEG_Y, DVec3::Z] {
            assert_eq!(check(light, from, from + step * 80.0), Ok(()), "from {from} along {step}");
        }
    }
}

#[test]
fn the_lit_length_is_the_sum_over_samples() {
    let light = CITY.lights().next().unwrap();
    let samples = 20_000;
    let mut mixed = 0;
    for i in 0..200 {
        let [from, to] = [i, i + 777].map(|i| {
            let p = f64::from(i) * DVec3::new(0.819_172_5, 0.671_043_6, 0.549_700_5);
            light.origin_world() + (p.fract() - 0.5) * DVec3::new(150.0, 20.0, 150.0)
        });
        let lit = (0..samples).filter(|i| {
            let t = (f64::from(*i) + 0.5) / f64::from(samples);
            light.visibility(from + (to - from) * t) == 1.0
        });
        let expected = lit.count() as f64 / f64::from(samples) * from.distance(to);
        // A run's two ends each miss less than a sample.
        let runs = runs(light, from, to).len();
        mixed += usize::from(runs > 3);
        let error = (light.lit_length_m(from, to) - expected).abs();
        assert!(error <= runs as f64 * from.distance(to) / f64::from(samples), "{error} m with {runs} runs");
    }
    assert!(mixed > 50, "only {mixed} of 200 segments meet shadows");
}
