//! Means, coarse levels and enter depths against all the voxels and rays that they stand for.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod common;

use std::sync::LazyLock;

use antumbra::format::dag8;
use antumbra::{FacePoint, Filter, Interior, Kernel, LightShadow, Prefilter};
use antumbra_bake::BakeOptions;
use antumbra_scene::{Light, Scene, procedural};
use common::{Checked, bake_for_check, cuboid, lamp, options, scene, spot, sun, turned, with_oracle};
use glam::{DAffine3, DVec3};
use proptest::prelude::*;
use rayon::prelude::*;

static CITY: LazyLock<Scene> = LazyLock::new(|| {
    procedural::build("city", &procedural::Options { seed: 5, scale: 0.15, ..Default::default() }).unwrap()
});

/// A room with furniture, whose walls are one closed part with a cavity.
static ROOM: LazyLock<Scene> = LazyLock::new(|| {
    let meshes = vec![
        cuboid([0.0; 3], [2.2, 1.4, 2.2], 0.0),
        turned(cuboid([0.0; 3], [2.0, 1.2, 2.0], 0.0)),
        cuboid([0.7, -0.6, 0.4], [0.3, 0.6, 0.2], 0.5),
        cuboid([-0.9, -0.2, -0.7], [0.15, 0.9, 0.15], 0.2),
        (vec![[-1.0, 0.3, 0.5], [0.4, 0.5, 0.9], [-0.3, 0.1, -0.6]], vec![[0, 1, 2]]),
    ];
    scene(meshes, DAffine3::IDENTITY)
});

fn with_everything(resolution: u32, interior: Interior) -> BakeOptions {
    BakeOptions { levels: true, enter_depths: true, ..options(interior, resolution, 0) }
}

/// One light of each kind.
static BAKES: LazyLock<Vec<Checked<'static>>> = LazyLock::new(|| {
    let room_lamp = lamp([0.1, 0.4, -0.2], 6.0);
    let bake =
        |scene: &'static Scene, light: &Light| bake_for_check(scene, light, &with_everything(512, Interior::Auto));
    vec![
        bake(&CITY, &sun([0.5, -0.6, 0.3])),
        bake(&ROOM, &room_lamp),
        bake(&ROOM, &spot([0.1, 1.0, -0.2], [0.2, -1.0, 0.1], 50.0, 6.0)),
    ]
});

/// First shadowed slice of every ray, by light and face.
static ENTERS: LazyLock<Vec<Vec<Vec<u32>>>> = LazyLock::new(|| {
    let of_face = |checked: &Checked<'_>, face: usize| {
        with_oracle(checked, face, |oracle| {
            (0..512 * 512u32).into_par_iter().map(|i| oracle.interval(i % 512, i / 512).enter).collect()
        })
    };
    BAKES.iter().map(|checked| (0..checked.faces.len()).map(|face| of_face(checked, face)).collect()).collect()
});

/// Lit share of a cube of voxels, voxel by voxel.
fn lit_share(light: LightShadow<'_>, face: usize, corner: [u32; 3], side: u32) -> f64 {
    let voxels = (0..side.pow(3)).map(|i| [i % side, i / side % side, i / (side * side)]);
    let lit = voxels.filter(|v| light.is_lit(face, [corner[0] + v[0], corner[1] + v[1], corner[2] + v[2]])).count();
    lit as f64 / f64::from(side.pow(3))
}

/// A light, a face, a voxel near some surface, and a level.
fn place() -> impl Strategy<Value = (usize, usize, [u32; 3], u32)> {
    (0usize..3, 0usize..6, prop::array::uniform3(0u32..512), 0u32..6)
}

/// Moves a voxel along the light to where its texel's ray turns dark, so that nodes there are mixed.
fn at_transition(light: LightShadow<'_>, face: usize, [x, y, z]: [u32; 3]) -> [u32; 3] {
    let lit = (0..512).take_while(|&z| light.is_lit(face, [x, y, z])).count() as u32;
    [x, y, if lit == 512 { z } else { lit.saturating_sub(z % 4).min(511) }]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3000, ..ProptestConfig::default() })]

    #[test]
    fn means_are_those_of_all_their_voxels((which, face, voxel, level) in place()) {
        let light = BAKES[which].light();
        let face = face % light.faces();
        let voxel = at_transition(light, face, voxel);
        let side = 1 << level;
        let share = lit_share(light, face, voxel.map(|c| c & !(side - 1)), side);
        let mean = f64::from(light.voxel_mean(face, voxel, level));
        prop_assert!((mean - share).abs() <= 1.0 / 131_070.0 + 1e-7, "{mean} instead of {share}");
    }

    #[test]
    fn coarse_voxels_are_lit_where_half_of_theirs_are((which, face, voxel, level) in place()) {
        let light = BAKES[which].light();
        let (face, level) = (face % light.faces(), (level % 3) + 1);
        let voxel = at_transition(light, face, voxel).map(|c| c >> level);
        let share = lit_share(light, face, voxel.map(|c| c << level), 1 << level);
        prop_assert_eq!(light.is_lit_on_level(level, face, voxel), share >= 0.5, "share {}", share);
    }

    /// Enter depths bound those of every ray, and blockers follow from them.
    #[test]
    fn enter_depths_bound_every_ray((which, face, [x, y, z], _) in place()) {
        let light = BAKES[which].light();
        let face = face % light.faces();
        let enter = ENTERS[which][face][(512 * y + x) as usize];
        let [least, greatest] = light.enter_bounds(face, [x, y]).unwrap();
        prop_assert!(least <= enter && (greatest >= enter || greatest == u32::MAX), "{enter} not in {least}..={greatest}");
        // A point behind that ray's first surface has a blocker, and the surface is within its bounds.
        if enter < 511 && z > enter {
            let voxel = DVec3::new(f64::from(x) + 0.5, f64::from(y) + 0.5, f64::from(z) + 0.5);
            if let Some(point) = light.unproject(FacePoint { face, voxel }) {
                let there = light.project(point);
                prop_assert!((there.voxel - voxel).abs().max_element() < 1e-6 || there.face != face);
                if there.face == face {
                    let blocker = light.blocker(point, 0.0).unwrap();
                    prop_assert!(blocker.least_m >= 0.0 && blocker.greatest_m > blocker.least_m);
                }
            }
        }
    }
}

/// On coarse levels a filter's answer differs from the mean of all the point lookups that it stands for by no more than
/// its voxels do on average.
#[test]
fn filters_on_levels_are_within_their_bound() {
    let light = BAKES[0].light();
    let mut worst = 0f64;
    for i in 0..400u32 {
        let noise = |k: u32| (i * 4 + k).wrapping_mul(2_654_435_761) >> 8;
        let (level, taps) = (1 + i % 3, [1, 3, 5][i as usize % 3]);
        let side = 1 << level;
        let [x, y, _] = [noise(0), noise(1), 0].map(|c| 64 + c % 384);
        let [x, y, z] = at_transition(light, 0, [x, y, noise(2) % 512]);
        let voxel = DVec3::new(f64::from(x) + 0.5, f64::from(y) + 0.5, f64::from(z) + 0.5);
        let point = light.unproject(FacePoint { face: 0, voxel }).unwrap();
        let answer = light.level_filtered(point, None, Filter::new(taps, Kernel::Box).unwrap(), f64::from(level));
        let radius = taps as i32 / 2;
        let (mut mean, mut bound) = (0.0, 0.0);
        for dy in -radius..=radius {
            for dx in -radius..=radius {
                let coarse = [(x >> level) as i32 + dx, (y >> level) as i32 + dy].map(|c| c as u32);
                let share = lit_share(light, 0, [coarse[0] << level, coarse[1] << level, z >> level << level], side);
                mean += share;
                bound += share.min(1.0 - share);
            }
        }
        let all = f64::from(taps * taps);
        let error = (f64::from(answer) - mean / all).abs();
        assert!(error <= bound / all + 1e-6, "{error} of {}", bound / all);
        worst = worst.max(error);
    }
    assert!(worst > 0.0, "no mixed voxel was met");
}

#[test]
fn narrow_footprints_are_looked_up_at_full_depth() {
    let light = BAKES[0].light();
    let filter = Filter::new_tent(5).unwrap();
    for i in 0..2000 {
        let p = (f64::from(i) * DVec3::new(0.819_172_5, 0.671_043_6, 0.549_700_5)).fract() - DVec3::new(0.5, 0.2, 0.5);
        let (point, texel) = (p * DVec3::new(120.0, 60.0, 120.0), light.frame(p).texel_m);
        for normal in [None, Some(DVec3::Y)] {
            let levels = light.prefiltered(point, normal, 2.9 * texel, Prefilter::Levels(filter));
            assert_eq!(levels, light.filtered(point, normal, filter));
            let mean = light.prefiltered(point, normal, 0.9 * texel, Prefilter::Mean);
            assert_eq!(mean, light.filtered(point, normal, Filter::new_box(1).unwrap()));
        }
        for strange in [f64::NAN, f64::INFINITY, -1.0, 1e300] {
            let value = light.prefiltered(point, None, strange, Prefilter::Mean);
            assert!((0.0..=1.0).contains(&value), "{strange}: {value}");
        }
    }
}

/// Filters and levels go on across the edges of a cube: answers hardly differ on either side.
#[test]
fn nothing_breaks_at_a_cubes_edges() {
    let light = BAKES[1].light();
    let filter = Filter::new_tent(9).unwrap();
    let (mut compared, mut apart) = (0, [0.0f64; 2]);
    for i in 0..4000u32 {
        let unit = |k: u32| f64::from((i * 3 + k).wrapping_mul(2_654_435_761)) / f64::from(u32::MAX);
        // Rays along the planes between two faces, a hair to either side.
        let (along, r) = (2.0 * unit(0) - 1.0, 0.1 + 0.6 * unit(1));
        let (a, b) = ([1.0, -1.0][i as usize & 1], [1.0, -1.0][(i >> 1) as usize & 1]);
        let corner = |tilt: f64| match (i >> 2) % 3 {
            0 => DVec3::new(a * (1.0 + tilt), b, along),
            1 => DVec3::new(a * (1.0 + tilt), along, b),
            _ => DVec3::new(along, a * (1.0 + tilt), b),
        };
        let [p, q] = [1e-9, -1e-9].map(|tilt| light.origin_world() + corner(tilt) * r);
        if light.project(p).face == light.project(q).face {
            continue;
        }
        compared += 1;
        apart[0] += f64::from((light.filtered(p, None, filter) - light.filtered(q, None, filter)).abs());
        let on_level = |point| light.level_filtered(point, None, filter, 2.0);
        apart[1] += f64::from((on_level(p) - on_level(q)).abs());
    }
    assert!(compared > 2000, "{compared}");
    // Either face's taps lie across its own axis, so that those near surfaces differ; but no tap is lost, or half the
    // window would be lit wherever the edge lies in shadow.
    let apart = apart.map(|sum| sum / f64::from(compared));
    assert!(apart[0] < 0.003 && apart[1] < 0.0065, "{apart:?}");
}

#[test]
fn means_cost_no_bytes_and_fit_every_level() {
    for checked in BAKES.iter() {
        let light = checked.light();
        for face in 0..light.faces() {
            let whole = f64::from(light.voxel_mean(face, [0; 3], 9));
            let root = light.record().roots[face];
            let expected = match root {
                dag8::LIT => 1.0,
                dag8::SHADOWED => 0.0,
                node => f64::from(dag8::mean(checked.file.pool()[node as usize])),
            };
            assert_eq!(whole, expected);
        }
    }
}
