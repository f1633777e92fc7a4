//! Alpha masks where rays hit: [`AlphaTest`], the one rule for them, at the hit's place on its triangle.

use antumbra_scene::{AlphaTest, Primitive, Scene};

use crate::trace::{Hit, Tracer};

/// The alpha tests of a scene's masked surfaces, ready for hits of any [`Tracer`] over the scene.
///
/// A comparison traces through it: `tracer.occluded_if(&ray, |hit| masks.keeps(&tracer, hit))`.
pub struct AlphaMasks<'a> {
    scene: &'a Scene,
    /// By mesh and primitive; empty where the scene masks nothing.
    tests: Vec<Vec<Option<AlphaTest<'a>>>>,
}

impl<'a> AlphaMasks<'a> {
    /// Prepares the tests; costs nothing per triangle or texel.
    #[must_use]
    pub fn new(scene: &'a Scene) -> Self {
        let test = |primitive| AlphaTest::new(scene, primitive);
        let tests: Vec<Vec<_>> = scene.meshes.iter().map(|mesh| mesh.primitives.iter().map(test).collect()).collect();
        let masks_nothing = tests.iter().flatten().all(Option::is_none);
        Self { scene, tests: if masks_nothing { Vec::new() } else { tests } }
    }

    /// Whether the surface is there at a hit. Only a mask with a usable texture cuts anything away: opaque surfaces and
    /// translucent ones (alpha mode BLEND) are there everywhere.
    ///
    /// # Panics
    /// When the tracer is not over the scene of these masks, or the hit is not this tracer's.
    #[must_use]
    pub fn keeps(&self, tracer: &Tracer, hit: &Hit) -> bool {
        if self.tests.is_empty() {
            return true;
        }
        let source = tracer.source(hit.triangle);
        let test = &self.tests[self.scene.nodes[source.node].mesh][source.primitive];
        test.as_ref().is_none_or(|test| {
            let primitive = source.primitive(self.scene);
            let corners = Corners { vertices: source.vertices(self.scene), weights: weights(hit) };
            test.keeps(corners.texcoord(primitive), corners.alpha(primitive))
        })
    }
}

/// Weights of a triangle's corners at a hit.
fn weights(hit: &Hit) -> [f64; 3] {
    [1.0 - hit.u - hit.v, hit.u, hit.v]
}

/// Three vertices and their weights.
struct Corners {
    vertices: [usize; 3],
    weights: [f64; 3],
}

impl Corners {
    fn texcoord(&self, primitive: &Primitive) -> [f64; 2] {
        [0, 1].map(|axis| self.mean(|vertex| primitive.texcoords[vertex][axis]))
    }

    /// 1 without vertex colours.
    fn alpha(&self, primitive: &Primitive) -> f64 {
        if primitive.colors.is_empty() {
            return 1.0;
        }
        self.mean(|vertex| primitive.colors.get(vertex).map_or(1.0, |color| color[3]))
    }

    fn mean(&self, value: impl Fn(usize) -> f32) -> f64 {
        let [a, b, c] = self.vertices.map(|vertex| f64::from(value(vertex)));
        let [wa, wb, wc] = self.weights;
        wa * a + wb * b + wc * c
    }
}
