//! Broken walls with openings, as fields that [`Pattern::cut`] cuts.

use glam::{DVec2, DVec3};

use super::looks::{ASHLAR, THIN_ASHLAR};
use super::{Site, ground};
use crate::procedural::noise::{fractal_noise, gradient_noise, smoothstep};
use crate::procedural::rng::mix;
use crate::procedural::sheets::{Pattern, Sheets};

/// How deep walls go into the ground.
pub(super) const FOOT_M: f64 = -0.8;
/// Height of a course of stone.
const COURSE_M: f64 = 0.4;

/// An arched opening, or a round one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Opening {
    /// Along the wall.
    pub middle: f64,
    pub half_width: f64,
    pub sill: f64,
    /// Where the arch begins.
    pub spring: f64,
    /// 0 for a round arch; the more, the more pointed.
    pub pointed: f64,
    /// A full circle about the point where the arch begins.
    pub circle: bool,
}

impl Opening {
    /// A gothic window or door.
    pub fn pointed(middle: f64, half_width: f64, sill: f64, spring: f64) -> Self {
        Self { middle, half_width, sill, spring, pointed: 0.7, circle: false }
    }

    /// A round arch.
    pub fn round(middle: f64, half_width: f64, sill: f64, spring: f64) -> Self {
        Self { middle, half_width, sill, spring, pointed: 0.0, circle: false }
    }

    /// A round window.
    pub fn circle(middle: f64, center: f64, radius: f64) -> Self {
        Self { middle, half_width: radius, sill: center - radius, spring: center, pointed: 0.0, circle: true }
    }

    /// Distance into the stone around it, negative in the opening.
    fn stone(&self, p: DVec2) -> f64 {
        let across = (p.x - self.middle).abs();
        if p.y < self.spring && !self.circle {
            return (across - self.half_width).max(self.sill - p.y);
        }
        // Two circles about points beyond the middle meet in the arch's point.
        let beyond = self.pointed * self.half_width;
        let arch = DVec2::new(across + beyond, p.y - self.spring).length() - (self.half_width + beyond);
        arch.max(self.sill - p.y)
    }
}

/// Where a wall runs.
#[derive(Clone, Copy, Debug)]
pub(super) enum Course {
    /// From a point of the ground along a unit vector.
    Straight { from: DVec2, along: DVec2 },
    /// Round a centre, counter-clockwise seen from above.
    Round { center: DVec2, radius: f64, start: f64 },
}

/// A wall. Its front is on the right of one who walks along it.
pub(super) struct Wall {
    pub course: Course,
    pub length: f64,
    /// No stone is lower: in the ground, or on columns.
    pub foot: f64,
    /// No stone is higher.
    pub height: f64,
    /// 0 for a single sheet.
    pub thick: f64,
    pub openings: Vec<Opening>,
    /// Height of its top along it, before it broke.
    pub top: Box<dyn Fn(f64) -> f64>,
    /// A number of its own.
    pub tag: u64,
    /// How much ivy it has: 0 none, 1 much.
    pub ivy: f64,
}

impl Wall {
    /// A straight wall from one point to another, without openings.
    pub fn straight(
        tag: u64,
        from: (f64, f64),
        to: (f64, f64),
        thick: f64,
        top: impl Fn(f64) -> f64 + 'static,
    ) -> Self {
        let (from, to) = (DVec2::from(from), DVec2::from(to));
        let length = (to - from).length();
        let course = Course::Straight { from, along: (to - from) / length };
        Self {
            course,
            length,
            foot: FOOT_M,
            height: 20.0,
            thick,
            openings: Vec::new(),
            top: Box::new(top),
            tag,
            ivy: 0.5,
        }
    }

    pub fn with(mut self, openings: impl IntoIterator<Item = Opening>) -> Self {
        self.openings.extend(openings);
        self
    }

    pub fn with_ivy(self, ivy: f64) -> Self {
        Self { ivy, ..self }
    }

    pub fn is_thick(&self) -> bool {
        self.thick > 0.0
    }

    /// The place of a point of the wall's face at a depth behind its front.
    pub fn place(&self, p: DVec2, depth: f64) -> DVec3 {
        match self.course {
            Course::Straight { from, along } => {
                let at = from + along * p.x + along.perp() * -depth;
                DVec3::new(at.x, p.y, at.y)
            }
            Course::Round { center, radius, start } => {
                let angle = start + p.x / radius;
                let r = radius - depth;
                DVec3::new(center.x + r * libm::cos(angle), p.y, center.y - r * libm::sin(angle))
            }
        }
    }

    /// Positive where there is stone.
    pub fn stone(&self, site: &Site, p: DVec2) -> f64 {
        let broken = broken_top(site.seed ^ mix(self.tag), p, &self.top);
        self.openings.iter().fold(broken, |stone, opening| stone.min(opening.stone(p)))
    }

    fn pattern(&self, site: &Site) -> Pattern {
        let lift = DVec2::Y * self.foot;
        let size = DVec2::new(self.length, self.height - self.foot);
        // Courses of stone fall on rows of cells, whatever their number.
        let cell = COURSE_M / (COURSE_M / site.cell_m).round().max(0.25);
        Pattern::cut(size, cell, |p| self.stone(site, p + lift))
    }

    pub fn build(&self, sheets: &mut Sheets, site: &Site) {
        let pattern = self.pattern(site);
        let lift = DVec2::Y * self.foot;
        let front = |p: DVec2| self.place(p + lift, 0.0);
        let back = |p: DVec2| self.place(p + lift, self.thick);
        let tint = |at: DVec3| weather(site, at);
        if self.is_thick() {
            sheets.side(ASHLAR, &pattern, &front, true, &tint);
            sheets.side(ASHLAR, &pattern, &back, false, &tint);
            sheets.rim(ASHLAR, &pattern, [&front, &back], &tint);
        } else {
            sheets.side(THIN_ASHLAR, &pattern, &front, true, &tint);
        }
    }
}

/// How far below a broken top a point lies. Tops break along courses and joints; holes gape where little was left.
fn broken_top(seed: u64, p: DVec2, top: &dyn Fn(f64) -> f64) -> f64 {
    let block = (p.x / 0.75).floor();
    let chip = (mix(seed ^ (block as i64 as u64)) >> 40) as f64 / (1_u64 << 24) as f64;
    let ruin = fractal_noise(seed, DVec2::new(p.x / 5.5, 0.5), 3, 0.6);
    let height = top((block + 0.5) * 0.75) * (1.0 + 0.13 * ruin) - 0.9 * chip;
    let courses = (height / COURSE_M).floor() * COURSE_M + 0.03;
    let hole = 0.62 - gradient_noise(seed ^ 0x401e, p / 2.6) - 0.35 * smoothstep(3.0, 0.0, courses - p.y);
    (courses - p.y).min(hole * 2.0)
}

/// Stone's colour: damp and mossy near the ground, streaked and bleached above.
pub(super) fn weather(site: &Site, at: DVec3) -> DVec3 {
    let over = at.y - ground::height(site, at.x, at.z);
    let face = DVec2::new(at.x + 0.73 * at.z, at.y);
    let patch = fractal_noise(site.seed ^ 0x3a, face / 3.1, 3, 0.55);
    let streak = gradient_noise(site.seed ^ 0x3b, DVec2::new(face.x / 0.9, face.y / 6.0));
    let clean = DVec3::new(1.0, 0.985, 0.95) * (0.92 + 0.13 * patch + 0.10 * streak);
    let moss = DVec3::new(0.52, 0.58, 0.33) * (0.9 + 0.2 * patch);
    let damp = smoothstep(2.2, -0.2, over + 1.6 * patch);
    let mossy = smoothstep(0.22, 0.55, patch - 0.05 * over);
    clean.lerp(moss, (0.65 * damp).max(0.8 * mossy)).min(DVec3::ONE)
}
