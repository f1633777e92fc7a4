//! Light space: from world metres to the fixed-point lattice on which everything exact happens.
//!
//! A light's volume is an N x N x N grid, N a power of two: a texel (x, y) is a light ray, slice 0 is nearest the light.
//! Vertices are rounded once to a lattice: 2^26 steps per side across the light, 2^32 along it, whatever N is. All
//! coverage is decided on that lattice in integers, so edges that triangles share are watertight and nothing depends
//! on tiles, threads or the machine. Texel centres lie on the lattice too: N is at most 2^20.

mod clip;
mod directional;
mod local;
mod slices;

pub use directional::DirectionalSpace;
pub use local::{LocalLight, LocalSpace};
pub use slices::Slices;

/// log2 of lattice steps per side across the light. Edge functions of such coordinates fit an `i64`, a side beyond too.
pub const LATERAL_BITS: u32 = 26;
/// log2 of lattice steps along the light. Depth gradients' numerators fit an `i64`.
pub const DEPTH_BITS: u32 = 32;

/// Texels per side and depth slices of a light: a power of two from 64 to 2^20.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Resolution {
    log2: u32,
}

impl Resolution {
    /// Least: 64.
    pub const MIN: Self = Self { log2: antumbra::format::light::MIN_LOG2_RESOLUTION };
    /// Greatest: 1,048,576.
    pub const MAX: Self = Self { log2: antumbra::format::light::MAX_LOG2_RESOLUTION };
    /// Of directional lights, unless told otherwise: 16,384.
    pub const DEFAULT_DIRECTIONAL: Self = Self { log2: 14 };
    /// Of spot and point lights, unless told otherwise: 4,096.
    pub const DEFAULT_LOCAL: Self = Self { log2: 12 };

    /// `None` unless `texels` is a power of two from 64 to 2^20.
    #[must_use]
    pub fn new(texels: u32) -> Option<Self> {
        let resolution = Self { log2: texels.checked_ilog2()? };
        (texels.is_power_of_two() && Self::MIN <= resolution && resolution <= Self::MAX).then_some(resolution)
    }

    /// All of them, coarsest first.
    pub fn all() -> impl Iterator<Item = Self> {
        (Self::MIN.log2..=Self::MAX.log2).map(|log2| Self { log2 })
    }

    /// log2 of the texels per side.
    #[must_use]
    pub fn log2(self) -> u32 {
        self.log2
    }

    /// Texels per side.
    #[must_use]
    pub fn texels(self) -> u32 {
        1 << self.log2
    }

    /// Lattice steps per texel.
    #[must_use]
    pub fn texel_steps(self) -> i64 {
        1 << self.texel_shift()
    }

    /// log2 of the lattice steps per texel.
    #[must_use]
    pub fn texel_shift(self) -> u32 {
        LATERAL_BITS - self.log2
    }

    /// Lattice coordinate of a texel's centre, along either axis.
    #[must_use]
    pub fn texel_center(self, texel: u32) -> i64 {
        i64::from(texel) * self.texel_steps() + self.texel_steps() / 2
    }

    /// Bits to shift a depth on the lattice right by for its slice.
    #[must_use]
    pub fn slice_shift(self) -> u32 {
        DEPTH_BITS - self.log2
    }
}

/// A caster triangle on the lattice. Corners may lie up to a side beyond the light's grid ([`LocalSpace`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LatticeTriangle {
    /// x of the corners, -2^26..=2^27; texels lie within 0..2^26.
    pub x: [i32; 3],
    /// y of the corners, likewise.
    pub y: [i32; 3],
    /// Depth of the corners, 0..2^32, growing away from the light.
    pub z: [u32; 3],
    /// Whether it bounds a solid. Seen from outside such a triangle is counter-clockwise in the world.
    pub solid: bool,
}

impl LatticeTriangle {
    /// Twice the signed area across the light: negative where the triangle's outside faces the light.
    #[must_use]
    pub fn doubled_area(&self) -> i64 {
        let [x, y] = [self.x, self.y].map(|c| c.map(i64::from));
        (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0])
    }
}
