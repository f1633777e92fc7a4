//! Whether a plane is right throughout a tile, where more is known of the tile than that.

use std::hash::BuildHasher;

use antumbra::format::silhouette::Form;
use rustc_hash::FxBuildHasher;

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

    /// A surface's planes.
    fn shape(&self, surface: Surface) -> Option<Shape> {
        let of = |plane: Plane| {
            let form = self.plane(plane)?;
            Some(if plane.is_deep() { (self.deep(form), true) } else { (form, false) })
        };
        let first = of(surface.first)?;
        Some(match surface.second() {
            Second::None => Shape { planes: [first; 3], first: 1, count: 1 },
            Second::Back(back) => Shape { planes: [first, (self.deep(first.0), true), of(back)?], first: 1, count: 3 },
            Second::Nearer(other) => Shape { planes: [first, of(other)?, first], first: 2, count: 2 },
            Second::Farther(other) => Shape { planes: [first, of(other)?, first], first: 1, count: 2 },
        })
    }

    /// A shape's values at a polygon's corners; whether they can be told.
    fn evaluate(&self, shape: &Shape, polygon: &Polygon, over: &mut Over) -> bool {
        (over.first, over.count) = (shape.first, shape.count);
        for (ends, (form, is_deep)) in over.ends.iter_mut().zip(&shape.planes[..shape.count]) {
            let own = if *is_deep { Ends::of_deep(*form, polygon, self) } else { Some(Ends::new(*form, polygon)) };
            let Some(own) = own else { return false };
            *ends = own;
        }
        true
    }

    /// The least whole value of a plane whose depth is so deep, 1 to N.
    pub fn first_value(&self, depth: u32) -> f64 {
        self.slices.spread().least_behind(depth - 1)[0] as f64
    }
}

/// Shapes that are kept.
const KEPT_SHAPES: usize = 64;

/// Surfaces of which some are right throughout a part of a tile, and others may be. Kept from tile to tile, for its lists.
pub(crate) struct Candidates<'a> {
    pub forms: Forms<'a>,
    /// Each once.
    surfaces: Vec<Surface>,
    /// Their values over the part at hand, and whether they can be told, where they have been asked for.
    over: Vec<(Option<bool>, Over)>,
    /// Shapes that were asked for lately, each at a place of its surface's: neighbours have the same ones.
    shapes: Vec<(Surface, Option<Shape>)>,
}

impl<'a> Candidates<'a> {
    /// None yet.
    pub fn new(forms: Forms<'a>) -> Self {
        Self { forms, surfaces: Vec::new(), over: Vec::new(), shapes: vec![(Surface::NONE, None); KEPT_SHAPES] }
    }

    /// Takes the surfaces of some sets.
    pub fn gather<'s>(&mut self, sets: impl IntoIterator<Item = &'s Set>) {
        self.surfaces.clear();
        for surface in sets.into_iter().flat_map(Set::surfaces) {
            if !self.surfaces.contains(&surface) {
                self.surfaces.push(surface);
            }
        }
    }

    pub fn len(&self) -> usize {
        self.surfaces.len()
    }

    pub fn surface(&self, number: usize) -> Surface {
        self.surfaces[number]
    }

    /// Turns to another part.
    pub fn forget(&mut self) {
        let missing = self.surfaces.len().saturating_sub(self.over.len());
        self.over.extend(std::iter::repeat_n((None, Over::NONE), missing));
        self.over.iter_mut().for_each(|(is_told, _)| *is_told = None);
    }

    /// Finds a surface's values over a polygon: they are in `over` then.
    fn evaluate(&mut self, number: usize, polygon: &Polygon) {
        let Self { forms, surfaces, over, shapes } = self;
        let (is_told @ None, over) = &mut over[number] else { return };
        let surface = surfaces[number];
        let (kept, shape) = &mut shapes[FxBuildHasher.hash_one(surface) as usize % KEPT_SHAPES];
        if *kept != surface {
            (*kept, *shape) = (surface, forms.shape(surface));
        }
        *is_told = Some(shape.as_ref().is_some_and(|shape| forms.evaluate(shape, polygon, over)));
    }

    /// A surface's values over the part at hand, which were found before.
    fn over(&self, number: usize) -> Option<&Over> {
        let (is_told, over) = &self.over[number];
        (*is_told == Some(true)).then_some(over)
    }

    /// Whether a surface is right throughout a polygon: not before what must be lit, not behind what must be shadowed, both of which
    /// constants bound, and surfaces that are known to be right.
    pub fn accepts(&mut self, number: usize, part: &(Polygon, &Set)) -> bool {
        let (polygon, set) = part;
        if set.surfaces().any(|known| known == self.surface(number)) {
            return true;
        }
        self.evaluate(number, polygon);
        let Some(own) = self.over(number) else { return false };
        let slices = self.forms.slices.resolution().texels();
        let first_value = |depth: u32| self.forms.first_value(depth);
        let is_late = set.low == 0 || own.is_behind(&polygon.constant(first_value(set.low)));
        // Values below the next whole one are rounded down.
        let is_early = set.high >= slices || own.is_before(&polygon.constant(first_value(set.high + 1)));
        (is_late || self.knows(number, part, Over::is_behind_other))
            && (is_early || self.knows(number, part, Over::is_before_other))
    }

    /// Whether a surface has some relation to one of those that are known to be right.
    fn knows(
        &mut self,
        number: usize,
        (polygon, set): &(Polygon, &Set),
        relation: impl Fn(&Over, &Over) -> bool,
    ) -> bool {
        set.surfaces().any(|known| {
            let Some(known) = self.surfaces.iter().position(|surface| *surface == known) else { return false };
            self.evaluate(known, polygon);
            self.over(number).zip(self.over(known)).is_some_and(|(own, known)| relation(own, known))
        })
    }
}

/// Corners of a square that two edges cut, at most.
pub(crate) const MOST_CORNERS: usize = 6;
/// By how much a sum of terms may be off, and corners, in texels: rounding of double precision, of numbers up to 2^20.
pub(crate) const ROUNDING: f64 = 1.0 / (1u64 << 50) as f64;
pub(crate) const CORNER_ERROR: f64 = 1.0 / (1u64 << 30) as f64;
/// By how much a deep plane's value, in lattice steps, may lie off that of the plane which is as deep: beginnings of slices are whole.
const DEEP_STEPS: f64 = 2.0;

/// A convex polygon that holds the centres of a region's texels.
#[derive(Clone, Copy)]
pub(crate) struct Polygon {
    pub corners: [[f64; 2]; MOST_CORNERS],
    pub count: usize,
    /// The greatest texels of the tile that it is of.
    last: [f64; 2],
}

impl Polygon {
    /// All of a tile.
    pub fn of_tile(tile: Tile) -> Self {
        let [a, b, c, d] = corners(tile).map(|texel| texel.map(f64::from));
        // Around it.
        Self { corners: [a, b, d, c, c, c], count: 4, last: d }
    }

    /// The part of a tile on some sides of one edge or two: the left one where it is set.
    pub fn of_part(tile: Tile, edges: impl IntoIterator<Item = (Form, bool)>) -> Self {
        let all = Self::of_tile(tile);
        let part = edges.into_iter().fold(all, |polygon, (edge, is_left)| polygon.cut(&edge, is_left));
        // What rounding leaves nothing of.
        if part.count == 0 { all } else { part }
    }

    /// Values at texels are whole: those to keep are not negative to the left and -1 or less to the right. The line lies a unit beyond either, so
    /// that no rounding of a corner leaves one out.
    fn cut(&self, edge: &Form, is_left: bool) -> Self {
        let (sign, beyond) = if is_left { (1.0, 1.0) } else { (-1.0, 0.0) };
        let [a, b, c] = [f64::from(edge.a), f64::from(edge.b), edge.c as f64 + beyond].map(|factor| sign * factor);
        let at = |[x, y]: [f64; 2]| a * x + b * y + c;
        let mut part = Self { corners: [[0.0; 2]; MOST_CORNERS], count: 0, ..*self };
        for i in 0..self.count {
            let (p, q) = (self.corners[i], self.corners[if i + 1 == self.count { 0 } else { i + 1 }]);
            let (here, next) = (at(p), at(q));
            if here >= 0.0 {
                part.push(p);
            }
            if (here < 0.0) != (next < 0.0) {
                let share = here / (here - next);
                part.push([0, 1].map(|axis| p[axis] + share * (q[axis] - p[axis])));
            }
        }
        part
    }

    fn push(&mut self, corner: [f64; 2]) {
        if self.count < MOST_CORNERS {
            self.corners[self.count] = corner;
            self.count += 1;
        }
    }

    pub fn constant(&self, value: f64) -> Ends {
        self.values([value; MOST_CORNERS], 0.0)
    }

    /// A plane of no form of which its values are known.
    pub fn values(&self, at: [f64; MOST_CORNERS], slack: f64) -> Ends {
        Ends { form: None, is_plain: false, at, count: self.count, slack }
    }
}

/// A plane's values at a polygon's corners, in units, and by how much they may be off.
#[derive(Clone, Copy)]
pub(crate) struct Ends {
    /// If it is known.
    form: Option<Form>,
    is_plain: bool,
    at: [f64; MOST_CORNERS],
    count: usize,
    slack: f64,
}

impl Ends {
    const NONE: Self = Self { form: None, is_plain: false, at: [0.0; MOST_CORNERS], count: 0, slack: 0.0 };

    pub fn new(form: Form, polygon: &Polygon) -> Self {
        let unit = 1.0 / (1i64 << form.shift) as f64;
        let [a, b, c] = [f64::from(form.a), f64::from(form.b), form.c as f64].map(|factor| factor * unit);
        let at = polygon.corners.map(|[x, y]| a * x + b * y + c);
        let [x, y] = polygon.last;
        let terms = a.abs() * x + b.abs() * y + c.abs();
        // More than nothing: what is before something is not at it.
        let slack = (terms * ROUNDING + (a.abs() + b.abs()) * CORNER_ERROR).max(f64::MIN_POSITIVE);
        Self { form: Some(form), is_plain: true, at, count: polygon.count, slack }
    }

    /// Of a deep plane: as those of a plane which is as deep. `None` where that cannot be told.
    pub fn of_deep(deep: Form, polygon: &Polygon, forms: &Forms<'_>) -> Option<Self> {
        let own = Self::new(deep, polygon);
        if forms.slices.are_even() { Some(own) } else { own.as_plain(forms) }
    }

    /// Of a deep plane in lattice steps: as those of a plane. `None` before the first slice, which counts no half.
    fn as_plain(self, forms: &Forms<'_>) -> Option<Self> {
        let is_inside = self.at[..self.count].iter().all(|value| *value >= 0.0);
        let at = self.at.map(|value| forms.of_deep(value));
        is_inside.then_some(Self { at, is_plain: false, slack: self.slack + DEEP_STEPS, ..self })
    }

    /// Whether it lies before another one, or is the same.
    pub fn is_before(&self, other: &Self) -> bool {
        if self.form.is_some() && (self.form, self.is_plain) == (other.form, other.is_plain) {
            return true;
        }
        let slack = self.slack + other.slack;
        self.at.iter().zip(&other.at).take(self.count).all(|(a, b)| a + slack <= *b)
    }
}

/// What a surface's depth is made of: the greatest of one group of planes or two, each the least of its own.
#[derive(Clone, Copy)]
struct Shape {
    /// Forms, and whether they are deep ones.
    planes: [(Form, bool); 3],
    /// How many there are in the first group, and in all.
    first: usize,
    count: usize,
}

/// The same at a polygon's corners.
#[derive(Clone, Copy)]
struct Over {
    ends: [Ends; 3],
    first: usize,
    count: usize,
}

impl Over {
    const NONE: Self = Self { ends: [Ends::NONE; 3], first: 0, count: 0 };

    fn groups(&self) -> impl Iterator<Item = &[Ends]> {
        let (first, rest) = self.ends[..self.count].split_at(self.first);
        [first, rest].into_iter().filter(|group| !group.is_empty())
    }

    /// Whether it lies behind a plane.
    fn is_behind(&self, plane: &Ends) -> bool {
        self.groups().any(|group| group.iter().all(|form| plane.is_before(form)))
    }

    /// Whether it lies before a plane.
    fn is_before(&self, plane: &Ends) -> bool {
        self.groups().all(|group| group.iter().any(|form| form.is_before(plane)))
    }

    fn is_behind_other(&self, other: &Self) -> bool {
        other.groups().all(|group| group.iter().any(|plane| self.is_behind(plane)))
    }

    fn is_before_other(&self, other: &Self) -> bool {
        self.groups().all(|group| group.iter().any(|plane| other.is_behind(plane)))
    }
}

/// First and last texels of a tile, x fastest.
pub(crate) fn corners(tile: Tile) -> [[u32; 2]; 4] {
    let side = (1 << tile.log2) - 1;
    let [x, y] = [tile.x, tile.y];
    [[x, y], [x + side, y], [x, y + side], [x + side, y + side]]
}
