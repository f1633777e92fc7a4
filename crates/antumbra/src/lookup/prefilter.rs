//! Prefiltered lookups, two ways (Sintorn et al. 2014): a pixel that covers many texels asks for their mean.
//!
//! - **Mean**: every node's header holds the mean over its voxels. A lookup stops at the node whose side matches the
//!   footprint: fewer steps than to a single voxel.
//! - **Levels**: a file may hold coarse levels, each a volume of half the last one's resolution, whose voxel is lit iff at
//!   least half of the voxels that it stands for are. Percentage-closer filtering runs on the two levels about the
//!   footprint's scale, and the two answers are blended.
//!
//! Silhouettes need neither headers nor files of levels: a mean is that of 64 columns in the node, a coarse voxel the light's own in its middle, so
//! that a filter's taps lie so much farther apart.
//!
//! Of the encoding [`dag8`], a mean is within 1/131070 of the mean of all point lookups in its node. A coarse voxel is within 1/2 of its, and a
//! K x K filter's answer within the mean of its voxels' errors.

use alloc::sync::Arc;
use alloc::vec::Vec;

use glam::DVec3;

use super::filter::Filter;
use super::light::LightShadow;
use super::pcf::{self, Weights};
use super::point::{descend, is_lit, slice_mask};
use super::project::{FacePoint, Place, clamp_to_volume};
use super::silhouette;
use super::top_grid::TopGrid;
use crate::format::dag8::{self, LIT, SHADOWED, SLICE_LEVEL};

/// log2 of the coarsest level's texels per side.
const COARSEST_LOG2: u32 = 6;

/// How to prefilter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Prefilter {
    /// The mean over the node that is as wide as the footprint.
    Mean,
    /// Filtering on coarse levels, as wide as the footprint; a file without them is filtered at full depth.
    Levels(Filter),
}

impl<'a> LightShadow<'a> {
    /// Whether there are coarse levels for [`Prefilter::Levels`]: those that the file holds; of silhouettes always.
    #[must_use]
    pub fn has_levels(self) -> bool {
        self.levels() > 0
    }

    /// How many coarse levels there are, down to 64 texels per side.
    #[must_use]
    pub fn levels(self) -> u32 {
        if self.is_silhouette() {
            self.record().log2_resolution.saturating_sub(COARSEST_LOG2)
        } else {
            self.coarse().len() as u32
        }
    }

    /// Visibility over a footprint: a square of `footprint_m` to a side about the point, as wide as the pixel that asks.
    /// With a unit normal the sample moves off the surface, as far as what it averages over is wide.
    ///
    /// Footprints no wider than a texel, or for [`Prefilter::Levels`] than the filter, are looked up at full depth.
    #[must_use]
    pub fn prefiltered(self, point: DVec3, normal: Option<DVec3>, footprint_m: f64, how: Prefilter) -> f32 {
        let texel_m = self.projection().texel_m(point);
        match how {
            // The nearest power of two.
            Prefilter::Mean => {
                self.mean_visibility(point, normal, octave(footprint_m * core::f64::consts::SQRT_2 / texel_m).0)
            }
            Prefilter::Levels(filter) => {
                let (level, share) = octave(footprint_m / (texel_m * f64::from(filter.width())));
                self.blended(point, normal, filter, level, share)
            }
        }
    }

    /// Mean visibility of the node of 2^`level` voxels per side that holds a point: level 0 is a point lookup.
    ///
    /// With a unit normal the point first moves as far off its surface as such a node is wide, so that no part of the node
    /// lies behind a plane with that normal. Before the volume and sideways of it: lit; behind it: as the last node.
    #[must_use]
    pub fn mean_visibility(self, point: DVec3, normal: Option<DVec3>, level: u32) -> f32 {
        let level = level.min(self.record().log2_resolution);
        let lifted =
            |n| if self.is_outside_cone(point) { point } else { point + n * self.mean_bias_m(point, n, level) };
        match self.projection().place(normal.map_or(point, lifted)) {
            Place::Lit => 1.0,
            Place::Unlit => 0.0,
            Place::At { face, voxel } => self.voxel_mean(face, voxel, level),
        }
    }

    /// Mean visibility of the node of 2^`level` voxels per side that holds a voxel of a face.
    ///
    /// Nodes of the encoding [`dag8`] know theirs. Of silhouettes it is measured along the columns of the node's texels, and in nodes of more
    /// than 8 x 8 along 64 of them, in the middles of its parts.
    ///
    /// # Panics
    /// When the light has no such face.
    #[must_use]
    pub fn voxel_mean(self, face: usize, voxel: [u32; 3], level: u32) -> f32 {
        let pool = &self.file.pool[..];
        let grid = self.top_grid(face);
        let (node, from) = if level <= grid.level {
            (grid.node(voxel), grid.level)
        } else {
            (self.record().roots[face], self.record().log2_resolution)
        };
        if self.is_silhouette() {
            let settled = grid.cube_is_lit(voxel, level);
            let mean = || silhouette::mean(pool, (node, from), level, voxel, self.spread());
            return settled.map_or_else(mean, f32::from);
        }
        match descend(pool, node, from, level.max(SLICE_LEVEL), voxel) {
            LIT => 1.0,
            SHADOWED => 0.0,
            node if level >= SLICE_LEVEL => dag8::mean(pool[node as usize]),
            node => mean_within(pool, node, voxel, level),
        }
    }

    /// Filtered visibility on the coarse levels about a real-valued one, blended by its fraction. Level L has texels 2^L times as wide; 0
    /// is the light itself, and levels past the coarsest (64 texels per side) count as that.
    #[must_use]
    pub fn level_filtered(self, point: DVec3, normal: Option<DVec3>, filter: Filter, level: f64) -> f32 {
        let level = level.clamp(0.0, 31.0);
        self.blended(point, normal, filter, level as u32, (level - libm::floor(level)) as f32)
    }

    /// Filtered on a level and, for a share, on the next.
    fn blended(self, point: DVec3, normal: Option<DVec3>, filter: Filter, level: u32, share: f32) -> f32 {
        if self.is_outside_cone(point) {
            return 0.0;
        }
        let coarsest = self.levels();
        let (level, share) = if level >= coarsest { (coarsest, 0.0) } else { (level, share) };
        let widest = level + u32::from(share > 0.0);
        let lifted = |n| point + n * self.level_bias_m(point, n, filter, widest);
        let at = self.project(normal.map_or(point, lifted));
        let fine = self.filtered_on_level(at, filter, level);
        if share > 0.0 { fine * (1.0 - share) + self.filtered_on_level(at, filter, level + 1) * share } else { fine }
    }

    /// Whether a voxel of a coarse level is lit, 1 the finest; its indices count that level's voxels. Of silhouettes: whether the light's own
    /// voxel in its middle is.
    ///
    /// # Panics
    /// When the file has no such level or the light no such face.
    #[must_use]
    pub fn is_lit_on_level(self, level: u32, face: usize, voxel: [u32; 3]) -> bool {
        if self.is_silhouette() {
            return self.is_lit(face, voxel.map(|c| silhouette::middle(c, level)));
        }
        let last = (self.record().resolution() >> level) - 1;
        let grid = &self.coarse()[level as usize - 1][face];
        let voxel = voxel.map(|c| c & last);
        is_lit(&self.file.pool, grid.node(voxel), grid.level, voxel)
    }

    /// How far along a unit normal a lookup of a node's mean moves: the node's whole extent along the normal.
    fn mean_bias_m(self, point: DVec3, normal: DVec3, level: u32) -> f64 {
        if level == 0 {
            return Filter::new_box(1).map_or(0.0, |one| self.bias_m(point, normal, one));
        }
        let frame = self.frame(point);
        let lateral = frame.right.dot(normal).abs() + frame.down.dot(normal).abs();
        f64::from(1u32 << level) * (lateral * frame.texel_m + frame.along.dot(normal).abs() * frame.slice_m)
    }

    /// A filter's bias on a level: its own at that scale, and half a coarse slice for the voxels' rounding.
    fn level_bias_m(self, point: DVec3, normal: DVec3, filter: Filter, level: u32) -> f64 {
        let scale = f64::from(1u32 << level);
        let rounding = if level == 0 { 0.0 } else { 0.5 * scale * self.frame(point).slice_m };
        self.bias_m(point, normal, filter) * scale + rounding
    }

    fn coarse(self) -> &'a [Vec<Arc<TopGrid>>] {
        &self.file.level_grids[self.index]
    }

    /// Taps beyond a face's grid see the neighbouring face of a cube; they are left out beside a spot light's cone, and lit
    /// beside a directional light's grid.
    #[inline]
    fn filtered_on_level(self, at: FacePoint, filter: Filter, level: u32) -> f32 {
        let silhouette = self.is_silhouette().then(|| (level, self.spread()));
        let grid = |face: usize| match level {
            0 => self.top_grid(face),
            _ if silhouette.is_some() => self.top_grid(face),
            _ => &self.coarse()[level as usize - 1][face],
        };
        let side = self.record().resolution() >> level;
        let scale = power_of_two(-(level as i32));
        let voxel = at.voxel * scale;
        let source = pcf::Source { grid: grid(at.face), silhouette, pool: &self.file.pool };
        let Weights { lit, inside, all } = pcf::weights(source, side, voxel, filter);
        if inside == all || !self.is_local() || at.voxel.z < 0.0 {
            return (lit + all - inside) as f32 / all as f32;
        }
        let mut sum = [lit, inside];
        pcf::for_each_outside(side, voxel, filter, |tap, weight| {
            let Some(there) = self.projection().around_corner(FacePoint { voxel: tap / scale, ..at }) else { return };
            let corner = clamp_to_volume(there.voxel * scale, f64::from(side));
            let one_lit = corner.is_none_or(|v| match level {
                0 => self.is_lit(there.face, v),
                _ => self.is_lit_on_level(level, there.face, v),
            });
            sum = [sum[0] + if one_lit { weight } else { 0 }, sum[1] + weight];
        });
        if sum[1] == 0 { 1.0 } else { sum[0] as f32 / sum[1] as f32 }
    }
}

/// The power of two at or below a width of 1 or more, and how far the width lies from it to the next, 0 to 1. Narrower
/// widths, and those that are no numbers, count as 1.
#[inline]
fn octave(width: f64) -> (u32, f32) {
    let bits = if width >= 1.0 { width.min(power_of_two(30)).to_bits() } else { 1f64.to_bits() };
    let level = (bits >> 52) as i32 - 1023;
    (level as u32, (f64::from_bits(bits) * power_of_two(-level) - 1.0) as f32)
}

/// 2^`exponent`, for small exponents.
#[inline]
fn power_of_two(exponent: i32) -> f64 {
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

/// Mean of the cube of 2^`level` voxels per side, level 0 to 2, that holds a voxel of a slice node.
fn mean_within(pool: &[u32], node: u32, [x, y, z]: [u32; 3], level: u32) -> f32 {
    let side = 1u32 << level;
    let [x, y, z] = [x, y, z].map(|c| c & 7 & !(side - 1));
    let row = ((1u64 << side) - 1) << (8 * y + x);
    let square = (0..side).fold(0, |square, i| square | (row << (8 * i)));
    let lit: u32 = (z..z + side).map(|slice| (slice_mask(pool, node, slice) & square).count_ones()).sum();
    lit as f32 / (side * side * side) as f32
}
