//! The `.antumbra` format, version 1, byte by byte.
//!
//! Everything is little-endian. Sections start at multiples of 256 bytes, so that a mapped file can be bound to a GPU
//! as it is. Bytes between sections are zero.
//!
//! ```text
//! offset  size  header
//!      0     8  magic "ANTUMBRA"
//!      8     2  major version (1): changes when old readers can no longer read the file
//!     10     2  minor version (0): changes when something is added that old readers may skip
//!     12     4  section count S, 1 to 64
//!     16     8  bytes in the whole file
//!     24     8  XXH3-64 (seed 0) of bytes 0..24 followed by the section table
//!     32    32  zero
//!     64  32*S  section table; each entry:
//!                 0  4  kind, four ASCII letters
//!                 4  4  flags; bit 0: a reader that does not know the kind must refuse the file
//!                 8  8  offset of the section in the file, a multiple of 256
//!                16  8  size in bytes
//!                24  8  XXH3-64 (seed 0) of the section's bytes
//! ```
//!
//! Version 2.0 has these sections, in this order, each at most once. A reader skips kinds it does not know unless
//! bit 0 of their flags is set.
//!
//! | kind | required | contents |
//! |------|----------|----------|
//! | `LGTS` | yes | light records of 256 bytes: [`light::LightRecord`] |
//! | `NAME` | yes | UTF-8 text that light records point into |
//! | `DAG8` | yes | the node pool that all lights share: [`dag8`]; or |
//! | `SILH` | yes | the same in the other encoding: [`silhouette`]; or |
//! | `SILP` | yes | that, packed: [`packed`] |
//! | `STAT` | no  | what was baked: [`stat::BakeStats`] |
//! | `LODS` | no  | roots of coarse levels, for prefiltering: [`LEVELS`] |
//! | `ENTR` | no  | coarse enter depths, for blockers: [`enter`] |

pub mod canonical;
pub mod dag8;
pub mod enter;
pub mod file;
pub mod light;
pub mod packed;
pub mod reach;
pub(crate) mod section;
pub mod silhouette;
pub mod slices;
pub mod stat;
pub mod write;

/// Magic number at the start of every file.
pub const MAGIC: [u8; 8] = *b"ANTUMBRA";
/// Major version that this crate reads and writes.
pub const VERSION_MAJOR: u16 = 2;
/// Minor version that this crate writes.
pub const VERSION_MINOR: u16 = 0;
/// Sections start at multiples of this many bytes.
pub const SECTION_ALIGNMENT: usize = 256;
/// Most sections in a file.
pub const MAX_SECTIONS: usize = 64;
/// Most lights in a file: a reader makes up to 128 KiB for each.
pub const MAX_LIGHTS: usize = 4096;
/// Kind of the optional section of coarse levels: for each light, for each level from 1 to log2(N) - 6, a root reference
/// per face (`u32`). Level L is a volume of N / 2^L voxels per side whose voxel is lit iff at least half of the 8^L voxels
/// that it stands for are.
pub const LEVELS: [u8; 4] = *b"LODS";
/// Kind of the optional section of enter depths: see [`enter`].
pub const ENTERS: [u8; 4] = *b"ENTR";
