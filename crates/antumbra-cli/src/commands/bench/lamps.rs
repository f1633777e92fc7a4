//! `antumbra bench lamps`.

use std::path::PathBuf;

use antumbra_bake::light_space::Resolution;
use antumbra_scene::procedural::{self, MAX_LAMPS, Options};
use antumbra_scene::{LightKind, Scene};
use anyhow::{Context, Result, ensure};

use crate::args::{self, RunArgs};
use crate::bench::child::Workshop;
use crate::bench::fly::{self, Flight};
use crate::bench::lamps::{self, Subject};
use crate::bench::report::OutputArgs;
use crate::commands::scene::parse_scale;
use crate::inputs;
use crate::progress::Progress;

/// Measures what every spot and point light of a scene takes, and a flight among them, beside figures 3 and 4 of Kämpe et
/// al. 2015.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  antumbra bench lamps --out tables\n  \
                        antumbra bench lamps colosseum.glb --resolution 2048")]
pub struct Args {
    /// The scene to measure: .glb, .gltf or .obj [default: the procedural city with its lamps]
    scene: Option<PathBuf>,
    /// Size of the procedural city, 0.05 to 4: the number of triangles grows with its square
    #[arg(long, value_name = "S", default_value_t = 1.0, value_parser = parse_scale)]
    scale: f64,
    /// Spot lights of the procedural city [default: 165, as in the paper]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_LAMPS)), conflicts_with = "scene")]
    lamps: Option<u32>,
    /// Texels per side and depth slices
    #[arg(long, value_name = "N", value_parser = args::parse_resolution, default_value = "8192")]
    resolution: Resolution,
    /// Frames of a flight among the lamps on the graphics card, as in figure 4; 0 for none
    #[arg(long, value_name = "N", default_value_t = 24, value_parser = clap::value_parser!(u32).range(0..=100_000))]
    frames: u32,
    /// Pixels of a frame [default: 1920x1080, or 640x360 on a software card]
    #[arg(long, value_name = "WxH", value_parser = args::parse_picture_size)]
    size: Option<[u32; 2]>,
    #[command(flatten)]
    output: OutputArgs,
    #[command(flatten)]
    run: RunArgs,
}

/// The lamps of the paper's city.
const LAMPS: u32 = 165;

/// Measures and prints.
pub fn run(args: &Args) -> Result<()> {
    args.output.prepare()?;
    let progress = Progress::new(args.run.quiet);
    let workshop = Workshop::new()?;
    let (subject, scene) = subject(args, &workshop, &progress)?;
    let mut report = lamps::run(&workshop, &subject, args.resolution, args.run.threads(), &progress)?;
    if args.frames > 0 {
        let flight = Flight { frames: args.frames as usize, size: args.size };
        let fly = || fly::run(&subject.name, scene, args.resolution, flight, &progress);
        let (section, rows, plot, gpu) =
            args.run.pool()?.install(fly).context("no flight (--frames 0 leaves it out)")?;
        report.sections.push(section);
        report.rows.extend(rows);
        report.plots.push(plot);
        report.gpu = Some(gpu);
    }
    drop(progress);
    args.output.publish(&report)
}

fn subject(args: &Args, workshop: &Workshop, progress: &Progress) -> Result<(Subject, Scene)> {
    if let Some(path) = &args.scene {
        progress.stage("reading the scene");
        let scene = inputs::scene(path, &[])?;
        let lights = lamps_of(&scene);
        ensure!(!lights.is_empty(), "the scene has no spot or point light to measure; choose another scene");
        return Ok((Subject { name: inputs::scene_name(path), path: path.clone(), lights }, scene));
    }
    progress.stage("generating city");
    let options = Options { scale: args.scale, lamps: args.lamps.unwrap_or(LAMPS), ..Options::default() };
    let scene = procedural::build("city", &options)?;
    let path = workshop.write("city", &scene)?;
    Ok((Subject { name: "city".to_owned(), path, lights: lamps_of(&scene) }, scene))
}

/// Names of a scene's spot and point lights.
fn lamps_of(scene: &Scene) -> Vec<String> {
    let lamps = scene.lights.iter().filter(|light| light.kind != LightKind::Directional);
    lamps.map(|light| light.name.clone()).collect()
}
