//! Prefiltered lookups by footprint, beside what they replace: a plain lookup, filters at full depth, and the mean of all
//! point lookups in the footprint's square.

use antumbra::{Filter, LightShadow, Prefilter, ShadowFile};
use antumbra_bake::light_space::Resolution;
use antumbra_bake::{BakeOptions, Encoding, ResolutionRequest, Silent, bake};
use antumbra_render::Tracer;
use antumbra_scene::LightKind;
use anyhow::{Context, Result};
use glam::DVec3;

use crate::{Args, best_rate, load, scan_order_points, shuffle};

pub const HEADER: &str = "\
| scene | order | footprint, texels | point | 9x9 box | 17x17 box | all taps of the footprint | mean | levels, 3x3 tent | levels, 9x9 box | mean : all taps | levels 9x9 : all taps |
|---|---|---|---|---|---|---|---|---|---|---|---|";

pub fn measure(name: &str, args: &Args) -> Result<()> {
    let scene = load(name)?;
    let light = scene.lights.iter().find(|l| l.kind == LightKind::Directional).context("the scene has no sun")?;
    let resolution = Resolution::new(args.resolution).context("--resolution: a power of two from 64 to 1048576")?;
    let resolution = ResolutionRequest::Texels(resolution);
    let (encoding, levels) = (Some(args.encoding), args.encoding == Encoding::Dag8);
    let options = BakeOptions { resolution, levels, encoding, ..BakeOptions::default() };
    let baked = bake(&scene, std::slice::from_ref(light), &options, &Silent)?;
    let bytes: u64 = baked.lights.iter().map(|light| light.bytes).sum();
    let file = ShadowFile::from_bytes(&baked.bytes)?;
    let shadow = file.lights().next().context("the bake has no light")?;
    let tracer = Tracer::new(&scene, |node, _| !node.dynamic);
    let coherent = scan_order_points(&scene, &tracer, args.points, 2.0 * shadow.record().texel_size_m)?;
    let mut random = coherent.clone();
    shuffle(&mut random);
    for (order, points) in [("random", &random), ("coherent", &coherent)] {
        print_rows(&scene.name, order, points, shadow)?;
    }
    let share = baked.levels_bytes as f64 / bytes as f64;
    println!("\n{}: coarse levels add {:.0} % to the light's bytes; means add none.\n", scene.name, 100.0 * share);
    Ok(())
}

fn print_rows(scene: &str, order: &str, points: &[DVec3], shadow: LightShadow<'_>) -> Result<()> {
    let point = best_rate(points, |p| shadow.visibility(p));
    let box_filter = |taps| Filter::new_box(taps);
    let (small, large, tent) = (box_filter(9)?, box_filter(17)?, Filter::new_tent(3)?);
    let box9 = best_rate(points, |p| shadow.filtered(p, None, small));
    let box17 = best_rate(points, |p| shadow.filtered(p, None, large));
    for texels in [2u32, 4, 8, 16, 32, 64] {
        let footprint_m = f64::from(texels) * shadow.record().texel_size_m;
        let with = |how| best_rate(points, move |p| shadow.prefiltered(p, None, footprint_m, how));
        let (mean, narrow, wide) =
            (with(Prefilter::Mean), with(Prefilter::Levels(tent)), with(Prefilter::Levels(small)));
        // Fewer points: this takes long.
        let few = &points[..points.len() / (texels * texels) as usize];
        let all = best_rate(few, |p| mean_of_all(shadow, p, texels));
        println!(
            "| {scene} | {order} | {texels} | {point:.1} | {box9:.1} | {box17:.1} | {all:.2} | {mean:.1} | {narrow:.1} | {wide:.1} | {:.1} | {:.1} |",
            mean / all,
            wide / all
        );
    }
    Ok(())
}

/// Mean of the point lookups of a square of texels about a point.
fn mean_of_all(shadow: LightShadow<'_>, point: DVec3, texels: u32) -> f32 {
    let frame = shadow.frame(point);
    let step = |i: u32| (f64::from(i) + 0.5 - 0.5 * f64::from(texels)) * frame.texel_m;
    let taps = (0..texels * texels).map(|i| point + frame.right * step(i % texels) + frame.down * step(i / texels));
    taps.map(|p| shadow.visibility(p)).sum::<f32>() / (texels * texels) as f32
}
