//! The terrain's shape and what grows on it.
//!
//! The mountains are a sum of octaves of gradient noise in which each octave counts for less the steeper the sum of
//! the coarser ones is (Quilez 2008, "Value noise derivatives"): slopes turn smooth and crests sharp, as erosion leaves
//! them. A ridged multifractal (Musgrave, Kolb and Mace 1989) sharpens the high ground, and a valley with a lake is
//! worn into both.

use glam::{DVec2, DVec3};

use crate::procedural::noise::{fractal_noise, gradient_noise, rotated, smoothstep};

/// The lake's level; the terrain does not go below.
const LAKE_M: f64 = 0.0;

/// A height for every point of the plane.
pub(crate) struct Terrain {
    seed: u64,
}

impl Terrain {
    pub(crate) fn new(seed: u64) -> Self {
        Self { seed }
    }

    /// Height, metres.
    pub(crate) fn height(&self, x: f64, z: f64) -> f64 {
        let p = DVec2::new(x, z);
        let warp = DVec2::new(self.noise(1, p / 1300.0, 3), self.noise(2, p / 1300.0, 3));
        let q = p + warp * 240.0;
        let upland = self.upland(q);
        let eroded = 0.5 + 0.5 * self.eroded(q / 1500.0);
        let ridged = self.ridged(q / 1900.0);
        let mountains = upland * (170.0 + 330.0 * eroded + 560.0 * ridged * upland);
        let plain = 26.0 * self.noise(3, p / 700.0, 5) + 30.0;
        let land = plain * (1.0 - upland) + mountains;
        (land - self.basin(q)).max(LAKE_M)
    }

    fn noise(&self, stream: u64, p: DVec2, octaves: u64) -> f64 {
        fractal_noise(self.seed.wrapping_mul(31).wrapping_add(stream * 1000), p, octaves, 0.5)
    }

    /// 0 on the plain in the south-west, 1 in the mountains of the north and east.
    fn upland(&self, p: DVec2) -> f64 {
        let across = (p.x * 0.55 - p.y * 0.83) / 3000.0;
        smoothstep(-0.55, 0.75, across + 0.28 * self.noise(4, p / 1700.0, 2)) * (1.0 - 0.8 * self.valley(p))
    }

    /// 1 along a winding line from the plain into the mountains, 0 away from it.
    fn valley(&self, p: DVec2) -> f64 {
        let bend = 420.0 * gradient_noise(self.seed ^ 0x77, DVec2::new(p.y / 1500.0, 0.5)).value;
        let away = (p.x - 250.0 + 0.35 * p.y - bend).abs();
        1.0 - smoothstep(60.0, 620.0 + 0.05 * p.y, away)
    }

    /// How much the lake's basin lies below its surroundings.
    fn basin(&self, p: DVec2) -> f64 {
        let away = ((p - DVec2::new(-900.0, 900.0)) / DVec2::new(1250.0, 800.0)).length();
        let shore = 0.35 * self.noise(5, p / 900.0, 4);
        110.0 * (1.0 - smoothstep(0.35, 1.15, away + shore))
    }

    fn eroded(&self, p: DVec2) -> f64 {
        let (mut sum, mut slope, mut amplitude, mut at) = (0.0, DVec2::ZERO, 1.0, p);
        for octave in 0..9 {
            let sample = gradient_noise(self.seed.wrapping_mul(17).wrapping_add(octave), at);
            slope += sample.slope;
            sum += amplitude * sample.value / (1.0 + slope.length_squared());
            amplitude *= 0.5;
            at = rotated(at) * 2.0;
        }
        sum
    }

    fn ridged(&self, p: DVec2) -> f64 {
        let (mut sum, mut weight, mut amplitude, mut at) = (0.0, 1.0, 0.55, p);
        for octave in 0..8 {
            let ridge = 1.0 - gradient_noise(self.seed.wrapping_mul(13).wrapping_add(900 + octave), at).value.abs();
            let signal = ridge * ridge * weight;
            sum += amplitude * signal;
            weight = (signal * 1.6).clamp(0.0, 1.0);
            amplitude *= 0.48;
            at = rotated(at) * 2.03;
        }
        sum
    }
}

/// The cover of a triangle: an index into the landscape's materials, in the order lake, shore, meadow, pasture,
/// forest, dark forest, heath, scree, rock, snow.
pub(crate) fn cover(height: f64, normal: DVec3, mottle: f64) -> usize {
    let flat = normal.y;
    let above = height - LAKE_M;
    if above <= 0.0 {
        return 0;
    }
    if above < 5.0 + 2.0 * mottle && flat > 0.95 {
        return 1;
    }
    let snow_line = 620.0 + 90.0 * mottle;
    if above > snow_line && flat > 0.62 {
        return 9;
    }
    if flat < 0.66 + 0.06 * mottle {
        return 8;
    }
    if flat < 0.78 + 0.05 * mottle || above > 520.0 + 80.0 * mottle {
        return 7;
    }
    match above + 110.0 * mottle {
        h if h < 55.0 => 2 + usize::from(mottle > 0.1),
        h if h < 210.0 => 4 + usize::from(mottle > 0.0),
        h if h < 330.0 => 5,
        _ => 6,
    }
}
