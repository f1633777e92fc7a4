//! Holds a bake against ray tracing in world space, at random points in the air, on surfaces and just off
//! them.
//!
//! The truth is a ray towards the light ([`beam`]) against the casters ([`ground`]), and what the bake's policy leaves
//! undefined ([`sight`]). A bake knows a shadow to a texel across the light and a slice along it ([`grid`]): so wherever
//! the two disagree, the truth is asked at points further and further aside ([`edge`]) until it agrees, or until the bake
//! was free. That is how far the disagreement lies from a true shadow edge.
//!
//! Of the bake only its lookups are used, and of the baker only its word on which parts are closed: nothing of its
//! light space, its builder or its oracle.

mod beam;
mod edge;
mod grid;
mod ground;
mod masks;
mod report;
pub mod sampling;
mod sight;
mod tally;
#[cfg(test)]
mod tests;

use antumbra::{Interior, LightKind, ShadowFile};
use antumbra_bake::{Blend, Inverted};
use antumbra_scene::Scene;
use anyhow::{Result, ensure};
use glam::DVec3;
use rayon::prelude::*;

use crate::progress::Progress;
use edge::{Edge, FARTHEST_TEXELS};
use ground::Ground;
use sampling::{Sample, Sampler};
use sight::{Sight, Truth};
pub use tally::{Tally, Worst};

/// One point in so many is told apart as robust, near an edge or inside a solid: that takes hundreds of rays.
pub const CLASSIFIED_EVERY: u64 = 16;

/// Samples that one task takes.
const TASK: u64 = 2048;

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
    /// Anywhere in the casters' box, or a little outside it; for a local light also within its range.
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
    pub kind: LightKind,
    pub policy: Interior,
    pub air: Tally,
    pub surfaces: Tally,
    pub off_surfaces: Tally,
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
        let sight = Sight::new(light, &ground);
        let sampler = Sampler::new(ground.tracer(), sight.beam());
        let tally = |kind| Job { sight: &sight, sampler: &sampler, wish, kind, edge: Edge::new(&sight) }.run(progress);
        LightComparison {
            name: light.name().to_owned(),
            kind: light.kind(),
            policy: light.interior(),
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
        let sample = self.draw(index);
        let truth = self.sight.truth(sample.point_world, sample.triangle);
        let bake_lit = self.sight.light().visibility(sample.point_world) > 0.5;
        tally.samples += 1;
        tally.lit += u64::from(truth == Truth::Lit);
        tally.free += u64::from(truth.is_free());
        if bake_lit == (truth == Truth::Lit) {
            tally.agreeing += 1;
        } else if truth.is_free() {
            tally.undefined += 1;
        } else {
            tally.disagree(sample.point_world, bake_lit, self.edge.distance_texels(sample.point_world, bake_lit));
        }
        if index.is_multiple_of(CLASSIFIED_EVERY) {
            self.classify(&sample, truth, tally);
        }
    }

    fn draw(&self, index: u64) -> Sample {
        let sample = self.sampler.sample(self.wish.seed, self.kind, index);
        if self.kind == Kind::OffSurface {
            Sample { point_world: self.lifted(&sample), triangle: None }
        } else {
            sample
        }
    }

    /// Where a picture would look a surface's point up.
    fn lifted(&self, sample: &Sample) -> DVec3 {
        let lift = |own| self.edge.lifted(sample.point_world, self.sight.ground().outward(own));
        sample.triangle.map_or(sample.point_world, lift)
    }

    fn classify(&self, sample: &Sample, truth: Truth, tally: &mut Tally) {
        tally.classified += 1;
        match truth {
            Truth::Inside => tally.inside += 1,
            Truth::Undefined => tally.behind += 1,
            // On its own surface a point is always at an edge: a little off it, it need not be.
            _ if self.edge.is_near(self.lifted(sample)) => tally.near_edge += 1,
            _ => tally.robust += 1,
        }
    }
}

impl LightComparison {
    /// Counts over all its points.
    #[must_use]
    pub fn total(&self) -> Tally {
        [&self.air, &self.surfaces, &self.off_surfaces].into_iter().cloned().fold(Tally::default(), Tally::merge)
    }
}

impl Comparison {
    /// Counts over everything.
    #[must_use]
    pub fn total(&self) -> Tally {
        self.lights.iter().map(LightComparison::total).fold(Tally::default(), Tally::merge)
    }
}
