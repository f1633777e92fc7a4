//! The landscape: mountains over a lake plain, one closed solid of about two million triangles.
//!
//! A height field on a square grid gets a skirt down to a flat bottom. Ground, lake and skirt are primitives of their
//! own; shared edges keep the bits of their positions, so that the mesh as a whole is
//! closed.

mod cover;
mod rivers;
mod terrain;

use glam::{DAffine3, DVec3};

use self::cover::Cover;
use self::terrain::{LAKE_M, Terrain};
use super::Options;
use super::palette::material;
use super::view::{camera, sun};
use crate::model::{Camera, Mesh, Node, Primitive, Scene};

/// Side of the square, metres.
const SIDE_M: f64 = 6000.0;
/// Height of the flat underside.
const BOTTOM_M: f64 = -260.0;
/// Quads per side at scale 1.
const QUADS: f64 = 1000.0;

/// The materials' places in [`Scene::materials`].
const GROUND: usize = 0;
const LAKE: usize = 1;
const EARTH: usize = 2;

/// Builds the landscape.
pub(crate) fn build(options: &Options) -> Scene {
    let quads = (QUADS * options.scale).round() as usize;
    let terrain = Terrain::new(options.seed);
    let grid = Grid::new(&terrain, quads);
    let mesh = Mesh { name: "landscape".to_owned(), primitives: grid.primitives(&Cover::new(&terrain, options.seed)) };
    let node = Node { name: "landscape".to_owned(), mesh: 0, world_from_mesh: DAffine3::IDENTITY, dynamic: false };
    Scene {
        name: "landscape".to_owned(),
        meshes: vec![mesh],
        nodes: vec![node],
        materials: vec![
            material("ground", 0xffffff, 0.0, 1.0),
            material("lake", 0x4b7688, 0.0, 0.08),
            material("earth", 0x7d684e, 0.0, 1.0),
        ],
        lights: vec![sun(262.0, 32.0)],
        cameras: cameras(&terrain),
        ..Scene::default()
    }
}

fn cameras(terrain: &Terrain) -> Vec<Camera> {
    let over = |x: f64, z: f64, above: f64| DVec3::new(x, terrain.height(x, z) + above, z);
    let (summit, [mouth, head]) = (terrain.summit(), terrain.valley(110.0, 400.0));
    let back = DVec3::new(-summit.x, 0.0, -summit.z).normalize();
    let perch = summit - back * 260.0;
    vec![
        camera("overview", DVec3::new(-2350.0, 820.0, 3150.0), DVec3::new(0.0, 140.0, -100.0), 40.0),
        camera("valley", mouth + DVec3::Y * 230.0, head + DVec3::Y * 40.0, 52.0),
        camera("ridge", over(perch.x, perch.z, 150.0), over(-1000.0, 1000.0, 0.0), 55.0),
        camera("lake", over(-2000.0, 1950.0, 45.0), over(300.0, -300.0, 40.0), 42.0),
    ]
}

/// The height field's vertices, row by row along x.
struct Grid {
    quads: usize,
    positions: Vec<DVec3>,
    normals: Vec<DVec3>,
}

impl Grid {
    fn new(terrain: &Terrain, quads: usize) -> Self {
        let side = quads + 1;
        let along = |i: usize| (i as f64 / quads as f64 - 0.5) * SIDE_M;
        let positions: Vec<_> = (0..side * side)
            .map(|i| (along(i % side), along(i / side)))
            .map(|(x, z)| DVec3::new(x, terrain.height(x, z), z))
            .collect();
        let mut grid = Self { quads, positions, normals: Vec::new() };
        grid.normals = (0..side * side).map(|i| grid.normal(i % side, i / side)).collect();
        grid
    }

    fn index(&self, x: usize, z: usize) -> u32 {
        (z * (self.quads + 1) + x) as u32
    }

    fn normal(&self, x: usize, z: usize) -> DVec3 {
        let at = |x: usize, z: usize| self.positions[self.index(x, z) as usize];
        let along_x = at((x + 1).min(self.quads), z) - at(x.saturating_sub(1), z);
        let along_z = at(x, (z + 1).min(self.quads)) - at(x, z.saturating_sub(1));
        along_z.cross(along_x).normalize()
    }

    fn primitives(&self, cover: &Cover<'_>) -> Vec<Primitive> {
        let (lake, ground): (Vec<_>, Vec<_>) = self.triangles().partition(|t| self.is_lake(*t));
        let mut ground = self.surface(GROUND, &ground);
        let vertices = ground.positions.iter().zip(&ground.normals);
        ground.colors = vertices
            .map(|(p, n)| cover.color(p.map(f64::from).into(), n.map(f64::from).into()).extend(1.0))
            .map(|c| c.to_array().map(|v| v as f32))
            .collect();
        let mut primitives = vec![ground, self.underside()];
        if !lake.is_empty() {
            primitives.push(self.surface(LAKE, &lake));
        }
        primitives
    }

    fn is_lake(&self, triangle: [u32; 3]) -> bool {
        triangle.iter().all(|&i| self.positions[i as usize].y <= LAKE_M)
    }

    /// Quads split along alternating diagonals.
    fn triangles(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        (0..self.quads * self.quads).flat_map(|i| {
            let (x, z) = (i % self.quads, i / self.quads);
            let [a, b] = [self.index(x, z), self.index(x + 1, z)];
            let [c, d] = [self.index(x, z + 1), self.index(x + 1, z + 1)];
            if (x + z) % 2 == 0 { [[a, c, d], [a, d, b]] } else { [[a, c, b], [b, c, d]] }
        })
    }

    /// One material's triangles, with their own vertices.
    fn surface(&self, material: usize, triangles: &[[u32; 3]]) -> Primitive {
        let mut own = vec![u32::MAX; self.positions.len()];
        let mut primitive = Primitive { material: Some(material), ..Primitive::default() };
        for triangle in triangles {
            let moved = triangle.map(|i| {
                let own = &mut own[i as usize];
                if *own == u32::MAX {
                    *own = primitive.positions.len() as u32;
                    primitive.positions.push(self.position(i));
                    primitive.normals.push(self.normals[i as usize].to_array().map(|v| v as f32));
                }
                *own
            });
            primitive.triangles.push(moved);
        }
        primitive
    }

    fn position(&self, i: u32) -> [f32; 3] {
        self.positions[i as usize].to_array().map(|v| v as f32 + 0.0)
    }

    /// The border, counter-clockwise seen from above.
    fn border(&self) -> Vec<u32> {
        let n = self.quads;
        let south = (0..n).map(|i| self.index(i, n));
        let east = (0..n).map(|i| self.index(n, n - i));
        let north = (0..n).map(|i| self.index(n - i, 0));
        let west = (0..n).map(|i| self.index(0, i));
        south.chain(east).chain(north).chain(west).collect()
    }

    /// Skirt and bottom: for each border vertex one above, one below, and a fan of the lower ones about the middle.
    fn underside(&self) -> Primitive {
        let border = self.border();
        let count = border.len() as u32;
        let mut primitive = Primitive { material: Some(EARTH), ..Primitive::default() };
        for &i in &border {
            let [x, y, z] = self.position(i);
            primitive.positions.extend([[x, y, z], [x, BOTTOM_M as f32, z]]);
        }
        primitive.positions.push([0.0, BOTTOM_M as f32, 0.0]);
        for i in 0..count {
            let j = (i + 1) % count;
            let [top, low, next_top, next_low] = [2 * i, 2 * i + 1, 2 * j, 2 * j + 1];
            primitive.triangles.extend([[low, next_low, next_top], [low, next_top, top], [low, 2 * count, next_low]]);
        }
        primitive
    }
}
