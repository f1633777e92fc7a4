//! The header and the section table.

use alloc::vec::Vec;

use bytemuck::{Pod, Zeroable};
use xxhash_rust::xxh3::{Xxh3, xxh3_64};

use super::{MAGIC, MAX_SECTIONS, SECTION_ALIGNMENT, VERSION_MAJOR};
use crate::FormatError;

/// First 64 bytes of a file; see the module's table.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Header {
    pub magic: [u8; 8],
    pub major: u16,
    pub minor: u16,
    pub section_count: u32,
    pub file_bytes: u64,
    pub table_checksum: u64,
    pub zero: [u8; 32],
}

/// One entry of the section table.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Entry {
    pub kind: [u8; 4],
    pub flags: u32,
    pub offset: u64,
    pub size: u64,
    pub checksum: u64,
}

/// A reader that does not know the section must refuse the file.
pub(crate) const REQUIRED: u32 = 1;

pub(crate) const HEADER_BYTES: usize = size_of::<Header>();
pub(crate) const ENTRY_BYTES: usize = size_of::<Entry>();

/// XXH3-64 of the header's checked part and the table.
pub(crate) fn table_checksum(header_prefix: &[u8], table: &[u8]) -> u64 {
    let mut hash = Xxh3::new();
    hash.update(header_prefix);
    hash.update(table);
    hash.digest()
}

/// Reads the header and the table; checks lengths, checksums and padding. Every returned range lies within `bytes`.
pub(crate) fn read_table(bytes: &[u8]) -> Result<Vec<Entry>, FormatError> {
    let header = read_header(bytes)?;
    let count = header.section_count as usize;
    let table_end = HEADER_BYTES + count * ENTRY_BYTES;
    let table = bytes.get(HEADER_BYTES..table_end).ok_or(FormatError::Malformed("the section table is cut off"))?;
    if table_checksum(&bytes[..24], table) != header.table_checksum {
        return Err(FormatError::Checksum { part: "header" });
    }
    let entries: Vec<Entry> =
        table.chunks_exact(ENTRY_BYTES).map(|c| from_le(bytemuck::pod_read_unaligned(c))).collect();
    let mut end = table_end as u64;
    for entry in &entries {
        end = check_entry(bytes, entry, end)?;
    }
    if end != bytes.len() as u64 {
        return Err(FormatError::Malformed("bytes follow the last section"));
    }
    Ok(entries)
}

fn read_header(bytes: &[u8]) -> Result<Header, FormatError> {
    if !bytes.starts_with(&MAGIC) {
        return Err(FormatError::NotAntumbra);
    }
    let found = bytes.len() as u64;
    let raw = bytes.get(..HEADER_BYTES).ok_or(FormatError::Length { expected: HEADER_BYTES as u64, found })?;
    let raw: Header = bytemuck::pod_read_unaligned(raw);
    let (major, minor) = (u16::from_le(raw.major), u16::from_le(raw.minor));
    if major != VERSION_MAJOR {
        return Err(FormatError::Version { major, minor });
    }
    let expected = u64::from_le(raw.file_bytes);
    if expected != found {
        return Err(FormatError::Length { expected, found });
    }
    let section_count = u32::from_le(raw.section_count);
    if section_count == 0 || section_count as usize > MAX_SECTIONS || raw.zero != [0; 32] {
        return Err(FormatError::Malformed("the header has an impossible section count or stray bytes"));
    }
    let table_checksum = u64::from_le(raw.table_checksum);
    Ok(Header { major, minor, section_count, file_bytes: expected, table_checksum, ..raw })
}

fn from_le(e: Entry) -> Entry {
    Entry {
        kind: e.kind,
        flags: u32::from_le(e.flags),
        offset: u64::from_le(e.offset),
        size: u64::from_le(e.size),
        checksum: u64::from_le(e.checksum),
    }
}

/// Checks one entry that must begin right after `previous_end`, padding apart; returns its end.
fn check_entry(bytes: &[u8], entry: &Entry, previous_end: u64) -> Result<u64, FormatError> {
    let offset = previous_end.next_multiple_of(SECTION_ALIGNMENT as u64);
    let end = entry.offset.checked_add(entry.size);
    let Some(end) = end.filter(|&end| entry.offset == offset && end <= bytes.len() as u64) else {
        return Err(FormatError::Malformed("a section lies outside the file or out of order"));
    };
    if bytes[previous_end as usize..offset as usize].iter().any(|&b| b != 0) {
        return Err(FormatError::Malformed("stray bytes between sections"));
    }
    if xxh3_64(&bytes[offset as usize..end as usize]) != entry.checksum {
        return Err(FormatError::Checksum { part: part_name(entry.kind) });
    }
    Ok(end)
}

fn part_name(kind: [u8; 4]) -> &'static str {
    match &kind {
        b"LGTS" => "light records",
        b"NAME" => "names",
        b"DAG8" | b"SILH" => "node pool",
        b"STAT" => "statistics",
        b"LODS" => "coarse levels",
        b"ENTR" => "enter depths",
        _ => "optional data",
    }
}
