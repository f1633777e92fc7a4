//! Alpha masks: what of a triangle is there at all.

use antumbra_render::{Hit, Tracer, TriangleId};
use antumbra_scene::{AlphaTest, Scene};

/// The alpha tests of a scene's masked triangles.
pub struct Masks<'a> {
    scene: &'a Scene,
    /// By mesh and primitive.
    tests: Vec<Vec<Option<AlphaTest<'a>>>>,
    /// By [`TriangleId`].
    is_masked: Vec<bool>,
}

impl<'a> Masks<'a> {
    pub fn new(scene: &'a Scene, tracer: &Tracer) -> Self {
        let of_mesh =
            |mesh: &'a antumbra_scene::Mesh| mesh.primitives.iter().map(|p| AlphaTest::new(scene, p)).collect();
        let tests: Vec<Vec<Option<AlphaTest<'a>>>> = scene.meshes.iter().map(of_mesh).collect();
        let is_masked = (0..tracer.triangle_count() as u32).map(|id| {
            let source = tracer.source(TriangleId(id));
            tests[scene.nodes[source.node].mesh][source.primitive].is_some()
        });
        Self { scene, is_masked: is_masked.collect(), tests }
    }

    /// Whether the triangle is there where it was hit.
    pub fn keeps(&self, tracer: &Tracer, hit: &Hit) -> bool {
        !self.is_masked[hit.triangle.0 as usize] || self.test(tracer, hit)
    }

    fn test(&self, tracer: &Tracer, hit: &Hit) -> bool {
        let source = tracer.source(hit.triangle);
        let Some(test) = &self.tests[self.scene.nodes[source.node].mesh][source.primitive] else { return true };
        let primitive = source.primitive(self.scene);
        let vertices = source.vertices(self.scene);
        let mix = |value: &dyn Fn(usize) -> f64| {
            let [a, b, c] = vertices.map(value);
            a + (b - a) * hit.u + (c - a) * hit.v
        };
        let uv = [0, 1].map(|axis| mix(&|v| f64::from(primitive.texcoords[v][axis])));
        let alpha = mix(&|v| primitive.colors.get(v).map_or(1.0, |color| f64::from(color[3])));
        test.keeps(uv, alpha)
    }
}
