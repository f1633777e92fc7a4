//! The graphics card draws what the CPU's passes draw, within 1/255 but for edge pixels: where a ray that is moved by a hundredth
//! of a pixel, or a shadow's border that is moved by rounding, shows something else.

use std::sync::Arc;

use antumbra::{Encoding, Filter, Prefilter, ShadowFile};
use antumbra_render::area::{
    Airlight, AreaLight, AreaLighting, AreaShape, AreaTechnique, Emission, Gathering, Interpolation, VoxelResolution,
};
use antumbra_render::gpu::{Gpu, GpuRenderer, LampLists, Lookup, Setting};
use antumbra_render::light::LightTracing;
use antumbra_render::{Cascades, Fog, LampMaps, MapFilter, MapProjection, Picture, RenderOptions, Renderer};
use antumbra_render::{ShadowSource, Time, default_camera};
use antumbra_scene::{Camera, Scene};
use antumbra_testbed::{baked, first_lights, gpu, procedural};
use glam::DVec3;

/// A scene with its bake, as both draw it.
struct Stage {
    gpu: Gpu,
    scene: Arc<Scene>,
    file: Arc<ShadowFile>,
}

impl Stage {
    /// With its first lights of each kind, baked.
    fn new(mut scene: Scene, lights: [usize; 3], resolution: u32) -> Self {
        scene.lights = first_lights(&scene, lights);
        let file = Arc::new(baked(&scene, &scene.lights, resolution, Encoding::default()));
        Self { gpu: gpu(), scene: Arc::new(scene), file }
    }

    fn cameras(&self) -> Vec<Camera> {
        let default = default_camera(&self.scene).expect("a camera");
        self.scene.cameras.iter().take(2).cloned().chain([default]).collect()
    }

    /// Draws the same picture on both and compares them.
    fn compare(&self, what: &str, options: &RenderOptions, source: ShadowSource<'_>, lookup: Lookup, lists: LampLists) {
        let bake = source_has_bake(source).then(|| Arc::clone(&self.file));
        let off = compare_in(&self.gpu, &self.scene, (what, &self.cameras()), options, (source, bake), lookup, lists);
        assert!(off < 2e-3, "{what}: exposures differ by {off}");
    }
}

/// Draws the same pictures of a scene on both and compares them. Says how far apart the exposures are that suit them.
fn compare_in(
    gpu: &Gpu,
    scene: &Arc<Scene>,
    (what, cameras): (&str, &[Camera]),
    options: &RenderOptions,
    (source, bake): (ShadowSource<'_>, Option<Arc<ShadowFile>>),
    lookup: Lookup,
    lists: LampLists,
) -> f32 {
    let mut off = 0.0_f32;
    let rays = Renderer::new(scene);
    let setting = Setting {
        lights: scene.lights.clone(),
        time: options.time,
        area: options.area.as_ref().map_or(&[], |area| &area.lights),
        bake,
        has_lamp_maps: options.lamp_maps.is_some(),
        virtual_lights: &options.virtual_lights,
        top_grid: lists == LampLists::Tiled,
        rays: Some(&rays),
    };
    let mut on_card = GpuRenderer::new(gpu, Arc::clone(scene), setting).expect("a renderer");
    on_card.lamp_lists = lists;
    for camera in cameras {
        let by_cpu = rays.render(camera, options, source, &|_, _| {}).expect("a picture");
        // The same exposure: it follows from all pixels, and edges are among them.
        let exposed = RenderOptions { exposure: Some(by_cpu.exposure()), ..options.clone() };
        let by_card = on_card.render(camera, &exposed, lookup).expect("a picture");
        compare(&format!("{what}, camera {}", camera.name), &by_cpu, &by_card);
        let own = on_card.render(camera, options, lookup).expect("a picture");
        off = off.max((own.exposure() / by_cpu.exposure() - 1.0).abs());
    }
    off
}

fn source_has_bake(source: ShadowSource<'_>) -> bool {
    !matches!(source, ShadowSource::None | ShadowSource::Traced | ShadowSource::Maps { .. })
}

/// Largest share of pixels that may lie on edges which rounding moves.
const EDGES: f64 = 0.002;

fn compare(what: &str, a: &Picture, b: &Picture) {
    let differs = |(a, b): (&[u8], &[u8])| a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 1);
    let pixels = a.rgb().chunks(3).zip(b.rgb().chunks(3));
    let off: Vec<usize> = pixels.enumerate().filter(|(_, pair)| differs(*pair)).map(|(i, _)| i).collect();
    let (width, all) = (a.width() as usize, a.rgb().len() / 3);
    for &i in &off {
        let neighbours = [i.wrapping_sub(1), i + 1, i.wrapping_sub(width), i + width];
        // An edge: the pixel lies between two that differ, or the whole is a thin thing that one of them misses.
        let [own, there] = [a, b].map(|picture| &picture.rgb()[3 * i..3 * i + 3]);
        let like = |j: &usize| {
            let beside = |p: &Picture| p.rgb().get(3 * j..3 * j + 3).map(<[u8]>::to_vec).unwrap_or_default();
            beside(a).iter().zip(own).chain(beside(b).iter().zip(there)).any(|(n, c)| n.abs_diff(*c) > 1)
        };
        let at = [i % width, i / width];
        assert!(neighbours.iter().any(like), "{what}: pixel {at:?} of a plain surface differs: {own:?} {there:?}");
    }
    assert!(off.len() as f64 <= EDGES * all as f64, "{what}: {} of {all} pixels differ", off.len());
    println!("{what}: {} of {all} pixels differ by more than 1/255", off.len());
}

fn options(time: Time) -> RenderOptions {
    RenderOptions { width: 240, height: 135, samples: 1, ao_samples: 0, time: Some(time), ..RenderOptions::default() }
}

#[test]
fn daylight_is_the_same_in_every_way() {
    let stage = Stage::new(procedural("village", 0.4), [1, 0, 0], 4096);
    let shadows = &*stage.file;
    let day = options(Time::Day);
    let tent = Filter::new_tent(5).expect("a filter");
    let nine = Filter::new_box(9).expect("a filter");
    let cascades = Cascades { size: 512, ..Cascades::default() };
    let tiled = LampLists::Tiled;
    stage.compare("no shadows", &day, ShadowSource::None, Lookup::None, tiled);
    stage.compare("9 x 9", &day, ShadowSource::Dag { shadows, filter: nine }, Lookup::Filter(nine), tiled);
    for how in [Prefilter::Mean, Prefilter::Levels(tent)] {
        stage.compare("prefiltered", &day, ShadowSource::Prefiltered { shadows, how }, Lookup::Prefiltered(how), tiled);
    }
    let penumbra = ShadowSource::Penumbra { shadows, sun_tangent: 0.02, filter: tent };
    stage.compare("penumbrae", &day, penumbra, Lookup::Penumbra(0.02, tent), tiled);
    for filter in [MapFilter::Bilinear, MapFilter::Taps(tent)] {
        let maps = ShadowSource::Maps { cascades, filter };
        stage.compare("shadow maps", &day, maps, Lookup::Maps(cascades, filter), tiled);
    }
    let fog = RenderOptions { fog: Some(Fog { density_per_m: 0.01, anisotropy: 0.5 }), samples: 3, ..day };
    stage.compare("fog", &fog, ShadowSource::Dag { shadows, filter: tent }, Lookup::Filter(tent), tiled);
}

#[test]
fn night_is_the_same_with_either_lists() {
    let stage = Stage::new(procedural("village", 0.4), [0, 20, 20], 512);
    let shadows = &*stage.file;
    let filter = Filter::new_box(5).expect("a filter");
    for lists in [LampLists::Tiled, LampLists::Clustered] {
        let source = ShadowSource::Dag { shadows, filter };
        stage.compare("night", &options(Time::Night), source, Lookup::Filter(filter), lists);
    }
}

#[test]
fn textures_masks_and_translucent_layers_are_the_same() {
    let stage = Stage::new(procedural("ruins", 0.3), [1, 0, 0], 2048);
    let shadows = &*stage.file;
    let filter = Filter::new_box(3).expect("a filter");
    let source = ShadowSource::Dag { shadows, filter };
    let options = RenderOptions { samples: 2, ..options(Time::Day) };
    stage.compare("ruins", &options, source, Lookup::Filter(filter), LampLists::Tiled);
}

#[test]
fn what_moves_casts_shadows_over_a_bake() {
    let mut scene = procedural("village", 0.3);
    // Every seventh node moves: it is not in the bake.
    scene.nodes.iter_mut().step_by(7).for_each(|node| node.dynamic = true);
    let stage = Stage::new(scene, [1, 0, 0], 2048);
    let shadows = &*stage.file;
    let filter = Filter::new_box(3).expect("a filter");
    let source = ShadowSource::Dag { shadows, filter };
    let day = options(Time::Day);
    stage.compare("movers", &day, source, Lookup::Filter(filter), LampLists::Tiled);
    // And it matters: without them some of the ground is brighter.
    let rays = Renderer::new(&stage.scene);
    let camera = default_camera(&stage.scene).expect("a camera");
    let moving = rays.render(&camera, &day, source, &|_, _| {}).expect("a picture");
    let traced = rays.render(&camera, &day, ShadowSource::Traced, &|_, _| {}).expect("a picture");
    let off = moving.hdr().iter().zip(traced.hdr()).filter(|(a, b)| (a[1] - b[1]).abs() > 0.05).count();
    assert!(off < moving.hdr().len() / 50, "{off} pixels unlike traced shadows");
}

#[test]
fn lamps_maps_are_the_same() {
    let mut scene = procedural("village", 0.2);
    scene.lights = first_lights(&scene, [0, 6, 6]);
    let scene = Arc::new(scene);
    let cameras = scene.cameras[..1].to_vec();
    let tent = Filter::new_tent(5).expect("a filter");
    for (what, maps) in [
        ("cubes", LampMaps::default()),
        ("paraboloids", LampMaps { projection: MapProjection::Paraboloid, ..LampMaps::default() }),
        ("a wide filter", LampMaps { filter: tent, size: 256, ..LampMaps::default() }),
    ] {
        let options = RenderOptions { lamp_maps: Some(maps), ..options(Time::Night) };
        let none = (ShadowSource::None, None);
        let off = compare_in(&gpu(), &scene, (what, &cameras), &options, none, Lookup::None, LampLists::Tiled);
        assert!(off < 2e-3, "{what}: exposures differ by {off}");
    }
}

#[test]
fn virtual_lights_are_the_same() {
    let mut scene = procedural("village", 0.2);
    scene.lights = first_lights(&scene, [0, 6, 6]);
    let scene = Arc::new(scene);
    let rays = Renderer::new(&scene);
    let virtual_lights = rays.virtual_lights(&LightTracing { lights: 40, ..LightTracing::default() }, &[]);
    assert!(virtual_lights.len() >= 40);
    let maps = LampMaps { size: 128, ..LampMaps::default() };
    let options =
        RenderOptions { lamp_maps: Some(maps), virtual_lights, exposure: Some(900.0), ..options(Time::Night) };
    let setting = Setting {
        lights: scene.lights.clone(),
        time: options.time,
        has_lamp_maps: true,
        virtual_lights: &options.virtual_lights,
        rays: Some(&rays),
        ..Setting::default()
    };
    let mut on_card = GpuRenderer::new(&gpu(), Arc::clone(&scene), setting).expect("a renderer");
    let by_cpu = rays.render(&scene.cameras[0], &options, ShadowSource::None, &|_, _| {}).expect("a picture");
    let by_card = on_card.render(&scene.cameras[0], &options, Lookup::None).expect("a picture");
    // Every light's shadows have borders of their own: there are few plain surfaces.
    let pixels = by_cpu.rgb().chunks(3).zip(by_card.rgb().chunks(3));
    let off = pixels.filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 1)).count();
    println!("virtual lights: {off} of {} pixels differ by more than 1/255", by_cpu.rgb().len() / 3);
    assert!(off as f64 <= 2.0 * EDGES * (by_cpu.rgb().len() / 3) as f64, "{off} pixels differ");
    // And they matter.
    let without = RenderOptions { virtual_lights: Vec::new(), ..options };
    let without = rays.render(&scene.cameras[0], &without, ShadowSource::None, &|_, _| {}).expect("a picture");
    let darker = by_cpu.hdr().iter().zip(without.hdr()).filter(|(a, b)| a[1] > 1.05 * b[1]).count();
    assert!(darker > by_cpu.hdr().len() / 20, "{darker} pixels");
}

#[test]
fn what_moves_casts_shadows_over_baked_lamps() {
    let mut scene = procedural("village", 0.3);
    scene.nodes.iter_mut().step_by(2).for_each(|node| node.dynamic = true);
    let stage = Stage::new(scene, [0, 12, 12], 2048);
    let filter = Filter::new_box(3).expect("a filter");
    let source = ShadowSource::Dag { shadows: &stage.file, filter };
    let maps = LampMaps { filter, ..LampMaps::default() };
    let night = RenderOptions { lamp_maps: Some(maps), ..options(Time::Night) };
    stage.compare("movers over baked lamps", &night, source, Lookup::Filter(filter), LampLists::Tiled);
    // And it matters: without them more of the ground is brighter than by rays.
    let rays = Renderer::new(&stage.scene);
    let unlike = |options: &RenderOptions, source| {
        let [own, traced] =
            [(options, source), (&options_of(options), ShadowSource::Traced)].map(|(options, source)| {
                rays.render(&stage.scene.cameras[1], options, source, &|_, _| {}).expect("a picture")
            });
        own.hdr().iter().zip(traced.hdr()).filter(|(a, b)| a[1] > 1.5 * b[1]).count()
    };
    let (with, without) = (unlike(&night, source), unlike(&options_of(&night), source));
    assert!(2 * with < without, "{with} pixels brighter than by rays with maps, {without} without");
}

/// The same without lamps' maps.
fn options_of(options: &RenderOptions) -> RenderOptions {
    RenderOptions { lamp_maps: None, ..options.clone() }
}

#[test]
fn area_lights_are_the_same_in_every_way() {
    let mut scene = procedural("village", 0.2);
    scene.lights.clear();
    let scene = Arc::new(scene);
    let (gpu, middle) = (gpu(), scene.bounds(|_| true).center());
    let image = antumbra_scene::Image {
        name: String::new(),
        width: 2,
        height: 1,
        rgba: [[255, 0, 0, 255], [0, 99, 255, 255]].concat(),
    };
    let light = |shape| {
        let at = middle + DVec3::new(-6.0, 9.0, 4.0);
        let light = AreaLight::towards(shape, at, middle, [2e4; 3]).expect("a light");
        AreaLight { emission: Emission::of_image(&image).map(Arc::new), ..light }
    };
    let screen = light(AreaShape::Rectangle { width_m: 4.0, height_m: 2.0 });
    let base = AreaLighting { vpls: 30, voxels: VoxelResolution::cube(64), ..AreaLighting::new(vec![screen]) };
    let fine = VoxelResolution { phi: 160, theta: 96, ..base.voxels };
    let many =
        [AreaShape::Disc { radius_m: 2.0 }, AreaShape::Sphere { radius_m: 1.0 }, AreaShape::Environment].map(light);
    let of = |change: &dyn Fn(&mut AreaLighting)| {
        let mut how = base.clone();
        change(&mut how);
        how
    };
    for (what, area, fog, samples) in [
        ("clear", of(&|_| {}), None, 1),
        ("fog", of(&|_| {}), Some(0.02), 2),
        ("no shadows", of(&|how| how.technique = AreaTechnique::None), Some(0.02), 1),
        ("one by one", of(&|how| how.technique = AreaTechnique::OneByOne), Some(0.02), 1),
        ("maps", of(&|how| how.technique = AreaTechnique::MarchedMaps), Some(0.02), 1),
        ("bit by bit", of(&|how| how.interpolation = Interpolation::Plain), None, 1),
        ("not interpolated", of(&|how| how.interpolation = Interpolation::None), None, 1),
        ("average", of(&|how| how.airlight = Airlight::Average), Some(0.02), 1),
        ("fine", of(&|how| how.voxels = fine), Some(0.02), 1),
        ("batches", of(&|how| how.budget_bytes = 7 * how.voxels.bytes()), Some(0.02), 2),
        ("interleaved", of(&|how| how.gathering = Gathering::Interleaved), Some(0.02), 1),
        ("half", of(&|how| how.gathering = Gathering::Half), Some(0.02), 1),
        ("disc, sphere, sky", of(&|how| how.lights = many.to_vec()), Some(0.02), 1),
    ] {
        let fog = fog.map(|density_per_m| Fog { density_per_m, anisotropy: 0.3 });
        let options = RenderOptions { area: Some(area), fog, samples, ..options(Time::Night) };
        let seen = (what, &[default_camera(&scene).expect("a camera")][..]);
        let off = compare_in(&gpu, &scene, seen, &options, (ShadowSource::None, None), Lookup::None, LampLists::Tiled);
        // By night a picture is exposed for its brightest places, which are few.
        assert!(off < 0.05, "{what}: exposures differ by {off}");
    }
}
