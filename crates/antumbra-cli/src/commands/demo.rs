//! `antumbra demo`: everything at once, with no input.

use std::fs;
use std::path::PathBuf;
use std::time::Instant;

use antumbra::{Filter, ShadowFile};
use antumbra_bake::{BakeOptions, Baked, Blend, Inverted};
use antumbra_render::{RenderOptions, ShadowSource, default_camera};
use antumbra_scene::procedural::{self, Options};
use antumbra_scene::{Scene, to_glb};
use anyhow::{Context, Result, bail};
use glam::DVec3;

use crate::commands::render::draw;
use crate::compare::{Comparison, Wish, compare};
use crate::lights;
use crate::output::{self, OutputFile};
use crate::progress::Progress;
use crate::table::{Table, bytes, count, percent};

/// Shows what Antumbra does: generates a city, bakes its sun, checks the bake against ray tracing and draws the city with
/// its shadows.
///
/// Writes city.glb, city.antumbra and city.png. Takes no input and half a gigabyte of memory.
#[derive(clap::Args)]
#[command(after_help = "Example:\n  antumbra demo --out demo-output")]
pub struct Args {
    /// Folder to write to; made if it is not there
    #[arg(long, value_name = "DIR", default_value = "demo-output")]
    out: PathBuf,
    /// Size of the city, 0.05 to 4: the number of triangles grows with its square
    #[arg(long, value_name = "S", default_value_t = 1.0, value_parser = super::scene::parse_scale)]
    scale: f64,
    /// Show no progress and no summary
    #[arg(long)]
    quiet: bool,
}

/// Points in the air, and as many on surfaces and off them, that the bake is checked at.
const SAMPLES: u64 = 100_000;
/// Taps per side of the picture's filter.
const FILTER_TAPS: u32 = 5;
/// Lookups that are timed.
const TIMED_LOOKUPS: usize = 2_000_000;

/// The demo's files.
struct Files {
    scene: OutputFile,
    shadows: OutputFile,
    picture: OutputFile,
}

/// Shows.
pub fn run(args: &Args) -> Result<()> {
    let start = Instant::now();
    fs::create_dir_all(&args.out)
        .with_context(|| format!("cannot make the folder {}; choose another with --out", args.out.display()))?;
    let file = |name: &str| OutputFile::new(&args.out.join(name));
    let files = Files { scene: file("city.glb")?, shadows: file("city.antumbra")?, picture: file("city.png")? };

    let progress = Progress::new(args.quiet);
    progress.stage("generating a city");
    let scene = procedural::build("city", &Options { scale: args.scale, ..Options::default() })?;
    files.scene.write(&to_glb(&scene)?)?;
    let lights = lights::choose(&mut scene.clone(), &[], None)?;
    let baked = antumbra_bake::bake(&scene, &lights, &BakeOptions::default(), &progress)?;
    files.shadows.write(&baked.bytes)?;
    let shadows = ShadowFile::from_bytes(&baked.bytes)?;
    let wish = Wish { samples: SAMPLES, seed: 1, blend: Blend::Skip, inverted: Inverted::Open };
    let comparison = compare(&shadows, &scene, wish, &progress)?;
    progress.stage("timing lookups");
    let lookups_per_second = time_lookups(&shadows, &scene);
    files.picture.write(&draw_city(&scene, &shadows, &progress)?)?;
    drop(progress);

    if !args.quiet {
        let seconds = start.elapsed().as_secs_f64();
        output::print(&summary(args, &scene, &baked, &comparison, lookups_per_second, seconds))?;
    }
    if comparison.total().too_far > 0 {
        bail!("the bake disagrees with ray tracing far from any shadow's edge: please report this with the text above");
    }
    Ok(())
}

fn draw_city(scene: &Scene, shadows: &ShadowFile, progress: &Progress) -> Result<Vec<u8>> {
    let camera = scene.cameras.first().map_or_else(|| default_camera(scene), |camera| Ok(camera.clone()))?;
    let source = ShadowSource::Dag { shadows, filter: Filter::new_tent(FILTER_TAPS)? };
    Ok(draw(scene, &camera, &RenderOptions::default(), source, progress)?.to_png()?)
}

/// Lookups per second of one thread, at points strewn evenly over the scene's box.
fn time_lookups(shadows: &ShadowFile, scene: &Scene) -> f64 {
    let Some(light) = shadows.lights().next() else { return 0.0 };
    let bounds = scene.bounds(|_| true);
    // The plastic sequence fills a box evenly (Roberts 2018, "The unreasonable effectiveness of quasirandom sequences").
    let step = DVec3::new(0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9);
    let points: Vec<DVec3> =
        (0..TIMED_LOOKUPS).map(|i| bounds.min + (bounds.max - bounds.min) * (step * i as f64).fract()).collect();
    let mut visibility = vec![0.0; points.len()];
    let start = Instant::now();
    light.visibility_many(&points, &mut visibility);
    let seconds = start.elapsed().as_secs_f64();
    std::hint::black_box(visibility);
    TIMED_LOOKUPS as f64 / seconds.max(1e-9)
}

fn summary(
    args: &Args,
    scene: &Scene,
    baked: &Baked,
    comparison: &Comparison,
    lookups_per_second: f64,
    seconds: f64,
) -> String {
    let mut table = Table::default();
    let closed = percent(baked.stats.triangles_closed, baked.stats.triangles_total);
    table.row("scene", format!("{} triangles, {closed} of them in closed solids", count(scene.triangle_count())));
    for light in &baked.lights {
        let n = light.resolution;
        let shadow_map = 2 * u64::from(n) * u64::from(n);
        table.row("resolution", format!("{n} x {n} x {n} voxels, texels of {:.1} cm", 100.0 * light.texel_size_m));
        table.row("built in", format!("{:.2} s on {} thread(s)", light.build_seconds, baked.threads));
        let file = baked.bytes.len() as u64;
        table.row("bytes", format!("{} on disk, {} as they are looked up", bytes(file), bytes(light.bytes)));
        let ratio = shadow_map as f64 / file as f64;
        table.row("16-bit shadow map", format!("{}: {ratio:.0} times as many", bytes(shadow_map)));
    }
    table.row("lookups", format!("{:.1} million a second on one thread", lookups_per_second * 1e-6));
    table.row("against ray tracing", comparison.verdict());
    let path = |name: &str| args.out.join(name).display().to_string();
    table.row("scene file", path("city.glb"));
    table.row("shadow file", path("city.antumbra"));
    table.row("picture", path("city.png"));
    table.row("all in all", format!("{seconds:.1} s"));
    table.text("A city and its sun")
}
