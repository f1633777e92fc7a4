//! From sketches to trees: depths are chosen, and planes and edges become forms.

use antumbra::format::silhouette::{Form, Kind, Pair, Turns, payload, reference};
use arrayvec::ArrayVec;
use rustc_hash::FxHashMap;

use super::accept::Forms;
use super::form::{Plane, Second};
use super::sketch::{Set, Sketch};
use crate::pause::Pause;

/// Depths that are chosen again if they will do.
const RECENT: usize = 64;

/// Inner tiles that are written between two rests.
const REST_TILES: u32 = 1 << 10;

/// A tile whose depths are chosen.
#[derive(Clone, Debug)]
pub(crate) enum Tree {
    /// Written in one go.
    Part(Part),
    /// Four tiles.
    Inner(Box<[Tree; 4]>),
}

/// A tile's nodes, which begin at word 0, and its forms, from number 0 on: both in the order of the pool's walk.
#[derive(Clone, Debug, Default)]
pub(crate) struct Part {
    pub forms: Vec<Form>,
    pub nodes: Vec<u32>,
    pub root: u32,
}

impl Tree {
    /// Chooses depths. The sketch is gone bit by bit.
    pub fn new(sketch: Sketch, forms: &Forms<'_>, pause: Pause<'_>) -> Self {
        pause();
        let recent = Vec::with_capacity(RECENT);
        let part = Part::default();
        let mut writer = Writer { part, numbers: FxHashMap::default(), forms, recent, tiles: 0, pause };
        let root = writer.tile(sketch);
        let Part { mut forms, mut nodes, .. } = writer.part;
        forms.shrink_to_fit();
        nodes.shrink_to_fit();
        Self::Part(Part { forms, nodes, root })
    }

    /// Calls with its parts, in order.
    pub fn for_each_part(&self, each: &mut impl FnMut(&Part)) {
        match self {
            Self::Part(part) => each(part),
            Self::Inner(children) => children.iter().for_each(|child| child.for_each_part(each)),
        }
    }

    /// Words of its nodes.
    pub fn words(&self) -> usize {
        match self {
            Self::Part(part) => part.nodes.len(),
            Self::Inner(children) => 4 + children.iter().map(Self::words).sum::<usize>(),
        }
    }

    /// Bytes that it takes.
    pub fn bytes(&self) -> u64 {
        match self {
            Self::Part(part) => (part.forms.len() * size_of::<Form>() + 4 * part.nodes.len()) as u64,
            Self::Inner(children) => size_of::<[Self; 4]>() as u64 + children.iter().map(Self::bytes).sum::<u64>(),
        }
    }

    pub fn is_lit(&self, slices: u32) -> bool {
        matches!(self, Self::Part(part) if part.root == slices)
    }
}

/// Writes a part, children before their parents.
struct Writer<'a> {
    part: Part,
    numbers: FxHashMap<Form, u32>,
    forms: &'a Forms<'a>,
    /// Depths that were chosen lately, latest first.
    recent: Vec<u32>,
    /// Inner tiles so far.
    tiles: u32,
    pause: Pause<'a>,
}

impl Writer<'_> {
    fn tile(&mut self, sketch: Sketch) -> u32 {
        match sketch {
            Sketch::Flat(set) => self.value(&set),
            Sketch::Cut(cut) => {
                let slices = self.forms.slices.resolution().texels();
                let mut words: ArrayVec<u32, 6> = cut.edges.iter().map(|e| self.form(self.forms.edge(*e))).collect();
                let kind = if words.len() == 1 { Kind::Cut } else { Kind::Cross };
                for region in &cut.regions[..1 << words.len()] {
                    // Any depth will do for a region without texels.
                    words.push(region.as_ref().map_or(reference(Kind::Depth, slices), |set| self.value(set)));
                }
                self.node(kind, &words)
            }
            Sketch::Masks(turns) => {
                let at = self.part.nodes.len() as u32;
                self.part.nodes.extend(Turns::to_words(turns.iter().map(|turn| (turn.high, turn.lit))));
                reference(Kind::Masks, at)
            }
            Sketch::Inner(children) => {
                self.tiles += 1;
                if self.tiles.is_multiple_of(REST_TILES) {
                    (self.pause)();
                }
                let children = children.map(|child| self.tile(child));
                self.node(Kind::Inner, &children)
            }
        }
    }

    fn node(&mut self, kind: Kind, words: &[u32]) -> u32 {
        let at = self.part.nodes.len() as u32;
        self.part.nodes.extend_from_slice(words);
        reference(kind, at)
    }

    fn value(&mut self, set: &Set) -> u32 {
        let slices = self.forms.slices.resolution().texels();
        if set.low <= set.high {
            return reference(Kind::Depth, self.depth(set.low, set.high.min(slices)));
        }
        let Some(surface) = set.surfaces().next() else { return reference(Kind::Depth, slices) };
        let (pair, second) = match surface.second() {
            Second::None => return self.plane(surface.first),
            Second::Back(back) => (Pair::Wedge, back),
            Second::Nearer(other) => (Pair::Nearer, other),
            Second::Farther(other) => (Pair::Farther, other),
        };
        let planes = [surface.first, second].map(|plane| (payload(self.plane(plane)) as u32, plane.is_deep()));
        self.node(Kind::Pair, &pair.to_words(planes))
    }

    /// A plane of a set, which has a form.
    fn plane(&mut self, plane: Plane) -> u32 {
        let slices = self.forms.slices.resolution().texels();
        let Some(form) = self.forms.plane(plane) else { return reference(Kind::Depth, slices) };
        reference(if plane.is_deep() { Kind::Deep } else { Kind::Plane }, self.form(form))
    }

    /// A depth between two: lit where it may be, or nearly so with a depth that was chosen lately, which takes fewer bytes on disk.
    fn depth(&mut self, low: u32, high: u32) -> u32 {
        let least = low + (high - low).div_ceil(2);
        let known = self.recent.iter().position(|depth| (least..=high).contains(depth));
        let depth = known.map_or(high, |at| self.recent.remove(at));
        self.recent.truncate(RECENT - 1);
        self.recent.insert(0, depth);
        depth
    }

    fn form(&mut self, form: Form) -> u32 {
        number(&mut self.part.forms, &mut self.numbers, form)
    }
}

/// A form's number, which it gets where it has none.
pub(crate) fn number(forms: &mut Vec<Form>, numbers: &mut FxHashMap<Form, u32>, form: Form) -> u32 {
    *numbers.entry(form).or_insert_with(|| {
        forms.push(form);
        forms.len() as u32 - 1
    })
}
