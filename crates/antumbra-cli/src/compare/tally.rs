//! Counts of what was found, and the worst of it.

use glam::DVec3;

/// Worst disagreements kept.
const WORST_KEPT: usize = 5;

/// Counts over the points of a kind.
#[derive(Clone, Debug, Default)]
pub struct Tally {
    pub samples: u64,
    /// The bake says what the ray says.
    pub agreeing: u64,
    /// They differ inside a solid or where the policy promises nothing: the bake was free to choose.
    pub undefined: u64,
    /// They differ elsewhere.
    pub disagreeing: u64,
    /// The ray reaches the light.
    pub lit: u64,
    /// The bake was free to choose, whatever it chose.
    pub free: u64,
    /// Of so many points it was found out whether they are robust, near an edge or inside.
    pub classified: u64,
    /// The truth is the same all round, a texel aside and a slice before and behind (of a point a little off the
    /// surface, for those on surfaces).
    pub robust: u64,
    /// It is not.
    pub near_edge: u64,
    /// Inside a solid.
    pub inside: u64,
    /// Behind a surface, where the policy promises nothing.
    pub behind: u64,
    /// The largest distance of a disagreement from an edge, texels; infinite past [`super::FARTHEST_TEXELS`].
    pub farthest_texels: f64,
    /// Disagreements farther than a texel.
    pub too_far: u64,
    /// The farthest of those.
    pub worst: Vec<Worst>,
}

/// A disagreement far from any edge.
#[derive(Clone, Copy, Debug)]
pub struct Worst {
    pub point_world: DVec3,
    pub bake_lit: bool,
    /// As [`Tally::farthest_texels`].
    pub texels: f64,
}

impl Tally {
    pub fn disagree(&mut self, point_world: DVec3, bake_lit: bool, texels: f64) {
        self.disagreeing += 1;
        self.farthest_texels = self.farthest_texels.max(texels);
        if texels > 1.0 {
            self.too_far += 1;
            self.worst.push(Worst { point_world, bake_lit, texels });
            self.keep_worst();
        }
    }

    /// Keeps the farthest; of equals the first by place, so that the order of threads does not show.
    fn keep_worst(&mut self) {
        let key = |w: &Worst| w.point_world.to_array();
        self.worst.sort_by(|a, b| {
            let places = key(a).into_iter().zip(key(b)).map(|(a, b)| a.total_cmp(&b));
            b.texels.total_cmp(&a.texels).then(places.fold(std::cmp::Ordering::Equal, std::cmp::Ordering::then))
        });
        self.worst.truncate(WORST_KEPT);
    }

    pub fn merge(mut self, other: Self) -> Self {
        self.samples += other.samples;
        self.agreeing += other.agreeing;
        self.undefined += other.undefined;
        self.disagreeing += other.disagreeing;
        self.lit += other.lit;
        self.free += other.free;
        self.classified += other.classified;
        self.robust += other.robust;
        self.near_edge += other.near_edge;
        self.inside += other.inside;
        self.behind += other.behind;
        self.farthest_texels = self.farthest_texels.max(other.farthest_texels);
        self.too_far += other.too_far;
        self.worst.extend(other.worst);
        self.keep_worst();
        self
    }
}
