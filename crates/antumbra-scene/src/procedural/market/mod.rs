//! The market: a foggy square at night with all kinds of shadows in one frame.
//!
//! What stays is lit by a moon, street lamps and lanterns in arcades, all of which can be baked; the moon comes in
//! through an old aqueduct on the west side and makes shafts. What moves are people, carts, and paper lanterns, each a
//! node with a light of the same name. A large screen on the north side is a light with a surface.
//!
//! The plan is the same for every seed and size; coats, wares, leaves and faces are left to chance. Scale is how finely
//! the square is paved, roofs are tiled, trees are in leaf and round things are made.

mod aqueduct;
mod garlands;
mod houses;
mod lamps;
mod lanterns;
mod looks;
mod people;
mod screen;
mod square;
mod stalls;
mod trees;
mod wares;

use glam::{DAffine3, DMat3, DVec2, DVec3};

use super::Options;
use super::rng::Rng;
use super::shapes::Detail;
use super::solids::{Builder, Turn};
use super::view::{camera, moon};
use crate::model::{Camera, Light, Node, Scene};

/// Half the square: its paving ends here and the fronts of its houses begin.
const SQUARE: DVec2 = DVec2::new(18.0, 15.0);

/// Builds the market.
pub(crate) fn build(options: &Options) -> Scene {
    let scene = Scene {
        name: "market".to_owned(),
        materials: looks::materials(),
        // As bright as moons are in films: its shafts have to be seen beside lamps.
        lights: vec![Light { intensity: 7.0, ..moon(255.0, 28.0) }],
        cameras: cameras(),
        ..Scene::default()
    };
    let mut market = Market { rng: Rng::new(options.seed), detail: Detail { scale: options.scale }, scene };
    square::build(&mut market);
    aqueduct::build(&mut market);
    houses::build(&mut market);
    trees::build(&mut market);
    stalls::build(&mut market);
    garlands::build(&mut market);
    lamps::build(&mut market);
    screen::build(&mut market, options.seed);
    people::build(&mut market);
    lanterns::build(&mut market);
    market.scene
}

fn cameras() -> Vec<Camera> {
    vec![
        camera("overview", DVec3::new(15.4, 5.3, 13.2), DVec3::new(-3.2, 1.5, -5.0), 50.0),
        camera("stall", DVec3::new(-4.6, 1.65, 5.4), DVec3::new(-11.0, 2.1, -2.6), 58.0),
        camera("above", DVec3::new(9.0, 19.0, 17.0), DVec3::new(-1.5, 0.0, -1.5), 52.0),
    ]
}

struct Market {
    rng: Rng,
    detail: Detail,
    scene: Scene,
}

impl Market {
    /// Builds a mesh about its own origin; gives its place among the scene's.
    fn mesh(&mut self, name: &str, build: impl FnOnce(&mut Builder, &mut Rng, Detail)) -> usize {
        let number = self.scene.meshes.len();
        let mut b = Builder::new();
        build(&mut b, &mut self.rng.fork(number as u64), self.detail);
        self.scene.meshes.push(b.finish(name));
        number
    }

    /// Builds a mesh about its own origin and places it, still, under a name of its own.
    fn add(&mut self, kind: &str, at: DVec3, turn: Turn, build: impl FnOnce(&mut Builder, &mut Rng, Detail)) {
        let mesh = self.mesh(kind, build);
        self.place(kind, mesh, at, turn);
    }

    /// Places a mesh, still, under a name of its own.
    fn place(&mut self, kind: &str, mesh: usize, at: DVec3, turn: Turn) {
        let name = format!("{kind}-{}", self.scene.nodes.len());
        self.place_as(name, mesh, at, turn, false);
    }

    /// Places a mesh upright; `dynamic` says whether it moves.
    fn place_as(&mut self, name: String, mesh: usize, at: DVec3, turn: Turn, dynamic: bool) {
        let matrix3 = DMat3::from_cols(turn.apply(DVec3::X), turn.apply(DVec3::Y), turn.apply(DVec3::Z));
        let world_from_mesh = DAffine3 { matrix3, translation: at };
        self.scene.nodes.push(Node { name, mesh, world_from_mesh, dynamic });
    }
}
