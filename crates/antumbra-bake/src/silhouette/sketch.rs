//! Sketches: what is known of a tile before depths are chosen. A leaf's regions each have a set of depths, any of which is right
//! at all of the region's texels; four leaves become one while two edges are enough and each region's sets still meet.

use arrayvec::ArrayVec;

use super::accept::{Candidates, Polygon, corners};
use super::form::{EdgeKey, Surface};
use crate::columns::Tile;

/// Surfaces kept of a set.
const MOST_SURFACES: usize = 6;
/// Surfaces that are tried.
const MOST_TRIED: usize = 12;
/// Most parts of a region: four of each of four tiles.
const MOST_PARTS: usize = 16;

/// Depths (first shadowed slices, N for none) that are right for every texel of a region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Set {
    /// Constants from `low` to `high`; none if `high` is less.
    pub low: u32,
    pub high: u32,
    surfaces: [Surface; MOST_SURFACES],
}

/// A tile's regions by the sides of its edges: bit i of a region's number is set to the left of edge i.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Cut {
    pub edges: ArrayVec<EdgeKey, 2>,
    pub regions: [Option<Set>; 4],
}

/// A transition that any of the depths `low` to `high` suits, behind which the texels of `lit` are still lit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Turn {
    pub low: u32,
    pub high: u32,
    pub lit: u64,
}

/// A tile.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Sketch {
    /// One region.
    Flat(Set),
    /// Two to four.
    Cut(Box<Cut>),
    /// 8 x 8 texels that turn at several depths, nearest first.
    Masks(Vec<Turn>),
    /// Four tiles.
    Inner(Box<[Sketch; 4]>),
}

impl Set {
    pub fn constants(low: u32, high: u32) -> Self {
        Self { low, high, surfaces: [Surface::NONE; MOST_SURFACES] }
    }

    /// The constants from the first of two to the second, and the first of some surfaces.
    #[inline(always)]
    pub fn new([low, high]: [u32; 2], found: impl Iterator<Item = Surface>) -> Self {
        let mut set = Self::constants(low, high);
        set.surfaces.iter_mut().zip(found).for_each(|(place, surface)| *place = surface);
        set
    }

    /// Adds a surface while there is room.
    pub fn push(&mut self, surface: Surface) {
        if let Some(free) = self.surfaces.iter_mut().find(|s| **s == Surface::NONE) {
            *free = surface;
        }
    }

    pub fn surfaces(&self) -> impl Iterator<Item = Surface> + '_ {
        self.surfaces.iter().copied().take_while(|surface| *surface != Surface::NONE)
    }

    /// The depths that both have; `None` if there are none.
    pub fn common(&self, other: &Self) -> Option<Self> {
        let joint = self.surfaces().filter(|surface| other.surfaces().any(|own| own == *surface));
        let set = Self::new([self.low.max(other.low), self.high.min(other.high)], joint);
        (!set.is_empty()).then_some(set)
    }

    pub fn is_empty(&self) -> bool {
        self.low > self.high && self.surfaces[0] == Surface::NONE
    }
}

impl Sketch {
    fn edges(&self) -> Option<&[EdgeKey]> {
        match self {
            Self::Flat(_) => Some(&[]),
            Self::Cut(cut) => Some(&cut.edges),
            Self::Masks(_) | Self::Inner(_) => None,
        }
    }

    fn region(&self, number: usize) -> Option<&Set> {
        match self {
            Self::Flat(set) => (number == 0).then_some(set),
            Self::Cut(cut) => cut.regions[number].as_ref(),
            Self::Masks(_) | Self::Inner(_) => None,
        }
    }

    /// Bytes of an inner tile, but for those of inner tiles in it.
    pub fn own_bytes(&self) -> u64 {
        let Self::Inner(children) = self else { return 0 };
        let of = |child: &Self| match child {
            Self::Flat(_) | Self::Inner(_) => 0,
            Self::Cut(_) => size_of::<Cut>(),
            Self::Masks(turns) => turns.len() * size_of::<Turn>(),
        };
        (size_of::<[Self; 4]>() + children.iter().map(of).sum::<usize>()) as u64
    }

    /// A tile of four.
    pub fn of(children: [Self; 4], parent: Tile, candidates: &mut Candidates<'_>) -> Self {
        match merged(&children, parent, candidates) {
            Some(sketch) => sketch,
            None => Self::Inner(Box::new(children)),
        }
    }
}

fn merged(children: &[Sketch; 4], parent: Tile, candidates: &mut Candidates<'_>) -> Option<Sketch> {
    let forms = candidates.forms;
    // Two, and one too many.
    let mut found = [EdgeKey::default(); 3];
    let mut count = 0;
    for child in children {
        for edge in child.edges()? {
            if !found[..count].contains(edge) {
                found[count] = *edge;
                count += 1;
                if count > 2 {
                    return None;
                }
            }
        }
    }
    let edges = &mut found[..count];
    edges.sort_unstable();
    // Which sides of the parent's edges each tile lies on: bit 0 to the right, bit 1 to the left.
    let mut sides = [[0; 2]; 4];
    let edge_forms = [0, 1].map(|bit| edges.get(bit).map(|edge| forms.edge(*edge)).unwrap_or_default());
    for (bit, form) in edge_forms.iter().enumerate().take(count) {
        for (i, sides) in (0..).zip(&mut sides) {
            let at = corners(parent.child(i)).map(|texel| form.at(texel) >= 0);
            sides[bit] = u32::from(at.contains(&false)) | (u32::from(at.contains(&true)) << 1);
        }
    }
    let mut regions = [None; 4];
    for (number, region) in regions.iter_mut().enumerate().take(1 << count) {
        let mut parts: ArrayVec<(Polygon, &Set), MOST_PARTS> = ArrayVec::new();
        for (i, child) in (0..).zip(children) {
            let own = child.edges()?;
            for part in 0..1 << own.len() {
                let is_part = edges.iter().enumerate().all(|(bit, edge)| {
                    let side = number >> bit & 1;
                    match own.iter().position(|e| e == edge) {
                        Some(at) => part >> at & 1 == side,
                        None => sides[i as usize][bit] >> side & 1 != 0,
                    }
                });
                let polygon = || {
                    let sides = (0..count).map(|bit| (edge_forms[bit], number >> bit & 1 != 0));
                    Polygon::of_part(parent.child(i), sides)
                };
                parts.extend(child.region(part).filter(|_| is_part).map(|set| (polygon(), set)));
            }
        }
        if !parts.is_empty() {
            *region = Some(met(&parts, candidates)?);
        }
    }
    let edges: ArrayVec<EdgeKey, 2> = edges.iter().copied().collect();
    Some(if edges.is_empty() { Sketch::Flat(regions[0]?) } else { Sketch::Cut(Box::new(Cut { edges, regions })) })
}

/// The depths that all of some regions' sets have, if there are any.
#[inline(never)]
fn met(parts: &[(Polygon, &Set)], candidates: &mut Candidates<'_>) -> Option<Set> {
    let low = parts.iter().map(|(_, set)| set.low).max()?;
    let high = parts.iter().map(|(_, set)| set.high).min()?;
    candidates.gather(parts.iter().map(|(_, set)| *set));
    let mut right = (1u32 << candidates.len().min(MOST_TRIED)) - 1;
    for part in parts {
        candidates.forget();
        for number in numbers_of(right) {
            right &= !(u32::from(!candidates.accepts(number, part)) << number);
        }
        if right == 0 {
            break;
        }
    }
    (low <= high || right != 0)
        .then(|| Set::new([low, high], numbers_of(right).map(|number| candidates.surface(number))))
}

/// Numbers of the bits that are set.
fn numbers_of(bits: u32) -> impl Iterator<Item = usize> {
    (0..u32::BITS as usize).filter(move |number| bits >> number & 1 != 0)
}
