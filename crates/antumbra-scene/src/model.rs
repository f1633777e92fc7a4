//! The scene model: everything a bake or a picture needs, and nothing else.
//!
//! Lengths are metres, angles radians, the world is right-handed with +Y up (glTF's convention).
//! Positions stay in mesh space as `f32`; nodes place them in the world with `f64` transforms, so that a scene far
//! from the origin keeps its detail.

use glam::{DAffine3, DVec3};

/// A scene, flattened: each [`Node`] places one [`Mesh`] in the world.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// Name for people: the file's stem or the generator's name.
    pub name: String,
    /// Meshes, shared by nodes.
    pub meshes: Vec<Mesh>,
    /// Placed meshes. Nodes of a file without a mesh do not appear here.
    pub nodes: Vec<Node>,
    /// Materials that primitives refer to.
    pub materials: Vec<Material>,
    /// Decoded base-colour images that materials refer to.
    pub images: Vec<Image>,
    /// Lights, in the file's order.
    pub lights: Vec<Light>,
    /// Lights with a surface, in the file's order.
    pub area_lights: Vec<AreaLight>,
    /// Cameras, in the file's order.
    pub cameras: Vec<Camera>,
    /// Triangles that were left out, by reason (counted per mesh, not per node).
    pub dropped: Dropped,
    /// glTF `asset.copyright`: keep it with every picture.
    pub copyright: Option<String>,
}

/// A mesh: one or more primitives, each with its own material. One glTF mesh.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Name for people.
    pub name: String,
    /// The parts that have one material each.
    pub primitives: Vec<Primitive>,
}

/// Triangles with one material. Counter-clockwise seen from outside, as in glTF.
#[derive(Clone, Debug, Default)]
pub struct Primitive {
    /// Vertex positions in mesh space, metres.
    pub positions: Vec<[f32; 3]>,
    /// Vertex normals, or empty: then a renderer uses face normals.
    pub normals: Vec<[f32; 3]>,
    /// Texture coordinates of the set the material's base-colour texture uses, or empty.
    pub texcoords: Vec<[f32; 2]>,
    /// Linear RGBA vertex colours, or empty.
    pub colors: Vec<[f32; 4]>,
    /// Triangles with a non-zero area; every index is in range and every corner finite.
    pub triangles: Vec<[u32; 3]>,
    /// Zero-area triangles with three distinct corners. They cover nothing (and count as dropped), but a closed
    /// surface may need their edges to be closed, for example at a T-junction.
    pub seams: Vec<[u32; 3]>,
    /// Index into [`Scene::materials`]; `None` means glTF's default material.
    pub material: Option<usize>,
}

/// A placed mesh.
#[derive(Clone, Debug)]
pub struct Node {
    /// The node's own name (unnamed nodes get `node<index>`).
    pub name: String,
    /// Index into [`Scene::meshes`].
    pub mesh: usize,
    /// Mesh space to world space. A negative determinant mirrors: triangles then turn over.
    pub world_from_mesh: DAffine3,
    /// Something that moves: it casts no baked shadow. Set by glTF extras `{"antumbra": "dynamic"}` (inherited by
    /// children) or by `--exclude`.
    pub dynamic: bool,
}

/// What becomes of a surface's alpha (glTF `alphaMode`).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AlphaMode {
    /// Alpha is ignored.
    #[default]
    Opaque,
    /// Fully there where alpha is at least the cutoff, else not there at all.
    Mask,
    /// Translucent.
    Blend,
}

/// A surface's look.
#[derive(Clone, Debug)]
pub struct Material {
    /// Name for people.
    pub name: String,
    /// Linear RGBA factor.
    pub base_color: [f32; 4],
    /// Base-colour texture (sRGB), multiplied by [`Material::base_color`].
    pub base_color_texture: Option<TextureRef>,
    /// Linear RGB light that the surface gives off.
    pub emissive: [f32; 3],
    /// 0 = dielectric, 1 = metal.
    pub metallic: f32,
    /// Perceptual roughness, 0 = mirror.
    pub roughness: f32,
    /// What becomes of alpha.
    pub alpha_mode: AlphaMode,
    /// For [`AlphaMode::Mask`].
    pub alpha_cutoff: f32,
    /// Whether the back shows too.
    pub double_sided: bool,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: String::new(),
            base_color: [1.0; 4],
            base_color_texture: None,
            emissive: [0.0; 3],
            metallic: 0.0,
            roughness: 1.0,
            alpha_mode: AlphaMode::Opaque,
            alpha_cutoff: 0.5,
            double_sided: false,
        }
    }
}

/// How a texture coordinate outside 0..1 is read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wrap {
    /// Repeat.
    #[default]
    Repeat,
    /// Repeat, every other tile mirrored.
    Mirror,
    /// The edge's texel goes on for ever.
    Clamp,
}

impl Wrap {
    /// The texel that an index stands for in a row of `side` texels.
    #[must_use]
    pub fn texel(self, index: i64, side: u32) -> u32 {
        let n = i64::from(side);
        let inside = match self {
            Self::Repeat => index.rem_euclid(n),
            Self::Clamp => index.clamp(0, n - 1),
            Self::Mirror => {
                let twice = index.rem_euclid(2 * n);
                twice.min(2 * n - 1 - twice)
            }
        };
        inside as u32
    }
}

/// A use of an image.
#[derive(Clone, Copy, Debug)]
pub struct TextureRef {
    /// Index into [`Scene::images`].
    pub image: usize,
    /// Wrap mode along s.
    pub wrap_s: Wrap,
    /// Wrap mode along t.
    pub wrap_t: Wrap,
    /// KHR_texture_transform as an affine map, row-major 2x3: `uv' = m * (u, v, 1)`.
    pub transform: [[f32; 3]; 2],
}

/// An image, RGBA, 8 bits per channel, sRGB colour and linear alpha, rows from the top.
#[derive(Clone, Debug)]
pub struct Image {
    /// Name for people.
    pub name: String,
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `4 * width * height` bytes.
    pub rgba: Vec<u8>,
}

/// What a light is (KHR_lights_punctual).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// The sun: parallel rays.
    Directional,
    /// All round from a point.
    Point,
    /// A cone about the light's direction.
    Spot {
        /// Half angle at which the light starts to fade, radians.
        inner_angle: f64,
        /// Half angle at which it ends, radians.
        outer_angle: f64,
    },
}

/// A punctual light.
#[derive(Clone, Debug)]
pub struct Light {
    /// The node's name; unique within the scene (a loader adds `.2`, `.3`, ... where a file repeats a name).
    pub name: String,
    /// What it is.
    pub kind: LightKind,
    /// World position (of no consequence for a directional light).
    pub position_world: DVec3,
    /// Unit vector along which light travels (of no consequence for a point light).
    pub direction_world: DVec3,
    /// Linear RGB.
    pub color: [f32; 3],
    /// Lux for directional lights, candela for the others.
    pub intensity: f32,
    /// Distance at which the light ends, if the file says so, metres.
    pub range_m: Option<f64>,
    /// Whether it moves: then it is baked only if it is named. Set as [`Node::dynamic`] is.
    pub dynamic: bool,
}

/// The surface of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AreaShape {
    /// Shines to one side.
    Rectangle {
        /// Metres across.
        width_m: f64,
        /// Metres along the light's up.
        height_m: f64,
    },
    /// Shines to one side.
    Disc {
        /// Metres.
        radius_m: f64,
    },
    /// Shines to all sides. Its picture goes round it, with the light's position in the middle.
    Sphere {
        /// Metres.
        radius_m: f64,
    },
    /// Everything around the scene, infinitely far away. Its picture is a map of longitude and latitude whose middle
    /// shows north (-Z).
    Environment,
}

/// A light with a surface that is equally bright from wherever it is seen: a screen, a lantern, a sky.
///
/// In glTF files it is a node that shines along its -Z with its Y up, and says so in its extras:
/// `{"antumbra": "area light", "shape": "rectangle", "width": 1.6, "height": 0.9, "luminance": 300}`. Shapes are
/// `rectangle` (with `width`, `height`), `disc` and `sphere` (`radius`), `environment`. `color` is three numbers from 0
/// to 1, `images` a list of the file's images (a video's frames), `fps` how many of them are shown in a second.
#[derive(Clone, Debug, PartialEq)]
pub struct AreaLight {
    /// The node's name.
    pub name: String,
    /// Its surface.
    pub shape: AreaShape,
    /// Its middle.
    pub position_world: DVec3,
    /// Unit vector along which a rectangle or disc shines.
    pub direction_world: DVec3,
    /// Unit vector at a right angle to it: up in the picture.
    pub up_world: DVec3,
    /// Linear RGB luminance, candela per square metre, by which the picture is multiplied.
    pub luminance: [f32; 3],
    /// What it shows, frame after frame: indices of the scene's images. Empty for plain light.
    pub frames: Vec<usize>,
    /// Frames that are shown in a second; the last is followed by the first.
    pub frames_per_second: f64,
}

/// A perspective camera.
#[derive(Clone, Debug)]
pub struct Camera {
    /// The node's name; unique within the scene.
    pub name: String,
    /// Position.
    pub eye_world: DVec3,
    /// Unit vector of view.
    pub forward_world: DVec3,
    /// Unit vector of up, at a right angle to `forward_world`.
    pub up_world: DVec3,
    /// Vertical field of view, radians.
    pub fov_y: f64,
}

/// Triangles that were left out, by reason.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dropped {
    /// A corner is NaN or infinite.
    pub not_finite: u64,
    /// Two corners coincide or all three lie on a line.
    pub zero_area: u64,
    /// An index points past the vertices, or a count does not make whole triangles.
    pub bad_index: u64,
}

impl Dropped {
    /// All reasons together.
    #[must_use]
    pub fn total(&self) -> u64 {
        self.not_finite + self.zero_area + self.bad_index
    }
}

/// An axis-aligned box, metres. Empty while `min > max`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest corner.
    pub min: DVec3,
    /// Largest corner.
    pub max: DVec3,
}

impl Bounds {
    /// The box of nothing.
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// Grows the box to hold a point.
    pub fn insert(&mut self, p: DVec3) {
        self.min = self.min.min(p);
        self.max = self.max.max(p);
    }

    /// Whether the box holds nothing.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        !(self.min.x <= self.max.x && self.min.y <= self.max.y && self.min.z <= self.max.z)
    }

    /// Centre.
    #[must_use]
    pub fn center(&self) -> DVec3 {
        (self.min + self.max) * 0.5
    }

    /// Length of the diagonal, metres; 0 for the empty box.
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        if self.is_empty() { 0.0 } else { (self.max - self.min).length() }
    }

    /// The eight corners.
    #[must_use]
    pub fn corners(&self) -> [DVec3; 8] {
        core::array::from_fn(|i| {
            let pick = |bit: usize, lo: f64, hi: f64| if i & bit == 0 { lo } else { hi };
            DVec3::new(
                pick(1, self.min.x, self.max.x),
                pick(2, self.min.y, self.max.y),
                pick(4, self.min.z, self.max.z),
            )
        })
    }
}

impl Node {
    /// World position of a mesh-space vertex, computed in `f64` by plain multiplications and additions, so that every
    /// machine gets the same bits.
    #[must_use]
    pub fn world_point(&self, position: [f32; 3]) -> DVec3 {
        let [x, y, z] = position.map(f64::from);
        let m = &self.world_from_mesh;
        m.matrix3.x_axis * x + m.matrix3.y_axis * y + m.matrix3.z_axis * z + m.translation
    }

    /// Whether the transform mirrors, so that counter-clockwise triangles turn clockwise.
    #[must_use]
    pub fn mirrors(&self) -> bool {
        self.world_from_mesh.matrix3.determinant() < 0.0
    }
}

impl Scene {
    /// Triangles over all nodes (a mesh that three nodes share counts three times), seams not included.
    #[must_use]
    pub fn triangle_count(&self) -> u64 {
        self.nodes.iter().map(|n| self.meshes[n.mesh].triangle_count()).sum()
    }

    /// World box over the triangles of all nodes for which `keep` holds.
    #[must_use]
    pub fn bounds(&self, keep: impl Fn(&Node) -> bool) -> Bounds {
        let mut bounds = Bounds::EMPTY;
        for node in self.nodes.iter().filter(|n| keep(n)) {
            for primitive in &self.meshes[node.mesh].primitives {
                for &i in primitive.triangles.iter().flatten() {
                    bounds.insert(node.world_point(primitive.positions[i as usize]));
                }
            }
        }
        bounds
    }

    /// The material of a primitive, or glTF's default.
    #[must_use]
    pub fn material(&self, primitive: &Primitive) -> Material {
        primitive.material.map_or_else(Material::default, |m| self.materials[m].clone())
    }
}

impl Mesh {
    /// Triangles over all primitives, seams not included.
    #[must_use]
    pub fn triangle_count(&self) -> u64 {
        self.primitives.iter().map(|p| p.triangles.len() as u64).sum()
    }
}
