//! The ablations: each alternative holds the same shadows as what it is compared with.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod common;

use antumbra::{Interior, ShadowFile};
use antumbra_bake::ablation::cubic::{LeafPool, Leaves, Reads};
use antumbra_bake::ablation::undefined::{Kampe2015, Sintorn2014};
use antumbra_bake::ablation::world::{WorldGrid, WorldVolume};
use antumbra_bake::ablation::{Graph, Intervals, octree};
use antumbra_bake::light_space::Resolution;
use antumbra_bake::{Baked, Silent, bake};
use antumbra_scene::{Light, Scene};
use common::{cuboid, options, scene, sun};
use glam::DAffine3;

/// A few solids on a slab, one of them in another.
fn solids() -> Scene {
    let boxes = vec![
        cuboid([0.0, -0.5, 0.0], [8.0, 0.5, 8.0], 0.0),
        cuboid([1.0, 1.5, -2.0], [1.0, 1.5, 0.7], 0.4),
        cuboid([-3.0, 1.0, 3.0], [1.3, 1.0, 0.3], 1.1),
        cuboid([-3.0, 2.0, 3.0], [0.5, 1.0, 0.5], 0.2),
    ];
    scene(boxes, DAffine3::IDENTITY)
}

fn light() -> Light {
    sun([0.5, -0.9, 0.3])
}

fn baked(scene: &Scene, interior: Interior, n: u32) -> (Baked, ShadowFile) {
    let baked = bake(scene, &[light()], &options(interior, n, 1), &Silent).unwrap();
    let file = ShadowFile::from_bytes(&baked.bytes).unwrap();
    (baked, file)
}

fn intervals(scene: &Scene, interior: Interior, n: u32) -> Intervals {
    Intervals::of_light(scene, &light(), Resolution::new(n).unwrap(), interior).unwrap().remove(0)
}

fn voxels(n: u32) -> impl Iterator<Item = [u32; 3]> {
    (0..n * n * n).map(move |i| [i % n, i / n % n, i / (n * n)])
}

fn both_rules(intervals: &Intervals) -> [Graph; 2] {
    let old = octree::build(&Sintorn2014 { intervals }, intervals.log2()).unwrap();
    let new = octree::build(&Kampe2015::new(intervals), intervals.log2()).unwrap();
    [old, new]
}

#[test]
fn both_rules_keep_to_the_intervals() {
    let scene = solids();
    for interior in [Interior::Open, Interior::Auto] {
        let intervals = intervals(&scene, interior, 64);
        let has_freedom = voxels(64).any(|[x, y, z]| (intervals.enter(x, y)..intervals.exit(x, y)).contains(&z));
        assert_eq!(has_freedom, interior == Interior::Auto);
        for graph in both_rules(&intervals) {
            assert!(intervals.allow(&graph));
            for [x, y, z] in voxels(64) {
                let lit = graph.is_lit([x, y, z]);
                let may = if lit { z < intervals.exit(x, y) } else { z >= intervals.enter(x, y) };
                assert!(may, "({x}, {y}, {z}) is lit: {lit}");
            }
        }
    }
}

#[test]
fn a_wrong_graph_is_noticed() {
    let scene = solids();
    let [fine, open] = [intervals(&scene, Interior::Auto, 64), intervals(&scene, Interior::Open, 64)];
    for graph in both_rules(&fine) {
        assert!(fine.allow(&graph) && !open.allow(&graph));
    }
}

#[test]
fn where_nothing_is_free_all_builders_agree() {
    let scene = solids();
    let (baked, file) = baked(&scene, Interior::Open, 128);
    for graph in both_rules(&intervals(&scene, Interior::Open, 128)) {
        assert_eq!((graph.bytes(), graph.nodes()), (baked.lights[0].bytes, baked.lights[0].nodes));
        let light = file.light("sun").unwrap();
        assert!(voxels(128).step_by(7).all(|voxel| graph.is_lit(voxel) == light.is_lit(0, voxel)));
    }
}

#[test]
fn the_new_rule_takes_fewer_masks() {
    let [old, new] = both_rules(&intervals(&solids(), Interior::Auto, 256));
    assert!(new.bytes() < old.bytes(), "{} and {}", new.bytes(), old.bytes());
}

#[test]
fn world_voxels_are_what_a_lookup_at_their_middle_says() {
    let scene = solids();
    let grid = WorldGrid::about(scene.bounds(|_| true), 6);
    let points: Vec<_> = voxels(64).map(|voxel| grid.center(voxel)).collect();
    let (_, file) = baked(&scene, Interior::Open, 128);
    let light = file.light("sun").unwrap();
    let mut expected = vec![0.0; points.len()];
    light.visibility_many(&points, &mut expected);
    let intervals = intervals(&scene, Interior::Open, 128);
    let graph = octree::build(&WorldVolume { grid, light, intervals: &intervals }, grid.log2).unwrap();
    for (voxel, expected) in voxels(64).zip(expected) {
        assert_eq!(f32::from(graph.is_lit(voxel)), expected, "{voxel:?}");
    }
}

#[test]
fn the_world_may_choose_where_solids_are_free() {
    let scene = solids();
    let grid = WorldGrid::about(scene.bounds(|_| true), 6);
    let (_, file) = baked(&scene, Interior::Auto, 128);
    let light = file.light("sun").unwrap();
    let intervals = intervals(&scene, Interior::Auto, 128);
    let graph = octree::build(&WorldVolume { grid, light, intervals: &intervals }, grid.log2).unwrap();
    for voxel in voxels(64) {
        let at = light.project(grid.center(voxel)).voxel;
        if at.min_element() < 0.0 || at.truncate().max_element() >= 128.0 {
            assert!(graph.is_lit(voxel));
            continue;
        }
        let (x, y, z) = (at.x as u32, at.y as u32, (at.z as u32).min(127));
        let may = if graph.is_lit(voxel) { z < intervals.exit(x, y) } else { z >= intervals.enter(x, y) };
        assert!(may, "{voxel:?}");
    }
}

#[test]
fn cubic_leaves_hold_the_same_voxels() {
    let scene = solids();
    for n in [64, 128] {
        let (_, file) = baked(&scene, Interior::Auto, n);
        let light = file.light("sun").unwrap();
        let (root, log2) = (light.record().roots[0], n.ilog2());
        let flat = LeafPool::flat(file.pool()).unwrap();
        let cubic = LeafPool::cubic(file.pool()).unwrap();
        assert_eq!(flat.last_node(), root);
        assert_eq!(flat.leaf_count(), file.node_counts().masks);
        for voxel in voxels(n).step_by(3) {
            let lit = light.is_lit(0, voxel);
            assert_eq!(flat.is_lit(root, log2, voxel), lit, "{voxel:?}");
            assert_eq!(cubic.is_lit(cubic.last_node(), log2, voxel), lit, "{voxel:?}");
        }
    }
}

#[test]
fn windows_read_no_more_leaves_than_they_touch() {
    let (_, file) = baked(&solids(), Interior::Open, 64);
    let pools = [LeafPool::flat(file.pool()).unwrap(), LeafPool::cubic(file.pool()).unwrap()];
    let kinds = [Leaves::Flat, Leaves::Cubic];
    let mut sum = [Reads::default(); 2];
    for z in 0..64 {
        for corner in (0..48).step_by(5) {
            let window = [[corner, 20], [corner + 8, 28]];
            for (i, pool) in pools.iter().enumerate() {
                assert_eq!(pool.leaves(), kinds[i]);
                let reads = pool.reads(pool.last_node(), 6, window, z);
                assert!(reads.leaves <= if kinds[i] == Leaves::Flat { 4 } else { 9 });
                sum[i].leaves += reads.leaves;
                sum[i].sectors += reads.sectors;
            }
        }
    }
    assert!(0 < sum[0].leaves && sum[0].leaves < sum[1].leaves, "{sum:?}");
}
