//! Stepped bakes: the bytes of ordinary ones, in many steps, one after the other, and cancelled.
#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

use std::sync::Arc;
use std::time::Duration;

use antumbra::Interior;
use antumbra_bake::light_space::Resolution;
use antumbra_bake::{BakeError, BakeOptions, Encoding, ResolutionRequest, Silent, Step, SteppedBaker, bake};
use antumbra_scene::procedural::{self, Options};
use antumbra_scene::{Light, Scene};

fn village() -> Arc<Scene> {
    Arc::new(procedural::build("village", &Options::default()).unwrap())
}

const ENCODINGS: [Encoding; 2] = [Encoding::Dag8, Encoding::Silhouette];

fn options(resolution: u32) -> BakeOptions {
    options_in(Encoding::Dag8, resolution)
}

fn options_in(encoding: Encoding, resolution: u32) -> BakeOptions {
    BakeOptions {
        resolution: ResolutionRequest::Texels(Resolution::new(resolution).unwrap()),
        levels: encoding == Encoding::Dag8,
        enter_depths: true,
        encoding: Some(encoding),
        ..BakeOptions::default()
    }
}

/// Steps until the bake is done; the bytes, and how many steps it took.
fn finish(baker: &mut SteppedBaker, budget: Duration) -> (Vec<u8>, usize) {
    for steps in 1.. {
        match baker.step(budget) {
            Step::Done(baked) => return (baked.unwrap().bytes, steps),
            Step::Working { share, .. } => assert!((0.0..=1.0).contains(&share)),
            Step::Idle => panic!("idle after {steps} steps"),
        }
    }
    unreachable!()
}

#[test]
fn steps_give_the_bytes_of_one_bake() {
    let scene = village();
    let interiors = [Interior::Auto, Interior::Open, Interior::Static(0.05)];
    for (encoding, interior) in
        ENCODINGS.into_iter().flat_map(|encoding| interiors.map(|interior| (encoding, interior)))
    {
        let options = BakeOptions { interior, ..options_in(encoding, 1024) };
        let mut lights = scene.lights.clone();
        lights.truncate(6);
        let whole = bake(&scene, &lights, &options, &Silent).unwrap().bytes;
        let mut baker = SteppedBaker::new(Arc::clone(&scene), options).unwrap();
        assert!(matches!(baker.step(Duration::from_millis(1)), Step::Idle));
        // Rests at every place where it may.
        baker.start(lights.clone());
        let (bytes, steps) = finish(&mut baker, Duration::ZERO);
        assert!(bytes == whole && steps > 100, "{encoding:?}, {interior:?}: {steps} steps");
        // In one step, on the same thread, once more.
        baker.start(lights);
        let (bytes, steps) = finish(&mut baker, Duration::from_secs(3600));
        assert!(bytes == whole && steps == 1, "{encoding:?}, {interior:?}: {steps} steps");
        assert!(matches!(baker.step(Duration::from_millis(1)), Step::Idle));
    }
}

#[test]
fn cancelled_bakes_leave_nothing_behind() {
    ENCODINGS.into_iter().for_each(cancelled_bakes_leave_nothing_behind_in);
}

fn cancelled_bakes_leave_nothing_behind_in(encoding: Encoding) {
    let scene = village();
    let options = options_in(encoding, 1024);
    let suns: Vec<Light> = scene.lights.iter().take(2).cloned().collect();
    let wholes: Vec<Vec<u8>> =
        suns.iter().map(|sun| bake(&scene, std::slice::from_ref(sun), &options, &Silent).unwrap().bytes).collect();
    let mut baker = SteppedBaker::new(Arc::clone(&scene), options).unwrap();
    // Cancelled at many places: by the next start, by name, and by being dropped.
    for (steps, i) in [0, 1, 3, 10, 40, 100, 200].into_iter().zip([0, 1].into_iter().cycle()) {
        baker.start(vec![suns[1 - i].clone()]);
        (0..steps).for_each(|_| _ = baker.step(Duration::ZERO));
        if steps % 3 == 1 {
            baker.cancel();
            assert!(matches!(baker.step(Duration::ZERO), Step::Idle));
        }
        baker.start(vec![suns[i].clone()]);
        assert!(finish(&mut baker, Duration::from_millis(1)).0 == wholes[i], "after {steps} steps");
    }
    baker.start(vec![suns[0].clone()]);
    (0..20).for_each(|_| _ = baker.step(Duration::ZERO));
    drop(baker);
}

#[test]
fn what_is_wrong_is_said() {
    let scene = village();
    let mut baker = SteppedBaker::new(Arc::clone(&scene), options(256)).unwrap();
    baker.start(Vec::new());
    assert!(matches!(baker.step(Duration::from_secs(1)), Step::Done(Err(BakeError::NoLights))));
    let error = SteppedBaker::new(Arc::new(Scene::default()), options(256)).err();
    assert_eq!(error, Some(BakeError::NoCasters));
    // A limit that does not suffice.
    for encoding in ENCODINGS {
        let tight = BakeOptions { memory_limit: Some(1 << 16), interior: Interior::Open, ..options_in(encoding, 1024) };
        let mut baker = SteppedBaker::new(Arc::clone(&scene), tight).unwrap();
        baker.start(scene.lights[..1].to_vec());
        assert!(
            matches!(baker.step(Duration::from_secs(60)), Step::Done(Err(BakeError::Memory { .. }))),
            "{encoding:?}"
        );
    }
}
