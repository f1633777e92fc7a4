//! The landscape: mountains over a lake plain, one closed solid of about two million triangles.
//!
//! A height field on a square grid gets a skirt down to a flat bottom. Its triangles are sorted by height and slope
//! into primitives with a material each; shared edges keep the bits of their positions, so that the mesh as a whole is
//! closed.

mod terrain;

use glam::{DAffine3, DVec3};

use self::terrain::Terrain;
use super::Options;
use super::noise::fractal_noise;
use super::palette::material;
use super::view::{camera, sun};
use crate::model::{Camera, Material, Mesh, Node, Primitive, Scene};

/// Side of the square, metres.
const SIDE_M: f64 = 6000.0;
/// Height of the flat underside.
const BOTTOM_M: f64 = -260.0;
/// Quads per side at scale 1.
const QUADS: f64 = 1000.0;

/// (name, sRGB colour, roughness), in the order that [`Cover`] numbers them.
const COVERS: [(&str, u32, f32); 11] = [
    ("lake", 0x4b7688, 0.08),
    ("shore", 0xc9b68c, 0.95),
    ("meadow", 0x8f9c55, 1.0),
    ("pasture", 0x7b8c4c, 1.0),
    ("forest", 0x56703d, 1.0),
    ("dark forest", 0x465f38, 1.0),
    ("heath", 0x8b8559, 1.0),
    ("scree", 0xa29883, 1.0),
    ("rock", 0x8a8176, 0.95),
    ("snow", 0xf2f4f6, 0.7),
    ("earth", 0x7d684e, 1.0),
];
const EARTH: usize = COVERS.len() - 1;

/// Builds the landscape.
pub(crate) fn build(options: &Options) -> Scene {
    let quads = (QUADS * options.scale).round() as usize;
    let terrain = Terrain::new(options.seed);
    let grid = Grid::new(&terrain, quads);
    let mesh = Mesh { name: "landscape".to_owned(), primitives: grid.primitives(options.seed) };
    let node = Node { name: "landscape".to_owned(), mesh: 0, world_from_mesh: DAffine3::IDENTITY, dynamic: false };
    Scene {
        name: "landscape".to_owned(),
        meshes: vec![mesh],
        nodes: vec![node],
        materials: covers(),
        lights: vec![sun(236.0, 36.0)],
        cameras: cameras(&terrain),
        ..Scene::default()
    }
}

fn covers() -> Vec<Material> {
    COVERS.iter().map(|&(name, rgb, roughness)| material(name, rgb, 0.0, roughness)).collect()
}

fn cameras(terrain: &Terrain) -> Vec<Camera> {
    let over = |x: f64, z: f64, above: f64| DVec3::new(x, terrain.height(x, z) + above, z);
    vec![
        camera("overview", DVec3::new(-2900.0, 1500.0, 3900.0), DVec3::new(150.0, 120.0, -250.0), 42.0),
        camera("valley", over(-1500.0, 1900.0, 60.0), over(600.0, -900.0, 60.0), 48.0),
        camera("ridge", over(1500.0, 300.0, 160.0), over(-900.0, -1500.0, 0.0), 50.0),
        camera("lake", over(-2300.0, 1000.0, 25.0), over(900.0, -300.0, 150.0), 45.0),
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

    fn primitives(&self, seed: u64) -> Vec<Primitive> {
        let mut by_cover = vec![Vec::new(); COVERS.len()];
        for triangle in self.triangles() {
            by_cover[self.cover(seed, triangle)].push(triangle);
        }
        let used = by_cover.iter().enumerate().filter(|(_, triangles)| !triangles.is_empty());
        let mut primitives: Vec<_> = used.map(|(cover, triangles)| self.surface(cover, triangles)).collect();
        primitives.push(self.underside());
        primitives
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

    fn cover(&self, seed: u64, triangle: [u32; 3]) -> usize {
        let [a, b, c] = triangle.map(|i| self.positions[i as usize]);
        let center = (a + b + c) / 3.0;
        let normal = (b - a).cross(c - a).normalize();
        let mottle = fractal_noise(seed ^ 0x51, glam::DVec2::new(center.x, center.z) / 260.0, 4, 0.6);
        terrain::cover(center.y, normal, mottle)
    }

    /// One material's triangles, with their own vertices.
    fn surface(&self, cover: usize, triangles: &[[u32; 3]]) -> Primitive {
        let mut own = vec![u32::MAX; self.positions.len()];
        let mut primitive = Primitive { material: Some(cover), ..Primitive::default() };
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
