//! The oracle: slow, exact, obviously right. Every fast path is held against it.
//!
//! For one texel it looks at every triangle that can matter, in exact integers, and counts. It shares no code with the
//! builder: coverage, depth and winding are written out again here in the plainest form.

use crate::light_space::{LATERAL_BITS, LatticeTriangle, Resolution};

/// What a light's policy leaves free behind open surfaces.
pub enum Free<'a> {
    /// Nothing.
    Nothing,
    /// From an enter depth, the deepest transition that a thickness allows.
    Behind(&'a (dyn Fn(u32) -> u32 + Sync)),
    /// From the second surface's slice, the deepest transition that a margin allows.
    BeforeSecond(&'a (dyn Fn(u32) -> u32 + Sync)),
}

/// How a light sees its triangles.
pub struct View<'a> {
    /// Texels per side.
    pub resolution: Resolution,
    /// Slice of a depth on the lattice, rounded down.
    pub slice: &'a (dyn Fn(u32) -> u32 + Sync),
    /// Whether a triangle (by its index) is there at a lattice point that it covers: its alpha test.
    pub keeps: &'a (dyn Fn(usize, [i64; 2]) -> bool + Sync),
    /// What its policy leaves free.
    pub free: Free<'a>,
}

/// Where a texel's transition may lie: any t with `enter <= t <= exit` is right (slices below t are lit, the others
/// shadowed). `u32::MAX` stands for never: a texel without casters is [`Interval::NEVER`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Interval {
    /// First slice in shadow.
    pub enter: u32,
    /// First slice that must be in shadow.
    pub exit: u32,
}

impl Interval {
    /// No caster: lit throughout.
    pub const NEVER: Self = Self { enter: u32::MAX, exit: u32::MAX };
}

/// Triangles binned by their boxes, so that a texel need not look at all of them.
pub struct Oracle<'a> {
    triangles: &'a [LatticeTriangle],
    view: View<'a>,
    bin_shift: u32,
    bins_per_side: usize,
    bins: Vec<Vec<u32>>,
}

/// One triangle's meeting with a texel's ray.
struct Crossing {
    slice: u32,
    /// +1 into a solid, -1 out of one, 0 an open surface.
    winding: i32,
}

impl<'a> Oracle<'a> {
    /// Bins the triangles.
    #[must_use]
    pub fn new(triangles: &'a [LatticeTriangle], view: View<'a>) -> Self {
        let log2_bins = view.resolution.log2().min(9);
        let bin_shift = LATERAL_BITS - log2_bins;
        let bins_per_side = 1usize << log2_bins;
        let mut bins = vec![Vec::new(); bins_per_side * bins_per_side];
        // Corners may lie beside the grid.
        let bin_of = |c: i32| ((c >> bin_shift).max(0) as usize).min(bins_per_side - 1);
        for (index, t) in triangles.iter().enumerate() {
            let span = |c: [i32; 3]| bin_of(c[0].min(c[1]).min(c[2]))..=bin_of(c[0].max(c[1]).max(c[2]));
            for y in span(t.y) {
                for x in span(t.x) {
                    bins[y * bins_per_side + x].push(index as u32);
                }
            }
        }
        Self { triangles, view, bin_shift, bins_per_side, bins }
    }

    /// The exact interval of texel (x, y).
    #[must_use]
    pub fn interval(&self, x: u32, y: u32) -> Interval {
        let mut crossings = self.crossings(x, y);
        crossings.sort_by_key(|c| c.slice);
        let Some(first) = crossings.first() else { return Interval::NEVER };
        let enter = first.slice + 1;
        let exit = exit_from_solids(&crossings, enter);
        let counts = |slice: &u32| *slice > first.slice && *slice < self.view.resolution.texels();
        let second = crossings.iter().map(|c| c.slice).find(counts);
        let free = match self.view.free {
            Free::Nothing => enter,
            Free::Behind(deepest) => deepest(enter),
            Free::BeforeSecond(deepest) => second.map_or(u32::MAX, deepest),
        };
        Interval { enter, exit: exit.max(free) }
    }

    fn crossings(&self, x: u32, y: u32) -> Vec<Crossing> {
        let [px, py] = [x, y].map(|c| self.view.resolution.texel_center(c));
        let bin = |p: i64| (p >> self.bin_shift) as usize;
        let bin = &self.bins[bin(py) * self.bins_per_side + bin(px)];
        let kept = bin.iter().filter(|&&t| (self.view.keeps)(t as usize, [px, py]));
        kept.filter_map(|&t| crossing(&self.triangles[t as usize], px, py, self.view.slice)).collect()
    }
}

/// The winding number behind each slice: within a slice entries come before exits, so touching solids leave no slit. The
/// ray is out of all solids behind the first slice where the number is not positive.
fn exit_from_solids(sorted: &[Crossing], enter: u32) -> u32 {
    let mut winding = 0;
    for same_slice in sorted.chunk_by(|a, b| a.slice == b.slice) {
        winding += same_slice.iter().map(|c| c.winding).sum::<i32>();
        if winding <= 0 {
            return same_slice[0].slice.max(enter);
        }
    }
    u32::MAX
}

/// Where the ray at lattice point (px, py), moved to (px + d, py + d^2) for an infinitesimal d > 0, meets a triangle.
fn crossing(t: &LatticeTriangle, px: i64, py: i64, slice: &dyn Fn(u32) -> u32) -> Option<Crossing> {
    let area = i128::from(t.doubled_area());
    // Barycentric weights, scaled by the doubled area.
    let mut weights = [0i128; 3];
    for (i, weight) in weights.iter_mut().enumerate() {
        let (a, b) = ((i + 1) % 3, (i + 2) % 3);
        let [ax, ay, bx, by] = [t.x[a], t.y[a], t.x[b], t.y[b]].map(i128::from);
        let [px, py] = [px, py].map(i128::from);
        *weight = (bx - ax) * (py - ay) - (by - ay) * (px - ax);
        // The weight at the moved point decides; the area's sign says which side is inside.
        let moved = [*weight, -(by - ay), bx - ax].into_iter().find(|v| *v != 0)?;
        if area == 0 || (moved > 0) != (area > 0) {
            return None;
        }
    }
    let depth: i128 = (0..3).map(|i| weights[i] * i128::from(t.z[i])).sum();
    let floor = if area > 0 { depth.div_euclid(area) } else { (-depth).div_euclid(-area) };
    let winding = if t.solid { -area.signum() as i32 } else { 0 };
    Some(Crossing { slice: slice(floor as u32), winding })
}
