//! From a hit to a surface, by glTF 2.0's rules for normals, vertex colours, textures and alpha.

use antumbra_scene::{AlphaMode, Material, Primitive, Scene};
use glam::{DMat3, DVec3, Vec3, Vec4};

use super::{alpha::AlphaMasks, texture::Pyramid};
use crate::trace::{Hit, Ray, Source, Tracer};

/// A surface where a ray meets it, turned towards the ray: the back of a triangle looks like its front.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Surface {
    pub position: DVec3,
    /// Distance along the ray, metres.
    pub distance: f64,
    /// Width of what the ray stands for, metres.
    pub footprint_m: f64,
    /// The triangle's own unit normal.
    pub face_normal: Vec3,
    /// The unit normal for shading: interpolated where the file has normals.
    pub normal: Vec3,
    /// Unit vector back to where the ray came from.
    pub towards_eye: Vec3,
    pub albedo: Vec3,
    pub emissive: Vec3,
    pub metallic: f32,
    pub roughness: f32,
}

/// A scene's materials, ready to look up.
pub(crate) struct Surfaces<'a> {
    scene: &'a Scene,
    /// By image.
    pyramids: Vec<Option<Pyramid>>,
    /// By node: turns mesh-space normals into world space.
    normal_matrices: Vec<DMat3>,
    default_material: Material,
    masks: AlphaMasks<'a>,
    /// Whether no surface is translucent.
    solid: bool,
}

impl<'a> Surfaces<'a> {
    pub(crate) fn new(scene: &'a Scene) -> Self {
        Self {
            scene,
            pyramids: scene.images.iter().map(Pyramid::new).collect(),
            normal_matrices: scene.nodes.iter().map(|n| n.world_from_mesh.matrix3.inverse().transpose()).collect(),
            default_material: Material::default(),
            masks: AlphaMasks::new(scene),
            solid: scene.materials.iter().all(|m| m.alpha_mode != AlphaMode::Blend),
        }
    }

    /// The scene.
    pub(crate) fn scene(&self) -> &'a Scene {
        self.scene
    }

    /// Whether light stops here: opaque and masked surfaces stop it, translucent ones let it through, as in a bake.
    pub(crate) fn casts_shadow(&self, tracer: &Tracer, hit: &Hit) -> bool {
        (self.solid || !self.is_translucent(tracer, hit)) && self.masks.keeps(tracer, hit)
    }

    /// Whether an eye sees something here. `unit` is a number in 0..1: translucent surfaces are there for a share of
    /// such numbers, so that a mean over many samples blends them.
    pub(crate) fn is_seen(&self, tracer: &Tracer, hit: &Hit, unit: impl Fn(&Hit) -> f32) -> bool {
        if self.solid || !self.is_translucent(tracer, hit) {
            return self.masks.keeps(tracer, hit);
        }
        unit(hit) < Corner::new(self, tracer.source(hit.triangle), hit).color(self, 0.0).w
    }

    /// Whether some node moves.
    pub(crate) fn any_moves(&self) -> bool {
        self.scene.nodes.iter().any(|node| node.dynamic)
    }

    /// Whether what is hit moves.
    pub(crate) fn moves(&self, tracer: &Tracer, hit: &Hit) -> bool {
        self.scene.nodes[tracer.source(hit.triangle).node].dynamic
    }

    fn is_translucent(&self, tracer: &Tracer, hit: &Hit) -> bool {
        let primitive = tracer.source(hit.triangle).primitive(self.scene);
        primitive.material.is_some_and(|m| self.scene.materials[m].alpha_mode == AlphaMode::Blend)
    }

    /// The surface at a hit. `footprint_m` is the width of what the ray stands for: how much texture to average.
    pub(crate) fn at(&self, tracer: &Tracer, ray: &Ray, hit: &Hit, footprint_m: f64) -> Surface {
        let corner = Corner::new(self, tracer.source(hit.triangle), hit);
        let triangle = tracer.corners(hit.triangle);
        let level = corner.mip_level(self, &triangle, footprint_m);
        let color = corner.color(self, level);
        let towards_eye = (-ray.direction).normalize();
        let face_normal = facing(tracer.normal(hit.triangle), towards_eye, DVec3::Y);
        let smooth = corner.smooth_normal(self.normal_matrices[corner.source.node], face_normal);
        Surface {
            position: position(&triangle, hit),
            distance: hit.t * ray.direction.length(),
            footprint_m,
            face_normal: face_normal.as_vec3(),
            normal: visible(smooth, towards_eye).as_vec3(),
            towards_eye: towards_eye.as_vec3(),
            albedo: color.truncate().clamp(Vec3::ZERO, Vec3::ONE),
            emissive: Vec3::from(corner.material.emissive),
            metallic: corner.material.metallic.clamp(0.0, 1.0),
            roughness: corner.material.roughness.clamp(0.0, 1.0),
        }
    }
}

/// The point of the triangle rather than of the ray: it lies on the triangle however far away the ray began.
fn position([a, b, c]: &[DVec3; 3], hit: &Hit) -> DVec3 {
    *a + (*b - *a) * hit.u + (*c - *a) * hit.v
}

/// A unit normal on the viewer's side.
fn facing(normal: DVec3, towards_eye: DVec3, or: DVec3) -> DVec3 {
    let normal = normal.try_normalize().unwrap_or(or);
    if normal.dot(towards_eye) < 0.0 { -normal } else { normal }
}

/// Bends a shading normal that looks away from the viewer back to the rim.
fn visible(normal: DVec3, towards_eye: DVec3) -> DVec3 {
    let cos = normal.dot(towards_eye);
    if cos >= 0.01 { normal } else { (normal + towards_eye * (0.01 - cos)).normalize() }
}

/// A hit's place in the scene's own arrays.
struct Corner<'a> {
    source: Source,
    primitive: &'a Primitive,
    material: &'a Material,
    vertices: [usize; 3],
    weights: [f32; 3],
}

impl<'a> Corner<'a> {
    fn new(surfaces: &'a Surfaces<'_>, source: Source, hit: &Hit) -> Self {
        let primitive = source.primitive(surfaces.scene);
        let material = primitive.material.map_or(&surfaces.default_material, |m| &surfaces.scene.materials[m]);
        let weights = [1.0 - hit.u - hit.v, hit.u, hit.v].map(|w| w as f32);
        Self { source, primitive, material, vertices: source.vertices(surfaces.scene), weights }
    }

    /// Interpolates a vertex attribute; `None` where the primitive does not have it.
    fn interpolate<const N: usize>(&self, attribute: &[[f32; N]]) -> Option<[f32; N]> {
        let mut sum = [0.0; N];
        for (vertex, weight) in self.vertices.into_iter().zip(self.weights) {
            let value = attribute.get(vertex)?;
            sum.iter_mut().zip(value).for_each(|(s, v)| *s += v * weight);
        }
        Some(sum)
    }

    /// Linear RGBA: factor, vertex colour and texture multiplied.
    fn color(&self, surfaces: &Surfaces<'_>, level: f32) -> Vec4 {
        let vertex = self.interpolate(&self.primitive.colors).map_or(Vec4::ONE, Vec4::from);
        let texel = self.texture(surfaces).and_then(|(reference, pyramid)| {
            Some(pyramid.sample(reference, self.interpolate(&self.primitive.texcoords)?, level))
        });
        Vec4::from(self.material.base_color) * vertex * texel.unwrap_or(Vec4::ONE)
    }

    fn texture<'s>(&'s self, surfaces: &'s Surfaces<'_>) -> Option<(&'s antumbra_scene::TextureRef, &'s Pyramid)> {
        let reference = self.material.base_color_texture.as_ref()?;
        Some((reference, surfaces.pyramids.get(reference.image)?.as_ref()?))
    }

    /// The mip level whose texels are as large as the footprint.
    fn mip_level(&self, surfaces: &Surfaces<'_>, corners: &[DVec3; 3], footprint_m: f64) -> f32 {
        let Some((reference, pyramid)) = self.texture(surfaces) else { return 0.0 };
        let [Some(a), Some(b), Some(c)] = self.vertices.map(|v| self.primitive.texcoords.get(v)) else {
            return 0.0;
        };
        let [row_u, row_v] = reference.transform;
        let scale = (row_u[0] * row_v[1] - row_u[1] * row_v[0]).abs();
        let uv_area = ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs() * scale;
        let area_m2 = (corners[1] - corners[0]).cross(corners[2] - corners[0]).length();
        let texels_per_m2 = f64::from(uv_area * pyramid.texels()) / area_m2;
        (0.5 * (texels_per_m2 * footprint_m * footprint_m).max(1e-12).log2()) as f32
    }

    /// The interpolated normal in world space, on the same side as the face normal.
    fn smooth_normal(&self, normal_matrix: DMat3, face_normal: DVec3) -> DVec3 {
        let Some(normal) = self.interpolate(&self.primitive.normals) else { return face_normal };
        let world = normal_matrix * Vec3::from(normal).as_dvec3();
        facing(world, face_normal, face_normal)
    }
}
