//! From thresholds to voxels: bits of darkness, extruded away from the light along alpha.

use crate::area::VoxelResolution;

/// Voxels by theta, then alpha: one bit per phi in `phi / 32` words, set where it is dark.
pub(crate) fn voxels(size: VoxelResolution, thresholds: &[u32]) -> Vec<u32> {
    let words = (size.phi / 32) as usize;
    let row_words = size.alpha as usize * words;
    let mut out = vec![0; size.theta as usize * row_words];
    for (row, thresholds) in out.chunks_mut(row_words).zip(thresholds.chunks(size.phi as usize)) {
        for (phi, &threshold) in thresholds.iter().enumerate() {
            if threshold < size.alpha {
                row[threshold as usize * words + phi / 32] |= 1 << (phi % 32);
            }
        }
        for at in words..row_words {
            row[at] |= row[at - words];
        }
    }
    out
}
