//! The lie of the land: gentle slopes, winding lanes, and where trees stand.

use core::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::church;
use super::plots::Plot;
use crate::model::{Mesh, Primitive};
use crate::procedural::noise::{fractal_noise, gradient_noise, smoothstep};
use crate::procedural::palette::Paint;
use crate::procedural::rng::Rng;
use crate::procedural::solids::{Builder, Shading};

/// From lane to lane.
const PITCH_M: f64 = 54.0;
/// Half a lane's width.
pub(super) const LANE_M: f64 = 2.4;
/// Radius of the paved green in the middle.
pub(super) const GREEN_M: f64 = 16.0;
/// Fields and woods beyond the last houses.
const MARGIN_M: f64 = 58.0;
const CELL_M: f64 = 4.0;
const BOTTOM_M: f64 = -14.0;

/// Hills, lanes and their sizes.
#[derive(Clone, Debug)]
pub(super) struct Land {
    seed: u64,
    /// How far lanes go east and west.
    pub reach: f64,
    /// Lanes north of the middle one, and as many south of it.
    pub lanes: i32,
    half: DVec2,
}

/// A tree's place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot {
    pub at: DVec2,
    pub angle: f64,
    pub size: f64,
    pub kind: usize,
}

impl Land {
    pub fn new(seed: u64, scale: f64) -> Self {
        let reach = (88.0 * scale).max(30.0);
        let lanes = (scale + 0.25).floor() as i32;
        let half = DVec2::new(reach, 26.0 + f64::from(lanes) * PITCH_M) + DVec2::splat(MARGIN_M);
        Self { seed, reach, lanes, half }
    }

    /// Height of the ground: level about the green, rising to woods all round.
    pub fn height(&self, p: DVec2) -> f64 {
        let roll = 3.0 * gradient_noise(self.seed ^ 0x11, p / 75.0) * smoothstep(18.0, 56.0, p.length());
        let beyond = (p.abs() - (self.half - DVec2::splat(MARGIN_M))).max(DVec2::ZERO).length();
        roll + 9.0 * smoothstep(4.0, MARGIN_M, beyond) * (0.7 + 0.5 * gradient_noise(self.seed ^ 0x12, p / 48.0))
    }

    /// The point of the ground below or above.
    pub fn on(&self, p: DVec2) -> DVec3 {
        DVec3::new(p.x, self.height(p), p.y)
    }

    /// The middle of a lane at an x; lane 0 crosses the green.
    pub fn lane_z(&self, lane: i32, x: f64) -> f64 {
        let phase = 1.7 * f64::from(lane);
        let straight = smoothstep(6.0, 40.0, x.abs());
        f64::from(lane) * PITCH_M + straight * (5.5 * libm::sin(x / 27.0 + phase) + 1.8 * libm::sin(x / 11.0 + phase))
    }

    /// The middle of the one lane that runs north to south.
    pub fn cross_x(&self, z: f64) -> f64 {
        19.0 * smoothstep(-6.0, -24.0, z) * smoothstep(-50.0, -36.0, z) + 4.0 * libm::sin(z / 23.0)
    }

    /// How far north and south that lane goes.
    pub fn cross_reach(&self) -> f64 {
        f64::from(self.lanes) * PITCH_M
    }

    /// Distance to the nearest lane's middle line, roughly.
    pub fn off_lanes(&self, p: DVec2) -> f64 {
        let mut nearest = f64::INFINITY;
        for lane in -self.lanes..=self.lanes {
            let past = (p.x.abs() - self.reach).max(0.0);
            nearest = nearest.min(DVec2::new(past, p.y - self.lane_z(lane, p.x)).length());
        }
        let past = (p.y.abs() - self.cross_reach()).max(0.0);
        let cross = DVec2::new(past, p.x - self.cross_x(p.y)).length();
        if self.lanes > 0 { nearest.min(cross) } else { nearest }
    }

    /// The ground: a height field with a skirt and a flat bottom.
    pub fn ground(&self, name: &str) -> Mesh {
        let cells = (self.half * 2.0 / CELL_M).round();
        let (columns, rows) = (cells.x as usize, cells.y as usize);
        let at = |x: usize, z: usize| self.on(self.half * (DVec2::new(x as f64, z as f64) * 2.0 / cells - DVec2::ONE));
        let mut top = Primitive { material: Some(Paint::Grass.into()), ..Primitive::default() };
        for (z, x) in (0..=rows).flat_map(|z| (0..=columns).map(move |x| (z, x))) {
            let p = at(x, z);
            top.positions.push(rounded(p));
            top.normals.push(rounded(self.normal(DVec2::new(p.x, p.z))));
            top.colors.push(self.tint(DVec2::new(p.x, p.z)));
        }
        let index = |x: usize, z: usize| (z * (columns + 1) + x) as u32;
        for (z, x) in (0..rows).flat_map(|z| (0..columns).map(move |x| (z, x))) {
            let [a, b, c, d] = [index(x, z), index(x + 1, z), index(x, z + 1), index(x + 1, z + 1)];
            top.triangles.extend(if (x + z) % 2 == 0 { [[a, c, d], [a, d, b]] } else { [[a, c, b], [b, c, d]] });
        }
        let south = (0..columns).map(|i| index(i, rows));
        let east = (0..rows).map(|i| index(columns, rows - i));
        let north = (0..columns).map(|i| index(columns - i, 0));
        let west = (0..rows).map(|i| index(0, i));
        let border: Vec<_> = south.chain(east).chain(north).chain(west).map(|i| top.positions[i as usize]).collect();
        Mesh { name: name.to_owned(), primitives: vec![top, underside(&border)] }
    }

    fn normal(&self, p: DVec2) -> DVec3 {
        let across = |d: DVec2| self.height(p + d) - self.height(p - d);
        DVec3::new(-across(DVec2::X), 2.0, -across(DVec2::Y)).normalize()
    }

    /// Meadows, mown and not.
    fn tint(&self, p: DVec2) -> [f32; 4] {
        let patch = fractal_noise(self.seed ^ 0x13, p / 26.0, 3, 0.55);
        let color = DVec3::new(0.82, 0.92, 0.74).lerp(DVec3::new(1.0, 0.96, 0.82), smoothstep(-0.4, 0.4, patch));
        [color.x as f32, color.y as f32, color.z as f32, 1.0]
    }

    /// All lanes, each a closed ribbon on the ground.
    pub fn lanes(&self, b: &mut Builder) {
        for lane in -self.lanes..=self.lanes {
            let steps = (self.reach / 1.5).ceil() as usize;
            let along = (0..=steps).map(|i| self.reach * (2.0 * i as f64 / steps as f64 - 1.0));
            let line: Vec<_> = along.map(|x| DVec2::new(x, self.lane_z(lane, x))).collect();
            self.ribbon(b, Paint::Gravel, &line, LANE_M, 0.16);
        }
        if self.lanes > 0 {
            let reach = self.cross_reach();
            let steps = (reach / 1.5).ceil() as usize;
            let along = (0..=steps).map(|i| reach * (2.0 * i as f64 / steps as f64 - 1.0));
            let line: Vec<_> = along.map(|z| DVec2::new(self.cross_x(z), z)).collect();
            self.ribbon(b, Paint::Gravel, &line, LANE_M * 0.85, 0.13);
        }
    }

    /// A strip that follows a line over the ground and rises a little above it.
    pub fn ribbon(&self, b: &mut Builder, paint: Paint, line: &[DVec2], half: f64, top: f64) {
        let rings: Vec<Vec<DVec3>> = (0..line.len())
            .map(|i| {
                let way = line[(i + 1).min(line.len() - 1)] - line[i.saturating_sub(1)];
                let right = way.perp().normalize() * half;
                [(right, -0.5), (-right, -0.5), (-right, top), (right, top)]
                    .map(|(side, dy)| self.on(line[i] + side) + DVec3::Y * dy)
                    .to_vec()
            })
            .collect();
        b.loft(paint, Shading::Flat, &rings);
    }

    /// Where trees stand: scattered among the gardens, dense on the slopes around.
    pub fn tree_spots(&self, taken: &[Plot], rng: &Rng) -> Vec<Spot> {
        let mut rng = rng.fork(4100);
        let inner = self.half - DVec2::splat(MARGIN_M);
        let most = self.half.x * self.half.y / 95.0;
        let mut spots: Vec<Spot> = Vec::new();
        for _ in 0..(most * 5.0) as usize {
            let at = self.half * DVec2::new(rng.range(-0.97, 0.97), rng.range(-0.97, 0.97));
            let (size, angle, kind) = (rng.range(0.7, 1.25), rng.range(0.0, TAU), rng.index(64));
            let wood = fractal_noise(self.seed ^ 0x14, at / 34.0, 2, 0.5);
            let outside = (at.abs() - inner).max(DVec2::ZERO).length();
            let keep = rng.chance(if outside > 12.0 { 0.45 + wood } else { 0.3 });
            let free = self.off_lanes(at) > 6.0
                && taken.iter().all(|plot| (plot.at - at).length() > 10.5)
                && (at - church::AT).length() > 21.0
                && at.length() > GREEN_M + 3.0
                && spots.iter().all(|s| (s.at - at).length() > 4.5)
                // The overview looks in from the south-west.
                && (at / self.half - DVec2::new(-0.62, 0.95)).length() > 0.42;
            if keep && free {
                spots.push(Spot { at, angle, size, kind });
            }
        }
        spots
    }
}

/// Skirt and bottom under a border that runs counter-clockwise seen from above.
fn underside(border: &[[f32; 3]]) -> Primitive {
    let count = border.len() as u32;
    let mut primitive = Primitive { material: Some(Paint::Trunk.into()), ..Primitive::default() };
    for &[x, y, z] in border {
        primitive.positions.extend([[x, y, z], [x, BOTTOM_M as f32, z]]);
    }
    primitive.positions.push([0.0, BOTTOM_M as f32, 0.0]);
    for i in 0..count {
        let j = (i + 1) % count;
        let [top, low, next_top, next_low] = [2 * i, 2 * i + 1, 2 * j, 2 * j + 1];
        primitive.triangles.extend([[low, next_low, next_top], [low, next_top, top], [low, 2 * count, next_low]]);
    }
    primitive
}

fn rounded(p: DVec3) -> [f32; 3] {
    [p.x as f32 + 0.0, p.y as f32 + 0.0, p.z as f32 + 0.0]
}
