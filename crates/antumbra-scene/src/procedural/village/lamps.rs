//! What shines: street lamps of two makes, and windows.

use core::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::Glow;
use super::land::{GREEN_M, LANE_M, Land};
use crate::model::Light;
use crate::procedural::palette::Paint;
use crate::procedural::solids::{Builder, Turn};
use crate::procedural::view::{Cone, point, spot};

/// From lamp to lamp along a lane.
const STEP_M: f64 = 29.0;
/// From the post to the lamp.
const ARM_M: f64 = 1.15;
/// Candlelight and oil lamps are warm.
const WARM: [f32; 3] = [1.0, 0.66, 0.34];

/// How a lamp is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::procedural) enum Make {
    /// A shade that throws its light down: a spot light.
    Shade,
    /// A lantern of glass: a point light.
    Lantern,
}

/// A street lamp.
#[derive(Clone, Copy, Debug)]
pub(in crate::procedural) struct Lamp {
    pub at: DVec2,
    /// Unit vector towards the lane.
    pub inward: DVec2,
    pub make: Make,
}

/// All street lamps: four about the green, then along each lane on alternating sides.
pub(super) fn along(land: &Land) -> Vec<Lamp> {
    let mut lamps: Vec<Lamp> = (0..4)
        .map(|i| TAU * (f64::from(i) + 0.42) / 4.0)
        .map(|angle| DVec2::new(libm::cos(angle), libm::sin(angle)))
        .map(|out| Lamp { at: out * (GREEN_M - 2.2), inward: -out, make: Make::Lantern })
        .collect();
    for lane in -land.lanes..=land.lanes {
        let line = |x: f64| DVec2::new(x, land.lane_z(lane, x));
        lamps.extend(beside(land.reach, lane == 0, line));
    }
    if land.lanes > 0 {
        let line = |z: f64| DVec2::new(land.cross_x(z), z);
        lamps.extend(beside(land.cross_reach() - 12.0, true, line));
    }
    lamps
}

/// Lamps along a lane, but not where it runs over the green.
fn beside(reach: f64, over_green: bool, line: impl Fn(f64) -> DVec2) -> Vec<Lamp> {
    let count = (2.0 * reach / STEP_M).round().max(1.0) as usize;
    let mut lamps = Vec::new();
    for i in 0..count {
        let t = reach * (2.0 * (i as f64 + 0.5) / count as f64 - 1.0);
        let (middle, way) = (line(t), (line(t + 0.5) - line(t - 0.5)).normalize());
        let inward = way.perp() * if i % 2 == 0 { 1.0 } else { -1.0 };
        if over_green && middle.length() < GREEN_M + 5.0 {
            continue;
        }
        let make = if i % 3 == 1 { Make::Lantern } else { Make::Shade };
        lamps.push(Lamp { at: middle - inward * (LANE_M + 0.55), inward, make });
    }
    lamps
}

impl Lamp {
    /// Where its light is: a little below what seems to give it off.
    fn light_height(&self) -> f64 {
        match self.make {
            Make::Shade => 3.98,
            Make::Lantern => 3.48,
        }
    }

    /// Its light; `foot` is where its post meets the ground.
    pub fn light(&self, name: String, foot: DVec3) -> Light {
        let out = self.inward * ARM_M;
        let position = foot + DVec3::new(out.x, self.light_height(), out.y);
        match self.make {
            Make::Lantern => point(name, position, 15.0, 170.0, WARM),
            Make::Shade => {
                let axis = DVec3::NEG_Y + DVec3::new(self.inward.x, 0.0, self.inward.y) * 0.14;
                spot(name, position, Cone { axis, inner_deg: 34.0, outer_deg: 66.0 }, 20.0, 480.0, [1.0, 0.74, 0.45])
            }
        }
    }
}

/// A post with an arm that reaches over the lane, and the lamp that hangs from it.
pub(in crate::procedural) fn post(b: &mut Builder, lamp: &Lamp, foot: DVec3) {
    b.within(foot, Turn::facing(lamp.inward), |b| {
        b.cone(Paint::GlassDark, DVec2::ZERO, 8, [(0.15, -0.5), (0.11, 0.7)]);
        b.cone(Paint::GlassDark, DVec2::ZERO, 8, [(0.075, 0.6), (0.05, 4.75)]);
        b.cone(Paint::GlassDark, DVec2::ZERO, 8, [(0.09, 4.7), (0.0, 4.95)]);
        b.strut(Paint::GlassDark, DVec3::Y * 4.55, DVec3::new(ARM_M + 0.08, 4.6, 0.0), 0.035, 6);
        b.strut(Paint::GlassDark, DVec3::Y * 3.9, DVec3::new(0.62, 4.56, 0.0), 0.022, 5);
        let at = DVec2::X * ARM_M;
        match lamp.make {
            Make::Shade => {
                b.cone(Glow::Lantern, at, 10, [(0.17, 4.1), (0.17, 4.24)]);
                b.cone(Paint::GlassDark, at, 10, [(0.36, 4.18), (0.07, 4.46)]);
                b.cone(Paint::GlassDark, at, 6, [(0.03, 4.4), (0.03, 4.62)]);
            }
            Make::Lantern => {
                b.cone(Paint::GlassDark, at, 6, [(0.13, 3.62), (0.15, 3.70)]);
                b.cone(Glow::Lantern, at, 6, [(0.12, 3.69), (0.19, 4.1)]);
                b.cone(Paint::GlassDark, at, 6, [(0.26, 4.08), (0.04, 4.34)]);
                b.cone(Paint::GlassDark, at, 6, [(0.025, 4.3), (0.025, 4.62)]);
            }
        }
    });
}

/// A window that throws light outside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    /// The middle of the pane's outer side.
    pub pane: DVec3,
    /// Unit vector out of the house.
    pub out: DVec3,
}

impl Window {
    /// From the house's frame to the world's.
    pub fn placed(&self, at: DVec3, turn: Turn) -> Self {
        Self { pane: at + turn.apply(self.pane), out: turn.apply(self.out) }
    }

    /// A spot just outside the pane, clear of the sill, that shines out and down.
    pub fn light(&self, name: String) -> Light {
        let cone = Cone { axis: self.out - DVec3::Y * 0.3, inner_deg: 20.0, outer_deg: 62.0 };
        spot(name, self.pane + self.out * 0.4, cone, 12.0, 120.0, [1.0, 0.7, 0.38])
    }
}
