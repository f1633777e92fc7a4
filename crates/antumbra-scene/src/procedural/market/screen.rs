//! The screen on the north side, on a scaffold: a light with a surface that shows a video.

use glam::{DVec2, DVec3};

use super::Market;
use crate::model::{AreaLight, AreaShape};
use crate::procedural::palette::Paint;
use crate::procedural::screen::video;
use crate::procedural::solids::{Builder, Turn};

/// Metres across and high.
const SIZE: DVec2 = DVec2::new(4.0, 2.25);
const MIDDLE: DVec3 = DVec3::new(2.6, 3.05, -13.3);
/// Candela per square metre where the video is white.
const LUMINANCE: f32 = 500.0;

pub(super) fn build(market: &mut Market, seed: u64) {
    market.add("screen", DVec3::new(MIDDLE.x, 0.0, MIDDLE.z), Turn::NONE, |b, _, _| scaffold(b));
    market.scene.images = video::frames(seed);
    market.scene.area_lights = vec![AreaLight {
        name: "screen".to_owned(),
        shape: AreaShape::Rectangle { width_m: SIZE.x, height_m: SIZE.y },
        position_world: MIDDLE,
        direction_world: DVec3::Z,
        up_world: DVec3::Y,
        luminance: [LUMINANCE; 3],
        frames: (0..market.scene.images.len()).collect(),
        frames_per_second: video::FPS,
    }];
}

/// The screen's case and what carries it; the screen itself is the plane z = 0.
fn scaffold(b: &mut Builder) {
    let (half, rim) = (SIZE * 0.5, 0.1);
    let (low, high) = (MIDDLE.y - half.y - rim, MIDDLE.y + half.y + rim);
    b.cuboid(Paint::GlassDark, DVec3::new(-half.x - rim, low, -0.3), DVec3::new(half.x + rim, high, -0.03));
    let at = DVec3::new;
    for x in [-half.x, half.x] {
        for z in [-0.45, -1.35] {
            b.strut(Paint::Steel, at(x, -0.1, z), at(x, high + 0.2, z), 0.045, 8);
        }
        for i in 0..3 {
            let y = 0.3 + 1.2 * f64::from(i);
            b.strut(Paint::Steel, at(x, y, -0.45), at(x, y + 1.1, -1.35), 0.025, 6);
        }
        b.pillar(Paint::GlassDark, DVec2::new(x + x.signum() * 0.5, -0.3), DVec2::new(0.6, 0.5), 0.0, 1.5);
    }
    for y in [0.3, 1.7, high] {
        b.strut(Paint::Steel, at(-half.x, y, -0.45), at(half.x, y, -0.45), 0.03, 6);
    }
    // A barrier of bars before it.
    for i in 0..31 {
        let x = -3.0 + 0.2 * f64::from(i);
        b.strut(Paint::Steel, at(x, 0.0, 2.2), at(x, 1.05, 2.2), 0.012, 5);
    }
    for y in [0.12, 1.05] {
        b.strut(Paint::Steel, at(-3.05, y, 2.2), at(3.05, y, 2.2), 0.022, 6);
    }
}
