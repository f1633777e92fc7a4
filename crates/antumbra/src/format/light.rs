//! Light records: where a light's grid lies in the world, and where its nodes begin.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;

use crate::FormatError;

/// Least log2 of a light's resolution (64).
pub const MIN_LOG2_RESOLUTION: u32 = 6;
/// Greatest log2 of a light's resolution (1,048,576).
pub const MAX_LOG2_RESOLUTION: u32 = 20;
/// The papers' node encoding, [`super::dag8`].
pub const ENCODING_DAG8: u32 = 0;

/// One light; 256 bytes.
///
/// ```text
/// offset  size  field
///      0     4  name: first byte in the NAME section
///      4     4  name: length in bytes
///      8     4  kind: 0 directional, 1 spot, 2 point
///     12     4  log2 of the resolution N, 6 to 20
///     16     4  interior policy: 0 open, 1 closed, 2 auto, 3 thickness, 4 static
///     20     4  node encoding: 0 dag8
///     24  4*6   root references, one per face (a directional or spot light uses the first; the others are 0)
///     48     8  policy parameter, metres (thickness or margin; else 0)
///     56     8  texel size, metres (local lights: at their range)
///     64     8  slice size, metres (local lights: 0, it grows with distance)
///     72     8  near distance, metres (local lights)
///     80     8  far distance, metres (local lights)
///     88     8  zero
///     96  8*3   origin, world metres: the volume's centre; subtract it first, so that f32 suffices after
///    120  8*9   linear part, voxels per metre, row by row (x, y, z of the voxel)
///    192  8*3   offset, voxels:  voxel = linear * (world - origin) + offset
///    216  8*3   unit direction along which the light travels (directional, spot), world
///    240    16  zero
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct LightRecord {
    /// First byte of the name in the NAME section.
    pub name_offset: u32,
    /// Length of the name, bytes.
    pub name_length: u32,
    /// See [`LightKind`].
    pub kind: u32,
    /// log2 of the texels per side and of the depth slices.
    pub log2_resolution: u32,
    /// See [`Interior`].
    pub interior: u32,
    /// Node encoding.
    pub encoding: u32,
    /// Root references, one per face.
    pub roots: [u32; 6],
    /// Thickness or margin, metres.
    pub interior_parameter_m: f64,
    /// Texel size, metres.
    pub texel_size_m: f64,
    /// Slice size, metres.
    pub slice_size_m: f64,
    /// Near distance, metres.
    pub near_m: f64,
    /// Far distance, metres.
    pub far_m: f64,
    /// Zero.
    pub zero: u64,
    /// The volume's centre, world metres.
    pub origin_world: [f64; 3],
    /// Rows of the linear map from metres about the origin to voxels.
    pub voxel_from_offset: [[f64; 3]; 3],
    /// Voxel coordinates of the origin.
    pub voxel_of_origin: [f64; 3],
    /// Unit direction along which the light travels, world.
    pub direction_world: [f64; 3],
    /// Zero.
    pub zero_end: [u64; 2],
}

/// What a light is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum LightKind {
    /// Parallel rays; orthographic grid.
    Directional = 0,
    /// A cone; one perspective grid.
    Spot = 1,
    /// All round; six perspective grids.
    Point = 2,
}

impl LightKind {
    /// The word that the program prints.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Directional => "directional",
            Self::Spot => "spot",
            Self::Point => "point",
        }
    }
}

/// Where the bake was free to choose: the policy that made the intervals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Interior {
    /// Nowhere: every voxel is exact.
    Open,
    /// Inside closed parts; what is open stays exact. The caller expects everything to be closed.
    Closed,
    /// Inside closed parts; what is open stays exact.
    Auto,
    /// Within so many metres behind a surface.
    Thickness(f64),
    /// Between the first and the second surface along a ray, less a margin in metres.
    Static(f64),
}

impl Interior {
    /// Number and parameter as the record stores them.
    #[must_use]
    pub fn to_record(self) -> (u32, f64) {
        match self {
            Self::Open => (0, 0.0),
            Self::Closed => (1, 0.0),
            Self::Auto => (2, 0.0),
            Self::Thickness(m) => (3, m),
            Self::Static(m) => (4, m),
        }
    }

    /// The word that the program reads and prints.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Open => "open",
            Self::Closed => "closed",
            Self::Auto => "auto",
            Self::Thickness(_) => "thickness",
            Self::Static(_) => "static",
        }
    }
}

impl LightRecord {
    /// The light's kind; `None` for a number that this version does not know.
    #[must_use]
    pub fn light_kind(&self) -> Option<LightKind> {
        Some(match self.kind {
            0 => LightKind::Directional,
            1 => LightKind::Spot,
            2 => LightKind::Point,
            _ => return None,
        })
    }

    /// The policy of the bake; `None` for a number that this version does not know.
    #[must_use]
    pub fn interior_policy(&self) -> Option<Interior> {
        let m = self.interior_parameter_m;
        Some(match self.interior {
            0 => Interior::Open,
            1 => Interior::Closed,
            2 => Interior::Auto,
            3 => Interior::Thickness(m),
            4 => Interior::Static(m),
            _ => return None,
        })
    }

    /// Texels per side, and depth slices.
    #[must_use]
    pub fn resolution(&self) -> u32 {
        1 << self.log2_resolution
    }

    /// Voxel coordinates of a world point (real-valued: floor them for the voxel's indices).
    #[must_use]
    pub fn voxel_from_world(&self, world: DVec3) -> DVec3 {
        let offset = world - DVec3::from_array(self.origin_world);
        let row = |i: usize| DVec3::from_array(self.voxel_from_offset[i]).dot(offset) + self.voxel_of_origin[i];
        DVec3::new(row(0), row(1), row(2))
    }

    /// The same with every field in little-endian order.
    pub(crate) fn to_le(self) -> Self {
        let mut le = self;
        swap_words(&mut le, u32::to_le, u64::to_le);
        le
    }

    /// Reads a record, fields in host order.
    pub(crate) fn from_le_bytes(bytes: &[u8]) -> Self {
        let mut record: Self = bytemuck::pod_read_unaligned(bytes);
        swap_words(&mut record, u32::from_le, u64::from_le);
        record
    }

    /// Checks everything but the node references and the name.
    pub(crate) fn check(&self, index: usize) -> Result<(), FormatError> {
        if self.encoding != ENCODING_DAG8 {
            return Err(FormatError::UnknownEncoding { light: index, encoding: self.encoding });
        }
        if self.light_kind() != Some(LightKind::Directional) {
            return Err(FormatError::Malformed("version 1.0 holds directional lights only"));
        }
        if !(MIN_LOG2_RESOLUTION..=MAX_LOG2_RESOLUTION).contains(&self.log2_resolution) {
            return Err(FormatError::Malformed("a light's resolution is not a power of two from 64 to 1048576"));
        }
        if self.interior_policy().is_none() || self.roots[1..] != [0; 5] {
            return Err(FormatError::Malformed("a light's policy or root references are unknown"));
        }
        if self.zero != 0 || self.zero_end != [0; 2] || !self.numbers_are_finite() {
            return Err(FormatError::Malformed("a light's placement is not finite or has stray bytes"));
        }
        Ok(())
    }

    fn numbers_are_finite(&self) -> bool {
        let lengths = [self.interior_parameter_m, self.texel_size_m, self.slice_size_m, self.near_m, self.far_m];
        lengths.iter().all(|m| m.is_finite() && *m >= 0.0)
            && self.texel_size_m > 0.0
            && self.slice_size_m > 0.0
            && self.origin_world.iter().chain(&self.voxel_of_origin).all(|v| v.is_finite())
            && self.voxel_from_offset.as_flattened().iter().chain(&self.direction_world).all(|v| v.is_finite())
    }
}

/// Words of the record before its first `f64`.
const U32_WORDS: usize = 12;

/// Applies a byte-order conversion to each field.
fn swap_words(record: &mut LightRecord, word: fn(u32) -> u32, long: fn(u64) -> u64) {
    let (words, longs) = bytemuck::bytes_of_mut(record).split_at_mut(4 * U32_WORDS);
    for w in bytemuck::cast_slice_mut::<u8, u32>(words) {
        *w = word(*w);
    }
    for l in bytemuck::cast_slice_mut::<u8, u64>(longs) {
        *l = long(*l);
    }
}
