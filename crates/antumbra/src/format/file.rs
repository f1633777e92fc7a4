//! A file in memory, checked once.

use alloc::collections::BTreeMap;
use alloc::sync::Arc;
use alloc::vec::Vec;
use core::str;

use super::MAX_LIGHTS;
use super::dag8::{self, NodeCounts};
use super::light::LightRecord;
use super::section::{Entry, REQUIRED, read_table};
use super::stat::BakeStats;
use crate::FormatError;
use crate::lookup::light::LightShadow;
use crate::lookup::top_grid::TopGrid;

/// A validated `.antumbra` file: after [`ShadowFile::from_bytes`] no lookup can fail or read outside.
#[derive(Clone, Debug)]
pub struct ShadowFile {
    pub(crate) pool: Vec<u32>,
    pub(crate) records: Vec<LightRecord>,
    pub(crate) top_grids: Vec<Arc<TopGrid>>,
    names: Vec<u8>,
    stats: Option<BakeStats>,
    sections: Vec<([u8; 4], u64)>,
    counts: NodeCounts,
}

impl ShadowFile {
    /// Reads and validates a whole file: checksums, ranges, node kinds, no cycles. Linear in the file's size; copies
    /// the node pool once and makes a top grid for each light that is not homogeneous (128 KiB at N >= 256).
    ///
    /// # Errors
    /// [`FormatError`], which says what is wrong and what to do. Hostile bytes give an error, never a panic.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, FormatError> {
        let entries = read_table(bytes)?;
        if let Some(e) = entries.iter().find(|e| e.flags & REQUIRED != 0 && !KNOWN.contains(&&e.kind)) {
            return Err(FormatError::UnknownSection { kind: e.kind });
        }
        let section = |kind: &[u8; 4]| find(bytes, &entries, kind);
        let records = read_records(section(b"LGTS")?.ok_or(FormatError::MissingSection("LGTS"))?)?;
        let names = section(b"NAME")?.ok_or(FormatError::MissingSection("NAME"))?.to_vec();
        let pool = read_pool(section(b"DAG8")?.ok_or(FormatError::MissingSection("DAG8"))?)?;
        let stats =
            section(b"STAT")?.map(|s| BakeStats::read(s).ok_or(FormatError::Malformed("the STAT section's size")));
        let checked = dag8::check(&pool)?;
        for (index, record) in records.iter().enumerate() {
            record.check(index)?;
            name_of(&names, record).ok_or(FormatError::Malformed("a light's name lies outside the names"))?;
            if !checked.fits(record.roots[0], record.log2_resolution) {
                return Err(FormatError::Malformed("a light's root is no node of the light's size"));
            }
        }
        let top_grids = make_top_grids(&pool, &records);
        let sections = entries.iter().map(|e| (e.kind, e.size)).collect();
        Ok(Self { counts: checked.counts(), stats: stats.transpose()?, pool, records, top_grids, names, sections })
    }

    /// The file's lights, in its order.
    pub fn lights(&self) -> impl ExactSizeIterator<Item = LightShadow<'_>> {
        (0..self.records.len()).map(|index| LightShadow { file: self, index })
    }

    /// The first light of that name.
    #[must_use]
    pub fn light(&self, name: &str) -> Option<LightShadow<'_>> {
        self.lights().find(|light| light.name() == name)
    }

    /// The shared node pool: upload it as it is. See [`super::dag8`].
    #[must_use]
    pub fn pool(&self) -> &[u32] {
        &self.pool
    }

    /// Nodes by kind over all lights.
    #[must_use]
    pub fn node_counts(&self) -> NodeCounts {
        self.counts
    }

    /// What was baked, if the file says so.
    #[must_use]
    pub fn stats(&self) -> Option<BakeStats> {
        self.stats
    }

    /// Kind and bytes of each section, in the file's order.
    #[must_use]
    pub fn sections(&self) -> &[([u8; 4], u64)] {
        &self.sections
    }

    pub(crate) fn name(&self, index: usize) -> &str {
        name_of(&self.names, &self.records[index]).unwrap_or_default()
    }
}

const KNOWN: [&[u8; 4]; 4] = [b"LGTS", b"NAME", b"DAG8", b"STAT"];

/// One grid for all lights with the same root; small ones where a light is homogeneous.
fn make_top_grids(pool: &[u32], records: &[LightRecord]) -> Vec<Arc<TopGrid>> {
    let mut made = BTreeMap::new();
    let mut grid = |r: &LightRecord| {
        let new = || Arc::new(TopGrid::new(pool, r.roots[0], r.log2_resolution));
        Arc::clone(made.entry((r.roots[0], r.log2_resolution)).or_insert_with(new))
    };
    records.iter().map(&mut grid).collect()
}

/// The one section of that kind, if there is one.
fn find<'a>(bytes: &'a [u8], entries: &[Entry], kind: &[u8; 4]) -> Result<Option<&'a [u8]>, FormatError> {
    let mut found = entries.iter().filter(|e| e.kind == *kind);
    let first = found.next();
    if found.next().is_some() {
        return Err(FormatError::Malformed("a section occurs twice"));
    }
    Ok(first.map(|e| &bytes[e.offset as usize..(e.offset + e.size) as usize]))
}

fn read_records(section: &[u8]) -> Result<Vec<LightRecord>, FormatError> {
    let (records, rest) = section.as_chunks::<{ size_of::<LightRecord>() }>();
    if records.is_empty() || !rest.is_empty() {
        return Err(FormatError::Malformed("the light records are cut off or missing"));
    }
    if records.len() > MAX_LIGHTS {
        return Err(FormatError::Malformed("it holds more than 4096 lights"));
    }
    Ok(records.iter().map(|r| LightRecord::from_le_bytes(r)).collect())
}

fn read_pool(section: &[u8]) -> Result<Vec<u32>, FormatError> {
    let (words, rest) = section.as_chunks::<4>();
    if rest.is_empty() {
        Ok(words.iter().map(|w| u32::from_le_bytes(*w)).collect())
    } else {
        Err(FormatError::Malformed("the node pool is cut off"))
    }
}

fn name_of<'a>(names: &'a [u8], record: &LightRecord) -> Option<&'a str> {
    let start = record.name_offset as usize;
    let end = start.checked_add(record.name_length as usize)?;
    str::from_utf8(names.get(start..end)?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::write::assemble;

    type Section<'a> = ([u8; 4], u32, &'a [u8]);

    fn record() -> Vec<u8> {
        let mut record: LightRecord = bytemuck::Zeroable::zeroed();
        (record.log2_resolution, record.texel_size_m, record.slice_size_m) = (6, 1.0, 1.0);
        bytemuck::bytes_of(&record).to_vec()
    }

    fn read(extra: &[Section<'_>], without: usize) -> Result<ShadowFile, FormatError> {
        let (lights, pool) = (record(), [0; 32]);
        let mut sections: Vec<Section<'_>> =
            [(*b"LGTS", 1, &lights[..]), (*b"NAME", 1, b""), (*b"DAG8", 1, &pool)].to_vec();
        if without < sections.len() {
            sections.remove(without);
        }
        sections.extend_from_slice(extra);
        ShadowFile::from_bytes(&assemble(&sections))
    }

    #[test]
    fn unknown_sections_are_skipped_unless_required() {
        assert!(read(&[(*b"LATR", 0, b"what a later version adds")], 9).is_ok());
        let refused = read(&[(*b"LATR", 1, b"what a reader must know")], 9);
        assert_eq!(refused.err(), Some(FormatError::UnknownSection { kind: *b"LATR" }));
    }

    #[test]
    fn sections_occur_once_and_the_required_ones_do() {
        let lights = record();
        assert!(read(&[(*b"LGTS", 1, &lights)], 9).is_err());
        for (without, name) in ["LGTS", "NAME", "DAG8"].into_iter().enumerate() {
            assert_eq!(read(&[], without).err(), Some(FormatError::MissingSection(name)));
        }
    }

    #[test]
    fn stray_bytes_between_sections_are_noticed() {
        let (lights, pool) = (record(), [0; 32]);
        let sections: [Section<'_>; 3] = [(*b"LGTS", 1, &lights), (*b"NAME", 1, b"x"), (*b"DAG8", 1, &pool)];
        let bytes = assemble(&sections);
        assert!(ShadowFile::from_bytes(&bytes).is_ok());
        // Behind the one byte of the names, and behind the section table.
        for at in [513, 200] {
            let mut stray = bytes.clone();
            stray[at] = 1;
            assert!(ShadowFile::from_bytes(&stray).is_err(), "a stray byte at {at}");
        }
    }
}
