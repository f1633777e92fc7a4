//! Ivy on the walls, ferns in the shade, grass everywhere else.

use core::f64::consts::TAU;

use glam::{DVec2, DVec3};

use super::looks::{FERN, GRASS, IVY};
use super::stone::{FOOT_M, Wall};
use super::{Site, ground};
use crate::procedural::noise::{fractal_noise, smoothstep};
use crate::procedural::rng::Rng;
use crate::procedural::sheets::{Card, Sheets, Vertex};

/// Sprigs of ivy per square metre of overgrown wall, at scale 1.
const SPRIGS_PER_M2: f64 = 4.8;

pub(super) fn ivy(s: &mut Sheets, site: &Site, walls: &[Wall]) {
    for wall in walls {
        for back in [false, true] {
            let mut rng = site.rng.fork(200 + 2 * wall.tag + u64::from(back));
            climb(s, site, &mut rng, wall, back);
        }
    }
}

/// Ivy on one side of a wall: thick near the ground and under the tops, thin in between.
fn climb(s: &mut Sheets, site: &Site, rng: &mut Rng, wall: &Wall, back: bool) {
    let count = site.many(SPRIGS_PER_M2 * wall.length * wall.height);
    let seed = site.seed ^ (0x1e0 + 2 * wall.tag + u64::from(back));
    for _ in 0..count {
        let p = DVec2::new(rng.range(0.0, wall.length), rng.range(wall.foot, wall.height));
        let (size, lean, roll) = (rng.range(0.34, 0.62), rng.range(0.15, 0.75), rng.range(-0.7, 0.7));
        let tone = rng.range(0.8, 1.15);
        let patch = fractal_noise(seed, DVec2::new(p.x / 4.6, p.y / 7.5), 3, 0.55);
        let grows = wall.ivy - 0.72 + 1.15 * patch - 0.055 * (p.y - FOOT_M);
        if grows < 0.0 || wall.stone(site, p) < -0.12 || !rng.chance(0.35 + grows * 2.0) {
            continue;
        }
        let (on, out) = surface(wall, p, back);
        let along = out.cross(DVec3::Y);
        let down = (DVec3::NEG_Y + along * roll + out * lean).normalize();
        let size = size * site.plant_size;
        let foot = on + out * (0.05 + 0.08 * tone) + down * size;
        let across = down.cross(out).normalize() * size;
        // The card's upper edge lies at the wall, its lower one hangs free.
        let color = DVec3::new(0.92, 1.0, 0.88) * tone;
        s.card(
            IVY,
            &Card { foot, across, up: down * (-2.0 * size), normal: (out + DVec3::Y * 0.35).normalize(), color },
        );
    }
}

/// A point of a wall's side, and the way out from there.
fn surface(wall: &Wall, p: DVec2, back: bool) -> (DVec3, DVec3) {
    let depth = if back { wall.thick } else { 0.0 };
    let out = (wall.place(p, -1.0) - wall.place(p, 0.0)).normalize();
    (wall.place(p, depth), if back { -out } else { out })
}

/// Ferns: in drifts about the walls and under the trees.
pub(super) fn ferns(s: &mut Sheets, site: &Site) {
    let mut rng = site.rng.fork(300);
    let mut planted = 0;
    for _ in 0..site.many(9000.0) {
        let at = DVec2::new(rng.range(-66.0, 48.0), rng.range(-36.0, 52.0));
        let (size, turn) = (rng.range(0.55, 1.15), rng.range(0.0, TAU));
        let drift = fractal_noise(site.seed ^ 0x301, at / 7.0, 3, 0.5);
        if planted < site.many(240.0) && drift > 0.27 && !trodden(site, at) {
            planted += 1;
            fern(s, site, &mut rng, at, size * site.plant_size, turn);
        }
    }
}

fn trodden(site: &Site, at: DVec2) -> bool {
    ground::flags(site, at.x, at.y) > 0.0 || ground::path(at.x, at.y) > 0.3
}

fn fern(s: &mut Sheets, site: &Site, rng: &mut Rng, at: DVec2, size: f64, turn: f64) {
    let foot = DVec3::new(at.x, ground::height(site, at.x, at.y) - 0.03, at.y);
    let tone = rng.range(0.8, 1.15);
    for k in 0..7 {
        let angle = turn + TAU * f64::from(k) / 7.0 + rng.range(-0.25, 0.25);
        let out = DVec3::new(libm::cos(angle), 0.0, libm::sin(angle));
        let long = size * rng.range(0.8, 1.15);
        let rise = rng.range(0.75, 1.15);
        frond(s, foot, out, long, rise, DVec3::new(1.0, 1.05, 0.85) * tone);
    }
}

/// One frond: up, over, and down again.
fn frond(s: &mut Sheets, foot: DVec3, out: DVec3, long: f64, rise: f64, color: DVec3) {
    const STEPS: u32 = 4;
    let across = out.cross(DVec3::Y) * long * 0.2;
    let mut vertices = Vec::with_capacity(10);
    for i in 0..=STEPS {
        let t = f64::from(i) / f64::from(STEPS);
        let middle = foot + out * long * t * (0.55 + 0.45 * t) + DVec3::Y * long * rise * t * (1.25 - 0.85 * t);
        let normal = (DVec3::Y + out * 0.8 * t).normalize();
        for side in [-1.0, 1.0] {
            let at = middle + across * side - DVec3::Y * long * 0.03;
            vertices.push(Vertex { at, normal, texcoord: DVec2::new(t, side), color });
        }
    }
    let quads = (0..STEPS).map(|i| 2 * i);
    let triangles: Vec<_> = quads.flat_map(|i| [[i, i + 1, i + 3], [i, i + 3, i + 2]]).collect();
    s.add(FERN, &vertices, &triangles);
}

/// Tufts of grass, thick near the buildings where eyes are near, thinner away from them.
pub(super) fn grass(s: &mut Sheets, site: &Site) {
    let mut rng = site.rng.fork(400);
    for _ in 0..site.many(15_000.0) {
        let at = DVec2::new(rng.range(-72.0, 50.0), rng.range(-40.0, 56.0));
        let (height, turn, shift) = (rng.range(0.22, 0.62), rng.range(0.0, TAU), rng.unit());
        let (keep, tone) = (rng.unit(), rng.range(0.75, 1.2));
        let patch = fractal_noise(site.seed ^ 0x401, at / 9.0, 3, 0.55);
        let dense = (0.30 + 0.7 * patch).clamp(0.03, 0.9) * smoothstep(34.0, 4.0, ground::outside(at.x, at.y));
        if keep > dense || trodden(site, at) {
            continue;
        }
        let tall = height * (1.0 + 0.5 * patch) * site.plant_size;
        let color = DVec3::new(1.0, 1.0, 0.9).lerp(DVec3::new(0.8, 1.0, 0.6), smoothstep(-0.3, 0.4, patch)) * tone;
        tuft(s, site, at, tall, turn, shift, color);
    }
}

/// Three blades' worth of cards, crossed.
fn tuft(s: &mut Sheets, site: &Site, at: DVec2, tall: f64, turn: f64, shift: f64, color: DVec3) {
    let foot = DVec3::new(at.x, ground::height(site, at.x, at.y) - 0.02, at.y);
    for k in 0..3 {
        let angle = turn + TAU * f64::from(k) / 6.0;
        let across = DVec3::new(libm::cos(angle), 0.0, libm::sin(angle)) * tall * 0.62;
        let lean = DVec3::new(-across.z, 0.0, across.x) * 0.3;
        let up = DVec3::Y * tall * 1.12 + lean;
        let corners = [(-1.0, 0.0), (1.0, 0.0), (1.0, 1.0), (-1.0, 1.0)];
        // Mostly the card's own: a renderer turns a normal over where it looks away, and grass must not be lit from below.
        let normal = (across.cross(DVec3::Y).normalize() + DVec3::Y * 0.25).normalize();
        // A little beyond the image's upper edge, where the empty row goes on.
        let vertices = corners.map(|(x, y)| Vertex {
            at: foot + across * x + up * y,
            normal,
            texcoord: DVec2::new(shift + 0.9 * x * 0.5 + 0.21 * f64::from(k), 1.0 - 1.12 * y),
            color,
        });
        s.add(GRASS, &vertices, &[[0, 1, 2], [0, 2, 3]]);
    }
}
