//! A scene on the graphics card: meshes once, however many nodes place them; materials and textures as words.

use antumbra_scene::{AlphaMode, AlphaTest, Bounds, Material, Node, Primitive, Scene, Wrap};
use glam::DVec3;

use super::{Gpu, Slot};
use crate::RenderError;
use crate::surface::Pyramid;

/// No such thing: what tables say instead of an index.
const NONE: u32 = u32::MAX;

/// What `geometry.wgsl` reads, but for the frame.
#[derive(Debug)]
pub(crate) struct SceneBuffers {
    geometry: wgpu::Buffer,
    tables: wgpu::Buffer,
    /// Three rows for each node: see [`SceneBuffers::place`].
    pub nodes: wgpu::Buffer,
    indices: wgpu::Buffer,
    positions: wgpu::Buffer,
    attributes: wgpu::Buffer,
    texels: wgpu::Buffer,
    /// In the order of the scene's nodes and their primitives.
    pub parts: Vec<DrawnPart>,
}

/// A primitive where a node places it: one draw.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DrawnPart {
    /// Three per triangle.
    pub vertices: u32,
    /// Whether its texture decides where it is.
    pub is_cut_out: bool,
    /// Whether it lets light through.
    pub is_translucent: bool,
    /// Whether its node moves.
    pub is_dynamic: bool,
    pub node: usize,
    /// A box about it, world, metres; empty without triangles.
    pub bounds: Bounds,
}

impl DrawnPart {
    /// A sphere about it: middle and radius.
    pub fn sphere(&self) -> (DVec3, f64) {
        let bounds = &self.bounds;
        (if bounds.is_empty() { DVec3::ZERO } else { bounds.center() }, 0.5 * bounds.diagonal())
    }
}

/// Bindings of `geometry.wgsl`: the frame comes first.
pub(crate) const GEOMETRY_SLOTS: [Slot; 8] = [Slot::Read; 8];

impl SceneBuffers {
    pub fn new(gpu: &Gpu, scene: &Scene) -> Result<Self, RenderError> {
        let mut words = Words::default();
        let placed: Vec<Vec<Placed>> =
            scene.meshes.iter().map(|mesh| mesh.primitives.iter().map(|p| words.add(p)).collect()).collect();
        let materials = materials(scene);
        let (images, levels, texels) = textures(scene);
        let (rows, parts) = part_rows(scene, &placed);
        let mut begins = [0; 4];
        for (i, table) in [&rows, &materials, &images].into_iter().enumerate() {
            begins[i + 1] = begins[i] + table.len() as u32;
        }
        let tables = [rows, materials, images, levels].concat();
        for (what, bytes) in [
            ("the scene's triangles", 4 * words.indices.len()),
            ("the scene's vertices", 4 * words.positions.len()),
            ("the scene's normals and texture coordinates", 4 * words.attributes.len()),
            ("the scene's textures", 4 * texels.len()),
        ] {
            gpu.check_size(what, bytes as u64)?;
        }
        Ok(Self {
            geometry: gpu.buffer("geometry", &begins),
            tables: gpu.buffer("tables", &tables),
            nodes: gpu.zeros("nodes", 48 * scene.nodes.len() as u64),
            indices: gpu.buffer("indices", &words.indices),
            positions: gpu.buffer("positions", &words.positions),
            attributes: gpu.buffer("attributes", &words.attributes),
            texels: gpu.buffer("texels", &texels),
            parts,
        })
    }

    /// Places the nodes relative to the eye.
    pub fn place(&self, gpu: &Gpu, nodes: &[Node], eye: DVec3) {
        let row = |node: &Node| -> [[f32; 4]; 3] {
            let m = &node.world_from_mesh;
            let offset = m.translation - eye;
            [0, 1, 2].map(|i| {
                let r = m.matrix3.row(i);
                [r.x as f32, r.y as f32, r.z as f32, offset[i] as f32]
            })
        };
        let rows: Vec<_> = nodes.iter().map(row).collect();
        if !rows.is_empty() {
            gpu.queue.write_buffer(&self.nodes, 0, bytemuck::cast_slice(&rows));
        }
    }

    /// Notes that a node has moved; returns the boxes about each of its parts before and after.
    pub fn moved(&mut self, scene: &Scene, number: usize, node: &Node) -> Vec<[Bounds; 2]> {
        let own = self.parts.iter_mut().filter(|part| part.node == number);
        let moved = |(part, primitive): (&mut DrawnPart, &Primitive)| {
            let before = std::mem::replace(&mut part.bounds, bounds(primitive, node));
            [before, part.bounds]
        };
        own.zip(&scene.meshes[node.mesh].primitives).map(moved).collect()
    }

    /// The bindings of `geometry.wgsl`.
    pub fn resources<'a>(&'a self, frame: &'a wgpu::Buffer) -> [wgpu::BindingResource<'a>; 8] {
        let buffers = [
            frame,
            &self.geometry,
            &self.tables,
            &self.nodes,
            &self.indices,
            &self.positions,
            &self.attributes,
            &self.texels,
        ];
        buffers.map(wgpu::Buffer::as_entire_binding)
    }
}

/// Vertices and triangles of all meshes in a row.
#[derive(Default)]
struct Words {
    indices: Vec<u32>,
    positions: Vec<f32>,
    attributes: Vec<f32>,
}

/// Where a primitive's words begin.
#[derive(Clone, Copy)]
struct Placed {
    first_index: u32,
    first_vertex: u32,
    normals: u32,
    texcoords: u32,
    colors: u32,
}

impl Words {
    fn add(&mut self, primitive: &Primitive) -> Placed {
        let count = primitive.positions.len();
        let first_index = self.indices.len() as u32;
        let first_vertex = (self.positions.len() / 3) as u32;
        self.indices.extend(primitive.triangles.as_flattened());
        self.positions.extend(primitive.positions.as_flattened());
        Placed {
            first_index,
            first_vertex,
            normals: self.attribute(&primitive.normals, count),
            texcoords: self.attribute(&primitive.texcoords, count),
            colors: self.attribute(&primitive.colors, count),
        }
    }

    /// Where an attribute begins, if every vertex has it.
    fn attribute<const N: usize>(&mut self, values: &[[f32; N]], vertices: usize) -> u32 {
        if values.len() != vertices || vertices == 0 {
            return NONE;
        }
        let at = self.attributes.len() as u32;
        self.attributes.extend(values.as_flattened());
        at
    }
}

/// A box about a primitive where a node places it.
fn bounds(primitive: &Primitive, node: &Node) -> Bounds {
    let mut bounds = Bounds::EMPTY;
    primitive.positions.iter().for_each(|p| bounds.insert(node.world_point(*p)));
    bounds
}

/// The table of parts, and how to draw them.
fn part_rows(scene: &Scene, placed: &[Vec<Placed>]) -> (Vec<u32>, Vec<DrawnPart>) {
    let (mut rows, mut parts, mut first_triangle) = (Vec::new(), Vec::new(), 0u32);
    // glTF's default material stands behind the scene's own.
    let default_material = scene.materials.len();
    for (n, node) in scene.nodes.iter().enumerate() {
        for (primitive, at) in scene.meshes[node.mesh].primitives.iter().zip(&placed[node.mesh]) {
            let index = primitive.material.unwrap_or(default_material);
            let alpha = scene.material(primitive).alpha_mode;
            let triangles = primitive.triangles.len() as u32;
            rows.extend([at.first_index, at.first_vertex, at.normals, at.texcoords, at.colors]);
            rows.extend([index as u32, n as u32, first_triangle, 0, 0, 0, 0]);
            parts.push(DrawnPart {
                vertices: 3 * triangles,
                is_cut_out: alpha == AlphaMode::Blend || AlphaTest::new(scene, primitive).is_some(),
                is_translucent: alpha == AlphaMode::Blend,
                is_dynamic: node.dynamic,
                node: n,
                bounds: bounds(primitive, node),
            });
            first_triangle = first_triangle.wrapping_add(triangles);
        }
    }
    (rows, parts)
}

fn materials(scene: &Scene) -> Vec<u32> {
    let is_whole = |image: &antumbra_scene::Image| Pyramid::new(image).is_some();
    let whole: Vec<bool> = scene.images.iter().map(is_whole).collect();
    let default = Material::default();
    scene.materials.iter().chain([&default]).flat_map(|material| material_row(material, &whole)).collect()
}

fn material_row(material: &Material, whole: &[bool]) -> [u32; 24] {
    let texture = material.base_color_texture.filter(|t| whole.get(t.image).is_some_and(|whole| *whole));
    let alpha = match material.alpha_mode {
        AlphaMode::Opaque => 0,
        // Without a texture a mask cuts nothing away.
        AlphaMode::Mask if texture.is_none() => 0,
        AlphaMode::Mask => 1,
        AlphaMode::Blend => 2,
    };
    let wrap = |wrap| match wrap {
        Wrap::Repeat => 0,
        Wrap::Mirror => 1,
        Wrap::Clamp => 2,
    };
    let mut row = [0; 24];
    let numbers = material.base_color.iter().chain(&material.emissive).chain([&material.metallic, &material.roughness]);
    row.iter_mut().zip(numbers).for_each(|(word, number)| *word = number.to_bits());
    row[9] = alpha;
    row[10] = material.alpha_cutoff.to_bits();
    row[11] = texture.map_or(NONE, |t| t.image as u32);
    if let Some(texture) = texture {
        row[12] = wrap(texture.wrap_s);
        row[13] = wrap(texture.wrap_t);
        let transform = texture.transform.as_flattened();
        row[14..20].iter_mut().zip(transform).for_each(|(word, number)| *word = number.to_bits());
    }
    row
}

/// The tables of images and mip levels, and all levels' texels.
fn textures(scene: &Scene) -> (Vec<u32>, Vec<u32>, Vec<u32>) {
    let (mut images, mut levels, mut texels) = (Vec::new(), Vec::new(), Vec::new());
    for image in &scene.images {
        let pyramid = Pyramid::new(image);
        let own = pyramid.as_ref().map_or(&[][..], Pyramid::levels);
        images.extend([(levels.len() / 4) as u32, own.len() as u32, 0, 0]);
        for level in own {
            levels.extend([texels.len() as u32, level.width, level.height, 0]);
            texels.extend(level.rgba.iter().map(|rgba| u32::from_le_bytes(*rgba)));
        }
    }
    (images, levels, texels)
}
