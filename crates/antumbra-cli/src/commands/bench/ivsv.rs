//! `antumbra bench ivsv`.

use std::path::{Path, PathBuf};

use antumbra_scene::procedural::{self, Options};
use anyhow::{Result, ensure};

use crate::area::LightArgs;
use crate::args::{self, RunArgs};
use crate::bench::ivsv::{self, Study};
use crate::bench::report::OutputArgs;
use crate::camera::CameraArgs;
use crate::inputs;
use crate::progress::Progress;

/// Measures soft shadows of area lights in fog on the graphics card: time per step beside the slow ways, cost over
/// resolution, and error against traced truth.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  antumbra bench ivsv --out tables\n  antumbra bench ivsv hairball.glb --fog 0.06")]
pub struct Args {
    /// The scene: .glb, .gltf or .obj [default: the procedural screen]
    scene: Option<PathBuf>,
    #[command(flatten)]
    camera: CameraArgs,
    #[command(flatten)]
    light: LightArgs,
    /// Fog: the share of light that a metre of it takes away
    #[arg(long, value_name = "PER-METRE", default_value_t = 0.03)]
    fog: f64,
    /// Most points of light
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = clap::value_parser!(u32).range(1..=1024))]
    vpls: u32,
    /// Most samples of their shadows along each axis, 32 to 512
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = crate::area::parse_voxels)]
    voxels: u32,
    /// Pixels of a frame [default: 1024x1024, or 256x144 on a software card]
    #[arg(long, value_name = "WxH", value_parser = args::parse_picture_size)]
    size: Option<[u32; 2]>,
    /// Rays per pixel of the truth
    #[arg(long, value_name = "N", default_value_t = 512, value_parser = clap::value_parser!(u32).range(1..=1024))]
    truth: u32,
    /// Draw the figures, too (with --out)
    #[arg(long)]
    figures: bool,
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
        None => ("screen".to_owned(), procedural::build("screen", &Options::default())?),
    };
    let path = args.scene.as_deref().unwrap_or(Path::new("the screen"));
    let camera = args.camera.camera(&scene, path)?;
    let lights = args.light.lights(&scene)?;
    ensure!(!lights.is_empty(), "{} has no area light; describe one with --area-light and --light-at", path.display());
    let study = Study {
        name,
        scene,
        camera,
        lights,
        fog: args.fog,
        most_vpls: args.vpls,
        most_voxels: args.voxels,
        size: args.size,
        truth: args.truth,
        has_figures: args.figures,
    };
    let report = args.run.pool()?.install(|| ivsv::run(study, &progress))?;
    drop(progress);
    args.output.publish(&report)
}
