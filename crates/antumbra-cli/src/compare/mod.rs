//! Holds a bake against ray tracing in world space, at random points in the air, on surfaces and just off
//! them.
//!
//! The truth is a ray towards the light against the casters, alpha masks tested where it meets them ([`ground`]); where a
//! solid or the bake's policy leaves the answer open, any will do. A bake knows a shadow to a texel across the
//! light and a slice along it: so wherever the two disagree, the truth is asked at points further and further aside
//! ([`edge`]) until it agrees. That is how far the disagreement lies from a true shadow edge.
//!
//! Of the bake only its lookups are used, and of the baker only its word on which parts are closed: nothing of its
//! light space, its builder or its oracle.

mod edge;
mod ground;
mod report;
pub mod sampling;

use antumbra::ShadowFile;
use antumbra_bake::{Blend, Inverted};
use antumbra_render::TriangleId;
use antumbra_scene::Scene;
use anyhow::{Result, ensure};
use glam::DVec3;
use rayon::prelude::*;

use crate::progress::Progress;
use edge::{Edge, FARTHEST_TEXELS};
use ground::{Ground, Sight, Truth};
use sampling::{Sample, Sampler};

/// One point in so many is told apart as robust, near an edge or inside a solid: that takes up to two hundred rays.
pub const CLASSIFIED_EVERY: u64 = 16;

/// Samples that one task takes.
const TASK: u64 = 2048;
/// Worst disagreements kept.
const WORST_KEPT: usize = 5;

/// What to compare.
#[derive(Clone, Copy, Debug)]
pub struct Wish {
    /// Points in the air, and as many on surfaces and off them.
    pub samples: u64,
    /// Of the points.
    pub seed: u64,
    /// As in the bake.
    pub blend: Blend,
    /// As in the bake.
    pub inverted: Inverted,
}

/// Where points lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Anywhere in the casters' box, or a little outside it.
    Air,
    /// On casters. Here a lookup may be wrong by its slice alone: one side of it is in the light, the other is not.
    Surface,
    /// The same points, moved off their surface as a filtered lookup moves them: a picture's view of them.
    OffSurface,
}

/// What was found out about a file.
pub struct Comparison {
    /// One per light of the file.
    pub lights: Vec<LightComparison>,
}

/// What was found out about a light.
pub struct LightComparison {
    pub name: String,
    pub air: Tally,
    pub surfaces: Tally,
    pub off_surfaces: Tally,
}

/// Counts over the points of a kind.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    pub samples: u64,
    /// The bake says what the ray says.
    pub agreeing: u64,
    /// They differ inside a solid, where the bake was free to choose.
    pub undefined: u64,
    /// They differ where the bake's policy leaves the answer open.
    pub left_open: u64,
    /// They differ elsewhere.
    pub disagreeing: u64,
    /// The ray reaches the light.
    pub lit: u64,
    /// Of so many points it was found out whether they are robust, near an edge or inside.
    pub classified: u64,
    /// The truth is the same all round, a texel aside and a slice before and behind (of a point a little off the
    /// surface, for those on surfaces).
    pub robust: u64,
    /// It is not.
    pub near_edge: u64,
    /// Inside a solid.
    pub inside: u64,
    /// Left open by the bake's policy.
    pub open: u64,
    /// The largest distance of a disagreement from an edge, texels; infinite past [`FARTHEST_TEXELS`].
    pub farthest_texels: f64,
    /// Disagreements farther than a texel.
    pub too_far: u64,
    /// The farthest of those.
    pub worst: Vec<Worst>,
}

/// A disagreement far from any edge.
#[derive(Clone, Copy, Debug)]
pub struct Worst {
    pub point_world: DVec3,
    pub bake_lit: bool,
    /// As [`Tally::farthest_texels`].
    pub texels: f64,
}

/// Compares every light of a file.
pub fn compare(file: &ShadowFile, scene: &Scene, wish: Wish, progress: &Progress) -> Result<Comparison> {
    progress.stage("building the ray tracer");
    let ground = Ground::new(scene, wish.blend, wish.inverted)?;
    ensure!(
        ground.tracer().triangle_count() > 0,
        "the scene has no triangles that cast shadows: nothing to compare with"
    );
    let lights = file.lights().map(|light| {
        let sight = Sight::new(&ground, light);
        let sampler = Sampler::new(&sight);
        let tally = |kind| Job { sight: &sight, sampler: &sampler, wish, kind, edge: Edge::new(&sight) }.run(progress);
        LightComparison {
            name: light.name().to_owned(),
            air: tally(Kind::Air),
            surfaces: tally(Kind::Surface),
            off_surfaces: tally(Kind::OffSurface),
        }
    });
    Ok(Comparison { lights: lights.collect() })
}

/// One light and one kind of points.
struct Job<'a> {
    sight: &'a Sight<'a>,
    sampler: &'a Sampler<'a>,
    wish: Wish,
    kind: Kind,
    edge: Edge<'a>,
}

impl Job<'_> {
    fn run(&self, progress: &Progress) -> Tally {
        let what = match self.kind {
            Kind::Air => "points in the air",
            Kind::Surface => "points on surfaces",
            Kind::OffSurface => "points off surfaces",
        };
        progress.count(&format!("{}: {what}", self.sight.light().name()), self.wish.samples, "points");
        let tasks = self.wish.samples.div_ceil(TASK);
        let tallies = (0..tasks).into_par_iter().map(|task| {
            let last = self.wish.samples.min((task + 1) * TASK);
            let mut tally = Tally::default();
            (task * TASK..last).for_each(|index| self.sample(index, &mut tally));
            progress.add(last - task * TASK);
            tally
        });
        tallies.reduce(Tally::default, Tally::merge)
    }

    fn sample(&self, index: u64, tally: &mut Tally) {
        let Some(sample) = self.draw(index) else { return };
        let truth = self.truth(&sample);
        let bake_lit = self.sight.light().visibility(sample.point_world) > 0.5;
        tally.samples += 1;
        tally.lit += u64::from(truth == Truth::Lit);
        if bake_lit == (truth == Truth::Lit) {
            tally.agreeing += 1;
        } else {
            match truth {
                Truth::Inside => tally.undefined += 1,
                Truth::Undefined => tally.left_open += 1,
                Truth::Lit | Truth::Shadowed => {
                    let texels = self.edge.distance_texels(sample.point_world, bake_lit);
                    tally.disagree(sample.point_world, bake_lit, texels);
                }
            }
        }
        if index.is_multiple_of(CLASSIFIED_EVERY) {
            self.classify(&sample, truth, tally);
        }
    }

    fn draw(&self, index: u64) -> Option<Sample> {
        let sample = self.sampler.sample(self.wish.seed, self.kind, index)?;
        Some(match sample.triangle {
            Some(own) if self.kind == Kind::OffSurface => {
                Sample { point_world: self.lifted(&sample, own), triangle: None }
            }
            _ => sample,
        })
    }

    fn lifted(&self, sample: &Sample, own: TriangleId) -> DVec3 {
        self.edge.lifted(sample.point_world, self.sight.ground().outward(own))
    }

    fn truth(&self, sample: &Sample) -> Truth {
        match sample.triangle {
            None => self.sight.truth(sample.point_world),
            Some(own) => self.sight.truth_on(sample.point_world, own),
        }
    }

    fn classify(&self, sample: &Sample, truth: Truth, tally: &mut Tally) {
        tally.classified += 1;
        // On its own surface a point is always at an edge.
        let off_surface = sample.triangle.map(|own| self.lifted(sample, own));
        match truth {
            Truth::Inside => tally.inside += 1,
            Truth::Undefined => tally.open += 1,
            _ if self.edge.is_near(off_surface.unwrap_or(sample.point_world)) => tally.near_edge += 1,
            _ => tally.robust += 1,
        }
    }
}

impl Tally {
    fn disagree(&mut self, point_world: DVec3, bake_lit: bool, texels: f64) {
        self.disagreeing += 1;
        self.farthest_texels = self.farthest_texels.max(texels);
        if texels > 1.0 {
            self.too_far += 1;
            self.worst.push(Worst { point_world, bake_lit, texels });
            self.keep_worst();
        }
    }

    /// Keeps the farthest; of equals the first by place, so that the order of threads does not show.
    fn keep_worst(&mut self) {
        let key = |w: &Worst| w.point_world.to_array();
        self.worst.sort_by(|a, b| {
            let places = key(a).into_iter().zip(key(b)).map(|(a, b)| a.total_cmp(&b));
            b.texels.total_cmp(&a.texels).then(places.fold(std::cmp::Ordering::Equal, std::cmp::Ordering::then))
        });
        self.worst.truncate(WORST_KEPT);
    }

    fn merge(mut self, other: Self) -> Self {
        self.samples += other.samples;
        self.agreeing += other.agreeing;
        self.undefined += other.undefined;
        self.left_open += other.left_open;
        self.disagreeing += other.disagreeing;
        self.lit += other.lit;
        self.classified += other.classified;
        self.robust += other.robust;
        self.near_edge += other.near_edge;
        self.inside += other.inside;
        self.open += other.open;
        self.farthest_texels = self.farthest_texels.max(other.farthest_texels);
        self.too_far += other.too_far;
        self.worst.extend(other.worst);
        self.keep_worst();
        self
    }
}

impl Comparison {
    /// Counts over everything.
    #[must_use]
    pub fn total(&self) -> Tally {
        let tallies =
            self.lights.iter().flat_map(|light| [&light.air, &light.surfaces, &light.off_surfaces].map(Tally::clone));
        tallies.fold(Tally::default(), Tally::merge)
    }
}
