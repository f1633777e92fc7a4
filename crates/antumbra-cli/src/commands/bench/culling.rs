//! `antumbra bench culling`.

use std::path::{Path, PathBuf};

use antumbra_scene::procedural::{self, Options};
use anyhow::Result;

use crate::args::{self, RunArgs};
use crate::bench::culling::{self, Study};
use crate::bench::report::OutputArgs;
use crate::camera::CameraArgs;
use crate::inputs;
use crate::progress::Progress;

/// Counts the triangles that are left to draw into each light's shadow map where none are culled, where those outside the light's
/// and the camera's frusta are, and where those are that lie between no light and nothing seen.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  antumbra bench culling --out tables\n  antumbra bench culling town.glb --grid 32")]
pub struct Args {
    /// The scene: .glb, .gltf or .obj [default: the procedural village]
    scene: Option<PathBuf>,
    #[command(flatten)]
    camera: CameraArgs,
    /// Cells along each axis, 8 to 128; may be given more than once
    #[arg(long, value_name = "N", default_values_t = [8, 16, 32, 64, 128], value_parser = clap::value_parser!(u32).range(8..=128))]
    grid: Vec<u32>,
    /// Texels per side of a map's face
    #[arg(long, value_name = "N", default_value_t = 512, value_parser = clap::value_parser!(u32).range(16..=8192))]
    map: u32,
    /// Pixels whose surfaces receive shadows
    #[arg(long, value_name = "WxH", value_parser = args::parse_picture_size, default_value = "640x360")]
    size: [u32; 2],
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
        None => ("village".to_owned(), procedural::build("village", &Options::default())?),
    };
    let camera = args.camera.camera(&scene, args.scene.as_deref().unwrap_or(Path::new("the village")))?;
    let study = Study { name, scene, camera, size: args.size, map: args.map, grids: args.grid.clone() };
    let report = args.run.pool()?.install(|| culling::run(&study, &progress))?;
    drop(progress);
    args.output.publish(&report)
}
