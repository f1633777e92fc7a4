//! `antumbra query`: how much of a light reaches given points or segments.

use std::path::{Path, PathBuf};
use std::time::Instant;

use antumbra::{Filter, LightShadow};
use anyhow::{Context, Result, bail};
use glam::DVec3;
use rayon::prelude::*;
use serde_json::json;

use crate::args::{FilterArgs, RunArgs};
use crate::output::{self, OutputFile};
use crate::progress::Progress;
use crate::table::count;
use crate::{describe, inputs, npy};

/// Looks up how much of a light reaches given points, or ways between points: 0 = shadowed to 1 = lit.
///
/// Outside the light's volume sideways or before it: lit; behind its last slice: as the last slice. Points that are not
/// finite are lit. With --to each value is the lit share of the straight way from a point to its end: exact, not sampled.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  antumbra query city.antumbra --light sun --points p.npy -o v.npy")]
pub struct Args {
    /// The shadow file
    file: PathBuf,
    /// Which of its lights
    #[arg(long, value_name = "NAME")]
    light: String,
    /// Points in the world, metres: a float32 or float64 array of shape (n, 3)
    #[arg(long, value_name = "P.npy")]
    points: PathBuf,
    /// Unit normals of the points' surfaces, of the same shape: lookups then move off the surface, just far enough
    #[arg(long, value_name = "N.npy")]
    normals: Option<PathBuf>,
    /// Ends of segments that begin at the points, of the same shape: values then are the segments' lit shares
    ///
    /// A segment of no length, or with an end that is not finite, is as lit as its point. Multiply a share by its segment's
    /// length for the lit length.
    #[arg(long, value_name = "T.npy", conflicts_with_all = ["normals", "filter", "lod"])]
    to: Option<PathBuf>,
    #[command(flatten)]
    filter: FilterArgs,
    /// Level of detail (not in this version)
    #[arg(long, value_name = "L")]
    lod: Option<f64>,
    /// Where to write: a float32 array of shape (n,)
    #[arg(short, long, value_name = "V.npy")]
    output: PathBuf,
    #[command(flatten)]
    run: RunArgs,
    /// Print JSON alone
    #[arg(long)]
    json: bool,
}

/// Points per task: long enough that handing out tasks costs nothing.
const TASK: usize = 4096;

/// Looks up.
pub fn run(args: &Args) -> Result<()> {
    if args.lod.is_some() {
        bail!("--lod is not in this version; leave it out, or use --filter");
    }
    let output = OutputFile::new(&args.output)?;
    let progress = Progress::new(args.run.quiet);
    progress.stage("reading");
    let (file, _) = inputs::shadows(&args.file)?;
    let light = inputs::light(&file, &args.file, &args.light)?;
    let points = read(&args.points)?;
    let normals = read_for_each(args, args.normals.as_deref(), "normals", points.len())?;
    let ends = read_for_each(args, args.to.as_deref(), "ends", points.len())?;
    let pool = args.run.pool()?;
    progress.count("looking up", points.len() as u64, asked(args));
    let filter = args.filter.filter(1)?;
    let start = Instant::now();
    let values = pool.install(|| match &ends {
        Some(ends) => lit_shares(light, &points, ends),
        None => look_up(light, &points, normals.as_deref(), filter),
    });
    let seconds = start.elapsed().as_secs_f64();
    progress.stage("writing");
    output.write(&npy::write_values(&values)?)?;
    drop(progress);
    report(args, &values, seconds, pool.current_num_threads())
}

fn read(path: &Path) -> Result<Vec<DVec3>> {
    npy::read_points(&inputs::file(path)?).with_context(|| format!("{} cannot be used", path.display()))
}

/// What a value is asked for.
fn asked(args: &Args) -> &'static str {
    if args.to.is_some() { "segments" } else { "points" }
}

/// Reads an array that must hold a vector for each point.
fn read_for_each(args: &Args, path: Option<&Path>, what: &str, points: usize) -> Result<Option<Vec<DVec3>>> {
    let Some(path) = path else { return Ok(None) };
    let vectors = read(path)?;
    if vectors.len() != points {
        bail!(
            "{} has {} {what} for the {points} points of {}; give one for each",
            path.display(),
            vectors.len(),
            args.points.display()
        );
    }
    Ok(Some(vectors))
}

fn lit_shares(light: LightShadow<'_>, from: &[DVec3], to: &[DVec3]) -> Vec<f32> {
    from.par_iter().zip(to).with_min_len(TASK / 64).map(|(from, to)| light.lit_share(*from, *to) as f32).collect()
}

fn look_up(light: LightShadow<'_>, points: &[DVec3], normals: Option<&[DVec3]>, filter: Filter) -> Vec<f32> {
    let mut values = vec![0.0; points.len()];
    values.par_chunks_mut(TASK).zip(points.par_chunks(TASK)).enumerate().for_each(|(task, (values, points))| {
        if normals.is_none() && filter.taps() == 1 {
            return light.visibility_many(points, values);
        }
        let normals = normals.map(|normals| &normals[task * TASK..]);
        for (i, (value, point)) in values.iter_mut().zip(points).enumerate() {
            *value = light.filtered(*point, normals.map(|n| n[i]), filter);
        }
    });
    values
}

fn report(args: &Args, values: &[f32], seconds: f64, threads: usize) -> Result<()> {
    let points = values.len() as u64;
    // The clock is finer than any lookup; without points there is no rate.
    let rate = points as f64 / seconds.max(1e-9);
    if args.json {
        return describe::print(&json!({
            (asked(args)): points,
            "lookups_per_second": rate,
            "threads": threads,
            "seconds": seconds,
            "mean_visibility": mean(values),
        }));
    }
    if args.run.quiet {
        return Ok(());
    }
    output::print(&format!(
        "{}: {} {}, {:.1} % lit, {:.2} million lookups/s on {threads} thread(s)\n",
        args.output.display(),
        count(points),
        asked(args),
        100.0 * mean(values).unwrap_or(0.0),
        rate * 1e-6,
    ))
}

/// `None` without values.
fn mean(values: &[f32]) -> Option<f64> {
    let sum: f64 = values.iter().map(|v| f64::from(*v)).sum();
    (!values.is_empty()).then(|| sum / values.len() as f64)
}
