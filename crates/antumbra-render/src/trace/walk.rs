//! The three questions to a [`Tracer`]: is anything hit, what is hit first, what is hit at all.

use glam::{UVec2, uvec2};
use obvhs::{
    cwbvh::node::CwBvhNode,
    faststack::{FastStack, HeapStack, StackStack},
    traverse,
};

use super::{Hit, Ray, Tracer, TriangleId, frame::Clipped, triangle::Shear};

/// Levels of a tree for which the traversal's stack lies on the thread's stack. Trees are hardly ever deeper than 12.
const SHALLOW: usize = 32;

/// What to do after a triangle has been looked at.
enum Step {
    /// Look no further than this parameter of the tree's ray.
    Until(f32),
    On,
    Stop,
}

impl Tracer {
    /// Whether anything lies on the ray.
    #[must_use]
    pub fn occluded(&self, ray: &Ray) -> bool {
        self.occluded_if(ray, |_| true)
    }

    /// Whether anything for which `accept` holds lies on the ray: an alpha test goes here. Hits come in no order.
    #[must_use]
    pub fn occluded_if(&self, ray: &Ray, mut accept: impl FnMut(&Hit) -> bool) -> bool {
        let mut found = false;
        self.visit(ray, |_, hit| {
            found = accept(&hit);
            if found { Step::Stop } else { Step::On }
        });
        found
    }

    /// The first thing on the ray.
    #[must_use]
    pub fn closest(&self, ray: &Ray) -> Option<Hit> {
        self.closest_if(ray, |_| true)
    }

    /// The first thing on the ray for which `accept` holds. Of hits at the same place to the bit, the triangle that
    /// comes first in the scene wins. `accept` sees hits in no order, and further ones than the answer too.
    #[must_use]
    pub fn closest_if(&self, ray: &Ray, mut accept: impl FnMut(&Hit) -> bool) -> Option<Hit> {
        let mut best: Option<Hit> = None;
        self.visit(ray, |clipped, hit| {
            if !best.is_none_or(|b| self.before(&hit, &b)) || !accept(&hit) {
                return Step::On;
            }
            best = Some(hit);
            Step::Until(clipped.tree_t(hit.t))
        });
        best
    }

    /// Everything on the ray, in no order. A ray that crosses a closed surface meets as many fronts as it meets
    /// backs, even through edges and corners: the sum of +1 for each front and -1 for each back is a winding number.
    pub fn for_each_hit(&self, ray: &Ray, mut visit: impl FnMut(Hit)) {
        self.visit(ray, |_, hit| {
            visit(hit);
            Step::On
        });
    }

    fn before(&self, a: &Hit, b: &Hit) -> bool {
        let place = |hit: &Hit| self.flattened[hit.triangle.0 as usize];
        a.t < b.t || (a.t == b.t && place(a) < place(b))
    }

    /// Calls `step` for the triangles on the ray, in the tree's order.
    #[inline(always)]
    fn visit(&self, ray: &Ray, step: impl FnMut(&Clipped, Hit) -> Step) {
        let Some(clipped) = self.frame.clip(ray) else { return };
        if self.tree.nodes.is_empty() {
            return;
        }
        if self.depth <= SHALLOW {
            self.walk(ray, clipped, StackStack::<UVec2, SHALLOW>::default(), step);
        } else {
            self.walk(ray, clipped, HeapStack::new_with_capacity(self.depth), step);
        }
    }

    #[inline(always)]
    fn walk(
        &self,
        ray: &Ray,
        mut clipped: Clipped,
        stack: impl FastStack<UVec2>,
        mut step: impl FnMut(&Clipped, Hit) -> Step,
    ) {
        let shear = Shear::new(ray.origin, ray.direction);
        let mut state = Walk::new(stack, &clipped);
        let mut node: &CwBvhNode;
        traverse!(self.tree, node, state, node.intersect_ray(&clipped.ray, state.oct_inv4), {
            if let Some(hit) = self.hit(&shear, ray, state.primitive_id) {
                match step(&clipped, hit) {
                    Step::Until(t) => clipped.ray.tmax = clipped.ray.tmax.min(t),
                    Step::On => {}
                    Step::Stop => return,
                }
            }
        });
    }

    #[inline(always)]
    fn hit(&self, shear: &Shear, ray: &Ray, id: u32) -> Option<Hit> {
        let crossing = shear.cross(&self.corners[id as usize])?;
        (crossing.t > ray.t_min && crossing.t < ray.t_max).then_some(Hit {
            t: crossing.t,
            triangle: TriangleId(id),
            u: crossing.u,
            v: crossing.v,
            front: crossing.front,
        })
    }
}

/// obvhs's traversal state with a stack of our choice; `traverse!` goes by the names of the fields.
struct Walk<S> {
    stack: S,
    current_group: UVec2,
    primitive_group: UVec2,
    oct_inv4: u32,
    primitive_id: u32,
    hitmask: u32,
}

impl<S> Walk<S> {
    #[inline(always)]
    fn new(stack: S, clipped: &Clipped) -> Self {
        let d = clipped.ray.direction;
        let axis = |component: f32, bit: u32| if component < 0.0 { 0 } else { bit };
        Self {
            stack,
            // Says "visit the root": child 0 of a group of one.
            current_group: uvec2(0, 0x8000_0000),
            primitive_group: UVec2::ZERO,
            oct_inv4: axis(d.x, 0x0404_0404) | axis(d.y, 0x0202_0202) | axis(d.z, 0x0101_0101),
            primitive_id: 0,
            hitmask: 0,
        }
    }
}
