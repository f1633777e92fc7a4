//! `antumbra bake`: from a scene file to a shadow file.

use std::path::PathBuf;
use std::time::Instant;

use antumbra::{DepthDistribution, Interior};
use antumbra_bake::light_space::Resolution;
use antumbra_bake::{BakeOptions, Baked, Encoding, LightReport, Method, ResolutionRequest};
use anyhow::{Context, Result, bail};
use clap::ValueEnum;
use glam::DVec3;
use serde_json::json;

use crate::args::{self, CasterArgs, RunArgs, SunAngles};
use crate::describe::{self, LightSummary};
use crate::output::{self, OutputFile};
use crate::progress::Progress;
use crate::table::{Table, bytes, count, printable};
use crate::{inputs, lights, memory, processor};

const EXAMPLE: &str = "Example:\n  antumbra bake city.glb -o city.antumbra --sun 135,40 --resolution 16384";

/// Bakes a scene's shadows into a file. The same scene and options give the same bytes, whatever the threads.
#[derive(clap::Args)]
#[command(after_help = EXAMPLE)]
pub struct Args {
    /// The scene: .glb, .gltf or .obj
    scene: PathBuf,
    /// Where to write
    #[arg(short, long, value_name = "FILE.antumbra")]
    output: PathBuf,
    /// A light of the scene to bake; may be repeated [default: all directional, spot and point lights]
    #[arg(long, value_name = "NAME")]
    light: Vec<String>,
    /// Bake a directional light named "sun" too, in degrees: azimuth clockwise from north (-Z) seen from above (+Y),
    /// elevation above the horizon. It replaces a light of that name
    #[arg(long, value_name = "AZIMUTH,ELEVATION", value_parser = args::parse_sun, allow_hyphen_values = true)]
    sun: Option<SunAngles>,
    /// Texels per side and depth slices: a power of two, 64 to 1048576 [default: 16384, of spot and point lights 4096]
    #[arg(long, value_name = "N", value_parser = args::parse_resolution)]
    resolution: Option<Resolution>,
    /// Instead of --resolution: the smallest power of two whose texels are no larger than so many metres (of spot and point
    /// lights: at their range)
    #[arg(long, value_name = "METRES", value_parser = args::parse_metres, conflicts_with = "resolution")]
    texel_size: Option<f64>,
    /// Where the bake may choose freely: auto (inside whatever is closed), open (nowhere), closed (as auto, and warns of
    /// what is open), thickness=METRES (also so far behind open surfaces), static=METRES (also between a ray's first
    /// surface and so far before its second: for receivers on the scene's own surfaces, a filter of K texels wants its
    /// width times the steepest slope)
    #[arg(long, value_name = "POLICY", value_parser = args::parse_interior, default_value = "auto")]
    interior: Interior,
    #[command(flatten)]
    casters: CasterArgs,
    /// Where receivers may be, if larger than the casters' box. Changes nothing for directional lights: they answer
    /// exactly everywhere
    #[arg(long, value_name = "X0,Y0,Z0,X1,Y1,Z1", value_parser = args::parse_bounds, allow_hyphen_values = true)]
    bounds: Option<[DVec3; 2]>,
    /// Spot and point lights ignore casters nearer than this, along a face's axis [default: their range / 1024]
    #[arg(long, value_name = "METRES", value_parser = args::parse_metres)]
    near: Option<f64>,
    /// Add coarse levels to --encoding dag8, for prefiltered lookups (query --prefilter levels, render --prefilter levels);
    /// silhouettes have them anyway
    #[arg(long)]
    levels: bool,
    /// Add coarse enter depths, for blocker lookups (query --blocker)
    #[arg(long)]
    enter_depths: bool,
    /// How the slices of spot and point lights are spread
    #[arg(long, value_enum, default_value_t = DepthArg::Log)]
    depth: DepthArg,
    /// How shadows are stored: silhouette (the casters' edges and planes: many times smaller, and hardly larger with resolution), or
    /// dag8 (the papers' voxel graph) [default: silhouette, dag8 with another --method than columns]
    #[arg(long, value_name = "NAME")]
    encoding: Option<String>,
    /// Store silhouettes as they are looked up, to be mapped into memory, instead of packed: three to five times the bytes
    #[arg(long)]
    unpacked: bool,
    /// Construction method
    #[arg(long, value_enum, default_value_t = MethodArg::Columns)]
    method: MethodArg,
    /// For --method kampe2015: make every node and merge identical ones afterwards, instead of reusing the one in front
    #[arg(long)]
    no_culling: bool,
    /// Most memory that the whole program may take: 512M, 2G, 1GiB or plain bytes
    #[arg(long, value_name = "SIZE", value_parser = args::parse_size)]
    memory_limit: Option<u64>,
    /// Go on with a bake that was cut short (not in this version)
    #[arg(long)]
    resume: bool,
    #[command(flatten)]
    run: RunArgs,
    /// Print JSON alone
    #[arg(long)]
    json: bool,
}

/// `--method`.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
enum MethodArg {
    /// This program's own
    Columns,
    /// As Kämpe et al. 2015: for comparison; open and closed geometry only
    Kampe2015,
    /// As Sintorn et al. 2014: for comparison; open and closed geometry only
    Sintorn2014,
}

/// `--depth`.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
enum DepthArg {
    /// By the logarithm of the distance: a voxel keeps its proportions
    Log,
    /// Evenly in normalized device coordinates, as a plain shadow map has them; for comparison
    Ndc,
}

/// Bakes.
pub fn run(args: &Args) -> Result<()> {
    let start = Instant::now();
    refuse_what_cannot_be(args)?;
    let output = OutputFile::new(&args.output)?;
    let progress = Progress::new(args.run.quiet);
    progress.stage("reading the scene");
    let mut scene = inputs::scene(&args.scene, &args.casters.exclude)?;
    let lights = lights::choose(&mut scene, &args.light, args.sun)?;
    let read_seconds = start.elapsed().as_secs_f64();
    let held = memory::current_bytes().unwrap_or(0);
    let options = options(args, held)?;
    let baked = antumbra_bake::bake(&scene, &lights, &options, &progress).with_context(|| asked_for(args, held))?;
    progress.stage("writing");
    let before_writing = Instant::now();
    output.write(&baked.bytes)?;
    drop(progress);
    output::warn(&baked.warnings);
    let (write, wall) = (before_writing.elapsed().as_secs_f64(), start.elapsed().as_secs_f64());
    report(args, &baked, Seconds { read: read_seconds, write, wall })
}

/// What the command took beside the bake's own stages.
#[derive(Clone, Copy)]
struct Seconds {
    read: f64,
    write: f64,
    /// All in all.
    wall: f64,
}

fn refuse_what_cannot_be(args: &Args) -> Result<()> {
    if args.resume {
        bail!("--resume is not in this version; leave it out to bake from the start");
    }
    if args.no_culling && args.method != MethodArg::Kampe2015 {
        bail!("--no-culling is for --method kampe2015 alone; leave it out");
    }
    if encoding(args)? == Some(Encoding::Dag8) && args.unpacked {
        bail!("--unpacked is for --encoding silhouette alone: dag8 is never packed; leave it out");
    }
    Ok(())
}

fn encoding(args: &Args) -> Result<Option<Encoding>> {
    match args.encoding.as_deref() {
        None => Ok(None),
        Some("dag8") => Ok(Some(Encoding::Dag8)),
        Some("silhouette") => Ok(Some(Encoding::Silhouette)),
        Some(other) => bail!("--encoding \"{other}\" is not in this version; use dag8 or silhouette"),
    }
}

/// `held` is what the program holds already: the scene, above all.
fn options(args: &Args, held: u64) -> Result<BakeOptions> {
    let left_of = |limit: u64| {
        limit.checked_sub(held).filter(|left| *left > 0).with_context(|| {
            format!("the scene alone takes {} of --memory-limit {}; allow more", bytes(held), bytes(limit))
        })
    };
    Ok(BakeOptions {
        encoding: encoding(args)?,
        is_unpacked: args.unpacked,
        method: match args.method {
            MethodArg::Columns => Method::Columns,
            MethodArg::Kampe2015 => Method::Kampe2015,
            MethodArg::Sintorn2014 => Method::Sintorn2014,
        },
        cull_identical: !args.no_culling,
        plain_code: false,
        interior: args.interior,
        resolution: match (args.resolution, args.texel_size) {
            (Some(resolution), _) => ResolutionRequest::Texels(resolution),
            (None, Some(metres)) => ResolutionRequest::TexelSize(metres),
            (None, None) => ResolutionRequest::Default,
        },
        inverted: args.casters.inverted(),
        blend: args.casters.blend(),
        near_m: args.near,
        local_depth: match args.depth {
            DepthArg::Log => DepthDistribution::Logarithmic,
            DepthArg::Ndc => DepthDistribution::Ndc,
        },
        levels: args.levels,
        enter_depths: args.enter_depths,
        threads: args.run.threads(),
        memory_limit: args.memory_limit.map(left_of).transpose()?,
    })
}

/// Names the scene in errors, and the whole limit where the baker knows only what was left of it.
fn asked_for(args: &Args, held: u64) -> String {
    let limit = args.memory_limit.map_or(String::new(), |limit| {
        format!(" (the scene takes {} of --memory-limit {})", bytes(held), bytes(limit))
    });
    format!("cannot bake {}{limit}", args.scene.display())
}

fn report(args: &Args, baked: &Baked, seconds: Seconds) -> Result<()> {
    if args.json {
        return describe::print(&json!({
            "lights": baked.lights.iter().map(|light| summary(light).json()).collect::<Vec<_>>(),
            "file_bytes": baked.bytes.len(),
            "peak_rss_bytes": memory::peak_bytes(),
            "threads": baked.threads,
            "triangles": describe::triangles(&baked.stats),
            "levels_bytes": baked.levels_bytes,
            "stages": describe::stages(&baked.stages),
            "read_seconds": seconds.read,
            "write_seconds": seconds.write,
            "wall_seconds": seconds.wall,
            "cpu_seconds": processor::seconds(),
            "warnings": baked.warnings,
        }));
    }
    if args.run.quiet {
        return Ok(());
    }
    output::print(&summary_table(args, baked, seconds.wall))
}

fn summary(light: &LightReport) -> LightSummary<'_> {
    LightSummary {
        name: &light.name,
        kind: light.kind.name(),
        resolution: light.resolution,
        texel_size_m: light.texel_size_m,
        bytes: light.bytes,
        build_seconds: Some(light.build_seconds),
        stages: Some(&light.stages),
        nodes: light.nodes,
    }
}

/// More lights than this are summed up.
const LIGHTS_IN_FULL: usize = 8;

fn summary_table(args: &Args, baked: &Baked, seconds: f64) -> String {
    let mut text = String::new();
    if baked.lights.len() <= LIGHTS_IN_FULL {
        for light in &baked.lights {
            let heading = format!("{} ({})", printable(&light.name), light.kind.name());
            text += &summary(light).table().row("built in", format!("{:.2} s", light.build_seconds)).text(&heading);
        }
    }
    let mut table = Table::default();
    if baked.lights.len() > LIGHTS_IN_FULL {
        table.row("lights", count(baked.lights.len() as u64));
        let sizes: Vec<u64> = baked.lights.iter().map(|light| light.bytes).collect();
        let largest = sizes.iter().max().copied().unwrap_or(0);
        let mean = sizes.iter().sum::<u64>() / sizes.len() as u64;
        table.row("bytes per light", format!("{} on average, {} at most", bytes(mean), bytes(largest)));
    }
    if baked.levels_bytes > 0 {
        table.row("coarse levels", bytes(baked.levels_bytes));
    }
    table.row("bytes", format!("{} ({})", bytes(baked.bytes.len() as u64), count(baked.bytes.len() as u64)));
    table.row("triangles", describe::triangles_text(&baked.stats));
    table.row("threads", baked.threads.to_string());
    if let Some(peak) = memory::peak_bytes() {
        table.row("peak memory", bytes(peak));
    }
    table.row("all in all", format!("{seconds:.2} s"));
    text + &table.text(&args.output.display().to_string())
}
