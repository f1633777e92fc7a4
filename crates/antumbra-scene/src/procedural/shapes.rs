//! Arches, walls with openings, groined vaults, hoops, cloth, and smooth profiles for what is turned on a lathe.

use core::f64::consts::{PI, TAU};

use glam::{DVec2, DVec3};

use crate::procedural::solids::{Builder, Shading};

/// How finely round things are made; their triangles grow with the square of the scale.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Detail {
    pub(crate) scale: f64,
}

impl Detail {
    /// Sides of something round that has `at_one` of them at scale 1.
    pub(crate) fn sides(self, at_one: f64) -> usize {
        (at_one * self.scale).round().max(4.0) as usize
    }

    /// How many of something of which there are `at_one` at scale 1; no more of them in a larger scene.
    pub(crate) fn up_to(self, at_one: usize) -> usize {
        ((at_one as f64 * self.scale).ceil() as usize).clamp(2, at_one)
    }

    /// Share of the places for small things that is filled, as `at_one` at scale 1.
    pub(crate) fn share(self, at_one: f64) -> f64 {
        at_one * (self.scale * self.scale).min(1.0)
    }

    /// Steps along a curve that has `at_one` of them at scale 1.
    pub(crate) fn steps(self, at_one: f64) -> usize {
        (at_one * self.scale).round().max(1.0) as usize
    }
}

/// A piece of wall that stands on an arch: half an ellipse, or flat where it does not rise. Heights are absolute.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arch {
    /// Middle along x.
    pub(crate) middle: f64,
    /// Half the width of the piece of wall.
    pub(crate) half: f64,
    /// Half the width of the opening.
    pub(crate) clear: f64,
    /// Where the arch begins.
    pub(crate) spring: f64,
    pub(crate) rise: f64,
    /// Top of the wall.
    pub(crate) top: f64,
}

impl Arch {
    /// Builds the wall between two depths.
    pub(crate) fn build(&self, b: &mut Builder, paint: impl Into<usize>, z: [f64; 2], steps: usize) {
        let steps = if self.rise > 0.0 { steps.max(4) } else { 1 };
        let mut soffit: Vec<(f64, f64)> = (0..=steps)
            .map(|i| PI * i as f64 / steps as f64)
            .map(|angle| (-self.clear * libm::cos(angle), self.spring + self.rise * libm::sin(angle)))
            .collect();
        if self.half > self.clear {
            soffit.insert(0, (-self.half, self.spring));
            soffit.push((self.half, self.spring));
        }
        let ring = |&(x, y): &(f64, f64)| {
            let at = |y: f64, z: f64| DVec3::new(self.middle + x, y, z);
            vec![at(y, z[1]), at(y, z[0]), at(self.top, z[0]), at(self.top, z[1])]
        };
        b.loft(paint, Shading::Flat, &soffit.iter().map(ring).collect::<Vec<_>>());
    }
}

/// An opening in a wall, from the wall's foot up. Heights are absolute.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Opening {
    /// Along the wall.
    pub(crate) middle: f64,
    pub(crate) half: f64,
    /// Where its arch begins; with a rise of 0 its top.
    pub(crate) spring: f64,
    pub(crate) rise: f64,
}

/// A wall along x between the corners `min` and `max`, with openings from west to east.
pub(crate) fn wall(
    b: &mut Builder,
    paint: impl Into<usize>,
    min: DVec3,
    max: DVec3,
    openings: &[Opening],
    steps: usize,
) {
    let paint = paint.into();
    let mut x = min.x;
    for o in openings {
        b.cuboid(paint, DVec3::new(x, min.y, min.z), DVec3::new(o.middle - o.half, max.y, max.z));
        let Opening { middle, half, spring, rise } = *o;
        Arch { middle, half, clear: half, spring, rise, top: max.y }.build(b, paint, [min.z, max.z], steps);
        x = o.middle + o.half;
    }
    b.cuboid(paint, DVec3::new(x, min.y, min.z), max);
}

/// A bay of groined vault about the y axis: two crossing barrels over a rectangle, below a flat top.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Vault {
    /// Width along x and z.
    pub(crate) size: DVec2,
    /// Where it begins, at the corners.
    pub(crate) spring: f64,
    pub(crate) rise: f64,
    pub(crate) top: f64,
}

impl Vault {
    /// Builds the bay; an even number of steps, so that the groins run along edges.
    pub(crate) fn build(&self, b: &mut Builder, paint: impl Into<usize>, half_steps: usize) {
        let paint = paint.into();
        let n = 2 * half_steps.max(2);
        let angle = |i: usize| PI * i as f64 / n as f64;
        let point = |i: usize, j: usize| {
            // At the far end the sine is not quite zero.
            let height = |i: usize| if i == n { 0.0 } else { libm::sin(angle(i)) };
            let y = self.spring + self.rise * height(i).max(height(j));
            let at = |i: usize, size: f64| -0.5 * size * libm::cos(angle(i));
            DVec3::new(at(i, self.size.x), y, at(j, self.size.y))
        };
        let mut webs: [Vec<[[usize; 2]; 3]>; 4] = Default::default();
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
            let first = usize::from((i < n / 2) != (j < n / 2));
            for k in [1, 2] {
                let triangle = [corners[first], corners[(first + k) % 4], corners[(first + k + 1) % 4]];
                webs[web_of(&triangle, n)].push(triangle);
            }
        }
        for web in webs {
            let points: Vec<DVec3> = web.iter().flatten().map(|&[i, j]| point(i, j)).collect();
            let index_of = |p: DVec3| points.iter().position(|&q| q == p).unwrap_or(0) as u32;
            let triangles: Vec<_> = web.iter().map(|t| t.map(|[i, j]| index_of(point(i, j)))).collect();
            b.smooth_triangles(paint, &points, &triangles);
        }
        self.close(b, paint, n, &point);
    }

    /// The four sides and the top.
    fn close(&self, b: &mut Builder, paint: usize, n: usize, point: &dyn Fn(usize, usize) -> DVec3) {
        let rim: [Vec<DVec3>; 4] = [
            (0..=n).map(|i| point(i, n)).collect(),
            (0..=n).map(|j| point(n, n - j)).collect(),
            (0..=n).map(|i| point(n - i, 0)).collect(),
            (0..=n).map(|j| point(0, j)).collect(),
        ];
        let top = rim.each_ref().map(|side| DVec3::new(side[0].x, self.top, side[0].z));
        for (k, side) in rim.iter().enumerate() {
            let mut points = side.clone();
            points.extend([top[(k + 1) % 4], top[k]]);
            let last = n as u32 + 2;
            let triangles: Vec<_> = (0..last - 1).map(|i| [last, i, i + 1]).collect();
            b.triangles(paint, &points, &triangles);
        }
        b.triangles(paint, &top, &[[0, 1, 2], [0, 2, 3]]);
    }
}

/// Which of the four webs between the groins a triangle of the grid lies in.
fn web_of(triangle: &[[usize; 2]; 3], n: usize) -> usize {
    let away = |axis: usize| triangle.iter().map(|p| 2 * p[axis] as i64 - n as i64).sum::<i64>();
    let (x, z) = (away(0), away(1));
    if x.abs() < z.abs() { usize::from(z > 0) } else { 2 + usize::from(x > 0) }
}

/// A flat ring about an upright axis, from radius `radii[0]` to `radii[1]` and from height `y[0]` to `y[1]`.
pub(crate) fn hoop(
    b: &mut Builder,
    paint: impl Into<usize>,
    at: DVec2,
    [inner, outer]: [f64; 2],
    [low, high]: [f64; 2],
    sides: usize,
) {
    let ring = |i: usize| {
        let angle = TAU * i as f64 / sides as f64;
        let spot = |r: f64, y: f64| DVec3::new(at.x + r * libm::cos(angle), y, at.y - r * libm::sin(angle));
        vec![spot(outer, low), spot(inner, low), spot(inner, high), spot(outer, high)]
    };
    b.loop_loft(paint, Shading::Flat, &(0..sides).map(ring).collect::<Vec<_>>());
}

/// A thin closed cloth: where its points lie is a function of the unit square, with x from left to right and y from
/// bottom to top seen from the front.
pub(crate) fn cloth(
    b: &mut Builder,
    paint: impl Into<usize>,
    [columns, rows]: [usize; 2],
    place: &dyn Fn(DVec2) -> DVec3,
) {
    const THICKNESS: f64 = 0.004;
    let (columns, rows) = (columns.max(2), rows.max(2));
    let row = columns as u32 + 1;
    let count = row * (rows as u32 + 1);
    let spot = |i: u32| DVec2::new(f64::from(i % row) / columns as f64, f64::from(i / row) / rows as f64);
    let normal = |p: DVec2| {
        let across = |d: DVec2| place(p + d) - place(p - d);
        across(DVec2::X * 1e-3).cross(across(DVec2::Y * 1e-3)).normalize_or(DVec3::Z)
    };
    let mut points: Vec<DVec3> = (0..count).map(|i| place(spot(i))).collect();
    points.extend((0..count).map(|i| place(spot(i)) - normal(spot(i)) * THICKNESS));
    let mut triangles = Vec::new();
    let mut quad = |a: u32, b: u32, c: u32, d: u32| triangles.extend([[a, b, c], [a, c, d]]);
    for i in (0..rows as u32).flat_map(|r| (0..row - 1).map(move |c| r * row + c)) {
        quad(i, i + 1, i + row + 1, i + row);
        quad(count + i, count + i + row, count + i + row + 1, count + i + 1);
    }
    let mut edge = |a: u32, b: u32| quad(b, a, count + a, count + b);
    for i in 0..row - 1 {
        edge(i, i + 1);
        edge(count - 1 - i, count - 2 - i);
    }
    for i in (0..rows as u32).map(|r| r * row) {
        edge(i + row, i);
        edge(i + row - 1, i + 2 * row - 1);
    }
    b.smooth_triangles(paint, &points, &triangles);
}

/// A smooth curve near a profile's knots, (radius, y), in so many steps, evenly spread over the knots: a Catmull-Rom
/// spline over the chords' lengths, which does not overshoot where knots are unevenly spaced. It has the knots themselves
/// where the steps are a multiple of the stretches between them, and always the first and the last.
pub(crate) fn smooth_profile(knots: &[(f64, f64)], steps: usize) -> Vec<(f64, f64)> {
    let knot = |i: usize| DVec2::from(knots[i]);
    let last = knots.len() - 1;
    let tangent = |i: usize| {
        let (before, after) = (i.saturating_sub(1), (i + 1).min(last));
        let chords: f64 = (before..after).map(|k| (knot(k + 1) - knot(k)).length()).sum();
        (knot(after) - knot(before)) / chords
    };
    let steps = steps.max(2);
    let at = |k: usize| {
        let (i, rest) = (k * last / steps, k * last % steps);
        if rest == 0 {
            return knots[i];
        }
        let (p, q, long) = (knot(i), knot(i + 1), (knot(i + 1) - knot(i)).length());
        let (m, n) = (tangent(i) * long, tangent(i + 1) * long);
        let t = rest as f64 / steps as f64;
        let (t2, t3) = (t * t, t * t * t);
        let at = p * (2.0 * t3 - 3.0 * t2 + 1.0) + m * (t3 - 2.0 * t2 + t) + q * (3.0 * t2 - 2.0 * t3) + n * (t3 - t2);
        (at.x.max(1e-3), at.y)
    };
    (0..=steps).map(at).collect()
}
