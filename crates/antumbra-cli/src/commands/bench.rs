//! `antumbra bench`: not in this version.

use std::path::PathBuf;

use anyhow::{Result, bail};

/// Prints the tables of the papers and of our own. Not in this version.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  antumbra bench construction --json")]
pub struct Args {
    /// Which table: construction, encodings, csm, lamps, ivsv, culling
    table: String,
    /// Print JSON alone
    #[arg(long)]
    json: bool,
    /// Folder for the plots
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// Says that there are no tables yet.
pub fn run(args: &Args) -> Result<()> {
    let asked_for = if args.json { " as JSON" } else { "" };
    let plots = if args.out.is_some() { " and its plots" } else { "" };
    bail!(
        "the table \"{}\"{asked_for}{plots} is not in this version; measure one scene with: antumbra bake SCENE -o FILE --json",
        args.table
    )
}
