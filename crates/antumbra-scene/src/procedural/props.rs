//! Things that stand about in more than one scene: people, carts, barrels, crates.

use glam::{DVec2, DVec3};

use super::palette::Paint;
use super::rng::Rng;
use super::shapes::{Detail, hoop, smooth_profile};
use super::solids::{Builder, Shading};

/// Someone who stands, looking along -Z.
pub(crate) fn person(b: &mut Builder, rng: &mut Rng) {
    let tall = rng.range(0.9, 1.1);
    let coat = rng.pick(&[Paint::CarBlue, Paint::BrickRed, Paint::GlassDark, Paint::Timber, Paint::LeafDeep]);
    let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z) * tall;
    for side in [-1.0, 1.0] {
        let stride = rng.range(-0.12, 0.12) * side;
        b.strut(Paint::Asphalt, at(side * 0.11, -0.05, stride), at(side * 0.09, 0.88, 0.0), 0.085 * tall, 7);
        let reach = rng.range(-0.1, 0.25);
        b.strut(coat, at(side * 0.24, 1.4, 0.0), at(side * 0.31, 0.85, -reach), 0.055 * tall, 6);
    }
    let profile = [(0.17, 0.82), (0.2, 1.0), (0.19, 1.2), (0.23, 1.36), (0.16, 1.47), (0.06, 1.52), (0.06, 1.58)];
    let profile = profile.map(|(radius, y)| (radius * tall, y * tall));
    b.turned(coat, Shading::Smooth, DVec2::ZERO, 10, &profile);
    let head = [(0.03, 1.53), (0.085, 1.58), (0.105, 1.66), (0.1, 1.73), (0.06, 1.79), (0.0, 1.81)];
    b.turned(Paint::Sandstone, Shading::Smooth, DVec2::ZERO, 10, &head.map(|(radius, y)| (radius * tall, y * tall)));
}

/// A hay cart, its shafts along +x.
pub(crate) fn cart(b: &mut Builder) {
    b.pillar(Paint::Timber, DVec2::ZERO, DVec2::new(2.4, 1.3), 0.72, 0.84);
    for z in [-0.62, 0.62] {
        b.pillar(Paint::Timber, DVec2::new(0.0, z), DVec2::new(2.4, 0.06), 0.8, 1.25);
        b.strut(Paint::Trunk, DVec3::new(0.0, 0.52, z * 1.16 - 0.06), DVec3::new(0.0, 0.52, z * 1.16 + 0.06), 0.52, 12);
    }
    b.turned(Paint::StuccoCream, Shading::Flat, DVec2::ZERO, 8, &[(0.56, 0.82), (0.62, 1.3), (0.34, 1.75), (0.0, 1.9)]);
    for z in [-0.4, 0.4] {
        b.strut(Paint::Trunk, DVec3::new(1.1, 0.76, z), DVec3::new(2.6, 0.25, z), 0.05, 5);
    }
}

/// Staves that bulge, with four hoops; stands upright on y = 0, a metre high.
pub(crate) fn barrel(b: &mut Builder, detail: Detail, [wood, iron]: [usize; 2]) {
    const LENGTH: f64 = 1.0;
    const STAVES: [(f64, f64); 5] = [(0.31, 0.035), (0.365, 0.25), (0.385, 0.5), (0.365, 0.75), (0.31, 0.965)];
    let sides = detail.sides(14.0);
    let profile = smooth_profile(&STAVES, detail.steps(6.0));
    b.turned(wood, Shading::Smooth, DVec2::ZERO, sides, &profile);
    for (y, radius, half) in
        [(0.035, 0.312, 0.035), (0.25, 0.366, 0.022), (LENGTH - 0.25, 0.366, 0.022), (LENGTH - 0.035, 0.312, 0.035)]
    {
        hoop(b, iron, DVec2::ZERO, [radius - 0.03, radius + 0.006], [y - half, y + half], sides);
    }
}

/// A crate of slats, open at the top, about the y axis.
pub(crate) fn open_crate(b: &mut Builder, [boards, posts]: [usize; 2]) {
    let (half, high) = (DVec2::new(0.28, 0.2), 0.3);
    b.pillar(boards, DVec2::ZERO, half * 2.0, 0.0, 0.02);
    for (x, z) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
        b.pillar(posts, half * DVec2::new(x, z) * 0.93, DVec2::splat(0.035), 0.01, high);
    }
    for i in 0..3 {
        let (y0, y1) = (0.02 + 0.1 * f64::from(i), 0.1 + 0.1 * f64::from(i));
        b.rim(boards, half * 2.0 + DVec2::splat(0.002 * f64::from(i)), 0.014, y0, y1);
    }
}
