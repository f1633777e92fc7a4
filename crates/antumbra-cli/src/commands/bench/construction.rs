//! `antumbra bench construction`.

use std::path::{Path, PathBuf};

use antumbra::Interior;
use antumbra_bake::light_space::Resolution;
use antumbra_scene::procedural::{self, Options};
use antumbra_scene::{Light, LightKind, Scene};
use anyhow::{Context, Result, bail};

use crate::args::{self, RunArgs};
use crate::bench::child::Workshop;
use crate::bench::construction::{self, Subject, Technique, Wish};
use crate::bench::report::OutputArgs;
use crate::commands::scene::parse_scale;
use crate::inputs::{self, listed};
use crate::progress::Progress;
use crate::table::printable;

/// Measures the construction by every method, beside the figures of Kämpe et al. 2015 (tables 1 to 4).
///
/// Every bake is a process of its own, so that its peak memory is, too.
#[derive(clap::Args)]
#[command(after_help = "Examples:\n  antumbra bench construction --out tables\n  \
                        antumbra bench construction delft.glb --light sun --largest 65536 --methods columns,kampe2015")]
pub struct Args {
    /// The scene to measure: .glb, .gltf or .obj [default: the procedural city and landscape]
    scene: Option<PathBuf>,
    /// The light to measure [default: the first directional one]
    #[arg(long, value_name = "NAME", requires = "scene")]
    light: Option<String>,
    /// Size of the procedural scenes, 0.05 to 4: the number of triangles grows with its square
    #[arg(long, value_name = "S", default_value_t = 1.0, value_parser = parse_scale)]
    scale: f64,
    /// Methods to measure; separate them by commas [default: all]
    #[arg(long, value_name = "NAMES", value_enum, value_delimiter = ',')]
    methods: Vec<Technique>,
    /// Policies to measure (see bake --interior; the papers' methods know open, auto and closed); separate them by commas
    #[arg(long, value_name = "POLICIES", value_delimiter = ',', value_parser = args::parse_interior, default_value = "open,auto")]
    interiors: Vec<Interior>,
    /// First resolution; each further one is twice the last
    #[arg(long, value_name = "N", value_parser = args::parse_resolution, default_value = "4096")]
    smallest: Resolution,
    /// Last resolution
    #[arg(long, value_name = "N", value_parser = args::parse_resolution, default_value = "16384")]
    largest: Resolution,
    /// Last resolution of the papers' methods, which take long and much memory
    #[arg(long, value_name = "N", value_parser = args::parse_resolution, default_value = "8192")]
    largest_baseline: Resolution,
    /// Bake so many times each, and take the quickest
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=100))]
    repeat: u32,
    /// Numbers of threads to compare, of columns alone; separate them by commas
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',', default_value = "1,2", value_parser = clap::value_parser!(u32).range(1..=1024))]
    threads_list: Vec<u32>,
    /// Most memory that a bake may take: 512M, 2G, 1GiB or plain bytes. One that needs more is shown as such
    #[arg(long, value_name = "SIZE", value_parser = args::parse_size)]
    memory_limit: Option<u64>,
    #[command(flatten)]
    output: OutputArgs,
    #[command(flatten)]
    run: RunArgs,
}

/// Measures and prints.
pub fn run(args: &Args) -> Result<()> {
    args.output.prepare()?;
    let progress = Progress::new(args.run.quiet);
    let workshop = Workshop::new()?;
    let subjects = subjects(args, &workshop, &progress)?;
    let report = construction::run(&workshop, &subjects, &wish(args), &progress)?;
    drop(progress);
    args.output.publish(&report)
}

fn wish(args: &Args) -> Wish {
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    Wish {
        techniques: once_each(args.methods.iter().copied(), Technique::all()),
        interiors: once_each(args.interiors.iter().copied(), &[]),
        smallest: args.smallest,
        largest: args.largest,
        largest_baseline: args.largest_baseline,
        threads: args.run.threads.map_or(cores, |threads| threads as usize),
        threads_list: once_each(args.threads_list.iter().map(|threads| *threads as usize), &[]),
        repeat: args.repeat,
        memory_limit: args.memory_limit,
    }
}

/// What was asked for without repetitions, or all of `otherwise` where nothing was.
fn once_each<T: Copy + PartialEq>(asked: impl Iterator<Item = T>, otherwise: &[T]) -> Vec<T> {
    let mut once = Vec::new();
    for thing in asked {
        if !once.contains(&thing) {
            once.push(thing);
        }
    }
    if once.is_empty() { otherwise.to_vec() } else { once }
}

fn subjects(args: &Args, workshop: &Workshop, progress: &Progress) -> Result<Vec<Subject>> {
    if let Some(path) = &args.scene {
        progress.stage("reading the scene");
        return Ok(vec![given(path, &inputs::scene(path, &[])?, args.light.as_deref())?]);
    }
    let procedural = |name: &&str| {
        progress.stage(&format!("generating {name}"));
        let scene = procedural::build(name, &Options { scale: args.scale, ..Options::default() })?;
        let light = sun(&scene).context("the scene has no sun")?.name.clone();
        Ok(Subject { name: (*name).to_owned(), path: workshop.write(name, &scene)?, light })
    };
    ["city", "landscape"].iter().map(procedural).collect()
}

fn sun(scene: &Scene) -> Option<&Light> {
    scene.lights.iter().find(|light| light.kind == LightKind::Directional)
}

fn given(path: &Path, scene: &Scene, light: Option<&str>) -> Result<Subject> {
    let found = match light {
        Some(wanted) => scene.lights.iter().find(|light| light.name == wanted),
        None => sun(scene),
    };
    let Some(found) = found else {
        let names = listed(scene.lights.iter().map(|light| light.name.as_str()));
        match light {
            Some(wanted) => bail!("the scene has no light \"{}\"; it has: {names}", printable(wanted)),
            None => bail!("the scene has no directional light; choose one with --light, of: {names}"),
        }
    };
    Ok(Subject { name: inputs::scene_name(path), path: path.to_owned(), light: found.name.clone() })
}
