//! Which closed parts are turned inward, and whether they lie in a solid (a room in it) or alone.

use antumbra_scene::{Bounds, Scene};
use glam::DVec3;

use super::closed::Parts;
use super::{Blend, casting_triangles};

/// Where a closed part stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// Its volume is positive (or zero): an ordinary solid.
    Outward,
    /// Turned inward, within other parts' solid: a cavity.
    InSolid,
    /// Turned inward, in no solid.
    Lone,
}

/// What is known of a part after one pass over its triangles.
#[derive(Clone)]
struct Shape {
    bounds: Bounds,
    /// Six times the signed volume.
    volume: f64,
    /// The part's first corner: volumes are summed about it, so that far-off parts keep their digits.
    anchor: DVec3,
    /// The largest triangle, and its squared doubled area.
    largest: ([DVec3; 3], f64),
}

/// Judges each part, and gives its box. Two passes over the triangles, the second only where there are inward parts.
pub(crate) fn judge_places(scene: &Scene, casting: &[usize], parts: &Parts, blend: Blend) -> (Vec<Place>, Vec<Bounds>) {
    let nothing = Shape { bounds: Bounds::EMPTY, volume: 0.0, anchor: DVec3::ZERO, largest: ([DVec3::ZERO; 3], -1.0) };
    let mut shapes = vec![nothing; parts.count];
    for_each_triangle(scene, casting, parts, blend, |part, corners| shapes[part].insert(corners));
    let inward: Vec<usize> = (0..parts.count).filter(|&p| shapes[p].volume < 0.0).collect();
    let mut places = vec![Place::Outward; parts.count];
    let bounds: Vec<Bounds> = shapes.iter().map(|s| s.bounds).collect();
    if inward.is_empty() {
        return (places, bounds);
    }
    let probes: Vec<DVec3> = inward.iter().map(|&p| shapes[p].probe_outside()).collect();
    let probes_in = probes_in_parts(&shapes, &inward, &probes);
    let mut windings = vec![0; inward.len()];
    for_each_triangle(scene, casting, parts, blend, |part, corners| {
        for &i in &probes_in[part] {
            windings[i] += ray_crossing(&corners, probes[i]);
        }
    });
    for (&part, winding) in inward.iter().zip(windings) {
        places[part] = if winding > 0 { Place::InSolid } else { Place::Lone };
    }
    (places, bounds)
}

/// For each part, the probes of other parts that lie in its box: outside, its winding number is zero.
fn probes_in_parts(shapes: &[Shape], inward: &[usize], probes: &[DVec3]) -> Vec<Vec<usize>> {
    let mut along_x: Vec<usize> = (0..probes.len()).collect();
    along_x.sort_by(|&a, &b| probes[a].x.total_cmp(&probes[b].x));
    let within = |(part, shape): (usize, &Shape)| {
        let first = along_x.partition_point(|&i| probes[i].x < shape.bounds.min.x);
        let beside = along_x[first..].iter().take_while(|&&i| probes[i].x <= shape.bounds.max.x);
        beside.copied().filter(|&i| inward[i] != part && contains(&shape.bounds, probes[i])).collect()
    };
    shapes.iter().enumerate().map(within).collect()
}

/// Calls `each` with every closed part's triangles, counter-clockwise seen from outside, in the world.
fn for_each_triangle(
    scene: &Scene,
    casting: &[usize],
    parts: &Parts,
    blend: Blend,
    mut each: impl FnMut(usize, [DVec3; 3]),
) {
    for (caster_node, &index) in casting.iter().enumerate() {
        let node = &scene.nodes[index];
        let mirrors = node.mirrors();
        for (i, t) in casting_triangles(scene, index, blend).enumerate() {
            if let Some(part) = parts.of(caster_node, i) {
                let mut corners = t.corners().map(|p| node.world_point(p));
                if mirrors {
                    corners.swap(1, 2);
                }
                each(part as usize, corners);
            }
        }
    }
}

fn contains(bounds: &Bounds, p: DVec3) -> bool {
    p.cmpge(bounds.min).all() && p.cmple(bounds.max).all()
}

impl Shape {
    fn insert(&mut self, corners: [DVec3; 3]) {
        if self.bounds.is_empty() {
            self.anchor = corners[0];
        }
        corners.into_iter().for_each(|c| self.bounds.insert(c));
        let [a, b, c] = corners.map(|p| p - self.anchor);
        self.volume += a.dot(b.cross(c));
        let doubled_area = (b - a).cross(c - a).length_squared();
        if doubled_area > self.largest.1 {
            self.largest = (corners, doubled_area);
        }
    }

    /// A point just off the largest triangle, on the side that its (inward) normal turns away from. It lies off the
    /// middle by irregular shares, so that rays from it miss edges.
    fn probe_outside(&self) -> DVec3 {
        let t = self.largest.0;
        let normal = (t[1] - t[0]).cross(t[2] - t[0]).normalize_or_zero();
        t[0] * 0.3137 + t[1] * 0.3571 + t[2] * 0.3292 - normal * (1e-4 * self.bounds.diagonal())
    }
}

/// +1 where the ray from `p` towards +x leaves through the triangle's outside, -1 where it enters, else 0.
fn ray_crossing(t: &[DVec3; 3], p: DVec3) -> i32 {
    let side = |a: DVec3, b: DVec3| (b.y - a.y) * (p.z - a.z) - (b.z - a.z) * (p.y - a.y);
    let w = [side(t[1], t[2]), side(t[2], t[0]), side(t[0], t[1])];
    let inside = w.iter().all(|v| *v > 0.0) || w.iter().all(|v| *v < 0.0);
    let area: f64 = w.iter().sum();
    let x = (w[0] * t[0].x + w[1] * t[1].x + w[2] * t[2].x) / area;
    if inside && x > p.x { if area > 0.0 { 1 } else { -1 } } else { 0 }
}
