//! The hairball: a ball of long thin fibres before a screen, for soft shadows of what is hard to voxelize.
//!
//! Each fibre is a closed tube that wanders over spheres about the ball's middle.

use glam::{DAffine3, DVec2, DVec3};

use super::Options;
use super::palette::{self, Paint, material};
use super::rng::Rng;
use super::solids::{Builder, Shading};
use super::view::{camera, moon};
use crate::model::{AreaLight, AreaShape, Node, Scene};

/// Fibres at scale 1.
const FIBRES: f64 = 1800.0;
/// Pieces of a fibre, and its sides.
const PIECES: usize = 24;
const SIDES: usize = 4;
const RADIUS: f64 = 1.0;
const MIDDLE: DVec3 = DVec3::new(0.0, 1.5, 0.0);

/// Builds the hairball.
pub(crate) fn build(options: &Options) -> Scene {
    let mut materials = palette::materials();
    materials.push(material("fibre", 0xc7a27a, 0.0, 0.7));
    let fibre = materials.len() - 1;
    let rng = Rng::new(options.seed);
    let mut ball = Builder::new();
    let count = (FIBRES * options.scale * options.scale).ceil().max(24.0) as u64;
    for number in 0..count {
        let rings = rings(&mut rng.fork(number), options.scale);
        ball.loft(fibre, Shading::Smooth, &rings);
    }
    let mut room = Builder::new();
    room.cuboid(Paint::StuccoWhite, DVec3::new(-6.0, -0.2, -4.0), DVec3::new(6.0, 0.0, 6.0));
    room.cuboid(Paint::StuccoCream, DVec3::new(-6.0, 0.0, -4.2), DVec3::new(6.0, 5.0, -4.0));
    room.pillar(Paint::Timber, DVec2::new(0.0, 0.0), DVec2::new(1.1, 1.1), 0.0, 0.45);
    let node =
        |name: &str, mesh| Node { name: name.to_owned(), mesh, world_from_mesh: DAffine3::IDENTITY, dynamic: false };
    let at = DVec3::new(-3.4, 3.6, 1.8);
    let direction_world = (MIDDLE - at).normalize();
    let across = direction_world.cross(DVec3::Y).normalize();
    Scene {
        name: "hairball".to_owned(),
        meshes: vec![room.finish("room"), ball.finish("hairball")],
        nodes: vec![node("room", 0), node("hairball", 1)],
        materials,
        lights: vec![moon(140.0, 50.0)],
        area_lights: vec![AreaLight {
            name: "screen".to_owned(),
            shape: AreaShape::Rectangle { width_m: 1.6, height_m: 1.0 },
            position_world: at,
            direction_world,
            up_world: across.cross(direction_world).normalize(),
            luminance: [900.0, 860.0, 780.0],
            frames: Vec::new(),
            frames_per_second: 0.0,
        }],
        cameras: vec![
            camera("overview", DVec3::new(2.6, 2.3, 5.4), DVec3::new(-0.2, 1.35, -0.4), 42.0),
            camera("close", DVec3::new(1.9, 1.9, 2.0), DVec3::new(0.1, 1.4, 0.0), 45.0),
        ],
        ..Scene::default()
    }
}

/// The rings of one fibre.
fn rings(rng: &mut Rng, scale: f64) -> Vec<Vec<DVec3>> {
    let mut out = direction(rng);
    let mut along = out.cross(direction(rng)).normalize();
    // Fewer fibres are thicker.
    let thick = 0.0045 / scale.sqrt();
    let mut height = RADIUS * rng.range(0.25, 1.0);
    let (bend, rise) = (rng.range(-0.9, 0.9), rng.range(-0.02, 0.03));
    (0..=PIECES)
        .map(|piece| {
            let at = MIDDLE + out * height;
            let aside = along.cross(out).normalize();
            let radius = thick * if piece == 0 || piece == PIECES { 0.35 } else { 1.0 };
            let ring = (0..SIDES).map(|i| {
                let (cos, sin) = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)][i];
                at + (out * cos + aside * sin) * radius
            });
            let ring: Vec<DVec3> = ring.collect();
            // On along a great circle that bends, a little up or down.
            let step = 0.16;
            let next = (out + along * step).normalize();
            along = (along + aside * (bend * step) - next * along.dot(next)).normalize();
            along = (along - next * along.dot(next)).normalize();
            out = next;
            height = (height + rise * RADIUS + rng.range(-0.02, 0.02)).clamp(0.2, 1.08 * RADIUS);
            ring
        })
        .collect()
}

/// Evenly over all directions.
fn direction(rng: &mut Rng) -> DVec3 {
    loop {
        let at = DVec3::new(rng.range(-1.0, 1.0), rng.range(-1.0, 1.0), rng.range(-1.0, 1.0));
        let square = at.length_squared();
        if (0.01..1.0).contains(&square) {
            return at / square.sqrt();
        }
    }
}
