//! Random points: each depends on the seed, its kind and its index alone, so that threads do not show.

use antumbra_render::{Tracer, TriangleId};
use antumbra_scene::Bounds;
use glam::DVec3;

use super::Kind;
use super::ground::Sight;

/// How far points in the air lie outside the casters' box, in parts of its diagonal.
const MARGIN: f64 = 0.02;
/// Draws before a point is given up: of a local light, whose reach a large triangle may leave.
const MOST_DRAWS: u32 = 64;
/// Of a spot light's points outside its cone one in so many is taken.
const OUTSIDE_CONE: f64 = 1.0 / 8.0;

/// A point to compare at.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    pub point_world: DVec3,
    /// The triangle that it lies on.
    pub triangle: Option<TriangleId>,
}

/// Draws points that a light may reach.
pub struct Sampler<'a> {
    sight: &'a Sight<'a>,
    bounds: Bounds,
    /// Triangles that the light may reach; all of them if there is no list.
    triangles: Vec<TriangleId>,
    /// For each of those, the area of all up to and with it.
    areas: Vec<f64>,
}

impl<'a> Sampler<'a> {
    pub fn new(sight: &'a Sight<'a>) -> Self {
        let tracer = sight.ground().tracer();
        let mut bounds = tracer.bounds();
        let margin = bounds.diagonal() * MARGIN;
        bounds.min -= margin;
        bounds.max += margin;
        if let Some([min, max]) = sight.reach() {
            bounds = Bounds { min: bounds.min.max(min), max: bounds.max.min(max) };
        }
        let touches = |id: &TriangleId| {
            let corners = tracer.corners(*id);
            let (min, max) = (corners[0].min(corners[1]).min(corners[2]), corners[0].max(corners[1]).max(corners[2]));
            min.cmple(bounds.max).all() && bounds.min.cmple(max).all()
        };
        let triangles: Vec<TriangleId> = (0..tracer.triangle_count() as u32).map(TriangleId).filter(touches).collect();
        let mut sum = 0.0;
        let areas = triangles.iter().map(|id| {
            sum += area(tracer.corners(*id));
            sum
        });
        Self { sight, bounds, areas: areas.collect(), triangles }
    }

    /// `None` where no draw came out within the light's reach.
    pub fn sample(&self, seed: u64, kind: Kind, index: u64) -> Option<Sample> {
        let mut random = Random::new(seed, kind, index);
        let draw = |_| {
            let sample = match kind {
                Kind::Air if self.bounds.is_empty() => return None,
                Kind::Air => {
                    let share = DVec3::new(random.unit(), random.unit(), random.unit());
                    let point_world = self.bounds.min + (self.bounds.max - self.bounds.min) * share;
                    Sample { point_world, triangle: None }
                }
                Kind::Surface | Kind::OffSurface => self.on_surface(&mut random)?,
            };
            let cone = self.sight.is_in_cone(sample.point_world) || random.unit() < OUTSIDE_CONE;
            (cone && self.sight.is_in_range(sample.point_world)).then_some(sample)
        };
        (0..MOST_DRAWS).find_map(draw)
    }

    fn on_surface(&self, random: &mut Random) -> Option<Sample> {
        let wanted = random.unit() * self.areas.last().copied()?;
        let index = self.areas.partition_point(|&sum| sum <= wanted).min(self.areas.len() - 1);
        let triangle = self.triangles[index];
        let [a, b, c] = self.tracer().corners(triangle);
        let (mut u, mut v) = (random.unit(), random.unit());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        Some(Sample { point_world: a + (b - a) * u + (c - a) * v, triangle: Some(triangle) })
    }

    fn tracer(&self) -> &'a Tracer {
        self.sight.ground().tracer()
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
