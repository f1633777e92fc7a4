//! `antumbra bench`: tables and plots of the papers, and of our own. Of them this version has the ablations.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};

use antumbra_bake::light_space::Resolution;
use antumbra_scene::procedural::{self, Options};
use anyhow::{Context, Result, bail};
use clap::ValueEnum;
use serde_json::{Value, json};

use crate::ablations::{self, Ablation, Section, Subject, Wish};
use crate::args::{self, RunArgs};
use crate::output::{self, OutputFile};
use crate::progress::Progress;
use crate::{describe, inputs, machine};

/// Prints the tables of the papers and of our own. This version has the ablations: what each of the papers' choices buys,
/// at small resolutions.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  antumbra bench ablations --only space,leaves --out plots")]
pub struct Args {
    /// Which table: ablations (construction, encodings, csm, lamps, ivsv and culling come with a later version)
    table: String,
    /// The scene to measure: .glb, .gltf or .obj [default: the procedural city and landscape]
    scene: Option<PathBuf>,
    /// The light to measure [default: the first directional one, and up to eight spot and point lights]
    #[arg(long, value_name = "NAME", requires = "scene")]
    light: Option<String>,
    /// Size of the procedural scenes, 0.05 to 4: the number of triangles grows with its square
    #[arg(long, value_name = "S", default_value_t = 0.3, value_parser = super::scene::parse_scale)]
    scale: f64,
    /// Only these ablations; separate them by commas
    #[arg(long, value_name = "NAMES", value_enum, value_delimiter = ',')]
    only: Vec<Ablation>,
    /// Largest resolution of the growth table; the others end at 1024 or 4096, or here if that is less
    #[arg(long, value_name = "N", value_parser = args::parse_resolution, default_value = "16384")]
    largest: Resolution,
    /// Print JSON alone
    #[arg(long)]
    json: bool,
    /// Folder for ablations.md, ablations.json and the plots; made if it is not there
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    run: RunArgs,
}

/// Measures and prints.
pub fn run(args: &Args) -> Result<()> {
    if args.table != "ablations" {
        bail!(
            "the table \"{}\" is not in this version and comes with a later version; this one has: ablations",
            args.table
        );
    }
    let progress = Progress::new(args.run.quiet);
    let wish = Wish { ablations: wished(&args.only), largest: args.largest };
    let (sections, plots) =
        args.run.pool()?.install(|| ablations::run(&subjects(args, &progress)?, &wish, &progress))?;
    let machine = machine::describe();
    let rows: Vec<&ablations::Row> = sections.iter().flat_map(|section| &section.rows).collect();
    let table = json!({ "table": args.table, "machine": machine, "rows": rows });
    let text = markdown(&sections, &machine);
    if let Some(folder) = &args.out {
        fs::create_dir_all(folder)
            .with_context(|| format!("cannot make the folder {}; choose another with --out", folder.display()))?;
        write(folder, "ablations.md", &text)?;
        write(folder, "ablations.json", &format!("{table:#}\n"))?;
        plots.iter().try_for_each(|plot| write(folder, &plot.file_name, &plot.svg))?;
    }
    drop(progress);
    if args.json { describe::print(&table) } else { output::print(&text) }
}

/// Each once, in their own order.
fn wished(only: &[Ablation]) -> Vec<Ablation> {
    let all = Ablation::value_variants().iter().copied();
    all.filter(|ablation| only.is_empty() || only.contains(ablation)).collect()
}

fn subjects(args: &Args, progress: &Progress) -> Result<Vec<Subject>> {
    let Some(path) = &args.scene else {
        let procedural = |name: &&str| {
            progress.stage(&format!("generating {name}"));
            let scene = procedural::build(name, &Options { scale: args.scale, ..Options::default() })?;
            Subject::procedural(name, scene)
        };
        return ["city", "landscape"].iter().map(procedural).collect();
    };
    progress.stage("reading the scene");
    let scene = inputs::scene(path, &[])?;
    let name = path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    Ok(vec![Subject::given(name, scene, args.light.as_deref())?])
}

fn markdown(sections: &[Section], machine: &Value) -> String {
    let model = machine["model"].as_str().unwrap_or("unknown");
    let mut text = format!("# Ablations of the papers\n\nMachine: {} cores, {model}.\n", machine["cores"]);
    for section in sections {
        // Writing to a string cannot fail.
        let _ = write!(text, "\n{}", section.markdown());
    }
    text
}

fn write(folder: &Path, name: &str, text: &str) -> Result<()> {
    OutputFile::new(&folder.join(name))?.write(text.as_bytes())
}
