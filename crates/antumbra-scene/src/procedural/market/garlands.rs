//! Garlands from the mast over the fountain to the fronts around: a line that sags, with pennants and small bulbs.

use glam::{DVec2, DVec3};

use super::aqueduct::CORNICE_M;
use super::looks::Look;
use super::square::MAST_M;
use super::{Market, SQUARE};
use crate::procedural::palette::Paint;
use crate::procedural::shapes::Detail;
use crate::procedural::solids::{Builder, Shading, Turn};

/// Where the lines are tied at the fronts.
const ENDS: [DVec3; 8] = [
    DVec3::new(-SQUARE.x + 0.2, CORNICE_M, -6.75),
    DVec3::new(-SQUARE.x + 0.2, CORNICE_M, 2.25),
    DVec3::new(-8.0, 5.8, SQUARE.y - 0.05),
    DVec3::new(4.5, 5.8, SQUARE.y - 0.05),
    DVec3::new(SQUARE.x - 0.05, 5.8, 7.5),
    DVec3::new(SQUARE.x - 0.05, 5.8, -5.0),
    DVec3::new(9.0, 5.9, -SQUARE.y + 0.05),
    DVec3::new(-6.5, 5.9, -SQUARE.y + 0.05),
];
/// How far a line's middle hangs below the straight way.
const SAG_M: f64 = 1.1;

/// A point of a line: 0 is at the mast, 1 at the front.
pub(super) fn point(line: usize, t: f64) -> DVec3 {
    let mast = DVec3::Y * (MAST_M - 0.14);
    mast.lerp(ENDS[line], t) - DVec3::Y * 4.0 * SAG_M * t * (1.0 - t)
}

pub(super) fn build(market: &mut Market) {
    market.add("garlands", DVec3::ZERO, Turn::NONE, |b, _, detail| {
        for line in 0..ENDS.len() {
            garland(b, detail, line);
        }
    });
}

fn garland(b: &mut Builder, detail: Detail, line: usize) {
    let steps = detail.sides(28.0);
    let at = |i: usize| point(line, i as f64 / steps as f64);
    for i in 0..steps {
        let (from, to) = (at(i), at(i + 1));
        b.strut(Paint::GlassDark, from, to, 0.012, 4);
        let middle = (from + to) * 0.5;
        if i % 4 == 1 {
            let profile = [(0.0, -0.13), (0.035, -0.1), (0.035, -0.07), (0.015, -0.03), (0.015, 0.01)];
            b.within(middle, Turn::NONE, |b| {
                b.turned(Look::Bulb, Shading::Smooth, DVec2::ZERO, detail.sides(7.0), &profile);
            });
        } else {
            pennant(b, [Look::CanvasRed, Look::CanvasOchre, Look::CanvasBlue, Look::CanvasWhite][i % 4], from, to);
        }
    }
}

/// A thin triangle of cloth under a piece of line.
fn pennant(b: &mut Builder, paint: Look, from: DVec3, to: DVec3) {
    let along = to - from;
    let across = along.cross(DVec3::Y).normalize() * 0.004;
    let tip = (from + to) * 0.5 - DVec3::Y * (0.4 * along.length()).min(0.4);
    let ring = |side: DVec3| vec![from + along * 0.1 + side, tip + side, to - along * 0.1 + side];
    b.loft(paint, Shading::Flat, &[ring(-across), ring(across)]);
}
