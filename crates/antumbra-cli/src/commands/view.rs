//! `antumbra view`: not in this version.

use std::path::PathBuf;

use anyhow::{Result, bail};

/// Opens a scene in an interactive window. Not in this version.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  antumbra view city.glb --shadows city.antumbra")]
pub struct Args {
    /// The scene: .glb, .gltf or .obj
    scene: PathBuf,
    /// A bake of the scene
    #[arg(long, value_name = "FILE")]
    shadows: Option<PathBuf>,
}

/// Says that there is no window yet.
pub fn run(args: &Args) -> Result<()> {
    let scene = args.scene.display();
    let shadows = args.shadows.as_ref().map_or(String::new(), |file| format!(" --shadows {}", file.display()));
    bail!(
        "the interactive window is not in this version; draw a picture with: antumbra render {scene}{shadows} -o picture.png"
    )
}
