//! `antumbra bench lamps`.

use std::path::PathBuf;

use antumbra_bake::light_space::Resolution;
use antumbra_scene::procedural::{self, MAX_LAMPS, Options};
use antumbra_scene::{LightKind, Scene};
use anyhow::{Result, ensure};

use crate::args::{self, RunArgs};
use crate::bench::child::Workshop;
use crate::bench::lamps::{self, Subject};
use crate::bench::report::OutputArgs;
use crate::commands::scene::parse_scale;
use crate::inputs;
use crate::progress::Progress;

/// Measures what every spot and point light of a scene takes, beside figure 3 of Kämpe et al. 2015.
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
    let subject = subject(args, &workshop, &progress)?;
    let report = lamps::run(&workshop, &subject, args.resolution, args.run.threads(), &progress)?;
    drop(progress);
    args.output.publish(&report)
}

fn subject(args: &Args, workshop: &Workshop, progress: &Progress) -> Result<Subject> {
    if let Some(path) = &args.scene {
        progress.stage("reading the scene");
        let lights = lamps_of(&inputs::scene(path, &[])?);
        ensure!(!lights.is_empty(), "the scene has no spot or point light to measure; choose another scene");
        return Ok(Subject { name: inputs::scene_name(path), path: path.clone(), lights });
    }
    progress.stage("generating city");
    let options = Options { scale: args.scale, lamps: args.lamps.unwrap_or(LAMPS), ..Options::default() };
    let scene = procedural::build("city", &options)?;
    Ok(Subject { name: "city".to_owned(), path: workshop.write("city", &scene)?, lights: lamps_of(&scene) })
}

/// Names of a scene's spot and point lights.
fn lamps_of(scene: &Scene) -> Vec<String> {
    let lamps = scene.lights.iter().filter(|light| light.kind != LightKind::Directional);
    lamps.map(|light| light.name.clone()).collect()
}
