//! The packed form of a [`silhouette`](super::silhouette) pool, for disk: the section `SILP` in the place of `SILH`. It unpacks in one
//! pass to the pool's words, bit for bit, and takes a sixth to a half of their bytes.
//!
//! ```text
//! offset  size  contents
//!      0     4  W: words of the pool
//!      4     4  F: its forms
//!      8     …  a raw DEFLATE stream (RFC 1951): the bytes of each of the 16 streams (`u32`), then the streams one after the other
//! ```
//!
//! It is deflated in pieces of which none needs another, so that they can be deflated side by side ([`Packing`]); to a reader they are one stream.
//!
//! Each root's tree is walked, lights in the file's order, each node before its children and they in theirs. What the walk meets goes to one
//! of the streams:
//!
//! | stream | holds |
//! |---|---|
//! | 0 | a byte for each reference: what it is ([`Kind`]); 2 for a wedge, 8 for the nearer and 9 for the farther of two planes, then a byte for either plane |
//! | 1 | a byte for each edge: which form it is, by *recency* |
//! | 2 | the same for each plane |
//! | 3 | the same for each depth |
//! | 4 | new depths: the difference from the last new one, signed, beginning at 0 |
//! | 5 | numbers of forms that were met before, but not recently |
//! | 6 | of masks: how many, then the difference of each depth from the one before, beginning at 0 |
//! | 7 | masks, 8 bytes each, those of the lowest bits first |
//! | 8 to 11 | a, b and c of edges that are new, signed; their shifts, a byte each |
//! | 12 to 15 | the same of planes |
//!
//! Numbers are in base 128, lowest digits first, bit 7 set on all bytes but the last; signed ones as 2n, or -2n - 1.
//!
//! **Recency.** Edges, planes and depths have a list each of up to 254 that were met last, latest first, each once. 1 stands for the first of
//! the list, and so on to 254; 0 for something new: of forms the next one of the pool, of depths any that the list has not; 255 for a form that
//! the list has lost.

use alloc::vec::Vec;

use miniz_oxide::DataFormat;
use miniz_oxide::deflate::core::{CompressionStrategy, CompressorOxide, TDEFLFlush, compress_to_output};
use miniz_oxide::inflate::decompress_to_vec_with_limit;

use super::silhouette::{
    FORM_WORDS, Form, HEADER_WORDS, Kind, MASK_LEVEL, MOST_PAYLOAD, Pair, Turns, kind, payload, plane_of_pair,
    reference,
};
use crate::FormatError;

const STREAMS: usize = 16;
const HEADER_BYTES: usize = 8;
const KINDS: usize = 0;
/// What stands for two planes of which the nearer counts, or the farther, where a kind may stand.
const NEARER: u8 = 8;
const FARTHER: u8 = 9;
const DEPTHS: usize = 3;
const NEW_DEPTHS: usize = 4;
const FAR_FORMS: usize = 5;
const TURNS: usize = 6;
const MASKS: usize = 7;
/// The next levels take two and three times as long for a hundredth each.
const DEFLATE_LEVEL: u8 = 5;
/// DEFLATE looks back 32 KiB and has tables for each block: pieces of so many bytes of the streams cost three of a thousand more than one.
const PIECE_BYTES: usize = 1 << 17;
/// Bytes that are deflated between two rests.
const REST_BYTES: usize = 1 << 14;
/// Tiles and depths that are packed between two rests.
const REST_TILES: u32 = 1 << 12;
/// Most that a list remembers.
const RECENT: usize = 254;
/// Something new.
const NEW: u8 = 0;
/// What the list has lost.
const LOST: u8 = 255;
/// Most words that a byte of the streams can stand for: those of a new form, which takes five bytes, are the most.
const MOST_WORDS_PER_BYTE: u64 = 4;

/// What was met last, latest first.
#[derive(Default)]
struct Recent(Vec<u32>);

impl Recent {
    /// Where it is in the list; it comes first now.
    fn find(&mut self, item: u32) -> Option<u8> {
        let place = self.0.iter().position(|other| *other == item);
        match place {
            Some(place) => self.0[..=place].rotate_right(1),
            None => self.add(item),
        }
        place.map(|place| place as u8 + 1)
    }

    fn add(&mut self, item: u32) {
        self.0.truncate(RECENT - 1);
        self.0.insert(0, item);
    }

    /// What is at a place, from 1; it comes first now.
    fn take(&mut self, place: u8) -> Option<u32> {
        self.0.get_mut(..usize::from(place))?.rotate_right(1);
        self.0.first().copied()
    }
}

/// What both directions keep: the lists, and the last depth that was new.
#[derive(Default)]
struct Memory {
    edges: Recent,
    planes: Recent,
    depths: Recent,
    last_depth: u32,
    /// Forms that were met.
    forms: u32,
}

/// What a form stands for; each has streams of its own.
#[derive(Clone, Copy)]
enum Role {
    Edge,
    Plane,
}

impl Role {
    /// The stream of its recencies, and the first of the four of its new forms.
    fn streams(self) -> (usize, usize) {
        match self {
            Self::Edge => (1, 8),
            Self::Plane => (2, 12),
        }
    }
}

impl Memory {
    fn recent(&mut self, role: Role) -> &mut Recent {
        match role {
            Role::Edge => &mut self.edges,
            Role::Plane => &mut self.planes,
        }
    }
}

/// Packs a valid pool, whose trees have these roots, in the file's order.
#[must_use]
pub fn pack(pool: &[u32], roots: impl IntoIterator<Item = u32>) -> Vec<u8> {
    let packing = Packing::new(pool, roots, &|| {});
    let deflated: Vec<Vec<u8>> = (0..packing.pieces()).map(|i| packing.deflate(i, &|| {})).collect();
    packing.finish(&deflated)
}

/// A pool on its way to its packed form: in pieces that may be deflated in any order, on any threads. [`pack`] does it at once.
pub struct Packing {
    header: [u32; 2],
    /// The sizes of the streams, and the streams.
    streams: Vec<u8>,
}

impl Packing {
    /// Writes the streams of a valid pool, whose trees have these roots, in the file's order. `pause` is called now and then.
    #[must_use]
    pub fn new(pool: &[u32], roots: impl IntoIterator<Item = u32>, pause: &dyn Fn()) -> Self {
        let mut packer = Packer { pool, memory: Memory::default(), streams: Default::default(), tiles: 0, pause };
        roots.into_iter().for_each(|root| packer.tile(root));
        let mut streams: Vec<u8> =
            packer.streams.iter().flat_map(|stream| (stream.len() as u32).to_le_bytes()).collect();
        // Each is dropped when it is copied.
        packer.streams.into_iter().for_each(|stream| streams.extend_from_slice(&stream));
        Self { header: [pool.len() as u32, pool[0]], streams }
    }

    /// How many pieces there are.
    #[must_use]
    pub fn pieces(&self) -> usize {
        self.streams.len().div_ceil(PIECE_BYTES)
    }

    /// Deflates a piece. `pause` is called now and then.
    #[must_use]
    pub fn deflate(&self, piece: usize, pause: &dyn Fn()) -> Vec<u8> {
        let mut compressor =
            CompressorOxide::with_params(DataFormat::Raw, DEFLATE_LEVEL, CompressionStrategy::Default, u8::MAX);
        let end = self.streams.len().min((piece + 1) * PIECE_BYTES);
        let mut parts = self.streams[piece * PIECE_BYTES..end].chunks(REST_BYTES).peekable();
        let mut bytes = Vec::new();
        while let Some(part) = parts.next() {
            let flush = match parts.peek() {
                Some(_) => TDEFLFlush::None,
                None if end < self.streams.len() => TDEFLFlush::Sync,
                None => TDEFLFlush::Finish,
            };
            compress_to_output(&mut compressor, part, flush, |deflated| {
                bytes.extend_from_slice(deflated);
                true
            });
            pause();
        }
        bytes
    }

    /// The packed form, given the pieces, deflated, in their order.
    #[must_use]
    pub fn finish(&self, deflated: &[Vec<u8>]) -> Vec<u8> {
        let mut bytes = self.header.map(u32::to_le_bytes).concat();
        deflated.iter().for_each(|piece| bytes.extend_from_slice(piece));
        bytes
    }
}

struct Packer<'a> {
    pool: &'a [u32],
    memory: Memory,
    streams: [Vec<u8>; STREAMS],
    /// Tiles and depths so far.
    tiles: u32,
    pause: &'a dyn Fn(),
}

impl Packer<'_> {
    fn tile(&mut self, tile: u32) {
        let at = payload(tile);
        self.tiles = self.tiles.wrapping_add(1);
        if self.tiles.is_multiple_of(REST_TILES) {
            (self.pause)();
        }
        if kind(tile) == Kind::Pair && Pair::of(self.pool[at]) != Pair::Wedge {
            self.streams[KINDS].push(if Pair::of(self.pool[at]) == Pair::Nearer { NEARER } else { FARTHER });
            for (number, is_deep) in [self.pool[at], self.pool[at + 1]].map(plane_of_pair) {
                self.tile(reference(if is_deep { Kind::Deep } else { Kind::Plane }, number as u32));
            }
            return;
        }
        self.streams[KINDS].push(kind(tile) as u8);
        match kind(tile) {
            Kind::Inner => (0..4).for_each(|i| self.tile(self.pool[at + i])),
            Kind::Cut | Kind::Cross => {
                let edges = if kind(tile) == Kind::Cut { 1 } else { 2 };
                (0..edges).for_each(|i| self.form(Role::Edge, self.pool[at + i]));
                (0..1 << edges).for_each(|i| self.tile(self.pool[at + edges + i]));
            }
            Kind::Pair => (0..2).for_each(|i| self.form(Role::Plane, plane_of_pair(self.pool[at + i]).0 as u32)),
            Kind::Plane | Kind::Deep => self.form(Role::Plane, at as u32),
            Kind::Depth => self.depth(at as u32),
            Kind::Masks => {
                let turns = Turns::read(self.pool, at);
                put(&mut self.streams[TURNS], turns.count() as u64);
                let mut last = 0;
                for depth in turns.depths() {
                    put(&mut self.streams[TURNS], u64::from(depth - last));
                    last = depth;
                }
                let words = turns.masks().as_flattened().iter();
                self.streams[MASKS].extend(words.flat_map(|word| word.to_le_bytes()));
            }
        }
    }

    fn depth(&mut self, depth: u32) {
        let place = self.memory.depths.find(depth);
        self.streams[DEPTHS].push(place.unwrap_or(NEW));
        if place.is_none() {
            put_signed(&mut self.streams[NEW_DEPTHS], i64::from(depth) - i64::from(self.memory.last_depth));
            self.memory.last_depth = depth;
        }
    }

    fn form(&mut self, role: Role, number: u32) {
        let (codes, first) = role.streams();
        let place = self.memory.recent(role).find(number);
        if number == self.memory.forms {
            self.memory.forms += 1;
            let form = Form::read(self.pool, number as usize);
            self.streams[codes].push(NEW);
            put_signed(&mut self.streams[first], form.a.into());
            put_signed(&mut self.streams[first + 1], form.b.into());
            put_signed(&mut self.streams[first + 2], form.c);
            self.streams[first + 3].push(form.shift as u8);
        } else if let Some(place) = place {
            self.streams[codes].push(place);
        } else {
            self.streams[codes].push(LOST);
            put(&mut self.streams[FAR_FORMS], number.into());
        }
    }
}

fn put(stream: &mut Vec<u8>, mut number: u64) {
    while number >= 128 {
        stream.push(number as u8 | 128);
        number >>= 7;
    }
    stream.push(number as u8);
}

fn put_signed(stream: &mut Vec<u8>, number: i64) {
    put(stream, ((number << 1) ^ (number >> 63)) as u64);
}

/// Unpacks a pool, of whose trees each has so many levels, in the file's order. What it gives may be no valid pool:
/// [`super::silhouette::Check`] says. Takes as much memory as the pool and the streams, which are smaller.
///
/// # Errors
/// [`FormatError::Malformed`] with what is wrong.
pub fn unpack(bytes: &[u8], levels: &[u32]) -> Result<Vec<u32>, FormatError> {
    let (header, deflated) = bytes.split_at_checked(HEADER_BYTES).ok_or(CUT_OFF)?;
    let [words, forms] =
        [0, 4].map(|at| u32::from_le_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]]));
    // Eight for each word and root: a new depth takes six, a new form 21.
    let most = (words as usize).saturating_add(levels.len()).saturating_mul(8).saturating_add(4 * STREAMS);
    let inflated = decompress_to_vec_with_limit(deflated, most).map_err(|_| CUT_OFF)?;
    let (sizes, mut rest) = inflated.split_at_checked(4 * STREAMS).ok_or(CUT_OFF)?;
    let mut streams = [&[][..]; STREAMS];
    for (stream, size) in streams.iter_mut().zip(sizes.as_chunks::<4>().0) {
        (*stream, rest) = rest.split_at_checked(u32::from_le_bytes(*size) as usize).ok_or(CUT_OFF)?;
    }
    let nodes = HEADER_WORDS as u64 + u64::from(forms) * FORM_WORDS as u64;
    if nodes > u64::from(words) || u64::from(words) > HEADER_WORDS as u64 + MOST_WORDS_PER_BYTE * inflated.len() as u64
    {
        return Err(FormatError::Malformed("the packed pool says that it is larger than it can be"));
    }
    let mut pool = Vec::with_capacity(words as usize);
    pool.push(forms);
    pool.resize(nodes as usize, 0);
    let mut unpacker = Unpacker { streams, memory: Memory::default(), forms, words: words as usize, pool };
    for level in levels {
        unpacker.tile(*level)?;
    }
    let is_all = unpacker.streams.iter().all(|stream| stream.is_empty()) && rest.is_empty();
    if is_all && unpacker.pool.len() == words as usize && unpacker.memory.forms == forms {
        Ok(unpacker.pool)
    } else {
        Err(FormatError::Malformed("the packed pool holds more or less than its lights' trees"))
    }
}

const CUT_OFF: FormatError = FormatError::Malformed("the packed pool is cut off or damaged");

struct Unpacker<'a> {
    /// What is left of them.
    streams: [&'a [u8]; STREAMS],
    memory: Memory,
    forms: u32,
    words: usize,
    pool: Vec<u32>,
}

/// The kind of a code; of one that is none, some kind.
fn kind_of(code: u8) -> Kind {
    kind(u32::from(code) << 29)
}

const IMPOSSIBLE: FormatError = FormatError::Malformed("a packed tile is something that it cannot be");

impl Unpacker<'_> {
    /// A tile of 2^`level` texels per side.
    fn tile(&mut self, level: u32) -> Result<u32, FormatError> {
        let mut words = [0; 6];
        let code = self.byte(KINDS)?;
        let (found, count) = match kind_of(code) {
            Kind::Inner if level > MASK_LEVEL => {
                for child in &mut words[..4] {
                    *child = self.tile(level - 1)?;
                }
                (Kind::Inner, 4)
            }
            cut @ (Kind::Cut | Kind::Cross) => {
                let edges = if cut == Kind::Cut { 1 } else { 2 };
                let count = edges + (1 << edges);
                for edge in &mut words[..edges] {
                    *edge = self.form(Role::Edge)?;
                }
                for region in &mut words[edges..count] {
                    *region = self.value()?;
                }
                (cut, count)
            }
            Kind::Masks => return self.masks(),
            _ => return self.value_of(code),
        };
        self.node(found, &words[..count])
    }

    fn value(&mut self) -> Result<u32, FormatError> {
        let code = self.byte(KINDS)?;
        self.value_of(code)
    }

    fn value_of(&mut self, code: u8) -> Result<u32, FormatError> {
        let (pair, planes) = match code {
            NEARER => (Pair::Nearer, [self.plane()?, self.plane()?]),
            FARTHER => (Pair::Farther, [self.plane()?, self.plane()?]),
            _ if code > FARTHER => return Err(CUT_OFF),
            _ => match kind_of(code) {
                Kind::Depth => return Ok(reference(Kind::Depth, self.depth()?)),
                found @ (Kind::Plane | Kind::Deep) => return Ok(reference(found, self.form(Role::Plane)?)),
                Kind::Pair => (Pair::Wedge, [(self.form(Role::Plane)?, false), (self.form(Role::Plane)?, false)]),
                _ => return Err(IMPOSSIBLE),
            },
        };
        self.node(Kind::Pair, &pair.to_words(planes))
    }

    /// One of two planes, and whether it is deep.
    fn plane(&mut self) -> Result<(u32, bool), FormatError> {
        match self.byte(KINDS).map(kind_of)? {
            Kind::Plane => Ok((self.form(Role::Plane)?, false)),
            Kind::Deep => Ok((self.form(Role::Plane)?, true)),
            _ => Err(IMPOSSIBLE),
        }
    }

    fn masks(&mut self) -> Result<u32, FormatError> {
        let count = self.number(TURNS)?;
        if !(1..=Turns::MOST_DEPTHS as u64).contains(&count) {
            return Err(IMPOSSIBLE);
        }
        let mut depths = [0u32; Turns::MOST_DEPTHS];
        let depths = &mut depths[..count as usize];
        let mut last = 0u32;
        for depth in &mut *depths {
            last = last.wrapping_add(self.number(TURNS)? as u32);
            *depth = last;
        }
        if depths[0] > Turns::MOST_FIRST {
            return Err(IMPOSSIBLE);
        }
        let mut words = [0; Turns::MOST_WORDS];
        let (masks, all) = Turns::lay_out(&mut words, depths);
        for word in masks {
            let (bytes, rest) = self.streams[MASKS].split_first_chunk::<4>().ok_or(CUT_OFF)?;
            self.streams[MASKS] = rest;
            *word = u32::from_le_bytes(*bytes);
        }
        self.node(Kind::Masks, &words[..all])
    }

    fn node(&mut self, kind: Kind, words: &[u32]) -> Result<u32, FormatError> {
        let at = self.pool.len();
        if words.len() > self.words - at || at > MOST_PAYLOAD as usize {
            return Err(FormatError::Malformed("the packed pool holds more than it says"));
        }
        self.pool.extend_from_slice(words);
        Ok(reference(kind, at as u32))
    }

    fn depth(&mut self) -> Result<u32, FormatError> {
        let code = self.byte(DEPTHS)?;
        if code != NEW {
            return self.memory.depths.take(code).ok_or(CUT_OFF);
        }
        let depth = self.memory.last_depth.wrapping_add(self.signed(NEW_DEPTHS)? as u32) & MOST_PAYLOAD;
        self.memory.last_depth = depth;
        self.memory.depths.add(depth);
        Ok(depth)
    }

    fn form(&mut self, role: Role) -> Result<u32, FormatError> {
        let (codes, first) = role.streams();
        let number = match self.byte(codes)? {
            NEW => {
                let number = self.memory.forms;
                let [a, b, c] = [self.signed(first)?, self.signed(first + 1)?, self.signed(first + 2)?];
                let form = Form { a: a as i32, b: b as i32, c, shift: self.byte(first + 3)?.into() };
                if number == self.forms {
                    return Err(FormatError::Malformed("the packed pool holds more forms than it says"));
                }
                let at = HEADER_WORDS + FORM_WORDS * number as usize;
                self.pool[at..at + FORM_WORDS].copy_from_slice(&form.to_words());
                self.memory.forms += 1;
                number
            }
            LOST => self.number(FAR_FORMS)? as u32 & MOST_PAYLOAD,
            place => return self.memory.recent(role).take(place).ok_or(CUT_OFF),
        };
        self.memory.recent(role).add(number);
        Ok(number)
    }

    fn byte(&mut self, stream: usize) -> Result<u8, FormatError> {
        let (byte, rest) = self.streams[stream].split_first().ok_or(CUT_OFF)?;
        self.streams[stream] = rest;
        Ok(*byte)
    }

    fn number(&mut self, stream: usize) -> Result<u64, FormatError> {
        let mut number = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte(stream)?;
            number |= u64::from(byte & 127) << shift;
            if byte < 128 {
                return Ok(number);
            }
        }
        Err(CUT_OFF)
    }

    fn signed(&mut self, stream: usize) -> Result<i64, FormatError> {
        let number = self.number(stream)?;
        Ok((number >> 1) as i64 ^ -((number & 1) as i64))
    }
}
