//! What the screen shows: four seconds that go round, of a sun that rises over hills and a sea, and of bars of colour that
//! pass.

use glam::DVec3;

use crate::model::Image;
use crate::procedural::rng::Rng;

/// Frames of the video.
const FRAMES: u32 = 32;
/// Frames in a second.
pub(crate) const FPS: f64 = 8.0;
const WIDTH: u32 = 64;
const HEIGHT: u32 = 36;

/// All frames, to be shown [`FPS`] a second.
pub(crate) fn frames(seed: u64) -> Vec<Image> {
    let mut rng = Rng::new(seed ^ 0x7e1e);
    let hills: Vec<f64> = (0..6).map(|_| rng.range(0.0, core::f64::consts::TAU)).collect();
    (0..FRAMES).map(|frame| image(frame, &hills)).collect()
}

fn image(frame: u32, hills: &[f64]) -> Image {
    let time = f64::from(frame) / f64::from(FRAMES);
    let mut rgba = Vec::with_capacity((4 * WIDTH * HEIGHT) as usize);
    for y in 0..HEIGHT {
        for x in 0..WIDTH {
            let (u, v) = ((f64::from(x) + 0.5) / f64::from(WIDTH), (f64::from(y) + 0.5) / f64::from(HEIGHT));
            let color = if time < 0.75 { landscape(u, v, time / 0.75, hills) } else { bars(u, v, (time - 0.75) * 4.0) };
            rgba.extend(color.to_array().map(|c| (255.0 * c.clamp(0.0, 1.0) + 0.5) as u8));
            rgba.push(255);
        }
    }
    Image { name: format!("frame{frame:02}"), width: WIDTH, height: HEIGHT, rgba }
}

/// A sun that rises, before it hills, above it a sky that turns from violet to blue.
fn landscape(u: f64, v: f64, time: f64, hills: &[f64]) -> DVec3 {
    let wave = |i: usize, pitch: f64| libm::sin(pitch * u + hills[i]) * 0.05;
    let ridge = 0.66 + wave(0, 5.0) + wave(1, 11.0) * 0.5;
    let shore = 0.84 + wave(2, 3.0) * 0.5;
    let (sun_u, sun_v) = (0.25 + 0.4 * time, 0.8 - 0.62 * time);
    let from_sun = libm::hypot((u - sun_u) * 1.78, v - sun_v);
    if v > shore {
        // The sea, with the sun in it.
        let glitter =
            (0.5 + 0.5 * libm::sin(150.0 * v + 20.0 * libm::sin(9.0 * u))) * (1.0 - 3.0 * (u - sun_u).abs()).max(0.0);
        return DVec3::new(0.05, 0.16, 0.3) + DVec3::new(0.9, 0.6, 0.3) * glitter;
    }
    if v > ridge {
        return DVec3::new(0.1, 0.16, 0.09) * (0.6 + time);
    }
    let sky = DVec3::new(0.42, 0.2, 0.46).lerp(DVec3::new(0.32, 0.6, 0.98), time * (1.0 - v * 0.5));
    let dusk = DVec3::new(1.0, 0.5, 0.16) * libm::exp(-4.0 * from_sun) * 1.2;
    let disc = if from_sun < 0.075 { DVec3::new(1.0, 0.95, 0.8) } else { DVec3::ZERO };
    sky + dusk + disc
}

/// Bars of strong colours that move to the left.
fn bars(u: f64, v: f64, time: f64) -> DVec3 {
    let colors = [
        DVec3::new(1.0, 0.1, 0.15),
        DVec3::new(1.0, 0.85, 0.1),
        DVec3::new(0.1, 0.85, 0.3),
        DVec3::new(0.1, 0.35, 1.0),
        DVec3::new(0.9, 0.15, 0.9),
    ];
    let place = (u + 0.4 * time + 0.06 * v) * 5.0;
    colors[place as usize % colors.len()] * if (0.12..=0.88).contains(&v) { 1.0 } else { 0.15 }
}
