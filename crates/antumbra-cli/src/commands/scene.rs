//! `antumbra scene`: writes a procedural scene.

use std::path::PathBuf;

use antumbra_scene::procedural::{self, MAX_LAMPS, NAMES, Options, ProceduralError, SCALE_RANGE};
use antumbra_scene::to_glb;
use anyhow::Result;
use clap::builder::PossibleValuesParser;
use clap::error::ErrorKind;

use crate::output::{self, OutputFile};
use crate::progress::Progress;
use crate::table::{bytes, count};

/// Writes a procedural scene with its lights and cameras as a GLB file. The same name, seed and scale give the same
/// bytes on every machine.
#[derive(clap::Args)]
#[command(after_help = scenes_and_example())]
pub struct Args {
    /// Which scene: see the list below
    #[arg(value_parser = PossibleValuesParser::new(NAMES.iter().map(|(name, _)| *name)), hide_possible_values = true)]
    name: String,
    /// Where to write
    #[arg(short, long, value_name = "FILE.glb")]
    output: PathBuf,
    /// Seed of everything that is left to chance
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Size, 0.05 to 4: the number of triangles grows with its square
    #[arg(long, value_name = "S", default_value_t = 1.0, value_parser = parse_scale)]
    scale: f64,
    /// Spot lights along the streets, for city only; up to 4000
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(..=i64::from(MAX_LAMPS)))]
    lamps: u32,
    /// Show no progress and no summary
    #[arg(long)]
    quiet: bool,
}

fn scenes_and_example() -> String {
    let scenes: String = NAMES.iter().map(|(name, what)| format!("  {name:10} {what}\n")).collect();
    format!("Scenes:\n{scenes}\nExample:\n  antumbra scene city -o city.glb")
}

/// A scale that scenes can have.
pub fn parse_scale(text: &str) -> Result<f64, String> {
    let (least, most) = SCALE_RANGE;
    let scale = text.parse().ok().filter(|scale| (least..=most).contains(scale));
    scale.ok_or_else(|| format!("it must be a number from {least} to {most}"))
}

/// Ends the program as it ends where clap itself finds arguments that do not go together.
fn refuse(error: &ProceduralError) -> ! {
    let command = <Args as clap::Args>::augment_args(clap::Command::new("antumbra scene"));
    command.bin_name("antumbra scene").error(ErrorKind::ArgumentConflict, error).exit()
}

/// Writes.
pub fn run(args: &Args) -> Result<()> {
    let options = Options { seed: args.seed, scale: args.scale, lamps: args.lamps };
    procedural::check(&args.name, &options).unwrap_or_else(|error| refuse(&error));
    let output = OutputFile::new(&args.output)?;
    let progress = Progress::new(args.quiet);
    progress.stage(&format!("generating {}", args.name));
    let scene = procedural::build(&args.name, &options)?;
    progress.stage("writing");
    let glb = to_glb(&scene)?;
    output.write(&glb)?;
    drop(progress);
    if args.quiet {
        return Ok(());
    }
    let (triangles, size) = (count(scene.triangle_count()), bytes(glb.len() as u64));
    output::print(&format!("{}: {triangles} triangles, {size}\n", args.output.display()))
}
