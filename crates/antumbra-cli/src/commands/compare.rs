//! `antumbra compare`: a bake against ray tracing.

use std::path::PathBuf;

use anyhow::{Result, bail};

use crate::args::{CasterArgs, RunArgs};
use crate::compare::{Comparison, Wish, compare};
use crate::progress::Progress;
use crate::{describe, inputs, output};

/// Compares a bake with ray tracing in world space, at random points in the air, on surfaces and just off them.
///
/// Every disagreement's distance from a true shadow edge is measured; the comparison fails if one lies farther than a
/// texel and a slice. Where the bake's policy promises nothing (inside solids, behind surfaces) any answer is right. A spot
/// or point light's points lie within its range. Give the same --exclude, --blend and --inverted as for the bake.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  antumbra compare city.antumbra city.glb --samples 1000000")]
pub struct Args {
    /// The shadow file
    file: PathBuf,
    /// The scene that it was baked from
    scene: PathBuf,
    /// Points in the air, and as many on surfaces and off them, for each light
    #[arg(long, value_name = "N", default_value_t = 200_000, value_parser = clap::value_parser!(u64).range(1..=1_000_000_000))]
    samples: u64,
    /// Seed of the points
    #[arg(long, value_name = "S", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    casters: CasterArgs,
    #[command(flatten)]
    run: RunArgs,
    /// Print JSON alone
    #[arg(long)]
    json: bool,
}

/// Compares.
pub fn run(args: &Args) -> Result<()> {
    let progress = Progress::new(args.run.quiet);
    progress.stage("reading");
    let (file, _) = inputs::shadows(&args.file)?;
    let scene = inputs::scene(&args.scene, &args.casters.exclude)?;
    let wish =
        Wish { samples: args.samples, seed: args.seed, blend: args.casters.blend(), inverted: args.casters.inverted() };
    let comparison = args.run.pool()?.install(|| compare(&file, &scene, wish, &progress))?;
    drop(progress);
    if args.json {
        describe::print(&comparison.json())?;
    } else if !args.run.quiet {
        output::print(&comparison.text())?;
    }
    judge(args, &comparison)
}

fn judge(args: &Args, comparison: &Comparison) -> Result<()> {
    let too_far = comparison.total().too_far;
    if too_far > 0 {
        let (file, scene) = (args.file.display(), args.scene.display());
        bail!(
            "{too_far} point(s) disagree farther than one texel and one slice from a shadow's edge: either {file} was baked \
             from something else than {scene} as it is read here (check --exclude, --blend and --inverted), or the bake is wrong"
        );
    }
    Ok(())
}
