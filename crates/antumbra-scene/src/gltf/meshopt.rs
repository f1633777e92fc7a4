//! Buffer views packed by meshoptimizer: EXT_meshopt_compression and its successor KHR_meshopt_compression.
//!
//! Follows the bitstream descriptions of those two extensions (Arseny Kapoulkine, 2021 and 2025; Khronos glTF registry).
//! Indices go through the crate `meshopt-rs`. Attributes are unpacked here, because that crate fixes the stride at compile
//! time and does not know version 1 of the stream.
//!
//! ```text
//! stream = header (0xA0 | version), block..., padding, tail
//! block  = up to 256 elements: [version 1: control byte per 4 bytes of stride] then, for each byte of the stride, one
//!          row: that byte of all elements of the block, as differences from the element before
//! row    = 2 header bits per group of 16, then the groups: each byte in 0, 1, 2, 4 or 8 bits, all ones meaning that
//!          the byte follows the group whole
//! tail   = the element before the first, [version 1: channel byte per 4 bytes of stride]
//! ```

use meshopt_rs::index;

use super::meshopt_filters;
use super::schema::Meshopt;
use crate::error::SceneError;

const GROUP: usize = 16;
const MAX_BLOCK_BYTES: usize = 8192;
const MAX_BLOCK_ELEMENTS: usize = 256;
/// Every group must have this many bytes before the end, whatever it uses: streams carry padding for fast decoders.
const GROUP_READ_AHEAD: usize = 24;
/// Bits per byte by the two header bits, for version 0 and the two row kinds of version 1.
const BITS_V0: [u32; 4] = [0, 2, 4, 8];
const BITS_V1: [[u32; 4]; 2] = [[0, 1, 2, 4], [1, 2, 4, 8]];
/// The densest stream: a version 1 block of 256 elements whose rows are all zero has two bits per row.
const MAX_RATIO: usize = 1024;

/// Unpacks one buffer view.
pub(super) fn unpack(input: &[u8], packed: &Meshopt) -> Result<Vec<u8>, SceneError> {
    let length = packed.count.checked_mul(packed.byte_stride);
    let length = length.filter(|&n| n <= input.len().saturating_mul(MAX_RATIO).saturating_add(MAX_BLOCK_BYTES));
    let length = length.ok_or_else(|| SceneError::limit("a compressed buffer view claims more than it can hold"))?;
    match (packed.mode.as_str(), packed.byte_stride) {
        ("ATTRIBUTES", stride @ 4..=256) if stride % 4 == 0 => {
            let mut out = vec![0; length];
            unpack_attributes(&mut out, stride, input).ok_or_else(damaged)?;
            if let Some(filter) = &packed.filter {
                meshopt_filters::apply(filter, &mut out, stride)?;
            }
            Ok(out)
        }
        ("TRIANGLES", 2 | 4) if packed.count.is_multiple_of(3) => {
            unpack_indices(packed, input, |out, input| index::buffer::decode_index_buffer(out, input).is_ok())
        }
        ("INDICES", 2 | 4) => {
            unpack_indices(packed, input, |out, input| index::sequence::decode_index_sequence(out, input).is_ok())
        }
        (mode, stride) => {
            Err(SceneError::format(format!("a compressed buffer view has mode {mode:?} with stride {stride}")))
        }
    }
}

fn damaged() -> SceneError {
    SceneError::format("a compressed buffer view does not unpack")
}

fn unpack_indices(
    packed: &Meshopt,
    input: &[u8],
    decode: impl Fn(&mut [u32], &[u8]) -> bool,
) -> Result<Vec<u8>, SceneError> {
    let mut indices = vec![0_u32; packed.count];
    if !decode(&mut indices, input) {
        return Err(damaged());
    }
    // Little-endian, so that an index of two bytes is the first two.
    Ok(indices.iter().flat_map(|i| i.to_le_bytes().into_iter().take(packed.byte_stride)).collect())
}

/// Reads the stream in order; every step fails where the bytes end.
struct Reader<'r> {
    rest: &'r [u8],
}

impl<'r> Reader<'r> {
    fn take(&mut self, count: usize) -> Option<&'r [u8]> {
        let (taken, rest) = self.rest.split_at_checked(count)?;
        self.rest = rest;
        Some(taken)
    }
}

fn unpack_attributes(out: &mut [u8], stride: usize, input: &[u8]) -> Option<()> {
    let (&header, body) = input.split_first()?;
    let version = header & 0x0f;
    if header & 0xf0 != 0xa0 || version > 1 {
        return None;
    }
    let channel_bytes = if version == 0 { 0 } else { stride / 4 };
    let padded_tail = (stride + channel_bytes).max(if version == 0 { 32 } else { 24 });
    let tail_start = body.len().checked_sub(padded_tail)?;
    let tail = &body[body.len() - stride - channel_bytes..];
    let (first, channels) = tail.split_at(stride);

    let mut previous = first.to_vec();
    let mut reader = Reader { rest: body };
    let block_elements = ((MAX_BLOCK_BYTES / stride) & !(GROUP - 1)).min(MAX_BLOCK_ELEMENTS);
    for block in out.chunks_mut(block_elements * stride) {
        let controls = reader.take(channel_bytes)?;
        unpack_block(&mut reader, block, stride, controls, channels, &previous)?;
        previous.copy_from_slice(&block[block.len() - stride..]);
    }
    (reader.rest.len() == body.len() - tail_start).then_some(())
}

/// Unpacks one block, four bytes of the stride at a time. `controls` and `channels` are empty in version 0.
fn unpack_block(
    reader: &mut Reader<'_>,
    block: &mut [u8],
    stride: usize,
    controls: &[u8],
    channels: &[u8],
    previous: &[u8],
) -> Option<()> {
    let elements = block.len() / stride;
    let mut rows = [[0_u8; MAX_BLOCK_ELEMENTS]; 4];
    for k in (0..stride).step_by(4) {
        let control = controls.get(k / 4).copied();
        for (j, row) in rows.iter_mut().enumerate() {
            let row = &mut row[..elements.next_multiple_of(GROUP)];
            match control.map(|c| c >> (j * 2) & 3) {
                None => unpack_row(reader, row, BITS_V0)?,
                Some(2) => row.fill(0),
                Some(3) => row[..elements].copy_from_slice(reader.take(elements)?),
                Some(kind) => unpack_row(reader, row, BITS_V1[usize::from(kind)])?,
            }
        }
        let channel = channels.get(k / 4).copied().unwrap_or(0);
        let start: [u8; 4] = *previous[k..].first_chunk()?;
        undo_differences(&rows, channel, start, block.chunks_exact_mut(stride).map(|element| &mut element[k..k + 4]))?;
    }
    Some(())
}

fn unpack_row(reader: &mut Reader<'_>, row: &mut [u8], bits_by_code: [u32; 4]) -> Option<()> {
    let codes = reader.take((row.len() / GROUP).div_ceil(4))?;
    for (i, group) in row.as_chunks_mut::<GROUP>().0.iter_mut().enumerate() {
        if reader.rest.len() < GROUP_READ_AHEAD {
            return None;
        }
        let code = codes[i / 4] >> (i % 4 * 2) & 3;
        unpack_group(reader, group, bits_by_code[usize::from(code)])?;
    }
    Some(())
}

fn unpack_group(reader: &mut Reader<'_>, group: &mut [u8; GROUP], bits: u32) -> Option<()> {
    match bits {
        0 => group.fill(0),
        8 => *group = *reader.take(GROUP)?.first_chunk()?,
        _ => {
            let escape = (1_u8 << bits) - 1;
            let per_byte = 8 / bits as usize;
            let fixed = reader.take(GROUP / per_byte)?;
            for (i, byte) in group.iter_mut().enumerate() {
                let place = (i % per_byte) as u32 * bits;
                // The widest value comes first from the top, but single bits come from the bottom.
                let shift = if bits == 1 { place } else { 8 - bits - place };
                let value = fixed[i / per_byte] >> shift & escape;
                *byte = if value == escape { reader.take(1)?[0] } else { value };
            }
        }
    }
    Some(())
}

/// Turns rows of differences into elements. The channel byte says how four bytes belong together: 0 as four bytes,
/// 1 as two halfwords, 2 as one word whose bits were rotated by the upper half of the channel byte.
fn undo_differences<'b>(
    rows: &[[u8; MAX_BLOCK_ELEMENTS]; 4],
    channel: u8,
    start: [u8; 4],
    elements: impl Iterator<Item = &'b mut [u8]>,
) -> Option<()> {
    let rotation = u32::from(channel >> 4);
    let mut previous = start;
    let step = |previous: [u8; 4], d: [u8; 4]| match channel & 3 {
        0 => Some(std::array::from_fn(|j| unzigzag8(d[j]).wrapping_add(previous[j]))),
        1 => {
            let half = |j: usize| {
                let d = u16::from_le_bytes([d[j], d[j + 1]]);
                unzigzag16(d).wrapping_add(u16::from_le_bytes([previous[j], previous[j + 1]])).to_le_bytes()
            };
            let ([a, b], [c, d]) = (half(0), half(2));
            Some([a, b, c, d])
        }
        2 => Some((u32::from_le_bytes(d).rotate_right(rotation) ^ u32::from_le_bytes(previous)).to_le_bytes()),
        _ => None,
    };
    for (i, element) in elements.enumerate() {
        previous = step(previous, std::array::from_fn(|j| rows[j][i]))?;
        element.copy_from_slice(&previous);
    }
    Some(())
}

fn unzigzag8(v: u8) -> u8 {
    (v & 1).wrapping_neg() ^ (v >> 1)
}

fn unzigzag16(v: u16) -> u16 {
    (v & 1).wrapping_neg() ^ (v >> 1)
}
