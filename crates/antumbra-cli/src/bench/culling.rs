//! `antumbra bench culling`: what voxel culling saves before many lights' shadow maps are drawn. Selgrad, Müller, Reintges,
//! Stamminger 2016, *Fast shadow map rendering for many-lights settings*: its figures 5 and 6 as a table, its ablations, and frames
//! per second as lights grow.

use std::sync::Arc;

use antumbra_render::culling::Binning;
use antumbra_render::gpu::{Gpu, GpuRenderer, Lookup, PassTime, Setting};
use antumbra_render::light::{LightTracing, VirtualLight};
use antumbra_render::{Clustering, Culling, LampMaps, MapProjection, Marking, RenderOptions, Renderer, Time};
use antumbra_scene::{Camera, LightKind, Scene};
use anyhow::{Result, ensure};
use serde_json::{Value, json};

use super::plot::{AMBER, Axis, BLUE, Curve, GREEN, GREY, ORANGE, Panel, Plot, file_name};
use super::report::{Image, Report};
use super::section::{Column, Row, Section, Shown, row};
use crate::progress::Progress;

/// A scene to measure.
pub struct Subject {
    /// Its name in tables.
    pub name: String,
    pub scene: Scene,
    pub camera: Camera,
}

/// What to measure.
pub struct Study {
    /// Pixels.
    pub size: [u32; 2],
    pub projections: Vec<MapProjection>,
    /// Texels per side of each side of a map.
    pub maps: Vec<u32>,
    /// Cells of the grid along each axis.
    pub grid: u32,
    /// Virtual lights of each scene.
    pub lights: u32,
    /// How often each frame is drawn: its shortest times count.
    pub frames: u32,
    /// Whether to measure the ablations.
    pub has_ablations: bool,
    /// Numbers of virtual lights to measure frames with; may be empty.
    pub counts: Vec<u32>,
}

const FRAMES: &[Column<'_>] = &[
    ("scene", "scene", Shown::Plain),
    ("map", "map", Shown::Plain),
    ("size", "texels", Shown::Count),
    ("technique", "culling", Shown::Plain),
    ("triangles", "triangles per light", Shown::Count),
    ("share", "of all", Shown::Percent),
    ("cull_ms", "culling, ms", Shown::Decimal),
    ("shadow_ms", "maps, ms", Shown::Decimal),
    ("light_ms", "lookups, ms", Shown::Decimal),
    ("shadow_ratio", "maps and culling, times faster", Shown::Decimal),
    ("total_ms", "frame, ms", Shown::Decimal),
    ("total_ratio", "frame, times faster", Shown::Decimal),
    ("pixels_differing", "pixels that differ", Shown::Count),
];

const ABLATIONS: &[Column<'_>] = &[
    ("scene", "scene", Shown::Plain),
    ("what", "what changes", Shown::Plain),
    ("how", "", Shown::Plain),
    ("triangles", "triangles per light", Shown::Count),
    ("bins_ms", "binning, ms", Shown::Decimal),
    ("source_ms", "source cells, ms", Shown::Decimal),
    ("marks_ms", "marking, ms", Shown::Decimal),
    ("lists_ms", "lists, ms", Shown::Decimal),
    ("shadow_ms", "maps, ms", Shown::Decimal),
    ("light_ms", "lookups, ms", Shown::Decimal),
    ("sum_ms", "sum, ms", Shown::Decimal),
];

const COUNTS: &[Column<'_>] = &[
    ("scene", "scene", Shown::Plain),
    ("lights", "lights", Shown::Count),
    ("cull_ms", "culling, ms", Shown::Decimal),
    ("shadow_ms", "maps, ms", Shown::Decimal),
    ("light_ms", "lookups, ms", Shown::Decimal),
    ("total_ms", "frame, ms", Shown::Decimal),
    ("fps", "frames per second", Shown::Decimal),
    ("frustum_ms", "frame with frusta, ms", Shown::Decimal),
];

/// A scene on the card.
struct Stage {
    name: String,
    camera: Camera,
    renderer: GpuRenderer,
    /// Lamps and virtual lights.
    lights: usize,
    options: RenderOptions,
}

/// What a frame took, milliseconds.
#[derive(Clone, Debug)]
struct Frame {
    bins_ms: f64,
    source_ms: f64,
    marks_ms: f64,
    lists_ms: f64,
    cull_ms: f64,
    shadow_ms: f64,
    light_ms: f64,
    total_ms: f64,
    triangles: u64,
    hdr: Vec<[f32; 3]>,
    png: Vec<u8>,
}

/// Ways to cull, by the names of `technique`.
const TECHNIQUES: [(&str, Culling); 3] =
    [("none", Culling::None), ("frustum", Culling::Frusta), ("voxel", Culling::Voxels(Marking::Sides))];

/// Measures everything.
pub fn run(subjects: Vec<Subject>, study: &Study, progress: &Progress) -> Result<Report> {
    for Subject { name, scene, .. } in &subjects {
        let has_lamps = scene.lights.iter().any(|light| light.kind != LightKind::Directional);
        ensure!(has_lamps, "{name} has no spot or point lights, whose shadow maps could be culled");
    }
    progress.stage("opening the graphics card");
    let gpu = Gpu::open()?;
    let [width, height] = study.size;
    let card = gpu.name();
    let mut frames = Section::new(
        "Frames",
        format!(
            "Frames of {width} x {height} in the light of each scene's lamps and {} virtual lights, on {card}. Grid of {} cells per axis. Times are sums \
over all lights; ratios are to light and camera frustum culling. The paper: maps 1.5 to 8.6 times faster, frames 1.1 to 4.2. Binning is left \
out, as there; it is in the next table.",
            study.lights, study.grid
        ),
        FRAMES,
    );
    let mut ablations = Section::new(
        "Ablations",
        format!(
            "Cube maps of {} texels; the sum is of marking, lists, maps and lookups. Marking: the paper steps from cell to cell and marks each with its \
neighbours, or takes slices in parallel (its cells' beams here); ours join boxes of what is seen, for each side of the map.",
            study.maps.first().copied().unwrap_or(512)
        ),
        ABLATIONS,
    );
    let mut counts = Section::new(
        "Lights",
        "Frames with cube maps, voxel culling and more and more virtual lights.".to_owned(),
        COUNTS,
    );
    let (mut images, mut plots) = (Vec::new(), Vec::new());
    let steps = subjects.len() as u64;
    for (i, subject) in subjects.into_iter().enumerate() {
        progress.count(&format!("measuring {}", subject.name), steps, "scenes");
        progress.set(i as u64, steps);
        let scene = Arc::new(night_of(subject.scene));
        let rays = Renderer::new(&scene);
        let traced = |lights| rays.virtual_lights(&LightTracing { lights, ..LightTracing::default() }, &[]);
        let mut stage = Stage::new(&gpu, (&subject.name, &scene, &subject.camera), &rays, traced(study.lights), study)?;
        images.push(stage.measure_frames(study, &mut frames)?);
        if study.has_ablations {
            stage.measure_ablations(study, &mut ablations)?;
        }
        let mut of_counts = Vec::new();
        for &lights in &study.counts {
            let mut own = Stage::new(&gpu, (&subject.name, &scene, &subject.camera), &rays, traced(lights), study)?;
            of_counts.push(own.measure_count(study)?);
        }
        if of_counts.len() > 1 {
            plots.push(plot(&subject.name, &of_counts)?);
        }
        counts.rows.extend(of_counts);
    }
    let sections: Vec<Section> = [frames, ablations, counts].into_iter().filter(|s| !s.rows.is_empty()).collect();
    Ok(Report {
        table: "culling",
        title: "Voxel culling for many lights",
        rows: sections.iter().flat_map(|section| section.rows.clone()).collect(),
        sections,
        summary: Row::new(),
        plots,
        images,
        gpu: Some(card),
    })
}

/// A scene by night.
fn night_of(mut scene: Scene) -> Scene {
    scene.lights.retain(|light| light.kind != LightKind::Directional);
    scene
}

impl Stage {
    fn new(
        gpu: &Gpu,
        (name, scene, camera): (&str, &Arc<Scene>, &Camera),
        rays: &Renderer<'_>,
        virtual_lights: Vec<VirtualLight>,
        study: &Study,
    ) -> Result<Self> {
        let lights = scene.lights.len() + virtual_lights.len();
        let setting = Setting {
            lights: scene.lights.clone(),
            time: Some(Time::Night),
            has_lamp_maps: true,
            virtual_lights: &virtual_lights,
            rays: Some(rays),
            ..Setting::default()
        };
        let renderer = GpuRenderer::new(gpu, Arc::clone(scene), setting)?;
        let [width, height] = study.size;
        let options = RenderOptions {
            width,
            height,
            samples: 1,
            ao_samples: 0,
            time: Some(Time::Night),
            virtual_lights,
            ..RenderOptions::default()
        };
        Ok(Self { name: name.to_owned(), camera: camera.clone(), renderer, lights, options })
    }

    /// Draws a frame a few times; the shortest time of each step counts. The first one makes programs and room.
    fn draw(&mut self, maps: LampMaps, frames: u32) -> Result<Frame> {
        let options = RenderOptions { lamp_maps: Some(maps), ..self.options.clone() };
        let mut best: Option<Frame> = None;
        for i in 0..=frames.max(1) {
            let picture = self.renderer.render(&self.camera, &options, Lookup::None)?;
            if i == 0 {
                continue;
            }
            let times = self.renderer.times()?;
            let triangles = self.renderer.map_triangles()?;
            let own = Frame::new(&times, triangles, picture.hdr().to_vec(), picture.to_png()?);
            best = Some(best.map_or(own.clone(), |known| known.shorter(own)));
        }
        best.ok_or_else(|| anyhow::anyhow!("no frame was drawn"))
    }

    /// None, frusta and voxels for each projection and size; returns the picture.
    fn measure_frames(&mut self, study: &Study, section: &mut Section) -> Result<Image> {
        let mut png = Vec::new();
        for (&projection, &size) in study.projections.iter().flat_map(|p| study.maps.iter().map(move |size| (p, size)))
        {
            let base = LampMaps { projection, size, grid: study.grid, reuse: false, ..LampMaps::default() };
            let mut drawn = Vec::new();
            for (_, culling) in TECHNIQUES {
                drawn.push(self.draw(LampMaps { culling, ..base.clone() }, study.frames)?);
            }
            let [none, frustum, voxel] = &drawn[..] else { continue };
            for ((technique, _), frame) in TECHNIQUES.iter().zip([none, frustum, voxel]) {
                let off = none.hdr.iter().zip(&frame.hdr).filter(|(a, b)| a != b).count();
                section.rows.push(row(json!({
                    "scene": self.name, "map": map_name(projection), "size": size, "technique": technique,
                    "lights": self.lights,
                    "triangles": frame.triangles / self.lights as u64,
                    "share": frame.triangles as f64 / none.triangles.max(1) as f64,
                    "source_ms": frame.source_ms, "marks_ms": frame.marks_ms, "lists_ms": frame.lists_ms,
                    "cull_ms": frame.cull_ms, "shadow_ms": frame.shadow_ms,
                    "light_ms": frame.light_ms, "total_ms": frame.unbinned_ms(),
                    "shadow_ratio": frustum.maps_ms() / frame.maps_ms(),
                    "total_ratio": frustum.unbinned_ms() / frame.unbinned_ms(),
                    "pixels_differing": off,
                })));
            }
            png.clone_from(&voxel.png);
        }
        let file_name = file_name("culling", &self.name, "picture").replace(".svg", ".png");
        Ok(Image { file_name, bytes: png })
    }

    fn measure_ablations(&mut self, study: &Study, section: &mut Section) -> Result<()> {
        let size = study.maps.first().copied().unwrap_or(512);
        let base = LampMaps { size, grid: study.grid, always_bin: true, reuse: false, ..LampMaps::default() };
        let voxels = |marking| LampMaps { culling: Culling::Voxels(marking), ..base.clone() };
        let binned = |binning| LampMaps { binning, ..base.clone() };
        let clustered = |clustering| LampMaps { clustering, ..base.clone() };
        let of_grid = |grid| LampMaps { grid, ..base.clone() };
        let of_levels = LampMaps { grid: 128, binning: Binning::Levels { most_cells: 8 }, ..base.clone() };
        let batches = |batch| LampMaps { batch, ..base.clone() };
        let all = (self.lights as u32).min(64);
        let kept = LampMaps { reuse: true, always_bin: false, batch: all, budget_bytes: 1 << 32, ..base.clone() };
        let ways = [
            ("marking", "step by step, with neighbours", voxels(Marking::Steps)),
            ("marking", "between cells, slices in parallel", voxels(Marking::Cells)),
            ("marking", "between boxes", voxels(Marking::Boxes)),
            ("marking", "between boxes, for each side", base.clone()),
            ("binning", "whole, in every cell", base.clone()),
            ("binning", "cut at the cells' sides", binned(Binning::Clip)),
            ("binning", "whole, unculled beyond 2 cells", binned(Binning::NoCull { most_cells: 2 })),
            ("binning", "whole, in coarser grids beyond 8 cells", binned(Binning::Levels { most_cells: 8 })),
            ("clusters", "none", clustered(Clustering::None)),
            ("clusters", "1 cell", base.clone()),
            ("clusters", "2 x 2 x 2 cells", clustered(Clustering::Cells(2))),
            ("clusters", "4 x 4 x 4 cells", clustered(Clustering::Cells(4))),
            ("grid", "8", of_grid(8)),
            ("grid", "16", of_grid(16)),
            ("grid", "32", of_grid(32)),
            ("grid", "64", of_grid(64)),
            ("grid", "128", of_grid(128)),
            ("grid", "128, and coarser ones beyond 8 cells", of_levels),
            ("lamps at once", "1", batches(1)),
            ("lamps at once", "4", batches(4)),
            ("lamps at once", "16", base.clone()),
            ("still", "maps kept while nothing moves", kept),
        ];
        for (what, how, maps) in ways {
            let frame = self.draw(maps, study.frames)?;
            section.rows.push(row(json!({
                "scene": self.name, "what": what, "how": how, "map": "cube", "size": size, "lights": self.lights,
                "triangles": frame.triangles / self.lights as u64,
                "bins_ms": frame.bins_ms, "source_ms": frame.source_ms, "marks_ms": frame.marks_ms, "lists_ms": frame.lists_ms,
                "shadow_ms": frame.shadow_ms, "light_ms": frame.light_ms,
                "sum_ms": frame.maps_ms() + frame.light_ms,
            })));
        }
        Ok(())
    }

    fn measure_count(&mut self, study: &Study) -> Result<Row> {
        let size = study.maps.first().copied().unwrap_or(512);
        let base = LampMaps { size, grid: study.grid, reuse: false, ..LampMaps::default() };
        let frame = self.draw(base.clone(), study.frames)?;
        let frusta = self.draw(LampMaps { culling: Culling::Frusta, ..base }, study.frames)?;
        Ok(row(json!({
            "scene": self.name, "lights": self.lights, "map": "cube", "size": size,
            "cull_ms": frame.cull_ms, "shadow_ms": frame.shadow_ms, "light_ms": frame.light_ms,
            "total_ms": frame.unbinned_ms(), "fps": 1e3 / frame.unbinned_ms(), "frustum_ms": frusta.unbinned_ms(),
        })))
    }
}

impl Frame {
    fn new(times: &[PassTime], triangles: u64, hdr: Vec<[f32; 3]>, png: Vec<u8>) -> Self {
        let of = |names: &[&str]| times.iter().filter(|t| names.contains(&t.name)).map(|t| t.ms).sum::<f64>();
        Self {
            bins_ms: of(&["bins"]),
            source_ms: of(&["source cells"]),
            marks_ms: of(&["marks"]),
            lists_ms: of(&["survivors"]),
            cull_ms: of(&["source cells", "marks", "survivors"]),
            shadow_ms: of(&["lamp maps"]),
            light_ms: of(&["mapped lamps"]),
            total_ms: times.iter().map(|t| t.ms).sum(),
            triangles,
            hdr,
            png,
        }
    }

    /// Each step as short as in the shorter of two.
    fn shorter(self, other: Self) -> Self {
        Self {
            bins_ms: self.bins_ms.min(other.bins_ms),
            source_ms: self.source_ms.min(other.source_ms),
            marks_ms: self.marks_ms.min(other.marks_ms),
            lists_ms: self.lists_ms.min(other.lists_ms),
            cull_ms: self.cull_ms.min(other.cull_ms),
            shadow_ms: self.shadow_ms.min(other.shadow_ms),
            light_ms: self.light_ms.min(other.light_ms),
            total_ms: self.total_ms.min(other.total_ms),
            ..self
        }
    }

    fn maps_ms(&self) -> f64 {
        self.cull_ms + self.shadow_ms
    }

    fn unbinned_ms(&self) -> f64 {
        self.total_ms - self.bins_ms
    }
}

fn map_name(projection: MapProjection) -> &'static str {
    match projection {
        MapProjection::Cube => "cube",
        MapProjection::Paraboloid => "paraboloid",
    }
}

/// Where the time of a frame goes as lights grow.
fn plot(scene: &str, rows: &[Row]) -> Result<Plot> {
    let of = |key: &str| -> Vec<(f64, f64)> {
        let value = |row: &Row, key: &str| row.get(key).and_then(Value::as_f64).unwrap_or(0.0);
        rows.iter().map(|row| (value(row, "lights"), value(row, key).max(1e-3))).collect()
    };
    let curve = |name, color, key: &str| Curve { name, color, points: of(key) };
    let curves = vec![
        curve("frame with frusta", GREY, "frustum_ms"),
        curve("frame", ORANGE, "total_ms"),
        curve("maps", BLUE, "shadow_ms"),
        curve("lookups", AMBER, "light_ms"),
        curve("culling", GREEN, "cull_ms"),
    ];
    // Axes are fitted to the second coordinate.
    let lights = Curve { points: curves[0].points.iter().map(|p| (0.0, p.0)).collect(), ..curves[0].clone() };
    let x = Axis::logarithmic("lights", &[&lights]);
    let y = Axis::logarithmic("ms", &curves.iter().collect::<Vec<_>>());
    let panel = Panel { title: format!("{scene}: where a frame's time goes"), x, y, curves };
    Plot::new(file_name("culling", scene, "lights"), &[panel])
}
