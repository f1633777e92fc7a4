//! Cascaded shadow maps, done well: the yardstick that baked shadows are held against, and how what moves casts shadows
//! over a bake.
//!
//! Engel 2006, *Cascaded shadow maps*; splits by Zhang, Sun, Xu, Lun 2006, *Parallel-split shadow maps for large-scale
//! virtual environments*; whole texels as steps, from spheres about the splits, by Valient 2007, *Stable rendering of
//! cascaded shadow maps*. Receivers move off their surface as those of baked lookups do, just as far as the filter needs:
//! no bias is left to tune but the rounding of depth.

pub(crate) mod reference;

use antumbra_scene::Bounds;
use glam::{DVec3, DVec4};

use crate::camera::View;
use crate::light::Sun;

/// How shadow maps are laid out and filtered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cascades {
    /// Maps per sun, 1 to 8.
    pub count: u32,
    /// Texels per side of each.
    pub size: u32,
    /// Between even splits (0) and logarithmic ones (1).
    pub logarithmic: f64,
    /// Distance up to which there are shadows, metres; `None` for the whole scene.
    pub distance_m: Option<f64>,
}

impl Default for Cascades {
    fn default() -> Self {
        Self { count: 4, size: 2048, logarithmic: 0.85, distance_m: None }
    }
}

impl Cascades {
    /// Small ones for what moves.
    pub(crate) fn for_dynamic() -> Self {
        Self { count: 3, size: 1024, ..Self::default() }
    }
}

/// Which casters maps hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Casters {
    All,
    /// What moves, which no bake holds.
    Dynamic,
}

/// One map: an orthographic view along the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Cascade {
    /// From a point of the world relative to the eye (and 1) to texels along x and y, and to depth from 0 to 1.
    pub rows: [DVec4; 3],
    pub texel_m: f64,
    /// What a depth of 1 spans, metres.
    pub depth_m: f64,
}

impl Cascade {
    /// Texels and depth of a point relative to the eye.
    pub fn project(&self, point: DVec3) -> DVec3 {
        let p = point.extend(1.0);
        DVec3::new(self.rows[0].dot(p), self.rows[1].dot(p), self.rows[2].dot(p))
    }
}

/// The nearest that shadows begin, metres, and the most that the last split is farther.
const NEAREST_M: f64 = 0.25;
const FARTHEST_PER_NEAREST: f64 = 2000.0;

/// The cascades of a sun for a view of a scene.
pub(crate) fn fit(options: &Cascades, view: &View, sun: &Sun, bounds: &Bounds) -> Vec<Cascade> {
    if bounds.is_empty() {
        return Vec::new();
    }
    let along = -sun.towards_world;
    let (right, down) = along.any_orthonormal_pair();
    let seen = |corner: &DVec3| (*corner - view.eye).dot(view.forward);
    let farthest = bounds.corners().iter().map(seen).fold(NEAREST_M * 2.0, f64::max);
    let far = options.distance_m.map_or(farthest, |m| m.clamp(NEAREST_M * 2.0, farthest));
    let near = (far / FARTHEST_PER_NEAREST).max(NEAREST_M);
    // Casters are all of the scene between the light and what is seen.
    let depths = bounds.corners().map(|corner| corner.dot(along));
    let first = depths.iter().copied().fold(f64::INFINITY, f64::min);
    let last = depths.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    // A little more, so that nothing lies on the border.
    let margin_m = 1e-3 * (last - first).max(1e-3);
    let (first, depth_m) = (first - margin_m, last - first + 2.0 * margin_m);
    let split = |i: u32| {
        let share = f64::from(i) / f64::from(options.count);
        let (log, even) = (near * (far / near).powf(share), near + share * (far - near));
        if i == 0 { 0.0 } else { options.logarithmic * log + (1.0 - options.logarithmic) * even }
    };
    let cascade = |i: u32| {
        let (middle, radius) = sphere(view, split(i), split(i + 1));
        // Room for the widest filter on all sides, and for snapping.
        let texel_m = 2.0 * radius / f64::from(options.size - 2 * BORDER);
        let snapped = |axis: DVec3| (middle.dot(axis) / texel_m).floor() - f64::from(options.size / 2);
        let row = |axis: DVec3, first_texel: f64| (axis / texel_m).extend(view.eye.dot(axis) / texel_m - first_texel);
        let depth = (along / depth_m).extend((view.eye.dot(along) - first) / depth_m);
        Cascade { rows: [row(right, snapped(right)), row(down, snapped(down)), depth], texel_m, depth_m }
    };
    (0..options.count).map(cascade).collect()
}

/// Texels at a map's rim that no lookup has its middle in.
const BORDER: u32 = 10;

/// The least sphere about a part of the view, from one depth to another: its middle and radius. It depends on the angle of
/// view alone, not on where the camera looks.
fn sphere(view: &View, near: f64, far: f64) -> (DVec3, f64) {
    // Squared distance from the axis per squared depth, at the view's corners.
    let spread = view.half_right.length_squared() + view.half_up.length_squared();
    // As far from the near corners as from the far ones, unless that lies behind them.
    let depth = (0.5 * (near + far) * (1.0 + spread)).min(far);
    let radius = ((far - depth).powi(2) + spread * far * far).sqrt();
    (view.eye + view.forward * depth, radius)
}

/// How far along a unit normal a lookup moves off its surface, metres: as for a baked light (see
/// [`antumbra::LightShadow::bias_m`]), with the rounding of depth instead of half a slice.
pub(crate) fn bias_m(cascade: &Cascade, normal: DVec3, taps: f64) -> f64 {
    let lateral = |row: &DVec4| row.truncate().dot(normal).abs() * cascade.texel_m;
    let across = lateral(&cascade.rows[0]) + lateral(&cascade.rows[1]);
    (0.5 * taps + 1.0 / 16.0) * cascade.texel_m * across + ROUNDING * cascade.depth_m
}

/// Error of a depth, relative to what maps span.
const ROUNDING: f64 = 1e-6;

/// Whether a lookup at these texels has all its taps in a map.
pub(crate) fn holds(size: u32, at: DVec3) -> bool {
    let (low, high) = (f64::from(BORDER - 1), f64::from(size - BORDER + 1));
    at.x >= low && at.x < high && at.y >= low && at.y < high
}

/// How shadow maps are filtered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MapFilter {
    /// The four texels about the point, weighed by how near they are: what graphics cards do by themselves.
    Bilinear,
    /// As many taps as a lookup of a bake takes.
    Taps(antumbra::Filter),
}

impl MapFilter {
    /// Width in texels, for the bias.
    pub(crate) fn width(self) -> f64 {
        match self {
            Self::Bilinear => 2.0,
            Self::Taps(filter) => f64::from(filter.taps()),
        }
    }
}
