//! `antumbra bench csm`: baked shadows beside cascaded shadow maps along a camera's way: time on the graphics card, and error
//! against traced truth. The comparison of Sintorn, Kämpe, Olsson, Assarsson 2014, *Compact precomputed voxelized shadows*.

use std::sync::Arc;

use antumbra::{Filter, Prefilter, ShadowFile};
use antumbra_bake::light_space::Resolution;
use antumbra_bake::{BakeOptions, Encoding, ResolutionRequest, Silent, bake};
use antumbra_render::gpu::{Gpu, GpuRenderer, Lookup, Setting};
use antumbra_render::{Cascades, MapFilter, Picture, RenderOptions, Renderer, ShadowSource, Time};
use antumbra_scene::{Camera, Light, LightKind, Scene};
use anyhow::{Context, Result, ensure};
use plotters::style::RGBColor;
use serde_json::json;

use super::path;
use super::plot::{AMBER, Axis, BLUE, Curve, GREY, ORANGE, Panel, Plot, file_name};
use super::report::{Image, Report};
use super::section::{Column, Row, Section, Shown, row};
use crate::progress::Progress;

/// What to measure.
pub struct Comparison {
    /// The scene's name in tables.
    pub name: String,
    pub scene: Scene,
    pub resolution: Resolution,
    pub frames: usize,
    /// `None` for what suits the card.
    pub size: Option<[u32; 2]>,
    /// Rays per pixel of the truth that prefiltering is held against.
    pub truth_samples: u32,
}

/// A way to have shadows.
struct Technique {
    name: &'static str,
    /// As the first option of `--technique`.
    kind: &'static str,
    filter: &'static str,
    lookup: Lookup,
}

fn techniques() -> Result<Vec<Technique>> {
    let maps = |count| Cascades { count, ..Cascades::default() };
    let taps = |k| Filter::new_box(k);
    let csm = |name, count, filter, by| Technique {
        name,
        kind: "csm",
        filter: by,
        lookup: Lookup::Maps(maps(count), filter),
    };
    let dag = |name, filter, lookup| Technique { name, kind: "dag", filter, lookup };
    let nine = MapFilter::Taps(taps(9)?);
    Ok(vec![
        csm("csm, 2 maps, 2 x 2", 2, MapFilter::Bilinear, "2x2"),
        csm("csm, 4 maps, 2 x 2", 4, MapFilter::Bilinear, "2x2"),
        csm("csm, 8 maps, 2 x 2", 8, MapFilter::Bilinear, "2x2"),
        csm("csm, 2 maps, 9 x 9", 2, nine, "9x9"),
        csm("csm, 4 maps, 9 x 9", 4, nine, "9x9"),
        csm("csm, 8 maps, 9 x 9", 8, nine, "9x9"),
        dag("dag, 1 tap", "1", Lookup::Filter(taps(1)?)),
        dag("dag, 3 x 3", "3x3", Lookup::Filter(taps(3)?)),
        dag("dag, 9 x 9", "9x9", Lookup::Filter(taps(9)?)),
        dag("dag, 17 x 17", "17x17", Lookup::Filter(taps(17)?)),
        dag("dag, mean of the footprint", "mean", Lookup::Prefiltered(Prefilter::Mean)),
        dag("dag, levels, 5 x 5 tent", "levels", Lookup::Prefiltered(Prefilter::Levels(Filter::new_tent(5)?))),
    ])
}

const COLUMNS: &[Column<'_>] = &[
    ("name", "", Shown::Plain),
    ("maps_ms", "drawing maps, ms", Shown::Decimal),
    ("lookup_ms", "lookups, ms", Shown::Decimal),
    ("ms", "sum, ms", Shown::Decimal),
    ("rmse", "error, 1 ray", Shown::Decimal),
    ("rmse_pixel", "error, whole pixels", Shown::Decimal),
    ("bytes", "memory", Shown::Bytes),
];

/// Sums over the frames of one technique.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    maps_ms: f64,
    lookup_ms: f64,
    /// Of squared differences per pixel.
    squares: f64,
    squares_pixel: f64,
    bytes: u64,
}

/// Measures all techniques along the way.
pub fn run(comparison: Comparison, progress: &Progress) -> Result<Report> {
    let Comparison { name, scene, resolution, frames, size, truth_samples } = comparison;
    progress.stage("opening the graphics card");
    let gpu = Gpu::open()?;
    let size = size.unwrap_or(if gpu.is_software() { [640, 360] } else { [1920, 1080] });
    let suns: Vec<Light> = scene.lights.iter().filter(|l| l.kind == LightKind::Directional).take(1).cloned().collect();
    ensure!(!suns.is_empty(), "the scene has no directional light to compare shadows of; choose another scene");
    progress.stage("baking the sun");
    let options = BakeOptions {
        resolution: ResolutionRequest::Texels(resolution),
        levels: true,
        encoding: Some(Encoding::Dag8),
        ..BakeOptions::default()
    };
    let baked = bake(&scene, &suns, &options, &Silent)?;
    let file = Arc::new(ShadowFile::from_bytes(&baked.bytes)?);
    progress.stage("preparing the scene");
    let mut scene = scene;
    scene.lights = suns.clone();
    let scene = Arc::new(scene);
    let rays = Renderer::new(&scene);
    let cameras = path::cameras(&scene, frames)?;
    let setting =
        |bake| Setting { lights: suns.clone(), time: Some(Time::Day), bake, top_grid: true, ..Setting::default() };
    let mut with_bake = GpuRenderer::new(&gpu, Arc::clone(&scene), setting(Some(Arc::clone(&file))))?;
    let mut with_maps = GpuRenderer::new(&gpu, Arc::clone(&scene), setting(None))?;
    let techniques = techniques()?;
    let mut sums = vec![Sums::default(); techniques.len()];
    let mut images = Vec::new();
    progress.count("drawing", cameras.len() as u64, "frames");
    for (i, camera) in cameras.iter().enumerate() {
        let truth = Truth::new(&rays, camera, size, truth_samples)?;
        for (technique, sums) in techniques.iter().zip(&mut sums) {
            let renderer = if technique.kind == "csm" { &mut with_maps } else { &mut with_bake };
            // Caches and maps are there after the first.
            let mut picture = truth.draw(renderer, camera, technique.lookup)?;
            picture = if i == 0 { truth.draw(renderer, camera, technique.lookup)? } else { picture };
            sums.add(renderer, technique, &truth, &picture, &file)?;
            if i == 0 && ["csm, 4 maps, 2 x 2", "dag, 1 tap", "dag, mean of the footprint"].contains(&technique.name) {
                images.push(image(&name, technique, &picture)?);
            }
        }
        if i == 0 {
            let file_name = file_name("csm", &name, "truth").replace(".svg", ".png");
            images.push(Image { file_name, bytes: truth.pixels.to_png()? });
        }
        progress.set(i as u64 + 1, cameras.len() as u64);
    }
    let [width, height] = size;
    let about = format!(
        "{} frames of {width} x {height} along a way through {name}, sun baked at {}, on {}. Maps have 2048 texels to a side. Errors are root mean squares over \
pixels and colours, of 255: against a traced shadow at the same point of each pixel, and against {truth_samples} traced rays through it.",
        cameras.len(),
        resolution.texels(),
        gpu.name(),
    );
    let mut section = Section::new("The sun's shadows", about, COLUMNS);
    section.rows = techniques.iter().zip(&sums).map(|(t, s)| s.row(&name, t, cameras.len(), size)).collect();
    let plot = plot(&name, &techniques, &section.rows)?;
    Ok(Report {
        table: "csm",
        title: "Baked shadows beside cascaded shadow maps",
        rows: section.rows.clone(),
        sections: vec![section],
        summary: Row::new(),
        plots: vec![plot],
        images,
        gpu: Some(gpu.name()),
    })
}

/// What a camera truly sees, by one ray per pixel and by many.
struct Truth {
    points: Picture,
    pixels: Picture,
    options: RenderOptions,
}

impl Truth {
    fn new(rays: &Renderer<'_>, camera: &Camera, [width, height]: [u32; 2], samples: u32) -> Result<Self> {
        let plain = RenderOptions {
            width,
            height,
            samples: 1,
            ao_samples: 0,
            time: Some(Time::Day),
            ..RenderOptions::default()
        };
        let points = rays.render(camera, &plain, ShadowSource::Traced, &|_, _| {})?;
        let options = RenderOptions { exposure: Some(points.exposure()), ..plain };
        let many = RenderOptions { samples, ..options.clone() };
        let pixels = rays.render(camera, &many, ShadowSource::Traced, &|_, _| {})?;
        Ok(Self { points, pixels, options })
    }

    fn draw(&self, renderer: &mut GpuRenderer, camera: &Camera, lookup: Lookup) -> Result<Picture> {
        Ok(renderer.render(camera, &self.options, lookup)?)
    }
}

/// Mean squared difference over pixels and colours.
fn square(a: &Picture, b: &Picture) -> f64 {
    let squares = a.rgb().iter().zip(b.rgb()).map(|(a, b)| (f64::from(*a) - f64::from(*b)).powi(2));
    squares.sum::<f64>() / a.rgb().len().max(1) as f64
}

impl Sums {
    fn add(
        &mut self,
        renderer: &GpuRenderer,
        technique: &Technique,
        truth: &Truth,
        picture: &Picture,
        file: &ShadowFile,
    ) -> Result<()> {
        let times = renderer.times()?;
        ensure!(!times.is_empty(), "this graphics card has no clock to time passes with");
        let of = |pass| times.iter().filter(|time| time.name == pass).map(|time| time.ms).sum::<f64>();
        self.maps_ms += of("shadow maps");
        self.lookup_ms += of("sun shadows");
        self.squares += square(picture, &truth.points);
        self.squares_pixel += square(picture, &truth.pixels);
        self.bytes = match technique.lookup {
            Lookup::Maps(Cascades { count, size, .. }, _) => 4 * u64::from(count) * u64::from(size).pow(2),
            _ => 4 * file.pool().len() as u64,
        };
        Ok(())
    }

    fn row(&self, scene: &str, technique: &Technique, frames: usize, [width, height]: [u32; 2]) -> Row {
        let mean = |sum: f64| sum / frames.max(1) as f64;
        row(json!({
            "scene": scene, "name": technique.name, "technique": technique.kind, "filter": technique.filter,
            "width": width, "height": height, "frames": frames,
            "maps_ms": mean(self.maps_ms), "lookup_ms": mean(self.lookup_ms),
            "ms": mean(self.maps_ms + self.lookup_ms),
            "rmse": mean(self.squares).sqrt(), "rmse_pixel": mean(self.squares_pixel).sqrt(),
            "bytes": self.bytes,
        }))
    }
}

fn image(scene: &str, technique: &Technique, picture: &Picture) -> Result<Image> {
    let what = format!("{}-{}", technique.kind, technique.filter);
    let file_name = file_name("csm", scene, &what).replace(".svg", ".png");
    Ok(Image { file_name, bytes: picture.to_png()? })
}

/// Techniques of one kind: a curve of the plot.
const FAMILIES: [(&str, &str, &[&str], RGBColor); 4] = [
    ("csm 2 x 2", "csm", &["2x2"], AMBER),
    ("csm 9 x 9", "csm", &["9x9"], ORANGE),
    ("dag, taps", "dag", &["1", "3x3", "9x9", "17x17"], BLUE),
    ("dag, means", "dag", &["mean", "levels"], GREY),
];

/// Error over time: a point for each technique.
fn plot(name: &str, techniques: &[Technique], rows: &[Row]) -> Result<Plot> {
    let curve = |(name, kind, filters, color): (&'static str, &str, &[&str], RGBColor), key: &str| {
        let own = techniques.iter().zip(rows).filter(|(t, _)| t.kind == kind && filters.contains(&t.filter));
        let point = |(_, row): (&Technique, &Row)| Some((row["ms"].as_f64()?.max(1e-3), row[key].as_f64()?.max(1e-2)));
        let mut points = own.map(point).collect::<Option<Vec<_>>>().context("a row lacks a figure")?;
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(Curve { name, color, points })
    };
    let panel = |title: &str, key: &str| -> Result<Panel> {
        let curves = FAMILIES.into_iter().map(|family| curve(family, key)).collect::<Result<Vec<Curve>>>()?;
        let all: Vec<&Curve> = curves.iter().collect();
        let turned = swapped(&all);
        let x = Axis::logarithmic("ms", &turned.iter().collect::<Vec<_>>());
        let y = Axis::logarithmic("error", &all);
        Ok(Panel { title: format!("{name}: {title}"), curves: curves.clone(), x, y })
    };
    let panels = [panel("against one traced ray", "rmse")?, panel("against whole pixels", "rmse_pixel")?];
    Plot::new(file_name("csm", name, "error"), &panels)
}

/// Curves with x and y changed over: an axis looks at the second.
fn swapped(curves: &[&Curve]) -> Vec<Curve> {
    let turn =
        |curve: &&Curve| Curve { points: curve.points.iter().map(|(x, y)| (*y, *x)).collect(), ..(*curve).clone() };
    curves.iter().map(turn).collect()
}
