//! Shadow maps of lamps, drawn anew for each frame: for lamps that move, for virtual point lights, and for what moves
//! through a baked lamp's light.
//!
//! Selgrad, Müller, Reintges, Stamminger 2016, *Fast shadow map rendering for many-lights settings*: a lamp's map is a cube's six
//! sides or two paraboloids (Brabec, Annen, Seidel 2002, *Shadow mapping for hemispherical and omnidirectional light sources*), of
//! which many lie in tiles of one texture; before it is drawn, voxel culling ([`crate::culling`]) finds the triangles that can cast
//! a shadow from the lamp onto anything that is seen.
//!
//! Beyond the paper: paraboloids are drawn exactly, texel by texel, so that large triangles need no cutting; marks are kept
//! for each side of a map; and receivers move off their surface just as far as the filter needs, so that no bias is left to
//! tune but the rounding of depth.

pub(crate) mod reference;

use antumbra::Filter;
use glam::{DVec2, DVec3};

use crate::RenderError;
use crate::culling::{Binning, Footprint, Grid};

/// How lamps' shadow maps are drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct LampMaps {
    /// How directions become texels.
    pub projection: MapProjection,
    /// Texels per side of a cube's face or of a paraboloid at most, 64 to 4096.
    pub size: u32,
    /// Whether lamps far from the camera have smaller maps: of the least power of two whose texels are no larger than pixels are,
    /// where the lamp's light comes nearest to the camera (after Olsson, Billeter, Sintorn, Kämpe, Assarsson 2015, *More efficient
    /// virtual shadow maps for many lights*).
    pub adaptive: bool,
    /// Taps of a lookup.
    pub filter: Filter,
    /// Which triangles are left to draw.
    pub culling: Culling,
    /// Cells of the culling grid along each axis, 8 to 128.
    pub grid: u32,
    /// What becomes of triangles that touch many cells.
    pub binning: Binning,
    /// Which lamps share what is culled.
    pub clustering: Clustering,
    /// Most bytes of maps at a time: lamps whose maps need more come in batches. One lamp's are there in any case.
    pub budget_bytes: u64,
    /// Most lamps in a batch, 1 to 64; the paper's tiling: 16.
    pub batch: u32,
    /// Whether triangles are sorted into the grid for every frame, though nothing has moved: to time it.
    pub always_bin: bool,
    /// Whether a map is kept while its lamp stands still, nothing moves in its marked cells, and no others become marked. It takes voxel
    /// culling, and room for the maps of all lamps at once.
    pub reuse: bool,
}

/// How the directions around a lamp become the texels of its map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MapProjection {
    /// Six sides of a cube along the world's axes.
    #[default]
    Cube,
    /// Two paraboloids, above and below: a third of the texels, and fewer draws.
    Paraboloid,
}

/// How triangles are culled before a lamp's map is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Culling {
    /// Not at all: all triangles are drawn into every side.
    None,
    /// Cells outside of the convex hull of the camera's frustum and the lamp, and of the side's frustum: the standard.
    Frusta,
    /// Cells that do not lie between the lamp and anything that is seen.
    Voxels(Marking),
}

/// How the cells between what is seen and a lamp are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Marking {
    /// By exact beams between boxes of what is seen and of lamps, for each side of the map.
    #[default]
    Sides,
    /// The same for all sides at once.
    Boxes,
    /// By beams between whole cells, as in the paper, slices in parallel.
    Cells,
    /// Step by step from cell to cell, each with its neighbours: what the paper improves on. It does not know how wide lookups
    /// are, and so may miss casters.
    Steps,
}

/// Which lamps share one culling.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clustering {
    /// None.
    None,
    /// Those in the same block of so many cells along each axis: 1, 2, 4 or 8; the paper: 1.
    Cells(u32),
}

impl MapProjection {
    /// How many sides a map has.
    #[must_use]
    pub fn sides(self) -> u32 {
        match self {
            Self::Cube => 6,
            Self::Paraboloid => 2,
        }
    }
}

impl Default for LampMaps {
    fn default() -> Self {
        Self {
            projection: MapProjection::default(),
            size: 512,
            adaptive: true,
            filter: Filter::default(),
            culling: Culling::Voxels(Marking::default()),
            grid: 32,
            binning: Binning::Whole,
            clustering: Clustering::Cells(1),
            budget_bytes: 256 << 20,
            batch: 16,
            always_bin: false,
            reuse: true,
        }
    }
}

impl LampMaps {
    /// Whether maps can be drawn so.
    ///
    /// # Errors
    /// [`RenderError::Samples`], which names the option that makes no sense.
    pub fn check(&self) -> Result<(), RenderError> {
        let within = |name, value: u32, least, most| {
            let error = RenderError::Samples { name, value, least, most };
            if (least..=most).contains(&value) { Ok(()) } else { Err(error) }
        };
        within("the size of lamps' maps", self.size, 64, 4096)?;
        within("the culling grid", self.grid, *Grid::SIDES.start(), *Grid::SIDES.end())?;
        within("the batch of lamps", self.batch, 1, 64)?;
        if let Clustering::Cells(cells) = self.clustering {
            within("the cells of a cluster", cells, 1, 8)?;
            within("the cells of a cluster, as powers of two,", cells.count_ones(), 1, 1)?;
        }
        Ok(())
    }

    /// Lamps whose maps are there at a time.
    pub(crate) fn lamps_at_once(&self) -> u32 {
        let own = 4 * u64::from(self.size) * u64::from(self.size) * u64::from(self.projection.sides());
        (self.budget_bytes / own).clamp(1, u64::from(self.batch)) as u32
    }

    /// The map of a lamp whose light ends after so many metres, seen from a distance by pixels of a size at distance 1.
    pub(crate) fn shape(&self, reach_m: f64, distance_m: f64, pixel_size: f64) -> Shape {
        let shape = |size| Shape { projection: self.projection, size, radius: self.filter.radius() };
        let nearest_m = distance_m - reach_m;
        if !self.adaptive || !reach_m.is_finite() || nearest_m <= 0.0 {
            return shape(self.size);
        }
        // A texel at the light's end is 2 / N of its distance.
        let wanted = (2.0 * reach_m / (nearest_m * pixel_size)).min(f64::from(self.size)).max(1.0) as u32;
        shape(wanted.next_power_of_two().max(LEAST_SIZE).min(self.size))
    }
}

/// Texels per side of the smallest maps.
const LEAST_SIZE: u32 = 64;

/// Error of a depth, relative to itself.
pub(crate) const ROUNDING: f64 = 1e-5;

/// A map's geometry, all lengths relative to the lamp: twin of `lookup.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shape {
    projection: MapProjection,
    size: u32,
    /// Taps on either side of the middle one.
    radius: u32,
}

/// Where a point appears in a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mapped {
    pub side: u32,
    /// In texels.
    pub at: DVec2,
    /// Depth, metres: along the side's axis or, in a paraboloid, along the ray.
    pub depth_m: f64,
}

impl Shape {
    /// Texels per side.
    #[cfg(feature = "gpu")]
    pub fn size(&self) -> u32 {
        self.size
    }

    /// Texels at each border that only filters read.
    pub fn border(&self) -> u32 {
        self.radius + 1
    }

    /// Texels per side within the border.
    fn inner(&self) -> f64 {
        f64::from(self.size - 2 * self.border())
    }

    /// Share of a side within its border.
    pub fn scale(&self) -> f64 {
        self.inner() / f64::from(self.size)
    }

    /// How far along its border's slope a side still shows what a lookup reads.
    #[cfg(feature = "gpu")]
    pub fn border_slope(&self) -> f64 {
        // A filter's diagonal reaches farther over a paraboloid's rim.
        let diagonal = if self.projection == MapProjection::Cube { 1.0 } else { 1.5 };
        diagonal * 2.0 * f64::from(self.border()) / self.inner()
    }

    /// Texels beside its own that a lookup reads at most, and a little more.
    fn reach(&self) -> f64 {
        f64::from(self.radius) + 0.5 + 1.0 / 16.0
    }

    /// How far along its unit normal a point moves off its surface, metres, so that no tap falls on the surface itself.
    pub fn offset_m(&self, from_light: DVec3, normal: DVec3) -> f64 {
        let (inner, reach) = (self.inner(), self.reach());
        if self.projection == MapProjection::Cube {
            let offset = |axis: usize| {
                // The moved point's texel may be wider than the point's, by as much as it moves along the axis.
                let texel_m = 2.0 * from_light[axis].abs() / (inner - 1.42 * reach);
                reach * texel_m * (normal[(axis + 1) % 3].abs() + normal[(axis + 2) % 3].abs())
            };
            let first = offset(from_light.abs().max_position());
            // It may move over to another side.
            return first.max(offset((from_light + normal * first).abs().max_position()));
        }
        // A step on the map is a turn by an angle of twice that over 1 + r^2.
        let distance = from_light.length();
        let r = DVec2::new(from_light.x, from_light.z).length() / (distance + from_light.y.abs());
        let r = (r - 2.83 * reach / inner).clamp(0.0, 1.0);
        let turn = (5.66 * reach / inner / (1.0 + r * r)).min(1.0).sin();
        let (mut moved, mut offset) = (from_light, 0.0);
        for _ in 0..2 {
            let cosine = normal.dot(moved) / moved.length().max(1e-30);
            offset =
                distance * turn * (1.0 - cosine * cosine).max(0.0).sqrt() / (1.0 - turn) + 0.125 * distance / inner;
            moved = from_light + normal * offset;
        }
        offset
    }

    /// How far beside its point a lookup reads.
    #[cfg(feature = "gpu")]
    pub fn footprint(&self) -> Footprint {
        let (inner, reach) = (self.inner(), self.reach());
        match self.projection {
            MapProjection::Cube => Footprint::of_cube((inner - 1.42 * reach).max(1.0) as u32, 2 * self.radius + 1),
            MapProjection::Paraboloid => {
                let turn = (5.66 * reach / inner).min(1.0).sin();
                let offset = turn / (1.0 - turn) + 0.125 / inner;
                Footprint { per_m: offset + turn * (1.0 + offset) }
            }
        }
    }

    /// Where a point appears.
    pub fn map(&self, p: DVec3) -> Mapped {
        let (side, at, depth_m) = match self.projection {
            MapProjection::Cube => {
                let axis = p.abs().max_position();
                let depth = p[axis].abs();
                let side = 2 * axis as u32 + u32::from(p[axis] < 0.0);
                (side, DVec2::new(p[(axis + 1) % 3], p[(axis + 2) % 3]) / depth, depth)
            }
            MapProjection::Paraboloid => {
                let depth = p.length();
                (u32::from(p.y < 0.0), DVec2::new(p.x, p.z) / (depth + p.y.abs()), depth)
            }
        };
        Mapped { side, at: (at * self.scale() + 1.0) * (0.5 * f64::from(self.size)), depth_m }
    }

    /// The ray through a texel's middle: a unit of it is a unit of depth.
    pub fn ray(&self, side: u32, texel: [u32; 2]) -> DVec3 {
        let at = DVec2::from(texel.map(|t| f64::from(t) + 0.5));
        let at = (at * (2.0 / f64::from(self.size)) - 1.0) / self.scale();
        match self.projection {
            MapProjection::Cube => {
                let axis = side as usize / 2;
                let mut ray = DVec3::ZERO;
                ray[axis] = if side.is_multiple_of(2) { 1.0 } else { -1.0 };
                (ray[(axis + 1) % 3], ray[(axis + 2) % 3]) = (at.x, at.y);
                ray
            }
            MapProjection::Paraboloid => {
                let squared = at.length_squared();
                let up = if side == 0 { 1.0 - squared } else { squared - 1.0 };
                DVec3::new(2.0 * at.x, up, 2.0 * at.y) / (1.0 + squared)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::r2;

    fn shapes() -> impl Iterator<Item = Shape> {
        let of = |projection| {
            let of_size = move |size| [0, 1, 4].map(|radius| Shape { projection, size, radius });
            [64, 256, 2048].into_iter().flat_map(of_size)
        };
        of(MapProjection::Cube).chain(of(MapProjection::Paraboloid))
    }

    fn direction(i: u32) -> DVec3 {
        let (z, turn) = (2.0 * r2(i).x - 1.0, std::f64::consts::TAU * r2(i).y);
        let across = (1.0 - z * z).sqrt();
        DVec3::new(across * turn.cos(), across * turn.sin(), z)
    }

    #[test]
    fn texels_rays_go_through_what_appears_there() {
        for shape in shapes() {
            for i in 0..2000 {
                let point = direction(i) * (1.0 + f64::from(i % 7));
                let mapped = shape.map(point);
                let texel = mapped.at.floor().to_array().map(|t| t as u32);
                let (low, high) = (f64::from(shape.border()) - 1e-6, f64::from(shape.size - shape.border()) + 1e-6);
                assert!(mapped.at.min_element() >= low && mapped.at.max_element() <= high, "{shape:?} {mapped:?}");
                let ray = shape.ray(mapped.side, texel);
                let again = shape.map(ray * mapped.depth_m);
                assert!((again.depth_m - mapped.depth_m).abs() < 1e-9 * mapped.depth_m);
                let off = (again.at - DVec2::from(texel.map(f64::from)) - 0.5).abs().max_element();
                assert!(off < 1e-6 || again.side != mapped.side, "{shape:?}: {off}");
                assert!(ray.normalize().dot(point.normalize()) > 1.0 - 20.0 / f64::from(shape.size).powi(2));
            }
        }
    }

    /// A plane never shadows itself, under any light and any filter.
    #[test]
    fn no_tap_meets_the_surface_that_is_looked_up() {
        for shape in shapes() {
            for i in 0..3000 {
                let normal = direction(i);
                // Lights above the plane, down to grazing ones.
                let light = direction(i + 7919);
                let light = light * normal.dot(light).signum();
                let from_light = -(light + normal * 1e-4) * 3.0;
                let moved = from_light + normal * shape.offset_m(from_light, normal);
                let here = shape.map(moved);
                let radius = shape.radius as i32;
                for y in -radius..=radius {
                    for x in -radius..=radius {
                        let texel = [here.at.x as i32 + x, here.at.y as i32 + y].map(|t| t as u32);
                        let ray = shape.ray(here.side, texel);
                        let meets = normal.dot(from_light) / normal.dot(ray);
                        let is_shadowed = meets > 0.0 && meets * (1.0 + ROUNDING) < here.depth_m;
                        assert!(!is_shadowed, "{shape:?}: {meets} before {} at {i}", here.depth_m);
                    }
                }
            }
        }
    }

    #[cfg(feature = "gpu")]
    #[test]
    fn footprints_hold_what_lookups_read() {
        for shape in shapes() {
            for i in 0..3000 {
                let (normal, from_light) = (direction(i), direction(i + 104_729) * 2.0);
                let moved = from_light + normal * shape.offset_m(from_light, normal);
                let here = shape.map(moved);
                let radius = shape.radius as i32;
                for [x, y] in [[-radius, -radius], [radius, -radius], [-radius, radius], [radius, radius]] {
                    let texel = [here.at.x as i32 + x, here.at.y as i32 + y].map(|t| t as u32);
                    let read = shape.ray(here.side, texel) * here.depth_m;
                    let reach = shape.footprint().per_m * from_light.length();
                    let off = (read - from_light).length();
                    assert!(off <= reach, "{shape:?}: {off} beyond {reach}");
                }
            }
        }
    }
}
