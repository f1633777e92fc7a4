//! A flight through a scene lit by its lamps, on the graphics card: what each step of a frame takes, as in figure 4 of Kämpe,
//! Sintorn, Assarsson 2015.

use std::sync::Arc;

use antumbra::{Filter, ShadowFile};
use antumbra_bake::light_space::Resolution;
use antumbra_bake::{BakeOptions, Encoding, ResolutionRequest, Silent, bake};
use antumbra_render::gpu::{Gpu, GpuRenderer, LampLists, Lookup, Setting};
use antumbra_render::{Renderer, Time};
use antumbra_scene::{Camera, Light, LightKind, Scene};
use anyhow::{Context, Result};
use serde_json::{Value, json};

use super::path;
use super::plot::{AMBER, Axis, BLUE, Curve, GREY, ORANGE, Panel, Plot, file_name};
use super::section::{Column, Row, Section, Shown, row};
use crate::progress::Progress;

/// How to fly.
#[derive(Clone, Copy, Debug)]
pub struct Flight {
    /// Frames.
    pub frames: usize,
    /// Of a frame; `None` for what suits the card.
    pub size: Option<[u32; 2]>,
}

/// What frames are drawn with.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Way {
    name: &'static str,
    taps: u32,
    lists: LampLists,
    top_grid: bool,
}

/// The first is the paper's own.
const WAYS: [Way; 4] = [
    Way { name: "9 x 9 taps, tiled", taps: 9, lists: LampLists::Tiled, top_grid: true },
    Way { name: "1 tap, tiled", taps: 1, lists: LampLists::Tiled, top_grid: true },
    Way { name: "9 x 9 taps, clustered", taps: 9, lists: LampLists::Clustered, top_grid: true },
    Way { name: "9 x 9 taps, no top grid", taps: 9, lists: LampLists::Tiled, top_grid: false },
];

/// Milliseconds of one frame's steps.
#[derive(Clone, Copy, Debug, Default)]
struct Steps {
    boxes: f64,
    lists: f64,
    shadows: f64,
    shading: f64,
    lights_per_pixel: f64,
}

impl Steps {
    fn total(&self) -> f64 {
        self.boxes + self.lists + self.shadows + self.shading
    }
}

const COLUMNS: &[Column<'_>] = &[
    ("way", "", Shown::Plain),
    ("tile boxes", "tile boxes, ms", Shown::Decimal),
    ("light lists", "light lists, ms", Shown::Decimal),
    ("shadows", "shadows, ms", Shown::Decimal),
    ("shading", "shading, ms", Shown::Decimal),
    ("total", "sum, ms", Shown::Decimal),
    ("worst", "worst frame, ms", Shown::Decimal),
    ("lights_per_pixel", "lights per pixel", Shown::Decimal),
];

/// Flies and gives a section, its rows for scripts, a plot of the frames, and the card's name.
pub fn run(
    name: &str,
    scene: Scene,
    resolution: Resolution,
    flight: Flight,
    progress: &Progress,
) -> Result<(Section, Vec<Row>, Plot, String)> {
    progress.stage("opening the graphics card");
    let gpu = Gpu::open()?;
    let size = flight.size.unwrap_or(if gpu.is_software() { [640, 360] } else { [1920, 1080] });
    progress.stage("baking the lamps");
    let lamps: Vec<Light> = scene.lights.iter().filter(|l| l.kind != LightKind::Directional).cloned().collect();
    let options = BakeOptions {
        resolution: ResolutionRequest::Texels(resolution),
        encoding: Some(Encoding::Dag8),
        ..BakeOptions::default()
    };
    let baked = bake(&scene, &lamps, &options, &Silent)?;
    let file = Arc::new(ShadowFile::from_bytes(&baked.bytes)?);
    progress.stage("preparing the scene");
    let scene = Arc::new(scene);
    let rays = Renderer::new(&scene);
    let cameras = path::cameras_among(&scene, &lamps, flight.frames)?;
    let setting = |top_grid| Setting {
        lights: lamps.clone(),
        time: Some(Time::Night),
        bake: Some(Arc::clone(&file)),
        top_grid,
        rays: Some(&rays),
        ..Setting::default()
    };
    let mut renderer = GpuRenderer::new(&gpu, Arc::clone(&scene), setting(true))?;
    let mut measured = Vec::new();
    progress.count("flying", (WAYS.len() * cameras.len()) as u64, "frames");
    for (i, way) in WAYS.iter().enumerate() {
        renderer.relight(setting(way.top_grid))?;
        renderer.lamp_lists = way.lists;
        let filter = Filter::new_box(way.taps)?;
        // The first frame of all makes buffers and warms caches.
        frame(&mut renderer, &cameras[0], size, filter)?;
        let mut frames = Vec::new();
        for camera in &cameras {
            frames.push(frame(&mut renderer, camera, size, filter)?);
            progress.set((i * cameras.len() + frames.len()) as u64, (WAYS.len() * cameras.len()) as u64);
        }
        measured.push(frames);
    }
    let [width, height] = size;
    let about = format!(
        "{} frames of {width} x {height} through {name} with {} lights baked at {}, on {}. Shadows and shading are one pass; shading is that pass with all \
lights visible, shadows the rest of it. Kämpe et al. 2015, figure 4: 165 lights, 1920 x 1080, GTX Titan, 9 x 9 taps: 3.2 ms on average, 9 ms at worst.",
        cameras.len(),
        lamps.len(),
        resolution.texels(),
        gpu.name(),
    );
    let mut section = Section::new("A flight among them", about, COLUMNS);
    section.rows = WAYS.iter().zip(&measured).map(|(way, frames)| mean_row(way, frames)).collect();
    let rows = WAYS.iter().zip(&measured).flat_map(|(way, frames)| {
        frames.iter().enumerate().map(|(i, steps)| frame_row(name, lamps.len(), way, i, steps, size))
    });
    let rows = rows.collect();
    let plot = plot(name, &measured[0])?;
    Ok((section, rows, plot, gpu.name()))
}

/// Draws a frame twice: with shadows, and without, which tells one from the other.
fn frame(renderer: &mut GpuRenderer, camera: &Camera, size: [u32; 2], filter: Filter) -> Result<Steps> {
    renderer.frame(camera, size, 1, Lookup::None, 1.0)?;
    let shading = ms(renderer, "lamps")?;
    renderer.frame(camera, size, 1, Lookup::Filter(filter), 1.0)?;
    let counts = renderer.lamps_per_pixel()?;
    let lamps = ms(renderer, "lamps")?;
    Ok(Steps {
        boxes: ms(renderer, "tile boxes")?,
        lists: ms(renderer, "light lists")?,
        shadows: (lamps - shading).max(0.0),
        shading: shading.min(lamps),
        lights_per_pixel: counts.iter().map(|n| f64::from(*n)).sum::<f64>() / counts.len().max(1) as f64,
    })
}

fn ms(renderer: &GpuRenderer, pass: &str) -> Result<f64> {
    let times = renderer.times()?;
    let of = times.iter().filter(|time| time.name == pass).map(|time| time.ms);
    of.reduce(|a, b| a + b).context("this graphics card has no clock to time passes with")
}

fn mean_row(way: &Way, frames: &[Steps]) -> Row {
    let mean = |of: fn(&Steps) -> f64| frames.iter().map(of).sum::<f64>() / frames.len().max(1) as f64;
    row(json!({
        "way": way.name,
        "tile boxes": mean(|s| s.boxes),
        "light lists": mean(|s| s.lists),
        "shadows": mean(|s| s.shadows),
        "shading": mean(|s| s.shading),
        "total": mean(Steps::total),
        "worst": frames.iter().map(Steps::total).fold(0.0, f64::max),
        "lights_per_pixel": mean(|s| s.lights_per_pixel),
    }))
}

fn frame_row(scene: &str, lights: usize, way: &Way, frame: usize, steps: &Steps, [width, height]: [u32; 2]) -> Row {
    let ms: Value = json!({
        "tile boxes": steps.boxes, "light lists": steps.lists, "shadows": steps.shadows, "shading": steps.shading,
    });
    row(json!({
        "scene": scene, "lights": lights, "way": way.name, "filter": way.taps,
        "lists": if way.lists == LampLists::Tiled { "tiled" } else { "clustered" },
        "top_grid": way.top_grid, "width": width, "height": height, "frame": frame, "ms": ms,
        "lights_per_pixel": steps.lights_per_pixel,
    }))
}

/// Time by step and lights per pixel along the way, as in figure 4.
fn plot(name: &str, frames: &[Steps]) -> Result<Plot> {
    let curve = |name, color, of: fn(&Steps) -> f64| Curve {
        name,
        color,
        points: frames.iter().enumerate().map(|(i, steps)| (i as f64, of(steps).max(1e-3))).collect(),
    };
    let curves = vec![
        curve("shadows", BLUE, |s| s.shadows),
        curve("shading", ORANGE, |s| s.shading),
        curve("light lists", AMBER, |s| s.lists),
        curve("tile boxes", GREY, |s| s.boxes),
    ];
    let lights = curve("", BLUE, |s| s.lights_per_pixel);
    let x = || Axis::ranks("frame", frames.len());
    let y = Axis::logarithmic("ms", &curves.iter().collect::<Vec<_>>());
    let panels = [
        Panel { title: format!("{name}: milliseconds by step"), x: x(), y, curves },
        Panel {
            title: format!("{name}: lights per pixel"),
            x: x(),
            y: Axis::logarithmic("lights", &[&lights]),
            curves: vec![lights],
        },
    ];
    Plot::new(file_name("lamps", name, "flight"), &panels)
}
