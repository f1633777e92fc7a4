//! Voxel culling against slow exact oracles.

use antumbra_scene::{Bounds, Mesh, Node, Primitive, Scene};
use glam::{DAffine3, DVec3, IVec3, Vec3};
use proptest::prelude::*;

use super::bins::touches;
use super::*;
use crate::{Ray, Tracer};

const SIDE: u32 = 16;

/// A grid in which metres are cells, but for a margin.
fn grid() -> Grid {
    Grid::new(&Bounds { min: DVec3::ZERO, max: DVec3::splat(f64::from(SIDE)) }, SIDE)
}

fn point() -> impl Strategy<Value = Vec3> {
    let anywhere = prop::array::uniform3(0.0f32..SIDE as f32);
    let on_borders = prop::array::uniform3((0..=SIDE).prop_map(|c| c as f32));
    prop_oneof![3 => anywhere, 1 => on_borders].prop_map(Vec3::from_array)
}

/// A box, often flat or a point.
fn cuboid() -> impl Strategy<Value = [Vec3; 2]> {
    let size = prop_oneof![Just(0.0f32), 0.0f32..1.0, 0.0f32..3.0];
    (point(), prop::array::uniform3(size)).prop_map(|(low, size)| {
        let high = (low + Vec3::from_array(size)).min(Vec3::splat(SIDE as f32));
        [low, high]
    })
}

/// Some point of a box.
fn within([low, high]: [Vec3; 2], share: [f32; 3]) -> Vec3 {
    low + (high - low) * Vec3::from_array(share)
}

/// No less than this are some points' hull and a cell apart: 0 where they meet. Gilbert's algorithm in double precision (Gilbert
/// 1966, *An iterative procedure for computing the minimum of a quadratic form on a convex set*), whose every step has a plane
/// that parts the two by so much.
fn at_least_apart(hull: &[DVec3], cell: IVec3) -> f64 {
    let low = cell.as_dvec3();
    let corner = |i: i32| low + IVec3::new(i & 1, i >> 1 & 1, i >> 2).as_dvec3();
    let apart: Vec<DVec3> = hull.iter().flat_map(|p| (0..8).map(move |i| *p - corner(i))).collect();
    let (mut nearest, mut most) = (apart[0], 0.0_f64);
    for _ in 0..1000 {
        let support = apart.iter().copied().min_by(|a, b| a.dot(nearest).total_cmp(&b.dot(nearest))).unwrap_or(nearest);
        most = most.max(support.dot(nearest) / nearest.length().max(1e-30));
        let way = support - nearest;
        if -way.dot(nearest) < 1e-12 {
            break;
        }
        nearest += way * (-nearest.dot(way) / way.length_squared()).clamp(0.0, 1.0);
    }
    most
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    #[test]
    fn beams_miss_no_cell_of_any_segment(
        from in cuboid(), to in cuboid(),
        shares in prop::collection::vec((prop::array::uniform3(0.0f32..=1.0), prop::array::uniform3(0.0f32..=1.0)), 20),
    ) {
        let grid = grid();
        let mut marks = Marks::none(&grid);
        Beam::new(from, to).mark(&grid, &mut marks);
        for (a, b) in shares {
            let (a, b) = (within(from, a), within(to, b));
            for i in 0..=2000 {
                let at = a + (b - a) * (i as f32 / 2000.0);
                let cell = at.floor().as_ivec3().min(IVec3::splat(SIDE as i32 - 1));
                prop_assert!(marks.has(grid.number(cell).expect("inside")), "{at} of {a} to {b}");
            }
        }
    }

    #[test]
    fn beams_mark_no_cell_that_they_do_not_touch(from in cuboid(), to in cuboid()) {
        let grid = grid();
        let mut marks = Marks::none(&grid);
        Beam::new(from, to).mark(&grid, &mut marks);
        let corner = |b: [Vec3; 2], i: usize| {
            Vec3::new(b[i & 1].x, b[i >> 1 & 1].y, b[i >> 2].z).as_dvec3()
        };
        let hull: Vec<DVec3> = (0..8).flat_map(|i| [corner(from, i), corner(to, i)]).collect();
        for number in (0..grid.cells()).filter(|number| marks.has(*number)) {
            // A box is widened by a hair along each axis.
            let apart = at_least_apart(&hull, grid.cell(number));
            prop_assert!(apart < 2e-3, "{} is {apart} off", grid.cell(number));
        }
    }

    #[test]
    fn steps_with_a_ring_hold_all_that_beams_between_cells_touch(from in point(), to in point()) {
        let grid = grid();
        let last = IVec3::splat(SIDE as i32 - 1);
        let [from, to] = [from, to].map(|p| p.floor().as_ivec3().min(last));
        let (mut exact, mut stepped) = (Marks::none(&grid), Marks::none(&grid));
        // Boxes a little smaller than the cells, so that no hair touches their neighbours.
        let inner = |cell: IVec3| [cell.as_vec3() + 0.01, cell.as_vec3() + 0.99];
        Beam::new(inner(from), inner(to)).mark(&grid, &mut exact);
        mark_by_steps(&grid, from, to, &mut stepped);
        for number in 0..grid.cells() {
            prop_assert!(!exact.has(number) || stepped.has(number), "{} from {from} to {to}", grid.cell(number));
        }
    }

    #[test]
    fn bins_hold_every_point_of_every_triangle(
        corners in prop::collection::vec(prop::array::uniform3(point()), 1..8),
        shares in prop::collection::vec([0.0f32..=1.0, 0.0f32..=1.0], 50),
    ) {
        let grid = grid();
        // Back to metres.
        let metres = |p: Vec3| {
            let bounds = grid.bounds(IVec3::ZERO);
            bounds.min + p.as_dvec3() / grid.cells_per_m()
        };
        let triangles: Vec<[DVec3; 3]> = corners.iter().map(|t| t.map(metres)).collect();
        let bins = Bins::new(&grid, &triangles, Binning::Whole);
        let clipped = Bins::new(&grid, &triangles, Binning::Clip);
        let levels = Bins::new(&grid, &triangles, Binning::Levels { most_cells: 3 });
        for (i, [a, b, c]) in corners.iter().enumerate() {
            let mut area = 0.0;
            for [u, v] in &shares {
                let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (*u, *v) };
                let cell = (*a + (*b - *a) * u + (*c - *a) * v).floor().as_ivec3().min(IVec3::splat(SIDE as i32 - 1));
                let number = grid.number(cell).expect("inside");
                prop_assert!(bins.of_cell(number).contains(&(i as u32)), "triangle {i} lacks {cell}");
                let mut marks = Marks::none(&grid);
                marks.set(number);
                prop_assert!(levels.survivors(&marks).contains(&(i as u32)), "triangle {i} is culled at {cell}");
            }
            // Pieces cover the triangle once.
            for number in clipped.occupied() {
                let own = clipped.of_cell(number).iter().zip(clipped.pieces_of_cell(number));
                for (_, [p, q, r]) in own.filter(|(triangle, _)| **triangle == i as u32) {
                    area += f64::from((*q - *p).cross(*r - *p).length());
                    let cell = grid.cell(number);
                    prop_assert!([p, q, r].into_iter().all(|p| (*p - cell.as_vec3() - 0.5).abs().max_element() < 0.501));
                }
            }
            let whole = f64::from((*b - *a).cross(*c - *a).length());
            // What lies on a border is in the cells on both sides.
            let on_border = (0..3).any(|axis| a[axis] == b[axis] && b[axis] == c[axis] && a[axis].fract() == 0.0);
            prop_assert!(on_border || (area - whole).abs() < 1e-3 * (1.0 + whole), "{area} of {whole}");
        }
    }

    #[test]
    fn triangles_touch_no_cell_that_is_farther_than_a_hair(corners in prop::array::uniform3(point()), cell in point()) {
        let cell = cell.floor().as_ivec3();
        let apart = at_least_apart(&corners.map(|p| p.as_dvec3()), cell);
        prop_assert!(!touches(&corners, cell) || apart < 3e-3, "{apart}");
    }
}

/// Walls with holes, a floor and clutter.
fn triangles(seed: u32) -> Vec<[[f32; 3]; 3]> {
    let random = |i: u32| {
        let mixed = (i ^ seed.wrapping_mul(0x9e37_79b9)).wrapping_mul(0x85eb_ca6b);
        ((mixed ^ mixed >> 15).wrapping_mul(0xc2b2_ae35) >> 8) as f32 / (1 << 24) as f32
    };
    let clutter = (0..400).map(|i| {
        let at = [0, 1, 2].map(|axis| 10.0 * random(16 * i + axis));
        [0, 3, 6].map(|k| [0, 1, 2].map(|axis: usize| at[axis] + random(16 * i + 4 + k + axis as u32) - 0.5))
    });
    let floor = [
        [[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [0.0, 0.0, 10.0]],
        [[10.0, 0.0, 0.0], [10.0, 0.0, 10.0], [0.0, 0.0, 10.0]],
    ];
    clutter.chain(floor).collect()
}

fn tracer(triangles: &[[[f32; 3]; 3]]) -> Tracer {
    let indices = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]);
    let primitive = Primitive {
        positions: triangles.as_flattened().to_vec(),
        triangles: indices.collect(),
        ..Primitive::default()
    };
    let node = Node { name: String::new(), mesh: 0, world_from_mesh: DAffine3::IDENTITY, dynamic: false };
    let scene = Scene {
        meshes: vec![Mesh { name: String::new(), primitives: vec![primitive] }],
        nodes: vec![node],
        ..Scene::default()
    };
    Tracer::new(&scene, |_, _| true)
}

/// Whatever a lookup of a cube map may read before a point that is seen lies in a marked cell: rays through texel centres,
/// and the triangle that each meets first.
#[test]
fn no_texel_that_a_lookup_reads_is_missed() {
    let (texels, taps) = (64, 3);
    let (mut culled, mut all, mut read, mut missed) = (0, 0, 0, 0);
    for seed in 0..12 {
        let tracer = tracer(&triangles(seed));
        let corners: Vec<[DVec3; 3]> =
            (0..tracer.triangle_count()).map(|i| tracer.corners(crate::TriangleId(i as u32))).collect();
        let grid = Grid::new(&tracer.bounds(), 32);
        let bins = Bins::new(&grid, &corners, Binning::Whole);
        let eye = DVec3::new(5.0, 4.0, -4.0);
        let rays = (0..300).map(|i| {
            let (x, y) = (f64::from(i % 20) / 40.0 - 0.25, f64::from(i / 20) / 30.0 - 0.4);
            Ray::new(eye, DVec3::new(x, y, 1.0))
        });
        let seen: Vec<(DVec3, DVec3)> = rays
            .filter_map(|ray| tracer.closest(&ray).map(|hit| (ray.at(hit.t), tracer.normal(hit.triangle))))
            .collect();
        let receivers = Receivers::new(&grid, seen.iter().map(|(point, _)| *point));
        // One of two lights that share their marks.
        let light = DVec3::new(2.0 + 0.5 * f64::from(seed), 6.0, 7.0 - 0.4 * f64::from(seed));
        let other = light + DVec3::new(0.2, 0.1, 0.3) * f64::from(seed % 2);
        let left = |footprint| {
            let mut marks = Marks::none(&grid);
            receivers.mark(&grid, [light, other], footprint, &mut marks);
            bins.survivors(&marks)
        };
        let (survivors, too_few) = (left(Footprint::of_cube(texels, taps)), left(Footprint::NONE));
        (culled, all) = (culled + corners.len() - survivors.len(), all + corners.len());
        for (point, normal) in &seen {
            // As far off its surface as a lookup goes.
            let texel_m = 2.0 / f64::from(texels) * (*point - light).abs().max_element();
            let off = *point + *normal * texel_m * (0.5 * f64::from(taps) + 0.0625);
            let aside = off - light;
            let major = aside.abs().max_position();
            let depth = aside[major].abs();
            let (u, v) = ((major + 1) % 3, (major + 2) % 3);
            let center = |axis: usize, tap: i32| {
                let texel = (0.5 * (aside[axis] / depth + 1.0) * f64::from(texels)).floor() + f64::from(tap);
                (2.0 * (texel + 0.5) / f64::from(texels) - 1.0) * depth
            };
            for tap in 0..9 {
                let mut way = DVec3::ZERO;
                way[major] = aside[major];
                (way[u], way[v]) = (center(u, tap % 3 - 1), center(v, tap / 3 - 1));
                let ray = Ray::new(light, way).between(0.0, 1.0);
                let Some(hit) = tracer.closest(&ray) else { continue };
                read += 1;
                missed += usize::from(too_few.binary_search(&hit.triangle.0).is_err());
                assert!(
                    survivors.binary_search(&hit.triangle.0).is_ok(),
                    "seed {seed}: {point} needs {:?} at {}",
                    hit.triangle,
                    hit.t,
                );
            }
        }
    }
    assert!(missed > 0, "lookups read no wider than their points");
    assert!(read > 1000 && culled > all / 4, "{read} texels with casters, {culled} of {all} triangles culled");
}

#[test]
fn what_lies_off_the_grid_is_not_culled_and_is_seen_from_its_rim() {
    let grid = grid();
    let nowhere = [DVec3::NAN, DVec3::splat(1e300)];
    assert_eq!(Receivers::new(&grid, nowhere).cells, []);
    let outside = Receivers::new(&grid, [DVec3::splat(-5.0)]).cells;
    assert!(outside.len() == 1 && outside[0].cell == IVec3::ZERO && outside[0].low.max_element() < -4.9);
    let triangle = [DVec3::ZERO, DVec3::X, DVec3::new(0.0, 40.0, 0.0)];
    let most_cells = 2;
    for binning in [Binning::Whole, Binning::Clip, Binning::NoCull { most_cells }, Binning::Levels { most_cells }] {
        let bins = Bins::new(&grid, &[triangle], binning);
        assert_eq!((bins.unculled(), bins.occupied().count()), (&[0][..], 0));
    }
    // Far beyond all cells, and without end.
    let mut marks = Marks::none(&grid);
    mark_by_steps(&grid, IVec3::ONE, IVec3::MIN, &mut marks);
    Beam::new([Vec3::ONE, Vec3::ONE], [Vec3::splat(-1e9), Vec3::splat(-1e9)]).mark(&grid, &mut marks);
    assert!(marks.has(0));
    let flat = Grid::new(&Bounds { min: DVec3::ZERO, max: DVec3::new(8.0, 0.0, 8.0) }, 8);
    assert!((flat.cells_per_m() - 1.0).abs().max_element() < 0.01);
    assert!((flat.at(DVec3::ZERO).y - 4.0).abs() < 0.01);
}

#[test]
fn large_triangles_lie_in_coarser_grids() {
    let grid = grid();
    assert_eq!((grid.levels(), grid.cells_to(5)), (5, 4096 + 512 + 64 + 8 + 1));
    assert_eq!((Grid::new(&grid.bounds(IVec3::ZERO), 17).levels(), grid.coarser(4).side()), (6, 1));
    let sized = |m: f64| [DVec3::splat(0.1), DVec3::new(m, 0.1, 0.1), DVec3::new(0.1, 0.1, m)];
    let bins = Bins::new(&grid, &[sized(1.5), sized(3.5), sized(15.5)], Binning::Levels { most_cells: 4 });
    let levels_of = |triangle: u32| -> Vec<usize> {
        let own = |level: &u32| {
            let mut cells = grid.cells_to(*level)..grid.cells_to(*level + 1);
            cells.any(|cell| bins.of_cell(cell).contains(&triangle))
        };
        (0..grid.levels()).filter(own).map(|level| level as usize).collect()
    };
    assert_eq!([0, 1, 2].map(levels_of), [vec![0], vec![1], vec![3]]);
}

#[test]
fn cuts_are_the_same_from_both_cells() {
    let grid = grid();
    let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let triangles = [[at(0.13, 0.71, 0.37), at(15.2, 3.3, 7.7), at(4.4, 14.9, 12.1)]];
    let bins = Bins::new(&grid, &triangles, Binning::Clip);
    let on_plane = |cell: IVec3, plane: f32| -> Vec<[u32; 3]> {
        let pieces = bins.pieces_of_cell(grid.number(cell).expect("inside")).as_flattened();
        let mut cuts: Vec<[u32; 3]> =
            pieces.iter().filter(|p| p.x == plane).map(|p| p.to_array().map(f32::to_bits)).collect();
        cuts.sort_unstable();
        cuts.dedup();
        cuts
    };
    let mut met = 0;
    for cell in bins.occupied().map(|number| grid.cell(number)).filter(|cell| cell.x + 1 < SIDE as i32) {
        let plane = (cell.x + 1) as f32;
        let (here, there) = (on_plane(cell, plane), on_plane(cell + IVec3::X, plane));
        assert_eq!(here.len(), there.len(), "{cell}");
        // Where the edge of the triangle itself is cut; cuts of cuts may differ by a rounding.
        met += here.iter().filter(|cut| there.contains(cut)).count();
    }
    assert!(met > 0);
}

#[test]
fn hulls_and_faces() {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| DVec3::new(x, y, 2.0));
    let hull = Hull::of_view(corners, DVec3::ZERO, DVec3::new(0.0, 5.0, 1.0));
    let at = |x: f64, y: f64, z: f64| Bounds { min: DVec3::new(x, y, z), max: DVec3::new(x, y, z) + 0.1 };
    assert!(hull.touches(&at(0.0, 0.0, 1.0)) && hull.touches(&at(0.0, 4.0, 1.0)));
    assert!(
        !hull.touches(&at(0.0, -1.0, 0.5)) && !hull.touches(&at(0.9, 4.0, 1.0)) && !hull.touches(&at(0.0, 0.0, 2.1))
    );
    assert_eq!(faces_of(&at(3.0, 0.0, 0.0), DVec3::ZERO), 1);
    assert_eq!(faces_of(&at(-3.0, 0.0, 0.0), DVec3::ZERO), 2);
    assert_eq!(faces_of(&Bounds { min: DVec3::NEG_ONE, max: DVec3::ONE }, DVec3::ZERO), 63);
    assert_eq!(faces_of(&at(3.0, 2.95, 0.0), DVec3::ZERO), 1 | 4);
}
