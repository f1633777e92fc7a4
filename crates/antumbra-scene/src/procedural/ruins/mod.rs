//! The ruins: an abbey that has lost its roofs, overgrown; nothing in it is closed.
//!
//! Church walls have two faces and broken tops but no ends and no feet; the cloister's walls, the vaults, the columns
//! and the trees' trunks are single sheets. Leaves are cards cut out by an alpha mask. The plan is the same for every
//! seed, so that the cameras always have something to look at; where walls are broken and where what grows is left
//! to chance. Scale is detail: finer patterns in stone, and more and smaller leaves.

mod church;
mod cloister;
mod columns;
mod ground;
mod looks;
mod plants;
mod stone;
mod trees;
mod vaults;

use glam::{DAffine3, DMat3, DVec3};

use super::Options;
use super::rng::Rng;
use super::sheets::Sheets;
use super::solids::Turn;
use super::view::{camera, sun};
use crate::model::{Camera, Mesh, Node, Scene};

/// What all parts of the ruins are made from.
struct Site {
    seed: u64,
    rng: Rng,
    /// Width of the cells in which stone is cut, metres.
    cell_m: f64,
    /// How many times as many plants as at scale 1.
    plenty: f64,
    /// How large plants are, where there are more or fewer of them.
    plant_size: f64,
}

impl Site {
    fn new(options: &Options) -> Self {
        Self {
            seed: options.seed,
            rng: Rng::new(options.seed),
            cell_m: (0.4 / options.scale).min(1.6),
            plenty: options.scale * options.scale,
            plant_size: options.scale.clamp(0.25, 2.25).sqrt().recip(),
        }
    }

    /// How many of something of which there are `count` at scale 1.
    fn many(&self, count: f64) -> usize {
        (count * self.plenty).ceil() as usize
    }
}

/// Builds the ruins.
pub(crate) fn build(options: &Options) -> Scene {
    let site = Site::new(options);
    let mut out = Scene { name: "ruins".to_owned(), images: looks::images(options.seed), ..Scene::default() };
    out.materials = looks::materials();
    out.lights = vec![sun(208.0, 36.0)];
    out.cameras = cameras(&site);
    let walls = church::walls(&site).into_iter().chain(cloister::walls(&site)).collect::<Vec<_>>();
    add(&mut out, "ground", |s| ground::build(s, &site));
    add(&mut out, "church", |s| walls.iter().filter(|w| w.is_thick()).for_each(|w| w.build(s, &site)));
    add(&mut out, "cloister", |s| walls.iter().filter(|w| !w.is_thick()).for_each(|w| w.build(s, &site)));
    add(&mut out, "columns", |s| columns::build(s, &site));
    add(&mut out, "vaults", |s| vaults::build(s, &site));
    add(&mut out, "rubble", |s| columns::rubble(s, &site));
    add(&mut out, "ivy", |s| plants::ivy(s, &site, &walls));
    add(&mut out, "ferns", |s| plants::ferns(s, &site));
    add(&mut out, "grass", |s| plants::grass(s, &site));
    grove(&mut out, &site);
    out
}

fn cameras(site: &Site) -> Vec<Camera> {
    let over = |x: f64, z: f64, above: f64| DVec3::new(x, ground::height(site, x, z) + above, z);
    vec![
        camera("overview", DVec3::new(-56.0, 30.0, 58.0), DVec3::new(-5.0, 2.5, 6.0), 42.0),
        camera("nave", over(-25.5, 1.6, 1.7), DVec3::new(14.0, 5.6, -1.4), 62.0),
        camera("cloister", over(-18.6, 31.4, 1.7), DVec3::new(-5.0, 4.6, 10.0), 62.0),
        camera("grove", over(-51.0, 13.0, 1.6), DVec3::new(-28.0, 6.4, -0.5), 58.0),
    ]
}

fn add(scene: &mut Scene, name: &str, build: impl FnOnce(&mut Sheets)) {
    let mut sheets = Sheets::default();
    build(&mut sheets);
    let mesh = push(scene, sheets.finish(name));
    place(scene, name.to_owned(), mesh, DAffine3::IDENTITY);
}

fn push(scene: &mut Scene, mesh: Mesh) -> usize {
    scene.meshes.push(mesh);
    scene.meshes.len() - 1
}

fn place(scene: &mut Scene, name: String, mesh: usize, world_from_mesh: DAffine3) {
    scene.nodes.push(Node { name, mesh, world_from_mesh, dynamic: false });
}

/// Trees share a few meshes.
fn grove(scene: &mut Scene, site: &Site) {
    let kinds: Vec<usize> = (0..trees::KINDS)
        .map(|kind| {
            let mut sheets = Sheets::default();
            trees::grow(&mut sheets, site, kind);
            push(scene, sheets.finish(&format!("tree-kind-{kind}")))
        })
        .collect();
    for (i, spot) in trees::spots(site).iter().enumerate() {
        let turn = Turn::radians(spot.angle);
        let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| turn.apply(axis) * spot.size);
        let translation = DVec3::new(spot.at.x, ground::height(site, spot.at.x, spot.at.y) - 0.15, spot.at.y);
        let world_from_mesh = DAffine3 { matrix3: DMat3::from_cols(axes[0], axes[1], axes[2]), translation };
        place(scene, format!("tree-{i}"), kinds[spot.kind % kinds.len()], world_from_mesh);
    }
}
