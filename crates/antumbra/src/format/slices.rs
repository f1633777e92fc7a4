//! Where a light's slices begin, for planes ([`super::silhouette`]).
//!
//! A directional light's are even, and its planes count in slices. A local light's are not ([`DepthDistribution`]); its planes count in
//! steps of depth on the lattice, 1 - near/z in parts of 2^-32, in which they stay planes in perspective. Slice k of N begins at the step
//!
//! ```text
//! logarithmic  2^32 (1 - (near / far)^(k / N))
//! ndc          2^32 (1 - near / far) k / N
//! ```
//!
//! rounded up to a whole one, and no later than at 2^32 - 1. Both are computed in double precision as [`begin`] says.

use alloc::collections::{BTreeMap, BTreeSet};
use alloc::sync::Arc;
use alloc::vec::Vec;

use super::silhouette::Form;
use crate::{DepthDistribution, FormatError, LightRecord};

/// Lattice steps to infinity.
const DEPTH_STEPS: f64 = (1u64 << 32) as f64;
/// Most words that a file's tables take together, 256 MiB: readers refuse files with more.
pub const MOST_WORDS: u64 = 1 << 26;

/// The lattice step at which a local light's slice k of so many begins; for k = N what lies behind the last one.
#[must_use]
pub fn begin(k: u32, slices: u32, far_over_near: f64, distribution: DepthDistribution) -> u32 {
    let part = f64::from(k) / f64::from(slices);
    let share = match distribution {
        DepthDistribution::Ndc => part * (1.0 - 1.0 / far_over_near),
        _ => -libm::expm1(-part * libm::log(far_over_near)),
    };
    libm::ceil(share * DEPTH_STEPS).min(DEPTH_STEPS - 1.0) as u32
}

/// How a light's slices follow one another.
#[derive(Clone, Copy, Debug)]
pub enum Spread<'a> {
    /// So many, evenly: the planes of directional lights count in them.
    Even(u32),
    /// The lattice step at which each begins: a local light's.
    Steps(&'a [u32]),
}

impl<'a> Spread<'a> {
    /// Even ones where it is not said where they begin.
    #[inline(always)]
    pub(crate) fn new(count: u32, begins: &'a [u32]) -> Self {
        if begins.is_empty() { Self::Even(count) } else { Self::Steps(begins) }
    }
}

impl Spread<'_> {
    /// How many there are.
    #[inline(always)]
    #[must_use]
    pub fn count(self) -> u32 {
        match self {
            Self::Even(count) => count,
            Self::Steps(begins) => begins.len() as u32,
        }
    }

    /// The least whole values with which a plane, and a deep one, lie behind a slice, so that it is lit.
    #[inline(always)]
    #[must_use]
    pub fn least_behind(self, slice: u32) -> [i64; 2] {
        match self {
            Self::Even(_) => [i64::from(slice) + 1; 2],
            Self::Steps(begins) => [i64::from(begins[slice as usize]), i64::from(middle(begins, slice))],
        }
    }

    /// The deep form of a plane, within half a slice: the deepest point of each texel.
    #[inline(always)]
    #[must_use]
    pub fn deep(self, plane: Form) -> Form {
        let one = 1i64 << plane.shift;
        let rise = (i64::from(plane.a.unsigned_abs()) + i64::from(plane.b.unsigned_abs())) >> 1;
        let more = match self {
            Self::Even(_) => (one >> 1) + (one >> 8),
            Self::Steps(_) => one,
        };
        Form { c: plane.c + rise + more, ..plane }
    }

    /// The first shadowed slice that a whole value of a plane stands for, 0 to N.
    #[inline(always)]
    #[must_use]
    pub fn depth(self, value: i64) -> u32 {
        match self {
            Self::Even(count) => value.clamp(0, i64::from(count)) as u32,
            Self::Steps(begins) => begins.partition_point(|begin| i64::from(*begin) <= value) as u32,
        }
    }

    /// The same of a deep plane.
    #[inline(always)]
    #[must_use]
    pub fn depth_of_deep(self, value: i64) -> u32 {
        match self {
            Self::Even(_) => self.depth(value),
            Self::Steps(begins) => {
                // The plane's own, or the next one.
                let depth = self.depth(value);
                depth + u32::from(depth < self.count() && i64::from(middle(begins, depth)) <= value)
            }
        }
    }
}

/// The middle of the slice before one, from which deep planes lie behind it; of the first slice its beginning.
#[inline(always)]
fn middle(begins: &[u32], slice: u32) -> u32 {
    let begin = begins[slice as usize];
    let before = begins[(slice as usize).saturating_sub(1)];
    before + ((begin - before) >> 1)
}

/// What lights with one table have in common: log2 of their slices, the ratio of far to near distance, how slices are spread. `None` for a
/// directional light.
fn key(record: &LightRecord) -> Option<(u32, u64, u32)> {
    let is_even = record.depth_distribution().unwrap_or_default() == DepthDistribution::Linear;
    (!is_even).then(|| (record.log2_resolution, (record.far_m / record.near_m).to_bits(), record.depth))
}

/// Words of the tables that silhouettes of these lights need.
pub fn table_words(records: impl IntoIterator<Item = LightRecord>) -> u64 {
    let keys: BTreeSet<_> = records.into_iter().filter_map(|record| key(&record)).collect();
    keys.iter().map(|(log2, ..)| 1u64 << log2).sum()
}

/// Tables of where slices begin, one for all lights of a resolution and a ratio of far to near distance.
#[derive(Default)]
pub(crate) struct Tables {
    made: BTreeMap<(u32, u64, u32), Arc<[u32]>>,
    words: u64,
}

impl Tables {
    /// A light's table; an empty one for a directional light.
    ///
    /// # Errors
    /// [`FormatError::Malformed`] when all would take too much memory.
    pub fn of(&mut self, record: &LightRecord) -> Result<Arc<[u32]>, FormatError> {
        let Some(key) = key(record) else { return Ok(Arc::from([])) };
        if let Some(table) = self.made.get(&key) {
            return Ok(Arc::clone(table));
        }
        let slices = record.resolution();
        self.words += u64::from(slices);
        if self.words > MOST_WORDS {
            return Err(FormatError::Malformed(TOO_MANY));
        }
        let (ratio, distribution) = (record.far_m / record.near_m, record.depth_distribution().unwrap_or_default());
        let table: Arc<[u32]> = (0..slices).map(|k| begin(k, slices, ratio, distribution)).collect::<Vec<_>>().into();
        self.made.insert(key, Arc::clone(&table));
        Ok(table)
    }
}

const TOO_MANY: &str = "its lamps' slices would take over 256 MiB, for each has its own ratio of far to near distance";

#[cfg(test)]
mod tests {
    use super::*;

    fn table(slices: u32, ratio: f64, distribution: DepthDistribution) -> Vec<u32> {
        (0..slices).map(|k| begin(k, slices, ratio, distribution)).collect()
    }

    /// What is baked on one machine is looked up on another: a library whose logarithm changes must not pass unnoticed.
    #[test]
    fn tables_are_the_same_everywhere() {
        let sum =
            |table: &[u32]| table.iter().fold(0u64, |sum, begin| sum.wrapping_mul(31).wrapping_add((*begin).into()));
        let sums: Vec<u64> = [(1024, 1024.0), (4096, 40.5), (65_536, 1e5)]
            .map(|(slices, ratio)| sum(&table(slices, ratio, DepthDistribution::Logarithmic)))
            .into();
        assert_eq!(sums, [6_788_962_457_343_619_952, 16_817_460_711_847_935_549, 8_785_043_942_154_676_983]);
        assert_eq!(sum(&table(1024, 1024.0, DepthDistribution::Ndc)), 9_243_673_285_330_206_720);
    }

    #[test]
    fn a_depth_is_the_number_of_slices_that_a_plane_lies_behind() {
        for distribution in [DepthDistribution::Logarithmic, DepthDistribution::Ndc] {
            let begins = table(64, 300.0, distribution);
            let spread = Spread::Steps(&begins);
            let around = begins.iter().flat_map(|begin| [-1, 0, 1].map(|by| i64::from(*begin) + by));
            let middles = (0..64).flat_map(|z| [-1, 0].map(|by| spread.least_behind(z)[1] + by));
            for value in around.chain(middles).chain([i64::MIN, -1, 1 << 32, i64::MAX]) {
                let behind = |i: usize| (0..64).filter(|z| spread.least_behind(*z)[i] <= value).count() as u32;
                assert_eq!([spread.depth(value), spread.depth_of_deep(value)], [behind(0), behind(1)], "{value}");
            }
        }
    }
}
