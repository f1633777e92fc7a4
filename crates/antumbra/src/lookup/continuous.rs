//! Continuous lookups: silhouettes between the middles of texels. Ours.
//!
//! The encoding [`silhouette`](crate::format::silhouette) holds the casters' own edges and planes. At the middles of texels their signs and
//! values are the voxels' answers; in between they are just as well defined, and tell where a shadow's edge really runs, so that it has no stairs
//! however near it is seen. Tiles stay as the texels have them: where an edge leaves a tile between the middles of two rows, so that
//! neither tile holds it, a shadow may end up to half a texel beside it. Masks of 8 x 8 texels have nothing in between.

use glam::DVec3;

use super::silhouette::{Plane, Value, descend, region};
use super::top_grid::TopGrid;
use crate::format::silhouette::{Form, Kind, Turns, kind, payload};
use crate::format::slices::Spread;

/// A place between texels and slices.
struct Between<'a> {
    texel: [u32; 2],
    /// From the texel's middle on, within half a texel.
    rest: [f64; 2],
    slice: u32,
    /// Share of the slice before it.
    share: f64,
    spread: Spread<'a>,
}

/// Whether real-valued voxel coordinates of a face are lit; they are inside of it sideways and not before its first slice.
pub(crate) fn is_lit(pool: &[u32], grid: &TopGrid, voxel: DVec3, spread: Spread<'_>) -> bool {
    // A cast rounds down and saturates: behind the last slice is as the end of the last.
    let slice = (voxel.z as u32).min(spread.count() - 1);
    let share = (voxel.z - f64::from(slice)).min(1.0);
    let texel = [voxel.x as u32, voxel.y as u32];
    let rest = [voxel.x - f64::from(texel[0]) - 0.5, voxel.y - f64::from(texel[1]) - 0.5];
    let (tile, _) = descend(pool, grid.node([texel[0], texel[1], 0]), grid.level, 0, texel);
    Between { texel, rest, slice, share, spread }.is_lit(pool, tile)
}

impl Between<'_> {
    fn is_lit(&self, pool: &[u32], leaf: u32) -> bool {
        let value = match kind(leaf) {
            Kind::Masks => {
                return Turns::read(pool, payload(leaf)).depth(self.texel).is_none_or(|depth| self.slice < depth);
            }
            Kind::Cut | Kind::Cross => region(pool, leaf, |edge| self.value(&edge, 0) >= 0.0),
            _ => leaf,
        };
        Value::read(pool, value, self.spread).is_lit(self.slice, |plane| self.is_before(plane))
    }

    /// A form's value less a whole number: of great ones the difference is small where it counts.
    fn value(&self, form: &Form, less: i64) -> f64 {
        let whole = form.at(self.texel) - less;
        whole as f64 + (f64::from(form.a) * self.rest[0] + f64::from(form.b) * self.rest[1])
    }

    /// Whether the place lies before a plane: the values with which planes lie behind a whole slice are those of its end.
    fn is_before(&self, plane: &Plane) -> bool {
        let of = |slice: u32| self.spread.least_behind(slice)[usize::from(plane.is_deep)];
        let end = of(self.slice);
        let width = if self.slice > 0 { end - of(self.slice - 1) } else { of(1) - end };
        let shift = plane.form.shift;
        self.value(&plane.form, (end - width) << shift) >= self.share * (width << shift) as f64
    }
}
