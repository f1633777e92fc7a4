//! Spot lights along the streets, as many as asked for.
//!
//! 165 of them are like the city of Kampe, Sintorn, Dolonius and Assarsson (2015), "Fast, Memory-Efficient Construction of
//! Voxelized Shadows": each lights a small part of it.
//!
//! Posts could stand at every few metres of every kerb; farthest-point sampling picks among those places, so that any
//! number of lamps is spread evenly, and the first hundred are the same whether or not more follow.

use glam::{DVec2, DVec3};

use super::layout::{Plan, Street};
use super::streets::{Stretch, stretches};
use crate::model::Light;
use crate::procedural::palette::Paint;
use crate::procedural::rng::Rng;
use crate::procedural::solids::{Builder, Turn};
use crate::procedural::view::{Cone, spot};

/// Distance between neighbouring places along a kerb, unless more are needed.
const STEP_M: f64 = 7.0;
/// From the post to the lamp, over the street: beyond the crowns of the kerb's trees.
const ARM_M: f64 = 3.4;
/// From the kerb to the post, away from the street.
const SETBACK_M: f64 = 0.45;

/// A place for a post: on a kerb.
#[derive(Clone, Copy, Debug)]
struct Place {
    at: DVec2,
    /// Unit vector towards the middle of the street.
    inward: DVec2,
}

/// A lamp on its post.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lamp {
    place: Place,
    head: DVec3,
    cone: Cone,
    range_m: f64,
    candela: f32,
    color: [f32; 3],
}

/// Places that many lamps.
pub(crate) fn place(plan: &Plan, rng: &Rng, count: usize) -> Vec<Lamp> {
    let streets = all_stretches(plan);
    let mut step = STEP_M;
    let mut places = along(&streets, step);
    while places.len() < count {
        step *= 0.5;
        places = along(&streets, step);
    }
    let picked = spread(&places, count);
    picked.iter().enumerate().map(|(i, &place)| lamp(place, &mut rng.fork(i as u64))).collect()
}

/// Every street between crossings; where there is none, the roads around the only block.
fn all_stretches(plan: &Plan) -> Vec<Stretch> {
    let mut all = Vec::new();
    for (streets, others, along_z) in
        [(&plan.meridians, &plan.parallels, true), (&plan.parallels, &plan.meridians, false)]
    {
        all.extend(streets.iter().flat_map(|street| stretches(plan, street, others, along_z)));
    }
    if all.is_empty() {
        const WIDTH_M: f64 = 13.0;
        for (side, along_z) in [(-1.0, true), (1.0, true), (-1.0, false), (1.0, false)] {
            let reach = if along_z { plan.half.x } else { plan.half.y };
            let street = Street { middle: side * (reach - 0.5 * WIDTH_M - 1.0), width: WIDTH_M };
            all.extend(stretches(plan, &street, &[], along_z));
        }
    }
    all
}

/// Places on both kerbs, staggered.
fn along(streets: &[Stretch], step: f64) -> Vec<Place> {
    let mut places = Vec::new();
    for street in streets {
        let long = (street.to - street.from).length();
        let way = (street.to - street.from) / long;
        let count = (long / step) as usize;
        for (i, side) in (0..count).flat_map(|i| [(i, -1.0), (i, 1.0)]) {
            let t = (i as f64 + 0.5 + 0.25 * side) / count as f64;
            let inward = way.perp() * -side;
            let at = street.from.lerp(street.to, t) - inward * (street.width * 0.5 + SETBACK_M);
            places.push(Place { at, inward });
        }
    }
    places
}

/// Farthest-point sampling from the place nearest the middle of the city.
fn spread(places: &[Place], count: usize) -> Vec<Place> {
    let mut apart: Vec<f64> = vec![f64::INFINITY; places.len()];
    let central = (0..places.len()).min_by(|&a, &b| {
        let off = |i: usize| places[i].at.length_squared();
        off(a).total_cmp(&off(b))
    });
    let mut picked = Vec::with_capacity(count);
    let mut next = central;
    while let Some(i) = next.filter(|_| picked.len() < count) {
        picked.push(places[i]);
        for (distance, place) in apart.iter_mut().zip(places) {
            *distance = distance.min((place.at - places[i].at).length_squared());
        }
        next = (0..places.len()).max_by(|&a, &b| apart[a].total_cmp(&apart[b]));
    }
    picked
}

/// Three of four light the street below; the fourth is thrown along the facades of the other side.
fn lamp(place: Place, rng: &mut Rng) -> Lamp {
    let height = rng.range(9.0, 12.0);
    let over = place.at + place.inward * ARM_M;
    let head = DVec3::new(over.x, height, over.y);
    let inward = DVec3::new(place.inward.x, 0.0, place.inward.y);
    let along = inward.cross(DVec3::Y) * if rng.chance(0.5) { 1.0 } else { -1.0 };
    let white = rng.range(0.0, 1.0) as f32;
    let color = [1.0, 0.74 + 0.12 * white, 0.46 + 0.26 * white];
    let outer_deg = rng.range(50.0, 60.0);
    if rng.chance(0.75) {
        let axis = DVec3::NEG_Y + inward * rng.range(0.05, 0.3) + along * rng.range(0.0, 0.2);
        let cone = Cone { axis, inner_deg: 0.6 * outer_deg, outer_deg };
        Lamp { place, head, cone, range_m: rng.range(25.0, 32.0), candela: rng.range(900.0, 1500.0) as f32, color }
    } else {
        let axis = inward * 0.9 + along * rng.range(0.5, 1.1) + DVec3::Y * rng.range(-0.2, 0.25);
        let cone = Cone { axis, inner_deg: 0.4 * outer_deg, outer_deg };
        Lamp { place, head, cone, range_m: rng.range(32.0, 40.0), candela: rng.range(1500.0, 2600.0) as f32, color }
    }
}

impl Lamp {
    /// The light itself, a little below its housing.
    pub(crate) fn light(&self, name: String) -> Light {
        spot(name, self.head - DVec3::Y * 0.15, self.cone, self.range_m, self.candela, self.color)
    }
}

/// A post with an arm over the street and a housing at its end.
pub(crate) fn post(b: &mut Builder, lamp: &Lamp) {
    let (foot, inward, top) = (lamp.place.at, lamp.place.inward, lamp.head.y);
    let turn = Turn::facing(inward);
    b.within(DVec3::new(foot.x, 0.0, foot.y), turn, |b| {
        b.cone(Paint::GlassDark, DVec2::ZERO, 8, [(0.14, -0.3), (0.08, top + 0.45)]);
        b.cone(Paint::GlassDark, DVec2::ZERO, 8, [(0.22, -0.3), (0.18, 1.1)]);
        let (shoulder, tip) = (DVec3::new(0.0, top + 0.35, 0.0), DVec3::new(ARM_M, top + 0.12, 0.0));
        b.strut(Paint::GlassDark, shoulder, tip, 0.05, 4);
        b.pillar(Paint::Steel, DVec2::new(ARM_M, 0.0), DVec2::new(0.8, 0.34), top, top + 0.2);
    });
}
