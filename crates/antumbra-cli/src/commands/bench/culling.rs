//! `antumbra bench culling`.

use std::path::PathBuf;

use antumbra_render::MapProjection;
use antumbra_scene::procedural::{self, Options};
use anyhow::Result;

use crate::args::{self, RunArgs};
use crate::bench::culling::{self, Study, Subject};
use crate::bench::report::OutputArgs;
use crate::camera::CameraArgs;
use crate::commands::scene::parse_scale;
use crate::inputs;
use crate::lamp_maps::Projection;
use crate::progress::Progress;

/// Times frames in the light of many lamps and virtual lights, each with a shadow map of its own, and counts the triangles that are drawn
/// into them: without culling, with the light's and the camera's frusta, and with voxels.
#[derive(clap::Args)]
#[command(
    after_help = "Examples:\n  antumbra bench culling --lights 16 --ablations --out tables\n  antumbra bench culling town.glb \
                        --projection cube --counts 16 --counts 64 --counts 256"
)]
pub struct Args {
    /// The scene: .glb, .gltf or .obj [default: door, grille, village, room, flag and cellar, each in turn]
    scene: Option<PathBuf>,
    #[command(flatten)]
    camera: CameraArgs,
    /// Size of the generated scenes
    #[arg(long, value_name = "S", default_value_t = 1.0, value_parser = parse_scale, conflicts_with = "scene")]
    scale: f64,
    /// Kinds of maps; may be given more than once [default: both]
    #[arg(long, value_enum, value_name = "HOW")]
    projection: Vec<Projection>,
    /// Texels per side of each side of a map; may be given more than once
    #[arg(long, value_name = "N", default_values_t = [512], value_parser = clap::value_parser!(u32).range(64..=4096))]
    map: Vec<u32>,
    /// Cells of the grid along each axis, 8 to 128
    #[arg(long, value_name = "N", default_value_t = 32, value_parser = clap::value_parser!(u32).range(8..=128))]
    grid: u32,
    /// Virtual lights of each scene, 1 to 4096
    #[arg(long, value_name = "N", default_value_t = 32, value_parser = clap::value_parser!(u32).range(1..=4096))]
    lights: u32,
    /// How often each frame is drawn: its shortest times count
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=1000))]
    frames: u32,
    /// Measure ways of marking and binning, clusters, grids and batches, too
    #[arg(long)]
    ablations: bool,
    /// Measure frames with so many virtual lights, too; may be given more than once
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    counts: Vec<u32>,
    /// Pixels
    #[arg(long, value_name = "WxH", value_parser = args::parse_picture_size, default_value = "640x360")]
    size: [u32; 2],
    #[command(flatten)]
    output: OutputArgs,
    #[command(flatten)]
    run: RunArgs,
}

/// The scenes of the paper's kinds.
const SCENES: [&str; 6] = ["door", "grille", "village", "room", "flag", "cellar"];

/// Measures and prints.
pub fn run(args: &Args) -> Result<()> {
    args.output.prepare()?;
    let progress = Progress::new(args.run.quiet);
    progress.stage("preparing the scenes");
    let both = [MapProjection::Cube, MapProjection::Paraboloid].to_vec();
    let chosen: Vec<MapProjection> = args.projection.iter().map(|p| p.projection()).collect();
    let study = Study {
        size: args.size,
        projections: if chosen.is_empty() { both } else { chosen },
        maps: args.map.clone(),
        grid: args.grid,
        lights: args.lights,
        frames: args.frames,
        has_ablations: args.ablations,
        counts: args.counts.clone(),
    };
    let report = args.run.pool()?.install(|| culling::run(subjects(args)?, &study, &progress))?;
    drop(progress);
    args.output.publish(&report)
}

fn subjects(args: &Args) -> Result<Vec<Subject>> {
    if let Some(path) = &args.scene {
        let scene = inputs::scene(path, &[])?;
        let camera = args.camera.camera(&scene, path)?;
        return Ok(vec![Subject { name: inputs::scene_name(path), camera, scene }]);
    }
    let options = Options { scale: args.scale, ..Options::default() };
    let subject = |name: &str| {
        let scene = procedural::build(name, &options)?;
        let camera = args.camera.camera(&scene, name.as_ref())?;
        Ok(Subject { name: name.to_owned(), scene, camera })
    };
    SCENES.into_iter().map(subject).collect()
}
