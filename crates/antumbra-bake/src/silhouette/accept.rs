//! Whether a plane is right throughout a tile, where more is known of the tile than that.

use antumbra::format::silhouette::Form;

use super::form::{EdgeKey, Plane, Second, Surface, edge_form};
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
    /// A plane's form; deep planes are made of it when they are looked up.
    pub fn plane(&self, plane: Plane) -> Option<Form> {
        plane.form(self.triangles, self.slices)
    }

    pub fn edge(&self, key: EdgeKey) -> Form {
        edge_form(key, self.slices.resolution())
    }

    /// The deep form of a plane.
    #[inline(always)]
    pub fn deep(&self, form: Form) -> Form {
        self.slices.spread().deep(form)
    }

    /// A deep form's depth, in units, as that of a plane which is as deep.
    #[inline]
    pub fn of_deep(&self, units: f64) -> f64 {
        self.slices.half_of_deep().of(units)
    }

    /// A surface's values over a tile's corners.
    fn over(&self, surface: Surface, tile: Tile) -> Option<Over> {
        let deep = |form: Form| {
            let ends = Ends::new(self.deep(form), tile);
            if self.slices.are_even() { Some(ends) } else { ends.as_plain(self) }
        };
        let of = |plane: Plane| {
            let form = self.plane(plane)?;
            if plane.is_deep() { deep(form) } else { Some(Ends::new(form, tile)) }
        };
        Some(match surface.second() {
            Second::None => Over::plane(of(surface.first)?),
            Second::Back(back) => {
                let front = self.plane(surface.first)?;
                Over { forms: [Ends::new(front, tile), deep(front)?, of(back)?], groups: 2 }
            }
            Second::Other(other) => Over { forms: [of(surface.first)?, of(surface.first)?, of(other)?], groups: 1 },
        })
    }

    /// Whether a surface is right throughout a region of a tile: not before what must be lit, not behind what must be shadowed, both of
    /// which constants bound, and surfaces that are known to be right.
    pub fn accepts(&self, set: &Set, tile: Tile, surface: Surface) -> bool {
        if set.surfaces().any(|known| known == surface) {
            return true;
        }
        let Some(own) = self.over(surface, tile) else { return false };
        let known = || set.surfaces().filter_map(|known| self.over(known, tile));
        let is_late = set.low == 0
            || own.is_behind(&Ends::constant(self.first_value(set.low)))
            || known().any(|known| known.groups().all(|g| g.iter().any(|f| own.is_behind(f))));
        let is_early = || {
            // Values below the next whole one are rounded down.
            let last = (self.first_value(set.high + 1) << FRACTION_BITS) - 1;
            own.is_before(&Ends { at: [last; 4], slack: 0 })
        };
        let ends = set.high >= self.slices.resolution().texels();
        is_late && (ends || is_early() || known().any(|known| own.is_before_other(&known)))
    }

    /// The least whole value of a plane whose depth is so deep, 1 to N.
    pub fn first_value(&self, depth: u32) -> i128 {
        self.slices.spread().least_behind(depth - 1)[0].into()
    }
}

/// Bits of a value's fraction.
const FRACTION_BITS: u32 = 32;
/// By how much a deep plane's value, in lattice steps, may lie off that of the plane which is as deep: beginnings of slices are whole.
const DEEP_STEPS: i128 = 2;

/// A plane's values over a tile's corners, in parts of 2^-32 of a unit, and by how much they may be off.
#[derive(Clone, Copy)]
struct Ends {
    at: [i128; 4],
    slack: i128,
}

impl Ends {
    fn new(form: Form, tile: Tile) -> Self {
        let at = corners(tile).map(|texel| i128::from(form.at(texel)) << (FRACTION_BITS - form.shift));
        Self { at, slack: 0 }
    }

    fn constant(value: i128) -> Self {
        Self { at: [value << FRACTION_BITS; 4], slack: 0 }
    }

    /// Of a deep plane in lattice steps: as those of a plane. `None` before the first slice, which counts no half.
    fn as_plain(self, forms: &Forms<'_>) -> Option<Self> {
        let one = (1i64 << FRACTION_BITS) as f64;
        let plain = |value: i128| (forms.of_deep(value as f64 / one) * one) as i128;
        let is_inside = self.at.iter().all(|value| *value >= 0);
        is_inside.then(|| Self { at: self.at.map(plain), slack: DEEP_STEPS << FRACTION_BITS })
    }

    fn is_before(&self, other: &Self) -> bool {
        let slack = self.slack + other.slack;
        self.at.iter().zip(&other.at).all(|(a, b)| a + slack <= *b)
    }
}

/// A surface's values: the greatest of groups, each the least of its planes'.
struct Over {
    /// Of a wedge: the front in one group, its deep form and the back in the other. Else all are one group.
    forms: [Ends; 3],
    groups: usize,
}

impl Over {
    fn plane(ends: Ends) -> Self {
        Self { forms: [ends; 3], groups: 1 }
    }

    fn groups(&self) -> impl Iterator<Item = &[Ends]> {
        let (first, rest) = self.forms.split_at(if self.groups == 2 { 1 } else { 3 });
        [first, rest].into_iter().take(self.groups)
    }

    /// Whether it lies behind a plane.
    fn is_behind(&self, plane: &Ends) -> bool {
        self.groups().any(|group| group.iter().all(|form| plane.is_before(form)))
    }

    /// Whether it lies before a plane.
    fn is_before(&self, plane: &Ends) -> bool {
        self.groups().all(|group| group.iter().any(|form| form.is_before(plane)))
    }

    fn is_before_other(&self, other: &Self) -> bool {
        self.groups().all(|group| group.iter().any(|form| other.is_behind(form)))
    }
}

/// First and last texels of a tile, x fastest.
pub(crate) fn corners(tile: Tile) -> [[u32; 2]; 4] {
    let side = (1 << tile.log2) - 1;
    let [x, y] = [tile.x, tile.y];
    [[x, y], [x + side, y], [x, y + side], [x + side, y + side]]
}
