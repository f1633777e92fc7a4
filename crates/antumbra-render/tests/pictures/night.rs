//! Lamps: their light against closed forms, their shadows, and pictures at night.

use std::f64::consts::PI;

use antumbra::{Filter, Prefilter, ShadowFile, format::dag8};
use antumbra_render::{Picture, RenderError, RenderOptions, Renderer, ShadowSource, Time, light::LUX, look_at, render};
use antumbra_scene::{Light, LightKind, Material, Scene};
use glam::DVec3;

use crate::common::{SILENT, at, cluttered, from_above, level, options, picture, point_file, scene, sun, uniform_file};

/// A lamp that gives an irradiance of 1 (the sun's) at 1 m: bright enough to see by day, when nothing else depends on it.
fn lamp(kind: LightKind, position_world: DVec3, range_m: Option<f64>) -> Light {
    Light {
        name: "lamp".into(),
        kind,
        position_world,
        direction_world: DVec3::NEG_Y,
        color: [1.0; 3],
        intensity: 1.0 / LUX,
        range_m,
        dynamic: false,
    }
}

/// Ground, a sun, and a lamp.
fn lit_ground(lamp: Light) -> Scene {
    let ground = level([-50.0, 50.0], 0.0, [-50.0, 50.0], 0);
    let mut scene = scene(vec![ground], vec![Material::default()], sun(DVec3::new(0.0, -1.0, 0.3)));
    scene.lights.push(lamp);
    scene
}

/// One ray per pixel, through its middle.
fn by_day() -> RenderOptions {
    RenderOptions { time: Some(Time::Day), samples: 1, ..options() }
}

/// What the lamp alone adds to a picture by day, at a point of the ground.
fn added(scene: &Scene, shadows: ShadowSource<'_>) -> impl Fn(f64, f64) -> f64 + use<> {
    let mut without = scene.clone();
    without.lights.retain(|light| light.kind == LightKind::Directional);
    let (with, without) = (picture(scene, &by_day(), shadows), picture(&without, &by_day(), shadows));
    move |x, z| f64::from(at(&with, x, z)) - f64::from(at(&without, x, z))
}

/// Radiance towards the camera (10 m up) of white rough ground under a bare lamp at (0, 2, 0).
fn closed_form(x: f64, z: f64, window: f64) -> f64 {
    let point = DVec3::new(x, 0.0, z);
    let to_eye = DVec3::Y * 10.0 - point;
    let (l, v) = ((DVec3::Y * 2.0 - point).normalize(), to_eye.normalize());
    let irradiance = window / (x * x + z * z + 4.0) * l.y;
    // A roughness of 1 leaves of the microfacets' reflection only this.
    let fresnel = 0.04 + 0.96 * (1.0 - v.dot((v + l).normalize())).powi(5);
    let haze = (-3.9 * to_eye.length() / 3000.0).exp();
    irradiance * (1.0 / PI + fresnel / PI * 0.5 / (l.y + v.y)) * haze
}

/// Middles of pixels, along a line across the picture.
fn places() -> impl Iterator<Item = (f64, f64)> {
    (0..64).map(|i| (f64::from(i) / 8.0 - 3.9375, 0.8125))
}

#[test]
fn light_falls_off_as_the_closed_form_says() {
    for range in [None, Some(4.0)] {
        let added = added(&lit_ground(lamp(LightKind::Point, DVec3::Y * 2.0, range)), ShadowSource::None);
        for (x, z) in places() {
            let squared: f64 = x * x + z * z + 4.0;
            let window = range.map_or(1.0, |range: f64| (1.0 - (squared / range.powi(2)).powi(2)).max(0.0));
            let (got, expected) = (added(x, z), closed_form(x, z, window));
            assert!((got - expected).abs() < 0.01 * expected + 2e-5, "{x} {z}: {got} instead of {expected}");
        }
    }
}

#[test]
fn a_spot_ends_at_its_cones_edge() {
    let kind = LightKind::Spot { inner_angle: 0.5, outer_angle: 0.7 };
    let added = added(&lit_ground(lamp(kind, DVec3::Y * 2.0, None)), ShadowSource::None);
    for (x, z) in places() {
        let angle = (x.hypot(z) / 2.0).atan();
        let (got, full) = (added(x, z), closed_form(x, z, 1.0));
        // A pixel is up to 0.03 radians wide here.
        match angle {
            a if a < 0.47 => assert!((got / full - 1.0).abs() < 0.01, "{angle}: {got} of {full}"),
            a if a > 0.73 => assert_eq!(got, 0.0, "{angle}"),
            a if (0.53..0.67).contains(&a) => assert!(got > 0.0 && got < full, "{angle}: {got} of {full}"),
            _ => {}
        }
    }
}

/// A lamp at (-2, 2, 0) and a plate half way down to the ground, whose shadow is x -1 to 0, z -1 to 1.
fn plate_before_lamp(range_m: Option<f64>) -> Scene {
    let mut scene = lit_ground(lamp(LightKind::Point, DVec3::new(-2.0, 2.0, 0.0), range_m));
    scene.meshes[0].primitives.push(level([-1.5, -1.0], 1.0, [-0.5, 0.5], 0));
    scene
}

#[test]
fn a_lamps_shadow_falls_behind_what_stands_before_it() {
    let scene = plate_before_lamp(None);
    let (traced, open) = (added(&scene, ShadowSource::Traced), added(&scene, ShadowSource::None));
    for (x, _) in places().filter(|(x, _)| *x > -0.95 || *x < -1.8) {
        for z in [-2.0625_f64, -1.0625, -0.9375, 0.0625, 0.9375, 1.0625] {
            let shadowed = x > -1.0 && x < 0.0 && z.abs() < 1.0;
            let expected = if shadowed { 0.0 } else { open(x, z) };
            assert!((traced(x, z) - expected).abs() < 1e-6, "{x} {z}: {}", traced(x, z));
        }
    }
}

#[test]
fn casters_nearer_than_the_near_distance_are_ignored() {
    // A range of 1400 m has a near distance of 1.37 m; the plate lies 1 m under the lamp.
    let scene = plate_before_lamp(Some(1400.0));
    let (traced, open) = (added(&scene, ShadowSource::Traced), added(&scene, ShadowSource::None));
    assert!((traced(-0.5, 0.0) - open(-0.5, 0.0)).abs() < 1e-6 && open(-0.5, 0.0) > 0.01);
}

fn draw(scene: &Scene, shadows: ShadowSource<'_>) -> Result<Picture, RenderError> {
    render(scene, &from_above(), &by_day(), shadows, SILENT)
}

#[test]
fn baked_lamps_are_looked_up_by_name_and_face() {
    let position = DVec3::Y * 2.0;
    let scene = lit_ground(lamp(LightKind::Point, position, None));
    let filter = Filter::new_box(1).expect("odd");
    // Lit on the face that looks down and the one along +x: the ground is dark where another axis is the longest.
    let (lit, dark) = (dag8::LIT, dag8::SHADOWED);
    let file = point_file("lamp", position, [lit, dark, dark, lit, dark, dark]);
    let baked = draw(&scene, ShadowSource::Dag { shadows: &file, filter }).expect("a picture");
    let sunless = |scene: &Scene| {
        let mut scene = scene.clone();
        scene.lights[0].name = "not in the file".into();
        scene
    };
    // The file has no sun, which therefore is dark: so it is in the pictures to compare with.
    let none = point_file("lamp", position, [dark; 6]);
    let base = draw(&sunless(&scene), ShadowSource::Dag { shadows: &none, filter }).expect("a picture");
    // Lookups move off the ground by half a slice, which is coarse here: the faces meet a little nearer.
    for (x, z) in places().filter(|(x, _)| *x > -1.7 || *x < -2.0) {
        let lit = x > -1.7;
        let got = f64::from(at(&baked, x, z)) - f64::from(at(&base, x, z));
        let expected = if lit { closed_form(x, z, 1.0) } else { 0.0 };
        assert!((got - expected).abs() < 0.01 * expected + 2e-5, "{x} {z}: {got} instead of {expected}");
    }
}

#[test]
fn lights_that_a_bake_lacks_stay_dark_and_are_named() {
    let position = DVec3::Y * 2.0;
    let scene = lit_ground(lamp(LightKind::Point, position, None));
    let filter = Filter::new_box(1).expect("odd");
    let source = |file| ShadowSource::Dag { shadows: file, filter };
    let renderer = Renderer::new(&scene);
    let suns = uniform_file("sun", dag8::LIT);
    assert_eq!(renderer.left_dark(source(&suns)), ["lamp"]);
    assert_eq!(renderer.left_dark(ShadowSource::Traced), [""; 0]);
    let lampless = draw(&scene, source(&suns)).expect("a picture");
    let mut alone = scene.clone();
    alone.lights.truncate(1);
    assert_eq!(lampless, draw(&alone, ShadowSource::None).expect("a picture"));
    // A light of that name and another kind is another light.
    let misnamed = uniform_file("lamp", dag8::LIT);
    assert_eq!(renderer.left_dark(source(&misnamed)), ["sun", "lamp"]);
    let error = draw(&scene, source(&misnamed)).expect_err("none of the scene's lights");
    assert_eq!(error, RenderError::LightNotInFile { light: "sun".into(), present: "lamp".into() });
}

#[test]
fn prefiltered_lookups_answer_like_plain_ones_where_all_is_lit_or_dark() {
    let position = DVec3::Y * 2.0;
    let scene = lit_ground(lamp(LightKind::Point, position, None));
    let filter = Filter::new_box(5).expect("odd");
    for root in [dag8::LIT, dag8::SHADOWED] {
        let file: ShadowFile = point_file("lamp", position, [root; 6]);
        let plain = draw(&scene, ShadowSource::Dag { shadows: &file, filter }).expect("a picture");
        for how in [Prefilter::Mean, Prefilter::Levels(filter)] {
            let picture = draw(&scene, ShadowSource::Prefiltered { shadows: &file, how }).expect("a picture");
            assert_eq!(picture, plain);
        }
    }
}

/// A street's lamp: 2 m over the ground, reaching 3 m, in an artist's units.
fn street() -> Scene {
    let lamp = Light { intensity: 50.0, ..lamp(LightKind::Point, DVec3::Y * 2.0, Some(3.0)) };
    let mut scene = lit_ground(lamp);
    scene.lights.remove(0);
    scene
}

#[test]
fn at_night_it_is_light_only_near_the_lamp() {
    let picture = picture(&street(), &RenderOptions { ao_samples: 16, ..options() }, ShadowSource::Traced);
    let seen = |x: f64, z: f64| {
        let pixel = |c: f64| ((c + 4.0) * 8.0) as usize;
        picture.rgb()[3 * (pixel(z) * 64 + pixel(x)) + 1]
    };
    let (near, edge, far) = (seen(0.0, 0.0), seen(1.9, 0.0), seen(3.9, 3.9));
    assert!((110..252).contains(&near), "{near}");
    assert!(edge < near && edge > far, "{edge}");
    assert!((6..60).contains(&far), "neither lit nor lost: {far}");
}

#[test]
fn exposure_does_not_mind_units_or_what_glows() {
    let plain = picture(&street(), &options(), ShadowSource::Traced);
    let mut brighter = street();
    brighter.lights[0].intensity *= 1000.0;
    let brighter = picture(&brighter, &options(), ShadowSource::Traced);
    assert!((brighter.exposure() * 1000.0 / plain.exposure() - 1.0).abs() < 1e-3);
    let window = |emissive| {
        let mut scene = street();
        scene.materials.push(Material { emissive, ..Material::default() });
        scene.meshes[0].primitives.push(level([1.0, 3.0], 0.1, [1.0, 3.0], 1));
        picture(&scene, &options(), ShadowSource::Traced)
    };
    let (dark, glowing) = (window([0.0; 3]), window([1.0, 0.8, 0.4]));
    assert!((glowing.exposure() / dark.exposure() - 1.0).abs() < 1e-3);
    assert!(at(&glowing, 2.0, 2.0) > 10.0 * at(&dark, 2.0, 2.0));
}

#[test]
fn night_suits_lamps_and_moons() {
    let light = |kind, intensity| Light { intensity, ..lamp(kind, DVec3::Y, None) };
    let (moon, sun) = (light(LightKind::Directional, 0.25), light(LightKind::Directional, 5000.0));
    let street_lamp = light(LightKind::Point, 100.0);
    for (lights, time) in [
        (vec![], Time::Day),
        (vec![&sun], Time::Day),
        // A lone light is the sun, whatever its lux.
        (vec![&moon], Time::Day),
        (vec![&sun, &street_lamp], Time::Day),
        (vec![&moon, &street_lamp], Time::Night),
        (vec![&street_lamp], Time::Night),
    ] {
        assert_eq!(Time::suiting(lights.iter().copied()), time);
    }
}

#[test]
fn a_moon_shines_at_night_and_a_sun_does_not() {
    let with = |lux: f32| {
        let mut scene = street();
        scene.lights.push(Light { intensity: lux, ..sun(DVec3::new(0.2, -1.0, 0.0)) });
        picture(&scene, &RenderOptions { time: Some(Time::Night), ..options() }, ShadowSource::Traced)
    };
    let (sun, moon) = (with(50_000.0), with(0.25));
    let dark = picture(&street(), &options(), ShadowSource::Traced);
    assert_eq!(sun.hdr(), dark.hdr());
    assert!(at(&moon, 3.5, 3.5) > 1.2 * at(&dark, 3.5, 3.5));
}

#[test]
fn threads_change_nothing_at_night() {
    let mut scene = cluttered();
    scene.lights.clear();
    for i in 0..30_u8 {
        let place = DVec3::new(f64::from(i % 6) - 2.5, 1.5, f64::from(i / 6) - 2.0);
        let color = [1.0, f32::from(i % 3) * 0.5, 0.3];
        scene.lights.push(Light { color, name: format!("lamp {i}"), ..lamp(LightKind::Point, place, Some(2.0)) });
    }
    let draw = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| picture(&scene, &RenderOptions { ao_samples: 8, ..options() }, ShadowSource::Traced))
    };
    let one = draw(1);
    assert_eq!(one, draw(2));
    assert!(one.hdr().iter().flatten().all(|c| c.is_finite() && *c >= 0.0));
}

#[test]
fn a_dark_scene_and_an_empty_one_have_pictures_at_night() {
    let night = RenderOptions { time: Some(Time::Night), ao_samples: 4, ..options() };
    let mut unlit = cluttered();
    unlit.lights.clear();
    for scene in [unlit, Scene::default()] {
        let camera = look_at(DVec3::Y * 3.0, DVec3::new(0.0, 3.5, -9.0), 1.0).expect("a camera");
        let picture = render(&scene, &camera, &night, ShadowSource::Traced, SILENT).expect("a picture");
        assert!(picture.hdr().iter().flatten().all(|c| c.is_finite() && *c >= 0.0));
        let sky = &picture.rgb()[..3];
        assert!(sky[2] > sky[0] && sky[2] < 120, "{sky:?}");
    }
}
