//! Imperfect shadow maps: points drawn as discs into a paraboloid map, whose holes are filled when it is read.
//!
//! A map is a hemisphere about the VPL's normal (Heidrich and Seidel 1998, "View-Independent Environment Maps"): the direction
//! (x, y, z) lies at (x, y) / (1 + z). Texels hold the bits of the least distance from the light, which are in the order
//! of distances; all ones where nothing is.

use glam::{IVec2, Vec2, Vec3};

use super::cloud::{Cast, Share};
use crate::area::Vpl;
use crate::sampling::hash;

/// Nothing is there.
pub(crate) const EMPTY: u32 = u32::MAX;
/// Discs are at most this large, texels.
const MOST_TEXELS: f32 = 4.0;
/// A disc is a line when the cosine of its normal is less.
const EDGE_ON: f32 = 0.02;
/// Neighbouring texels show one surface when their distances differ by less than this share.
const ONE_SURFACE: f32 = 0.15;
/// Holes between a surface's discs are at most about twice as wide, texels.
const HOLE: i32 = 2;
/// What is lower above the light's own surface casts nothing: its own housing.
const HORIZON: f32 = 0.02;

/// The map of one VPL.
#[derive(Clone, Debug)]
pub(crate) struct Map {
    pub side: u32,
    pub texels: Vec<u32>,
}

/// What a point stands for, as seen from a light: a disc within its chunk's box.
struct Disc<'s> {
    away: Vec3,
    r: f32,
    radius_m: f32,
    normal: Vec3,
    /// From the light to the middle of the box.
    middle: Vec3,
    share: &'s Share,
}

impl Disc<'_> {
    /// How far away a ray from the light meets it.
    fn meets(&self, direction: Vec3) -> Option<f32> {
        let facing = direction.dot(self.normal);
        let t = self.away.dot(self.normal) / facing;
        let there = direction * t;
        let is_there = t > 0.0
            && facing.abs() > EDGE_ON
            && there.distance_squared(self.away) <= self.radius_m * self.radius_m
            && self.is_in_box(there - self.middle);
        is_there.then_some(t)
    }

    fn is_in_box(&self, at: Vec3) -> bool {
        let Share { half_along_m, half_across_m, half_third_m, .. } = *self.share;
        let (along, across) = (Vec3::from(self.share.along), Vec3::from(self.share.across));
        at.dot(along).abs() <= half_along_m
            && at.dot(across).abs() <= half_across_m
            && at.dot(along.cross(across)).abs() <= half_third_m
    }
}

/// A VPL's axes, and how its directions lie in a map.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Paraboloid {
    pub x: Vec3,
    pub y: Vec3,
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

    /// The direction of the middle of a texel.
    pub fn direction(&self, x: u32, y: u32) -> Vec3 {
        let at = ((Vec2::new(x as f32, y as f32) + 0.5) * (2.0 / self.side) - 1.0) / self.per_spread;
        let z = 2.0 / (1.0 + at.length_squared()) - 1.0;
        (self.x * at.x + self.y * at.y) * (1.0 + z) + self.z * z
    }
}

/// The number of the point that a VPL draws as its `index`-th: which share, which of its points.
pub(crate) fn chosen(cast: &Cast, vpl: u32, index: u32, budget: u32) -> (usize, usize) {
    let stride = u32::MAX / budget;
    let at = stride * index + hash(vpl) % stride;
    let share = cast.shares.partition_point(|share| share.begin <= at).saturating_sub(1);
    let of = &cast.shares[share];
    // A chunk's points lie along a curve: van der Corput's sequence (1935), turned for each VPL, spreads any few evenly over it.
    let turn = ((at - of.begin) / stride).reverse_bits().wrapping_add(hash(vpl ^ hash(share as u32)));
    (share, (of.first + (((turn >> 16) * of.count) >> 16)) as usize)
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
            let (share, point) = (&cast.shares[share], &cast.points[point]);
            let away = point.position - vpl.position;
            let r = away.length();
            let direction = away / r.max(1e-9);
            let Some((at, z)) = paraboloid.texel(direction) else { continue };
            let per_radian = 0.5 * side as f32 / (vpl.spread * (1.0 + z));
            let radius_m = share.radius_m.min(MOST_TEXELS * r / per_radian);
            let middle = Vec3::from(share.middle) - vpl.position;
            let disc = Disc { away, r, radius_m, normal: point.normal, middle, share };
            // What fills less than a texel has it as often.
            let per_metre = per_radian / r;
            let texels = share.area_m2 * direction.dot(point.normal).abs() * per_metre * per_metre;
            let has_own = (hash(index ^ hash(number)) >> 8) as f32 / 16_777_216.0 < texels;
            map.disc(&paraboloid, at, radius_m * per_metre, &disc, has_own);
        }
        map
    }

    /// Draws a disc, each texel as far away as it is there: those whose rays meet it, and the texel of its middle if it has
    /// that.
    fn disc(&mut self, paraboloid: &Paraboloid, at: Vec2, radius: f32, disc: &Disc<'_>, has_own: bool) {
        let side = self.side as i32;
        let (low, high) = ((at - radius).floor().as_ivec2(), (at + radius).floor().as_ivec2());
        let own = at.floor().as_ivec2();
        for y in low.y.max(0)..=high.y.min(side - 1) {
            for x in low.x.max(0)..=high.x.min(side - 1) {
                let meets = disc.meets(paraboloid.direction(x as u32, y as u32));
                let is_own = has_own && x == own.x && y == own.y;
                let Some(r) = meets.or(if is_own { Some(disc.r) } else { None }) else { continue };
                let texel = &mut self.texels[(y * side + x) as usize];
                *texel = r.to_bits().min(*texel);
            }
        }
    }

    /// Distance at a place: between the middles of four texels of one surface, or else that of the nearest texel, which may be
    /// a hole in a surface, with nothing behind or something. Nothing outside the map.
    pub fn between(&self, at: Vec2) -> Option<f32> {
        let last = self.side as i32 - 1;
        let own = at.floor().as_ivec2();
        if own.min_element() < 0 || own.max_element() > last {
            return None;
        }
        let nearest = self.at(own.x as u32, own.y as u32);
        if let Some(before) = self.before_hole(own, nearest.unwrap_or(f32::INFINITY)) {
            return Some(before);
        }
        let Some(nearest) = nearest else { return self.across_hole(own) };
        let first = (at - 0.5).floor();
        let share = at - 0.5 - first;
        let mut sum = 0.0;
        for (dx, dy) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let texel = [first.x as i32 + dx, first.y as i32 + dy].map(|i| i.clamp(0, last) as u32);
            let Some(r) = self.at(texel[0], texel[1]).filter(|r| (r / nearest - 1.0).abs() < ONE_SURFACE) else {
                return Some(nearest);
            };
            let weight = |d: i32, share: f32| if d == 0 { 1.0 - share } else { share };
            sum += r * weight(dx, share.x) * weight(dy, share.y);
        }
        Some(sum)
    }

    /// Distance at a hole: of the surface that both texels to its sides show, or those above and below.
    fn across_hole(&self, own: IVec2) -> Option<f32> {
        let at = |step: IVec2| {
            let texel = own + step;
            let inside = texel.min_element() >= 0 && texel.max_element() < self.side as i32;
            if inside { self.at(texel.x as u32, texel.y as u32) } else { None }
        };
        [IVec2::X, IVec2::Y].into_iter().find_map(|step| {
            let (before, after) = (at(-step)?, at(step)?);
            ((before / after - 1.0).abs() < ONE_SURFACE).then_some(0.5 * (before + after))
        })
    }

    /// Distance of the one surface that lies before a texel's on all four sides of it, a few texels away at most: seen through
    /// a hole between its discs.
    fn before_hole(&self, own: IVec2, r: f32) -> Option<f32> {
        let across = self.before_between(own, r, IVec2::X)?;
        let along = self.before_between(own, r, IVec2::Y)?;
        ((across / along - 1.0).abs() < ONE_SURFACE).then_some(0.5 * (across + along))
    }

    /// The same on two sides.
    fn before_between(&self, own: IVec2, r: f32, step: IVec2) -> Option<f32> {
        let nearer = |step: IVec2| {
            (1..=HOLE).find_map(|reach| {
                let texel = own + step * reach;
                let inside = texel.min_element() >= 0 && texel.max_element() < self.side as i32;
                let there = if inside { self.at(texel.x as u32, texel.y as u32) } else { None };
                there.filter(|there| *there < r * (1.0 - ONE_SURFACE))
            })
        };
        let (before, after) = (nearer(-step)?, nearer(step)?);
        ((before / after - 1.0).abs() < ONE_SURFACE).then_some(0.5 * (before + after))
    }

    /// Distance of what a texel shows.
    pub fn at(&self, x: u32, y: u32) -> Option<f32> {
        let bits = self.texels[(y * self.side + x) as usize];
        (bits != EMPTY).then(|| f32::from_bits(bits))
    }
}
