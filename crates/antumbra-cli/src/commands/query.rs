//! `antumbra query`: how much of a light reaches given points or segments.

use std::path::{Path, PathBuf};
use std::time::Instant;

use antumbra::{Filter, Kernel, LightShadow, Prefilter, ShadowFile};
use anyhow::{Context, Result, bail};
use clap::ValueEnum;
use glam::DVec3;
use rayon::prelude::*;
use serde_json::json;

use crate::args::{self, FilterArgs, RunArgs};
use crate::output::{self, OutputFile};
use crate::progress::Progress;
use crate::table::count;
use crate::{describe, inputs, lights, npy};

/// Looks up how much of a light reaches given points, or ways between points: 0 = shadowed to 1 = lit.
///
/// Outside the light's volume sideways or before it: lit; behind its last slice: as the last slice; outside a spot light's
/// cone: 0. Points that are not finite are lit. With --to each value is the lit share of the straight way from a point to
/// its end: exact, not sampled.
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
    #[arg(long, value_name = "T.npy", conflicts_with_all = ["normals", "filter", "continuous", "lod", "footprint", "blocker"])]
    to: Option<PathBuf>,
    #[command(flatten)]
    filter: FilterArgs,
    /// Level of detail: the mean over voxels of 2^L to a side; with --prefilter levels, filtered on levels of that
    /// coarseness, blended
    #[arg(long, value_name = "L", value_parser = parse_level, conflicts_with = "footprint")]
    lod: Option<f64>,
    /// Instead of --lod: the width of what a pixel sees, from which the level follows
    #[arg(long, value_name = "METRES", value_parser = args::parse_metres)]
    footprint: Option<f64>,
    /// How --lod and --footprint average
    #[arg(long, value_enum, default_value_t = PrefilterArg::Mean)]
    prefilter: PrefilterArg,
    /// Instead of visibility: bounds on the distance of the surfaces that shadow a point, least and greatest (an array of
    /// shape (n, 2); NaN where nothing does), within so many metres about it across the light. Needs a bake with
    /// --enter-depths
    #[arg(long, value_name = "RADIUS", value_parser = args::parse_metres, conflicts_with_all = ["lod", "footprint", "filter", "continuous", "normals"])]
    blocker: Option<f64>,
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

/// `--prefilter`.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
enum PrefilterArg {
    /// The mean over the node of the graph that holds the point (--filter does not count)
    Mean,
    /// Filtering on the bake's coarse levels; needs a bake with --levels
    Levels,
}

/// A level from 0 to 20.
fn parse_level(text: &str) -> Result<f64, String> {
    let level = text.parse().ok().filter(|level| (0.0..=20.0).contains(level));
    level.ok_or_else(|| "it must be a number from 0 to 20".to_owned())
}

/// What is asked of each point.
#[derive(Clone, Copy)]
enum Question {
    Filtered(Filter),
    Mean(u32),
    Levels(Filter, f64),
    Footprint(f64, Prefilter),
}

impl Question {
    fn new(args: &Args, file: &ShadowFile, light: LightShadow<'_>) -> Result<Self> {
        let filter = args.filter.of_file(1, file)?;
        let by_level = args.lod.is_some() || args.footprint.is_some();
        if args.filter.continuous && by_level {
            bail!("--continuous lookups are of points: leave out --lod and --footprint");
        }
        if by_level && args.prefilter == PrefilterArg::Levels && !light.has_levels() {
            bail!("{} holds no coarse levels; bake it with --levels, or use --prefilter mean", args.file.display());
        }
        Ok(match (args.lod, args.footprint, args.prefilter) {
            (Some(level), _, PrefilterArg::Levels) => Self::Levels(filter, level),
            (Some(level), _, PrefilterArg::Mean) if level.fract() == 0.0 => Self::Mean(level as u32),
            (Some(_), _, PrefilterArg::Mean) => bail!("--lod must be a whole number with --prefilter mean"),
            (None, Some(metres), PrefilterArg::Levels) => Self::Footprint(metres, Prefilter::Levels(filter)),
            (None, Some(metres), PrefilterArg::Mean) => Self::Footprint(metres, Prefilter::Mean),
            (None, None, _) => Self::Filtered(filter),
        })
    }

    fn answer(self, light: LightShadow<'_>, point: DVec3, normal: Option<DVec3>) -> f32 {
        match self {
            Self::Filtered(filter) => light.filtered(point, normal, filter),
            Self::Mean(level) => light.mean_visibility(point, normal, level),
            Self::Levels(filter, level) => light.level_filtered(point, normal, filter, level),
            Self::Footprint(metres, how) => light.prefiltered(point, normal, metres, how),
        }
    }
}

/// Looks up.
pub fn run(args: &Args) -> Result<()> {
    let output = OutputFile::new(&args.output)?;
    let progress = Progress::new(args.run.quiet);
    progress.stage("reading");
    let (file, _) = inputs::shadows(&args.file)?;
    let light = inputs::light(&file, &args.file, &args.light)?;
    let points = read(&args.points)?;
    let normals = read_for_each(args, args.normals.as_deref(), "normals", points.len())?;
    let ends = read_for_each(args, args.to.as_deref(), "ends", points.len())?;
    let what = if ends.is_some() { "ways through the air" } else { "points anywhere" };
    output::warn(&lights::policy_warnings(light, what));
    let pool = args.run.pool()?;
    progress.count("looking up", points.len() as u64, asked(args));
    if let Some(radius_m) = args.blocker {
        return find_blockers(args, light, &points, radius_m, &pool, progress, &output);
    }
    let question = Question::new(args, &file, light)?;
    let start = Instant::now();
    let values = pool.install(|| match &ends {
        Some(ends) => lit_shares(light, &points, ends),
        None => look_up(light, &points, normals.as_deref(), question),
    });
    let seconds = start.elapsed().as_secs_f64();
    progress.stage("writing");
    output.write(&npy::write_values(&values)?)?;
    drop(progress);
    report(args, &values, seconds, pool.current_num_threads())
}

fn find_blockers(
    args: &Args,
    light: LightShadow<'_>,
    points: &[DVec3],
    radius_m: f64,
    pool: &rayon::ThreadPool,
    progress: Progress,
    output: &OutputFile,
) -> Result<()> {
    if !light.has_enter_depths() {
        bail!("{} holds no enter depths, which --blocker needs; bake it with --enter-depths", args.file.display());
    }
    let start = Instant::now();
    let bounds = |point: &DVec3| match light.blocker(*point, radius_m) {
        Some(blocker) => [blocker.least_m as f32, blocker.greatest_m as f32],
        None => [f32::NAN; 2],
    };
    let pairs: Vec<[f32; 2]> = pool.install(|| points.par_iter().map(bounds).collect());
    let seconds = start.elapsed().as_secs_f64();
    progress.stage("writing");
    output.write(&npy::write_pairs(&pairs)?)?;
    drop(progress);
    let blocked: Vec<f32> = pairs.iter().map(|pair| f32::from(pair[0].is_nan())).collect();
    report(args, &blocked, seconds, pool.current_num_threads())
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

fn look_up(light: LightShadow<'_>, points: &[DVec3], normals: Option<&[DVec3]>, question: Question) -> Vec<f32> {
    let mut values = vec![0.0; points.len()];
    values.par_chunks_mut(TASK).zip(points.par_chunks(TASK)).enumerate().for_each(|(task, (values, points))| {
        if let Question::Filtered(filter) = question
            && normals.is_none()
            && filter.taps() == 1
            && filter.kernel() != Kernel::Continuous
        {
            return light.visibility_many(points, values);
        }
        let normals = normals.map(|normals| &normals[task * TASK..]);
        for (i, (value, point)) in values.iter_mut().zip(points).enumerate() {
            *value = question.answer(light, *point, normals.map(|n| n[i]));
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
