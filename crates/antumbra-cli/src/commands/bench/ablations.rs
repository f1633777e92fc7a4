//! `antumbra bench ablations`.

use std::path::PathBuf;

use antumbra_bake::light_space::Resolution;
use antumbra_scene::procedural::{self, Options};
use anyhow::Result;
use clap::ValueEnum;

use crate::args::{self, RunArgs};
use crate::bench::ablations::{self, Ablation, Subject, Wish};
use crate::bench::report::OutputArgs;
use crate::commands::scene::parse_scale;
use crate::inputs;
use crate::progress::Progress;

/// Measures what each of the papers' choices buys, at small resolutions.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  antumbra bench ablations --only space,leaves --out plots")]
pub struct Args {
    /// The scene to measure: .glb, .gltf or .obj [default: the procedural city and landscape]
    scene: Option<PathBuf>,
    /// The light to measure [default: the first directional one, and up to eight spot and point lights]
    #[arg(long, value_name = "NAME", requires = "scene")]
    light: Option<String>,
    /// Size of the procedural scenes, 0.05 to 4: the number of triangles grows with its square
    #[arg(long, value_name = "S", default_value_t = 0.3, value_parser = parse_scale)]
    scale: f64,
    /// Only these ablations; separate them by commas
    #[arg(long, value_name = "NAMES", value_enum, value_delimiter = ',')]
    only: Vec<Ablation>,
    /// Largest resolution of the growth table; the others end at 1024 or 4096, or here if that is less
    #[arg(long, value_name = "N", value_parser = args::parse_resolution, default_value = "16384")]
    largest: Resolution,
    #[command(flatten)]
    output: OutputArgs,
    #[command(flatten)]
    run: RunArgs,
}

/// Measures and prints.
pub fn run(args: &Args) -> Result<()> {
    args.output.prepare()?;
    let progress = Progress::new(args.run.quiet);
    let wish = Wish { ablations: wished(&args.only), largest: args.largest };
    let report = args.run.pool()?.install(|| ablations::run(&subjects(args, &progress)?, &wish, &progress))?;
    drop(progress);
    args.output.publish(&report)
}

/// Each once, in their own order.
fn wished(only: &[Ablation]) -> Vec<Ablation> {
    let all = Ablation::value_variants().iter().copied();
    all.filter(|ablation| only.is_empty() || only.contains(ablation)).collect()
}

fn subjects(args: &Args, progress: &Progress) -> Result<Vec<Subject>> {
    let Some(path) = &args.scene else {
        let procedural = |name: &&str| {
            progress.stage(&format!("generating {name}"));
            let scene = procedural::build(name, &Options { scale: args.scale, ..Options::default() })?;
            Subject::procedural(name, scene)
        };
        return ["city", "landscape"].iter().map(procedural).collect();
    };
    progress.stage("reading the scene");
    let scene = inputs::scene(path, &[])?;
    Ok(vec![Subject::given(inputs::scene_name(path), scene, args.light.as_deref())?])
}
