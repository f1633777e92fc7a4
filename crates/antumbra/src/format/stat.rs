//! The optional `STAT` section: what was baked, for people and tools. Lookups never read it.

use bytemuck::{Pod, Zeroable};

/// Counts of what went into a bake; 64 bytes.
///
/// ```text
/// offset  size  field
///      0     8  triangles in the scene's nodes
///      8     8  triangles of closed parts
///     16     8  of which cavities: closed parts turned inward inside a solid
///     24     8  triangles of open parts
///     32     8  alpha-masked triangles (also counted as open)
///     40     8  triangles dropped because they were broken
///     48     8  triangles left out: dynamic, excluded or blended
///     56     8  zero
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct BakeStats {
    /// Triangles in the scene's nodes, dropped ones not included.
    pub triangles_total: u64,
    /// Triangles of closed parts.
    pub triangles_closed: u64,
    /// Of those, triangles of cavities: closed parts turned inward inside a solid.
    pub triangles_cavity: u64,
    /// Triangles of open parts.
    pub triangles_open: u64,
    /// Alpha-masked triangles; they also count as open.
    pub triangles_alpha_masked: u64,
    /// Triangles dropped because they were broken.
    pub triangles_dropped: u64,
    /// Triangles that cast no shadow here: dynamic, excluded or blended.
    pub triangles_left_out: u64,
    /// Zero.
    pub zero: u64,
}

impl BakeStats {
    /// The same with every field in little-endian order.
    pub(crate) fn to_le(self) -> Self {
        bytemuck::cast(bytemuck::cast::<Self, [u64; 8]>(self).map(u64::to_le))
    }

    /// Reads the section, whose size must be right.
    pub(crate) fn read(bytes: &[u8]) -> Option<Self> {
        let raw: [u64; 8] = bytemuck::try_pod_read_unaligned(bytes).ok()?;
        Some(bytemuck::cast(raw.map(u64::from_le)))
    }
}
