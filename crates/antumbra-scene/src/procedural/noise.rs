//! Gradient noise.

use glam::DVec2;

use super::rng::mix;

/// Perlin's improved gradient noise (2002), about -1..1.
pub(crate) fn gradient_noise(seed: u64, p: DVec2) -> f64 {
    let cell = p.floor();
    let f = p - cell;
    let corner =
        |dx: f64, dz: f64| gradient(seed, (cell.x + dx) as i64, (cell.y + dz) as i64).dot(f - DVec2::new(dx, dz));
    let (a, b, c, d) = (corner(0.0, 0.0), corner(1.0, 0.0), corner(0.0, 1.0), corner(1.0, 1.0));
    let u = f * f * f * (f * (f * 6.0 - 15.0) + 10.0);
    a + u.x * (b - a) + u.y * (c - a) + u.x * u.y * (a - b - c + d)
}

/// A gradient of a lattice point: length about 1, any direction.
fn gradient(seed: u64, x: i64, z: i64) -> DVec2 {
    let bits =
        mix(seed ^ (x as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ (z as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f));
    let part = |shift: u32| ((bits >> shift) & 0xffff) as f64 / 32767.5 - 1.0;
    DVec2::new(part(0), part(16)) * 1.25
}

/// A sum of octaves, each of half the size and `gain` times the height of the one before, about -1..1.
pub(crate) fn fractal_noise(seed: u64, p: DVec2, octaves: u64, gain: f64) -> f64 {
    let (mut sum, mut amplitude, mut at) = (0.0, 1.0, p);
    for octave in 0..octaves {
        sum += amplitude * gradient_noise(seed.wrapping_add(octave), at);
        amplitude *= gain;
        at = rotated(at) * 2.0;
    }
    sum
}

/// A turn by a Pythagorean angle (about 36.87 degrees), so that the octaves' lattices do not line up.
pub(crate) fn rotated(p: DVec2) -> DVec2 {
    DVec2::new(0.8 * p.x - 0.6 * p.y, 0.6 * p.x + 0.8 * p.y)
}

/// Hermite step from 0 at `lo` to 1 at `hi`.
pub(crate) fn smoothstep(lo: f64, hi: f64, x: f64) -> f64 {
    let t = ((x - lo) / (hi - lo)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
