//! Lights with a surface, in clear air and in fog.

use antumbra_render::area::{Airlight, AreaLight, AreaLighting, AreaShape, AreaTechnique, Gathering, VoxelResolution};
use antumbra_render::{Fog, Picture, RenderError, RenderOptions, ShadowSource, look_at, render};
use antumbra_scene::{Camera, Material, Scene};
use glam::DVec3;

use crate::common::{SILENT, cluttered, level, quad, scene, sun};

fn lamp(shape: AreaShape) -> AreaLight {
    AreaLight::towards(shape, DVec3::new(-2.0, 4.5, -1.0), DVec3::new(0.5, 0.0, 0.3), [3000.0; 3]).expect("a light")
}

fn camera() -> Camera {
    look_at(DVec3::new(5.0, 4.0, 8.0), DVec3::new(0.0, 1.0, 0.0), 0.9).expect("a camera")
}

fn drawn(scene: &Scene, lighting: AreaLighting, fog: Option<f64>) -> Picture {
    let fog = fog.map(|density_per_m| Fog { density_per_m, anisotropy: 0.3 });
    let options = RenderOptions {
        width: 96,
        height: 54,
        samples: 1,
        ao_samples: 0,
        exposure: Some(1.0),
        fog,
        area: Some(lighting),
        ..RenderOptions::default()
    };
    render(scene, &camera(), &options, ShadowSource::Traced, SILENT).expect("a picture")
}

fn lighting(technique: AreaTechnique, vpls: u32) -> AreaLighting {
    let rectangle = lamp(AreaShape::Rectangle { width_m: 1.5, height_m: 1.0 });
    AreaLighting { technique, vpls, ..AreaLighting::new(vec![rectangle]) }
}

/// Root of the mean square of differences, relative to the mean of the second picture.
fn rmse(a: &Picture, b: &Picture) -> f64 {
    let square = |(a, b): (&[f32; 3], &[f32; 3])| f64::from(a[1] - b[1]).powi(2);
    let count = a.hdr().len() as f64;
    let mean = b.hdr().iter().map(|p| f64::from(p[1])).sum::<f64>() / count;
    (a.hdr().iter().zip(b.hdr()).map(square).sum::<f64>() / count).sqrt() / mean
}

/// A floor alone: nothing casts a shadow on anything.
fn open_floor() -> Scene {
    scene(vec![level([-9.0, 9.0], 0.0, [-9.0, 9.0], 0)], vec![Material::default()], sun(DVec3::new(0.3, -1.0, -0.5)))
}

#[test]
fn voxels_come_close_to_the_truth() {
    let scene = cluttered();
    for fog in [None, Some(0.1)] {
        let truth = drawn(&scene, lighting(AreaTechnique::Traced, 1024), fog);
        let off = |technique, vpls| rmse(&drawn(&scene, lighting(technique, vpls), fog), &truth);
        let (unshadowed, voxels) = (off(AreaTechnique::None, 256), off(AreaTechnique::Voxels, 256));
        println!("fog {fog:?}: off by {voxels:.4}, without shadows by {unshadowed:.4}");
        assert!(voxels < 0.4 * unshadowed, "fog {fog:?}: {voxels} of {unshadowed}");
    }
    // An average over the whole ray is not what each stretch of it gets.
    let truth = drawn(&scene, lighting(AreaTechnique::Traced, 1024), Some(0.1));
    let average = AreaLighting { airlight: Airlight::Average, ..lighting(AreaTechnique::Voxels, 256) };
    let exact = rmse(&drawn(&scene, lighting(AreaTechnique::Voxels, 256), Some(0.1)), &truth);
    let average = rmse(&drawn(&scene, average, Some(0.1)), &truth);
    println!("exact {exact:.4}, average {average:.4}");
    assert!(exact < average, "{exact} {average}");
}

#[test]
fn without_casters_fog_shines_as_computed_and_as_traced() {
    let scene = open_floor();
    for shape in [
        AreaShape::Rectangle { width_m: 1.5, height_m: 1.0 },
        AreaShape::Disc { radius_m: 0.7 },
        AreaShape::Sphere { radius_m: 0.4 },
        AreaShape::Environment,
    ] {
        let of = |technique, vpls| {
            let lighting = AreaLighting { technique, vpls, ..AreaLighting::new(vec![lamp(shape)]) };
            drawn(&scene, lighting, Some(0.1))
        };
        let (computed, traced) = (of(AreaTechnique::None, 1024), of(AreaTechnique::Traced, 1024));
        let sum = |picture: &Picture| picture.hdr().iter().map(|p| f64::from(p[1])).sum::<f64>();
        let ratio = sum(&computed) / sum(&traced);
        println!("{shape:?}: {ratio:.4}");
        // An environment's light from below the floor passes in one and not in the other.
        if shape != AreaShape::Environment {
            assert!((ratio - 1.0).abs() < 0.01, "{shape:?}: {ratio}");
            let shadowed = of(AreaTechnique::Voxels, 256);
            let own = rmse(&shadowed, &of(AreaTechnique::None, 256));
            println!("{shape:?}: shadows itself by {own:.4}");
            assert!(own < 0.03, "{shape:?}: {own}");
        }
    }
}

#[test]
fn shadows_are_right_from_far_outside() {
    // Farther from the scene than it is large.
    let camera = look_at(DVec3::new(60.0, 48.0, 96.0), DVec3::ZERO, 0.1).expect("a camera");
    let of = |technique, vpls| {
        let area = Some(lighting(technique, vpls));
        let (width, height, exposure) = (96, 54, Some(1.0));
        let options =
            RenderOptions { width, height, samples: 1, ao_samples: 0, exposure, area, ..RenderOptions::default() };
        render(&cluttered(), &camera, &options, ShadowSource::Traced, SILENT).expect("a picture")
    };
    let truth = of(AreaTechnique::Traced, 512);
    let (voxels, unshadowed) = (of(AreaTechnique::Voxels, 256), of(AreaTechnique::None, 256));
    let off = [rmse(&voxels, &truth), rmse(&unshadowed, &truth)];
    println!("from outside: off by {:.4}, without shadows by {:.4}", off[0], off[1]);
    assert!(off[0] < 0.7 * off[1], "{off:?}");
}

#[test]
fn batches_make_the_same_picture_and_sharing_nearly_the_same() {
    let scene = cluttered();
    let of = |change: &dyn Fn(&mut AreaLighting)| {
        let mut how = lighting(AreaTechnique::Voxels, 100);
        how.voxels = VoxelResolution::cube(64);
        change(&mut how);
        drawn(&scene, how, Some(0.1))
    };
    let full = of(&|_| {});
    // Batches of 7: sums in the same order.
    assert_eq!(of(&|how| how.budget_bytes = 7 * how.voxels.bytes()).hdr(), full.hdr());
    assert_eq!(of(&|how| how.technique = AreaTechnique::OneByOne).hdr(), full.hdr());
    let marched = rmse(&of(&|how| how.technique = AreaTechnique::MarchedMaps), &full);
    let interleaved = rmse(&of(&|how| how.gathering = Gathering::Interleaved), &full);
    let half = rmse(&of(&|how| how.gathering = Gathering::Half), &full);
    println!("marched maps {marched:.4}, interleaved {interleaved:.4}, half {half:.4}");
    assert!(marched < 0.15 && interleaved < 0.12 && half < 0.2, "{marched} {interleaved} {half}");
}

#[test]
fn next_to_no_fog_is_no_fog() {
    let scene = cluttered();
    let clear = drawn(&scene, lighting(AreaTechnique::Voxels, 64), None);
    let thin = drawn(&scene, lighting(AreaTechnique::Voxels, 64), Some(1e-9));
    assert!(rmse(&thin, &clear) < 1e-4);
}

#[test]
fn a_light_is_seen_and_glass_does_not_stop_it() {
    let glass = Material {
        alpha_mode: antumbra_scene::AlphaMode::Blend,
        base_color: [1.0, 1.0, 1.0, 0.0],
        ..Material::default()
    };
    let pane = quad([[-9.0, 2.0, 9.0], [9.0, 2.0, 9.0], [9.0, 2.0, -9.0], [-9.0, 2.0, -9.0]], 1);
    let mut with_pane = open_floor();
    with_pane.meshes[0].primitives.push(pane);
    with_pane.materials.push(glass);
    let of = |scene: &Scene| drawn(scene, lighting(AreaTechnique::Voxels, 64), None);
    // It widens the scene's box, by which angles are measured, and no more.
    let off = rmse(&of(&with_pane), &of(&open_floor()));
    assert!(off < 0.02, "{off}");
    let sphere = |technique| {
        let light = lamp(AreaShape::Sphere { radius_m: 0.5 });
        drawn(&open_floor(), AreaLighting { technique, ..AreaLighting::new(vec![light]) }, None)
    };
    // 3000 cd/m² of 128,000 lux: brighter than any white surface that it lights.
    let bright = |picture: &Picture| picture.hdr().iter().filter(|p| p[1] > 0.95 * 3000.0 / 128_000.0).count();
    assert!(bright(&sphere(AreaTechnique::Voxels)) > 10);
}

#[test]
fn lights_that_cannot_be_are_refused() {
    let refused = |change: &dyn Fn(&mut AreaLighting)| {
        let mut wrong = lighting(AreaTechnique::Voxels, 64);
        change(&mut wrong);
        let options = RenderOptions { area: Some(wrong), width: 8, height: 8, ..RenderOptions::default() };
        render(&open_floor(), &camera(), &options, ShadowSource::Traced, SILENT).expect_err("an error")
    };
    let samples = |error: RenderError| matches!(error, RenderError::Samples { .. });
    assert!(samples(refused(&|l| l.vpls = 0)) && samples(refused(&|l| l.vpls = 1025)));
    assert!(samples(refused(&|l| l.voxels.phi = 16)) && samples(refused(&|l| l.voxels.points = 0)));
    let light = |error: RenderError| matches!(error, RenderError::AreaLight(_));
    assert!(light(refused(&|l| l.voxels.phi = 100)));
    assert!(light(refused(&|l| l.voxels.map = 100)));
    assert!(light(refused(&|l| l.lights[0].shape = AreaShape::Disc { radius_m: f64::NAN })));
    assert!(light(refused(&|l| l.lights[0].luminance[1] = -1.0)));
    assert!(light(refused(&|l| l.lights[0].position_world.x = f64::INFINITY)));
    assert!(light(refused(&|l| l.lights[0].up_world = l.lights[0].direction_world)));
}
