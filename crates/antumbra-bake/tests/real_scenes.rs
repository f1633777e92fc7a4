//! The builder against the oracle on real scenes, where they are at hand, and on the procedural ones.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod common;

use antumbra::Interior;
use antumbra_bake::{BakeOptions, Encoding};
use antumbra_scene::{Scene, procedural};
use common::{bake_for_check, check_all, check_texels, options, shared_scenes, sun};

const ENCODINGS: [Encoding; 2] = [Encoding::Dag8, Encoding::Silhouette];

/// Small generated scenes always; real ones where the folder is there.
fn scenes() -> Vec<Scene> {
    let small =
        |name, scale| procedural::build(name, &procedural::Options { seed: 3, scale, ..Default::default() }).unwrap();
    let real = shared_scenes().into_iter().map(|path| antumbra_scene::load(&path).unwrap());
    [small("city", 0.2), small("landscape", 0.1)].into_iter().chain(real).collect()
}

fn light(scene: &Scene) -> antumbra_scene::Light {
    let own = scene.lights.iter().find(|l| l.kind == antumbra_scene::LightKind::Directional);
    own.cloned().map_or_else(|| sun([0.4, -0.8, 0.3]), |l| antumbra_scene::Light { name: "sun".into(), ..l })
}

#[test]
fn every_texel_at_512() {
    for scene in scenes() {
        for interior in [Interior::Open, Interior::Auto] {
            for encoding in ENCODINGS {
                let options = BakeOptions { encoding: Some(encoding), ..options(interior, 512, 0) };
                let checked = bake_for_check(&scene, &light(&scene), &options);
                check_all(&checked).unwrap_or_else(|e| panic!("{} {interior:?} {encoding:?}: {e}", scene.name));
            }
        }
    }
}

#[test]
fn every_texel_under_an_upright_sun() {
    for scene in scenes() {
        let checked = bake_for_check(&scene, &sun([0.0, -1.0, 0.0]), &options(Interior::Auto, 256, 0));
        check_all(&checked).unwrap_or_else(|e| panic!("{}: {e}", scene.name));
    }
}

#[test]
fn a_million_random_texels_at_16384() {
    for scene in scenes() {
        check_random_texels(&scene, &options(Interior::Auto, 16384, 0));
    }
}

#[test]
fn random_texels_of_silhouettes_at_4096() {
    for scene in scenes() {
        let encoding = Encoding::Silhouette;
        check_random_texels(&scene, &BakeOptions { encoding: Some(encoding), ..options(Interior::Auto, 4096, 0) });
    }
}

fn check_random_texels(scene: &Scene, options: &BakeOptions) {
    let checked = bake_for_check(scene, &light(scene), options);
    let last = checked.resolution().texels() - 1;
    let texels = || {
        (0..1_000_000).scan(0x9e37_79b9_7f4a_7c15u64, move |state, _| {
            *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            Some([(*state >> 33) as u32 & last, (*state >> 49) as u32 & last])
        })
    };
    check_texels(&checked, texels).unwrap_or_else(|e| panic!("{} {:?}: {e}", scene.name, options.encoding));
}

/// Answers that are right can still take more bytes than they need: a lost bit of slack shows here alone. After a change
/// of the scene that is meant, put the new figure in.
#[test]
fn a_small_city_takes_no_more_bytes_than_it_did() {
    const BYTES: usize = 2_013_248;
    let options_of_scene = procedural::Options { seed: 3, scale: 0.2, ..Default::default() };
    let scene = procedural::build("city", &options_of_scene).unwrap();
    let bytes = bake_for_check(&scene, &light(&scene), &options(Interior::Auto, 4096, 0)).bytes.len();
    assert!(bytes <= BYTES, "{bytes} bytes instead of {BYTES}");
}
