//! `antumbra validate`: checks a shadow file in full.

use std::path::PathBuf;

use antumbra::Encoding;
use antumbra::format::canonical;
use anyhow::{Context, Result};

use crate::table::{bytes, count};
use crate::{inputs, output};

/// Checks a shadow file in full: checksums, ranges, no cycles, canonical order.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  antumbra validate city.antumbra")]
pub struct Args {
    /// The shadow file
    file: PathBuf,
}

/// Checks.
pub fn run(args: &Args) -> Result<()> {
    let (file, file_bytes) = inputs::shadows(&args.file)?;
    let shown = args.file.display();
    canonical::check(&file).with_context(|| shown.to_string())?;
    let nodes = file.node_counts();
    let (leaves, name) = match file.encoding() {
        Encoding::Silhouette => (nodes.cuts, "cuts"),
        Encoding::Dag8 => (nodes.slices, "slice nodes"),
    };
    output::print(&format!(
        "ok: {shown}: {} light(s), {} inner nodes, {} {name}, {} masks, {}\n",
        file.lights().len(),
        count(nodes.inner),
        count(leaves),
        count(nodes.masks),
        bytes(file_bytes),
    ))
}
