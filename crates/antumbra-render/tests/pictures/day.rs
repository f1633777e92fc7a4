//! Daylight: a sun and its sky.

use antumbra::{Filter, ShadowFile, format};
use antumbra_render::{RenderError, RenderOptions, Renderer, ShadowSource, default_camera, look_at, render};
use antumbra_scene::{AlphaMode, Camera, Image, Material, Scene, TextureRef, Wrap};
use glam::DVec3;

use crate::common::{SILENT, at, cluttered, from_above, level, options, picture, quad, scene, sun, uniform_file};

#[test]
fn a_shadow_falls_where_the_sun_throws_it() {
    // A plate of 1 x 1 m, 3 m up, under light that travels (1, -1, 0): its shadow is 3 m towards +x, beside the plate.
    let plate = level([-0.5, 0.5], 3.0, [-0.5, 0.5], 0);
    let scene = scene(
        vec![level([-50.0, 50.0], 0.0, [-50.0, 50.0], 0), plate],
        vec![Material::default()],
        sun(DVec3::new(1.0, -1.0, 0.0)),
    );
    let with = picture(&scene, &options(), ShadowSource::Traced);
    let without = picture(&scene, &options(), ShadowSource::None);
    for i in 0..64 {
        let z = f64::from(i) / 8.0 - 3.9375;
        for x in [1.5, 2.4375, 2.5625, 3.0625, 3.4375, 3.5625] {
            let shadowed = z.abs() < 0.5 && x > 2.5 && x < 3.5;
            let (lit, seen) = (at(&without, x, z), at(&with, x, z));
            assert_eq!(seen < 0.5 * lit, shadowed, "x {x} z {z}: {seen} of {lit}");
            assert!(shadowed || seen == lit);
        }
    }
}

#[test]
fn a_cut_out_texture_lets_light_and_sight_through() {
    // The same plate, its texture's right half cut out: only the left half of the shadow is left.
    let texture = TextureRef {
        image: 0,
        wrap_s: Wrap::Clamp,
        wrap_t: Wrap::Clamp,
        transform: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    };
    let leaf = Material { alpha_mode: AlphaMode::Mask, base_color_texture: Some(texture), ..Material::default() };
    let mut scene = scene(
        vec![level([-50.0, 50.0], 0.0, [-50.0, 50.0], 0), level([-0.5, 0.5], 3.0, [-0.5, 0.5], 1)],
        vec![Material::default(), leaf],
        sun(DVec3::new(1.0, -1.0, 0.0)),
    );
    let rgba = vec![255, 255, 255, 255, 255, 255, 255, 0];
    scene.images.push(Image { name: "half".into(), width: 2, height: 1, rgba });
    let picture = picture(&scene, &options(), ShadowSource::Traced);
    assert!(at(&picture, 2.75, 0.0) < 0.5 * at(&picture, 3.25, 0.0));
    // Haze is a little thinner right below the camera.
    assert!((at(&picture, 3.25, 0.0) / at(&picture, 1.5, 0.0) - 1.0).abs() < 1e-3);
}

#[test]
fn the_foot_of_a_wall_sees_half_the_sky() {
    // A black wall along z, 400 m high and long, and light from below, so that there is nothing but the sky. The wall
    // stands along the sun's azimuth: the sky is the same on either side.
    let black = Material { base_color: [0.0, 0.0, 0.0, 1.0], ..Material::default() };
    let x = 0.01; // Just beside the eye, which is above x = 0.
    let wall = quad([[x, 0.0, -400.0], [x, 0.0, 400.0], [x, 400.0, 400.0], [x, 400.0, -400.0]], 1);
    let ground = level([-1000.0, 1000.0], 0.0, [-1000.0, 1000.0], 0);
    let materials = vec![Material::default(), black];
    let open = scene(vec![ground.clone()], materials.clone(), sun(DVec3::new(0.0, 1.0, 0.05)));
    let walled = scene(vec![ground, wall], materials, sun(DVec3::new(0.0, 1.0, 0.05)));
    let options = RenderOptions { ao_samples: 256, ..options() };
    let (open, walled) =
        (picture(&open, &options, ShadowSource::Traced), picture(&walled, &options, ShadowSource::Traced));
    for z in [-2.0, 0.0, 2.0] {
        let ratio = at(&walled, -0.5, z) / at(&open, -0.5, z);
        assert!((0.46..0.54).contains(&ratio), "{ratio}");
    }
}

#[test]
fn an_open_box_is_darker_inside_and_darkest_in_its_corners() {
    let wall = |a: [f32; 2], b: [f32; 2]| {
        quad([[a[0], 0.0, a[1]], [b[0], 0.0, b[1]], [b[0], 3.0, b[1]], [a[0], 3.0, a[1]]], 0)
    };
    let corners = [[-2.0, -2.0], [2.0, -2.0], [2.0, 2.0], [-2.0, 2.0]];
    let mut primitives = vec![level([-50.0, 50.0], 0.0, [-50.0, 50.0], 0)];
    primitives.extend((0..4).map(|i| wall(corners[i], corners[(i + 1) % 4])));
    let scene = scene(primitives, vec![Material::default()], sun(DVec3::new(0.0, 1.0, 0.05)));
    let picture = picture(&scene, &RenderOptions { ao_samples: 64, ..options() }, ShadowSource::Traced);
    let (outside, middle, corner) = (at(&picture, 3.9, 3.9), at(&picture, 0.0, 0.0), at(&picture, 1.7, 1.7));
    assert!(middle < 0.8 * outside && corner < 0.8 * middle, "{outside} {middle} {corner}");
}

#[test]
fn threads_change_nothing() {
    let scene = cluttered();
    let draw = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| picture(&scene, &RenderOptions { ao_samples: 8, ..options() }, ShadowSource::Traced))
    };
    assert_eq!(draw(1), draw(2));
}

#[test]
fn baked_shadows_are_looked_up_by_the_lights_name() {
    let scene = cluttered();
    let filter = Filter::new_tent(3).expect("odd");
    let draw = |file: &ShadowFile| {
        render(&scene, &from_above(), &options(), ShadowSource::Dag { shadows: file, filter }, SILENT)
    };
    let lit = draw(&uniform_file("sun", format::dag8::LIT)).expect("a picture");
    assert_eq!(lit, picture(&scene, &options(), ShadowSource::None));
    let dark = draw(&uniform_file("sun", format::dag8::SHADOWED)).expect("a picture");
    assert!(at(&dark, 0.0, 0.0) < 0.3 * at(&lit, 0.0, 0.0));
    let error = draw(&uniform_file("moon", format::dag8::LIT)).expect_err("the file has another light");
    assert_eq!(error, RenderError::LightNotInFile { light: "sun".into(), present: "moon".into() });
}

#[test]
fn senseless_wishes_are_refused() {
    let scene = cluttered();
    let renderer = Renderer::new(&scene);
    let refused = |camera: &Camera, options: RenderOptions| {
        renderer.render(camera, &options, ShadowSource::None, SILENT).expect_err("an error")
    };
    let camera = from_above();
    for (width, height) in [(0, 9), (9, 0), (16385, 1), (16384, 16384)] {
        assert_eq!(refused(&camera, RenderOptions { width, height, ..options() }), RenderError::Size { width, height });
    }
    assert!(matches!(refused(&camera, RenderOptions { samples: 0, ..options() }), RenderError::Samples { .. }));
    let blinding = RenderOptions { exposure: Some(f32::NAN), ..options() };
    assert!(matches!(refused(&camera, blinding), RenderError::Exposure(_)));
    for fov_y in [0.0, -1.0, 4.0, f64::NAN] {
        let flat = Camera { fov_y, ..camera.clone() };
        assert!(matches!(refused(&flat, options()), RenderError::FieldOfView { .. }));
    }
    for bad in [
        Camera { eye_world: DVec3::NAN, ..camera.clone() },
        Camera { forward_world: DVec3::ZERO, ..camera.clone() },
        Camera { up_world: camera.forward_world, ..camera.clone() },
    ] {
        assert!(matches!(refused(&bad, options()), RenderError::Camera(_)));
    }
    assert!(look_at(DVec3::ONE, DVec3::ONE, 1.0).is_err());
}

#[test]
fn scenes_without_a_camera_or_a_light_are_drawn() {
    let mut scene = cluttered();
    scene.lights.clear();
    let camera = default_camera(&scene).expect("a camera");
    let picture = render(&scene, &camera, &options(), ShadowSource::Traced, SILENT).expect("a picture");
    assert!(picture.hdr().iter().flatten().all(|c| c.is_finite() && *c >= 0.0));
    assert_eq!(default_camera(&Scene::default()).expect_err("nothing there"), RenderError::EmptyScene);
}

#[test]
fn an_empty_scene_is_all_sky() {
    let empty = Scene::default();
    let camera = look_at(DVec3::ZERO, DVec3::new(0.0, 1.0, -1.0), 1.0).expect("a camera");
    let picture = render(&empty, &camera, &options(), ShadowSource::Traced, SILENT).expect("a picture");
    assert!(picture.hdr().iter().all(|c| c[2] > c[0] && c[0] > 0.0), "blue everywhere");
}

#[test]
fn png_comes_back_as_it_went() {
    let picture = picture(&cluttered(), &options(), ShadowSource::Traced);
    let bytes = picture.to_png().expect("bytes");
    let read = image::load_from_memory(&bytes).expect("a PNG").to_rgb8();
    assert_eq!((read.width(), read.height()), (picture.width(), picture.height()));
    assert_eq!(read.as_raw(), picture.rgb());
}

#[test]
fn progress_ends_at_the_total() {
    let last = std::sync::Mutex::new((0, 0));
    let note = |done: usize, total: usize| {
        let mut last = last.lock().expect("no panics");
        *last = (last.0.max(done), total);
    };
    let options = RenderOptions { ao_samples: 4, ..options() };
    render(&cluttered(), &from_above(), &options, ShadowSource::None, &note).expect("a picture");
    assert_eq!(*last.lock().expect("no panics"), (128, 128));
}
