//! Painted images: leaves cut out by their alpha, stone and turf that repeat without a seam.

use core::f64::consts::FRAC_PI_2;

use glam::DVec2;

use super::rng::{Rng, mix};
use crate::model::Image;

/// An sRGB colour, 0..1.
type Color = [f64; 3];

/// An image in the making, at first empty (alpha 0) and of one colour. The colour shows through filtered edges.
struct Canvas {
    width: usize,
    height: usize,
    rgba: Vec<u8>,
}

/// The outline of a leaf in its own frame: the stalk at the origin, the tip at (1, 0).
#[derive(Clone, Copy)]
enum Outline {
    /// Five lobes.
    Ivy,
    /// A pointed oval; its greatest width.
    Oval(f64),
    /// A blade of grass: its width at the foot, and how far its tip bends aside.
    Blade(f64, f64),
}

#[derive(Clone, Copy)]
struct Leaf {
    /// The stalk, pixels from the left and from the top.
    at: DVec2,
    /// Unit vector towards the tip.
    ahead: DVec2,
    /// From stalk to tip, pixels.
    length: f64,
    outline: Outline,
    color: Color,
}

impl Outline {
    /// Roughly the distance to the edge as a share of the leaf's length, positive inside.
    fn inside(self, q: DVec2) -> f64 {
        match self {
            Self::Ivy => {
                let r = q - DVec2::new(0.46, 0.0);
                let angle = libm::atan2(r.y, r.x);
                0.39 + 0.075 * libm::cos(5.0 * angle) + 0.06 * libm::cos(angle) - r.length()
            }
            Self::Oval(width) => (2.4 * width * q.x * (1.0 - q.x) * (1.2 - 0.55 * q.x) - q.y.abs()).min(q.x),
            Self::Blade(width, bend) => {
                (width * (1.0 - q.x * q.x * 0.96) - (q.y - bend * q.x * q.x).abs()).min(1.0 - q.x).min(q.x + 0.1)
            }
        }
    }
}

impl Canvas {
    fn new(width: usize, height: usize, color: Color) -> Self {
        let [r, g, b] = color.map(byte);
        Self { width, height, rgba: [r, g, b, 0].repeat(width * height) }
    }

    /// Paints a leaf over what is there. Where it would go over the left or right edge it comes back on the other side
    /// if the canvas `wraps`.
    fn leaf(&mut self, leaf: &Leaf, wraps: bool) {
        let reach = leaf.length * 1.1;
        let (lo, hi) = (leaf.at - DVec2::splat(reach), leaf.at + DVec2::splat(reach));
        let rows = (lo.y.max(0.0) as usize)..(hi.y.clamp(0.0, self.height as f64) as usize);
        for (y, x) in rows.flat_map(|y| ((lo.x.floor() as i64)..=(hi.x.ceil() as i64)).map(move |x| (y, x))) {
            let column = if wraps { x.rem_euclid(self.width as i64) } else { x };
            if !(0..self.width as i64).contains(&column) {
                continue;
            }
            let away = (DVec2::new(x as f64 + 0.5, y as f64 + 0.5) - leaf.at) / leaf.length;
            let q = DVec2::new(away.dot(leaf.ahead), away.dot(leaf.ahead.perp()));
            let inside = leaf.outline.inside(q);
            let cover = (0.5 + inside * leaf.length).clamp(0.0, 1.0);
            if cover > 0.0 {
                // Lighter along the midrib, darker where the leaf turns down at its edge, each half a little different.
                let rib = if q.y.abs() < 0.022 && q.x > 0.05 { 1.16 } else { 1.0 };
                let half = if q.y > 0.0 { 1.05 } else { 0.95 };
                let light = rib * half * (0.84 + 1.1 * inside.min(0.16));
                self.blend(column as usize, y, leaf.color.map(|c| c * light), cover);
            }
        }
    }

    fn blend(&mut self, x: usize, y: usize, color: Color, cover: f64) {
        let pixel = &mut self.rgba[4 * (y * self.width + x)..][..4];
        for (old, new) in pixel.iter_mut().zip(color) {
            let kept = f64::from(*old) / 255.0 * (1.0 - cover);
            *old = byte(kept + new.min(1.0) * cover);
        }
        pixel[3] = pixel[3].max(byte(cover));
    }

    fn finish(self, name: &str) -> Image {
        Image { name: name.to_owned(), width: self.width as u32, height: self.height as u32, rgba: self.rgba }
    }
}

fn byte(value: f64) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8
}

fn shaded(color: Color, light: f64) -> Color {
    color.map(|c| c * light)
}

fn direction(angle: f64) -> DVec2 {
    DVec2::new(libm::cos(angle), libm::sin(angle))
}

/// Two tiles side by side, each with an empty border: a patch of ivy on the left, a twig of beech on the right.
pub(crate) fn leaves(seed: u64) -> Image {
    const TILE: usize = 256;
    let mut rng = Rng::new(seed ^ 0x1ea5);
    let mut canvas = Canvas::new(2 * TILE, TILE, [0.33, 0.45, 0.19]);
    ivy(&mut canvas, &mut rng, TILE as f64);
    twig(&mut canvas, &mut rng, TILE as f64);
    canvas.finish("leaves")
}

fn ivy(canvas: &mut Canvas, rng: &mut Rng, side: f64) {
    const GREENS: [Color; 4] = [[0.25, 0.37, 0.17], [0.31, 0.45, 0.20], [0.37, 0.51, 0.23], [0.45, 0.55, 0.28]];
    let middle = DVec2::splat(side * 0.5);
    for i in 0..44 {
        // Leaves hang: their tips point down and outward.
        let t = f64::from(i) / 44.0;
        let out = direction(2.399_963 * f64::from(i)) * (1.0 - t).sqrt() * side * 0.36;
        let length = side * rng.range(0.12, 0.18);
        let ahead = (DVec2::new(out.x / side, 0.55) + direction(rng.range(0.0, 6.3)) * 0.35).normalize();
        let at = middle + out - ahead * length * 0.5;
        let color = shaded(GREENS[(i as usize * 4 / 44).min(3)], rng.range(0.86, 1.12));
        canvas.leaf(&Leaf { at, ahead, length, outline: Outline::Ivy, color }, false);
    }
}

fn twig(canvas: &mut Canvas, rng: &mut Rng, side: f64) {
    const GREENS: [Color; 3] = [[0.36, 0.50, 0.20], [0.45, 0.58, 0.24], [0.56, 0.65, 0.30]];
    let foot = DVec2::new(side * 1.5, side * 0.97);
    let bark = [0.30, 0.24, 0.17];
    for shoot in 0..5 {
        let angle = -FRAC_PI_2 + 0.46 * (f64::from(shoot) - 2.0) + rng.range(-0.1, 0.1);
        let ahead = direction(angle);
        let length = side * (0.80 - 0.09 * (f64::from(shoot) - 2.0).abs());
        let stalk = Leaf { at: foot, ahead, length, outline: Outline::Blade(0.011, 0.0), color: bark };
        canvas.leaf(&stalk, false);
        for k in 0..11 {
            let t = 0.18 + 0.74 * f64::from(k) / 10.0;
            let lean = if k % 2 == 0 { 0.85 } else { -0.85 } * (1.15 - 0.6 * t) + rng.range(-0.25, 0.25);
            let length = side * rng.range(0.13, 0.18);
            let color = shaded(rng.pick(&GREENS), rng.range(0.85, 1.12));
            let at = foot + ahead * (t * side * (0.78 - 0.09 * (f64::from(shoot) - 2.0).abs()));
            canvas
                .leaf(&Leaf { at, ahead: direction(angle + lean), length, outline: Outline::Oval(0.30), color }, false);
        }
    }
}

/// The right half of a fern's frond: the stem along the left edge, the tip at the top. To be mirrored about the stem.
pub(crate) fn fern(seed: u64) -> Image {
    const SIDE: usize = 128;
    let side = SIDE as f64;
    let mut rng = Rng::new(seed ^ 0xfe29);
    let mut canvas = Canvas::new(SIDE, SIDE, [0.29, 0.41, 0.16]);
    for k in 0..17 {
        let t = f64::from(k) / 17.0;
        // Widest a third of the way up.
        let length = side * 0.92 * (0.45 + 2.2 * t).min(1.0) * (1.0 - t * t * 0.96);
        let ahead = direction(-0.28 - 0.5 * t);
        let color = shaded([0.36, 0.49, 0.19], rng.range(0.85, 1.15));
        let at = DVec2::new(-1.0, side * (0.97 - 0.93 * t));
        let width = 0.17 * side * 0.45 / length.max(0.3 * side);
        canvas.leaf(&Leaf { at, ahead, length, outline: Outline::Oval(width.max(0.06)), color }, false);
    }
    let stem = Leaf {
        at: DVec2::new(0.0, side * 0.99),
        ahead: DVec2::NEG_Y,
        length: side * 0.97,
        outline: Outline::Blade(0.018, 0.0),
        color: [0.40, 0.42, 0.20],
    };
    canvas.leaf(&stem, false);
    canvas.finish("fern")
}

/// A stand of grass that repeats sideways: rooted in the bottom row, the top rows empty.
pub(crate) fn grass(seed: u64) -> Image {
    const SIDE: usize = 128;
    const GREENS: [Color; 4] = [[0.36, 0.45, 0.19], [0.45, 0.52, 0.24], [0.55, 0.56, 0.29], [0.64, 0.60, 0.37]];
    let side = SIDE as f64;
    let mut rng = Rng::new(seed ^ 0x92a5);
    let mut canvas = Canvas::new(SIDE, SIDE, [0.42, 0.48, 0.22]);
    for i in 0..34 {
        let length = side * rng.range(0.35, 0.93);
        let color = shaded(rng.pick(&GREENS), rng.range(0.8, 1.1));
        let outline = Outline::Blade(3.2 / length, rng.range(-0.30, 0.30));
        let at = DVec2::new(side * (f64::from(i) + rng.unit()) / 34.0, side + 1.0);
        let ahead = direction(-FRAC_PI_2 + rng.range(-0.22, 0.22));
        canvas.leaf(&Leaf { at, ahead, length, outline, color }, true);
    }
    canvas.finish("grass")
}

/// Courses of hewn stone, four across and eight up.
pub(crate) fn masonry(seed: u64) -> Image {
    const SIDE: usize = 256;
    const COURSES: u64 = 8;
    let course_px = SIDE as f64 / COURSES as f64;
    opaque("masonry", SIDE, |x, y| {
        let course = (y / course_px) as u64;
        // Blocks of a course: four, their joints pushed about.
        let joint = |k: u64| SIDE as f64 * (k as f64 + 0.55 * chance(seed, course, k % 4)) / 4.0;
        let shift = (course % 2) as f64 * SIDE as f64 / 8.0;
        let along = (x + shift) % SIDE as f64;
        let block = (0..4).rev().find(|&k| joint(k) <= along).unwrap_or(3);
        let next = if block == 3 { SIDE as f64 + joint(0) } else { joint(block + 1) };
        let from = if along < joint(0) { along + SIDE as f64 - joint(3) } else { along - joint(block) };
        let to = if along < joint(0) { joint(0) - along } else { next - along };
        let gap = from.min(to).min(y % course_px).min(course_px - y % course_px);
        let tone = chance(seed ^ 0x70, course, block);
        let warm = chance(seed ^ 0x71, course, block);
        let grain = tiled_noise(seed, DVec2::new(x, y) / SIDE as f64, &[(8, 0.5), (32, 0.3), (96, 0.25)]);
        let light = (0.80 + 0.20 * tone + 0.16 * grain) * if gap < 1.6 { 0.72 } else { 1.0 };
        [0.80 * light, (0.745 + 0.02 * warm) * light, (0.64 + 0.05 * warm) * light]
    })
}

/// Fine light and dark for ground whose colour the vertices give.
pub(crate) fn turf(seed: u64) -> Image {
    opaque("turf", 256, |x, y| {
        let grain = tiled_noise(seed ^ 0x7f, DVec2::new(x, y) / 256.0, &[(6, 0.5), (24, 0.5), (80, 0.6)]);
        let light = 0.84 + 0.22 * grain;
        [light, light, light * 0.97]
    })
}

fn opaque(name: &str, side: usize, color: impl Fn(f64, f64) -> Color) -> Image {
    let pixel = |i: usize| {
        let [r, g, b] = color((i % side) as f64 + 0.5, (i / side) as f64 + 0.5).map(byte);
        [r, g, b, 255]
    };
    let rgba = (0..side * side).flat_map(pixel).collect();
    Image { name: name.to_owned(), width: side as u32, height: side as u32, rgba }
}

/// A number in 0..1 for a place of a lattice.
fn chance(seed: u64, x: u64, y: u64) -> f64 {
    let bits = mix(seed ^ mix(x.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ mix(y.wrapping_add(0x51))));
    (bits >> 11) as f64 / (1_u64 << 53) as f64
}

/// Smooth noise about -1..1 over the unit square that repeats without a seam; octaves are (cells, weight).
fn tiled_noise(seed: u64, p: DVec2, octaves: &[(u64, f64)]) -> f64 {
    let octave = |&(cells, weight): &(u64, f64)| {
        let at = p * cells as f64;
        let (cell, f) = (at.floor(), at - at.floor());
        let corner = |dx: u64, dy: u64| {
            2.0 * chance(seed ^ cells, (cell.x as u64 + dx) % cells, (cell.y as u64 + dy) % cells) - 1.0
        };
        let s = f * f * (DVec2::splat(3.0) - 2.0 * f);
        let low = corner(0, 0) + s.x * (corner(1, 0) - corner(0, 0));
        let high = corner(0, 1) + s.x * (corner(1, 1) - corner(0, 1));
        weight * (low + s.y * (high - low))
    };
    octaves.iter().map(octave).sum()
}
