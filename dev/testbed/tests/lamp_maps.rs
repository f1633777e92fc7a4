//! Lamps' shadow maps on the graphics card: whatever is culled, and however, no pixel changes.

use std::sync::Arc;

use antumbra_render::culling::Binning;
use antumbra_render::gpu::{Gpu, GpuRenderer, Lookup, Setting};
use antumbra_render::light::LightTracing;
use antumbra_render::{Clustering, Culling, LampMaps, MapProjection, Marking, Picture, RenderOptions, Renderer, Time};
use antumbra_scene::{Camera, LightKind, Scene};
use antumbra_testbed::{gpu, procedural};

/// A scene by night, in the light of a few of its lamps and of virtual ones.
struct Stage {
    camera: Camera,
    renderer: GpuRenderer,
}

/// What was drawn, and how many triangles into maps.
struct Drawn {
    picture: Picture,
    triangles: u64,
}

impl Stage {
    fn new(gpu: &Gpu, mut scene: Scene, lamps: usize, virtual_lights: u32) -> Self {
        scene.lights.retain(|light| light.kind != LightKind::Directional);
        let step = (scene.lights.len() / lamps).max(1);
        scene.lights = scene.lights.into_iter().step_by(step).take(lamps).collect();
        let scene = Arc::new(scene);
        let how = LightTracing { lights: virtual_lights.max(1), ..LightTracing::default() };
        let mut traced = Renderer::new(&scene).virtual_lights(&how, &[]);
        traced.truncate(virtual_lights as usize);
        let setting = Setting {
            lights: scene.lights.clone(),
            time: Some(Time::Night),
            has_lamp_maps: true,
            virtual_lights: &traced,
            ..Setting::default()
        };
        let renderer = GpuRenderer::new(gpu, Arc::clone(&scene), setting).expect("a renderer");
        Self { camera: scene.cameras[0].clone(), renderer }
    }

    fn draw(&mut self, maps: LampMaps) -> Drawn {
        let options = RenderOptions { lamp_maps: Some(maps), exposure: Some(400.0), ..options() };
        let picture = self.renderer.render(&self.camera, &options, Lookup::None).expect("a picture");
        Drawn { picture, triangles: self.renderer.map_triangles().expect("a count") }
    }

    /// Draws with and without culling: the same pictures. Says how many triangles were drawn of all.
    fn compare(&mut self, what: &str, all: &Drawn, maps: LampMaps) -> f64 {
        let culled = self.draw(maps);
        let off = all.picture.hdr().iter().zip(culled.picture.hdr()).filter(|(a, b)| a != b).count();
        println!("{what}: {} of {} triangles", culled.triangles, all.triangles);
        assert_eq!(off, 0, "{what}: pixels differ");
        culled.triangles as f64 / all.triangles as f64
    }
}

fn options() -> RenderOptions {
    let (width, height) = (160, 90);
    RenderOptions { width, height, samples: 1, ao_samples: 0, time: Some(Time::Night), ..RenderOptions::default() }
}

const PROJECTIONS: [MapProjection; 2] = [MapProjection::Cube, MapProjection::Paraboloid];

#[test]
fn no_way_of_culling_changes_a_pixel() {
    let mut stage = Stage::new(&gpu(), procedural("village", 0.08), 3, 3);
    for projection in PROJECTIONS {
        let most_cells = 8;
        let listed = Binning::NoCull { most_cells: 2 };
        for binning in [Binning::Whole, Binning::Clip, listed, Binning::Levels { most_cells }] {
            let base = LampMaps { projection, binning, size: 256, ..LampMaps::default() };
            let all = stage.draw(LampMaps { culling: Culling::None, ..base.clone() });
            let ways = [
                Culling::Frusta,
                Culling::Voxels(Marking::Sides),
                Culling::Voxels(Marking::Boxes),
                Culling::Voxels(Marking::Cells),
                // Buffers follow what changes.
                Culling::Voxels(Marking::Sides),
            ];
            for culling in ways {
                let what = format!("{projection:?}, {binning:?}, {culling:?}");
                let share = stage.compare(&what, &all, LampMaps { culling, ..base.clone() });
                assert!(binning != Binning::Whole || culling == Culling::Frusta || share < 0.5, "{what}: {share} left");
            }
            // Steps do not know how wide lookups are.
            stage.draw(LampMaps { culling: Culling::Voxels(Marking::Steps), ..base.clone() });
        }
        let base = LampMaps { projection, size: 256, ..LampMaps::default() };
        // Lamps come in the order of their cells, batch by batch, and sums are rounded in that order.
        for base in [
            LampMaps { grid: 8, ..base.clone() },
            LampMaps { grid: 17, ..base.clone() },
            LampMaps { grid: 128, ..base.clone() },
            LampMaps { grid: 100, binning: Binning::Levels { most_cells: 2 }, ..base.clone() },
            LampMaps { batch: 3, ..base.clone() },
            LampMaps { budget_bytes: 1, ..base.clone() },
        ] {
            let all = stage.draw(LampMaps { culling: Culling::None, ..base.clone() });
            stage.compare(&format!("{} cells, batches of {}", base.grid, base.batch), &all, base);
        }
        let all = stage.draw(LampMaps { culling: Culling::None, ..base.clone() });
        for clustering in [Clustering::None, Clustering::Cells(4), Clustering::Cells(8)] {
            stage.compare(&format!("{clustering:?}"), &all, LampMaps { clustering, ..base.clone() });
        }
        stage.compare("sorted anew", &all, LampMaps { always_bin: true, ..base.clone() });
    }
}

#[test]
fn culling_changes_no_pixel_of_any_scene() {
    let gpu = gpu();
    for name in ["door", "grille", "village", "room", "flag", "cellar"] {
        let mut stage = Stage::new(&gpu, procedural(name, 0.1), 1, 3);
        for (projection, size) in
            [(MapProjection::Cube, 256), (MapProjection::Cube, 1024), (MapProjection::Paraboloid, 256)]
        {
            let base = LampMaps { projection, size, ..LampMaps::default() };
            let all = stage.draw(LampMaps { culling: Culling::None, ..base.clone() });
            let what = format!("{name}, {projection:?} of {size}");
            let share = stage.compare(&what, &all, base);
            assert!(share < 0.5, "{what}: {share} of all triangles are left");
        }
    }
}

/// Maps are kept while nothing moves in them, and what moves is seen at once.
#[test]
fn kept_maps_are_those_drawn_anew() {
    let gpu = gpu();
    let mut scene = procedural("village", 0.1);
    scene.lights.retain(|light| light.kind == LightKind::Point);
    scene.lights.truncate(6);
    let lamps = scene.lights.clone();
    // Something small near the first lamp moves, and so does the second lamp.
    let size = |i: &usize| {
        let node = &scene.nodes[*i];
        let mut bounds = antumbra_scene::Bounds::EMPTY;
        let primitives = scene.meshes[node.mesh].primitives.iter();
        primitives.flat_map(|p| &p.positions).for_each(|p| bounds.insert(node.world_point(*p)));
        bounds.diagonal() + (bounds.center() - lamps[0].position_world).length()
    };
    let order = |a: &usize, b: &usize| size(a).total_cmp(&size(b));
    let own = (0..scene.nodes.len()).min_by(order).expect("a node");
    for projection in PROJECTIONS {
        let [mut kept, mut anew] = [(); 2].map(|()| Stage::new(&gpu, scene.clone(), 6, 3));
        let maps = LampMaps { projection, size: 256, adaptive: false, ..LampMaps::default() };
        let without = LampMaps { reuse: false, ..maps.clone() };
        let mut triangles = Vec::new();
        for step in 0..9 {
            for stage in [&mut kept, &mut anew] {
                if step == 2 || step == 4 {
                    let by = glam::DVec3::new(0.2, 0.1, 0.1) * f64::from(step);
                    let moved = glam::DAffine3::from_translation(by) * scene.nodes[own].world_from_mesh;
                    stage.renderer.move_node(own, moved);
                }
                if step == 3 {
                    stage.renderer.move_lamp(&lamps[1].name, lamps[1].position_world + glam::DVec3::Y * 0.05);
                }
                if step == 6 {
                    // Into the first one's cell, and to where its map shows other things.
                    stage.renderer.move_lamp(&lamps[1].name, lamps[0].position_world + glam::DVec3::Y * 0.05);
                }
                if step == 7 {
                    stage.camera = scene.cameras[1].clone();
                }
            }
            let (a, b) = (kept.draw(maps.clone()), anew.draw(without.clone()));
            let off = a.picture.hdr().iter().zip(b.picture.hdr()).filter(|(a, b)| a != b).count();
            println!("{projection:?}, step {step}: {} of {} triangles drawn", a.triangles, b.triangles);
            assert_eq!(off, 0, "{projection:?}, step {step}");
            triangles.push((a.triangles, b.triangles));
        }
        // All at first, then none, then some.
        assert_eq!(triangles[0].0, triangles[0].1);
        assert_eq!([1, 5, 8].map(|i| triangles[i].0), [0; 3]);
        assert!([2, 3, 4].iter().all(|i| triangles[*i].0 > 0 && triangles[*i].0 < triangles[*i].1), "{triangles:?}");
    }
}
