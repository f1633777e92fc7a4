//! Light records: where a light's grid lies in the world, and where its nodes begin.

use crate::FormatError;
use bytemuck::{Pod, Zeroable};

/// Least log2 of a light's resolution (64).
pub const MIN_LOG2_RESOLUTION: u32 = 6;
/// Greatest log2 of a light's resolution (1,048,576).
pub const MAX_LOG2_RESOLUTION: u32 = 20;

/// How shadows are stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u32)]
pub enum Encoding {
    /// The papers' voxel graph: [`super::dag8`].
    Dag8 = 0,
    /// Edges and planes, which hardly grow with resolution: [`super::silhouette`].
    #[default]
    Silhouette = 1,
}

impl Encoding {
    /// As commands and tables call it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Dag8 => "dag8",
            Self::Silhouette => "silhouette",
        }
    }
}

/// One light; 256 bytes.
///
/// ```text
/// offset  size  field
///      0     4  name: first byte in the NAME section
///      4     4  name: length in bytes
///      8     4  kind: 0 directional, 1 spot, 2 point
///     12     4  log2 of the resolution N, 6 to 20
///     16     4  interior policy: 0 open, 1 closed, 2 auto, 3 thickness, 4 static
///     20     4  node encoding: 0 dag8, 1 silhouette; the same for all lights of a file
///     24   4*6  root references, one per face; unused ones are 0
///     48     8  policy parameter, metres (thickness or margin; else 0)
///     56     8  texel size, metres (local lights: at their range)
///     64     8  slice size, metres (local lights: 0, it grows with distance)
///     72     8  near distance, metres (local lights; else 0)
///     80     8  far distance, metres (local lights: their range; else 0)
///     88     8  cosine of the cone's half angle (spot lights; else 0)
///     96   8*3  origin, world metres: the volume's centre, or the local light's position; subtract it first
///    120   8*9  linear part, row by row: directional: voxels per metre; local: the light's unit axes
///    192   8*3  voxel coordinates of the origin (directional; else 0)
///    216   8*3  unit direction along which the light travels, world (point lights: 0)
///    240     4  faces: 1, or 6 for point lights and wide spot lights
///    244     4  distribution of the slices: 0 linear, 1 logarithmic, 2 linear in normalized device coordinates
///    248     8  texels per unit of tangent (local lights; else 0)
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
    /// Cosine of a spot light's half angle.
    pub cone_cosine: f64,
    /// The volume's centre or the light's position, world metres.
    pub origin_world: [f64; 3],
    /// Rows of the linear map from metres about the origin to voxels (directional) or to the light's axes (local).
    pub linear: [[f64; 3]; 3],
    /// Voxel coordinates of the origin.
    pub voxel_of_origin: [f64; 3],
    /// Unit direction along which the light travels, world.
    pub direction_world: [f64; 3],
    /// Faces: 1 or 6.
    pub faces: u32,
    /// See [`DepthDistribution`].
    pub depth: u32,
    /// Texels that a unit of tangent spans.
    pub texels_per_tangent: f64,
}

/// How the slices are spread between a light's near and far distance.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u32)]
pub enum DepthDistribution {
    /// Evenly, as directional lights have them.
    #[default]
    Linear = 0,
    /// By the logarithm of the distance, so that a voxel keeps its proportions (Kämpe et al. 2015, equation 1).
    Logarithmic = 1,
    /// Evenly in normalized device coordinates, as a plain shadow map has them: for comparison.
    Ndc = 2,
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

    /// How its shadows are stored; `None` for a number that this version does not know.
    #[must_use]
    pub fn node_encoding(&self) -> Option<Encoding> {
        match self.encoding {
            0 => Some(Encoding::Dag8),
            1 => Some(Encoding::Silhouette),
            _ => None,
        }
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

    /// How the slices are spread; `None` for a number that this version does not know.
    #[must_use]
    pub fn depth_distribution(&self) -> Option<DepthDistribution> {
        Some(match self.depth {
            0 => DepthDistribution::Linear,
            1 => DepthDistribution::Logarithmic,
            2 => DepthDistribution::Ndc,
            _ => return None,
        })
    }

    /// References to the faces' roots.
    #[must_use]
    pub fn face_roots(&self) -> &[u32] {
        &self.roots[..(self.faces as usize).min(6)]
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
        if self.node_encoding().is_none() {
            return Err(FormatError::UnknownEncoding { light: index, encoding: self.encoding });
        }
        let (Some(kind), Some(depth)) = (self.light_kind(), self.depth_distribution()) else {
            return Err(FormatError::Malformed("a light's kind or its distribution of slices is unknown"));
        };
        if !(MIN_LOG2_RESOLUTION..=MAX_LOG2_RESOLUTION).contains(&self.log2_resolution) {
            return Err(FormatError::Malformed("a light's resolution is not a power of two from 64 to 1048576"));
        }
        let faces_fit = match kind {
            LightKind::Directional => self.faces == 1,
            LightKind::Spot => self.faces == 1 || self.faces == 6,
            LightKind::Point => self.faces == 6,
        };
        if !faces_fit || self.interior_policy().is_none() {
            return Err(FormatError::Malformed("a light's policy or number of faces is unknown"));
        }
        if self.roots[self.faces as usize..].iter().any(|r| *r != 0) {
            return Err(FormatError::Malformed("a light has more root references than faces"));
        }
        if (kind == LightKind::Directional) != (depth == DepthDistribution::Linear) || !self.numbers_make_sense(kind) {
            return Err(FormatError::Malformed("a light's placement makes no sense"));
        }
        Ok(())
    }

    fn numbers_make_sense(&self, kind: LightKind) -> bool {
        let lengths = [self.interior_parameter_m, self.texel_size_m, self.slice_size_m, self.near_m, self.far_m];
        let finite = lengths.iter().all(|m| m.is_finite() && *m >= 0.0)
            && self.texel_size_m > 0.0
            && self.origin_world.iter().chain(&self.voxel_of_origin).all(|v| v.is_finite())
            && self.linear.as_flattened().iter().chain(&self.direction_world).all(|v| v.is_finite());
        let fits = if kind == LightKind::Directional {
            self.slice_size_m > 0.0 && self.texels_per_tangent == 0.0
        } else {
            let ratio = self.far_m / self.near_m;
            ratio > 1.0 && ratio.is_finite() && self.texels_per_tangent > 0.0 && self.texels_per_tangent.is_finite()
        };
        finite && fits && (-1.0..=1.0).contains(&self.cone_cosine)
    }
}

/// Words of the record before its first `f64`.
const U32_WORDS: usize = 12;
/// The record's two words between its `f64`s.
const INNER_WORDS: core::ops::Range<usize> = 240..248;

/// Applies a byte-order conversion to each field.
fn swap_words(record: &mut LightRecord, word: fn(u32) -> u32, long: fn(u64) -> u64) {
    let bytes = bytemuck::bytes_of_mut(record);
    let (before, rest) = bytes.split_at_mut(INNER_WORDS.start);
    let (inner, last) = rest.split_at_mut(INNER_WORDS.len());
    let (words, longs) = before.split_at_mut(4 * U32_WORDS);
    for part in [words, inner] {
        bytemuck::cast_slice_mut::<u8, u32>(part).iter_mut().for_each(|w| *w = word(*w));
    }
    for part in [longs, last] {
        bytemuck::cast_slice_mut::<u8, u64>(part).iter_mut().for_each(|l| *l = long(*l));
    }
}
