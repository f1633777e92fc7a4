//! `antumbra bench csm`.

use std::path::PathBuf;

use antumbra_bake::light_space::Resolution;
use antumbra_scene::procedural::{self, Options};
use anyhow::Result;

use crate::args::{self, RunArgs};
use crate::bench::csm::{self, Comparison};
use crate::bench::report::OutputArgs;
use crate::commands::scene::parse_scale;
use crate::inputs;
use crate::progress::Progress;

/// Measures baked shadows beside cascaded shadow maps on the graphics card: time, and error against traced truth.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  antumbra bench csm --out tables\n  antumbra bench csm delft.glb --frames 4")]
pub struct Args {
    /// The scene to draw: .glb, .gltf or .obj [default: the procedural city]
    scene: Option<PathBuf>,
    /// Size of the procedural city, 0.05 to 4
    #[arg(long, value_name = "S", default_value_t = 1.0, value_parser = parse_scale)]
    scale: f64,
    /// Texels per side and depth slices of the bake
    #[arg(long, value_name = "N", value_parser = args::parse_resolution, default_value = "16384")]
    resolution: Resolution,
    /// Frames along the way
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    frames: u32,
    /// Pixels of a frame [default: 1920x1080, or 640x360 on a software card]
    #[arg(long, value_name = "WxH", value_parser = args::parse_picture_size)]
    size: Option<[u32; 2]>,
    /// Rays per pixel of the truth that stands for whole pixels
    #[arg(long, value_name = "N", default_value_t = 36, value_parser = clap::value_parser!(u32).range(1..=1024))]
    truth: u32,
    #[command(flatten)]
    output: OutputArgs,
    #[command(flatten)]
    run: RunArgs,
}

/// Measures and prints.
pub fn run(args: &Args) -> Result<()> {
    args.output.prepare()?;
    let progress = Progress::new(args.run.quiet);
    progress.stage("preparing the scene");
    let (name, scene) = match &args.scene {
        Some(path) => (inputs::scene_name(path), inputs::scene(path, &[])?),
        None => ("city".to_owned(), procedural::build("city", &Options { scale: args.scale, ..Options::default() })?),
    };
    let comparison = Comparison {
        name,
        scene,
        resolution: args.resolution,
        frames: args.frames as usize,
        size: args.size,
        truth_samples: args.truth,
    };
    let report = args.run.pool()?.install(|| csm::run(comparison, &progress))?;
    drop(progress);
    args.output.publish(&report)
}
