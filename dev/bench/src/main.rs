//! Lookups per second on one thread, beside shadow rays on the same points: all figures from one run.
//!
//! *points* is many at a time, the other columns one after the other. Points lie near surfaces, where lookups descend deepest. *Random* takes them in shuffled order, *coherent* in a
//! picture's scan order. Each figure is the best of several passes, so that other work on the machine weighs less.
//!
//! `--segments` measures segments from the camera to those points instead, beside marching; `--step-ms` measures rebuilds
//! that are spread over frames.

mod prefilter;
mod segments;
mod stepped;

use std::path::PathBuf;
use std::time::Instant;

use antumbra::{Filter, LightShadow, ShadowFile};
use antumbra_bake::light_space::Resolution;
use antumbra_bake::{BakeOptions, Encoding, ResolutionRequest, Silent, bake};
use antumbra_render::{Ray, Tracer};
use antumbra_scene::{LightKind, Scene, procedural};
use anyhow::{Context, Result, anyhow};
use clap::Parser;
use glam::DVec3;

/// Measures lookups against shadow rays on one thread.
#[derive(Parser)]
struct Args {
    /// Scene files, or names of procedural scenes.
    #[arg(required = true)]
    scenes: Vec<String>,
    /// Texels per side of the bake.
    #[arg(long, default_value_t = 16384)]
    resolution: u32,
    /// Encoding of the bake: dag8 or silhouette.
    #[arg(long, default_value = "dag8", value_parser = encoding)]
    encoding: Encoding,
    /// Points per set.
    #[arg(long, default_value_t = 1_000_000)]
    points: usize,
    /// Measure prefiltered lookups by the width of their footprint, beside lookups at full depth.
    #[arg(long)]
    prefilter: bool,
    /// Measure this many segment lookups instead.
    #[arg(long, value_name = "COUNT")]
    segments: Option<usize>,
    /// Measure a rebuild in steps of so many milliseconds instead.
    #[arg(long, value_name = "BUDGET")]
    step_ms: Option<f64>,
}

fn encoding(name: &str) -> Result<Encoding, String> {
    let known = [Encoding::Dag8, Encoding::Silhouette];
    known.into_iter().find(|encoding| encoding.name() == name).ok_or_else(|| "dag8 or silhouette".to_owned())
}

fn main() -> Result<()> {
    let args = Args::parse();
    if args.prefilter {
        println!(
            "Millions per second on one thread, bake at {}, {} points near surfaces.\n",
            args.resolution, args.points
        );
        println!("{}", prefilter::HEADER);
        return args.scenes.iter().try_for_each(|name| prefilter::measure(name, &args));
    }
    if let Some(budget_ms) = args.step_ms {
        println!("{}", stepped::HEADER);
        return args.scenes.iter().try_for_each(|name| stepped::measure(name, &args, budget_ms));
    }
    if args.segments.is_some() {
        segments::print_head(args.resolution);
    } else {
        print_head(&args);
    }
    for name in &args.scenes {
        measure_scene(name, &args).with_context(|| format!("measuring {name}"))?;
    }
    Ok(())
}

fn print_head(args: &Args) {
    println!("Millions per second on one thread, bake at {}, {} points near surfaces.\n", args.resolution, args.points);
    println!(
        "| scene | order | points | point | 3x3 box | 9x9 box | 9x9 tent | 17x17 tent | shadow ray | point : ray | point : 9x9 |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
}

fn measure_scene(name: &str, args: &Args) -> Result<()> {
    let scene = load(name)?;
    let light = scene.lights.iter().find(|l| l.kind == LightKind::Directional).context("the scene has no sun")?;
    let resolution = Resolution::new(args.resolution).context("--resolution: a power of two from 64 to 1048576")?;
    let encoding = Some(args.encoding);
    let options = BakeOptions { resolution: ResolutionRequest::Texels(resolution), encoding, ..BakeOptions::default() };
    let baked = bake(&scene, std::slice::from_ref(light), &options, &Silent)?;
    let file = ShadowFile::from_bytes(&baked.bytes)?;
    let shadow = file.lights().next().context("the bake has no light")?;
    let tracer = Tracer::new(&scene, |node, _| !node.dynamic);
    let lift_m = 2.0 * shadow.record().texel_size_m;
    let coherent = scan_order_points(&scene, &tracer, args.segments.unwrap_or(args.points), lift_m)?;
    let mut random = coherent.clone();
    shuffle(&mut random);
    for (order, points) in [("random", &random), ("coherent", &coherent)] {
        if args.segments.is_some() {
            let eye = scene.cameras.first().context("the scene has no camera")?.eye_world;
            segments::print_row(&scene.name, order, eye, points, shadow);
            continue;
        }
        print_row(&scene.name, order, points, shadow, &tracer)?;
    }
    Ok(())
}

fn load(name: &str) -> Result<Scene> {
    if procedural::NAMES.iter().any(|(known, _)| *known == name) {
        return procedural::build(name, &procedural::Options::default()).map_err(|e| anyhow!("{e}"));
    }
    Ok(antumbra_scene::load(&PathBuf::from(name))?)
}

fn print_row(scene: &str, order: &str, points: &[DVec3], shadow: LightShadow<'_>, tracer: &Tracer) -> Result<()> {
    let rate = |answer: &dyn Fn(DVec3) -> f32| best_rate(points, answer);
    let many = best_rate_of_many(points, shadow);
    let point = best_rate(points, |p| shadow.visibility(p));
    let filtered = |filter: Filter| best_rate(points, move |p| shadow.filtered(p, None, filter));
    let (box3, box9) = (filtered(Filter::new_box(3)?), filtered(Filter::new_box(9)?));
    let (tent9, tent17) = (filtered(Filter::new_tent(9)?), filtered(Filter::new_tent(17)?));
    let toward_light = -shadow.direction_world();
    let ray = rate(&|p| f32::from(!tracer.occluded(&Ray::new(p, toward_light))));
    println!(
        "| {scene} | {order} | {many:.1} | {point:.1} | {box3:.1} | {box9:.1} | {tent9:.1} | {tent17:.1} | {ray:.2} | {:.0} | {:.1} |",
        point / ray,
        point / box9
    );
    Ok(())
}

/// Millions of answers per second: the best of several passes.
fn best_rate(points: &[DVec3], answer: impl Fn(DVec3) -> f32) -> f64 {
    let pass = || {
        let start = Instant::now();
        let sum: f32 = points.iter().map(|p| answer(*p)).sum();
        std::hint::black_box(sum);
        points.len() as f64 / start.elapsed().as_secs_f64() / 1e6
    };
    (0..5).map(|_| pass()).fold(0.0, f64::max)
}

/// The same for lookups side by side.
fn best_rate_of_many(points: &[DVec3], shadow: LightShadow<'_>) -> f64 {
    let mut answers = vec![0.0; points.len()];
    let mut pass = || {
        let start = Instant::now();
        shadow.visibility_many(points, &mut answers);
        std::hint::black_box(&answers);
        points.len() as f64 / start.elapsed().as_secs_f64() / 1e6
    };
    (0..5).map(|_| pass()).fold(0.0, f64::max)
}

/// What a camera sees, pixel by pixel and row by row, lifted off the surfaces a little.
fn scan_order_points(scene: &Scene, tracer: &Tracer, count: usize, lift_m: f64) -> Result<Vec<DVec3>> {
    let camera = scene.cameras.first().context("the scene has no camera")?;
    let right = camera.forward_world.cross(camera.up_world);
    let spread = (0.5 * camera.fov_y).tan();
    // The sky takes some of the pixels: raise the picture's size until enough see a surface.
    let mut side = (count as f64).sqrt() as usize + 1;
    loop {
        let mut points = Vec::new();
        for i in 0..side * side {
            let [x, y] = [i % side, i / side].map(|c| (c as f64 + 0.5) / side as f64 * 2.0 - 1.0);
            let direction = camera.forward_world + right * (x * spread) - camera.up_world * (y * spread);
            let ray = Ray::new(camera.eye_world, direction);
            if let Some(hit) = tracer.closest(&ray) {
                let normal = tracer.normal(hit.triangle);
                points.push(ray.at(hit.t) + normal * (lift_m * -normal.dot(direction).signum()));
            }
        }
        if points.len() >= count {
            return Ok(points);
        }
        if points.is_empty() || side > 8192 {
            anyhow::bail!("the scene's first camera sees too little of it");
        }
        side = side * 5 / 4;
    }
}

/// Fisher-Yates with a fixed sequence.
fn shuffle(points: &mut [DVec3]) {
    let mut state = 0x2545_f491_4f6c_dd1du64;
    for i in (1..points.len()).rev() {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        points.swap(i, (state % (i as u64 + 1)) as usize);
    }
}
