//! `antumbra rebuild`: not in this version.

use std::path::PathBuf;

use anyhow::{Result, bail};

/// Bakes again after an edit, revisiting only what changed. Not in this version.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  antumbra rebuild city.antumbra old.glb new.glb -o new.antumbra")]
pub struct Args {
    /// The bake of the old scene
    file: PathBuf,
    /// The scene that was baked
    old_scene: PathBuf,
    /// The scene as it is now
    new_scene: PathBuf,
    /// Where to write
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
}

/// Says that there are no partial bakes yet.
pub fn run(args: &Args) -> Result<()> {
    let [file, old, new, output] = [&args.file, &args.old_scene, &args.new_scene, &args.output].map(|p| p.display());
    bail!(
        "partial bakes are not in this version: {file} cannot be carried from {old} to {new}; bake in full with: antumbra bake {new} -o {output}"
    )
}
