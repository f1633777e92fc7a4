//! Projection: from a world point to a face of the light and real-valued voxel coordinates on it.
//!
//! A directional light has one face with an affine map. A local light sits at its origin and looks along up to six axes:
//! on a face, a texel is a ray through the light, `x = k * p.x / p.z + N/2`, and slices are spread by the logarithm of
//! the depth p.z (Kämpe, Sintorn, Assarsson 2015, *Fast, memory-efficient construction of voxelized shadows*, eq. 1).
//!
//! ```text
//! axes a, b, c of the light     face   looks along   its right   its down
//!                               2a + 0     +a            b           c       (and so on, cyclically)
//!                               2a + 1     -a            c           b
//! ```
//!
//! A spot light has face 4 alone (along c), stored as its first; a wide one has all six, as a point light has. A cube's
//! faces reach [`FACE_BORDER`] texels beyond its edges, so that a filter never leaves the grid of its middle.

pub(crate) mod line;

use glam::DVec3;

use crate::format::light::DepthDistribution;
use crate::{LightKind, LightRecord};

/// Texels by which a local light's grid goes on beyond a cube's edges, and beyond a spot light's cone: the radius of
/// the largest filter.
pub const FACE_BORDER: u32 = 8;

/// A point as a light sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacePoint {
    /// Which of the light's faces.
    pub face: usize,
    /// Real-valued voxel coordinates: x and y number texels, z numbers slices; floors are indices. z is negative for
    /// points before the first slice.
    pub voxel: DVec3,
}

/// Where a lookup ends up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Place {
    /// Sideways of the volume or before it.
    Lit,
    /// Outside a spot light's cone.
    Unlit,
    /// In a voxel.
    At { face: usize, voxel: [u32; 3] },
}

/// The light's grid about a point: unit axes of its face, and the size of a voxel there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoxelFrame {
    /// Unit vector along which x grows, world.
    pub right: DVec3,
    /// Unit vector along which y grows, world.
    pub down: DVec3,
    /// Unit vector along which slices follow one another, world.
    pub along: DVec3,
    /// Unit vector from the point to the light, world.
    pub towards_light: DVec3,
    /// Side of a texel at the point's depth, metres.
    pub texel_m: f64,
    /// Height of the slice there, metres along `along`.
    pub slice_m: f64,
}

/// A light's projection, ready for many points. Made once when a file is loaded.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Projection {
    origin: DVec3,
    rows: [DVec3; 3],
    /// Directional: voxel coordinates of the origin.
    offset: DVec3,
    side: f64,
    local: Option<Local>,
    texel_m: f64,
    slice_m: f64,
}

/// What a local light has beside its axes.
#[derive(Clone, Copy, Debug)]
struct Local {
    is_cube: bool,
    /// Texels per unit of tangent.
    scale: f64,
    near_m: f64,
    log_near: f64,
    log_ratio: f64,
    /// Near over far distance.
    near_share: f64,
    is_ndc: bool,
    /// -1 for lights without a cone.
    cone_cosine: f64,
}

impl Projection {
    /// Of a record that was checked.
    pub fn new(record: &LightRecord) -> Self {
        let kind = record.light_kind().unwrap_or(LightKind::Directional);
        let local = (kind != LightKind::Directional).then(|| Local {
            is_cube: record.faces == 6,
            scale: record.texels_per_tangent,
            near_m: record.near_m,
            log_near: libm::log(record.near_m),
            log_ratio: libm::log(record.far_m / record.near_m),
            near_share: record.near_m / record.far_m,
            is_ndc: record.depth_distribution() == Some(DepthDistribution::Ndc),
            cone_cosine: if kind == LightKind::Spot { record.cone_cosine } else { -1.0 },
        });
        Self {
            origin: DVec3::from_array(record.origin_world),
            rows: record.linear.map(DVec3::from_array),
            offset: DVec3::from_array(record.voxel_of_origin),
            side: f64::from(record.resolution()),
            local,
            texel_m: record.texel_size_m,
            slice_m: record.slice_size_m,
        }
    }

    fn rotated(&self, world: DVec3) -> DVec3 {
        self.rotated_offset(world - self.origin)
    }

    fn rotated_offset(&self, offset: DVec3) -> DVec3 {
        DVec3::new(self.rows[0].dot(offset), self.rows[1].dot(offset), self.rows[2].dot(offset))
    }

    /// A point in the light's axes: voxels (directional) or metres from the light.
    pub fn in_axes(&self, world: DVec3) -> DVec3 {
        let offset = if self.local.is_none() { self.offset } else { DVec3::ZERO };
        self.rotated(world) + offset
    }

    /// The face that sees a point, and its voxel coordinates there. A point before the near distance has z = -1; not even
    /// x and y mean anything behind a light with one face.
    #[inline]
    pub fn project(&self, world: DVec3) -> FacePoint {
        let p = self.rotated(world);
        match &self.local {
            None => FacePoint { face: 0, voxel: p + self.offset },
            Some(local) => local.project(p, self.side),
        }
    }

    /// The voxel that holds a point; points behind the last slice take the last one. Points that are no numbers are lit.
    #[inline]
    pub fn place(&self, world: DVec3) -> Place {
        let p = self.rotated(world);
        let FacePoint { face, voxel } = match &self.local {
            None => FacePoint { face: 0, voxel: p + self.offset },
            Some(local) if local.is_outside_cone(p) => return Place::Unlit,
            Some(local) => local.project(p, self.side),
        };
        clamp_to_volume(voxel, self.side).map_or(Place::Lit, |voxel| Place::At { face, voxel })
    }

    /// Where on a cube's faces a ray of texel coordinates beyond one face's edge belongs; `None` if the light is no cube.
    /// Depth is the real-valued slice, which every face counts alike for the same depth along its own axis.
    pub fn around_corner(&self, at: FacePoint) -> Option<FacePoint> {
        let local = self.local.as_ref().filter(|local| local.is_cube)?;
        let tangent = |v: f64| (v - 0.5 * self.side) / local.scale;
        let ray = from_face(DVec3::new(tangent(at.voxel.x), tangent(at.voxel.y), 1.0), at.face);
        let face = cube_face(ray);
        let p = on_face(ray, face);
        let shifted = local.slices_from_depth_ratio(at.voxel.z, p.z, self.side);
        let texel = |v: f64| v / p.z * local.scale + 0.5 * self.side;
        Some(FacePoint { face, voxel: DVec3::new(texel(p.x), texel(p.y), shifted) })
    }

    /// The world point with real-valued voxel coordinates on a face; `None` where there is none.
    pub fn unproject(&self, at: FacePoint) -> Option<DVec3> {
        let Some(local) = &self.local else {
            let across = at.voxel - self.offset;
            let [a, b, c] = self.rows.map(|row| row / row.length_squared());
            return Some(self.origin + a * across.x + b * across.y + c * across.z).filter(|p| p.is_finite());
        };
        let depth = self.depth_of_slice(at.voxel.z);
        let tangent = |v: f64| (v - 0.5 * self.side) / local.scale;
        let ray = DVec3::new(tangent(at.voxel.x), tangent(at.voxel.y), 1.0);
        let p = from_face(ray * depth, if local.is_cube { at.face } else { SPOT_FACE });
        Some(self.origin + self.rows[0] * p.x + self.rows[1] * p.y + self.rows[2] * p.z).filter(|p| p.is_finite())
    }

    /// Whether a point lies outside a spot light's cone.
    #[inline]
    pub fn is_outside_cone(&self, world: DVec3) -> bool {
        self.local.as_ref().is_some_and(|local| local.is_outside_cone(self.rotated(world)))
    }

    /// Depth along a face's axis at a real-valued slice, metres: from the light, or from the first slice.
    pub fn depth_of_slice(&self, slice: f64) -> f64 {
        let Some(local) = &self.local else { return slice * self.slice_m };
        let share = slice / self.side;
        if local.is_ndc {
            local.near_m / (1.0 - share * (1.0 - local.near_share))
        } else {
            libm::exp(local.log_near + share * local.log_ratio)
        }
    }

    /// Side of a texel at a point's depth, metres.
    #[inline]
    pub fn texel_m(&self, world: DVec3) -> f64 {
        let Some(local) = &self.local else { return self.texel_m };
        let p = self.rotated(world);
        let depth = if local.is_cube { p.abs().max_element() } else { p.z };
        depth.max(local.near_m) / local.scale
    }

    /// The grid about a point.
    pub fn frame(&self, world: DVec3) -> VoxelFrame {
        let [a, b, c] = self.rows;
        let Some(local) = &self.local else {
            // The rows are unit axes over the voxels' sizes.
            let [right, down, along] = [a * self.texel_m, b * self.texel_m, c * self.slice_m];
            return VoxelFrame {
                right,
                down,
                along,
                towards_light: -along,
                texel_m: self.texel_m,
                slice_m: self.slice_m,
            };
        };
        let p = self.rotated(world);
        let face = if local.is_cube { cube_face(p) } else { SPOT_FACE };
        let [right, down, along] = face_axes([a, b, c], face);
        let depth = on_face(p, face).z.max(local.near_m);
        let slice_m = if local.is_ndc {
            // NDC grows by (1/near - 1/z) over its whole range.
            depth * depth * (1.0 - local.near_share) / (local.near_m * self.side)
        } else {
            depth * local.log_ratio / self.side
        };
        let towards_light = (self.origin - world).try_normalize().unwrap_or(-along);
        VoxelFrame { right, down, along, towards_light, texel_m: depth / local.scale, slice_m }
    }
}

impl Local {
    /// The slice of a depth that is so many times that of another slice.
    fn slices_from_depth_ratio(&self, slice: f64, ratio: f64, side: f64) -> f64 {
        if self.is_ndc {
            let near_over_depth = (1.0 - slice / side * (1.0 - self.near_share)) / ratio;
            (1.0 - near_over_depth) / (1.0 - self.near_share) * side
        } else {
            slice + libm::log(ratio) / self.log_ratio * side
        }
    }

    #[inline]
    fn is_outside_cone(&self, p: DVec3) -> bool {
        self.cone_cosine > -1.0 && p.z < self.cone_cosine * p.length()
    }

    #[inline]
    fn project(&self, p: DVec3, side: f64) -> FacePoint {
        let face = if self.is_cube { cube_face(p) } else { SPOT_FACE };
        let voxel = self.voxel(on_face(p, face), side);
        FacePoint { face: if self.is_cube { face } else { 0 }, voxel }
    }

    /// Voxel coordinates of a point in the axes of its face.
    #[inline]
    fn voxel(&self, p: DVec3, side: f64) -> DVec3 {
        let middle = 0.5 * side;
        if p.z.is_nan() || p.z < self.near_m {
            return DVec3::new(middle, middle, -1.0);
        }
        let per_metre = self.scale / p.z;
        DVec3::new(p.x * per_metre + middle, p.y * per_metre + middle, self.slice(p.z, side))
    }

    /// Real-valued slice of a depth that is not before the near distance.
    #[inline]
    fn slice(&self, depth_m: f64, side: f64) -> f64 {
        let along = if self.is_ndc {
            (1.0 - self.near_m / depth_m) / (1.0 - self.near_share)
        } else {
            (libm::log(depth_m) - self.log_near) / self.log_ratio
        };
        // The first slice begins at the near distance itself, whatever a logarithm's last digit says.
        (along * side).max(0.0)
    }
}

/// The only face of a narrow spot light: along the third axis.
const SPOT_FACE: usize = 4;

/// The face of a cube about the light that a point in its axes projects to.
#[inline]
pub(crate) fn cube_face(p: DVec3) -> usize {
    let [x, y, z] = p.abs().to_array();
    let axis = if x >= y && x >= z {
        0
    } else if y >= z {
        1
    } else {
        2
    };
    2 * axis + usize::from(p[axis] < 0.0)
}

/// A point in the light's axes, in a face's: right, down, along.
#[inline]
pub(crate) fn on_face(p: DVec3, face: usize) -> DVec3 {
    let axis = face / 2;
    let (next, last) = (p[(axis + 1) % 3], p[(axis + 2) % 3]);
    if face.is_multiple_of(2) { DVec3::new(next, last, p[axis]) } else { DVec3::new(last, next, -p[axis]) }
}

/// The inverse of [`on_face`].
#[inline]
pub(crate) fn from_face(p: DVec3, face: usize) -> DVec3 {
    let axis = face / 2;
    let (next, last, along) = if face.is_multiple_of(2) { (p.x, p.y, p.z) } else { (p.y, p.x, -p.z) };
    let mut axes = DVec3::ZERO;
    axes[axis] = along;
    axes[(axis + 1) % 3] = next;
    axes[(axis + 2) % 3] = last;
    axes
}

/// A face's unit axes (right, down, along) of a light with the given ones. Faces of a cube are numbered as in the module's
/// table; a narrow spot light's is 4.
#[must_use]
pub fn face_axes(axes: [DVec3; 3], face: usize) -> [DVec3; 3] {
    let axis = face / 2;
    let (next, last) = (axes[(axis + 1) % 3], axes[(axis + 2) % 3]);
    if face.is_multiple_of(2) { [next, last, axes[axis]] } else { [last, next, -axes[axis]] }
}

/// `None` sideways of or before the volume, and for coordinates that are not numbers: lit.
#[inline(always)]
pub(crate) fn clamp_to_volume(voxel: DVec3, n: f64) -> Option<[u32; 3]> {
    let inside = voxel.x >= 0.0 && voxel.x < n && voxel.y >= 0.0 && voxel.y < n && voxel.z >= 0.0;
    // A cast of a non-negative number rounds down and saturates.
    inside.then(|| [voxel.x as u32, voxel.y as u32, (voxel.z as u32).min(n as u32 - 1)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_are_right_handed_and_see_their_own_side() {
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        for face in 0..6 {
            let [right, down, along] = face_axes(axes, face);
            assert_eq!(right.cross(down), along, "face {face}");
            let p = along * 3.0 + right * 0.5 - down * 0.25;
            assert_eq!(cube_face(p), face);
            assert_eq!(on_face(p, face), DVec3::new(0.5, -0.25, 3.0));
            assert_eq!(from_face(on_face(p, face), face), p);
        }
    }
}
