//! Puts sections together into a file's bytes.

use alloc::borrow::Cow;
use alloc::vec::Vec;

use xxhash_rust::xxh3::Xxh3;

use super::light::{Encoding, LightRecord};
use super::section::{ENTRY_BYTES, Entry, HEADER_BYTES, Header, REQUIRED, table_checksum};
use super::stat::BakeStats;
use super::{ENTERS, LEVELS, MAGIC, SECTION_ALIGNMENT, VERSION_MAJOR, VERSION_MINOR};

/// Everything that a file holds.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Contents<'a> {
    /// One record per light.
    pub lights: &'a [LightRecord],
    /// Text that the records' names point into.
    pub names: &'a str,
    /// The shared node pool, words in host order, in the encoding that the lights name: [`super::dag8`] or [`super::silhouette`].
    pub pool: &'a [u32],
    /// The packed form of a pool of silhouettes ([`super::packed`]), to be stored in the pool's place: a third of the bytes, but a file cannot be
    /// mapped to be looked up in.
    pub packed: Option<&'a [u8]>,
    /// What was baked.
    pub stats: BakeStats,
    /// Roots of coarse levels, if there are any: the contents of [`super::LEVELS`].
    pub levels: Option<&'a [u32]>,
    /// Enter depths, if there are any: the contents of [`super::enter`].
    pub enters: Option<&'a [u8]>,
}

impl<'a> Contents<'a> {
    /// A file without optional lookups.
    #[must_use]
    pub fn new(lights: &'a [LightRecord], names: &'a str, pool: &'a [u32], stats: BakeStats) -> Self {
        Self { lights, names, pool, packed: None, stats, levels: None, enters: None }
    }
}

/// The file's bytes. The same contents give the same bytes on every machine.
#[must_use]
pub fn write(contents: &Contents<'_>) -> Vec<u8> {
    write_paced(contents, &mut || {})
}

/// The same; `pause` is called between blocks of a quarter of a megabyte.
#[must_use]
pub fn write_paced(contents: &Contents<'_>, pause: &mut dyn FnMut()) -> Vec<u8> {
    let lights: Vec<LightRecord> = contents.lights.iter().map(|r| r.to_le()).collect();
    let (pool_kind, pool) = pool_section(contents);
    let levels = contents.levels.map(words_to_le);
    let stats = contents.stats.to_le();
    let mut sections: Vec<([u8; 4], u32, &[u8])> = alloc::vec![
        (*b"LGTS", REQUIRED, bytemuck::cast_slice(&lights)),
        (*b"NAME", REQUIRED, contents.names.as_bytes()),
        (pool_kind, REQUIRED, &pool),
        (*b"STAT", 0, bytemuck::bytes_of(&stats)),
    ];
    sections.extend(levels.as_ref().map(|roots| (LEVELS, 0, bytemuck::cast_slice(roots))));
    sections.extend(contents.enters.map(|bytes| (ENTERS, 0, bytes)));
    assemble_paced(&sections, pause)
}

/// The section of the node pool.
fn pool_section<'a>(contents: &Contents<'a>) -> ([u8; 4], Cow<'a, [u8]>) {
    let as_it_is = || match words_to_le(contents.pool) {
        Cow::Borrowed(words) => Cow::Borrowed(bytemuck::cast_slice(words)),
        Cow::Owned(words) => Cow::Owned(bytemuck::cast_slice(&words).to_vec()),
    };
    let is_silhouette = contents.lights.first().and_then(LightRecord::node_encoding) == Some(Encoding::Silhouette);
    match contents.packed {
        Some(packed) if is_silhouette => (*b"SILP", Cow::Borrowed(packed)),
        _ if is_silhouette => (*b"SILH", as_it_is()),
        _ => (*b"DAG8", as_it_is()),
    }
}

/// The words in little-endian order: as they are on nearly every machine.
fn words_to_le(pool: &[u32]) -> Cow<'_, [u32]> {
    if cfg!(target_endian = "little") { Cow::Borrowed(pool) } else { pool.iter().map(|w| w.to_le()).collect() }
}

/// Bytes that are copied and hashed at a time.
const BLOCK: usize = 1 << 18;

/// Header, table and sections, in the order given.
#[cfg(test)]
pub(crate) fn assemble(sections: &[([u8; 4], u32, &[u8])]) -> Vec<u8> {
    assemble_paced(sections, &mut || {})
}

fn assemble_paced(sections: &[([u8; 4], u32, &[u8])], pause: &mut dyn FnMut()) -> Vec<u8> {
    let table_end = HEADER_BYTES + sections.len() * ENTRY_BYTES;
    let padded = |size: usize| size.next_multiple_of(SECTION_ALIGNMENT);
    let total = padded(table_end) + sections.iter().map(|(_, _, data)| padded(data.len())).sum::<usize>();
    let mut bytes = Vec::with_capacity(total);
    bytes.resize(table_end, 0);
    let mut table = Vec::with_capacity(sections.len() * ENTRY_BYTES);
    for &(kind, flags, data) in sections {
        bytes.resize(bytes.len().next_multiple_of(SECTION_ALIGNMENT), 0);
        let offset = bytes.len() as u64;
        let mut hash = Xxh3::new();
        for block in data.chunks(BLOCK) {
            hash.update(block);
            bytes.extend_from_slice(block);
            pause();
        }
        let entry = Entry {
            kind,
            flags: flags.to_le(),
            offset: offset.to_le(),
            size: (data.len() as u64).to_le(),
            checksum: hash.digest().to_le(),
        };
        table.extend_from_slice(bytemuck::bytes_of(&entry));
    }
    let mut header = Header {
        magic: MAGIC,
        major: VERSION_MAJOR.to_le(),
        minor: VERSION_MINOR.to_le(),
        section_count: (sections.len() as u32).to_le(),
        file_bytes: (bytes.len() as u64).to_le(),
        table_checksum: 0,
        zero: [0; 32],
    };
    header.table_checksum = table_checksum(&bytemuck::bytes_of(&header)[..24], &table).to_le();
    bytes[..HEADER_BYTES].copy_from_slice(bytemuck::bytes_of(&header));
    bytes[HEADER_BYTES..table_end].copy_from_slice(&table);
    bytes
}
