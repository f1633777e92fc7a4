//! Planes in gaps: of tiles in which one constant would do, since it lies behind some surfaces and before others.

use super::accept::Forms;
use super::form::{PlaneKey, Side};
use super::sketch::Set;
use crate::columns::{Entry, Tile};

/// Longer lists are not looked at.
const MOST_LOOKED_AT: usize = 64;
/// Fronts and backs that are tried.
const MOST_SIDES: usize = 6;
/// How far planes keep from surfaces, in slices: see [`Side::Before`].
const HALF: f64 = 0.5;
/// What deep planes add beside, in slices.
const WIDENING: f64 = 1.0 / 256.0;
/// What [`Side::Past`] adds, in slices.
const PAST: f64 = 1.0 / 4096.0;
/// More than depths in double precision err by, in slices.
const ERROR: f64 = 1.0 / 8192.0;

/// Adds planes that are right in a tile whose constants lie in a gap: behind all that lies before the gap, before all that lies
/// behind it. What is no longer in the list lies no nearer than `clamp`.
pub(crate) fn add_planes(forms: &Forms<'_>, set: &mut Set, tile: Tile, (entries, clamp): (&[Entry], u32)) {
    if !forms.slices.are_even() || entries.len() > MOST_LOOKED_AT {
        return;
    }
    let at = tile.corners(forms.slices.resolution());
    let Some(mut gap) = Gap::new(forms, entries, set, &at) else { return };
    if clamp < forms.slices.resolution().texels() {
        gap.behind.push([f64::from(clamp); 4]);
    }
    let [fronts, backs] = [&gap.fronts, &gap.backs].map(|side| &side[..side.len().min(MOST_SIDES)]);
    // Just behind a front that lies behind all others, or just before a back that lies before all others.
    let is_last = |front: &&GapSide| gap.before.iter().all(|(other, _)| is_behind(&front.at, other, PAST));
    let is_before = |front: &GapSide, by: f64, other: &Depths| is_behind(other, &front.at, -(1.0 + PAST + by));
    for front in fronts {
        let deep = front.rise + HALF + WIDENING;
        let is_deep = gap.before.iter().all(|(other, rise)| is_behind(&front.at, other, deep - rise));
        if is_deep && gap.behind.iter().all(|other| is_before(front, deep, other)) {
            set.push(PlaneKey::deep(front.triangle, Side::Past));
        }
    }
    for back in backs {
        let is_first = gap.behind.iter().all(|other| is_behind(other, &back.at, HALF));
        if is_first && gap.before.iter().all(|(other, rise)| is_behind(&back.at, other, -(HALF + 1.0 + rise))) {
            set.push(PlaneKey::new(back.triangle, Side::Before));
        }
    }
    for front in fronts.iter().filter(is_last) {
        let deep = front.rise + HALF + WIDENING;
        for back in backs {
            let fits = |other: &Depths| {
                is_before(front, deep, other) || (is_before(front, 0.0, other) && is_behind(other, &back.at, HALF))
            };
            if gap.behind.iter().all(fits) {
                set.push(PlaneKey::wedge(front.triangle, back.triangle));
            }
        }
    }
}

/// Depths at a tile's corners, in slices.
type Depths = [f64; 4];

/// Whether a plane, moved away by so many slices, lies behind another one.
fn is_behind(a: &Depths, b: &Depths, by: f64) -> bool {
    a.iter().zip(b).all(|(a, b)| a + by >= b + ERROR)
}

/// A triangle at a gap.
struct GapSide {
    triangle: u32,
    at: Depths,
    rise: f64,
}

/// What lies before a gap and behind it.
struct Gap {
    fronts: Vec<GapSide>,
    backs: Vec<GapSide>,
    /// Everything before, and how far behind its depth at a texel's centre it may begin a solid.
    before: Vec<(Depths, f64)>,
    behind: Vec<Depths>,
}

impl Gap {
    /// `None` where something cannot be told.
    fn new(forms: &Forms<'_>, entries: &[Entry], set: &Set, corners: &[[f64; 2]; 4]) -> Option<Self> {
        let mut gap = Self { fronts: Vec::new(), backs: Vec::new(), before: Vec::new(), behind: Vec::new() };
        let (units, texel) = (forms.slices.units_per_step(), forms.slices.resolution().texel_steps() as f64);
        for entry in entries {
            let t = &forms.triangles[entry.triangle as usize];
            if t.is_edge_on() {
                return None;
            }
            let at = corners.map(|p| t.depth(p, units));
            let side = |rise| GapSide { triangle: entry.triangle, at, rise };
            let rise = t.rise(texel, forms.slices);
            if entry.last < set.low {
                gap.before.push((at, if t.winding() == 1 { rise } else { 0.0 }));
                gap.fronts.extend((t.winding() == 1).then(|| side(rise)));
            } else if entry.first >= set.high {
                gap.behind.push(at);
                gap.backs.extend((t.winding() == -1).then(|| side(rise)));
            } else {
                return None;
            }
        }
        Some(gap)
    }
}
