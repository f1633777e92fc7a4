//! Whether a plane is right throughout a tile, where more is known of the tile than that.

use antumbra::format::silhouette::Form;

use super::form::{AS_IT_IS, DEEP, EdgeKey, PlaneKey, Side, edge_form, plane_form};
use super::sketch::Set;
use crate::columns::{BuildTriangle, Tile};
use crate::light_space::Slices;

/// What forms are made of.
#[derive(Clone, Copy)]
pub(crate) struct Forms<'a> {
    pub triangles: &'a [BuildTriangle],
    pub slices: &'a Slices,
}

impl Forms<'_> {
    pub fn plane(&self, key: PlaneKey) -> Option<Form> {
        plane_form(&self.triangles[key.triangle as usize], key.side, self.slices)
    }

    /// The back of a wedge.
    pub fn back(&self, key: PlaneKey) -> Option<Form> {
        let has_back = key.back != AS_IT_IS && key.back != DEEP;
        has_back.then(|| plane_form(&self.triangles[key.back as usize], Side::Before, self.slices))?
    }

    pub fn edge(&self, key: EdgeKey) -> Form {
        edge_form(key, self.slices.resolution())
    }

    /// A plane's depths over a tile's corners.
    fn over(&self, plane: PlaneKey, tile: Tile) -> Option<Over> {
        let at = |form: Form| corners(tile).map(|texel| i128::from(form.at(texel)) << (32 - form.shift));
        let own = self.plane(plane)?;
        Some(match plane.back {
            AS_IT_IS => Over { forms: [at(own); 3], is_wedge: false },
            DEEP => Over { forms: [at(own.deep()); 3], is_wedge: false },
            _ => Over { forms: [at(own), at(own.deep()), at(self.back(plane)?)], is_wedge: true },
        })
    }

    /// Whether a plane is right throughout a region of a tile: not before what must be lit, not behind what must be shadowed, both of
    /// which constants bound, and planes that are known to be right.
    pub fn accepts(&self, set: &Set, tile: Tile, plane: PlaneKey) -> bool {
        if set.planes().any(|known| known == plane) {
            return true;
        }
        let Some(own) = self.over(plane, tile) else { return false };
        let [low, high] = [set.low, set.high].map(|depth| [i128::from(depth) << 32; 4]);
        let known = || set.planes().filter_map(|known| self.over(known, tile));
        let is_late =
            own.is_behind(&low) || known().any(|known| known.groups().all(|g| g.iter().any(|f| own.is_behind(f))));
        let ends = set.high >= self.slices.resolution().texels();
        // Depths below the next whole one are rounded down.
        let high = high.map(|depth| depth | 0xffff_ffff);
        is_late && (ends || own.is_before(&high) || known().any(|known| own.is_before_other(&known)))
    }
}

/// Depths over a tile's corners in parts of 2^-32 of a slice: the greatest of groups, each the least of its forms.
struct Over {
    /// Of a wedge: the front, the front's deep form, and the back.
    forms: [[i128; 4]; 3],
    is_wedge: bool,
}

impl Over {
    fn groups(&self) -> impl Iterator<Item = &[[i128; 4]]> {
        let (front, rest) = self.forms.split_at(1);
        [front, rest].into_iter().take(if self.is_wedge { 2 } else { 1 })
    }

    /// Whether it lies behind a plane.
    fn is_behind(&self, plane: &[i128; 4]) -> bool {
        self.groups().any(|group| group.iter().all(|form| is_below(plane, form)))
    }

    /// Whether it lies before a plane.
    fn is_before(&self, plane: &[i128; 4]) -> bool {
        self.groups().all(|group| group.iter().any(|form| is_below(form, plane)))
    }

    fn is_before_other(&self, other: &Self) -> bool {
        self.groups().all(|group| group.iter().any(|form| other.is_behind(form)))
    }
}

fn is_below(a: &[i128; 4], b: &[i128; 4]) -> bool {
    a.iter().zip(b).all(|(a, b)| a <= b)
}

/// First and last texels of a tile, x fastest.
pub(crate) fn corners(tile: Tile) -> [[u32; 2]; 4] {
    let side = (1 << tile.log2) - 1;
    let [x, y] = [tile.x, tile.y];
    [[x, y], [x + side, y], [x, y + side], [x + side, y + side]]
}
