//! Steps of a rebuild that is spread over frames: how long they take at a budget.

use std::sync::Arc;
use std::time::{Duration, Instant};

use antumbra_bake::light_space::Resolution;
use antumbra_bake::{BakeOptions, ResolutionRequest, Silent, Step, SteppedBaker, bake};
use antumbra_scene::LightKind;
use anyhow::{Context, Result, ensure};

use crate::{Args, load};

/// Heading of the table.
pub const HEADER: &str = "| scene | N | budget | steps | median | 99th percentile | 99.9th | longest | steps over 4 ms | in steps | at once, 1 thread |\n\
                          |---|---|---|---|---|---|---|---|---|---|---|";

/// Rebuilds a scene's sun in steps and prints a row.
pub fn measure(name: &str, args: &Args, budget_ms: f64) -> Result<()> {
    let scene = Arc::new(load(name)?);
    let sun = scene.lights.iter().find(|l| l.kind == LightKind::Directional).context("the scene has no sun")?.clone();
    let resolution = Resolution::new(args.resolution).context("--resolution: a power of two from 64 to 1048576")?;
    let options = BakeOptions {
        encoding: Some(args.encoding),
        resolution: ResolutionRequest::Texels(resolution),
        threads: 1,
        ..BakeOptions::default()
    };
    let start = Instant::now();
    let whole = bake(&scene, std::slice::from_ref(&sun), &options, &Silent)?;
    let at_once = start.elapsed();
    let mut baker = SteppedBaker::new(Arc::clone(&scene), options)?;
    baker.start(vec![sun]);
    let budget = Duration::from_secs_f64(1e-3 * budget_ms);
    let mut steps = Vec::new();
    let bytes = loop {
        let start = Instant::now();
        let step = baker.step(budget);
        steps.push(start.elapsed());
        if let Step::Done(baked) = step {
            break baked?.bytes;
        }
    };
    ensure!(bytes == whole.bytes, "the stepped bake has other bytes");
    steps.sort_unstable();
    let ms = |d: Duration| 1e3 * d.as_secs_f64();
    let percentile = |share: f64| ms(steps[((steps.len() - 1) as f64 * share) as usize]);
    println!(
        "| {} | {} | {budget_ms} ms | {} | {:.2} ms | {:.2} ms | {:.2} ms | {:.2} ms | {} | {:.2} s | {:.2} s |",
        scene.name,
        resolution.texels(),
        steps.len(),
        percentile(0.5),
        percentile(0.99),
        percentile(0.999),
        percentile(1.0),
        steps.iter().filter(|step| ms(**step) > 4.0).count(),
        steps.iter().sum::<Duration>().as_secs_f64(),
        at_once.as_secs_f64(),
    );
    Ok(())
}
