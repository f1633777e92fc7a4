//! `antumbra view`: the interactive window.

use std::fmt::Write;
use std::path::PathBuf;

use antumbra_bake::light_space::Resolution;
use antumbra_viewer::{Script, ViewOptions};
use anyhow::Result;

use crate::{args, inputs, output};

const HELP: &str = "A script has one step per line; # begins a comment:
  wait-bake                 wait for the bake in the background
  set KEY VALUE             technique baked|maps|none, filter K, kernel box|tent, prefilter none|mean|levels,
                            penumbra DEG, cascades N, lists tiled|clustered, time day|night|auto, samples N,
                            fog PER-METRE, sun AZ,EL, scatter G; area lights: area on|off,
                            shape rectangle|disc|sphere|environment, light X,Y,Z, aim X,Y,Z, size W,H, color R,G,B,
                            luminance CD, area-shadows voxels|one-by-one|maps|none, vpls N, voxels N, maps N,
                            alpha N, theta N, phi N, gather full|interleaved|half, airlight exact|average,
                            interpolation none|plain|fast, video SECONDS, moving on|off; lamps:
                            lamp-maps cube|paraboloid|off, map-size N, culling voxels|frusta|none, grid N,
                            virtual-lights N
  frame X,Y,Z X,Y,Z         draw a frame from an eye, looking at a target; metres
  screenshot PATH.png       save the window's picture, with its panel

Example:
  antumbra view city.glb --shadows city.antumbra";

/// Opens a scene in a window: fly about, drag the sun, switch and time its shadows. Files dropped on it are opened.
#[derive(clap::Args)]
#[command(after_help = HELP)]
pub struct Args {
    /// The scene: .glb, .gltf or .obj
    scene: PathBuf,
    /// A bake of the scene [default: its lights are baked in the background]
    #[arg(long, value_name = "FILE")]
    shadows: Option<PathBuf>,
    /// Texels per side of bakes in the background
    #[arg(long, value_name = "N", value_parser = args::parse_resolution, default_value = "4096")]
    resolution: Resolution,
    /// The window's size, pixels
    #[arg(long, value_name = "WxH", value_parser = args::parse_picture_size, default_value = "1280x720")]
    size: [u32; 2],
    /// Replay a camera's way from a file, print the mean times of a frame and its passes, and close
    #[arg(long, value_name = "FILE")]
    script: Option<PathBuf>,
}

/// Opens the window; returns when it is closed.
pub fn run(args: &Args) -> Result<()> {
    let script = match &args.script {
        Some(path) => Some(Script::parse(&String::from_utf8_lossy(&inputs::file(path)?))?),
        None => None,
    };
    let scene = inputs::scene(&args.scene, &[])?;
    let bake = args.shadows.as_ref().map(|path| inputs::shadows(path)).transpose()?.map(|(file, _)| file);
    let has_script = script.is_some();
    let options = ViewOptions { scene, bake, resolution: args.resolution.texels(), size: args.size, script };
    let closed = antumbra_viewer::run(options)?;
    if has_script {
        let mut text = format!("{} frames, {:.1} ms each on average\n", closed.frames, closed.mean_ms);
        for pass in &closed.passes {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{:>10.2} ms  {}", pass.ms, pass.name);
        }
        output::print(&text)?;
    }
    Ok(())
}
