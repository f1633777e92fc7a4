//! The screen: a large television at the end of a foggy street, at night, with people and things before it.
//!
//! What it shows is a video of its own: see `video.rs`. Everything else is dark, so that all light comes from it.

pub(super) mod video;

use glam::{DAffine3, DMat3, DVec2, DVec3};

use super::Options;
use super::foliage::{Habit, tree};
use super::palette::{self, Paint};
use super::props::person;
use super::rng::Rng;
use super::solids::{Builder, Turn};
use super::view::{camera, moon};
use crate::model::{AreaLight, AreaShape, Node, Scene};

/// Half the width of the street, and of the road in it.
const STREET: f64 = 9.0;
const ROAD: f64 = 5.0;
/// The screen: its size, how high its middle is, and where it stands.
const SIZE: DVec2 = DVec2::new(8.0, 4.5);
const MIDDLE: DVec3 = DVec3::new(0.0, 4.6, -30.0);
/// Length of the street at scale 1, metres.
const LENGTH: f64 = 64.0;

/// Builds the street.
pub(crate) fn build(options: &Options) -> Scene {
    let mut street = Street { rng: Rng::new(options.seed), scene: Scene::default(), scale: options.scale };
    street.scene.name = "screen".to_owned();
    street.scene.materials = palette::materials();
    street.scene.lights = vec![moon(150.0, 35.0)];
    street.scene.images = video::frames(options.seed);
    street.scene.area_lights = vec![AreaLight {
        name: "screen".to_owned(),
        shape: AreaShape::Rectangle { width_m: SIZE.x, height_m: SIZE.y },
        position_world: MIDDLE,
        direction_world: DVec3::Z,
        up_world: DVec3::Y,
        luminance: [1500.0; 3],
        frames: (0..street.scene.images.len()).collect(),
        frames_per_second: video::FPS,
    }];
    street.scene.cameras = vec![
        camera("overview", DVec3::new(2.6, 1.7, 5.0), DVec3::new(-0.6, 3.0, -22.0), 52.0),
        camera("side", DVec3::new(-8.2, 3.4, -9.0), DVec3::new(3.0, 1.6, -19.0), 60.0),
        camera("above", DVec3::new(7.5, 9.5, 4.0), DVec3::new(-1.0, 1.5, -22.0), 50.0),
    ];
    street.ground();
    street.stage();
    street.houses();
    street.things();
    street.people();
    street.scene
}

struct Street {
    rng: Rng,
    scene: Scene,
    scale: f64,
}

impl Street {
    /// Builds a mesh about its own origin and places it.
    fn add(&mut self, kind: &str, at: DVec3, turn: Turn, dynamic: bool, build: impl FnOnce(&mut Builder, &mut Rng)) {
        let number = self.scene.nodes.len();
        let mut b = Builder::new();
        build(&mut b, &mut self.rng.fork(number as u64));
        let name = format!("{kind}-{number}");
        self.scene.meshes.push(b.finish(&name));
        let matrix3 = DMat3::from_cols(turn.apply(DVec3::X), turn.apply(DVec3::Y), turn.apply(DVec3::Z));
        let (mesh, world_from_mesh) = (self.scene.meshes.len() - 1, DAffine3 { matrix3, translation: at });
        self.scene.nodes.push(Node { name, mesh, world_from_mesh, dynamic });
    }

    fn ground(&mut self) {
        let far = LENGTH * self.scale.max(0.6) * 0.5;
        self.add("ground", DVec3::ZERO, Turn::NONE, false, |b, _| {
            b.cuboid(Paint::Asphalt, DVec3::new(-ROAD, -0.4, -36.0), DVec3::new(ROAD, 0.0, far));
            for side in [-1.0, 1.0] {
                let (a, z) = (side * ROAD, side * (STREET + 3.0));
                b.cuboid(Paint::Paving, DVec3::new(a.min(z), -0.4, -36.0), DVec3::new(a.max(z), 0.14, far));
            }
            for i in 0..10 {
                let z = -24.0 + 4.0 * f64::from(i);
                b.pillar(Paint::Marking, DVec2::new(0.0, z), DVec2::new(0.14, 1.8), -0.1, 0.004);
            }
        });
    }

    /// The screen's back and the scaffold that carries it.
    fn stage(&mut self) {
        self.add("stage", DVec3::ZERO, Turn::NONE, false, |b, _| {
            let (half, z) = (SIZE * 0.5, MIDDLE.z);
            let (low, high) = (MIDDLE.y - half.y - 0.15, MIDDLE.y + half.y + 0.15);
            let corner = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
            b.cuboid(Paint::GlassDark, corner(-half.x - 0.15, low, z - 0.35), corner(half.x + 0.15, high, z - 0.05));
            for x in [-half.x - 0.1, half.x + 0.1] {
                for dz in [-0.6, -2.2] {
                    b.strut(Paint::Steel, corner(x, -0.2, z + dz), corner(x, high + 0.4, z + dz), 0.06, 6);
                }
                for i in 0..4 {
                    let y = 0.4 + 1.7 * f64::from(i);
                    b.strut(Paint::Steel, corner(x, y, z - 0.6), corner(x, y + 1.5, z - 2.2), 0.035, 5);
                }
            }
            // A barrier of bars before it: its shadows are shafts.
            for i in 0..41 {
                let x = -6.0 + 0.3 * f64::from(i);
                b.strut(Paint::Steel, corner(x, 0.0, z + 4.0), corner(x, 1.15, z + 4.0), 0.016, 5);
            }
            for y in [0.25, 1.15] {
                b.strut(Paint::Steel, corner(-6.05, y, z + 4.0), corner(6.05, y, z + 4.0), 0.025, 6);
            }
        });
    }

    fn houses(&mut self) {
        let coats = [Paint::BrickRed, Paint::BrickBrown, Paint::StuccoCream, Paint::Sandstone, Paint::StuccoRose];
        let far = LENGTH * self.scale * 0.5;
        for side in [0_usize, 2] {
            let mut z = -34.0;
            while z < far {
                let mut rng = self.rng.fork(900 + self.scene.nodes.len() as u64);
                let (width, depth, floors) = (rng.range(6.0, 9.5), rng.range(7.0, 10.0), 3 + rng.index(3));
                let coat = rng.pick(&coats);
                let x = if side == 0 { STREET } else { -STREET };
                let at = DVec3::new(x, 0.0, z + width * 0.5);
                // The front looks along -X, turned to the street.
                self.add("house", at, Turn::quarters(side), false, |b, rng| {
                    house(b, rng, [width, depth], floors, coat);
                });
                z += width + if rng.chance(0.2) { 2.4 } else { 0.0 };
            }
        }
    }

    fn things(&mut self) {
        let scale = self.scale.min(2.0);
        let count = |share: f64| (share * scale).ceil() as u32;
        for i in 0..count(5.0) {
            let side = if i % 2 == 0 { 1.0 } else { -1.0 };
            let at = DVec3::new(side * (ROAD + 0.9), 0.14, -21.0 + 8.5 * f64::from(i));
            self.add("lamp post", at, Turn::NONE, false, |b, _| {
                b.cone(Paint::Bronze, DVec2::ZERO, 9, [(0.11, -0.1), (0.06, 4.4)]);
                b.strut(Paint::Bronze, DVec3::Y * 4.3, DVec3::new(-side * 1.1, 4.75, 0.0), 0.04, 6);
                b.pillar(Paint::GlassGrey, DVec2::new(-side * 1.15, 0.0), DVec2::new(0.5, 0.22), 4.66, 4.8);
            });
            let foot = DVec3::new(-side * (ROAD + 1.6), 0.14, -18.5 + 8.5 * f64::from(i));
            self.add("tree", foot, Turn::NONE, false, |b, rng| tree(b, rng, Habit::Round, DVec3::ZERO, (5.0, 7.0)));
        }
        for i in 0..count(6.0) {
            let side = if i % 2 == 0 { 1.0 } else { -1.0 };
            let at = DVec3::new(side * (ROAD - 1.1), 0.0, -20.0 + 6.0 * f64::from(i) + side);
            self.add("car", at, Turn::quarters(1), false, car);
        }
        // Bicycle racks.
        self.add("racks", DVec3::new(-ROAD - 0.8, 0.14, -13.0), Turn::NONE, false, |b, _| {
            for i in 0..8 {
                let z = 0.8 * f64::from(i);
                b.strut(Paint::Steel, DVec3::new(0.0, -0.1, z), DVec3::new(0.0, 0.85, z), 0.025, 6);
                b.strut(Paint::Steel, DVec3::new(0.7, -0.1, z), DVec3::new(0.7, 0.85, z), 0.025, 6);
                b.strut(Paint::Steel, DVec3::new(-0.02, 0.85, z), DVec3::new(0.72, 0.85, z), 0.025, 6);
            }
        });
    }

    /// Onlookers, and some who walk by: those are dynamic.
    fn people(&mut self) {
        let count = (26.0 * self.scale.min(3.0)).ceil() as u32;
        for i in 0..count {
            let mut rng = self.rng.fork(7000 + u64::from(i));
            let walks = i % 6 == 5;
            let at = DVec3::new(rng.range(-4.3, 4.3), 0.0, rng.range(-24.0, -9.0));
            let turn = Turn::radians(rng.range(-0.4, 0.4) + if walks { core::f64::consts::FRAC_PI_2 } else { 0.0 });
            self.add(if walks { "walker" } else { "onlooker" }, at, turn, walks, person);
        }
    }
}

/// A house whose front is the plane x = 0, looking along -X.
fn house(b: &mut Builder, rng: &mut Rng, [width, depth]: [f64; 2], floors: usize, coat: Paint) {
    let height = 3.1 * floors as f64 + 0.6;
    let half = width * 0.5;
    b.cuboid(coat, DVec3::new(0.0, -0.3, -half), DVec3::new(depth, height, half));
    b.cuboid(Paint::Limestone, DVec3::new(-0.12, height - 0.35, -half), DVec3::new(0.2, height - 0.05, half));
    b.gable(Paint::Slate, DVec2::new(depth * 0.5, 0.0), DVec2::new(depth + 0.4, width), height, width * 0.28);
    let windows = (width / 2.3) as usize;
    for floor in 0..floors {
        let y = 0.9 + 3.1 * floor as f64;
        for i in 0..windows {
            let z = -half + width * (i as f64 + 0.5) / windows as f64;
            if floor == 0 && i == windows / 2 {
                b.cuboid(Paint::Timber, DVec3::new(-0.05, 0.1, z - 0.55), DVec3::new(0.05, 2.3, z + 0.55));
                b.cuboid(Paint::Granite, DVec3::new(-0.5, -0.1, z - 0.8), DVec3::new(0.1, 0.26, z + 0.8));
                continue;
            }
            b.cuboid(Paint::GlassDark, DVec3::new(-0.02, y, z - 0.5), DVec3::new(0.06, y + 1.6, z + 0.5));
            b.cuboid(Paint::Limestone, DVec3::new(-0.16, y - 0.14, z - 0.64), DVec3::new(0.05, y - 0.02, z + 0.64));
            b.cuboid(Paint::White, DVec3::new(-0.05, y, z - 0.03), DVec3::new(0.02, y + 1.6, z + 0.03));
            if rng.chance(0.25) && floor > 0 {
                balcony(b, DVec3::new(0.0, y - 0.2, z));
            }
        }
    }
}

fn balcony(b: &mut Builder, at: DVec3) {
    b.cuboid(Paint::Concrete, at + DVec3::new(-0.9, -0.12, -0.9), at + DVec3::new(0.1, 0.0, 0.9));
    for i in 0..11 {
        let z = -0.86 + 0.172 * f64::from(i);
        b.strut(Paint::Bronze, at + DVec3::new(-0.86, -0.05, z), at + DVec3::new(-0.86, 0.95, z), 0.014, 4);
    }
    b.strut(Paint::Bronze, at + DVec3::new(-0.86, 0.95, -0.9), at + DVec3::new(-0.86, 0.95, 0.9), 0.025, 5);
}

fn car(b: &mut Builder, rng: &mut Rng) {
    let paint = rng.pick(&[Paint::CarRed, Paint::CarBlue, Paint::CarWhite, Paint::CarYellow]);
    b.cuboid(paint, DVec3::new(-2.1, 0.32, -0.85), DVec3::new(2.1, 0.86, 0.85));
    b.within(DVec3::new(-0.2, 0.0, 0.0), Turn::NONE, |b| {
        b.taper(Paint::GlassDark, DVec2::ZERO, [(DVec2::new(2.6, 1.6), 0.85), (DVec2::new(1.7, 1.3), 1.42)]);
        b.taper(paint, DVec2::ZERO, [(DVec2::new(1.75, 1.35), 1.4), (DVec2::new(1.6, 1.25), 1.47)]);
    });
    for (x, z) in [(-1.3, -0.8), (1.3, -0.8), (-1.3, 0.8), (1.3, 0.8)] {
        b.strut(Paint::Asphalt, DVec3::new(x, 0.33, z - 0.11), DVec3::new(x, 0.33, z + 0.11), 0.33, 14);
    }
}
