//! Cascaded shadow maps on the CPU: each texel's depth is traced when a lookup first asks for it.

use std::sync::atomic::{AtomicU32, Ordering};

use glam::{DVec3, IVec2};

use super::{Cascade, Cascades, Casters, MapFilter, bias_m, fit, holds};
use crate::camera::View;
use crate::light::Sun;
use crate::surface::Surfaces;
use crate::trace::{Hit, Ray, Tracer};

/// The maps of one sun.
pub(crate) struct Maps<'w> {
    tracer: &'w Tracer,
    surfaces: &'w Surfaces<'w>,
    eye: DVec3,
    towards_light: DVec3,
    size: u32,
    cascades: Vec<Cascade>,
    /// By cascade: bits of each texel's depth; [`UNKNOWN`] until it is asked for.
    depths: Vec<Vec<AtomicU32>>,
    casters: Casters,
}

/// Not the bits of any depth.
const UNKNOWN: u32 = u32::MAX;

impl<'w> Maps<'w> {
    pub fn new(
        options: &Cascades,
        view: &View,
        sun: &Sun,
        tracer: &'w Tracer,
        surfaces: &'w Surfaces<'w>,
        casters: Casters,
    ) -> Self {
        let cascades = fit(options, view, sun, &tracer.bounds());
        let texels = (options.size as usize).pow(2);
        let empty = |_: &Cascade| (0..texels).map(|_| AtomicU32::new(UNKNOWN)).collect();
        Self {
            tracer,
            surfaces,
            eye: view.eye,
            towards_light: sun.towards_world,
            size: options.size,
            depths: cascades.iter().map(empty).collect(),
            cascades,
            casters,
        }
    }

    /// How much of the sun reaches a point of a surface: 0 to 1. Lit where no map holds it.
    pub fn visibility(&self, position: DVec3, normal: DVec3, filter: MapFilter) -> f32 {
        let point = position - self.eye;
        for (index, cascade) in self.cascades.iter().enumerate() {
            let at = cascade.project(point + normal * bias_m(cascade, normal, filter.width()));
            if holds(self.size, at) {
                return self.filtered(index, at, filter);
            }
        }
        1.0
    }

    fn filtered(&self, cascade: usize, at: DVec3, filter: MapFilter) -> f32 {
        let lit = |x: i32, y: i32| f32::from(at.z as f32 <= self.depth(cascade, x as u32, y as u32));
        match filter {
            MapFilter::Bilinear => {
                let corner = (at - 0.5).floor();
                let (f, i) = ((at - 0.5 - corner).as_vec3(), corner.as_ivec3());
                let row = |y| lit(i.x, y) * (1.0 - f.x) + lit(i.x + 1, y) * f.x;
                row(i.y) * (1.0 - f.y) + row(i.y + 1) * f.y
            }
            MapFilter::Taps(filter) => {
                let middle = IVec2::new(at.x as i32, at.y as i32);
                let radius = filter.radius() as i32;
                let mut sum = 0.0;
                for y in -radius..=radius {
                    for x in -radius..=radius {
                        let weight = filter.weight(x.unsigned_abs()) * filter.weight(y.unsigned_abs());
                        sum += weight as f32 * lit(middle.x + x, middle.y + y);
                    }
                }
                sum / (filter.axis_weight() * filter.axis_weight()) as f32
            }
        }
    }

    /// Depth of the nearest caster on a texel's ray; 1 for none.
    fn depth(&self, cascade: usize, x: u32, y: u32) -> f32 {
        let cell = &self.depths[cascade][(y * self.size + x) as usize];
        let known = cell.load(Ordering::Relaxed);
        if known != UNKNOWN {
            return f32::from_bits(known);
        }
        let depth = self.traced(&self.cascades[cascade], f64::from(x) + 0.5, f64::from(y) + 0.5);
        cell.store(depth.to_bits(), Ordering::Relaxed);
        depth
    }

    fn traced(&self, cascade: &Cascade, x: f64, y: f64) -> f32 {
        // The point of depth 0 with these texels: the rows are at right angles to one another.
        let back = |row: glam::DVec4, value: f64| {
            let axis = row.truncate();
            axis * ((value - row.w) / axis.length_squared())
        };
        let [right, down, along] = cascade.rows;
        let start = self.eye + back(right, x) + back(down, y) + back(along, 0.0);
        let ray = Ray::new(start, -self.towards_light * cascade.depth_m);
        let counts = |hit: &Hit| self.casters == Casters::All || self.surfaces.moves(self.tracer, hit);
        let hit = self.tracer.closest_if(&ray, |hit| counts(hit) && self.surfaces.casts_shadow(self.tracer, hit));
        hit.map_or(1.0, |hit| hit.t.min(1.0) as f32)
    }
}
