//! What tests over the whole of Antumbra share: scenes with their bakes, and the graphics card.

pub mod query;

use antumbra::{LightShadow, ShadowFile};
use antumbra_bake::light_space::Resolution;
use antumbra_bake::{BakeOptions, Encoding, ResolutionRequest, Silent, bake};
use antumbra_render::gpu::Gpu;
use antumbra_scene::procedural::{self, Options};
use antumbra_scene::{Light, LightKind, Scene};
use glam::UVec3;

/// The graphics card. Tests of what runs there need one: a software one will do.
///
/// # Panics
/// When there is none, saying what to install.
#[must_use]
pub fn gpu() -> Gpu {
    Gpu::open().unwrap_or_else(|error| panic!("{error}"))
}

/// A procedural scene, small enough for tests.
///
/// # Panics
/// When no scene has that name.
#[must_use]
pub fn procedural(name: &str, scale: f64) -> Scene {
    procedural::build(name, &Options { scale, ..Options::default() }).expect("a scene of that name")
}

/// A bake of lights of a scene with everything a lookup may ask for: coarse levels and enter depths, too.
///
/// # Panics
/// When the bake fails.
#[must_use]
pub fn baked(scene: &Scene, lights: &[Light], resolution: u32, encoding: Encoding) -> ShadowFile {
    let resolution = ResolutionRequest::Texels(Resolution::new(resolution).expect("a power of two"));
    let options = BakeOptions {
        resolution,
        levels: true,
        enter_depths: true,
        encoding: Some(encoding),
        ..BakeOptions::default()
    };
    let baked = bake(scene, lights, &options, &Silent).expect("a bake");
    ShadowFile::from_bytes(&baked.bytes).expect("a valid file")
}

/// The first lights of each kind of a scene, at most so many directional, spot and point lights.
#[must_use]
pub fn first_lights(scene: &Scene, [suns, spots, points]: [usize; 3]) -> Vec<Light> {
    let mut left = [suns, spots, points];
    let kind = |light: &Light| match light.kind {
        LightKind::Directional => 0,
        LightKind::Spot { .. } => 1,
        LightKind::Point => 2,
    };
    let mut take = |light: &&Light| {
        let left = &mut left[kind(light)];
        *left > 0 && {
            *left -= 1;
            true
        }
    };
    scene.lights.iter().filter(|light| take(light)).cloned().collect()
}

/// A small generator of numbers that look random, the same on every run.
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    /// Any 32 bits (Steele, Lea, Flood 2014, "Fast Splittable Pseudorandom Number Generators").
    pub fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 32) as u32
    }

    /// Less than a number.
    pub fn below(&mut self, end: u32) -> u32 {
        self.bits() % end.max(1)
    }

    /// From 0 to 1.
    pub fn unit(&mut self) -> f64 {
        f64::from(self.bits()) / f64::from(u32::MAX)
    }
}

/// A voxel that often lies where something is: near a transition along its ray.
#[must_use]
pub fn voxel(random: &mut Random, light: LightShadow<'_>, face: usize) -> UVec3 {
    let side = light.record().resolution();
    let [x, y] = [random.below(side), random.below(side)];
    let is_lit = |z: u32| light.is_lit(face, [x, y, z]);
    if random.below(4) == 0 || is_lit(side - 1) {
        return UVec3::new(x, y, random.below(side));
    }
    // The first shadowed slice: rays are lit up to some slice and shadowed from there on.
    let (mut lit, mut dark) = (0, side - 1);
    while dark - lit > 1 {
        let middle = lit.midpoint(dark);
        if is_lit(middle) { lit = middle } else { dark = middle }
    }
    UVec3::new(x, y, (dark + random.below(9)).saturating_sub(4).min(side - 1))
}
