//! Lamps that stay: four on posts, eight lanterns under the arcades and the aqueduct.

use glam::{DVec2, DVec3};

use super::houses::{ARCADE_M, CEILING_M};
use super::{Market, SQUARE};
use crate::model::Light;
use crate::procedural::palette::Paint;
use crate::procedural::solids::{Builder, Turn};
use crate::procedural::view::point;
use crate::procedural::village::Glow;
use crate::procedural::village::lamps::{Lamp, Make, post};

/// Posts and the way to what they light.
const POSTS: [(DVec2, DVec2, Make); 4] = [
    (DVec2::new(-14.6, -11.6), DVec2::new(0.6, 0.8), Make::Shade),
    (DVec2::new(15.6, -11.8), DVec2::new(-0.8, 0.6), Make::Lantern),
    (DVec2::new(15.9, 6.4), DVec2::new(-1.0, 0.0), Make::Shade),
    (DVec2::new(-1.8, 12.9), DVec2::new(0.0, -1.0), Make::Shade),
];
/// Candela of the posts' lamps and of the lanterns.
const POST_CD: f32 = 110.0;
const LANTERN_CD: f32 = 42.0;

/// From the ceiling down to the light, which is a little below the glass that seems to give it off.
const LIGHT_BELOW_M: f64 = 1.28;

/// Where a ceiling has a lantern.
const HUNG: [DVec3; 8] = [
    DVec3::new(-11.5, CEILING_M, -SQUARE.y - ARCADE_M * 0.55),
    DVec3::new(-3.0, CEILING_M, -SQUARE.y - ARCADE_M * 0.55),
    DVec3::new(11.0, CEILING_M, -SQUARE.y - ARCADE_M * 0.55),
    DVec3::new(SQUARE.x + ARCADE_M * 0.55, CEILING_M, -8.0),
    DVec3::new(SQUARE.x + ARCADE_M * 0.55, CEILING_M, 1.5),
    DVec3::new(8.0, CEILING_M, SQUARE.y + ARCADE_M * 0.55),
    DVec3::new(-9.0, CEILING_M, SQUARE.y + ARCADE_M * 0.55),
    DVec3::new(-SQUARE.x - 0.7, 4.4, -9.0),
];

pub(super) fn build(market: &mut Market) {
    for (at, inward, make) in POSTS {
        let (lamp, foot) = (Lamp { at, inward, make }, DVec3::new(at.x, 0.0, at.y));
        market.add("lamp post", DVec3::ZERO, Turn::NONE, |b, _, _| post(b, &lamp, foot));
        let light = lamp.light(next_name(market), foot);
        market.scene.lights.push(Light { intensity: POST_CD, range_m: Some(16.0), ..light });
    }
    let mesh = market.mesh("hung lantern", |b, _, _| hung(b));
    for at in HUNG {
        market.place("hung lantern", mesh, at, Turn::NONE);
        let name = next_name(market);
        market.scene.lights.push(point(name, at - DVec3::Y * LIGHT_BELOW_M, 13.0, LANTERN_CD, [1.0, 0.62, 0.3]));
    }
}

/// The moon comes first, so that lamps are counted from 1.
fn next_name(market: &Market) -> String {
    format!("lamp{:02}", market.scene.lights.len())
}

/// A lantern on a rod, hanging from y = 0.
fn hung(b: &mut Builder) {
    let at = DVec2::ZERO;
    b.cone(Paint::GlassDark, at, 6, [(0.015, -0.66), (0.015, 0.3)]);
    b.cone(Paint::GlassDark, at, 6, [(0.2, -0.8), (0.03, -0.62)]);
    b.cone(Glow::Lantern, at, 6, [(0.1, -1.08), (0.16, -0.79)]);
    b.cone(Paint::GlassDark, at, 6, [(0.1, -1.13), (0.12, -1.07)]);
}
