//! The node encoding `silhouette`: a quadtree over the shadow map whose leaves are cut by the casters' own edges and bounded by
//! their own planes, so that a file hardly grows with resolution. Ours; relatives are the shadow silhouette maps of Sen,
//! Cammarano, Hanrahan 2003 (edges), the sparse shadow trees of Myers 2016 (planes) and the multiresolution hierarchies of
//! Scandolo, Bauszat, Eisemann 2016.
//!
//! The pool is an array of 32-bit words:
//!
//! ```text
//! word   contents
//! 0      F: number of forms
//! 1..8   zero
//! 8      forms, four words each
//! 8+4F   nodes
//! ```
//!
//! A **form** is a linear function over texels, v(x, y) = a x + b y + c, in whole numbers:
//!
//! ```text
//! word 0  a, signed
//!      1  b, signed
//!      2  c, low word
//!      3  bits 23..0: c, high word, signed; bits 31..24: shift, 0 to 31, of local lights to 22
//! ```
//!
//! It is an *edge* (a texel lies to its left where v is not negative) or a *plane*. A directional light's planes count in slices: their depth is
//! v >> shift, rounded down and clamped to 0..N. A local light's count in steps of the lattice, where slices begin as
//! [`super::slices`] says: their depth is the number of slices that begin at v >> shift or before.
//!
//! A **reference** says in its upper three bits what it is, and in the others where:
//!
//! ```text
//! 0 depth   the depth itself, 0 to N (N: lit throughout)
//! 1 plane   a form's number
//! 2 pair    a node of two words, two planes: bits 27..0 are a form's number, bit 28 is set for its deep one. Bits 31..29 of the first word
//!           say what they are to each other ([`Pair`]); of the second they are zero
//! 3 inner   a node of four words, references to four tiles of half the side, x fastest
//! 4 cut     a node of three words: an edge's number, and references for the texels to its right and its left
//! 5 cross   a node of six words: two edges' numbers, and four references; bit i of their order is set to the left of edge i
//! 6 masks   a node for 1 to 64 depths that rise: a word, p masks of 8 x 8 texels (low word first; bit 8 y + x), where p bits can tell 0 to the number of
//!           depths, and by how much each depth but the first lies behind the first. Of the word bits 19..0 are the first depth, bits 26..20 their
//!           number, and bits 28..27 say how many bits each difference takes: 0, 1, 2 for 8, 16, 32, no more than the last one needs; the first
//!           one is in the lowest bits, unused ones are zero. Bit i of a texel's *turn* is its bit in mask i: which of the depths, from 0, is its own, or
//!           their number: it is lit throughout. Each depth is some texel's. Tiles of 8 x 8 texels alone ([`Turns`])
//! 7 deep    a form's number: the plane half a slice behind its deepest point within each texel. With v + e instead of v, where
//!           e = (|a| + |b|) / 2 rounded down + 2^shift / 2 rounded down + 2^shift / 256 rounded down; of a local light
//!           e = (|a| + |b|) / 2 rounded down + 2^shift, and each slice but the first counts from the middle of the one before on
//! ```
//!
//! The references of cuts and crosses are depths, planes, deep planes or pairs. Voxel (x, y, z) is lit iff z is less than the depth at its texel.
//!
//! Nodes lie in the order of a walk through each root's tree, lights in the file's order, children before their parents, each once;
//! forms in the order in which that walk meets them first. So equal scenes give equal bytes, and there are no cycles.

use crate::FormatError;

use super::dag8::NodeCounts;

/// Words before the forms.
pub const HEADER_WORDS: usize = 8;
/// Words of a form.
pub const FORM_WORDS: usize = 4;
/// log2 of the side of tiles with masks.
pub const MASK_LEVEL: u32 = 3;
/// Most bits of a form's shift; of local lights, whose values have 32 bits before the binary point.
pub const MOST_SHIFT: u32 = 31;
/// See [`MOST_SHIFT`].
pub const MOST_LOCAL_SHIFT: u32 = 22;

/// What a reference is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A constant depth.
    Depth,
    /// A plane.
    Plane,
    /// Two planes.
    Pair,
    /// Four tiles.
    Inner,
    /// Two regions.
    Cut,
    /// Four regions.
    Cross,
    /// Depths by masks.
    Masks,
    /// A plane behind its deepest points in texels.
    Deep,
}

/// What two planes are to each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pair {
    /// Front and back of a solid's edge, none of them deep: the depth is the front's deep one, but where the back's is less that, and no
    /// less than the front's.
    Wedge,
    /// The nearer one's depth.
    Nearer,
    /// The farther one's depth.
    Farther,
}

impl Pair {
    /// As a pair's first word has it.
    #[inline(always)]
    #[must_use]
    pub fn of(first: u32) -> Self {
        match first >> PAYLOAD_BITS {
            0 => Self::Wedge,
            1 => Self::Nearer,
            _ => Self::Farther,
        }
    }

    /// A pair's words, given its planes' numbers and which ones are deep.
    #[must_use]
    pub fn to_words(self, planes: [(u32, bool); 2]) -> [u32; 2] {
        let [first, second] = planes.map(|(number, is_deep)| number | (u32::from(is_deep) << DEEP_BIT));
        [first | ((self as u32) << PAYLOAD_BITS), second]
    }
}

/// A form's number in a pair's word, and whether its deep one is meant.
#[inline(always)]
#[must_use]
pub fn plane_of_pair(word: u32) -> (usize, bool) {
    ((word & ((1 << DEEP_BIT) - 1)) as usize, word >> DEEP_BIT & 1 != 0)
}

const PAYLOAD_BITS: u32 = 29;
const DEEP_BIT: u32 = 28;

/// Greatest payload of a reference.
pub const MOST_PAYLOAD: u32 = (1 << PAYLOAD_BITS) - 1;

/// A reference of a kind.
#[inline]
#[must_use]
pub fn reference(kind: Kind, payload: u32) -> u32 {
    ((kind as u32) << PAYLOAD_BITS) | payload
}

/// What a reference is.
#[inline(always)]
#[must_use]
pub fn kind(reference: u32) -> Kind {
    match reference >> PAYLOAD_BITS {
        0 => Kind::Depth,
        1 => Kind::Plane,
        2 => Kind::Pair,
        3 => Kind::Inner,
        4 => Kind::Cut,
        5 => Kind::Cross,
        6 => Kind::Masks,
        _ => Kind::Deep,
    }
}

/// A reference's depth, form or word.
#[inline(always)]
#[must_use]
pub fn payload(reference: u32) -> usize {
    (reference & MOST_PAYLOAD) as usize
}

/// A linear function over texels: a x + b y + c.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Form {
    /// Per texel along x.
    pub a: i32,
    /// Per texel along y.
    pub b: i32,
    /// At texel (0, 0): less than 2^55 either way.
    pub c: i64,
    /// Bits behind the binary point of a plane's depths.
    pub shift: u32,
}

impl Form {
    /// Reads a form of a pool by its number.
    #[inline(always)]
    #[must_use]
    pub fn read(pool: &[u32], number: usize) -> Self {
        let at = HEADER_WORDS + FORM_WORDS * number;
        let words = &pool[at..at + FORM_WORDS];
        // Bits 23..0 of the last word, with their sign.
        let high = ((words[3] << 8) as i32) >> 8;
        let c = (i64::from(high) << 32) | i64::from(words[2]);
        Self { a: words[0] as i32, b: words[1] as i32, c, shift: words[3] >> 24 & MOST_SHIFT }
    }

    /// Its words.
    #[must_use]
    pub fn to_words(self) -> [u32; FORM_WORDS] {
        let high = (self.c >> 32) as u32 & 0x00ff_ffff;
        [self.a as u32, self.b as u32, self.c as u32, high | (self.shift << 24)]
    }

    /// The value at a texel.
    #[inline(always)]
    #[must_use]
    pub fn at(&self, [x, y]: [u32; 2]) -> i64 {
        i64::from(self.a) * i64::from(x) + i64::from(self.b) * i64::from(y) + self.c
    }
}

/// A tile of masks: at which depths its texels turn dark.
#[derive(Clone, Copy)]
pub struct Turns<'a> {
    /// Its first word.
    head: u32,
    /// Bits of the texels' turns, two words each.
    planes: &'a [[u32; 2]],
    /// By how much depths lie behind the first.
    steps: &'a [u32],
}

/// Bits of a first depth, and of a number of depths.
const DEPTH_BITS: u32 = 20;
const COUNT_BITS: u32 = 7;

impl<'a> Turns<'a> {
    /// Reads the node at a word of a pool.
    #[inline(always)]
    #[must_use]
    pub fn read(pool: &'a [u32], at: usize) -> Self {
        let head = pool[at];
        let (planes, rest) = pool[at + 1..].split_at(2 * Self::planes_for(Self::count_of(head)));
        Self { head, planes: planes.as_chunks().0, steps: &rest[..Self::step_words(head)] }
    }

    /// The words of a node of 1 to 64 depths that rise, each with the texels that are lit behind it.
    pub fn to_words(turns: impl ExactSizeIterator<Item = (u32, u64)>) -> impl Iterator<Item = u32> {
        let count = turns.len();
        let mut depths = [0; Self::MOST_DEPTHS];
        let mut planes = [0u64; Self::MOST_PLANES];
        for (place, (depth, lit)) in depths.iter_mut().zip(turns) {
            *place = depth;
            // A texel turns as late as it is lit behind depths: count them, all texels at once.
            let mut carry = lit;
            for plane in &mut planes {
                (*plane, carry) = (*plane ^ carry, *plane & carry);
            }
        }
        let mut words = [0; Self::MOST_WORDS];
        let (masks, all) = Self::lay_out(&mut words, &depths[..count]);
        for (words, plane) in masks.as_chunks_mut().0.iter_mut().zip(planes) {
            *words = [plane as u32, (plane >> 32) as u32];
        }
        words.into_iter().take(all)
    }

    /// Writes the words of a node of 1 to 64 depths, but for its masks, which are left to the caller; how many words there are, too. Depths from
    /// 2^20 on, and those that do not rise, give some node that is not valid, or another one.
    pub(super) fn lay_out<'w>(words: &'w mut [u32; Turns::MOST_WORDS], depths: &[u32]) -> (&'w mut [u32], usize) {
        let [first, last] = [depths[0], depths[depths.len() - 1]];
        let width = match last.wrapping_sub(first) {
            0..0x100 => 0,
            0x100..0x1_0000 => 1,
            _ => 2,
        };
        let first_bits = first & ((1 << DEPTH_BITS) - 1);
        let head = first_bits | ((depths.len() as u32) << DEPTH_BITS) | (width << (DEPTH_BITS + COUNT_BITS));
        words[0] = head;
        let (masks, rest) = words[1..].split_at_mut(2 * Self::planes_for(depths.len()));
        let most = u32::MAX >> (32 - (8 << width));
        for (i, depth) in depths[1..].iter().enumerate() {
            let bit = i << (3 + width);
            rest[bit >> 5] |= (depth.wrapping_sub(first) & most) << (bit & 31);
        }
        (masks, Self::words_of(head))
    }

    /// How many depths there are.
    #[inline(always)]
    fn count_of(head: u32) -> usize {
        (head >> DEPTH_BITS & ((1 << COUNT_BITS) - 1)) as usize
    }

    /// log2 of the bits of a difference, less 3.
    #[inline(always)]
    fn width_of(head: u32) -> u32 {
        head >> (DEPTH_BITS + COUNT_BITS)
    }

    /// Bits that can tell 0 to `count`.
    #[inline(always)]
    fn planes_for(count: usize) -> usize {
        (usize::BITS - count.leading_zeros()) as usize
    }

    /// Words of the differences.
    #[inline(always)]
    fn step_words(head: u32) -> usize {
        ((Self::count_of(head) - 1) << Self::width_of(head)).div_ceil(4)
    }

    /// Words of a node that begins with this one.
    fn words_of(head: u32) -> usize {
        1 + 2 * Self::planes_for(Self::count_of(head)) + Self::step_words(head)
    }

    /// The words of the node at a word of a pool, if it begins as one may.
    fn checked_words(head: u32) -> Option<usize> {
        let is_one = (1..=Self::MOST_DEPTHS).contains(&Self::count_of(head)) && Self::width_of(head) <= 2;
        is_one.then(|| Self::words_of(head))
    }

    /// Depths of a node at most.
    pub(super) const MOST_DEPTHS: usize = 64;
    const MOST_PLANES: usize = 7;
    /// Words of a node at most.
    pub(super) const MOST_WORDS: usize = 1 + 2 * Self::MOST_PLANES + Self::MOST_DEPTHS;
    /// The greatest first depth that there can be.
    pub(super) const MOST_FIRST: u32 = (1 << DEPTH_BITS) - 1;

    /// How many depths there are.
    #[inline(always)]
    #[must_use]
    pub fn count(self) -> usize {
        Self::count_of(self.head)
    }

    /// The depth of a turn below their number.
    #[inline(always)]
    #[must_use]
    pub fn depth_of(self, turn: usize) -> u32 {
        let first = self.head & ((1 << DEPTH_BITS) - 1);
        let Some(place) = turn.checked_sub(1) else { return first };
        let width = Self::width_of(self.head);
        let bit = place << (3 + width);
        first.wrapping_add(self.steps[bit >> 5] >> (bit & 31) & (u32::MAX >> (32 - (8 << width))))
    }

    /// The depths.
    #[inline(always)]
    pub fn depths(self) -> impl Iterator<Item = u32> + 'a {
        (0..self.count()).map(move |turn| self.depth_of(turn))
    }

    /// The masks, two words each.
    #[must_use]
    pub fn masks(self) -> &'a [[u32; 2]] {
        self.planes
    }

    /// The depth at a texel, whose low bits count; `None` where it is lit throughout.
    #[inline(always)]
    #[must_use]
    pub fn depth(self, [x, y]: [u32; 2]) -> Option<u32> {
        let (word, bit) = ((y >> 2 & 1) as usize, 8 * (y & 3) + (x & 7));
        let turn = self.planes.iter().rev().fold(0, |turn, plane| (turn << 1) | (plane[word] >> bit & 1)) as usize;
        (turn < self.count()).then(|| self.depth_of(turn))
    }

    /// The texels that are lit in a slice: bit 8 y + x.
    #[inline(always)]
    #[must_use]
    pub fn lit(self, slice: u32) -> u64 {
        self.not_before(self.reached(slice))
    }

    /// How many depths lie at a slice or before.
    #[inline(always)]
    fn reached(self, slice: u32) -> u32 {
        let Some(behind) = slice.checked_sub(self.depth_of(0)) else { return 0 };
        match Self::width_of(self.head) {
            0 => self.reached_steps::<8>(behind),
            1 => self.reached_steps::<16>(behind),
            _ => self.reached_steps::<32>(behind),
        }
    }

    /// The same with differences of so many bits: the first depth, and differences that are no greater.
    #[inline(always)]
    fn reached_steps<const BITS: u32>(self, behind: u32) -> u32 {
        let (most, in_word) = (u32::MAX >> (32 - BITS), 32 / BITS);
        let of_word = |word: &u32| (0..in_word).map(|i| u32::from(word >> (i * BITS) & most <= behind)).sum::<u32>();
        let unused = in_word * self.steps.len() as u32 + 1 - self.count() as u32;
        // Unused bits are zero, which is no greater.
        1 + self.steps.iter().map(of_word).sum::<u32>() - unused
    }

    /// The texels whose turn is one or a later one.
    #[inline(always)]
    fn not_before(self, turn: u32) -> u64 {
        if turn >> self.planes.len() != 0 {
            return 0;
        }
        // From the highest bit on: those that were less, and those that were the same.
        let (mut before, mut same) = (0, u64::MAX);
        for (i, plane) in self.planes.iter().enumerate().rev() {
            let plane = u64::from(plane[0]) | (u64::from(plane[1]) << 32);
            let bit = u64::from(turn >> i & 1).wrapping_neg();
            before |= same & bit & !plane;
            same &= !(bit ^ plane);
        }
        !before
    }

    /// Whether depths rise, to less than a count of slices, in no more bits than they need, and each is some texel's, and no turn is greater than
    /// there are.
    fn is_valid(self, slices: u32) -> bool {
        let last = self.depth_of(self.count() - 1);
        let rise = self.depths().is_sorted() && last < slices;
        let mut again = [0; Self::MOST_WORDS];
        let mut depths = [0; Self::MOST_DEPTHS];
        depths.iter_mut().zip(self.depths()).for_each(|(place, depth)| *place = depth);
        let (masks, all) = Self::lay_out(&mut again, &depths[..self.count()]);
        let steps = 1 + masks.len();
        let is_short = again[0] == self.head && again[steps..all] == *self.steps;
        let of = |turn: usize| self.not_before(turn as u32);
        rise && is_short && (0..self.count()).all(|i| of(i) != of(i + 1)) && of(self.count() + 1) == 0
    }
}

/// A pool that is being checked: the roots' trees must follow one another in it.
pub struct Check<'a> {
    pool: &'a [u32],
    forms: usize,
    /// Forms that were met so far: they are numbered in that order.
    met: usize,
    /// Where nodes begin, and where the next one must.
    begin: usize,
    next: usize,
    counts: NodeCounts,
    /// Of the light whose tree is checked: log2 of its slices, and most bits of its forms' shifts.
    log2: u32,
    most_shift: u32,
}

impl<'a> Check<'a> {
    /// Reads the pool's header and its forms.
    ///
    /// # Errors
    /// [`FormatError::Malformed`] if they do not fit.
    pub fn new(pool: &'a [u32]) -> Result<Self, FormatError> {
        let &[forms, 0, 0, 0, 0, 0, 0, 0] = pool.get(..HEADER_WORDS).unwrap_or_default() else {
            return Err(FormatError::Malformed("the silhouette pool's header is cut off or has stray words"));
        };
        let next = HEADER_WORDS as u64 + u64::from(forms) * FORM_WORDS as u64;
        if next > pool.len() as u64 || forms >> DEEP_BIT != 0 {
            return Err(FormatError::Malformed("the silhouette pool's forms do not fit in it"));
        }
        if pool[HEADER_WORDS..next as usize].chunks_exact(FORM_WORDS).any(|form| form[3] >> 24 > MOST_SHIFT) {
            return Err(FormatError::Malformed("a form has stray bits"));
        }
        let (forms, begin) = (forms as usize, next as usize);
        Ok(Self { pool, forms, met: 0, begin, next: begin, counts: NodeCounts::default(), log2: 0, most_shift: 0 })
    }

    /// Checks the tree of a root of a light with 2^`log2` texels per side and as many slices.
    ///
    /// # Errors
    /// [`FormatError::Malformed`] with what is wrong.
    pub fn tree(&mut self, root: u32, log2: u32, is_local: bool) -> Result<(), FormatError> {
        self.log2 = log2;
        self.most_shift = if is_local { MOST_LOCAL_SHIFT } else { MOST_SHIFT };
        self.tile(root, log2)
    }

    fn tile(&mut self, root: u32, level: u32) -> Result<(), FormatError> {
        let at = payload(root);
        match kind(root) {
            Kind::Inner if level > MASK_LEVEL => {
                for child in self.node_words(at, 4)? {
                    self.tile(*child, level - 1)?;
                }
                self.counts.inner += 1;
                self.node(at, 4)
            }
            Kind::Cut | Kind::Cross => {
                let edges = if kind(root) == Kind::Cut { 1 } else { 2 };
                let words = self.node_words(at, edges + (1 << edges))?;
                let (edges, regions) = words.split_at(edges);
                edges.iter().try_for_each(|edge| self.form(*edge))?;
                regions.iter().try_for_each(|region| self.value(*region))?;
                self.counts.cuts += 1;
                self.node(at, words.len())
            }
            Kind::Masks if level == MASK_LEVEL => {
                let head = self.node_words(at, 1)?[0];
                let words = Turns::checked_words(head);
                let words = words.ok_or(FormatError::Malformed("a tile has an impossible number of masks"))?;
                let words = self.node_words(at, words)?;
                if !Turns::read(words, 0).is_valid(1 << self.log2) {
                    return Err(FormatError::Malformed("a tile's masks are out of order"));
                }
                self.counts.masks += Turns::count_of(head) as u64;
                self.node(at, words.len())
            }
            _ => self.value(root),
        }
    }

    /// That every word belongs to some root's tree.
    ///
    /// # Errors
    /// [`FormatError::Malformed`] if some are left over.
    pub fn finish(self) -> Result<NodeCounts, FormatError> {
        if self.next == self.pool.len() && self.met == self.forms {
            Ok(self.counts)
        } else {
            Err(FormatError::Malformed("the silhouette pool has nodes or forms that no light reaches"))
        }
    }

    /// Words of the nodes and forms so far.
    #[must_use]
    pub fn words(&self) -> usize {
        self.next - self.begin + FORM_WORDS * self.met
    }

    /// Nodes so far.
    #[must_use]
    pub fn counts(&self) -> NodeCounts {
        self.counts
    }

    fn node_words(&self, at: usize, count: usize) -> Result<&'a [u32], FormatError> {
        // Children stand before their parents.
        let words = if at < self.next { None } else { self.pool.get(at..at + count) };
        words.ok_or(FormatError::Malformed("a node is cut off or out of order"))
    }

    fn node(&mut self, at: usize, words: usize) -> Result<(), FormatError> {
        if at != self.next {
            return Err(FormatError::Malformed("a node is out of order"));
        }
        self.next += words;
        Ok(())
    }

    fn form(&mut self, number: u32) -> Result<(), FormatError> {
        let number = number as usize;
        if number >= self.forms || number > self.met {
            return Err(FormatError::Malformed("a node refers to no form, or to one out of order"));
        }
        if Form::read(self.pool, number).shift > self.most_shift {
            return Err(FormatError::Malformed("a form has an impossible shift"));
        }
        self.met = self.met.max(number + 1);
        Ok(())
    }

    fn value(&mut self, value: u32) -> Result<(), FormatError> {
        let at = payload(value);
        match kind(value) {
            Kind::Depth if at <= 1 << self.log2 => Ok(()),
            Kind::Plane | Kind::Deep => self.form(at as u32),
            Kind::Pair => {
                let words = self.node_words(at, 2)?;
                let planes = [words[0], words[1]].map(plane_of_pair);
                let is_deep_wedge = Pair::of(words[0]) == Pair::Wedge && (planes[0].1 || planes[1].1);
                if words[0] >> PAYLOAD_BITS > Pair::Farther as u32 || words[1] >> PAYLOAD_BITS != 0 || is_deep_wedge {
                    return Err(FormatError::Malformed("a pair of planes is none that there is"));
                }
                planes.iter().try_for_each(|(number, _)| self.form(*number as u32))?;
                self.node(at, 2)
            }
            _ => Err(FormatError::Malformed("a tile refers to something that is no depth")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of one depth to 64: what the bits of turns say is what a mask for each depth says, and nodes that are not quite so are refused.
    #[test]
    fn turns_are_masks_of_lit_texels() {
        const SLICES: u32 = 1 << 20;
        let mut state = 0x9e37_79b9_7f4a_7c15u64;
        let mut random = |below: u64| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) % below
        };
        for (round, count) in (1..=64usize).cycle().take(640).enumerate() {
            // Differences of 8, 16 and 32 bits.
            let step = [1, 7, 16_000][round % 3];
            // Each texel's turn, of which each but the last is some texel's.
            let turn_of: Vec<usize> =
                (0..64).map(|i| if i < count { i } else { random(count as u64 + 1) as usize }).collect();
            let masks: Vec<(u32, u64)> = (0..count)
                .map(|turn| {
                    let lit = (0..64).filter(|i| turn_of[*i] > turn).fold(0, |lit, i| lit | 1u64 << i);
                    (step * turn as u32 + 3, lit)
                })
                .collect();
            let mut words: Vec<u32> = Turns::to_words(masks.iter().copied()).collect();
            let last = step * (count as u32 - 1) + 3;
            let bits = if last - 3 < 256 {
                8
            } else if last - 3 < 65_536 {
                16
            } else {
                32
            };
            assert_eq!(Some(words.len()), Turns::checked_words(words[0]));
            assert_eq!(words.len(), 1 + 2 * (count.ilog2() as usize + 1) + ((count - 1) * bits).div_ceil(32));
            let turns = Turns::read(&words, 0);
            assert!(turns.depths().eq(masks.iter().map(|(depth, _)| *depth)));
            assert!(turns.is_valid(SLICES) && !turns.is_valid(last));
            let about = |turn: u32| [step * turn + 2, step * turn + 3];
            for slice in (0..count as u32).flat_map(about).chain([0, SLICES - 1]) {
                let lit =
                    masks.iter().take_while(|(depth, _)| *depth <= slice).last().map_or(u64::MAX, |(_, lit)| *lit);
                assert_eq!(turns.lit(slice), lit, "{count} depths, slice {slice}");
            }
            for (i, turn) in (0..).zip(&turn_of) {
                assert_eq!(turns.depth([i & 7, i >> 3]), masks.get(*turn).map(|(depth, _)| *depth));
            }
            // A turn that is no texel's, and one that is greater than there are.
            let unused = (0..64u32).filter(|i| turn_of[*i as usize] == 0);
            let bit = |i: u32| (1 + (i >> 5) as usize, 1u32 << (i & 31));
            let mut other = words.clone();
            for i in unused {
                other[bit(i).0] |= bit(i).1;
            }
            assert!(!Turns::read(&other, 0).is_valid(SLICES), "{count} depths, none turns at the first");
            let masks_end = words.len() - turns.steps.len();
            // More bits than differences need, and stray ones.
            if bits < 32 {
                let mut other = words[..masks_end].to_vec();
                other[0] += 1 << (DEPTH_BITS + COUNT_BITS);
                other.resize(Turns::words_of(other[0]), 0);
                for (i, (depth, _)) in masks[1..].iter().enumerate() {
                    other[masks_end + i * 2 * bits / 32] |= (depth - 3) << (i * 2 * bits % 32);
                }
                let wide = Turns::read(&other, 0);
                assert!(wide.depths().eq(turns.depths()) && !wide.is_valid(SLICES), "{count} depths of {bits} bits");
            }
            if (count - 1) * bits % 32 != 0 {
                let mut other = words.clone();
                *other.last_mut().expect("a difference") |= 1 << 31;
                assert!(!Turns::read(&other, 0).is_valid(SLICES), "a stray bit behind {count} depths");
            }
            words[1..masks_end].fill(u32::MAX);
            assert!(!Turns::read(&words, 0).is_valid(SLICES));
        }
    }
}
