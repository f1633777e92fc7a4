//! Finds a caster that hides nearly everything: a sky dome, most often.

use antumbra_scene::Scene;

use crate::light_space::{LATERAL_BITS, LatticeTriangle};

/// Samples per side.
const SIDE: usize = 64;
/// Share of the samples over other casters that one node must hide before it is named.
const NEARLY_ALL: f64 = 0.95;

/// First two nodes along each of a coarse grid of rays.
pub struct FirstHits {
    /// Nearest depth and its node, and the nearest depth of any other node.
    samples: Vec<Option<Sample>>,
}

#[derive(Clone, Copy)]
struct Sample {
    nearest: (f64, usize),
    other: bool,
}

impl Default for FirstHits {
    fn default() -> Self {
        Self { samples: vec![None; SIDE * SIDE] }
    }
}

impl FirstHits {
    /// Adds a caster.
    pub fn insert(&mut self, t: &LatticeTriangle, node: usize) {
        let step = (1 << LATERAL_BITS) / SIDE as i32;
        let first = |c: [i32; 3]| (c[0].min(c[1]).min(c[2]) + step / 2 - 1) / step;
        let last = |c: [i32; 3]| (c[0].max(c[1]).max(c[2]) - step / 2).div_euclid(step);
        for row in first(t.y)..=last(t.y).min(SIDE as i32 - 1) {
            for column in first(t.x)..=last(t.x).min(SIDE as i32 - 1) {
                if let Some(depth) = depth_at(t, column * step + step / 2, row * step + step / 2) {
                    self.meet(row as usize * SIDE + column as usize, depth, node);
                }
            }
        }
    }

    /// Adds what others have met that come later in the scene.
    pub fn append(&mut self, later: &Self) {
        for (sample, later) in self.samples.iter_mut().zip(&later.samples) {
            *sample = match (*sample, *later) {
                (one, None) | (None, one) => one,
                (Some(a), Some(b)) => Some(Sample {
                    nearest: if b.nearest.0 < a.nearest.0 { b.nearest } else { a.nearest },
                    other: a.other || b.other || a.nearest.1 != b.nearest.1,
                }),
            };
        }
    }

    fn meet(&mut self, sample: usize, depth: f64, node: usize) {
        let sample = &mut self.samples[sample];
        *sample = Some(match *sample {
            None => Sample { nearest: (depth, node), other: false },
            Some(s) => Sample {
                nearest: if depth < s.nearest.0 { (depth, node) } else { s.nearest },
                other: s.other || s.nearest.1 != node,
            },
        });
    }

    /// A warning that names the node which lies before nearly all other casters.
    #[must_use]
    pub fn warning(&self, scene: &Scene) -> Option<String> {
        let contested: Vec<usize> = self.samples.iter().flatten().filter(|s| s.other).map(|s| s.nearest.1).collect();
        let mut sorted = contested.clone();
        sorted.sort_unstable();
        let most = sorted.chunk_by(|a, b| a == b).max_by_key(|same| same.len())?;
        let share = most.len() as f64 / contested.len() as f64;
        // A few samples over one small thing say nothing about a scene.
        let covered = self.samples.iter().flatten().count();
        let everywhere = self.samples.iter().flatten().filter(|s| s.nearest.1 == most[0]).count();
        let widely = contested.len() * 10 >= covered && everywhere * 10 >= 9 * covered;
        (share >= NEARLY_ALL && widely).then(|| {
            let name = &scene.nodes[most[0]].name;
            format!(
                "node \"{name}\" lies between the light and {:.0} % of everything else: if it is a sky dome or the like, add --exclude \"{name}\"",
                100.0 * share
            )
        })
    }
}

/// Depth of the triangle at a lattice point, if it covers the point.
fn depth_at(t: &LatticeTriangle, px: i32, py: i32) -> Option<f64> {
    let corner = |i: usize| [f64::from(t.x[i]), f64::from(t.y[i])];
    let p = [f64::from(px), f64::from(py)];
    let weight = |i: usize| {
        let (a, b) = (corner((i + 1) % 3), corner((i + 2) % 3));
        (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0])
    };
    let w = [weight(0), weight(1), weight(2)];
    let area: f64 = w.iter().sum();
    let inside = area != 0.0 && w.iter().all(|v| v * area >= 0.0);
    inside.then(|| (0..3).map(|i| w[i] * f64::from(t.z[i])).sum::<f64>() / area)
}
