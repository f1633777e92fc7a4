//! `antumbra bench`: tables and plots of the papers, and of our own, one file each.

mod ablations;
mod construction;
mod csm;
mod culling;
mod encodings;
mod ivsv;
mod lamps;

use anyhow::{Result, bail};
use clap::Subcommand;

/// Prints the tables of the papers and of our own.
#[derive(clap::Args)]
#[command(
    after_help = "Example:\n  antumbra bench construction --largest 8192 --out tables",
    arg_required_else_help = true,
    subcommand_value_name = "TABLE",
    subcommand_help_heading = "Tables",
    disable_help_subcommand = true
)]
pub struct Args {
    #[command(subcommand)]
    table: Table,
}

#[derive(Subcommand)]
enum Table {
    /// What each of the papers' choices buys, at small resolutions
    Ablations(ablations::Args),
    /// Seconds, memory and bytes of the construction, beside the papers' methods and figures
    Construction(construction::Args),
    /// Baked shadows beside cascaded shadow maps: time on the graphics card, error against traced truth
    Csm(csm::Args),
    /// Shadow maps of many lights: triangles and times with voxel culling, with frusta and without; its ablations
    Culling(culling::Args),
    /// Bytes, time to build and lookups per second of both encodings over resolution
    Encodings(encodings::Args),
    /// Soft shadows in fog: time per step beside the slow ways, error against traced truth
    Ivsv(ivsv::Args),
    /// Seconds and bytes of every spot and point light of a scene, and a flight among them
    Lamps(lamps::Args),
    #[command(external_subcommand)]
    Other(Vec<String>),
}

/// Measures and prints.
pub fn run(args: &Args) -> Result<()> {
    match &args.table {
        Table::Ablations(args) => ablations::run(args),
        Table::Construction(args) => construction::run(args),
        Table::Csm(args) => csm::run(args),
        Table::Culling(args) => culling::run(args),
        Table::Encodings(args) => encodings::run(args),
        Table::Ivsv(args) => ivsv::run(args),
        Table::Lamps(args) => lamps::run(args),
        Table::Other(words) => bail!(
            "the table \"{}\" is not in this version; this one has: ablations, construction, csm, culling, encodings, ivsv, lamps",
            words.first().map_or("", String::as_str)
        ),
    }
}
