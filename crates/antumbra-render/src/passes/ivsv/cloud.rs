//! The scene as points, of which each VPL's shadow map gets a share.
//!
//! Points lie evenly over the scene's area, and move with their nodes. They come in chunks of neighbours, along a curve. Each
//! frame shares out a map's points among the chunks by the solid angle in which the lights see them, so that what is near
//! gets many: the point level of detail that Wyman and Dai (2013, section 5) leave to the future.

use antumbra_scene::{AlphaMode, AlphaTest, Node, Primitive, Scene};
use glam::{DMat3, DVec3, Vec3};

use crate::area::Vpl;
use crate::sampling::r2;

/// Points of a chunk.
const CHUNK: usize = 64;
/// Discs overlap, or light would pass between them.
const OVERLAP: f64 = 1.15;

/// A point of the scene, in mesh space.
#[derive(Clone, Copy, Debug)]
struct Point {
    position: [f32; 3],
    normal: Vec3,
}

/// Neighbouring points of one node.
#[derive(Clone, Copy, Debug)]
struct Chunk {
    node: usize,
    first: u32,
    count: u32,
    hull: Hull,
    /// Of what its points stand for, world, m².
    area_m2: f64,
}

/// A box about a chunk, at which its discs end: or bars and limbs would swell to walls.
#[derive(Clone, Copy, Debug)]
struct Hull {
    /// In mesh space.
    middle: [f32; 3],
    /// Unit vectors in mesh space: along its length, and across.
    along: Vec3,
    across: Vec3,
    /// Half of what it measures along them and along the third, metres.
    half_m: [f32; 3],
}

/// A scene's points.
#[derive(Clone, Debug)]
pub(crate) struct Cloud {
    points: Vec<Point>,
    chunks: Vec<Chunk>,
}

/// A point where it is in one frame, relative to the eye.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    pub position: Vec3,
    pub normal: Vec3,
}

/// A chunk's share of each map's points.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "gpu", derive(bytemuck::Pod, bytemuck::Zeroable))]
#[repr(C)]
pub(crate) struct Share {
    /// Where its share begins, of 2^32.
    pub begin: u32,
    pub first: u32,
    pub count: u32,
    /// Radius of the discs that its points are drawn as, and the area that each stands for.
    pub radius_m: f32,
    /// The box at which discs end: its middle, two axes (the third is at right angles to them), half its sides.
    pub middle: [f32; 3],
    pub area_m2: f32,
    pub along: [f32; 3],
    pub half_along_m: f32,
    pub across: [f32; 3],
    pub half_across_m: f32,
    pub half_third_m: f32,
    pub pad: [u32; 3],
}

/// The cloud in one frame.
#[derive(Clone, Debug)]
pub(crate) struct Cast {
    pub points: Vec<Placed>,
    /// By `begin`.
    pub shares: Vec<Share>,
}

/// A triangle of the scene that casts shadows.
struct Caster {
    node: usize,
    primitive: usize,
    triangle: usize,
    area_m2: f64,
}

impl Cloud {
    /// About so many points of what casts shadows: opaque surfaces, and masked ones where they are.
    pub fn new(scene: &Scene, count: u32) -> Self {
        let casters = casters(scene);
        let all: f64 = casters.iter().map(|c| c.area_m2).sum();
        let mut found: Vec<(usize, u64, DVec3, Point)> = Vec::new();
        if all > 0.0 {
            let (mut next, mut before, step) = (0_u32, 0.0, all / f64::from(count));
            for caster in &casters {
                let after = before + caster.area_m2;
                // One point in the middle of each step along the sum of areas.
                while next < count && (f64::from(next) + 0.5) * step < after {
                    if let Some((world, point)) = caster.point(scene, next) {
                        found.push((caster.node, 0, world, point));
                    }
                    next += 1;
                }
                before = after;
            }
            order(&mut found);
            return Self::of_points(scene, &found, step);
        }
        Self { points: Vec::new(), chunks: Vec::new() }
    }

    /// Cuts points that lie in order of their nodes and places into chunks.
    fn of_points(scene: &Scene, found: &[(usize, u64, DVec3, Point)], area_m2: f64) -> Self {
        let (mut points, mut chunks) = (Vec::with_capacity(found.len()), Vec::new());
        for of_node in found.chunk_by(|a, b| a.0 == b.0) {
            for chunk in of_node.chunks(CHUNK) {
                let first = points.len() as u32;
                let own: Vec<Point> = chunk.iter().map(|(.., point)| *point).collect();
                let count = own.len() as u32;
                points.extend(own);
                let hull = Hull::of(chunk, &scene.nodes[chunk[0].0], area_m2);
                chunks.push(Chunk { node: chunk[0].0, first, count, hull, area_m2: area_m2 * f64::from(count) });
            }
        }
        Self { points, chunks }
    }

    /// Where the points are, and how many of each chunk's go into each map of `budget` points for these VPLs.
    pub fn cast(&self, nodes: &[Node], eye: DVec3, vpls: &[Vpl], budget: u32) -> Cast {
        let mut points = Vec::with_capacity(self.points.len());
        for chunk in &self.chunks {
            let node = &nodes[chunk.node];
            // By cofactors: those of flattened nodes, too.
            let DMat3 { x_axis: x, y_axis: y, z_axis: z } = node.world_from_mesh.matrix3;
            let turned = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
            for point in &self.points[chunk.first as usize..(chunk.first + chunk.count) as usize] {
                let position = (node.world_point(point.position) - eye).as_vec3();
                let normal = (turned * point.normal.as_dvec3()).normalize_or_zero().as_vec3();
                points.push(Placed { position, normal });
            }
        }
        Cast { points, shares: self.shares(nodes, eye, vpls, budget) }
    }

    /// How many of each chunk's points go into each map of `budget` points for these VPLs.
    pub fn shares(&self, nodes: &[Node], eye: DVec3, vpls: &[Vpl], budget: u32) -> Vec<Share> {
        let middle = |chunk: &Chunk| (nodes[chunk.node].world_point(chunk.hull.middle) - eye).as_vec3();
        let wish = |chunk: &Chunk| chunk.area_m2 * solid_angle(middle(chunk), chunk.area_m2, vpls);
        let quotas = self.quotas(&self.chunks.iter().map(wish).collect::<Vec<_>>(), budget);
        let all: f64 = quotas.iter().sum();
        let mut before = 0.0;
        let mut share = |(chunk, quota): (&Chunk, &f64)| {
            let begin = (before / all.max(f64::MIN_POSITIVE) * 4_294_967_296.0) as u32;
            before += quota;
            // A map that has none of a chunk's points is as likely as its quota is small: then they stand for all of it.
            let area_m2 = chunk.area_m2 / quota.max(1.0);
            let radius_m = ((area_m2 / std::f64::consts::PI).sqrt() * OVERLAP) as f32;
            let turned = |axis: Vec3| {
                let world = nodes[chunk.node].world_from_mesh.matrix3 * axis.as_dvec3();
                world.normalize_or_zero().as_vec3().to_array()
            };
            let Hull { along, across, half_m: [half_along_m, half_across_m, half_third_m], .. } = chunk.hull;
            Share {
                begin,
                first: chunk.first,
                count: chunk.count,
                radius_m,
                middle: middle(chunk).to_array(),
                area_m2: area_m2 as f32,
                along: turned(along),
                half_along_m,
                across: turned(across),
                half_across_m,
                half_third_m,
                pad: [0; 3],
            }
        };
        self.chunks.iter().zip(&quotas).map(&mut share).collect()
    }

    /// Number of points.
    #[cfg(feature = "gpu")]
    pub fn len(&self) -> u32 {
        self.points.len() as u32
    }

    /// All points in mesh space, with the numbers of their nodes and their normals.
    #[cfg(feature = "gpu")]
    pub fn points(&self) -> impl Iterator<Item = ([f32; 3], u32, [f32; 3])> {
        let of_chunk = |chunk: &Chunk| {
            let own = &self.points[chunk.first as usize..(chunk.first + chunk.count) as usize];
            let node = chunk.node as u32;
            own.iter().map(move |point| (point.position, node, point.normal.to_array()))
        };
        self.chunks.iter().flat_map(of_chunk)
    }

    /// Shares a budget out by wishes; no chunk gets more than it has points, as long as others can take the rest.
    fn quotas(&self, wishes: &[f64], budget: u32) -> Vec<f64> {
        let count = |i: usize| f64::from(self.chunks[i].count);
        let (mut scale, mut full) = (0.0, vec![false; wishes.len()]);
        for _ in 0..8 {
            let taken: f64 = (0..wishes.len()).filter(|i| full[*i]).map(count).sum();
            let wished: f64 = wishes.iter().zip(&full).filter(|(_, full)| !**full).map(|(wish, _)| wish).sum();
            scale = (f64::from(budget) - taken).max(0.0) / wished.max(f64::MIN_POSITIVE);
            let mut changed = false;
            for (i, wish) in wishes.iter().enumerate() {
                if !full[i] && wish * scale > count(i) {
                    (full[i], changed) = (true, true);
                }
            }
            if !changed {
                break;
            }
        }
        wishes.iter().enumerate().map(|(i, wish)| if full[i] { count(i) } else { wish * scale }).collect()
    }
}

impl Hull {
    /// About points that a node places, each of which stands for so much area: along their principal axes.
    fn of(points: &[(usize, u64, DVec3, Point)], node: &Node, area_m2: f64) -> Self {
        if node.world_from_mesh.matrix3.determinant() == 0.0 {
            // Flattened: there is no way back into its space, and no box.
            return Self { middle: [0.0; 3], along: Vec3::X, across: Vec3::Y, half_m: [f32::INFINITY; 3] };
        }
        let worlds = || points.iter().map(|(_, _, world, _)| *world);
        let mean = worlds().sum::<DVec3>() / points.len() as f64;
        let outer = |v: DVec3| DMat3::from_cols(v * v.x, v * v.y, v * v.z);
        let spread = worlds().fold(DMat3::ZERO, |sum, world| sum + outer(world - mean));
        // The greatest axis by repeated multiplication, from where hardly any scene's axes are at right angles to it.
        let mut along = DVec3::new(0.48, 0.64, 0.6);
        for _ in 0..32 {
            along = (spread * along).try_normalize().unwrap_or(along);
        }
        // The second, in the plane across it.
        let (x, y) = along.any_orthonormal_pair();
        let (p, q, s) = (x.dot(spread * x), x.dot(spread * y), y.dot(spread * y));
        let turn = 0.5 * (2.0 * q).atan2(p - s);
        let across = x * turn.cos() + y * turn.sin();
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for world in worlds() {
            let way = world - mean;
            let at = DVec3::new(way.dot(along), way.dot(across), way.dot(along.cross(across)));
            (low, high) = (low.min(at), high.max(at));
        }
        // To the borders of what the outermost points stand for, but where all lie in a plane or on a line.
        let half = 0.5 * (high - low);
        let spacing = area_m2.sqrt();
        let margin = 0.5 * spacing * (0.5 * (half / spacing - 1.0)).clamp(DVec3::ZERO, DVec3::ONE);
        let half_m = (half + margin).max(DVec3::splat(1e-3 * half.x));
        let at = 0.5 * (low + high);
        let middle = mean + along * at.x + across * at.y + along.cross(across) * at.z;
        let back = node.world_from_mesh.inverse();
        let mesh = |axis: DVec3| back.transform_vector3(axis).normalize_or_zero().as_vec3();
        Self {
            middle: back.transform_point3(middle).as_vec3().to_array(),
            along: mesh(along),
            across: mesh(across),
            half_m: half_m.as_vec3().to_array(),
        }
    }
}

/// What a chunk's place makes of its area: the mean over a few VPLs of 1 / r², no nearer than its own size; nothing where it
/// lies behind the light.
fn solid_angle(middle: Vec3, area_m2: f64, vpls: &[Vpl]) -> f64 {
    let few = vpls.iter().step_by(vpls.len().div_ceil(8).max(1));
    let (mut sum, mut count) = (0.0, 0);
    for vpl in few {
        let way = middle - vpl.position;
        let is_before = f64::from(way.dot(vpl.normal)) > -area_m2.sqrt();
        sum += if is_before { 1.0 / (f64::from(way.length_squared()) + area_m2) } else { 0.0 };
        count += 1;
    }
    sum / f64::from(count.max(1))
}

/// Sorts points by node, then along a curve that keeps neighbours together (Morton 1966).
fn order(found: &mut [(usize, u64, DVec3, Point)]) {
    let mut bounds = antumbra_scene::Bounds::EMPTY;
    found.iter().for_each(|(_, _, world, _)| bounds.insert(*world));
    let size = (bounds.max - bounds.min).max_element().max(1e-12);
    for (_, code, world, _) in found.iter_mut() {
        let cell = ((*world - bounds.min) / size * 2_097_151.0).as_u64vec3();
        *code = spread(cell.x) | spread(cell.y) << 1 | spread(cell.z) << 2;
    }
    found.sort_by_key(|(node, code, ..)| (*node, *code));
}

/// 21 bits, each followed by two zeros.
fn spread(x: u64) -> u64 {
    let x = (x | x << 32) & 0x001F_0000_0000_FFFF;
    let x = (x | x << 16) & 0x001F_0000_FF00_00FF;
    let x = (x | x << 8) & 0x100F_00F0_0F00_F00F;
    let x = (x | x << 4) & 0x10C3_0C30_C30C_30C3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

fn casters(scene: &Scene) -> Vec<Caster> {
    let mut out = Vec::new();
    for (n, node) in scene.nodes.iter().enumerate() {
        for (p, primitive) in scene.meshes[node.mesh].primitives.iter().enumerate() {
            if scene.material(primitive).alpha_mode == AlphaMode::Blend {
                continue;
            }
            for (t, triangle) in primitive.triangles.iter().enumerate() {
                let [a, b, c] = triangle.map(|i| node.world_point(primitive.positions[i as usize]));
                let area_m2 = 0.5 * (b - a).cross(c - a).length();
                if area_m2.is_finite() && area_m2 > 0.0 {
                    out.push(Caster { node: n, primitive: p, triangle: t, area_m2 });
                }
            }
        }
    }
    out
}

impl Caster {
    /// A point of it, evenly over its area; `None` where an alpha mask cuts it away.
    fn point(&self, scene: &Scene, index: u32) -> Option<(DVec3, Point)> {
        let node = &scene.nodes[self.node];
        let primitive: &Primitive = &scene.meshes[node.mesh].primitives[self.primitive];
        let vertices = primitive.triangles[self.triangle].map(|i| i as usize);
        let at = r2(index);
        // The unit square folded onto the triangle.
        let (u, v) = if at.x + at.y > 1.0 { (1.0 - at.x, 1.0 - at.y) } else { (at.x, at.y) };
        let weights = [1.0 - u - v, u, v];
        if let Some(test) = AlphaTest::new(scene, primitive) {
            let mean = |value: &dyn Fn(usize) -> f32| -> f64 {
                vertices.iter().zip(weights).map(|(&i, w)| f64::from(value(i)) * w).sum()
            };
            let uv = [0, 1].map(|axis| mean(&|i| primitive.texcoords[i][axis]));
            let alpha = mean(&|i| primitive.colors.get(i).map_or(1.0, |color| color[3]));
            if !test.keeps(uv, alpha) {
                return None;
            }
        }
        let [a, b, c] = vertices.map(|i| Vec3::from(primitive.positions[i]));
        let position = a * weights[0] as f32 + b * u as f32 + c * v as f32;
        let normal = (b - a).cross(c - a).normalize_or_zero();
        Some((node.world_point(position.to_array()), Point { position: position.to_array(), normal }))
    }
}
