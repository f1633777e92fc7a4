//! The optional `ENTR` section: coarse bounds of the depth at which rays first meet a caster.
//!
//! Transition depths in the node pool may lie anywhere inside a solid; these do not. For each light, in the file's order:
//!
//! ```text
//! offset  size  field
//!      0     4  log2 of the cells per side C: at most 9, and at most log2(N) - 3
//!      4     4  shift S, at most 8: depths are stored in units of 2^S slices
//!      8   4*k  k = faces * C * C cells, face by face, row by row:
//!                 0  2  least first shadowed slice of the cell's texels, rounded down; 65535: no texel meets a caster
//!                 2  2  greatest one, rounded up; 65535: some texel meets none
//! ```
//!
//! The bounds hold for every texel; they need not be met by one.

use alloc::vec::Vec;

use super::light::LightRecord;
use crate::FormatError;

/// log2 of the most cells per side.
pub const MAX_LOG2_CELLS: u32 = 9;
/// No caster.
pub const NONE: u16 = u16::MAX;

/// Texels per cell and side (as a power of two) that a bake uses: cells of 32 texels, or larger ones where there would be
/// more than 512 per side.
#[must_use]
pub fn log2_cells(log2_resolution: u32) -> u32 {
    (log2_resolution - 5).min(MAX_LOG2_CELLS)
}

/// Bits by which slices are shifted, so that all of them are below [`NONE`].
#[must_use]
pub fn shift(log2_resolution: u32) -> u32 {
    // The last slice + 1 must still differ from `NONE`.
    (log2_resolution + 1).saturating_sub(16)
}

/// Least and greatest first shadowed slice, in stored units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cell {
    /// [`NONE`] where no ray meets anything.
    pub least: u16,
    /// [`NONE`] where some ray meets nothing.
    pub greatest: u16,
}

impl Cell {
    /// Bounds of two cells together.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { least: self.least.min(other.least), greatest: self.greatest.max(other.greatest) }
    }
}

/// One face's cells, and ever coarser ones up to a single cell.
#[derive(Clone, Debug)]
pub(crate) struct EnterPyramid {
    /// Finest first.
    pub levels: Vec<Vec<Cell>>,
    pub log2_cells: u32,
}

/// One light's enter depths.
#[derive(Clone, Debug)]
pub(crate) struct LightEnters {
    pub shift: u32,
    pub faces: Vec<EnterPyramid>,
}

/// Writes one light's part of the section: its faces' cells, 4^`log2_cells` each.
pub fn push(section: &mut Vec<u8>, log2_cells: u32, shift: u32, faces: &[Vec<Cell>]) {
    section.extend(log2_cells.to_le_bytes());
    section.extend(shift.to_le_bytes());
    for cell in faces.iter().flatten() {
        section.extend(cell.least.to_le_bytes());
        section.extend(cell.greatest.to_le_bytes());
    }
}

/// Reads the whole section.
pub(crate) fn read(section: &[u8], records: &[LightRecord]) -> Result<Vec<LightEnters>, FormatError> {
    let cut_off = FormatError::Malformed("the enter depths are cut off or of an impossible size");
    let mut rest = section;
    let mut lights = Vec::with_capacity(records.len());
    for record in records {
        let (head, tail) = rest.split_at_checked(8).ok_or(cut_off.clone())?;
        let word = |i: usize| u32::from_le_bytes([head[i], head[i + 1], head[i + 2], head[i + 3]]);
        let (log2_cells, shift) = (word(0), word(4));
        if log2_cells > MAX_LOG2_CELLS.min(record.log2_resolution - 3) || shift > 8 {
            return Err(cut_off);
        }
        let face_bytes = 4usize << (2 * log2_cells);
        let faces = record.faces as usize;
        let (cells, tail) = tail.split_at_checked(faces * face_bytes).ok_or(cut_off.clone())?;
        rest = tail;
        let pyramid = |bytes: &[u8]| EnterPyramid::new(read_cells(bytes), log2_cells);
        lights.push(LightEnters { shift, faces: cells.chunks_exact(face_bytes).map(pyramid).collect() });
    }
    if rest.is_empty() { Ok(lights) } else { Err(cut_off) }
}

fn read_cells(bytes: &[u8]) -> Vec<Cell> {
    let cell =
        |c: &[u8; 4]| Cell { least: u16::from_le_bytes([c[0], c[1]]), greatest: u16::from_le_bytes([c[2], c[3]]) };
    bytes.as_chunks::<4>().0.iter().map(cell).collect()
}

impl EnterPyramid {
    fn new(cells: Vec<Cell>, log2_cells: u32) -> Self {
        let mut levels = alloc::vec![cells];
        for log2 in (0..log2_cells).rev() {
            let (fine, side) = (&levels[levels.len() - 1], 1usize << log2);
            let coarse = (0..side * side).map(|i| {
                let at = 4 * (i / side) * side + 2 * (i % side);
                let below = at + 2 * side;
                fine[at].union(fine[at + 1]).union(fine[below].union(fine[below + 1]))
            });
            let coarse = coarse.collect();
            levels.push(coarse);
        }
        Self { levels, log2_cells }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pyramids_bound_what_lies_below() {
        let cells: Vec<Cell> = (0..16).map(|i| Cell { least: 100 - i, greatest: 200 + i }).collect();
        let pyramid = EnterPyramid::new(cells, 2);
        assert_eq!(pyramid.levels.len(), 3);
        assert_eq!(pyramid.levels[1][0], Cell { least: 95, greatest: 205 });
        assert_eq!(pyramid.levels[1][3], Cell { least: 85, greatest: 215 });
        assert_eq!(pyramid.levels[2], [Cell { least: 85, greatest: 215 }]);
    }
}
