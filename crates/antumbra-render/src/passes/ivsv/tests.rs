//! Each step held against a plain one.

use glam::{DVec2, DVec3, Vec3};
use proptest::prelude::*;

use super::AreaLit;
use super::airlight::Airlight;
use super::cloud::Cloud;
use super::epipolar::Epipolar;
use super::gather::{Gather, Rows, Sample, Shadows, Volume};
use super::splat::{Map, chosen};
use super::{rectify, scan};
use crate::area::{self, VoxelResolution, Vpl};
use crate::camera::{View, look_at};
use crate::sampling::hash;

fn size(alpha: u32, theta: u32, phi: u32) -> VoxelResolution {
    VoxelResolution { map: 64, alpha, theta, phi, points: 4096 }
}

fn vpl(position: Vec3, normal: Vec3) -> Vpl {
    Vpl { position, normal, intensity: Vec3::ONE, radius_m: 0.01, start_m: 0.0, spread: 1.0 }
}

fn view(towards: DVec3, fov_y: f64) -> View {
    let camera = look_at(DVec3::ZERO, towards, fov_y).expect("a camera");
    View::new(&camera, 160, 90).expect("a view")
}

prop_compose! {
    fn direction()(x in -1.0..1.0_f64, y in -1.0..1.0_f64, z in -1.0..1.0_f64) -> DVec3 {
        DVec3::new(x, y, z).try_normalize().unwrap_or(DVec3::X)
    }
}

proptest! {
    /// Wherever the light is, all that is seen has an index, and indices lead back to it.
    #[test]
    fn all_that_is_seen_lies_in_range(
        light in direction(), far_away in 0.1..50.0_f64, towards in direction(), fov in 0.2..2.5_f64,
        pixel in (0.0..160.0_f64, 0.0..90.0_f64), t in 0.01..40.0_f32,
    ) {
        let vpl = vpl((light * far_away).as_vec3(), Vec3::Y);
        let view = view(towards, fov);
        let space = Epipolar::new(&vpl, &view, 40.0, size(128, 64, 96));
        let ray = view.ray(DVec2::new(pixel.0, pixel.1)).direction.as_vec3();
        let place = space.place(ray, t);
        let column = (place.alpha - space.alpha_min) * space.alpha_scale;
        prop_assert!((3.9..128.0).contains(&column), "column {column}");
        let row = space.theta_index(place.theta);
        prop_assert!((-0.01..64.01).contains(&row), "row {row}");
        prop_assert!(place.phi >= 0.0 && place.phi * space.phi_scale <= 96.0, "bit {}", place.phi * space.phi_scale);
        // From the light, along its ray, to where the eye's ray was.
        let there = ray * t;
        let r = there.distance(vpl.position);
        let back = vpl.position + space.light_ray(place.theta, place.phi) * r;
        prop_assert!(back.distance(there) < 1e-3 * (r + t), "{back} {there}");
        let alpha = space.alpha_on_light_ray(place.phi, r);
        prop_assert!((alpha - place.alpha).abs() < 1e-2, "{alpha} {}", place.alpha);
    }

    /// A light ray is dark from its threshold on.
    #[test]
    fn voxels_are_what_thresholds_say(seed in any::<u32>(), alpha in 32_u32..80, phi_words in 1_u32..4) {
        let size = size(alpha, 32, 32 * phi_words);
        let thresholds: Vec<u32> = (0..size.theta * size.phi).map(|i| hash(seed ^ hash(i)) % (alpha + 9)).collect();
        let voxels = scan::voxels(size, &thresholds);
        for theta in 0..size.theta {
            for column in 0..alpha {
                for phi in 0..size.phi {
                    let word = voxels[((theta * alpha + column) * phi_words + phi / 32) as usize];
                    let expected = thresholds[(theta * size.phi + phi) as usize] <= column;
                    prop_assert_eq!(word >> (phi % 32) & 1 == 1, expected);
                }
            }
        }
    }

    /// Runs of lit bits add up to what bits do one by one, and so does their share.
    #[test]
    fn runs_are_what_bits_add_up_to(bits in any::<u128>(), sparse in any::<u128>(), index in 0.0..127.5_f32) {
        let space = Epipolar::new(&vpl(Vec3::NEG_Z, Vec3::Z), &view(DVec3::NEG_Z, 1.0), 20.0, size(32, 32, 128));
        for dark in [bits, bits & sparse, bits | sparse, 0, u128::MAX, 1, 1 << 127, !1] {
            let voxels: Vec<u32> = (0..4).map(|i| (dark >> (32 * i)) as u32).collect();
            let end = index / space.phi_scale;
            // Each bit is as long as the way to the next, the last as far as the end.
            let lit = |i: i32| if dark >> i & 1 == 0 { (index - i as f32).clamp(0.0, 1.0) } else { 0.0 };
            let expected: f32 = (0..128).map(lit).sum();
            let runs = space.runs(&voxels, end, |phi| -phi * space.phi_scale);
            prop_assert!((runs + expected).abs() < 1e-2 || (runs - expected).abs() < 1e-2, "{runs} {expected}");
            let whole = (index as u32).clamp(1, 128);
            let share = (0..whole).filter(|i| dark >> i & 1 == 0).count() as f32 / whole as f32;
            prop_assert!((space.share_lit(&voxels, end) - share).abs() < 1e-5);
        }
    }
}

#[test]
fn a_light_before_an_open_sky_is_not_hidden() {
    // The eye looks straight at a light that is farther away than fog reaches; what stands nearer hides it.
    let (light, airlight) = (vpl(Vec3::NEG_Z * 100.0, Vec3::Z), Airlight::new(0.0));
    let space = Epipolar::new(&light, &view(DVec3::NEG_Z, 1.0), 20.0, size(32, 32, 32));
    let volume = Volume { vpl: light, space, shadows: Shadows::Voxels(vec![0; 32 * 32]) };
    let gather = Gather { sigma_t: 0.01, airlight: &airlight, how: area::Airlight::Exact, interpolate: true };
    let mut lit = AreaLit::default();
    let sample = Sample { ray: Vec3::NEG_Z, distance: 20.0, fog_m: 20.0, surface: None };
    gather.add(&volume, &sample, &mut lit);
    assert!(lit.airlight.x > 0.0, "{lit:?}");
    let rows = |stop| volume.rows(&space.place(Vec3::NEG_Z, 20.0), stop, 0.0, true);
    assert!(matches!(rows(20.0), Rows::Dark) && matches!(rows(200.0), Rows::Lit));
}

/// A wall of 2 x 2 m, at z = -3, and a floor of 24 x 24 m.
pub(crate) fn wall_and_floor() -> antumbra_scene::Scene {
    let quad = |corners: [[f32; 3]; 4]| antumbra_scene::Primitive {
        positions: corners.to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Default::default()
    };
    let wall = quad([[-1.0, -1.0, -3.0], [1.0, -1.0, -3.0], [1.0, 1.0, -3.0], [-1.0, 1.0, -3.0]]);
    let floor = quad([[-12.0, -2.0, 12.0], [12.0, -2.0, 12.0], [12.0, -2.0, -12.0], [-12.0, -2.0, -12.0]]);
    let mesh = antumbra_scene::Mesh { name: String::new(), primitives: vec![wall, floor] };
    let node = antumbra_scene::Node {
        name: String::new(),
        mesh: 0,
        world_from_mesh: glam::DAffine3::IDENTITY,
        dynamic: false,
    };
    antumbra_scene::Scene { meshes: vec![mesh], nodes: vec![node], ..Default::default() }
}

#[test]
fn maps_show_what_stands_before_the_light() {
    let scene = wall_and_floor();
    let light = vpl(Vec3::ZERO, Vec3::NEG_Z);
    let cast = Cloud::new(&scene, 1 << 16).cast(&scene.nodes, DVec3::ZERO, &[light], 8192);
    let map = Map::draw(&light, 0, &cast, 64, 8192);
    let paraboloid = super::splat::Paraboloid::new(&light, 64);
    let (mut seen, mut off) = (0, 0);
    for (x, y) in (0..64).flat_map(|y| (0..64).map(move |x| (x, y))) {
        // Through the middle of each texel: of the wall, the floor, or nothing.
        let direction = paraboloid.direction(x, y);
        let Some((texel, cos)) = paraboloid.texel(direction) else { continue };
        assert!((texel - glam::Vec2::new(x as f32 + 0.5, y as f32 + 0.5)).length() < 1e-3);
        let to_wall = direction * (3.0 / cos);
        // Away from edges, which discs may cover by a texel or two.
        let inside = to_wall.x.abs().max(to_wall.y.abs());
        if inside < 0.8 {
            let r = map.between(texel).unwrap_or(f32::INFINITY);
            off += usize::from((r - 3.0 / cos).abs() > 0.15);
            seen += 1;
        } else if direction.y > 0.05 && inside > 1.4 {
            assert!(map.at(x, y).is_none(), "{x} {y}: something in the sky");
        }
    }
    // A map is imperfect: it may have a hole here and there.
    assert!(seen > 50 && off * 40 <= seen, "{off} of {seen}");
    // The floor is 144 times the wall: evenly over the area, the wall would have 57 of the points.
    let on_wall = |index| cast.points[chosen(&cast, 0, index, 8192).1].normal.z > 0.5;
    let points = (0..8192).filter(|i| on_wall(*i)).count();
    assert!(points > 200, "{points}");
}

#[test]
fn holes_of_a_surface_are_seen_as_such() {
    let (wall, far) = (2.0_f32, 9.0_f32);
    let texel = |x: u32, y: u32| match (x, y) {
        // Holes in a wall, before something and before nothing, and one of four texels; a slit; and an opening of five texels.
        (3, 3) => far.to_bits(),
        (3, 4) | (4..6, 12..14) => u32::MAX,
        (8, _) => far.to_bits(),
        (11..16, 5..10) => far.to_bits(),
        _ => (wall + 0.01 * y as f32).to_bits(),
    };
    let map = Map { side: 16, texels: (0..256).map(|i| texel(i % 16, i / 16)).collect() };
    let at = |x: u32, y: u32| map.between(DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5).as_vec2());
    let is_wall = |x, y| at(x, y).is_some_and(|r| (r - wall).abs() < 0.2);
    assert!([(3, 3), (3, 4), (4, 12), (5, 12), (4, 13), (5, 13), (5, 5)].into_iter().all(|(x, y)| is_wall(x, y)));
    assert!((0..16).all(|y| !is_wall(8, y)), "a slit is no hole");
    assert!(!is_wall(13, 7), "an opening is no hole");
}

#[test]
fn shadow_begins_behind_the_wall() {
    let scene = wall_and_floor();
    // The light in front of the wall, the eye far to the side.
    let eye = DVec3::new(12.0, 1.0, -4.0);
    let light = vpl(-eye.as_vec3(), Vec3::NEG_Z);
    let camera = look_at(eye, DVec3::new(0.0, 0.0, -3.0), 1.2).expect("a camera");
    let view = View::new(&camera, 160, 90).expect("a view");
    let size = size(256, 256, 256);
    let cast = Cloud::new(&scene, 1 << 16).cast(&scene.nodes, eye, &[light], 32_768);
    let map = Map::draw(&light, 0, &cast, 256, 32_768);
    let space = Epipolar::new(&light, &view, 40.0, size);
    let voxels = scan::voxels(size, &rectify::thresholds(&light, &space, &map));
    let dark = |at: DVec3| {
        let way = (at - eye).as_vec3();
        let place = space.place(way.normalize(), way.length());
        let column = ((place.alpha - space.alpha_min) * space.alpha_scale - 2.25).max(0.0) as u32;
        let row = (space.theta_index(place.theta) as u32).min(255);
        let bit = ((place.phi * space.phi_scale) as u32).min(255);
        voxels[((row * 256 + column) * 8 + bit / 32) as usize] >> (bit % 32) & 1 == 1
    };
    let (mut lit, mut shadowed, mut all) = (0, 0, 0);
    for (x, y) in (-5..=5).flat_map(|y| (-5..=5).map(move |x| (0.1 * f64::from(x), 0.1 * f64::from(y)))) {
        // Rays from the light at the origin through points well inside the wall, before it and behind it; and over it.
        let through = DVec3::new(x, y, -3.0);
        let over = through + DVec3::Y * 2.0;
        lit += [through * 0.8, over, over * 1.2].iter().filter(|at| !dark(**at)).count();
        shadowed += usize::from(dark(through * 1.2));
        all += 1;
    }
    assert_eq!(lit, 3 * all);
    // The map is imperfect: a little light may leak.
    assert!(shadowed * 100 >= 97 * all, "{shadowed} of {all}");
}
