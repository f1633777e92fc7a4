//! Imperfect shadow maps: points drawn as discs into a paraboloid map, and holes filled.
//!
//! A map is a hemisphere about the VPL's normal (Heidrich and Seidel 1998, "View-Independent Environment Maps"): the direction
//! (x, y, z) lies at (x, y) / (1 + z). Texels hold the bits of the least distance from the light, which are in the order
//! of distances; all ones where nothing is.

use glam::{Vec2, Vec3};

use super::cloud::Cast;
use crate::area::Vpl;
use crate::sampling::hash;

/// Nothing is there.
pub(crate) const EMPTY: u32 = u32::MAX;
/// Discs are at most this large, texels.
const MOST_TEXELS: f32 = 4.0;
/// What is lower above the light's own surface casts nothing: its own housing.
const HORIZON: f32 = 0.02;

/// The map of one VPL.
#[derive(Clone, Debug)]
pub(crate) struct Map {
    pub side: u32,
    pub texels: Vec<u32>,
}

/// A VPL's axes, and how its directions lie in a map.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Paraboloid {
    x: Vec3,
    y: Vec3,
    z: Vec3,
    per_spread: f32,
    side: f32,
}

impl Paraboloid {
    pub fn new(vpl: &Vpl, side: u32) -> Self {
        let (x, y) = vpl.normal.any_orthonormal_pair();
        Self { x, y, z: vpl.normal, per_spread: 1.0 / vpl.spread, side: side as f32 }
    }

    /// Where a direction lies, in texels, and its cosine to the normal; `None` below the horizon.
    pub fn texel(&self, direction: Vec3) -> Option<(Vec2, f32)> {
        let z = direction.dot(self.z);
        let at = Vec2::new(direction.dot(self.x), direction.dot(self.y)) * (self.per_spread / (1.0 + z).max(1e-6));
        (z > HORIZON).then(|| ((at * 0.5 + 0.5) * self.side, z))
    }
}

/// The number of the point that a VPL draws as its `index`-th: which share, which of its points.
pub(crate) fn chosen(cast: &Cast, vpl: u32, index: u32, budget: u32) -> (usize, usize) {
    let stride = u32::MAX / budget;
    let at = stride * index + hash(vpl) % stride;
    let share = cast.shares.partition_point(|share| share.begin <= at).saturating_sub(1);
    let of = &cast.shares[share];
    // Consecutive ones of a chunk's random order, from where this VPL begins.
    let turn = (at - of.begin) / stride + hash(vpl ^ hash(share as u32));
    (share, (of.first + turn % of.count) as usize)
}

impl Map {
    /// Draws a VPL's points.
    pub fn draw(vpl: &Vpl, number: u32, cast: &Cast, side: u32, budget: u32) -> Self {
        let mut map = Self { side, texels: vec![EMPTY; (side * side) as usize] };
        if cast.shares.is_empty() {
            return map;
        }
        let paraboloid = Paraboloid::new(vpl, side);
        for index in 0..budget {
            let (share, point) = chosen(cast, number, index, budget);
            let point = &cast.points[point];
            let away = point.position - vpl.position;
            let r = away.length();
            let direction = away / r.max(1e-9);
            let Some((at, z)) = paraboloid.texel(direction) else { continue };
            // A disc seen at an angle is an ellipse: a circle of its area.
            let facing = direction.dot(point.normal).abs().max(0.05).sqrt();
            let per_radian = 0.5 * side as f32 / (vpl.spread * (1.0 + z));
            let radius = (cast.shares[share].radius_m * facing / r * per_radian).min(MOST_TEXELS);
            map.disc(at, radius, r.to_bits());
        }
        map
    }

    /// Draws a disc: the texel it lies in, and those whose middle it covers.
    fn disc(&mut self, at: Vec2, radius: f32, depth: u32) {
        let side = self.side as i32;
        let (low, high) = ((at - radius).floor().as_ivec2(), (at + radius).floor().as_ivec2());
        let own = at.floor().as_ivec2();
        for y in low.y.max(0)..=high.y.min(side - 1) {
            for x in low.x.max(0)..=high.x.min(side - 1) {
                let from = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) - at;
                if from.length_squared() <= radius * radius || (x == own.x && y == own.y) {
                    let texel = &mut self.texels[(y * side + x) as usize];
                    *texel = depth.min(*texel);
                }
            }
        }
    }

    /// Fills small holes: pull-push over one coarser level (Grossman and Dally 1998, "Point Sample Rendering"). A hole
    /// takes the mean of its block of 2 x 2 texels, or of the blocks around it that are at least half full.
    pub fn filled(&self) -> Self {
        let half = self.side / 2;
        let coarse: Vec<Option<f32>> = (0..half * half)
            .map(|i| {
                let (x, y) = (2 * (i % half), 2 * (i / half));
                let block = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(dx, dy)| self.at(x + dx, y + dy));
                let (sum, count) =
                    block.iter().flatten().fold((0.0, 0), |(sum, count), depth| (sum + depth, count + 1));
                (count >= 2).then(|| sum / count as f32)
            })
            .collect();
        let fill = |i: u32| {
            let (x, y) = (i % self.side, i / self.side);
            let own = self.texels[i as usize];
            if own != EMPTY {
                return own;
            }
            let (bx, by) = ((x / 2).min(half - 1), (y / 2).min(half - 1));
            coarse[(by * half + bx) as usize].map_or(EMPTY, f32::to_bits)
        };
        Self { side: self.side, texels: (0..self.side * self.side).map(fill).collect() }
    }

    /// Distance of what a texel shows.
    pub fn at(&self, x: u32, y: u32) -> Option<f32> {
        let bits = self.texels[(y * self.side + x) as usize];
        (bits != EMPTY).then(|| f32::from_bits(bits))
    }
}
