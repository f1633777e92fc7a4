//! A straight line as a light sees it.
//!
//! In the light's axes a line is affine in its parameter t. Every boundary of the light's grid is a plane there:
//!
//! ```text
//!               texel boundary c            slice boundary c       boundary of two cube faces
//! directional   x = c                       z = c                  -
//! local         p.x = (c - N/2) / k * p.z   p.z = depth of c       p.i = p.j or p.i = -p.j
//! ```
//!
//! so each is crossed where a linear function of t is zero, whatever the projection, and nothing needs to march. On one
//! face (p.z > 0) each voxel coordinate only ever rises or only ever falls with t. Only a spot light's cone is no plane:
//! a quadratic equation.

use glam::DVec3;

use super::{Local, Projection, SPOT_FACE, cube_face, on_face};

/// A line in the light's axes: voxel coordinates (directional) or metres (local). The parameter is 0 and 1 at the
/// ends of the segment that it was made of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Line {
    start: DVec3,
    step: DVec3,
}

impl Line {
    fn at(&self, t: f64) -> DVec3 {
        self.start + self.step * t
    }
}

/// The part of a line that one face of the light sees, in the axes of that face.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FaceLine<'a> {
    projection: &'a Projection,
    /// Which of the light's faces.
    pub face: usize,
    line: Line,
}

/// Parameters in order, the first 0 and the last 1, between which a line stays on one face and on one side of the cone.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cuts {
    at: [f64; MOST_CUTS],
    count: usize,
}

/// Both ends, six planes between cube faces, and twice through the cone.
const MOST_CUTS: usize = 2 + 6 + 2;

impl Cuts {
    fn new() -> Self {
        Self { at: [1.0; MOST_CUTS], count: 0 }
    }

    /// Adds a cut unless it lies outside the segment or is no number.
    fn add(&mut self, t: f64) {
        if (0.0..=1.0).contains(&t) && self.count < MOST_CUTS {
            self.at[self.count] = t;
            self.count += 1;
        }
    }

    fn sorted(mut self) -> Self {
        self.at[..self.count].sort_unstable_by(f64::total_cmp);
        self
    }

    /// The leg with that index: where it begins and ends.
    pub fn leg(&self, index: usize) -> Option<[f64; 2]> {
        (index + 1 < self.count).then(|| [self.at[index], self.at[index + 1]])
    }
}

impl Projection {
    /// The line from one world point to another; `None` for a point, and where numbers are not finite or overflow.
    pub fn line(&self, from: DVec3, to: DVec3) -> Option<Line> {
        let offset = if self.local.is_none() { self.offset } else { DVec3::ZERO };
        let line = Line { start: self.rotated(from) + offset, step: self.rotated_offset(to - from) };
        let sound = line.start.is_finite() && line.step.is_finite() && line.at(1.0).is_finite();
        (sound && line.step != DVec3::ZERO).then_some(line)
    }

    /// Where a line may change faces or pass the cone. A cut too many does no harm: legs are judged by their middles.
    pub fn cuts(&self, line: &Line) -> Cuts {
        let mut cuts = Cuts::new();
        cuts.add(0.0);
        cuts.add(1.0);
        let Some(local) = &self.local else { return cuts };
        if local.is_cube {
            for (i, j) in [(0, 1), (1, 2), (2, 0)] {
                let (p, d) = (line.start, line.step);
                cuts.add((p[j] - p[i]) / (d[i] - d[j]));
                cuts.add(-(p[j] + p[i]) / (d[i] + d[j]));
            }
        }
        if local.cone_cosine > -1.0 {
            local.cone_crossings(line).into_iter().for_each(|t| cuts.add(t));
        }
        cuts.sorted()
    }

    /// The line on the face that sees it at parameter t; `None` outside the cone.
    pub fn face_line(&self, line: &Line, t: f64) -> Option<FaceLine<'_>> {
        let Some(local) = &self.local else { return Some(FaceLine { projection: self, face: 0, line: *line }) };
        let p = line.at(t);
        if local.is_outside_cone(p) {
            return None;
        }
        let face = if local.is_cube { cube_face(p) } else { SPOT_FACE };
        let line = Line { start: on_face(line.start, face), step: on_face(line.step, face) };
        Some(FaceLine { projection: self, face: if local.is_cube { face } else { 0 }, line })
    }
}

impl Local {
    /// Where a line passes the double cone p.z^2 = cos^2 |p|^2, of which the light's cone is one half; near misses count.
    fn cone_crossings(&self, line: &Line) -> [f64; 2] {
        // Scaled, so that no square overflows.
        let scale = 1.0 / line.start.abs().max_element().max(line.step.abs().max_element());
        let line = Line { start: line.start * scale, step: line.step * scale };
        let form = |u: DVec3, v: DVec3| u.z * v.z - self.cone_cosine * self.cone_cosine * u.dot(v);
        let (a, b, c) = (form(line.step, line.step), form(line.start, line.step), form(line.start, line.start));
        // Half angles near 90 degrees have their roots next to each other: rounding must not lose both.
        let root = libm::sqrt((b * b - a * c).max(0.0));
        let sum = -(b + if b < 0.0 { -root } else { root });
        [sum / a, c / sum].map(|t| self.polished(&line, t))
    }

    /// A crossing of the cone after a few steps of Newton's method, which lose fewer digits than the quadratic formula.
    fn polished(&self, line: &Line, mut t: f64) -> f64 {
        let beyond = |p: DVec3| p.z - self.cone_cosine * p.length();
        for _ in 0..2 {
            let p = line.at(t);
            let slope = line.step.z - self.cone_cosine * p.dot(line.step) / p.length();
            let next = t - beyond(p) / slope;
            // Towards the other half of the double cone and at its apex the method leads nowhere.
            let is_nearer = beyond(line.at(next)).abs() < beyond(p).abs();
            if !is_nearer {
                break;
            }
            t = next;
        }
        t
    }
}

impl FaceLine<'_> {
    /// The linear function of t that is zero where the line crosses boundary `c` of an axis (0 and 1: texels, 2: slices):
    /// its value at 0 and its slope. It rises with the voxel coordinate.
    fn boundary(&self, axis: usize, c: f64) -> (f64, f64) {
        let Line { start, step } = self.line;
        match &self.projection.local {
            None => (start[axis] - c, step[axis]),
            Some(local) if axis < 2 => {
                let tangent = (c - 0.5 * self.projection.side) / local.scale;
                (start[axis] - tangent * start.z, step[axis] - tangent * step.z)
            }
            // Not by a logarithm and back: lookups compare with the near distance itself.
            Some(local) if c == 0.0 => (start.z - local.near_m, step.z),
            Some(_) => (start.z - self.projection.depth_of_slice(c), step.z),
        }
    }

    /// Where the line crosses a boundary that it does cross.
    #[inline]
    pub fn crossing(&self, axis: usize, c: u32) -> f64 {
        let (value, slope) = self.boundary(axis, f64::from(c));
        -value / slope
    }

    /// A voxel coordinate at parameter t, within the volume.
    #[inline]
    pub fn coordinate(&self, axis: usize, t: f64) -> f64 {
        let Line { start, step } = self.line;
        let along = |axis: usize| start[axis] + step[axis] * t;
        match &self.projection.local {
            None => along(axis),
            Some(local) if axis < 2 => along(axis) * (local.scale / along(2)) + 0.5 * self.projection.side,
            Some(local) => local.slice(along(2), self.projection.side),
        }
    }

    /// The part between two parameters that lies in the volume: within the grid sideways and not before its first slice,
    /// but for all its length behind the last (Liang, Barsky 1984: one bound after the other). `None` if that is nothing.
    pub fn clipped(&self, [mut from, mut to]: [f64; 2]) -> Option<[f64; 2]> {
        let side = self.projection.side;
        for (axis, c, inward) in [(2, 0.0, 1.0), (0, 0.0, 1.0), (0, side, -1.0), (1, 0.0, 1.0), (1, side, -1.0)] {
            let (value, slope) = self.boundary(axis, c);
            let crossing = -value / slope;
            if slope * inward > 0.0 {
                from = from.max(crossing);
            } else if slope * inward < 0.0 {
                to = to.min(crossing);
            } else if value * inward < 0.0 || (value == 0.0 && inward < 0.0) {
                return None;
            }
        }
        (from < to).then_some([from, to])
    }
}
