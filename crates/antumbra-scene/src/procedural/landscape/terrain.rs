//! The terrain's shape.
//!
//! A plain with a lake lies in the south-west; the ground north and east of it rises for ages while rivers cut it back
//! to the plain (see [`super::rivers`]). That happens on a coarse grid, which is then interpolated; noise that grows
//! with height and slope adds the rock's own roughness.

use glam::{DVec2, DVec3};

use super::SIDE_M;
use super::rivers::{Ground, Rivers};
use crate::procedural::noise::{fractal_noise, gradient_noise, rotated, smoothstep};

/// The lake's level; the terrain does not go below.
pub(crate) const LAKE_M: f64 = 0.0;
/// Cells per side of the grid on which rivers run.
const CELLS: usize = 384;
/// Steps of uplift and erosion.
const STEPS: usize = 110;
/// Height of the highest summit before roughness.
const SUMMIT_M: f64 = 1050.0;

/// A height for every point of the square.
pub(crate) struct Terrain {
    seed: u64,
    heights: Vec<f64>,
    drained_m2: Vec<f64>,
}

impl Terrain {
    pub(crate) fn new(seed: u64) -> Self {
        let shape = Shape { seed };
        let ground: Vec<_> = (0..CELLS * CELLS).map(|i| shape.ground(place(i))).collect();
        let start = (0..CELLS * CELLS).map(|i| shape.start(place(i))).collect();
        let mut rivers = Rivers::new(CELLS, SIDE_M / (CELLS - 1) as f64, start);
        (0..STEPS).for_each(|_| rivers.step(&ground));
        let highest = rivers.heights.iter().fold(1.0_f64, |a, &h| a.max(h));
        let heights = rivers.heights.iter().map(|h| if *h > 0.0 { h * SUMMIT_M / highest } else { *h }).collect();
        Self { seed, heights, drained_m2: rivers.drained_m2 }
    }

    /// Height, metres.
    pub(crate) fn height(&self, x: f64, z: f64) -> f64 {
        let p = DVec2::new(x, z);
        // A small warp hides the eight directions of the river grid.
        let warp = |stream: u64| 16.0 * fractal_noise(self.seed ^ stream, p / 170.0, 3, 0.5);
        let q = p + DVec2::new(warp(0xa1), warp(0xa2));
        let (coarse, slope) = sampled(&self.heights, q);
        let rough = 1.5 + 15.0 * smoothstep(0.1, 0.8, slope) + 8.0 * smoothstep(400.0, 900.0, coarse);
        let swell = 9.0 * fractal_noise(self.seed ^ 0xb0, p / 420.0, 3, 0.5) * smoothstep(4.0, 40.0, coarse);
        (coarse + swell + rough * self.rock(p) * smoothstep(0.0, 25.0, coarse)).max(LAKE_M)
    }

    /// How steep the ground is without its roughness, rise over run.
    pub(crate) fn slope(&self, p: DVec2) -> f64 {
        sampled(&self.heights, p).1
    }

    /// The highest summit.
    pub(crate) fn summit(&self) -> DVec3 {
        self.ground_at(self.best(|i| self.heights[i]))
    }

    /// The greatest valley: a point of its river for each of two heights.
    pub(crate) fn valley(&self, low: f64, high: f64) -> [DVec3; 2] {
        let mouth = self.best(|i| if (low..1.5 * low).contains(&self.heights[i]) { self.drained_m2[i] } else { 0.0 });
        let mut head = mouth;
        while self.heights[head] < high {
            let Some(next) = self.upstream(head) else { break };
            head = next;
        }
        [mouth, head].map(|i| self.ground_at(i))
    }

    /// The higher neighbour that brings the most water.
    fn upstream(&self, i: usize) -> Option<usize> {
        let (x, z) = (i % CELLS, i / CELLS);
        let around = |at: usize| at.saturating_sub(1)..=(at + 1).min(CELLS - 1);
        around(z)
            .flat_map(|z| around(x).map(move |x| z * CELLS + x))
            .filter(|&k| self.heights[k] > self.heights[i])
            .max_by(|&a, &b| self.drained_m2[a].total_cmp(&self.drained_m2[b]))
    }

    /// The cell with the greatest merit, away from the borders.
    fn best(&self, merit: impl Fn(usize) -> f64) -> usize {
        let inner = CELLS / 10..CELLS - CELLS / 10;
        let cells = inner.clone().flat_map(|z| inner.clone().map(move |x| z * CELLS + x));
        cells.max_by(|&a, &b| merit(a).total_cmp(&merit(b))).unwrap_or(0)
    }

    fn ground_at(&self, cell: usize) -> DVec3 {
        let p = place(cell);
        DVec3::new(p.x, self.height(p.x, p.y), p.y)
    }

    /// Ridged noise about 0: sharp edges upward, as of broken rock.
    fn rock(&self, p: DVec2) -> f64 {
        let (mut sum, mut amplitude, mut at) = (0.0, 1.0, p / 210.0);
        for octave in 0..5 {
            sum += amplitude * (0.4 - gradient_noise(self.seed.wrapping_mul(13).wrapping_add(octave), at).abs());
            amplitude *= 0.52;
            at = rotated(at) * 2.03;
        }
        sum
    }
}

/// Where a cell of the river grid lies.
fn place(cell: usize) -> DVec2 {
    (DVec2::new((cell % CELLS) as f64, (cell / CELLS) as f64) / (CELLS - 1) as f64 - 0.5) * SIDE_M
}

/// Interpolates a grid by uniform cubic B-splines: the value and the slope's length.
fn sampled(grid: &[f64], p: DVec2) -> (f64, f64) {
    let last = (CELLS - 1) as f64;
    let at = ((p / SIDE_M + 0.5) * last).clamp(DVec2::ZERO, DVec2::splat(last));
    let cell = at.floor();
    let (wx, dx) = spline(at.x - cell.x);
    let (wz, dz) = spline(at.y - cell.y);
    let (mut value, mut slope) = (0.0, DVec2::ZERO);
    for k in 0..4 {
        let row = (cell.y as usize + k).saturating_sub(1).min(CELLS - 1) * CELLS;
        let (mut along, mut change) = (0.0, 0.0);
        for i in 0..4 {
            let h = grid[row + (cell.x as usize + i).saturating_sub(1).min(CELLS - 1)];
            along += wx[i] * h;
            change += dx[i] * h;
        }
        value += wz[k] * along;
        slope += DVec2::new(wz[k] * change, dz[k] * along);
    }
    (value, slope.length() * last / SIDE_M)
}

/// Weights of four neighbours and their derivatives.
fn spline(t: f64) -> ([f64; 4], [f64; 4]) {
    let (s, t2, t3) = (1.0 - t, t * t, t * t * t);
    let weights = [s * s * s, 3.0 * t3 - 6.0 * t2 + 4.0, -3.0 * t3 + 3.0 * t2 + 3.0 * t + 1.0, t3];
    let slopes = [-s * s, 3.0 * t2 - 4.0 * t, -3.0 * t2 + 2.0 * t + 1.0, t2];
    (weights.map(|w| w / 6.0), slopes.map(|w| w * 0.5))
}

/// The plan: where the ground rises, and where the lake is.
struct Shape {
    seed: u64,
}

impl Shape {
    fn noise(&self, stream: u64, p: DVec2, octaves: u64) -> f64 {
        fractal_noise(self.seed.wrapping_mul(31).wrapping_add(stream * 1000), p, octaves, 0.5)
    }

    /// 0 on the plain, 1 where the mountains rise fastest.
    fn upland(&self, p: DVec2) -> f64 {
        let away = ((p - DVec2::new(-1250.0, 1350.0)) / 1000.0).length() - 1.15;
        let warped = away + 0.55 * self.noise(4, p / 1600.0, 3);
        smoothstep(0.0, 1.5, warped)
    }

    fn ground(&self, p: DVec2) -> Ground {
        let upland = self.upland(p);
        let massif = 0.75 + 0.5 * self.noise(6, p / 1500.0, 2);
        Ground {
            uplift_m: 9.0 * upland * massif.max(0.2),
            softness: (1.0 + 0.55 * self.noise(7, p / 500.0, 3)).max(0.3),
            repose: 0.75 + 0.35 * self.noise(8, p / 400.0, 3),
        }
    }

    /// The ground before the first step: the lake's basin, and bumps that give the first brooks their course.
    fn start(&self, p: DVec2) -> f64 {
        let away = ((p - DVec2::new(-1150.0, 1250.0)) / DVec2::new(900.0, 640.0)).length();
        let basin = 1.0 - smoothstep(0.55, 1.25, away + 0.4 * self.noise(5, p / 800.0, 4));
        13.0 + 13.0 * self.noise(3, p / 700.0, 4) + 40.0 * self.upland(p) * (1.0 + self.noise(9, p / 250.0, 4))
            - 45.0 * basin
    }
}
