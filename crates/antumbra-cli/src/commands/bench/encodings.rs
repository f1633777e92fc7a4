//! `antumbra bench encodings`.

use std::path::PathBuf;

use antumbra::Interior;
use antumbra_bake::light_space::Resolution;
use antumbra_scene::procedural::{self, Options};
use antumbra_scene::{LightKind, Scene};
use anyhow::{Context, Result, bail, ensure};

use crate::args::{self, RunArgs, SunAngles};
use crate::bench::encodings::{self, Study, Subject};
use crate::bench::report::OutputArgs;
use crate::bench::resolutions;
use crate::commands::scene::parse_scale;
use crate::inputs;
use crate::lights::{SUN, directional};
use crate::progress::Progress;

/// Measures bytes, time to build and lookups per second of the encodings dag8 and silhouette over resolution.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  antumbra bench encodings city.glb --sun 135,40 --largest 65536 --out tables")]
pub struct Args {
    /// Scenes to measure: .glb, .gltf or .obj [default: the procedural city and landscape]
    scenes: Vec<PathBuf>,
    /// The sun, in degrees: azimuth clockwise from north, elevation above the horizon [default: the scene's first directional
    /// light]
    #[arg(long, value_name = "AZIMUTH,ELEVATION", value_parser = args::parse_sun, allow_hyphen_values = true)]
    sun: Option<SunAngles>,
    /// Size of the procedural scenes, 0.05 to 4: the number of triangles grows with its square
    #[arg(long, value_name = "S", default_value_t = 0.3, value_parser = parse_scale)]
    scale: f64,
    /// Where bakes may choose freely: see bake --interior
    #[arg(long, value_name = "POLICY", value_parser = args::parse_interior, default_value = "auto")]
    interior: Interior,
    /// Smallest resolution
    #[arg(long, value_name = "N", value_parser = args::parse_resolution, default_value = "4096")]
    smallest: Resolution,
    /// Largest resolution; up to 1048576
    #[arg(long, value_name = "N", value_parser = args::parse_resolution, default_value = "16384")]
    largest: Resolution,
    /// Random points of surfaces to look up
    #[arg(long, value_name = "N", default_value_t = 500_000, value_parser = clap::value_parser!(u64).range(1..=100_000_000))]
    points: u64,
    #[command(flatten)]
    output: OutputArgs,
    #[command(flatten)]
    run: RunArgs,
}

/// Measures and prints.
pub fn run(args: &Args) -> Result<()> {
    ensure!(args.smallest <= args.largest, "--smallest is greater than --largest; give them the other way round");
    args.output.prepare()?;
    let progress = Progress::new(args.run.quiet);
    let study = Study {
        interior: args.interior,
        resolutions: resolutions(args.smallest.texels(), args.largest.texels()).collect(),
        points: args.points,
    };
    let subjects = subjects(args, &progress)?;
    let report = args.run.pool()?.install(|| encodings::run(&subjects, &study, &progress))?;
    drop(progress);
    args.output.publish(&report)
}

fn subjects(args: &Args, progress: &Progress) -> Result<Vec<Subject>> {
    progress.stage("reading scenes");
    let subject = |name: String, scene: Scene| -> Result<Subject> {
        let own = scene.lights.iter().find(|light| light.kind == LightKind::Directional);
        let sun = match (args.sun, own) {
            (None, Some(own)) => own.clone(),
            (Some(angles), _) => directional(SUN, angles.direction_world()),
            (None, None) => bail!("{name} has no directional light; add one with --sun AZIMUTH,ELEVATION"),
        };
        Ok(Subject { name, scene, sun })
    };
    if args.scenes.is_empty() {
        let procedural = |name: &&str| {
            let scene = procedural::build(name, &Options { scale: args.scale, ..Options::default() })?;
            subject((*name).to_owned(), scene)
        };
        return ["city", "landscape"].iter().map(procedural).collect();
    }
    let given = |path: &PathBuf| {
        let scene = inputs::scene(path, &[]).with_context(|| format!("cannot measure {}", path.display()))?;
        subject(inputs::scene_name(path), scene)
    };
    args.scenes.iter().map(given).collect()
}
