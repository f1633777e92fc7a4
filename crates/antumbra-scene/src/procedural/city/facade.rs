//! Walls with depth: a glass core in a cage of bands and piers. What is left between them are recessed windows, so a
//! tower of two thousand windows costs a few hundred triangles.

use glam::{DVec2, DVec3};

use crate::procedural::palette::Paint;
use crate::procedural::rng::Rng;
use crate::procedural::solids::Builder;

/// How a body of glass is clad.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facade {
    pub(crate) glass: Paint,
    pub(crate) wall: Paint,
    /// Distance from pier to pier.
    pub(crate) bay: f64,
    /// Width of a pier and how far it stands out of the glass.
    pub(crate) pier: DVec2,
    /// Height of a storey.
    pub(crate) storey: f64,
    /// Height of the band at each floor and how far it stands out of the glass.
    pub(crate) band: DVec2,
}

const STONES: [Paint; 6] =
    [Paint::Limestone, Paint::Limestone, Paint::Sandstone, Paint::Granite, Paint::StuccoWhite, Paint::Concrete];
const BRICKS: [Paint; 3] = [Paint::BrickRed, Paint::BrickBrown, Paint::BrickOchre];
const GLASSES: [Paint; 4] = [Paint::GlassBlue, Paint::GlassBlue, Paint::GlassGrey, Paint::GlassGreen];

impl Facade {
    /// Glass in a thin grid of metal.
    pub(crate) fn curtain(rng: &mut Rng) -> Self {
        Self {
            glass: rng.pick(&GLASSES),
            wall: rng.pick(&[Paint::Steel, Paint::White, Paint::Bronze, Paint::Steel]),
            bay: rng.range(2.6, 4.0),
            pier: DVec2::new(0.32, rng.range(0.25, 0.6)),
            storey: 4.0,
            band: DVec2::new(rng.range(0.6, 1.1), 0.15),
        }
    }

    /// Stone or brick with a window in each bay.
    pub(crate) fn masonry(rng: &mut Rng) -> Self {
        let wall = if rng.chance(0.55) { rng.pick(&STONES) } else { rng.pick(&BRICKS) };
        let bay = rng.range(3.2, 4.3);
        Self {
            glass: Paint::GlassDark,
            wall,
            bay,
            pier: DVec2::new(bay * rng.range(0.38, 0.52), 0.42),
            storey: rng.range(3.3, 3.8),
            band: DVec2::new(rng.range(1.2, 1.6), 0.32),
        }
    }

    /// Long horizontal windows.
    pub(crate) fn ribbon(rng: &mut Rng) -> Self {
        Self {
            glass: rng.pick(&[Paint::GlassDark, Paint::GlassGrey, Paint::GlassBlue]),
            wall: rng.pick(&[Paint::StuccoWhite, Paint::Concrete, Paint::White, Paint::Sandstone]),
            bay: rng.range(5.5, 8.0),
            pier: DVec2::new(0.5, 0.2),
            storey: 3.8,
            band: DVec2::new(rng.range(1.3, 1.9), 0.55),
        }
    }

    /// Piers from bottom to top, as in the towers of the 1930s.
    pub(crate) fn vertical(rng: &mut Rng) -> Self {
        let bay = rng.range(2.6, 3.4);
        Self {
            glass: Paint::GlassDark,
            wall: rng.pick(&[Paint::Limestone, Paint::Sandstone, Paint::Limestone, Paint::BrickOchre, Paint::Granite]),
            bay,
            pier: DVec2::new(bay * 0.42, 0.85),
            storey: 3.7,
            band: DVec2::new(1.3, 0.25),
        }
    }

    /// Clads a box on the origin, `size` along x and z, from `y0` to `y1`. Everything below `y0` runs into what is
    /// underneath.
    pub(crate) fn clad(&self, b: &mut Builder, size: DVec2, y0: f64, y1: f64) {
        b.pillar(self.glass, DVec2::ZERO, size, y0 - 0.8, y1 - 0.3);
        self.bands(b, size, y0, y1);
        self.piers(b, size, y0, y1);
        self.corners(b, size, y0, y1);
        let cornice = size + DVec2::splat(2.0 * (self.pier.y.max(self.band.y) + 0.22));
        b.pillar(self.wall, DVec2::ZERO, cornice, y1 - 0.7, y1);
        b.rim(self.wall, cornice - DVec2::splat(0.3), 0.45, y1 - 0.4, y1 + 1.0);
    }

    fn bands(&self, b: &mut Builder, size: DVec2, y0: f64, y1: f64) {
        let storeys = ((y1 - y0) / self.storey).round().max(1.0) as usize;
        let storey = (y1 - y0) / storeys as f64;
        let outer = size + DVec2::splat(2.0 * self.band.y);
        for i in 0..storeys {
            let floor = y0 + storey * i as f64;
            let bottom = if i == 0 { y0 - 0.6 } else { floor - 0.3 * self.band.x };
            b.pillar(self.wall, DVec2::ZERO, outer, bottom, floor + 0.7 * self.band.x);
        }
    }

    /// One bar through the whole body makes a pier on either side.
    fn piers(&self, b: &mut Builder, size: DVec2, y0: f64, y1: f64) {
        let out = 2.0 * self.pier.y;
        for axis in 0..2 {
            let bays = (size[axis] / self.bay).round().max(1.0) as usize;
            for i in 1..bays {
                let mut at = DVec2::ZERO;
                at[axis] = size[axis] * (i as f64 / bays as f64 - 0.5);
                let mut bar = size + DVec2::splat(out);
                bar[axis] = self.pier.x;
                b.pillar(self.wall, at, bar, y0 - 0.6, y1 - 0.35);
            }
        }
    }

    fn corners(&self, b: &mut Builder, size: DVec2, y0: f64, y1: f64) {
        let out = self.pier.y + 0.06;
        let width = self.pier.x.max(0.5) + 0.3;
        for (sx, sz) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
            let at = (size * 0.5 + DVec2::splat(out - width * 0.5)) * DVec2::new(sx, sz);
            b.pillar(self.wall, at, DVec2::splat(width), y0 - 0.6, y1 - 0.35);
        }
    }
}

/// A single window in a wall that faces +z: a pane and a lintel.
pub(crate) fn window(b: &mut Builder, trim: Paint, center: DVec3, size: DVec2) {
    let half = size * 0.5;
    let slab = |b: &mut Builder, paint: Paint, grow: f64, y0: f64, y1: f64, out: f64| {
        let min = DVec3::new(center.x - half.x - grow, center.y + y0, center.z - 0.15);
        let max = DVec3::new(center.x + half.x + grow, center.y + y1, center.z + out);
        b.cuboid(paint, min, max);
    };
    slab(b, Paint::GlassDark, 0.0, -half.y, half.y, 0.05);
    slab(b, trim, 0.14, half.y, half.y + 0.24, 0.16);
}
