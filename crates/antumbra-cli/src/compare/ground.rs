//! The ground truth: rays towards a light, and winding numbers along them.

use antumbra_bake::casters::{CasterOptions, Casters};
use antumbra_bake::{Blend, Inverted};
use antumbra_render::{Ray, Tracer, TriangleId};
use antumbra_scene::{AlphaMode, Material, Node, Scene};
use anyhow::Result;
use glam::DVec3;

/// What is true of a point and a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Truth {
    /// Nothing lies on the ray towards the light.
    Lit,
    /// Something does.
    Shadowed,
    /// The point lies inside a closed part, so that nobody sees what the bake answers.
    Inside,
}

/// What a triangle adds to the winding number of a point before it, seen along the ray's way out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Side {
    /// Bounds no solid.
    Open,
    /// Corners run counter-clockwise seen from outside the solid.
    Solid,
    /// Clockwise: the whole solid was turned over.
    TurnedSolid,
}

/// The casters, ready to trace.
pub struct Ground {
    tracer: Tracer,
    /// By [`TriangleId`].
    sides: Vec<Side>,
    /// Hits nearer than this are the ray's own start, metres: a few roundings of a point's coordinates.
    near_m: f64,
}

impl Ground {
    pub fn new(scene: &Scene, blend: Blend, inverted: Inverted) -> Result<Self> {
        let casts = |node: &Node, material: &Material| {
            !node.dynamic && (material.alpha_mode != AlphaMode::Blend || blend == Blend::Opaque)
        };
        let tracer = Tracer::new(scene, casts);
        let memory_limit = u64::MAX;
        let casters = Casters::new(scene, CasterOptions { find_solids: true, inverted, blend, memory_limit })?;
        let sides = sides(&tracer, &casters);
        let bounds = tracer.bounds();
        let largest = if bounds.is_empty() { 0.0 } else { bounds.min.abs().max(bounds.max.abs()).max_element() };
        Ok(Self { near_m: 1e-14 * largest + 1e-12 * bounds.diagonal(), tracer, sides })
    }

    pub fn tracer(&self) -> &Tracer {
        &self.tracer
    }

    /// The truth at a point, to the letter: a hair behind a surface is in its shadow.
    pub fn truth(&self, point_world: DVec3, towards_light: DVec3, solids_are_free: bool) -> Truth {
        let ray = Ray::new(point_world, towards_light);
        self.settle(&ray, solids_are_free, None)
    }

    /// The truth at a point of a triangle, seen from outside: the triangle casts nothing on itself, and where it faces
    /// away from the light, its own solid does.
    pub fn truth_on(&self, point_world: DVec3, own: TriangleId, towards_light: DVec3, solids_are_free: bool) -> Truth {
        let ray = Ray::new(point_world, towards_light).between(self.near_m, f64::INFINITY);
        self.settle(&ray, solids_are_free, Some(own))
    }

    /// Unit normal of a triangle, away from the solid that it bounds; zero where the triangle is too thin to have one.
    pub fn outward(&self, triangle: TriangleId) -> DVec3 {
        let normal = self.tracer.normal(triangle);
        if self.side(triangle) == Side::TurnedSolid { -normal } else { normal }
    }

    fn side(&self, triangle: TriangleId) -> Side {
        self.sides[triangle.0 as usize]
    }

    fn settle(&self, ray: &Ray, solids_are_free: bool, own: Option<TriangleId>) -> Truth {
        if !self.tracer.occluded_if(ray, |hit| own != Some(hit.triangle)) {
            return Truth::Lit;
        }
        if !solids_are_free {
            return Truth::Shadowed;
        }
        // Just outside its triangle, a ray that goes inward enters first.
        let enters = |own| self.side(own) != Side::Open && self.outward(own).dot(ray.direction) < 0.0;
        let mut winding = -i32::from(own.is_some_and(enters));
        self.tracer.for_each_hit(ray, |hit| {
            let leaves = if hit.front { -1 } else { 1 };
            winding += match self.side(hit.triangle) {
                _ if own == Some(hit.triangle) => 0,
                Side::Open => 0,
                Side::Solid => leaves,
                Side::TurnedSolid => -leaves,
            };
        });
        if winding > 0 { Truth::Inside } else { Truth::Shadowed }
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
        sides[id.0 as usize] = match (caster.solid, turned) {
            (false, _) => Side::Open,
            (true, false) => Side::Solid,
            (true, true) => Side::TurnedSolid,
        };
    });
    sides
}
