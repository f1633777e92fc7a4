//! Takes a `.glb` apart: a 12-byte header, then chunks.
//!
//! ```text
//! offset  size  field
//!      0     4  "glTF"
//!      4     4  version, 2
//!      8     4  length of everything
//!     12     8  chunk header: length, type ("JSON" first, then "BIN\0"; others are skipped)
//!     20     .  chunk, padded to 4 bytes
//! ```

use crate::error::SceneError;

const MAGIC: &[u8] = b"glTF";
const CHUNK_JSON: [u8; 4] = *b"JSON";
const CHUNK_BIN: [u8; 4] = *b"BIN\0";

/// The two parts of a glTF file.
pub(super) struct Container<'a> {
    pub json: &'a [u8],
    /// The GLB's own buffer, if there is one.
    pub bin: Option<&'a [u8]>,
}

/// Splits a GLB; anything else is taken for a JSON document.
pub(super) fn open(bytes: &[u8]) -> Result<Container<'_>, SceneError> {
    if !bytes.starts_with(MAGIC) {
        return Ok(Container { json: bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes), bin: None });
    }
    let (version, length) = (word(bytes, 4)?, word(bytes, 8)? as usize);
    if version != 2 {
        return Err(SceneError::format(format!("it is GLB version {version}, but only version 2 is supported")));
    }
    let body = bytes.get(12..length).ok_or_else(|| {
        SceneError::format(format!("it is cut short: the header says {length} bytes, there are {}", bytes.len()))
    })?;
    split_chunks(body)
}

fn split_chunks(mut body: &[u8]) -> Result<Container<'_>, SceneError> {
    let (mut json, mut bin) = (None, None);
    while !body.is_empty() {
        let length = word(body, 0)? as usize;
        let kind = word(body, 4)?.to_le_bytes();
        let chunk = body[8..].get(..length).ok_or_else(|| SceneError::format("a GLB chunk is longer than the file"))?;
        match kind {
            CHUNK_JSON if json.is_none() => json = Some(chunk),
            CHUNK_BIN if bin.is_none() => bin = Some(chunk),
            _ => {}
        }
        // Some writers forget the padding of the last chunk.
        body = body[8..].get(length.next_multiple_of(4)..).unwrap_or_default();
    }
    let json = json.ok_or_else(|| SceneError::format("the GLB has no JSON chunk"))?;
    Ok(Container { json, bin })
}

fn word(bytes: &[u8], at: usize) -> Result<u32, SceneError> {
    let word = bytes.get(at..).and_then(|rest| rest.first_chunk());
    word.map(|w| u32::from_le_bytes(*w)).ok_or_else(|| SceneError::format("the GLB is cut short"))
}
