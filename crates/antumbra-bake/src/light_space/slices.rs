//! From depth on the lattice to slices, exactly.
//!
//! Depth on the lattice is linear across the light: distance for directional lights, 1 - near/z for local ones, whose
//! planes stay planes in perspective. What a slice is differs. A directional light's slices are equally many lattice
//! steps each. A local light's are spread by the logarithm of z (Kämpe et al. 2015, eq. 1), so a table holds the lattice
//! step at which each begins: slices are then as exact as depths are, whatever logarithm made the table.

use antumbra::DepthDistribution;
use antumbra::format::slices::{Spread, begin};

use super::{DEPTH_BITS, Resolution};

/// A light's slices.
#[derive(Clone, Debug)]
pub struct Slices {
    resolution: Resolution,
    table: Option<Table>,
}

/// Slices that begin at any step.
#[derive(Clone, Debug)]
struct Table {
    /// First lattice step of each slice, and of what lies behind the last.
    begins: Vec<u32>,
    /// For each bucket of depths, the slice of its nearest step.
    buckets: Vec<u32>,
    index: BucketIndex,
    /// What a depth becomes one slice and a half nearer, and one nearer.
    nearer: [Moved; 2],
    half_of_deep: Moved,
}

/// How depths fall into buckets.
#[derive(Clone, Copy, Debug)]
enum BucketIndex {
    /// By the leading bits of the steps that remain to infinity, which slices follow logarithmically.
    Logarithmic { fraction_bits: u32 },
    /// By equal steps.
    Even { shift: u32 },
}

/// Depths over more slices than this are looked up one by one.
const MOST_BOUNDARIES: u32 = 24;

/// Lattice steps to infinity (local lights), or to the volume's end.
const DEPTH_STEPS: f64 = (1u64 << DEPTH_BITS) as f64;

impl Slices {
    /// Slices of equally many steps: a directional light's.
    #[must_use]
    pub fn even(resolution: Resolution) -> Self {
        Self { resolution, table: None }
    }

    /// A local light's slices between its near and far distance, whose ratio is given; lattice depth is 1 - near/z.
    /// The same table on every machine.
    #[must_use]
    pub fn local(resolution: Resolution, far_over_near: f64, distribution: DepthDistribution) -> Self {
        let n = resolution.texels();
        let begins: Vec<u32> = (0..=n).map(|slice| begin(slice, n, far_over_near, distribution)).collect();
        // From one slice to the next the steps that remain to infinity shrink by e to this, or they grow by so many.
        let (index, decay, width) = match distribution {
            DepthDistribution::Ndc => {
                let width = (1.0 - 1.0 / far_over_near) / f64::from(n) * DEPTH_STEPS;
                (BucketIndex::Even { shift: resolution.slice_shift().saturating_sub(1) }, 0.0, width)
            }
            _ => {
                let fraction_bits = resolution.log2().saturating_sub(2).max(4);
                (BucketIndex::Logarithmic { fraction_bits }, libm::log(far_over_near) / f64::from(n), 0.0)
            }
        };
        let nearer = |slices: f64| {
            let more = -libm::expm1(slices * decay) * DEPTH_STEPS - slices * width;
            Moved { share: libm::exp(slices * decay), more }
        };
        // From the middle between a slice's beginning and that of the one before.
        let share = 2.0 / (1.0 + libm::exp(decay));
        let half_of_deep = Moved { share, more: (1.0 - share) * DEPTH_STEPS + 0.5 * width };
        let buckets = index.buckets(&begins);
        let nearer = [nearer(1.5), nearer(1.0)];
        Self { resolution, table: Some(Table { begins, buckets, index, nearer, half_of_deep }) }
    }

    /// Texels per side and slices.
    #[must_use]
    pub fn resolution(&self) -> Resolution {
        self.resolution
    }

    /// Slice of a lattice step; N for what lies behind the last slice.
    #[inline]
    #[must_use]
    pub fn of_step(&self, step: u32) -> u32 {
        match &self.table {
            None => step >> self.resolution.slice_shift(),
            Some(table) => table.slice(step),
        }
    }

    /// Depth units per lattice step: the builder computes depths in slices where those are even, else in lattice steps.
    #[must_use]
    pub fn units_per_step(&self) -> f64 {
        if self.table.is_none() { 1.0 / (1u64 << self.resolution.slice_shift()) as f64 } else { 1.0 }
    }

    /// Whether a depth unit is a slice.
    #[inline]
    #[must_use]
    pub fn are_even(&self) -> bool {
        self.table.is_none()
    }

    /// Depth of the lattice's end, in units.
    #[must_use]
    pub fn end_units(&self) -> f64 {
        if self.table.is_none() { f64::from(self.resolution.texels()) } else { DEPTH_STEPS }
    }

    /// Slice of a depth in units, as good as the depth is; saturates at both ends.
    #[inline]
    #[must_use]
    pub fn of_units(&self, depth: f64) -> u32 {
        // A cast rounds down where positive, and saturates.
        match &self.table {
            None => depth as u32,
            Some(table) => table.slice(depth as u32),
        }
    }

    /// The slices of 64 depths in units, and a mask of those that a depth which is off by no more than `error` may make
    /// wrong. Both hold where `wanted`, a mask too, is set. For slices that are not even.
    #[inline(always)]
    #[must_use]
    pub(crate) fn of_depths_within(
        &self,
        depths: &[f64; 64],
        error: f64,
        wanted: &[u32; 64],
    ) -> ([u32; 64], [u32; 64]) {
        let Some(table) = &self.table else { return ([0; 64], [u32::MAX; 64]) };
        // Depth is linear over the square that the 64 lie on: its corners bound it.
        let corners = [depths[0], depths[7], depths[56], depths[63]];
        let low = corners.iter().fold(f64::INFINITY, |low, d| low.min(*d));
        let high = corners.iter().fold(f64::NEG_INFINITY, |high, d| high.max(*d));
        let (first, last) = (table.slice(low as u32), table.slice(high as u32));
        if last - first <= MOST_BOUNDARIES {
            table.count_boundaries(depths, error, [first, last])
        } else {
            table.look_up_each(depths, error, wanted)
        }
    }

    /// Bound on the rounding of a sum of terms no greater than the volume's depth, in units.
    #[must_use]
    pub fn rounding(&self) -> f64 {
        self.end_units() * (1.0 / (1u64 << 50) as f64)
    }

    /// By how much depth intervals are widened so that rounding opens no gap between neighbours, in units.
    #[must_use]
    pub fn widening(&self) -> f64 {
        if self.table.is_none() { 1.0 / 256.0 } else { 1.0 }
    }

    /// The same, as lookups of planes want them.
    #[must_use]
    pub fn spread(&self) -> Spread<'_> {
        match &self.table {
            None => Spread::Even(self.resolution.texels()),
            Some(table) => Spread::Steps(&table.begins[..table.begins.len() - 1]),
        }
    }

    /// What a depth becomes, in units, as the value of a plane there whose first shadowed slice is its own, or the next one. Planes stay planes.
    #[inline]
    #[must_use]
    pub fn value_of(&self, is_next: bool) -> Moved {
        match &self.table {
            None => Moved { share: 1.0, more: f64::from(u32::from(is_next)) },
            // The first shadowed slice is the next to that of the value.
            Some(_) if is_next => Moved::UNMOVED,
            Some(table) => table.nearer[1],
        }
    }

    /// The same of a plane half a slice nearer.
    #[inline]
    #[must_use]
    pub fn value_before(&self) -> Moved {
        self.table.as_ref().map_or(Moved { share: 1.0, more: -0.5 }, |table| table.nearer[0])
    }

    /// By how much the depth of a deep plane's value lies behind that of the same value of another: half a slice, as [`Spread`] has it.
    #[inline]
    #[must_use]
    pub fn half_of_deep(&self) -> Moved {
        self.table.as_ref().map_or(Moved::UNMOVED, |table| table.half_of_deep)
    }

    /// Bytes that the table takes.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.table.as_ref().map_or(0, |table| 4 * (table.begins.len() + table.buckets.len()) as u64)
    }
}

/// A linear function of a depth in units.
#[derive(Clone, Copy, Debug)]
pub struct Moved {
    /// Its slope.
    pub share: f64,
    more: f64,
}

impl Moved {
    const UNMOVED: Self = Self { share: 1.0, more: 0.0 };

    /// The depth that a depth becomes.
    #[inline(always)]
    #[must_use]
    pub fn of(self, depth: f64) -> f64 {
        depth * self.share + self.more
    }
}

impl Table {
    /// The slices of depths that lie in slices `first` to `last`, by counting the boundaries that lie before them.
    #[inline(always)]
    fn count_boundaries(&self, depths: &[f64; 64], error: f64, [first, last]: [u32; 2]) -> ([u32; 64], [u32; 64]) {
        let mut slices = [first; 64];
        let mut doubtful = [0u32; 64];
        let boundaries = self.begins.iter().skip(first as usize).take((last - first) as usize + 2);
        for (i, boundary) in boundaries.enumerate() {
            let boundary = f64::from(*boundary);
            let counts = u32::from(i != 0);
            for ((slice, doubtful), depth) in slices.iter_mut().zip(&mut doubtful).zip(depths) {
                *slice += counts & u32::from(*depth >= boundary);
                *doubtful |= u32::from((depth - boundary).abs() <= error).wrapping_neg();
            }
        }
        // What lies behind the last slice is not told apart.
        slices.iter_mut().for_each(|slice| *slice = (*slice).min(last));
        (slices, doubtful)
    }

    /// The same for any depths, one by one.
    #[cold]
    fn look_up_each(&self, depths: &[f64; 64], error: f64, wanted: &[u32; 64]) -> ([u32; 64], [u32; 64]) {
        let mut slices = [0; 64];
        let mut doubtful = [0; 64];
        for i in (0..64).filter(|&i| wanted[i] != 0) {
            let slice = self.slice(depths[i] as u32);
            let begin = f64::from(self.begins[slice as usize]);
            let end = self.begins.get(slice as usize + 1).map_or(f64::INFINITY, |&end| f64::from(end));
            slices[i] = slice;
            doubtful[i] = u32::from(!(depths[i] - begin > error && end - depths[i] > error)).wrapping_neg();
        }
        (slices, doubtful)
    }

    #[inline]
    fn slice(&self, step: u32) -> u32 {
        let last = self.begins.len() - 1;
        let mut slice = self.buckets[self.index.of(step).min(self.buckets.len() - 1)] as usize;
        while slice < last && self.begins[slice + 1] <= step {
            slice += 1;
        }
        slice as u32
    }
}

impl BucketIndex {
    /// Buckets are numbered from the nearest depth on.
    #[inline]
    fn of(self, step: u32) -> usize {
        match self {
            Self::Even { shift } => (step >> shift) as usize,
            Self::Logarithmic { fraction_bits } => {
                // 1.0 to 2^32 as a double: its exponent and the first bits of its fraction count buckets of equal ratio.
                let bits = |steps: f64| steps.to_bits() >> (52 - fraction_bits);
                (bits(DEPTH_STEPS) - bits(DEPTH_STEPS - f64::from(step))) as usize
            }
        }
    }

    /// The slice of each bucket's nearest step, up to the bucket that holds the last slice's end.
    fn buckets(self, begins: &[u32]) -> Vec<u32> {
        let end = begins[begins.len() - 1];
        let mut buckets = vec![0u32; self.of(end) + 1];
        // A bucket that a slice begins in has its nearest step in the slice before, or just there: both will do.
        for (slice, pair) in begins.windows(2).enumerate() {
            let (from, to) = (self.of(pair[0]), self.of(pair[1]));
            for bucket in buckets.iter_mut().take(to + 1).skip(from + 1) {
                *bucket = slice as u32;
            }
        }
        buckets
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_agree_with_a_search_of_their_beginnings() {
        for (log2, ratio) in [(6, 1024.0), (10, 1024.0), (13, 1.01), (13, 1e6), (16, 40.0), (20, 1024.0)] {
            for distribution in [DepthDistribution::Logarithmic, DepthDistribution::Ndc] {
                let slices = Slices::local(Resolution::new(1 << log2).expect("in range"), ratio, distribution);
                let begins = &slices.table.as_ref().expect("a table").begins;
                let check = |step: u32| {
                    let expected = begins.partition_point(|&b| b <= step) as u32 - 1;
                    assert_eq!(slices.of_step(step), expected, "2^{log2}, {ratio}, {distribution:?}, step {step}");
                };
                (0..200_000u32).for_each(|i| check(i.wrapping_mul(2_654_435_761)));
                for &b in begins.iter().step_by(7) {
                    [b, b.saturating_sub(1), b.saturating_add(1)].into_iter().for_each(check);
                }
                [0, 1, u32::MAX - 1, u32::MAX].into_iter().for_each(check);
            }
        }
    }

    #[test]
    fn slices_follow_equation_1() {
        let resolution = Resolution::new(4096).expect("in range");
        let slices = Slices::local(resolution, 1024.0, DepthDistribution::Logarithmic);
        for i in 1..1000 {
            let z = 1.0 + f64::from(i) * 1.0231;
            let exact = 4096.0 * z.ln() / 1024f64.ln();
            let step = ((1.0 - 1.0 / z) * DEPTH_STEPS) as u32;
            assert!((exact - 0.5 - f64::from(slices.of_step(step))).abs() < 0.52, "z {z}");
        }
    }
}
