//! Random points: each depends on the seed, its kind and its index alone, so that threads do not show.

use antumbra_render::{Tracer, TriangleId};
use antumbra_scene::Bounds;
use glam::DVec3;

use super::Kind;

/// How far points in the air lie outside the casters' box, in parts of its diagonal.
const MARGIN: f64 = 0.02;

/// A point to compare at.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    pub point_world: DVec3,
    /// The triangle that it lies on.
    pub triangle: Option<TriangleId>,
}

/// Draws points.
pub struct Sampler<'a> {
    tracer: &'a Tracer,
    bounds: Bounds,
    /// For each triangle, the area of all triangles up to and with it.
    areas: Vec<f64>,
}

impl<'a> Sampler<'a> {
    pub fn new(tracer: &'a Tracer) -> Self {
        let mut bounds = tracer.bounds();
        let margin = bounds.diagonal() * MARGIN;
        bounds.min -= margin;
        bounds.max += margin;
        let mut sum = 0.0;
        let areas = (0..tracer.triangle_count()).map(|i| {
            sum += area(tracer.corners(TriangleId(i as u32)));
            sum
        });
        Self { tracer, bounds, areas: areas.collect() }
    }

    pub fn sample(&self, seed: u64, kind: Kind, index: u64) -> Sample {
        let mut random = Random::new(seed, kind, index);
        match kind {
            Kind::Air => {
                let share = DVec3::new(random.unit(), random.unit(), random.unit());
                let point_world = self.bounds.min + (self.bounds.max - self.bounds.min) * share;
                Sample { point_world, triangle: None }
            }
            Kind::Surface | Kind::OffSurface => self.on_surface(&mut random),
        }
    }

    fn on_surface(&self, random: &mut Random) -> Sample {
        let wanted = random.unit() * self.areas.last().copied().unwrap_or(0.0);
        let index = self.areas.partition_point(|&sum| sum <= wanted).min(self.areas.len() - 1);
        let triangle = TriangleId(index as u32);
        let [a, b, c] = self.tracer.corners(triangle);
        let (mut u, mut v) = (random.unit(), random.unit());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        Sample { point_world: a + (b - a) * u + (c - a) * v, triangle: Some(triangle) }
    }
}

/// Zero where it is beyond numbers, so that sums stay sound.
fn area([a, b, c]: [DVec3; 3]) -> f64 {
    let area = (b - a).cross(c - a).length();
    if area.is_finite() { area } else { 0.0 }
}

/// SplitMix64 (Steele, Lea, Flood 2014, "Fast splittable pseudorandom number generators"), begun at a place of its own
/// for each point.
pub struct Random {
    state: u64,
}

impl Random {
    pub fn new(seed: u64, kind: Kind, index: u64) -> Self {
        let stream = [seed, u64::from(kind == Kind::Air), index].into_iter().fold(0, |state, part| mix(state ^ part));
        Self { state: stream }
    }

    /// 0 to less than 1.
    pub fn unit(&mut self) -> f64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        (mix(self.state) >> 11) as f64 / (1u64 << 53) as f64
    }
}

fn mix(z: u64) -> u64 {
    let z = z.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}
