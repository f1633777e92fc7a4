//! A file in memory, checked once.

use alloc::collections::BTreeMap;
use alloc::sync::Arc;
use alloc::vec;
use alloc::vec::Vec;
use core::str;

use super::dag8::{self, NodeCounts};
use super::enter::{self, LightEnters};
use super::light::{Encoding, LightRecord, MIN_LOG2_RESOLUTION};
use super::packed;
use super::section::{Entry, REQUIRED, read_table};
use super::silhouette;
use super::slices::{self, Spread};
use super::stat::BakeStats;
use super::{ENTERS, LEVELS, MAX_LIGHTS};
use crate::lookup::light::LightShadow;
use crate::lookup::project::Projection;
use crate::lookup::top_grid::{self, TopGrid};
use crate::{FormatError, LightKind};

/// A validated `.antumbra` file: after [`ShadowFile::from_bytes`] no lookup can fail or read outside.
#[derive(Clone, Debug)]
pub struct ShadowFile {
    pub(crate) pool: Vec<u32>,
    pub(crate) records: Vec<LightRecord>,
    /// By light, then by face.
    pub(crate) top_grids: Vec<Vec<Arc<TopGrid>>>,
    pub(crate) projections: Vec<Projection>,
    /// By light: where slices begin, of local lights in silhouettes.
    pub(crate) slices: Vec<Arc<[u32]>>,
    /// By light, level (1 first) and face: roots of the coarse levels; no levels where the file has none.
    pub(crate) level_roots: Vec<Vec<Vec<u32>>>,
    pub(crate) level_grids: Vec<Vec<Vec<Arc<TopGrid>>>>,
    pub(crate) enters: Option<Vec<LightEnters>>,
    names: Vec<u8>,
    stats: Option<BakeStats>,
    sections: Vec<([u8; 4], u64)>,
    counts: NodeCounts,
}

impl ShadowFile {
    /// Reads and validates a whole file: checksums, ranges, node kinds, no cycles. Linear in the file's size; copies
    /// the node pool once (or unpacks it) and makes a top grid for each face that is not homogeneous (128 KiB at N >= 256, 16 KiB for
    /// each face of a cube, up to as much again for each coarse level; of silhouettes 600 KiB, 10 KiB, or a seventh of the pool). For lamps in
    /// silhouettes it computes where slices begin: 4 N bytes, once for each ratio of far to near distance.
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
        let mut pools = POOLS.into_iter().filter_map(|kind| section(kind).transpose().map(|bytes| (kind, bytes)));
        let (pool_kind, nodes) = pools.next().ok_or(FormatError::MissingSection("DAG8"))?;
        let nodes = nodes?;
        if pools.next().is_some() {
            return Err(FormatError::Malformed("it holds two node pools"));
        }
        let encoding = if pool_kind == b"DAG8" { Encoding::Dag8 } else { Encoding::Silhouette };
        let stats =
            section(b"STAT")?.map(|s| BakeStats::read(s).ok_or(FormatError::Malformed("the STAT section's size")));
        for (index, record) in records.iter().enumerate() {
            record.check(index)?;
            if record.node_encoding() != Some(encoding) {
                return Err(FormatError::Malformed("a light's encoding is not that of the node pool"));
            }
            name_of(&names, record).ok_or(FormatError::Malformed("a light's name lies outside the names"))?;
        }
        let faces = |r: &LightRecord| core::iter::repeat_n(r.log2_resolution, r.face_roots().len());
        let pool = match pool_kind {
            b"SILP" => packed::unpack(nodes, &records.iter().flat_map(faces).collect::<Vec<_>>())?,
            _ => read_pool(nodes)?,
        };
        let (counts, level_roots) = match encoding {
            Encoding::Dag8 => check_dag8(&pool, &records, section(&LEVELS)?)?,
            Encoding::Silhouette => check_silhouettes(&pool, &records, section(&LEVELS)?)?,
        };
        let enters = section(&ENTERS)?.map(|bytes| enter::read(bytes, &records)).transpose()?;
        let mut tables = slices::Tables::default();
        let is_flat = encoding == Encoding::Silhouette;
        let slices = records.iter().map(|record| if is_flat { tables.of(record) } else { Ok(Arc::from([])) });
        let slices = slices.collect::<Result<Vec<Arc<[u32]>>, _>>()?;
        let all_faces = records.iter().map(|record| record.face_roots().len()).sum();
        let mut grids = Grids { pool: &pool, is_flat, faces: all_faces, made: BTreeMap::new() };
        Ok(Self {
            counts,
            stats: stats.transpose()?,
            top_grids: records.iter().zip(&slices).map(|(record, slices)| grids.of_light(record, slices)).collect(),
            projections: records.iter().map(Projection::new).collect(),
            slices,
            level_grids: records.iter().zip(&level_roots).map(|(r, levels)| grids.of_levels(r, levels)).collect(),
            level_roots,
            enters,
            sections: entries.iter().map(|e| (e.kind, e.size)).collect(),
            pool,
            records,
            names,
        })
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

    /// Whether any light has coarse levels: [`LightShadow::has_levels`].
    #[must_use]
    pub fn has_levels(&self) -> bool {
        self.lights().any(LightShadow::has_levels)
    }

    /// Whether the file holds enter depths.
    #[must_use]
    pub fn has_enter_depths(&self) -> bool {
        self.enters.is_some()
    }

    /// How shadows are stored: the same for all lights of a file.
    #[must_use]
    pub fn encoding(&self) -> Encoding {
        self.records.first().and_then(LightRecord::node_encoding).unwrap_or_default()
    }

    /// The shared node pool: upload it as it is. See [`super::dag8`] and [`super::silhouette`].
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

const KNOWN: [&[u8; 4]; 6] = [b"LGTS", b"NAME", b"DAG8", b"SILH", b"SILP", b"STAT"];
/// Sections that hold the node pool, one of them in each file.
const POOLS: [&[u8; 4]; 3] = [b"DAG8", b"SILH", b"SILP"];

/// By light, level and face.
type LevelRoots = Vec<Vec<Vec<u32>>>;

fn check_dag8(
    pool: &[u32],
    records: &[LightRecord],
    levels: Option<&[u8]>,
) -> Result<(NodeCounts, LevelRoots), FormatError> {
    let checked = dag8::check(pool)?;
    let fits =
        |record: &LightRecord| record.face_roots().iter().all(|root| checked.fits(*root, record.log2_resolution));
    if !records.iter().all(fits) {
        return Err(FormatError::Malformed("a light's root is no node of the light's size"));
    }
    let level_roots = match levels {
        Some(bytes) => read_levels(bytes, records, &checked)?,
        None => vec![Vec::new(); records.len()],
    };
    Ok((checked.counts(), level_roots))
}

fn check_silhouettes(
    pool: &[u32],
    records: &[LightRecord],
    levels: Option<&[u8]>,
) -> Result<(NodeCounts, LevelRoots), FormatError> {
    if levels.is_some() {
        return Err(FormatError::Malformed("it has coarse levels, which silhouettes do not know"));
    }
    let mut check = silhouette::Check::new(pool)?;
    for record in records {
        let log2 = record.log2_resolution;
        let is_local = record.light_kind() != Some(LightKind::Directional);
        record.face_roots().iter().try_for_each(|root| check.tree(*root, log2, is_local))?;
    }
    Ok((check.finish()?, vec![Vec::new(); records.len()]))
}

/// log2 of the most cells per side of a cube's faces: 16 KiB each instead of 128, for a lamp has six.
const CUBE_CELLS: u32 = 4;
/// The same of a local light's coarse levels, of which there are many.
const LOCAL_LEVEL_CELLS: u32 = 3;

/// Makes top grids: one for all faces and levels with the same root, small ones where a face is homogeneous.
struct Grids<'a> {
    pool: &'a [u32],
    /// Whether nodes are tiles.
    is_flat: bool,
    /// Of all lights: one at least.
    faces: usize,
    /// By root, its size, cells, and where slices begin.
    made: BTreeMap<(u32, u32, u32, usize), Arc<TopGrid>>,
}

impl Grids<'_> {
    fn grid(&mut self, root: u32, log2: u32, most_log2: u32, slices: &[u32]) -> Arc<TopGrid> {
        let new = || {
            Arc::new(if self.is_flat {
                let most_log2 = top_grid::flat_log2(most_log2, self.pool.len() / self.faces);
                TopGrid::new_flat(self.pool, root, log2, most_log2, Spread::new(1 << log2, slices))
            } else {
                TopGrid::new(self.pool, root, log2, most_log2)
            })
        };
        let table = if slices.is_empty() { 0 } else { slices.as_ptr() as usize };
        Arc::clone(self.made.entry((root, log2, most_log2, table)).or_insert_with(new))
    }

    fn of_light(&mut self, record: &LightRecord, slices: &[u32]) -> Vec<Arc<TopGrid>> {
        let log2 = record.log2_resolution;
        let most = if record.faces == 1 { top_grid::MAX_LOG2_CELLS } else { CUBE_CELLS };
        record.face_roots().iter().map(|root| self.grid(*root, log2, most, slices)).collect()
    }

    fn of_levels(&mut self, record: &LightRecord, levels: &[Vec<u32>]) -> Vec<Vec<Arc<TopGrid>>> {
        let is_local = record.light_kind() != Some(LightKind::Directional);
        let most = if is_local { LOCAL_LEVEL_CELLS } else { top_grid::MAX_LOG2_CELLS };
        let of_level = |(i, roots): (usize, &Vec<u32>)| {
            let log2 = record.log2_resolution - 1 - i as u32;
            roots.iter().map(|root| self.grid(*root, log2, most, &[])).collect()
        };
        levels.iter().enumerate().map(of_level).collect()
    }
}

/// Coarse levels of a light.
fn level_count(record: &LightRecord) -> usize {
    (record.log2_resolution - MIN_LOG2_RESOLUTION) as usize
}

fn read_levels(
    section: &[u8],
    records: &[LightRecord],
    checked: &dag8::Checked,
) -> Result<Vec<Vec<Vec<u32>>>, FormatError> {
    let mut roots = read_pool(section)?.into_iter();
    let mut lights = Vec::with_capacity(records.len());
    for record in records {
        let mut levels = Vec::with_capacity(level_count(record));
        for level in 1..=level_count(record) as u32 {
            let faces: Vec<u32> = roots.by_ref().take(record.faces as usize).collect();
            let fits = |root: &u32| checked.fits(*root, record.log2_resolution - level);
            if faces.len() != record.faces as usize || !faces.iter().all(fits) {
                return Err(FormatError::Malformed("the coarse levels are cut off or refer to no nodes of their size"));
            }
            levels.push(faces);
        }
        lights.push(levels);
    }
    match roots.next() {
        None => Ok(lights),
        Some(_) => Err(FormatError::Malformed("the coarse levels are too many")),
    }
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
        (record.log2_resolution, record.texel_size_m, record.slice_size_m, record.faces) = (6, 1.0, 1.0, 1);
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
