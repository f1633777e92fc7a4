//! Random points: each depends on the seed, its kind and its index alone, so that threads do not show.
//!
//! A directional light's lie all over the scene. A local light's lie where it matters: within its range and its cone, but
//! for a few beside the cone.

use antumbra_render::{Tracer, TriangleId};
use antumbra_scene::Bounds;
use glam::DVec3;

use super::Kind;
use super::beam::{Beam, Lamp};

/// How far points in the air lie outside the casters' box, in parts of its diagonal.
const MARGIN: f64 = 0.02;
/// Share of the points outside a spot light's cone that are taken.
const OUTSIDE_CONE_TAKEN: f64 = 0.1;
/// Points that are drawn where a local light may reach, before one is looked for along its rays.
const TRIES: usize = 24;

/// A point to compare at.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    pub point_world: DVec3,
    /// The triangle that it lies on.
    pub triangle: Option<TriangleId>,
}

/// Draws points for a light.
pub struct Sampler<'a> {
    tracer: &'a Tracer,
    lamp: Option<&'a Lamp>,
    /// Of points in the air.
    bounds: Bounds,
    /// Triangles that the light may reach.
    triangles: Vec<TriangleId>,
    /// For each of those, the area of all up to and with it.
    areas: Vec<f64>,
}

impl<'a> Sampler<'a> {
    /// Points all over the scene.
    pub fn everywhere(tracer: &'a Tracer) -> Self {
        Self::within(tracer, None, bounds_with_margin(tracer), |_| true)
    }

    /// Points where a light matters.
    pub fn new(tracer: &'a Tracer, beam: &'a Beam) -> Self {
        let Beam::Lamp(lamp) = beam else { return Self::everywhere(tracer) };
        let bounds = bounds_with_margin(tracer);
        let reach = lamp.bounds();
        let common = Bounds { min: bounds.min.max(reach.min), max: bounds.max.min(reach.max) };
        let bounds = if common.is_empty() { reach } else { common };
        Self::within(tracer, Some(lamp), bounds, |[a, b, c]| {
            let (min, max) = (a.min(b).min(c), a.max(b).max(c));
            min.cmple(reach.max).all() && reach.min.cmple(max).all()
        })
    }

    fn within(tracer: &'a Tracer, lamp: Option<&'a Lamp>, bounds: Bounds, wants: impl Fn([DVec3; 3]) -> bool) -> Self {
        let all = (0..tracer.triangle_count() as u32).map(TriangleId);
        let triangles: Vec<TriangleId> = all.filter(|id| wants(tracer.corners(*id))).collect();
        let mut sum = 0.0;
        let areas = triangles.iter().map(|id| {
            sum += area(tracer.corners(*id));
            sum
        });
        Self { tracer, lamp, bounds, areas: areas.collect(), triangles }
    }

    pub fn sample(&self, seed: u64, kind: Kind, index: u64) -> Sample {
        let mut random = Random::new(seed, kind, index);
        let draw = |random: &mut Random| match kind {
            Kind::Air => Some(self.in_box(random)),
            Kind::Surface | Kind::OffSurface => self.on_surface(random),
        };
        for _ in 0..TRIES {
            match draw(&mut random) {
                Some(sample) if self.takes(&sample, &mut random) => return sample,
                Some(_) => {}
                None => break,
            }
        }
        match self.lamp {
            Some(lamp) => self.on_ray(lamp, kind, &mut random),
            None => self.in_box(&mut random),
        }
    }

    /// Whether a point lies where the light matters.
    fn takes(&self, sample: &Sample, random: &mut Random) -> bool {
        self.lamp.is_none_or(|lamp| {
            let is_outside = lamp.is_outside_cone(sample.point_world);
            lamp.depth(sample.point_world) <= lamp.far_m && (!is_outside || random.unit() < OUTSIDE_CONE_TAKEN)
        })
    }

    fn in_box(&self, random: &mut Random) -> Sample {
        let share = DVec3::from_array(random.units());
        let point_world = self.bounds.min + (self.bounds.max - self.bounds.min) * share;
        Sample { point_world, triangle: None }
    }

    fn on_surface(&self, random: &mut Random) -> Option<Sample> {
        let wanted = random.unit() * self.areas.last()?;
        let index = self.areas.partition_point(|&sum| sum <= wanted).min(self.areas.len() - 1);
        let triangle = self.triangles[index];
        let [a, b, c] = self.tracer.corners(triangle);
        let (mut u, mut v) = (random.unit(), random.unit());
        if u + v > 1.0 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        Some(Sample { point_world: a + (b - a) * u + (c - a) * v, triangle: Some(triangle) })
    }

    /// A point of any surface on one of a local light's rays, or in the air of it where it meets none.
    fn on_ray(&self, lamp: &Lamp, kind: Kind, random: &mut Random) -> Sample {
        let to_far = lamp.far_point(random.units()) - lamp.position_world;
        let which = random.unit();
        let mut hits: Vec<(f64, TriangleId)> = Vec::new();
        if kind != Kind::Air {
            let ray = antumbra_render::Ray::new(lamp.position_world, to_far).between(0.0, 1.0);
            self.tracer.for_each_hit(&ray, |hit| hits.push((hit.t, hit.triangle)));
        }
        hits.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let hit = hits.get((which * hits.len() as f64) as usize);
        let share = hit.map_or(which, |(t, _)| *t);
        Sample { point_world: lamp.position_world + to_far * share, triangle: hit.map(|(_, triangle)| *triangle) }
    }
}

/// The casters' box and a little more.
fn bounds_with_margin(tracer: &Tracer) -> Bounds {
    let mut bounds = tracer.bounds();
    let margin = bounds.diagonal() * MARGIN;
    bounds.min -= margin;
    bounds.max += margin;
    bounds
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

    fn units(&mut self) -> [f64; 3] {
        [self.unit(), self.unit(), self.unit()]
    }
}

fn mix(z: u64) -> u64 {
    let z = z.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}
