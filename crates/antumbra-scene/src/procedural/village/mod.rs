//! The village: closed houses along winding lanes, at night. A dim moon, street lamps, and light from windows.
//!
//! The church and the green in the middle are there for every seed and size; lanes grow from them, and houses stand
//! where the lanes leave room. Lights stand just outside what seems to give them off, so that neither a lantern nor a
//! pane shuts its own light in.

mod church;
mod green;
pub(super) mod houses;
pub(super) mod lamps;
mod land;
mod plots;

use glam::{DAffine3, DMat3, DVec2, DVec3};

use self::land::Land;
use self::plots::Plot;
use super::Options;
use super::foliage::{Habit, tree};
use super::palette::{self, Paint, material};
use super::rng::Rng;
use super::solids::{Builder, Turn};
use super::view::{camera, moon};
use crate::model::{Camera, Light, Material, Mesh, Node, Scene};

/// Materials of the village, after those of the palette.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Glow {
    /// A lit window.
    Pane,
    /// A window with a curtain drawn before the light.
    Curtain,
    /// The glass of a street lamp.
    Lantern,
}

impl From<Glow> for usize {
    fn from(glow: Glow) -> Self {
        palette::materials().len() + glow as Self
    }
}

/// What gives off light, in candela per square metre.
pub(super) fn materials() -> Vec<Material> {
    let mut all = palette::materials();
    for (name, rgb, emissive) in [
        ("lit window", 0xf2d9a0, [4.8, 2.5, 0.9]),
        ("lit curtain", 0xd9a06a, [2.6, 1.05, 0.34]),
        ("lantern", 0xfff0d0, [20.0, 12.5, 6.0]),
    ] {
        all.push(Material { emissive, ..material(name, rgb, 0.0, 0.4) });
    }
    all
}

/// Builds the village.
pub(crate) fn build(options: &Options) -> Scene {
    let rng = Rng::new(options.seed);
    let land = Land::new(options.seed, options.scale);
    let mut village = Village { rng, land, scene: Scene { name: "village".to_owned(), ..Scene::default() } };
    village.scene.materials = materials();
    village.scene.lights = vec![moon(238.0, 40.0)];
    village.scene.cameras = cameras(&village.land);
    village.grounds();
    village.lamps();
    village.houses();
    village.trees();
    village.scene
}

fn cameras(land: &Land) -> Vec<Camera> {
    let over = |x: f64, z: f64, above: f64| DVec3::new(x, land.height(DVec2::new(x, z)) + above, z);
    let reach = land.reach.max(45.0);
    let start = DVec2::new(-0.62 * reach, land.lane_z(0, -0.62 * reach));
    let from = DVec3::new(start.x, land.height(start) + 1.8, start.y);
    vec![
        camera("overview", over(-0.86 * reach, 0.98 * reach, 0.42 * reach), over(2.0, -2.0, 3.0), 40.0),
        camera("street", from, over(-2.0, land.lane_z(0, -2.0) - 3.5, 5.4), 56.0),
        camera("green", over(8.4, 13.2, 1.9), over(-5.5, -12.0, 6.4), 62.0),
    ]
}

struct Village {
    rng: Rng,
    land: Land,
    scene: Scene,
}

impl Village {
    fn place(&mut self, name: String, mesh: Mesh, at: DVec3, turn: Turn) {
        self.scene.meshes.push(mesh);
        self.place_again(name, self.scene.meshes.len() - 1, at, turn, 1.0);
    }

    fn place_again(&mut self, name: String, mesh: usize, at: DVec3, turn: Turn, size: f64) {
        let matrix3 = DMat3::from_cols(turn.apply(DVec3::X), turn.apply(DVec3::Y), turn.apply(DVec3::Z)) * size;
        let world_from_mesh = DAffine3 { matrix3, translation: at };
        self.scene.nodes.push(Node { name, mesh, world_from_mesh, dynamic: false });
    }

    /// Builds a mesh around its own origin and places it.
    fn add<T>(&mut self, kind: &str, at: DVec3, turn: Turn, build: impl FnOnce(&mut Builder, &mut Rng) -> T) -> T {
        let number = self.scene.nodes.len();
        let mut b = Builder::new();
        let made = build(&mut b, &mut self.rng.fork(5000 + number as u64));
        let name = format!("{kind}-{number}");
        let mesh = b.finish(&name);
        self.place(name, mesh, at, turn);
        made
    }

    fn grounds(&mut self) {
        let mesh = self.land.ground("ground");
        self.place("ground".to_owned(), mesh, DVec3::ZERO, Turn::NONE);
        let land = self.land.clone();
        self.add("lanes", DVec3::ZERO, Turn::NONE, |b, _| land.lanes(b));
        self.add("green", DVec3::ZERO, Turn::NONE, |b, rng| green::build(b, rng, &land));
        let at = self.land.on(church::AT);
        self.add("church", at, Turn::radians(church::ANGLE), |b, _| church::build(b));
    }

    fn houses(&mut self) {
        let mut windows = Vec::new();
        for plot in plots::all(&self.land, &self.rng) {
            windows.extend(self.house(&plot));
        }
        for (i, window) in windows.iter().enumerate() {
            self.scene.lights.push(window.light(format!("window{:02}", i + 1)));
        }
    }

    /// A house with its garden; returns the windows that throw light on the street.
    fn house(&mut self, plot: &Plot) -> Vec<lamps::Window> {
        let (at, land) = (self.land.on(plot.at), self.land.clone());
        let windows = self.add("house", at, plot.turn, |b, rng| houses::build(b, rng, plot.kind));
        self.add("garden", at, plot.turn, |b, rng| plots::garden(b, rng, plot, &land));
        windows.into_iter().map(|window| window.placed(at, plot.turn)).collect()
    }

    fn lamps(&mut self) {
        let lamps = lamps::along(&self.land);
        let land = self.land.clone();
        self.add("lamps", DVec3::ZERO, Turn::NONE, |b, _| {
            lamps.iter().for_each(|lamp| lamps::post(b, lamp, land.on(lamp.at)));
        });
        let lights: Vec<Light> = lamps
            .iter()
            .enumerate()
            .map(|(i, lamp)| lamp.light(format!("lamp{:02}", i + 1), self.land.on(lamp.at)))
            .collect();
        self.scene.lights.extend(lights);
    }

    /// Trees share a few meshes.
    fn trees(&mut self) {
        const HABITS: [Habit; 6] =
            [Habit::Spreading, Habit::Round, Habit::Spreading, Habit::Conifer, Habit::Round, Habit::Poplar];
        let mut rng = self.rng.fork(4000);
        let first = self.scene.meshes.len();
        for (i, habit) in HABITS.into_iter().enumerate() {
            let mut b = Builder::new();
            tree(&mut b, &mut rng, habit, DVec3::ZERO, (8.5, 12.0));
            self.scene.meshes.push(b.finish(&format!("tree-kind-{i}")));
        }
        let taken = plots::all(&self.land, &self.rng);
        for (i, spot) in self.land.tree_spots(&taken, &self.rng).into_iter().enumerate() {
            let at = self.land.on(spot.at) - DVec3::Y * 0.15;
            let mesh = first + spot.kind % HABITS.len();
            self.place_again(format!("tree-{i}"), mesh, at, Turn::radians(spot.angle), spot.size);
        }
    }
}

/// The paints of walls, roofs and wood, house by house.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coat {
    pub wall: Paint,
    pub roof: Paint,
    pub wood: Paint,
}
