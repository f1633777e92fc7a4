//! Which local lights to measure.

use antumbra_render::{Ray, Tracer};
use antumbra_scene::{Light, LightKind};
use glam::DVec3;

use crate::compare::Kind;
use crate::compare::sampling::Random;

/// Most lights that are measured.
const MOST: usize = 8;

/// At most [`MOST`] of them, spread over the scene's order.
pub fn chosen<'a>(lamps: impl Iterator<Item = &'a Light>) -> Vec<Light> {
    let all: Vec<&Light> = lamps.collect();
    let kept = all.len().min(MOST);
    (0..kept).map(|i| all[i * all.len() / kept].clone()).collect()
}

/// Height above the ground, distance from the wall, and range of a lamp on a wall, metres.
const HEIGHT_M: f64 = 4.0;
const OFF_WALL_M: f64 = 0.5;
const RANGE_M: f64 = 60.0;
/// Walls are looked for this far from a place in the open.
const FARTHEST_WALL_M: f64 = 30.0;

/// Spot lights on the walls of a city: each shines down and along the street.
pub fn on_walls(tracer: &Tracer) -> Vec<Light> {
    (0..10_000).filter_map(|i| on_wall(tracer, &mut Random::new(6, Kind::Air, i))).take(MOST).collect()
}

fn on_wall(tracer: &Tracer, random: &mut Random) -> Option<Light> {
    let bounds = tracer.bounds();
    let share = DVec3::new(0.2 + 0.6 * random.unit(), 1.0, 0.2 + 0.6 * random.unit());
    let above = bounds.min + (bounds.max - bounds.min) * share + DVec3::Y;
    let drop = Ray::new(above, DVec3::NEG_Y);
    let ground = drop.at(tracer.closest(&drop)?.t);
    let (sin, cos) = (std::f64::consts::TAU * random.unit()).sin_cos();
    let towards_wall = DVec3::new(cos, 0.0, sin);
    let across = Ray::new(ground + DVec3::Y * HEIGHT_M, towards_wall).between(2.0 * OFF_WALL_M, FARTHEST_WALL_M);
    let wall = tracer.closest(&across)?;
    let along_wall = tracer.normal(wall.triangle).cross(DVec3::Y).try_normalize()?;
    Some(Light {
        name: "wall lamp".to_owned(),
        kind: LightKind::Spot { inner_angle: 0.5, outer_angle: 1.0 },
        position_world: across.at(wall.t - OFF_WALL_M),
        direction_world: (along_wall - DVec3::Y).normalize(),
        color: [1.0; 3],
        intensity: 1000.0,
        range_m: Some(RANGE_M),
        dynamic: false,
    })
}
