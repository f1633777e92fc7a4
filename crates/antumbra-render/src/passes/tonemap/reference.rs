//! Tone mapping, on the CPU.
//!
//! The curve is Hill's (2017) fit of the Academy's reference and sRGB output transforms (ACES 1.0), from the BakingLab
//! of Pettineo and Neubelt: deep shadows, colours that fade towards white as they get brighter.

use glam::{Mat3, Vec3};
use std::f32::consts::PI;

use crate::{
    light::{Lamp, Time, luminance},
    passes::{Lighting, shade::reference::Shaded},
    surface::srgb_from_linear,
};

/// From linear sRGB to the space of the curve, with the reference transform's desaturation, and back.
const INTO: Mat3 =
    Mat3::from_cols_array(&[0.59719, 0.07600, 0.02840, 0.35458, 0.90834, 0.13383, 0.04823, 0.01566, 0.83777]);
const BACK: Mat3 =
    Mat3::from_cols_array(&[1.60475, -0.10208, -0.00327, -0.53108, 1.10813, -0.07276, -0.07367, -0.00605, 1.07602]);

/// Contrast about middle grey, before the curve's own.
const CONTRAST: f32 = 0.93;

/// At night, the typical lit place comes out as bright as this, before the curve.
const NIGHT_KEY: f32 = 0.30;
/// Albedo of a typical surface.
const TYPICAL_ALBEDO: f32 = 0.3;
/// Brightest share of what is seen that does not count: hot spots right under lamps.
const HOT_SHARE: f64 = 0.02;

/// Factor that exposes a picture.
pub(crate) fn exposure(lighting: &Lighting, shaded: &[Shaded]) -> f32 {
    match lighting.time {
        Time::Day => day_exposure(lighting, shaded),
        Time::Night => night_exposure(lighting, shaded.iter().map(|s| s.metered).filter(|&m| m > 0.0).collect()),
    }
}

/// Sunlit ground comes out light but not white. It follows from the lights alone, so that pictures of a scene with
/// different shadows compare; only a picture that is dark all over (a room) is lifted.
fn day_exposure(lighting: &Lighting, shaded: &[Shaded]) -> f32 {
    let white = luminance(lighting.outdoors).max(1e-6);
    let exposure = 1.9 / white;
    exposure * lift(shaded, exposure)
}

/// 1 unless the picture's typical pixel is dark, then up to 8.
fn lift(shaded: &[Shaded], exposure: f32) -> f32 {
    let log_sum: f64 =
        shaded.iter().map(|s| f64::from((luminance(s.radiance) * exposure).clamp(1e-3, 10.0).ln())).sum();
    let typical = (log_sum / shaded.len().max(1) as f64).exp() as f32;
    (0.17 / typical).clamp(1.0, 8.0)
}

/// What is seen of the lamps' light decides, however little of the picture it is: the mean (of logarithms) over what
/// surfaces reflect, each pixel weighed by its own brightness. Windows and signs do not count, nor do hot spots. A picture
/// of the dark stays dark.
fn night_exposure(lighting: &Lighting, mut metered: Vec<f32>) -> f32 {
    let lit = lighting.plainly_lit * TYPICAL_ALBEDO / PI;
    let hottest = (metered.len() as f64 * HOT_SHARE) as usize;
    if metered.is_empty() {
        return NIGHT_KEY / lit;
    }
    let most = *metered.select_nth_unstable_by(hottest, |a, b| b.total_cmp(a)).1;
    // In the order of brightness, for sums that do not depend on how the selection went.
    metered.sort_unstable_by(f32::total_cmp);
    let (mut sum, mut weights) = (0.0, 0.0);
    for brightness in metered.into_iter().map(|m| f64::from(m.min(most))) {
        sum += brightness * brightness.ln();
        weights += brightness;
    }
    // Light that surfaces send on is dimmer than the lamps', and may be all there is to see.
    let least = if lighting.lamps.all().iter().any(Lamp::is_virtual) { 0.002 } else { 0.3 };
    NIGHT_KEY / ((sum / weights).exp() as f32).clamp(lit * least, lit * 16.0)
}

/// One exposed linear color as sRGB bytes. `dither` is in 0..1 and differs from pixel to pixel: it spreads the
/// rounding, so that clear skies show no steps.
pub(crate) fn pixel(exposed: Vec3, dither: f32) -> [u8; 3] {
    let display = filmic(exposed.max(Vec3::ZERO));
    display.to_array().map(|c| (srgb_from_linear(c) * 255.0 + dither) as u8)
}

/// Linear light in, linear light on the screen out, both with 1 as white.
fn filmic(color: Vec3) -> Vec3 {
    // Beyond this the curve is flat, and squares of absurd lights would overflow.
    let v = INTO * softened(color.min(Vec3::splat(1e6)));
    let rise = v * (v + 0.024_578_6) - 0.000_090_537;
    let fall = v * (0.983_729 * v + 0.432_951) + 0.238_081;
    (BACK * (rise / fall)).clamp(Vec3::ZERO, Vec3::ONE)
}

/// Less contrast about middle grey, for a low sun's shadows are deep: a clear day has six stops between them and its
/// whites.
fn softened(color: Vec3) -> Vec3 {
    const GREY: f32 = 0.18;
    color.map(|c| GREY * (c / GREY).powf(CONTRAST))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn black_is_black_white_is_white_and_grey_stays_grey() {
        assert!(pixel(Vec3::ZERO, 0.5).iter().all(|&c| c <= 2));
        assert!(pixel(Vec3::splat(50.0), 0.5).iter().all(|&c| c >= 250));
        let grey = pixel(Vec3::splat(0.18), 0.5);
        assert!(grey.iter().max().expect("3") - grey.iter().min().expect("3") <= 2, "{grey:?}");
    }

    #[test]
    fn brighter_is_brighter() {
        let tone = |i: i32| pixel(Vec3::splat((i as f32 * 0.25 - 9.0).exp2()), 0.5)[1];
        assert!((1..50).all(|i| tone(i) >= tone(i - 1)));
        assert!(tone(44) > tone(30) && tone(30) > tone(16));
    }
}
