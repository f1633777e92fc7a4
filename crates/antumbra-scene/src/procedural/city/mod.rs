//! The city: a downtown by a river, about a million triangles, every solid closed.
//!
//! The grand plan (the river, the park, the square, the capitol, where the towers stand) is the same for every seed, so
//! that the cameras always have something to look at; all else is left to chance. Each building is a node with a mesh
//! of its own around its own origin; trees of the park share a few meshes.

mod civic;
mod facade;
mod greens;
mod houses;
mod lamps;
mod layout;
mod roofs;
mod streets;
mod towers;
mod works;

use glam::{DAffine3, DMat3, DVec2, DVec3, Vec2Swizzles};

use self::layout::{Block, Lot, Plan, Use};
use self::streets::Stretch;
use super::Options;
use super::foliage::{Habit, tree};
use super::palette::{self, Paint};
use super::rng::Rng;
use super::solids::{Builder, Turn};
use super::view::{camera, sun};
use crate::model::{Camera, Mesh, Node, Scene};

/// Width of the pavement around the buildings of a block.
const PAVEMENT_M: f64 = 4.2;

/// Builds the city.
pub(crate) fn build(options: &Options) -> Scene {
    let rng = Rng::new(options.seed);
    let plan = Plan::new(&rng, options.scale);
    let mut city = City { rng, scene: Scene { name: "city".to_owned(), ..Scene::default() } };
    city.ground(&plan);
    let center = city.tallest(&plan);
    for block in &plan.blocks {
        city.block(block, block.tag == center);
    }
    city.scene.materials = palette::materials();
    city.scene.lights = vec![sun(110.0, 33.0)];
    if options.lamps > 0 {
        city.lamps(&plan, options.lamps as usize);
    }
    city.scene.cameras = cameras(&plan);
    city.scene
}

/// Cameras stand where nothing is built: high up, over the river, over a street.
fn cameras(plan: &Plan) -> Vec<Camera> {
    // A city of a few blocks is as tall as a big one: stay back as far as for half a kilometre.
    let reach = plan.half.max(DVec2::splat(260.0));
    let at = |x: f64, y: f64, z: f64| DVec3::new(x * reach.x, y * reach.x, z * reach.y);
    let west = plan.meridians.iter().find(|s| s.is_avenue()).map_or(plan.main_x, |s| s.middle);
    let water = plan.river.map_or(1.25, |_| 0.57);
    let mid_avenue = DVec3::new(plan.main_x, 2.2, plan.half.y * 0.36);
    vec![
        camera("overview", at(-0.56, 0.40, 1.18), at(0.05, 0.045, 0.0), 34.0),
        camera("skyline", at(-0.42, 0.025, water), at(0.16, 0.10, 0.0), 46.0),
        camera("street", mid_avenue, DVec3::new(plan.main_x, 14.0, -plan.half.y), 58.0),
        camera("rooftops", DVec3::new(west, 46.0, plan.half.y * 0.1), at(0.15, 0.06, -0.1), 48.0),
    ]
}

struct City {
    rng: Rng,
    scene: Scene,
}

impl City {
    fn mesh(&mut self, mesh: Mesh) -> usize {
        self.scene.meshes.push(mesh);
        self.scene.meshes.len() - 1
    }

    fn place(&mut self, name: String, mesh: usize, at: DVec2, turn: Turn, size: f64) {
        let matrix3 = DMat3::from_cols(turn.apply(DVec3::X), turn.apply(DVec3::Y), turn.apply(DVec3::Z)) * size;
        let world_from_mesh = DAffine3 { matrix3, translation: DVec3::new(at.x, 0.0, at.y) };
        self.scene.nodes.push(Node { name, mesh, world_from_mesh, dynamic: false });
    }

    /// Builds a mesh around its own origin and places it.
    fn add(&mut self, kind: &str, at: DVec2, turn: Turn, build: impl FnOnce(&mut Builder, &mut Rng)) {
        let number = self.scene.nodes.len();
        let mut b = Builder::new();
        build(&mut b, &mut self.rng.fork(5000 + number as u64));
        let name = format!("{kind}-{number}");
        let mesh = self.mesh(b.finish(&name));
        self.place(name, mesh, at, turn, 1.0);
    }

    fn ground(&mut self, plan: &Plan) {
        self.add("ground", DVec2::ZERO, Turn::NONE, |b, _| streets::ground(b, plan));
        for (streets, others, along_z) in
            [(&plan.meridians, &plan.parallels, true), (&plan.parallels, &plan.meridians, false)]
        {
            for street in streets {
                let stretches = streets::stretches(plan, street, others, along_z);
                self.traffic(&stretches);
            }
        }
        let Some(river) = plan.river else { return };
        self.cranes(plan, &river);
        self.add("promenade", DVec2::ZERO, Turn::NONE, |b, rng| streets::promenade(b, rng, plan, &river));
        for street in plan.meridians.iter().filter(|s| s.is_avenue()) {
            let span = (river.north_bank(street.middle) - 4.0, river.south_bank(street.middle) + 4.0);
            if street.middle == plan.main_x {
                self.add("bridge", DVec2::ZERO, Turn::NONE, |b, _| streets::cable_bridge(b, street.middle, span));
            } else {
                self.add("bridge", DVec2::ZERO, Turn::NONE, |b, _| {
                    streets::arch_bridge(b, street.middle, span, street.width - 2.0);
                });
            }
        }
    }

    /// Cranes along the south quay by the works, on the paved strip, at any angle over the water.
    fn cranes(&mut self, plan: &Plan, river: &layout::River) {
        let mut rng = self.rng.fork(4100);
        let steps = (plan.half.x / 95.0) as usize;
        for i in 0..steps {
            let x = plan.half.x * (0.34 + 0.6 * i as f64 / steps as f64);
            if plan.meridians.iter().any(|s| (x - s.middle).abs() < s.width * 0.5 + 8.0) {
                continue;
            }
            let at = DVec2::new(x, river.south_bank(x) + 6.5);
            let turn = Turn::radians(core::f64::consts::PI + rng.range(-0.9, 0.9));
            let paint = rng.pick(&[Paint::CarYellow, Paint::CarBlue, Paint::CarRed]);
            self.add("crane", at, turn, |b, _| works::crane(b, paint));
        }
    }

    fn traffic(&mut self, stretches: &[Stretch]) {
        if stretches.is_empty() {
            return;
        }
        self.add("street", DVec2::ZERO, Turn::NONE, |b, rng| {
            for stretch in stretches {
                streets::traffic(b, rng, stretch);
            }
        });
    }

    /// Lamps along the streets, with their posts.
    fn lamps(&mut self, plan: &Plan, count: usize) {
        let lamps = lamps::place(plan, &self.rng.fork(6000), count);
        self.add("lamps", DVec2::ZERO, Turn::NONE, |b, _| lamps.iter().for_each(|lamp| lamps::post(b, lamp)));
        self.scene.lights.extend(lamps.iter().enumerate().map(|(i, lamp)| lamp.light(format!("spot{:03}", i + 1))));
    }

    /// The block that gets the tallest tower: the one nearest the middle of downtown.
    fn tallest(&self, plan: &Plan) -> u64 {
        let towers = plan.blocks.iter().filter(|b| b.purpose == Use::Downtown);
        towers.max_by(|a, b| a.height.total_cmp(&b.height)).map_or(u64::MAX, |b| b.tag)
    }

    fn block(&mut self, block: &Block, tallest: bool) {
        let (at, size) = (block.center(), block.size());
        match block.purpose {
            Use::Park => return self.park(block),
            Use::Square => return self.add("square", at, Turn::NONE, |b, rng| greens::square(b, rng, size)),
            _ => {}
        }
        let (paint, trees) = match block.purpose {
            Use::Estate => (Paint::Grass, 0.9),
            Use::Works => (Paint::Concrete, 0.08),
            Use::Capitol | Use::Cathedral => (Paint::Plaza, 0.9),
            _ => (Paint::Paving, 0.34),
        };
        self.add("block", at, Turn::NONE, |b, rng| {
            greens::pavement(b, paint, size);
            greens::kerb(b, rng, size, trees);
        });
        let inner = size - DVec2::splat(2.0 * PAVEMENT_M);
        match block.purpose {
            Use::Capitol => self.add("capitol", at, Turn::NONE, |b, _| civic::capitol(b, inner)),
            Use::Stadium => self.add("stadium", at, Turn::NONE, |b, _| civic::stadium(b, inner)),
            Use::Cathedral => self.add("cathedral", at, Turn::radians(0.35), |b, _| civic::cathedral(b, inner * 0.86)),
            Use::OldTown if inner.min_element() > 40.0 => self.terraces(block, inner),
            Use::Estate => self.estate(block, inner),
            _ if tallest => {
                self.add("spire", at, Turn::NONE, |b, rng| {
                    towers::spire(b, inner.min(DVec2::splat(68.0)), 238.0);
                    greens::kerb(b, rng, inner, 0.9);
                });
            }
            _ => self.lots(block, inner),
        }
    }

    fn park(&mut self, block: &Block) {
        let (at, size) = (block.center(), block.size());
        let mut spots = Vec::new();
        self.add("park", at, Turn::NONE, |b, rng| spots = greens::park(b, rng, size));
        let kinds = self.tree_kinds();
        for (i, spot) in spots.iter().enumerate() {
            let mesh = kinds[spot.kind % kinds.len()];
            self.place(format!("tree-{i}"), mesh, at + spot.at, Turn::radians(spot.angle), spot.size);
        }
    }

    fn tree_kinds(&mut self) -> Vec<usize> {
        const HABITS: [Habit; 10] = [
            Habit::Spreading,
            Habit::Spreading,
            Habit::Round,
            Habit::Spreading,
            Habit::Conifer,
            Habit::Round,
            Habit::Spreading,
            Habit::Poplar,
            Habit::Round,
            Habit::Spreading,
        ];
        let mut rng = self.rng.fork(4000);
        let mut kinds = Vec::new();
        for (i, habit) in HABITS.into_iter().enumerate() {
            let mut b = Builder::new();
            tree(&mut b, &mut rng, habit, DVec3::Y * 0.2, (10.0, 14.0));
            kinds.push(self.mesh(b.finish(&format!("tree-kind-{i}"))));
        }
        kinds
    }

    /// Cuts a block into lots and builds on each.
    fn lots(&mut self, block: &Block, inner: DVec2) {
        let mut rng = self.rng.fork(3000 + block.tag);
        let turned = block.purpose == Use::Midtown && rng.chance(0.16);
        let turn = if turned { Turn::radians(rng.range(0.25, 0.6)) } else { Turn::NONE };
        let inner = if turned { inner * 0.74 } else { inner };
        let longest = match block.purpose {
            Use::Downtown if rng.chance(0.35) => 110.0,
            Use::Downtown => 48.0,
            Use::Works => 56.0,
            _ => rng.range(30.0, 40.0),
        };
        let mut lots = Vec::new();
        Lot { min: -inner * 0.5, max: inner * 0.5, street: [true; 4] }.split(&mut rng, longest, &mut lots);
        for lot in lots {
            self.lot(block, &lot, turn, &mut rng);
        }
    }

    fn lot(&mut self, block: &Block, lot: &Lot, turn: Turn, rng: &mut Rng) {
        let quarters = lot.quarters();
        let extent = lot.max - lot.min;
        let gap = DVec2::splat(rng.range(1.2, 3.2));
        let size = if quarters.is_multiple_of(2) { extent } else { extent.yx() } - gap;
        let middle = (lot.min + lot.max) * 0.5;
        let offset = turn.apply(DVec3::new(middle.x, 0.0, middle.y));
        let at = block.center() + DVec2::new(offset.x, offset.z);
        let facing = turn.then(Turn::quarters(quarters));
        let height = block.height * rng.range(0.55, 1.25);
        let towers = size.min_element() > 16.0;
        match block.purpose {
            Use::Works => self.add("works", at, facing, |b, rng| works::works(b, rng, size)),
            Use::Downtown if size.max_element() > 52.0 => self.landmark(at, facing, size, height),
            Use::Downtown if towers => self.add("tower", at, facing, |b, rng| towers::tower(b, rng, size, height)),
            _ => self.add("house", at, facing, |b, rng| towers::masonry(b, rng, size, height)),
        }
    }

    /// A whole block for one group of towers.
    fn landmark(&mut self, at: DVec2, facing: Turn, size: DVec2, height: f64) {
        let height = (height * 1.25).clamp(60.0, 205.0);
        let plan = size.min(DVec2::splat((height * 0.4).min(58.0)));
        self.add("tower", at, facing, |b, rng| match rng.index(4) {
            0 if height > 110.0 => towers::gherkin(b, plan, height),
            1 => towers::twisted(b, rng, plan, height),
            2 => towers::twins(b, rng, size, height),
            _ => towers::deco(b, rng, plan, height),
        });
        if (size - plan).min_element() > 14.0 {
            self.add("plaza", at, facing, |b, rng| greens::kerb(b, rng, size - DVec2::splat(2.0), 0.85));
        }
    }

    /// Houses all round a block, with trees in the courtyard.
    fn terraces(&mut self, block: &Block, inner: DVec2) {
        const DEPTH_M: f64 = 12.5;
        let mut rng = self.rng.fork(3000 + block.tag);
        for side in 0..4 {
            let turn = Turn::quarters(side);
            let (long, deep) = if side % 2 == 0 { (inner.x, inner.y) } else { (inner.y - 2.0 * DEPTH_M, inner.x) };
            self.terrace(block, turn, long, deep * 0.5 - DEPTH_M * 0.5, side % 2 == 0, &mut rng);
        }
        let court = inner - DVec2::splat(2.0 * DEPTH_M + 3.0);
        self.add("court", block.center(), Turn::NONE, |b, rng| {
            b.pillar(Paint::Grass, DVec2::ZERO, court, -0.3, 0.3);
            greens::grove(b, rng, DVec2::ZERO, court - DVec2::splat(4.0), (court.x * court.y / 190.0) as usize);
        });
    }

    fn terrace(&mut self, block: &Block, turn: Turn, long: f64, out: f64, ends: bool, rng: &mut Rng) {
        if long < 6.0 {
            return;
        }
        let count = (long / 19.5).round().max(1.0) as usize;
        let base = (block.height / 3.4) as usize;
        for i in 0..count {
            let x = long * ((i as f64 + 0.5) / count as f64 - 0.5);
            let storeys = base - 1 + rng.index(5) / 2;
            let size = DVec2::new(long / count as f64 + 0.08, 12.0 + rng.range(-0.3, 0.3));
            let offset = turn.apply(DVec3::new(x, 0.0, out + rng.range(-0.25, 0.25)));
            let at = block.center() + DVec2::new(offset.x, offset.z);
            let corner = [ends && i == 0, ends && i + 1 == count];
            self.add("terrace", at, turn, |b, rng| houses::terraced(b, rng, size, storeys, corner));
        }
    }

    /// Slabs on a lawn, turned out of the grid.
    fn estate(&mut self, block: &Block, inner: DVec2) {
        let mut rng = self.rng.fork(3000 + block.tag);
        let turn = Turn::radians(0.42 + rng.range(-0.12, 0.12));
        let long = (inner.min_element() * 0.86).min(58.0);
        let rows = if inner.min_element() > 60.0 { 2 } else { 1 };
        for row in 0..rows {
            let off = (f64::from(row) - f64::from(rows - 1) * 0.5) * 34.0;
            let offset = turn.apply(DVec3::new(0.0, 0.0, off));
            let at = block.center() + DVec2::new(offset.x, offset.z);
            let height = (rng.range(7.0, 14.0) as usize * 3 + 4) as f64;
            self.add("slab", at, turn, |b, rng| houses::slab(b, rng, DVec2::new(long, 12.0), height));
        }
        self.add("grove", block.center(), Turn::NONE, |b, rng| greens::grove(b, rng, DVec2::ZERO, inner, 22));
    }
}
