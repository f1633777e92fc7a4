//! Planes in gaps: of tiles in which one constant would do, since it lies behind some surfaces and before others.

use antumbra::format::silhouette::Form;

use super::accept::{Forms, ROUNDING, corners};
use super::form::{Plane, Side, Surface};
use super::sketch::Set;
use crate::columns::{BuildTriangle, Entry, Tile};
use crate::light_space::Slices;

/// Longer lists are not looked at.
const MOST_LOOKED_AT: usize = 64;
/// Fronts and backs that are tried.
const MOST_SIDES: usize = 6;
/// More than depths in double precision err by, but for steep planes: in slices, and in lattice steps, in whole ones of which a local light's slices begin.
const ERROR: [f64; 2] = [1.0 / 8192.0, 3.0];

/// Adds planes that are right in a tile whose constants lie in a gap: behind all that lies before the gap, before all that lies
/// behind it. What is no longer in the list lies no nearer than `clamp`.
pub(crate) fn add_planes(
    forms: &Forms<'_>,
    gap: &mut Gap,
    set: &mut Set,
    tile: Tile,
    (entries, clamp): (&[Entry], u32),
) {
    if entries.len() > MOST_LOOKED_AT || gap.read(forms, entries, set, tile).is_none() {
        return;
    }
    if clamp < forms.slices.resolution().texels() {
        gap.behind.push([forms.first_value(clamp + 1) - gap.error; 4]);
    }
    // Just behind a front, or deep behind it, and before all that lies behind the gap.
    for front in &gap.fronts {
        let is_deep = front.deep.is_some_and(|deep| gap.is_after(&deep, true) && gap.is_first(&deep));
        if is_deep {
            set.push(Surface::plane(Plane::new(front.triangle, Side::Past).deep()));
        }
    }
    for (back, before) in &gap.backs {
        if gap.is_first(before) && gap.is_after(before, true) {
            set.push(Surface::plane(Plane::new(*back, Side::Before)));
        }
    }
    for front in gap.fronts.iter().filter(|front| gap.is_after(&front.past, false)) {
        let Some(deep) = front.deep else { continue };
        for (back, before) in &gap.backs {
            let is_before = |depths: &Depths, other: &Depths| is_behind(other, depths, gap.error);
            let fits = |other| is_before(&deep, other) || (is_before(&front.past, other) && is_before(before, other));
            if gap.behind.iter().all(fits) {
                set.push(Surface::wedge(front.triangle, *back));
            }
        }
    }
}

/// By how much a triangle's depths at some points may be off, in units.
pub(super) fn depth_error<const N: usize>(t: &BuildTriangle, points: &[[f64; 2]; N], slices: &Slices) -> f64 {
    let [sx, sy] = t.slope.map(f64::abs);
    let terms = |[x, y]: &[f64; 2]| (x - f64::from(t.x[0])).abs() * sx + (y - f64::from(t.y[0])).abs() * sy;
    ERROR[usize::from(!slices.are_even())] + points.iter().map(terms).fold(0.0, f64::max) * (4.0 * ROUNDING)
}

/// Values of planes at a tile's corners, in units.
type Depths = [f64; 4];

/// Whether a plane lies behind another one.
fn is_behind(a: &Depths, b: &Depths, error: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| *a >= b + error)
}

/// A triangle before a gap, where rays enter a solid: the plane past it, and its deep one as a plane that is as deep.
struct Front {
    triangle: u32,
    past: Depths,
    deep: Option<Depths>,
}

/// What lies before a gap and behind it. Kept from tile to tile, for its lists.
#[derive(Default)]
pub(crate) struct Gap {
    fronts: Vec<Front>,
    /// Triangles where rays leave, and the planes before them.
    backs: Vec<(u32, Depths)>,
    /// What a plane has to lie behind: just behind everything before, at texels' centres and wherever in texels it may begin a solid.
    before: Vec<[Depths; 2]>,
    /// What a plane has to lie before.
    behind: Vec<Depths>,
    error: f64,
}

impl Gap {
    /// Takes a tile's triangles. `None` where something cannot be told.
    fn read(&mut self, forms: &Forms<'_>, entries: &[Entry], set: &Set, tile: Tile) -> Option<()> {
        let slices = forms.slices;
        let (units, texel) = (slices.units_per_step(), slices.resolution().texel_steps() as f64);
        self.fronts.clear();
        self.backs.clear();
        self.before.clear();
        self.behind.clear();
        self.error = ERROR[usize::from(!slices.are_even())];
        let at_corners = tile.corners(slices.resolution());
        let [next, own] = [true, false].map(|is_next| slices.value_of(is_next));
        for entry in entries {
            let t = &forms.triangles[entry.triangle as usize];
            self.error = self.error.max(depth_error(t, &at_corners, slices));
            if t.is_edge_on() || entry.triangle > Plane::MOST_TRIANGLES {
                return None;
            }
            let at = at_corners.map(|p| t.depth(p, units));
            let values = |form: Form| {
                let one = (1i64 << form.shift) as f64;
                corners(tile).map(|texel| form.at(texel) as f64 / one)
            };
            if entry.last < set.low {
                let rise = if t.winding() == 1 { t.rise(texel, slices) } else { 0.0 };
                self.before.push([at.map(|d| next.of(d)), at.map(|d| next.of(d + rise))]);
                let is_wanted = t.winding() == 1 && self.fronts.len() < MOST_SIDES;
                let past = Plane::new(entry.triangle, Side::Past);
                if is_wanted && let Some(form) = forms.plane(past) {
                    let deep = values(forms.deep(form));
                    let is_inside = slices.are_even() || deep.iter().all(|value| *value >= 0.0);
                    let deep = is_inside.then(|| deep.map(|value| forms.of_deep(value)));
                    self.fronts.push(Front { triangle: entry.triangle, past: values(form), deep });
                }
            } else if entry.first >= set.high {
                self.behind.push(at.map(|d| own.of(d)));
                let is_wanted = t.winding() == -1 && self.backs.len() < MOST_SIDES;
                let before = Plane::new(entry.triangle, Side::Before);
                if is_wanted && let Some(form) = forms.plane(before) {
                    self.backs.push((entry.triangle, values(form)));
                }
            } else {
                return None;
            }
        }
        Some(())
    }

    /// Whether a plane lies behind everything before the gap: behind what begins solids anywhere in texels, or at their centres.
    fn is_after(&self, plane: &Depths, anywhere: bool) -> bool {
        self.before.iter().all(|before| is_behind(plane, &before[usize::from(anywhere)], self.error))
    }

    /// Whether a plane lies before everything behind the gap.
    fn is_first(&self, plane: &Depths) -> bool {
        self.behind.iter().all(|behind| is_behind(behind, plane, self.error))
    }
}
