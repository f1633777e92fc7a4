//! The casters, ready to trace: what lies on a ray, and the winding number along it.

use antumbra_bake::casters::{CasterOptions, Casters, OpenedParts};
use antumbra_bake::{Blend, Inverted};
use antumbra_render::{Hit, Ray, Tracer, TriangleId};
use antumbra_scene::{AlphaMode, Material, Node, Scene};
use anyhow::Result;
use glam::DVec3;

use super::masks::Masks;

/// What a triangle adds to the winding number of a point before it, seen along the ray's way out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    /// Bounds no solid.
    Open,
    /// Corners run counter-clockwise seen from outside the solid.
    Solid { part: Option<u32> },
    /// Clockwise: the whole solid was turned over.
    TurnedSolid { part: Option<u32> },
}

/// The casters.
pub struct Ground<'a> {
    tracer: Tracer,
    casters: Casters<'a>,
    masks: Masks<'a>,
    /// By [`TriangleId`].
    sides: Vec<Side>,
    /// Hits nearer than this are the ray's own start, metres: a few roundings of a point's coordinates.
    near_m: f64,
}

impl<'a> Ground<'a> {
    pub fn new(scene: &'a Scene, blend: Blend, inverted: Inverted) -> Result<Self> {
        let casts = |node: &Node, material: &Material| {
            !node.dynamic && (material.alpha_mode != AlphaMode::Blend || blend == Blend::Opaque)
        };
        let tracer = Tracer::new(scene, casts);
        let memory_limit = u64::MAX;
        let casters = Casters::new(scene, CasterOptions { find_solids: true, inverted, blend, memory_limit })?;
        let sides = sides(&tracer, &casters);
        let masks = Masks::new(scene, &tracer);
        let bounds = tracer.bounds();
        let largest = if bounds.is_empty() { 0.0 } else { bounds.min.abs().max(bounds.max.abs()).max_element() };
        Ok(Self { near_m: 1e-14 * largest + 1e-12 * bounds.diagonal(), tracer, casters, masks, sides })
    }

    pub fn tracer(&self) -> &Tracer {
        &self.tracer
    }

    pub fn casters(&self) -> &Casters<'a> {
        &self.casters
    }

    /// Hits nearer than this are the ray's own start, metres.
    pub fn near_m(&self) -> f64 {
        self.near_m
    }

    /// Whether anything but a triangle lies on a ray.
    pub fn is_occluded(&self, ray: &Ray, but: Option<TriangleId>) -> bool {
        self.tracer.occluded_if(ray, |hit| self.counts(hit, but))
    }

    /// The last hit of anything but a triangle on a ray.
    pub fn last_hit(&self, ray: &Ray, but: Option<TriangleId>) -> Option<f64> {
        let mut last = None;
        self.tracer.for_each_hit(ray, |hit| {
            if last.is_none_or(|t| hit.t > t) && self.counts(&hit, but) {
                last = Some(hit.t);
            }
        });
        last
    }

    /// How many solids hold a ray's start, which may lie on a triangle and just outside it; opened parts bound none.
    pub fn winding(&self, ray: &Ray, own: Option<TriangleId>, opened: &OpenedParts) -> i32 {
        // Just outside its triangle, a ray that goes inward enters first.
        let enters = |own| {
            let is_open = self.side(own, opened) == Side::Open;
            !is_open && self.outward(own).dot(ray.direction) < 0.0
        };
        let mut winding = -i32::from(own.is_some_and(enters));
        self.tracer.for_each_hit(ray, |hit| {
            let leaves = if hit.front { -1 } else { 1 };
            winding += match self.side(hit.triangle, opened) {
                _ if own == Some(hit.triangle) => 0,
                Side::Open => 0,
                Side::Solid { .. } => leaves,
                Side::TurnedSolid { .. } => -leaves,
            };
        });
        winding
    }

    /// Unit normal of a triangle, away from the solid that it bounds; zero where the triangle is too thin to have one.
    pub fn outward(&self, triangle: TriangleId) -> DVec3 {
        let normal = self.tracer.normal(triangle);
        if matches!(self.sides[triangle.0 as usize], Side::TurnedSolid { .. }) { -normal } else { normal }
    }

    fn counts(&self, hit: &Hit, but: Option<TriangleId>) -> bool {
        but != Some(hit.triangle) && self.masks.keeps(&self.tracer, hit)
    }

    fn side(&self, triangle: TriangleId, opened: &OpenedParts) -> Side {
        match self.sides[triangle.0 as usize] {
            Side::Solid { part: Some(part) } | Side::TurnedSolid { part: Some(part) } if opened.contains(part) => {
                Side::Open
            }
            side => side,
        }
    }
}

/// The baker's word on each of the tracer's triangles. Both go through the scene in its order; the casters' seams, which
/// have no area, are the only ones that the tracer lacks.
fn sides(tracer: &Tracer, casters: &Casters<'_>) -> Vec<Side> {
    let mut order: Vec<TriangleId> = (0..tracer.triangle_count() as u32).map(TriangleId).collect();
    order.sort_by_cached_key(|&id| {
        let source = tracer.source(id);
        (source.node, source.primitive, source.triangle)
    });
    let mut sides = vec![Side::Open; order.len()];
    let mut next = order.into_iter().peekable();
    casters.for_each(|caster| {
        let [a, b, c] = caster.corners;
        let is_same = |id: &TriangleId| {
            let corners = tracer.corners(*id);
            corners == [a, b, c] || corners == [a, c, b]
        };
        let Some(id) = next.next_if(is_same) else { return };
        let turned = tracer.corners(id) != [a, b, c];
        let part = caster.part;
        sides[id.0 as usize] = match (caster.solid, turned) {
            (false, _) => Side::Open,
            (true, false) => Side::Solid { part },
            (true, true) => Side::TurnedSolid { part },
        };
    });
    sides
}
