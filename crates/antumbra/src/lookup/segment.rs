//! Segment lookups: which parts of a straight way are lit, for shafts of light through air.
//!
//! A segment is cut where it passes from one face of the light to another or through a spot light's cone
//! (`project/line.rs`); each leg then walks through the homogeneous boxes of its face's graph (`walk.rs`).
//! The graph is that of Sintorn, Kämpe, Olsson, Assarsson 2014, *Compact precomputed voxelized shadows*; they look up
//! single points along a view ray, as many as samples are taken. Here the answer is exact, and a box that is all lit or all
//! shadowed costs one step, however long the way through it.

use glam::DVec3;

use super::light::LightShadow;
use super::project::line::{Cuts, Line};
use super::walk::{Graph, Span, Walk};

/// A part of a segment that is lit or shadowed all along.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// Where it begins: 0 at the segment's start, 1 at its end.
    pub from: f64,
    /// Where it ends; more than `from`.
    pub to: f64,
    /// Whether the light reaches it.
    pub lit: bool,
}

/// The runs of a segment, in order: see [`LightShadow::segment`].
#[derive(Clone, Debug)]
pub struct Segment<'a> {
    light: LightShadow<'a>,
    /// What is left of the legs: `None` when all that is left is ahead.
    legs: Option<Legs>,
    walk: Option<Walk<'a>>,
    /// A span that begins where the last run ended.
    ahead: Option<Span>,
    /// Where the next run begins.
    at: f64,
    steps: u64,
}

/// A line and the legs that are left of it.
#[derive(Clone, Copy, Debug)]
struct Legs {
    line: Line,
    cuts: Cuts,
    next: usize,
    /// Where the leg under way ends.
    end: f64,
}

impl<'a> LightShadow<'a> {
    /// Which parts of the segment from one world point (metres) to another are lit: runs that cover 0 to 1 without a gap,
    /// in order, neighbours never alike.
    ///
    /// At every parameter t the run about it says what [`LightShadow::visibility`] says of the point at t, but for
    /// rounding at the boundaries of voxels: beside a directional light's grid and before any grid it is lit, outside a
    /// spot light's cone it is not, behind the last slice it is as there. A segment of no length, or with an end that is
    /// not finite, is one run, as lit as its start.
    ///
    /// Cost: a step for every box of equal voxels on the way (nodes of the graph, slices of its leaves, texels where a
    /// mask is mixed), at most 3N on each face; a step is a few reads and divisions, for local lights also an
    /// exponential and a logarithm. [`Segment::steps`] counts them. Nothing is allocated.
    #[must_use]
    pub fn segment(self, from: DVec3, to: DVec3) -> Segment<'a> {
        let line = self.projection().line(from, to);
        let legs = line.map(|line| Legs { line, cuts: self.projection().cuts(&line), next: 0, end: 0.0 });
        let ahead = legs.is_none().then(|| Span { to: 1.0, lit: self.visibility(from) == 1.0 });
        Segment { light: self, legs, walk: None, ahead, at: 0.0, steps: 0 }
    }

    /// How much of a segment is lit: 0 to 1. Cost: as [`LightShadow::segment`].
    #[must_use]
    pub fn lit_share(self, from: DVec3, to: DVec3) -> f64 {
        let lit: f64 = self.segment(from, to).filter(|run| run.lit).map(|run| run.to - run.from).sum();
        lit.min(1.0)
    }

    /// Light that fog along a segment, of some optical depth in all, scatters and lets through to the segment's start,
    /// relative to that of endless fog in full light: the sum over lit runs of the difference of transmittance. With an
    /// optical depth of 0 it is [`LightShadow::lit_share`]. Cost: as [`LightShadow::segment`].
    #[must_use]
    pub fn lit_through(self, from: DVec3, to: DVec3, optical_depth: f64) -> f64 {
        if optical_depth == 0.0 {
            return self.lit_share(from, to);
        }
        let through = |t: f64| libm::exp(-optical_depth * t);
        let lit: f64 =
            self.segment(from, to).filter(|run| run.lit).map(|run| through(run.from) - through(run.to)).sum();
        lit.clamp(0.0, 1.0)
    }

    /// Length of the lit parts of a segment, metres; 0 where nothing is lit, and as its length not finite for a segment that
    /// is not. Cost: as [`LightShadow::segment`].
    #[must_use]
    pub fn lit_length_m(self, from: DVec3, to: DVec3) -> f64 {
        let share = self.lit_share(from, to);
        if share == 0.0 { 0.0 } else { share * from.distance(to) }
    }
}

impl Segment<'_> {
    /// Boxes of equal voxels walked through so far: what the lookup costs.
    #[must_use]
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// The next span, which may be empty or as lit as the last.
    fn span(&mut self) -> Option<Span> {
        if let Some(span) = self.ahead.take() {
            return Some(span);
        }
        if let Some(walk) = &mut self.walk {
            let span = walk.next();
            self.steps += u64::from(span.is_some());
            if span.is_some() {
                return span;
            }
            // What is left of the leg lies beside the volume or before it.
            self.walk = None;
            return self.legs.map(|legs| Span { to: legs.end, lit: true });
        }
        self.start_leg()
    }

    /// Begins the next leg, and gives its part before the volume.
    fn start_leg(&mut self) -> Option<Span> {
        let legs = self.legs.as_mut()?;
        let [from, to] = legs.cuts.leg(legs.next)?;
        legs.next += 1;
        legs.end = to;
        let Some(line) = self.light.projection().face_line(&legs.line, 0.5 * (from + to)) else {
            return Some(Span { to, lit: false });
        };
        let Some(inside) = line.clipped([from, to]) else { return Some(Span { to, lit: true }) };
        let record = self.light.record();
        let graph = Graph {
            pool: &self.light.file.pool,
            root: record.roots[line.face],
            log2: record.log2_resolution,
            silhouettes: self.light.is_silhouette().then(|| (self.light.spread(), self.light.top_grid(line.face))),
        };
        self.walk = Some(Walk::new(graph, line, inside));
        Some(Span { to: inside[0], lit: true })
    }
}

impl Iterator for Segment<'_> {
    type Item = Run;

    fn next(&mut self) -> Option<Run> {
        let from = self.at;
        let mut run: Option<Run> = None;
        while let Some(span) = self.span() {
            // Spans of no length are where a line meets two boundaries at once.
            if span.to <= self.at {
                continue;
            }
            match &mut run {
                Some(run) if run.lit != span.lit => {
                    self.ahead = Some(span);
                    break;
                }
                Some(run) => run.to = span.to,
                None => run = Some(Run { from, to: span.to, lit: span.lit }),
            }
            self.at = span.to;
        }
        run
    }
}

impl core::iter::FusedIterator for Segment<'_> {}
