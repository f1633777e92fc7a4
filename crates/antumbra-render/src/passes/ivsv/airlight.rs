//! Light that fog scatters from a point light towards the eye, over any stretch of a view ray.
//!
//! ```text
//!            L                   D = |EL|, gamma the angle at E, h = D sin gamma
//!          / | \                 theta: the angle at L from the foot F to a point P of the ray,
//!        D   h   r                      from -(pi/2 - gamma) at E to pi/2 at infinity
//!      /     |     \             t = D cos gamma + h tan theta, r = h / cos theta
//!    E ----- F ----- P --->      t + r = D cos gamma + h tan(pi/4 + theta/2), dt / r^2 = dtheta / h
//! ```
//!
//! So the airlight of a stretch is sigma_s I / h times the integral over theta of exp(-sigma_t (t + r)) times the phase
//! function, whose cosine is -sin theta, times the emitter's cosine, a cos theta + b sin theta. (The change of variable is
//! that of Sun et al. 2005, "A Practical Analytic Single Scattering Model for Real Time Rendering"; emission, any phase
//! function and arbitrary stretches are ours.)
//!
//! With tau = sigma_t h, what lies behind theta is exp(-sigma_t (t + r)) times the *tail*
//!
//! ```text
//! G(theta, tau) = integral from theta to pi/2 of exp(-tau (tan(pi/4 + s/2) - tan(pi/4 + theta/2))) w(s) ds
//! ```
//!
//! for w = phase times cosine, and times sine. A stretch is a difference of two tails. G is tabulated: by theta, and by
//! rho = tau (pi/2 - theta) / (1 - sin theta), how many times the light fades over what is left of the angle; divided by
//! (pi/2 - theta) / (1 + rho), which is how it grows, it is a mild function of both.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

use glam::Vec2;
use rayon::prelude::*;

use crate::passes::fog::reference::henyey_greenstein;

/// Columns, from -pi/2 to pi/2; rows, from rho = 0 to infinity.
pub(crate) const COLUMNS: usize = 513;
pub(crate) const ROWS: usize = 129;
/// Steps of each entry's quadrature.
const STEPS: u32 = 256;
/// The last column stands for an angle this far from pi/2.
const LAST: f64 = 1e-4;
/// Angles are no steeper than this: beyond, tangents of single numbers change sign.
pub(crate) const STEEPEST: f32 = std::f32::consts::FRAC_PI_2 - 6e-6;

/// The table of tails for one phase function.
#[derive(Clone, Debug)]
pub(crate) struct Airlight {
    /// By row, then column: weighted by cosine, by sine.
    pub table: Vec<Vec2>,
}

impl Airlight {
    /// For Henyey and Greenstein's g. Takes a few dozen milliseconds.
    pub fn new(anisotropy: f64) -> Self {
        let row = |row: usize| (0..COLUMNS).map(move |column| entry(anisotropy, row, column));
        Self { table: (0..ROWS).into_par_iter().flat_map_iter(row).collect() }
    }

    /// G(theta, tau) weighted by cosine and by sine.
    pub fn tail(&self, theta: f32, tau: f32) -> Vec2 {
        let left = std::f32::consts::FRAC_PI_2 - theta;
        let rho = tau * left / (1.0 - theta.sin()).max(1e-9);
        let x = (theta / std::f32::consts::PI + 0.5).clamp(0.0, 1.0) * (COLUMNS - 1) as f32;
        let root = rho.sqrt();
        let y = root / (1.0 + root) * (ROWS - 1) as f32;
        let (column, row) = ((x as usize).min(COLUMNS - 2), (y as usize).min(ROWS - 2));
        let at = |row: usize| {
            let first = row * COLUMNS + column;
            self.table[first].lerp(self.table[first + 1], x - column as f32)
        };
        at(row).lerp(at(row + 1), y - row as f32) * (left / (1.0 + rho))
    }
}

/// G (1 + rho) / (pi/2 - theta).
fn entry(anisotropy: f64, row: usize, column: usize) -> Vec2 {
    let theta = (column as f64 / (COLUMNS - 1) as f64 * 2.0 - 1.0) * (FRAC_PI_2 - LAST);
    let left = FRAC_PI_2 - theta;
    let weights = |s: f64| {
        let (sin, cos) = s.sin_cos();
        let phase = henyey_greenstein(anisotropy, -sin);
        [phase * cos, phase * sin]
    };
    if row == ROWS - 1 {
        // All fades at once: the integral of exp(-rho q) is 1 / rho.
        let [cos, sin] = weights(theta);
        return Vec2::new(cos as f32, sin as f32);
    }
    // Rows lie closer together towards 0, where the tail changes fastest (as tau log tau).
    let y = row as f64 / (ROWS - 1) as f64;
    let rho = (y / (1.0 - y)).powi(2);
    let tau = rho * (1.0 - theta.sin()) / left;
    let tan = |angle: f64| (FRAC_PI_4 + 0.5 * angle).tan();
    let mut sum = [0.0; 2];
    for i in 0..STEPS {
        // Closer together at the beginning, where light is left, and at the end, where in thin fog it fades at last.
        let x = (f64::from(i) + 0.5) / f64::from(STEPS);
        let s = theta + left * x * x * (3.0 - 2.0 * x);
        let weight = 6.0 * x * (1.0 - x) * (-tau * (tan(s) - tan(theta))).exp() / f64::from(STEPS);
        let [cos, sin] = weights(s);
        sum = [sum[0] + weight * cos, sum[1] + weight * sin];
    }
    Vec2::new((sum[0] * (1.0 + rho)) as f32, (sum[1] * (1.0 + rho)) as f32)
}

/// A point light beside a view ray, in fog.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Beside {
    /// Distance along the ray to the foot.
    pub foot: f32,
    /// Distance of the light from the ray: at least the radius of what it stands for, so that 1 / h stays within bounds.
    pub h: f32,
    /// The emitter's cosine along theta: `a cos theta + b sin theta`.
    pub a: f32,
    pub b: f32,
    /// Extinction per metre, and the light's way that is free of fog.
    pub sigma_t: f32,
    pub start: f32,
}

impl Beside {
    /// The angle at the light of a point of the ray.
    pub fn theta(&self, t: f32) -> f32 {
        ((t - self.foot) / self.h).atan()
    }

    /// Ends of what the emitter's front lights, between two angles.
    pub fn lit(&self, from: f32, to: f32) -> [f32; 2] {
        // The cosine is positive within pi/2 of this angle.
        let middle = self.b.atan2(self.a);
        let half = std::f32::consts::FRAC_PI_2;
        [from, to].map(|theta| theta.clamp(middle - half, middle + half))
    }

    /// What comes from behind an angle, per intensity and scattering: differences of it are airlight.
    pub fn behind(&self, airlight: &Airlight, theta: f32) -> f32 {
        let theta = theta.clamp(-STEEPEST, STEEPEST);
        let (sin, cos) = theta.sin_cos();
        let cos = cos.max(1e-6);
        let way = self.foot + self.h * (sin + 1.0) / cos - self.start;
        let tail = airlight.tail(theta, self.sigma_t * self.h);
        (-self.sigma_t * way).exp() * (self.a * tail.x + self.b * tail.y) / self.h
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By small steps along the ray.
    fn brute(beside: &Beside, g: f64, from: f64, to: f64) -> f64 {
        let (foot, h) = (f64::from(beside.foot), f64::from(beside.h));
        let steps = 4_000;
        // Even in the angle's tangent near the foot: even in theta.
        let theta = |t: f64| ((t - foot) / h).atan();
        let (begin, end) = (theta(from), theta(to));
        let sum: f64 = (0..steps)
            .map(|i| {
                let theta = begin + (end - begin) * (f64::from(i) + 0.5) / f64::from(steps);
                let t = foot + h * theta.tan();
                let r = h / theta.cos();
                let emitted = (f64::from(beside.a) * theta.cos() + f64::from(beside.b) * theta.sin()).max(0.0);
                // dt = r^2 / h dtheta, and light falls off by r^2.
                emitted * henyey_greenstein(g, -theta.sin()) * (-f64::from(beside.sigma_t) * (t + r)).exp() / h
            })
            .sum();
        sum * (end - begin) / f64::from(steps)
    }

    #[test]
    fn airlight_is_what_small_steps_add_up_to() {
        let mut worst = 0.0_f64;
        for g in [0.0, 0.5, -0.4, 0.85] {
            let airlight = Airlight::new(g);
            for (foot, h) in [(5.0, 2.0), (-3.0, 1.0), (0.5, 8.0), (20.0, 0.3), (10.0, 10.0)] {
                for sigma_t in [0.001, 0.02, 0.1, 0.5] {
                    for (a, b) in [(1.0, 0.0), (0.6, 0.8), (0.6, -0.8), (-0.8, 0.6), (0.05, 0.9)] {
                        let beside = Beside { foot, h, a, b, sigma_t, start: 0.0 };
                        let whole = brute(&beside, g, 0.0, 60.0);
                        for (from, to) in [(0.0, 60.0), (0.0, 4.0), (3.0, 9.0), (8.0, 60.0), (4.0, 4.5)] {
                            let [begin, end] = beside.lit(beside.theta(from), beside.theta(to));
                            let ours = beside.behind(&airlight, begin) - beside.behind(&airlight, end);
                            let exact = brute(&beside, g, f64::from(from), f64::from(to));
                            let error = (f64::from(ours) - exact).abs() / whole.max(1e-12);
                            // Where next to nothing arrives, nothing counts.
                            let counts = whole > 1e-9;
                            worst = worst.max(if counts { error } else { 0.0 });
                        }
                    }
                }
            }
        }
        println!("airlight: off by at most {worst:.2e} of the whole ray's");
        assert!(worst < 1e-3, "{worst}");
    }
}
