//! Many lamps: finds those whose light reaches a point without asking all the others.
//!
//! A binary tree of boxes about the lamps' spheres of light, in depth-first order. Each node knows where to go on when its
//! box misses the point, so that a walk needs no stack (Smits 1998, "Efficiency Issues for Ray Tracing", section 4.3).

use antumbra_scene::Bounds;
use glam::DVec3;

use super::{Lamp, Lamplight};

/// Lamps, ready to be asked for light at points.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lamps {
    lamps: Vec<Lamp>,
    nodes: Vec<Node>,
    /// Irradiance that counts as none.
    pub least: f32,
}

#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Bounds,
    /// Node to go on with where the box does not hold the point.
    skip: u32,
    /// A leaf's lamp.
    lamp: Option<u32>,
}

impl Lamps {
    /// Light of less than `least` irradiance counts as none.
    pub(crate) fn new(lamps: Vec<Lamp>, least: f32) -> Self {
        let boxes: Vec<Bounds> = lamps.iter().map(|lamp| around(lamp, least)).collect();
        let mut order: Vec<u32> = (0..lamps.len() as u32).collect();
        let mut nodes = Vec::with_capacity(2 * lamps.len());
        build(&boxes, &mut order, &mut nodes);
        Self { lamps, nodes, least }
    }

    /// Moves a lamp.
    #[cfg(feature = "gpu")]
    pub(crate) fn move_to(&mut self, index: usize, position_world: DVec3) {
        let mut lamps = std::mem::take(&mut self.lamps);
        lamps[index].position_world = position_world;
        *self = Self::new(lamps, self.least);
    }

    pub(crate) fn all(&self) -> &[Lamp] {
        &self.lamps
    }

    /// Calls `visit` with the index and the light of each lamp that reaches a point, always in the same order.
    #[inline]
    pub(crate) fn reaching(&self, point_world: DVec3, mut visit: impl FnMut(usize, Lamplight)) {
        let mut next = 0;
        while let Some(node) = self.nodes.get(next) {
            if !holds(&node.bounds, point_world) {
                next = node.skip as usize;
                continue;
            }
            next += 1;
            let Some(lamp) = node.lamp else { continue };
            if let Some(light) = self.lamps[lamp as usize].at(point_world) {
                visit(lamp as usize, light);
            }
        }
    }
}

fn around(lamp: &Lamp, least: f32) -> Bounds {
    let reach = DVec3::splat(lamp.reach_m(least));
    Bounds { min: lamp.position_world - reach, max: lamp.position_world + reach }
}

fn holds(bounds: &Bounds, p: DVec3) -> bool {
    p.cmpge(bounds.min).all() && p.cmple(bounds.max).all()
}

/// Appends the tree of some lamps: split at the median along the axis on which their places differ most.
fn build(boxes: &[Bounds], order: &mut [u32], nodes: &mut Vec<Node>) {
    let Some(&first) = order.first() else { return };
    let mut bounds = Bounds::EMPTY;
    let mut places = Bounds::EMPTY;
    for &lamp in order.iter() {
        let own = &boxes[lamp as usize];
        bounds.insert(own.min);
        bounds.insert(own.max);
        places.insert(own.center());
    }
    let index = nodes.len();
    let is_leaf = order.len() == 1;
    nodes.push(Node { bounds, skip: 0, lamp: is_leaf.then_some(first) });
    if !is_leaf {
        let axis = (places.max - places.min).max_position();
        let place = |lamp: &u32| boxes[*lamp as usize].center()[axis];
        let middle = order.len() / 2;
        order.sort_by(|a, b| place(a).total_cmp(&place(b)));
        let (left, right) = order.split_at_mut(middle);
        build(boxes, left, nodes);
        build(boxes, right, nodes);
    }
    nodes[index].skip = nodes.len() as u32;
}

#[cfg(test)]
mod tests {
    use antumbra_scene::{Light, LightKind};

    use super::*;
    use crate::sampling::r2;

    fn lamp(i: u32) -> Lamp {
        let place = r2(i);
        let light = Light {
            name: format!("lamp {i}"),
            kind: LightKind::Point,
            position_world: DVec3::new(place.x * 40.0, f64::from(i % 3), place.y * 40.0),
            direction_world: DVec3::NEG_Z,
            color: [1.0; 3],
            intensity: 128_000.0,
            range_m: (!i.is_multiple_of(4)).then_some(1.0 + f64::from(i % 7)),
            dynamic: false,
        };
        Lamp::of_light(&light, 60.0).expect("a lamp")
    }

    #[test]
    fn the_tree_finds_what_a_search_finds() {
        let least = 0.02;
        for count in [0, 1, 2, 3, 200] {
            let all: Vec<Lamp> = (0..count).map(lamp).collect();
            let lamps = Lamps::new(all.clone(), least);
            for i in 0..500 {
                let p = DVec3::new(r2(i).x * 50.0 - 5.0, f64::from(i % 5) - 1.0, r2(i).y * 50.0 - 5.0);
                let mut found = Vec::new();
                lamps.reaching(p, |index, light| {
                    assert_eq!(Some(light), all[index].at(p));
                    found.push(index);
                });
                found.sort_unstable();
                let bright = |l: &Lamp| l.at(p).is_some_and(|light| light.irradiance.y >= least * 1.01);
                assert!(all.iter().enumerate().all(|(i, l)| !bright(l) || found.contains(&i)), "{p}");
                assert!(found.iter().all(|&i| all[i].at(p).is_some()));
                assert!(found.windows(2).all(|w| w[0] < w[1]), "a lamp twice");
            }
        }
    }
}
