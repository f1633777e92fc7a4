//! The tracer against brute force, against integer arithmetic, and at edges and corners of closed meshes.

use antumbra_scene::{Material, Mesh, Node, Primitive, Scene};
use glam::{DAffine3, DMat3, DVec3, I64Vec3};
use proptest::prelude::*;

use super::{Hit, Ray, Tracer, TriangleId, triangle::Shear};

fn scene(positions: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>, world_from_mesh: DAffine3) -> Scene {
    Scene {
        meshes: vec![Mesh {
            name: "mesh".into(),
            primitives: vec![Primitive { positions, triangles, ..Primitive::default() }],
        }],
        nodes: vec![Node { name: "node".into(), mesh: 0, world_from_mesh, dynamic: false }],
        ..Scene::default()
    }
}

fn tracer(positions: Vec<[f32; 3]>, triangles: Vec<[u32; 3]>, place: DAffine3) -> Tracer {
    Tracer::new(&scene(positions, triangles, place), |_, _| true)
}

/// Every hit of a ray without the tree, nearest first.
fn brute_force(tracer: &Tracer, ray: &Ray) -> Vec<Hit> {
    let shear = Shear::new(ray.origin, ray.direction);
    let ids = (0..tracer.triangle_count() as u32).map(TriangleId);
    let mut hits: Vec<Hit> = ids
        .filter_map(|id| {
            let c = shear.cross(&tracer.corners(id))?;
            let inside = c.t > ray.t_min && c.t < ray.t_max;
            inside.then_some(Hit { t: c.t, triangle: id, u: c.u, v: c.v, front: c.front })
        })
        .collect();
    hits.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.triangle.cmp(&b.triangle)));
    hits
}

fn all_hits(tracer: &Tracer, ray: &Ray) -> Vec<Hit> {
    let mut hits = Vec::new();
    tracer.for_each_hit(ray, |hit| hits.push(hit));
    hits.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.triangle.cmp(&b.triangle)));
    hits
}

fn assert_like_brute_force(tracer: &Tracer, ray: &Ray) {
    let expected = brute_force(tracer, ray);
    assert_eq!(all_hits(tracer, ray), expected, "{ray:?}");
    assert_eq!(tracer.occluded(ray), !expected.is_empty(), "{ray:?}");
    assert_eq!(tracer.closest(ray).map(|h| h.t), expected.first().map(|h| h.t), "{ray:?}");
}

fn winding(tracer: &Tracer, ray: &Ray) -> i64 {
    let mut sum = 0;
    tracer.for_each_hit(ray, |hit| sum += if hit.front { -1 } else { 1 });
    sum
}

/// A closed mesh that goes round the origin: a subdivided octahedron, bent out of shape.
fn ball(levels: u32, bend: f64) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let n = 1_i32 << levels;
    let mut positions: Vec<[f32; 3]> = Vec::new();
    let mut index = std::collections::HashMap::new();
    let mut vertex = |p: I64Vec3| {
        *index.entry(p.to_array()).or_insert_with(|| {
            let d = p.as_dvec3().normalize();
            let bent = d * (1.0 + bend * (7.0 * d.x).sin() * (5.0 * d.y + 3.0 * d.z).cos());
            positions.push(bent.as_vec3().to_array());
            positions.len() as u32 - 1
        })
    };
    let mut triangles = Vec::new();
    for octant in 0..8 {
        let s = |bit: i32| if octant & bit == 0 { 1 } else { -1 };
        let mut at = |i: i32, j: i32| {
            vertex(I64Vec3::new(i64::from(s(1) * i), i64::from(s(2) * j), i64::from(s(4) * (n - i - j))))
        };
        let mut emit = |t: [u32; 3]| triangles.push(if s(1) * s(2) * s(4) > 0 { t } else { [t[0], t[2], t[1]] });
        for i in 0..n {
            for j in 0..n - i {
                emit([at(i, j), at(i + 1, j), at(i, j + 1)]);
                if i + j + 1 < n {
                    emit([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
    }
    (positions, triangles)
}

fn places() -> Vec<DAffine3> {
    let turned = DAffine3::from_mat3_translation(DMat3::from_rotation_y(0.7), DVec3::new(5.0e6, -3.0e5, 7.0e6));
    vec![
        DAffine3::IDENTITY,
        DAffine3::from_scale(DVec3::splat(1e-3)),
        DAffine3::from_scale(DVec3::new(3.0e4, 10.0, 3.0e4)),
        DAffine3::from_scale(DVec3::new(1.0, -1.0, 1.0)),
        turned,
        DAffine3::from_scale(DVec3::splat(1e12)),
    ]
}

/// Where rays of a leak test are aimed: corners, middles of edges and points along edges.
fn aims(tracer: &Tracer) -> Vec<DVec3> {
    let ids = (0..tracer.triangle_count() as u32).map(TriangleId);
    ids.flat_map(|id| {
        let [a, b, c] = tracer.corners(id);
        [a, (a + b) * 0.5, b + (c - b) * 0.25, c + (a - c) * 0.123]
    })
    .collect()
}

#[test]
fn nothing_leaks_through_edges_or_corners() {
    let (positions, triangles) = ball(3, 0.2);
    for place in places() {
        let tracer = tracer(positions.clone(), triangles.clone(), place);
        let inside = place.transform_point3(DVec3::new(0.01, 0.02, -0.03));
        let outside = place.transform_point3(DVec3::new(5.0, 3.0, -4.0));
        for aim in aims(&tracer) {
            let ray = Ray::new(inside, aim - inside);
            assert_eq!(winding(&tracer, &ray), 1, "from inside {ray:?}");
            assert!(tracer.occluded(&ray));
            assert_eq!(winding(&tracer, &Ray::new(outside, aim - outside)), 0, "from outside, at {aim}");
        }
    }
}

#[test]
fn axis_parallel_rays_through_grid_corners_are_counted_once() {
    // A box of 8 x 8 x 8 unit cells: rays along the axes go exactly through corners and along edges' planes.
    let (positions, triangles) = grid_box(8);
    let tracer = tracer(positions, triangles, DAffine3::from_translation(DVec3::new(-4.0, -4.0, -4.0)));
    for axis in [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z, DVec3::ONE, DVec3::new(0.0, 1.0, -1.0)]
    {
        for i in 0..343 {
            let p = DVec3::new(f64::from(i % 7) - 3.0, f64::from(i / 7 % 7) - 3.0, f64::from(i / 49) - 3.0);
            assert_eq!(winding(&tracer, &Ray::new(p, axis)), 1, "{p} along {axis}");
            assert_like_brute_force(&tracer, &Ray::new(p - axis * 20.0, axis));
        }
    }
}

fn grid_box(n: i32) -> (Vec<[f32; 3]>, Vec<[u32; 3]>) {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for (axis, side) in (0..6).map(|face| (face / 2, face % 2)) {
        for (i, j) in (0..n * n).map(|k| (k % n, k / n)) {
            let first = positions.len() as u32;
            for (di, dj) in [(0, 0), (1, 0), (1, 1), (0, 1)] {
                let mut p = [0.0; 3];
                p[axis] = (side * n as usize) as f32;
                p[(axis + 1) % 3] = (i + di) as f32;
                p[(axis + 2) % 3] = (j + dj) as f32;
                positions.push(p);
            }
            let quad = if side == 1 { [0, 1, 2, 3] } else { [3, 2, 1, 0] }.map(|k| first + k);
            triangles.extend([[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]);
        }
    }
    (positions, triangles)
}

#[test]
fn small_triangles_are_not_missed() {
    // A triangle of 1e-4 m in a scene of 30 km, and one of 1e-9 m on its own.
    for (size, span) in [(1e-4_f32, 3.0e4_f32), (1e-9, 1e-9)] {
        let positions = vec![
            [0.0, 0.0, 0.0],
            [size, 0.0, 0.0],
            [0.0, size, 0.0],
            [-span, -span, span],
            [span, -span, span],
            [span, -span, span * 1.001],
        ];
        let tracer = tracer(positions, vec![[0, 1, 2], [3, 4, 5]], DAffine3::IDENTITY);
        let aim = DVec3::new(f64::from(size) * 0.25, f64::from(size) * 0.5, 0.0);
        for from in [DVec3::new(0.3, 0.2, 1.0), DVec3::new(1.0, 2.0, 300.0), DVec3::new(-1e4, 5e3, 2e4)] {
            let hit = tracer.closest(&Ray::new(from * f64::from(span) / 3.0e4, aim - from * f64::from(span) / 3.0e4));
            let hit = hit.expect("the small triangle");
            assert!((hit.t - 1.0).abs() < 1e-9 && hit.front);
        }
    }
}

#[test]
fn thousands_of_coinciding_triangles_build_a_shallow_tree() {
    let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let tracer = tracer(positions, vec![[0, 1, 2]; 30_000], DAffine3::IDENTITY);
    let mut count = 0;
    tracer.for_each_hit(&Ray::new(DVec3::new(0.2, 0.2, 1.0), -DVec3::Z), |_| count += 1);
    assert_eq!(count, 30_000);
    assert!(tracer.depth <= 32, "{} levels", tracer.depth);
}

#[test]
fn triangles_of_every_scale_at_one_corner_are_all_found() {
    // Sizes from 1e-18 to 1e18: the worst there is for a tree's depth.
    let positions: Vec<[f32; 3]> = (-60..60)
        .flat_map(|k| {
            let s = (k as f32).exp2();
            [[0.0, 0.0, s], [s, 0.0, s], [0.0, s, s]]
        })
        .collect();
    let triangles: Vec<[u32; 3]> = (0..120).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let tracer = tracer(positions, triangles, DAffine3::IDENTITY);
    let ray = Ray::new(DVec3::ZERO, DVec3::new(0.3, 0.3, 1.0));
    assert_eq!(all_hits(&tracer, &ray).len(), 120);
    assert_like_brute_force(&tracer, &ray);
}

#[test]
fn hits_name_the_triangle_and_the_place() {
    let mirror = DAffine3::from_scale(DVec3::new(-2.0, 1.0, 1.0));
    let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let scene = scene(positions, vec![[0, 1, 2]], mirror);
    let tracer = Tracer::new(&scene, |_, _| true);
    let ray = Ray::new(DVec3::new(-0.5, 0.5, 3.0), DVec3::new(0.0, 0.0, -2.0));
    let hit = tracer.closest(&ray).expect("a hit");
    let source = tracer.source(hit.triangle);
    assert_eq!((source.node, source.primitive, source.triangle, source.flipped), (0, 0, 0, true));
    assert_eq!(source.vertices(&scene), [0, 2, 1]);
    assert!(hit.front, "mirroring must not turn the triangle inside out");
    assert_eq!(tracer.normal(hit.triangle), DVec3::Z);
    assert_eq!((hit.t, hit.u, hit.v), (1.5, 0.5, 0.25));
    let [a, b, c] = tracer.corners(hit.triangle);
    assert_eq!(a * (1.0 - hit.u - hit.v) + b * hit.u + c * hit.v, ray.at(hit.t));
}

#[test]
fn filters_skip_hits_and_ends_are_open() {
    let positions =
        vec![[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [0.0, 0.0, 2.0], [1.0, 0.0, 2.0], [0.0, 1.0, 2.0]];
    let tracer = tracer(positions, vec![[0, 1, 2], [3, 4, 5]], DAffine3::IDENTITY);
    let ray = Ray::new(DVec3::new(0.1, 0.1, 0.0), DVec3::Z);
    assert_eq!(tracer.closest_if(&ray, |hit| hit.t > 1.5).map(|h| h.t), Some(2.0));
    assert!(!tracer.occluded_if(&ray, |_| false));
    assert!(!tracer.occluded(&ray.between(1.0, 2.0)));
    assert!(tracer.occluded(&ray.between(1.0, 2.0 + 1e-12)));
    assert_eq!(all_hits(&tracer, &ray.between(f64::NEG_INFINITY, f64::INFINITY)).len(), 2);
}

#[test]
fn nodes_and_materials_can_be_left_out() {
    let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let mut scene = scene(positions, vec![[0, 1, 2]], DAffine3::IDENTITY);
    scene.nodes.push(Node { dynamic: true, ..scene.nodes[0].clone() });
    assert_eq!(Tracer::new(&scene, |node, _| !node.dynamic).triangle_count(), 1);
    let none = Tracer::new(&scene, |_, material: &Material| material.double_sided);
    assert_eq!(none.triangle_count(), 0);
    assert!(none.bounds().is_empty());
    assert!(!none.occluded(&Ray::new(DVec3::new(0.2, 0.2, 1.0), -DVec3::Z)));
}

#[test]
fn directions_of_any_length_will_do() {
    let tracer = tracer(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]], DAffine3::IDENTITY);
    for length in [1e-200, 1e-20, 1e20, 1e200] {
        let hit = tracer.closest(&Ray::new(DVec3::new(0.2, 0.2, 1.0), -DVec3::Z * length)).expect("a hit");
        assert!((hit.t * length - 1.0).abs() < 1e-12);
    }
}

#[test]
fn senseless_rays_hit_nothing() {
    let tracer = tracer(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]], DAffine3::IDENTITY);
    for bad in [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY] {
        assert!(!tracer.occluded(&Ray::new(DVec3::Z, bad)));
    }
    assert!(!tracer.occluded(&Ray::new(DVec3::NAN, DVec3::X)));
    assert!(!tracer.occluded(&Ray::new(DVec3::new(0.2, 0.2, 1.0), -DVec3::Z).between(5.0, 2.0)));
}

/// Sign of the volume of the tetrahedron `a b c d`.
fn volume(a: I64Vec3, b: I64Vec3, c: I64Vec3, d: I64Vec3) -> i128 {
    let [u, v, w] = [b - a, c - a, d - a].map(|p| p.to_array().map(i128::from));
    u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0])
}

fn lattice_point(range: i64) -> impl Strategy<Value = I64Vec3> {
    (-range..=range, -range..=range, -range..=range).prop_map(|(x, y, z)| I64Vec3::new(x, y, z))
}

fn soup() -> impl Strategy<Value = Vec<[f32; 3]>> {
    let coordinate = prop_oneof![-10.0..10.0_f32, -0.01..0.01_f32, (-4..5_i32).prop_map(|i| i as f32)];
    let corner = [coordinate.clone(), coordinate.clone(), coordinate];
    prop::collection::vec(corner, 3..90)
}

proptest! {
    /// A line through two lattice points hits exactly the triangles that integer arithmetic says it hits, unless it
    /// touches an edge.
    #[test]
    fn agrees_with_integers(
        [a, b, c, p, q] in [lattice_point(30), lattice_point(30), lattice_point(30), lattice_point(40), lattice_point(40)],
    ) {
        let sides = [volume(p, q, a, b), volume(p, q, b, c), volume(p, q, c, a)].map(i128::signum);
        prop_assume!(p != q && sides.iter().all(|&s| s != 0));
        let shear = Shear::new(p.as_dvec3(), (q - p).as_dvec3());
        let crossing = shear.cross(&[a, b, c].map(|v| v.as_dvec3()));
        let hit = sides[0] == sides[1] && sides[1] == sides[2];
        prop_assert_eq!(crossing.is_some(), hit);
        if let Some(crossing) = crossing {
            // t = V(p, abc) / (V(p, abc) - V(q, abc)).
            let (vp, vq) = (volume(a, b, c, p), volume(a, b, c, q));
            let t = vp as f64 / (vp - vq) as f64;
            prop_assert!((crossing.t - t).abs() <= 1e-9 * (1.0 + t.abs()), "{} {t}", crossing.t);
            prop_assert_eq!(crossing.front, vp > vq);
        }
    }

    /// The tree loses nothing: random soups with shared corners, slivers and lattice coordinates, everywhere.
    #[test]
    fn agrees_with_brute_force(
        positions in soup(),
        picks in prop::collection::vec([0_u32..1000, 0_u32..1000, 0_u32..1000], 1..120),
        rays in prop::collection::vec((soup(), 0_usize..1000, 0_usize..4), 1..8),
        place in 0_usize..6,
    ) {
        let count = positions.len() as u32;
        let triangles: Vec<[u32; 3]> = picks.iter().map(|t| t.map(|i| i % count)).collect();
        let place = places()[place];
        let tracer = tracer(positions.clone(), triangles, place);
        for (ends, aim, kind) in rays {
            let point = |p: [f32; 3]| place.transform_point3(glam::Vec3::from(p).as_dvec3());
            let from = point(ends[0]);
            let to = match kind {
                0 => point(positions[aim % positions.len()]),
                1 => from + DVec3::AXES[aim % 3] * if aim & 1 == 0 { 1.0 } else { -1.0 },
                _ => point(ends[1]),
            };
            let ray = Ray::new(from, to - from);
            assert_like_brute_force(&tracer, &ray);
            assert_like_brute_force(&tracer, &ray.between(0.1, 0.9));
            let far = Ray::new(from - (to - from) * 1e5, to - from);
            assert_like_brute_force(&tracer, &far);
        }
    }
}
