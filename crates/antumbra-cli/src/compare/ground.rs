//! The ground truth: rays towards a light, alpha masks, and winding numbers along them.

use antumbra::{Interior, LightKind, LightShadow};
use antumbra_bake::casters::{CasterOptions, Casters, OpenedParts};
use antumbra_bake::{Blend, Inverted};
use antumbra_render::{Hit, Ray, Tracer, TriangleId};
use antumbra_scene::{AlphaMode, AlphaTest, Material, Node, Scene};
use anyhow::Result;
use glam::DVec3;

/// What is true of a point and a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Truth {
    /// Nothing lies on the ray towards the light.
    Lit,
    /// Something does, or the point lies outside a spot light's cone.
    Shadowed,
    /// The point lies inside a closed part, so that nobody sees what the bake answers.
    Inside,
    /// The bake's policy leaves the answer open.
    Undefined,
}

impl Truth {
    /// Whether any answer will do.
    pub fn is_free(self) -> bool {
        matches!(self, Self::Inside | Self::Undefined)
    }
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
pub struct Ground<'a> {
    scene: &'a Scene,
    tracer: Tracer,
    casters: Casters<'a>,
    /// By [`TriangleId`]: its side, and its closed part.
    sides: Vec<(Side, Option<u32>)>,
    /// By mesh and primitive.
    masks: Vec<Vec<Option<AlphaTest<'a>>>>,
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
        let bounds = tracer.bounds();
        let largest = if bounds.is_empty() { 0.0 } else { bounds.min.abs().max(bounds.max.abs()).max_element() };
        let masks_of = |mesh: &'a antumbra_scene::Mesh| {
            mesh.primitives.iter().map(|primitive| AlphaTest::new(scene, primitive)).collect()
        };
        let masks = scene.meshes.iter().map(masks_of).collect();
        Ok(Self { near_m: 1e-14 * largest + 1e-12 * bounds.diagonal(), scene, tracer, casters, sides, masks })
    }

    pub fn tracer(&self) -> &Tracer {
        &self.tracer
    }

    /// Unit normal of a triangle, away from the solid that it bounds; zero where the triangle is too thin to have one.
    pub fn outward(&self, triangle: TriangleId) -> DVec3 {
        let normal = self.tracer.normal(triangle);
        if self.sides[triangle.0 as usize].0 == Side::TurnedSolid { -normal } else { normal }
    }

    /// Whether a surface is there where a ray meets it: its alpha mask.
    fn is_there(&self, hit: &Hit) -> bool {
        let source = self.tracer.source(hit.triangle);
        let mesh = self.scene.nodes[source.node].mesh;
        let Some(test) = &self.masks[mesh][source.primitive] else { return true };
        let primitive = source.primitive(self.scene);
        let weights = [1.0 - hit.u - hit.v, hit.u, hit.v];
        let corners = source.vertices(self.scene);
        let sum = |value: &dyn Fn(usize) -> f64| corners.iter().zip(weights).map(|(v, w)| value(*v) * w).sum::<f64>();
        let uv = [0, 1].map(|axis| sum(&|v| f64::from(primitive.texcoords[v][axis])));
        test.keeps(uv, sum(&|v| primitive.colors.get(v).map_or(1.0, |c| f64::from(c[3]))))
    }
}

/// The truth about one light of a bake.
pub struct Sight<'a> {
    ground: &'a Ground<'a>,
    light: LightShadow<'a>,
    /// Closed parts that bound no solid for this light.
    opened: OpenedParts,
    policy: Interior,
    /// A local light's.
    local: Option<Local>,
}

/// Where a local light stands and what it reaches.
struct Local {
    position_world: DVec3,
    axes: [DVec3; 3],
    is_cube: bool,
    near_m: f64,
    far_m: f64,
    /// -1 without a cone.
    cone_cosine: f64,
}

impl Local {
    /// Depth of a point along the axis of the face that sees it; a point behind a light with one face has a negative one.
    fn depth(&self, point_world: DVec3) -> f64 {
        let offset = point_world - self.position_world;
        let [x, y, z] = self.axes.map(|axis| axis.dot(offset));
        if self.is_cube { x.abs().max(y.abs()).max(z.abs()) } else { z }
    }

    fn is_in_cone(&self, point_world: DVec3) -> bool {
        let offset = point_world - self.position_world;
        self.cone_cosine <= -1.0 || self.axes[2].dot(offset) >= self.cone_cosine * offset.length()
    }
}

impl<'a> Sight<'a> {
    pub fn new(ground: &'a Ground<'a>, light: LightShadow<'a>) -> Self {
        let record = light.record();
        let local = (light.kind() != LightKind::Directional).then(|| Local {
            position_world: light.origin_world(),
            axes: record.linear.map(DVec3::from_array),
            is_cube: record.faces == 6,
            near_m: record.near_m,
            far_m: record.far_m,
            cone_cosine: if light.kind() == LightKind::Spot { record.cone_cosine } else { -1.0 },
        });
        // The baker's own word: parts that a near plane cuts, or that hold the light. A face's near plane reaches as far
        // aside as its grid.
        let tangent = 0.5 * f64::from(record.resolution()) / record.texels_per_tangent;
        let opened = local.as_ref().map_or_else(OpenedParts::default, |local| {
            ground.casters.opened_parts(local.position_world, local.axes, local.near_m * tangent.max(1.0))
        });
        Self { ground, light, opened, policy: light.interior(), local }
    }

    pub fn light(&self) -> LightShadow<'a> {
        self.light
    }

    pub fn ground(&self) -> &'a Ground<'a> {
        self.ground
    }

    /// Whether a point is of interest: the light reaches it, or its cone might.
    pub fn is_in_range(&self, point_world: DVec3) -> bool {
        self.local.as_ref().is_none_or(|local| local.depth(point_world) <= local.far_m)
    }

    /// Whether a point lies in the light's cone, if it has one.
    pub fn is_in_cone(&self, point_world: DVec3) -> bool {
        self.local.as_ref().is_none_or(|local| local.is_in_cone(point_world))
    }

    /// World box of what a local light reaches.
    pub fn reach(&self) -> Option<[DVec3; 2]> {
        let local = self.local.as_ref()?;
        // A cube in the light's own axes.
        let half = if local.is_cube { local.far_m } else { local.far_m * 2.0 };
        let reach = local.axes.iter().map(|axis| axis.abs()).sum::<DVec3>() * half;
        Some([local.position_world - reach, local.position_world + reach])
    }

    /// The truth at a point, to the letter: a hair behind a surface is in its shadow.
    pub fn truth(&self, point_world: DVec3) -> Truth {
        self.settle(point_world, 0.0, None)
    }

    /// The truth at a point of a triangle, seen from outside: the triangle casts nothing on itself, and where it faces
    /// away from the light, its own solid does.
    pub fn truth_on(&self, point_world: DVec3, own: TriangleId) -> Truth {
        self.settle(point_world, self.ground.near_m, Some(own))
    }

    fn settle(&self, point_world: DVec3, start_m: f64, own: Option<TriangleId>) -> Truth {
        let Some(ray) = self.ray(point_world, start_m) else {
            return if self.is_in_cone(point_world) { Truth::Lit } else { Truth::Shadowed };
        };
        if !self.is_in_cone(point_world) {
            return Truth::Shadowed;
        }
        let counts = |hit: &Hit| own != Some(hit.triangle) && self.ground.is_there(hit);
        if !self.ground.tracer.occluded_if(&ray, counts) {
            return Truth::Lit;
        }
        if self.policy != Interior::Open && self.winding(&ray, own) > 0 {
            return Truth::Inside;
        }
        if self.is_left_open(point_world, &ray, own) { Truth::Undefined } else { Truth::Shadowed }
    }

    /// From a point to where the light's rays start, of unit speed; `None` for a point before that.
    fn ray(&self, point_world: DVec3, start_m: f64) -> Option<Ray> {
        let Some(local) = &self.local else {
            return Some(Ray::new(point_world, -self.light.direction_world()).between(start_m, f64::INFINITY));
        };
        let offset = local.position_world - point_world;
        let (length, depth) = (offset.length(), local.depth(point_world));
        // Depth falls in proportion along the ray.
        let end = length * (1.0 - local.near_m / depth);
        (depth > local.near_m).then(|| Ray::new(point_world, offset / length).between(start_m, end))
    }

    fn winding(&self, ray: &Ray, own: Option<TriangleId>) -> i32 {
        let side = |triangle: TriangleId| match self.ground.sides[triangle.0 as usize] {
            (_, Some(part)) if self.opened.contains(part) => Side::Open,
            (side, _) => side,
        };
        // Just outside its triangle, a ray that goes inward enters first.
        let enters = |own| side(own) != Side::Open && self.ground.outward(own).dot(ray.direction) < 0.0;
        let mut winding = -i32::from(own.is_some_and(enters));
        self.ground.tracer.for_each_hit(ray, |hit| {
            let leaves = if hit.front { -1 } else { 1 };
            winding += match side(hit.triangle) {
                _ if own == Some(hit.triangle) => 0,
                Side::Open => 0,
                Side::Solid => leaves,
                Side::TurnedSolid => -leaves,
            };
        });
        winding
    }

    /// Whether the policy leaves a shadowed point's answer open.
    fn is_left_open(&self, point_world: DVec3, ray: &Ray, own: Option<TriangleId>) -> bool {
        let (Interior::Thickness(metres) | Interior::Static(metres)) = self.policy else { return false };
        let mut distances = Vec::new();
        self.ground.tracer.for_each_hit(ray, |hit| {
            if own != Some(hit.triangle) && self.ground.is_there(&hit) {
                distances.push(hit.t);
            }
        });
        let first = distances.iter().copied().fold(0.0, f64::max);
        if matches!(self.policy, Interior::Thickness(_)) {
            return first <= metres * (1.0 + 1e-9);
        }
        // Surfaces within a slice of the first may share its own, and do not count then.
        let slice_m = self.light.frame(ray.at(first)).slice_m * self.slope(ray);
        let is_second = |distance: &f64| *distance < first - slice_m * 1.01;
        own.is_none() && !distances.iter().any(is_second) && !self.is_before_surface(point_world, ray, metres)
    }

    /// Whether a surface lies less than so many metres behind a point, along the face's axis, and within the light's reach.
    fn is_before_surface(&self, point_world: DVec3, ray: &Ray, metres: f64) -> bool {
        let length = metres * self.slope(ray);
        let behind = Ray::new(point_world, -ray.direction).between(0.0, length);
        let reached = |hit: &Hit| self.is_in_range(behind.at(hit.t)) && self.ground.is_there(hit);
        self.ground.tracer.occluded_if(&behind, reached)
    }

    /// Metres along a ray per metre along the axis of its face.
    fn slope(&self, ray: &Ray) -> f64 {
        let along = self.light.frame(ray.origin).along;
        1.0 / along.dot(-ray.direction).max(1e-3)
    }
}

/// The baker's word on each of the tracer's triangles. Both go through the scene in its order; the casters' seams, which
/// have no area, are the only ones that the tracer lacks.
fn sides(tracer: &Tracer, casters: &Casters<'_>) -> Vec<(Side, Option<u32>)> {
    let mut order: Vec<TriangleId> = (0..tracer.triangle_count() as u32).map(TriangleId).collect();
    order.sort_by_cached_key(|&id| {
        let source = tracer.source(id);
        (source.node, source.primitive, source.triangle)
    });
    let mut sides = vec![(Side::Open, None); order.len()];
    let mut next = order.into_iter().peekable();
    casters.for_each(|caster| {
        let [a, b, c] = caster.corners;
        let is_same = |id: &TriangleId| {
            let corners = tracer.corners(*id);
            corners == [a, b, c] || corners == [a, c, b]
        };
        let Some(id) = next.next_if(is_same) else { return };
        let turned = tracer.corners(id) != [a, b, c];
        let side = match (caster.solid, turned) {
            (false, _) => Side::Open,
            (true, false) => Side::Solid,
            (true, true) => Side::TurnedSolid,
        };
        sides[id.0 as usize] = (side, caster.part);
    });
    sides
}
