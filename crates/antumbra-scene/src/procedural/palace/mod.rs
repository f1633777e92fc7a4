//! The palace: a court with a gallery around it and a wine cellar below, for light that arrives by one bounce.
//!
//! Five scenes are set in it, of the kinds on which Selgrad, Müller, Reintges and Stamminger 2016 ("Fast shadow map
//! rendering for many-lights settings") measure: `door`, `grille`, `room`, `flag` and `cellar`. All build the same
//! palace, so that most of it is hidden from wherever one looks, and differ in lights, cameras, and in which doors are
//! open and whether flags hang. The geometry is our own. Except in `cellar`, lamps light little that the first camera
//! sees; what it sees is lit by that.
//!
//! The plan is the same for every seed; what lies about in it is left to chance. Scale is how finely round things, cloth
//! and vaults are made.

mod cellar;
mod court;
mod doors;
mod flags;
mod furniture;
mod looks;
mod lumber;
mod plan;
mod shows;
mod stores;

use glam::{DAffine3, DMat3, DVec3};

use self::shows::Show;
use super::Options;
use super::rng::Rng;
use super::shapes::Detail;
use super::solids::{Builder, Turn};
use crate::model::{Node, Scene};

/// Light from a chamber's open door, on the gallery.
pub(crate) fn door(options: &Options) -> Scene {
    build(Show::Door, options)
}

/// Light off a wall behind a grille, in the cellar.
pub(crate) fn grille(options: &Options) -> Scene {
    build(Show::Grille, options)
}

/// Light off a carpet, in the lumber room.
pub(crate) fn room(options: &Options) -> Scene {
    build(Show::Room, options)
}

/// Light off the gallery's wall, on flags.
pub(crate) fn flag(options: &Options) -> Scene {
    build(Show::Flag, options)
}

/// Light from a lantern in the anteroom, in the cellar.
pub(crate) fn cellar(options: &Options) -> Scene {
    build(Show::Cellar, options)
}

struct Palace {
    rng: Rng,
    detail: Detail,
    show: Show,
    scene: Scene,
}

fn build(show: Show, options: &Options) -> Scene {
    let scene = Scene {
        name: show.name().to_owned(),
        materials: looks::materials(),
        lights: show.lights(),
        cameras: show.cameras(),
        ..Scene::default()
    };
    let mut palace = Palace { rng: Rng::new(options.seed), detail: Detail { scale: options.scale }, show, scene };
    court::build(&mut palace);
    doors::build(&mut palace);
    cellar::build(&mut palace);
    let stock = stores::Stock::new(&mut palace);
    stores::build(&mut palace, stock);
    lumber::build(&mut palace, stock);
    let lantern = palace.mesh("lantern", flags::lantern);
    palace.place_moving("lantern", lantern, flags::LANTERN, Turn::NONE, show == Show::Cellar);
    if show == Show::Flag {
        flags::flags(&mut palace);
        let footlight = palace.mesh("footlight", |b, _| flags::footlight(b));
        for lamp in show.lights() {
            palace.place("footlight", footlight, lamp.position_world, Turn::NONE);
        }
    }
    palace.scene
}

impl Palace {
    /// Builds a mesh about its own origin; gives its place among the scene's.
    fn mesh(&mut self, name: &str, build: impl FnOnce(&mut Builder, Detail)) -> usize {
        let mut b = Builder::new();
        build(&mut b, self.detail);
        self.scene.meshes.push(b.finish(name));
        self.scene.meshes.len() - 1
    }

    /// Builds a mesh where it belongs.
    fn add(&mut self, name: &str, build: impl FnOnce(&mut Builder, Detail)) {
        let mesh = self.mesh(name, build);
        self.place(name, mesh, DVec3::ZERO, Turn::NONE);
    }

    fn place(&mut self, name: &str, mesh: usize, at: DVec3, turn: Turn) {
        self.place_moving(name, mesh, at, turn, false);
    }

    /// Places a mesh upright; `dynamic` says whether it moves.
    fn place_moving(&mut self, name: &str, mesh: usize, at: DVec3, turn: Turn, dynamic: bool) {
        let matrix3 = DMat3::from_cols(turn.apply(DVec3::X), turn.apply(DVec3::Y), turn.apply(DVec3::Z));
        self.place_as(name, mesh, DAffine3 { matrix3, translation: at });
        if let Some(node) = self.scene.nodes.last_mut() {
            node.dynamic = dynamic;
        }
    }

    /// Places a mesh in any pose.
    fn place_as(&mut self, name: &str, mesh: usize, world_from_mesh: DAffine3) {
        let name = format!("{name}-{}", self.scene.nodes.len());
        self.scene.nodes.push(Node { name, mesh, world_from_mesh, dynamic: false });
    }
}
