//! Segment lookups per second, beside marching the same segments with a point lookup for every texel's length.

use std::time::Instant;

use antumbra::LightShadow;
use glam::DVec3;

/// Prints the table's head.
pub fn print_head(resolution: u32) {
    println!("Segments from the camera to what it sees, per second on one thread, bake at {resolution}.\n");
    println!(
        "| scene | order | segments | mean length | steps each | segments/s | ns per step | lookups each | marched/s | segment : march | lit share | marched |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
}

/// Prints what segments from an eye to points cost.
pub fn print_row(scene: &str, order: &str, eye: DVec3, points: &[DVec3], shadow: LightShadow<'_>) {
    let count = points.len() as f64;
    let length_m = points.iter().map(|p| eye.distance(*p)).sum::<f64>() / count;
    let steps = points.iter().map(|p| steps(shadow, eye, *p)).sum::<u64>() as f64 / count;
    let (rate, share) = best_rate(5, points, |p| shadow.lit_share(eye, p));
    let mut march = March::default();
    let samples = points.iter().map(|p| march.samples(shadow, eye, *p)).sum::<usize>() as f64 / count;
    let (marched, marched_share) = best_rate(2, points, |p| march.lit_share(shadow, eye, p));
    println!(
        "| {scene} | {order} | {count} | {length_m:.0} m | {steps:.0} | {rate:.0} | {:.1} | {samples:.0} | {marched:.0} | {:.1} | {share:.6} | {marched_share:.6} |",
        1e9 / (rate * steps),
        rate / marched
    );
}

fn steps(shadow: LightShadow<'_>, from: DVec3, to: DVec3) -> u64 {
    let mut segment = shadow.segment(from, to);
    segment.by_ref().for_each(drop);
    segment.steps()
}

/// Answers per second, the best of several passes, and their mean.
fn best_rate(passes: usize, points: &[DVec3], mut answer: impl FnMut(DVec3) -> f64) -> (f64, f64) {
    let mut best = (0.0, 0.0);
    for _ in 0..passes {
        let start = Instant::now();
        let sum: f64 = points.iter().map(|p| answer(*p)).sum();
        let rate = points.len() as f64 / start.elapsed().as_secs_f64();
        best = (rate.max(best.0), sum / points.len() as f64);
    }
    best
}

/// Marches with lookups side by side, the quickest there are.
#[derive(Default)]
struct March {
    points: Vec<DVec3>,
    visibility: Vec<f32>,
}

impl March {
    fn samples(&self, shadow: LightShadow<'_>, from: DVec3, to: DVec3) -> usize {
        (from.distance(to) / shadow.record().texel_size_m).ceil() as usize
    }

    fn lit_share(&mut self, shadow: LightShadow<'_>, from: DVec3, to: DVec3) -> f64 {
        let samples = self.samples(shadow, from, to).max(1);
        let step = (to - from) / samples as f64;
        self.points.clear();
        self.points.extend((0..samples).map(|i| from + step * (i as f64 + 0.5)));
        self.visibility.resize(samples, 0.0);
        shadow.visibility_many(&self.points, &mut self.visibility);
        self.visibility[..samples].iter().map(|v| f64::from(*v)).sum::<f64>() / samples as f64
    }
}
