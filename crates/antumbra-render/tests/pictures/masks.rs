//! Alpha masks: the renderer asks the scene's one rule.

use antumbra_render::{AlphaMasks, Ray, ShadowSource, Tracer};
use antumbra_scene::{AlphaMode, AlphaTest, Image, Material, Primitive, Scene, TextureRef, Wrap};
use glam::DVec3;

use crate::common::{at, level, options, picture, scene, sun};

/// A plate of 2 x 2 m at the height of 1 m, masked by a texture whose alpha falls from left to right, over ground.
fn masked_plate(plate: impl FnOnce(Primitive) -> Primitive, texture: bool) -> Scene {
    let identity = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let reference = TextureRef { image: 0, wrap_s: Wrap::Clamp, wrap_t: Wrap::Clamp, transform: identity };
    let mask = Material {
        alpha_mode: AlphaMode::Mask,
        base_color: [1.0, 1.0, 1.0, 0.4],
        base_color_texture: texture.then_some(reference),
        alpha_cutoff: 0.2,
        ..Material::default()
    };
    let plates = vec![level([-50.0, 50.0], 0.0, [-50.0, 50.0], 0), plate(level([-1.0, 1.0], 1.0, [-1.0, 1.0], 1))];
    let mut scene = scene(plates, vec![Material::default(), mask], sun(DVec3::new(0.1, -1.0, 0.0)));
    let rgba = [255, 170, 85, 0].iter().flat_map(|&a| [255, 255, 255, a]).collect();
    scene.images.push(Image { name: "slope".into(), width: 4, height: 1, rgba });
    scene
}

/// Whether the plate is there, at a place along x.
fn there(scene: &Scene, x: f64) -> bool {
    let tracer = Tracer::new(scene, |_, _| true);
    let masks = AlphaMasks::new(scene);
    let ray = Ray::new(DVec3::new(x, 0.5, 0.3), DVec3::Y);
    tracer.occluded_if(&ray, |hit| masks.keeps(&tracer, hit))
}

#[test]
fn a_mask_is_what_the_scenes_rule_says() {
    let scene = masked_plate(|plate| plate, true);
    let test = AlphaTest::new(&scene, &scene.meshes[0].primitives[1]).expect("a test");
    for i in 0..200 {
        let x = f64::from(i) * 0.01 - 0.995;
        assert_eq!(there(&scene, x), test.keeps([(x + 1.0) * 0.5, 0.35], 1.0), "{x}");
    }
    assert!(there(&scene, -0.9) && !there(&scene, 0.9));
}

#[test]
fn vertex_alpha_counts() {
    let clear_on_the_left = |plate: Primitive| Primitive {
        colors: [0.0, 1.0, 1.0, 0.0].map(|alpha| [1.0, 1.0, 1.0, alpha]).to_vec(),
        ..plate
    };
    let scene = masked_plate(clear_on_the_left, true);
    let test = AlphaTest::new(&scene, &scene.meshes[0].primitives[1]).expect("a test");
    for i in 0..200 {
        let u = (f64::from(i) + 0.5) / 200.0;
        assert_eq!(there(&scene, 2.0 * u - 1.0), test.keeps([u, 0.35], u), "{u}");
    }
    assert!(!there(&scene, -0.9));
}

#[test]
fn a_mask_without_a_texture_is_opaque() {
    let mut scene = masked_plate(|plate| plate, false);
    // Below the cutoff, which only a texture's alpha is held against.
    scene.materials[1].base_color = [0.0, 0.0, 0.0, 0.1];
    assert!((0..10).all(|i| there(&scene, f64::from(i) * 0.2 - 0.9)));
    let picture = picture(&scene, &options(), ShadowSource::Traced);
    assert!(at(&picture, 0.0, 0.0) < 0.2 * at(&picture, 3.0, 0.0), "the black plate is seen");
}

#[test]
fn what_is_not_masked_is_there() {
    let mut scene = masked_plate(|plate| plate, true);
    for mode in [AlphaMode::Opaque, AlphaMode::Blend] {
        scene.materials[1].alpha_mode = mode;
        assert!(there(&scene, 0.9));
    }
}
