//! Run-length-encoded columns, and merging four of them into their parent's.
//!
//! A column is a tile's whole depth range as runs of identical blocks, each block a cube as wide as the tile. The
//! boundary between two runs may lie anywhere in an interval, in blocks: it is committed to a depth only where no
//! boundary of the parent's greater blocks remains inside.

use crate::dag::{Id, Interner, LIT, SHADOWED};

/// Equal blocks, up to a boundary with the next run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Run {
    pub node: Id,
    /// The next run begins at any block from `end_first` to `end_last`. Both are the column's length in the last run.
    pub end_first: u32,
    pub end_last: u32,
}

impl Run {
    /// The run with its end moved; wraps.
    pub fn moved_by(self, blocks: u32) -> Self {
        let [end_first, end_last] = [self.end_first, self.end_last].map(|end| end.wrapping_add(blocks));
        Self { end_first, end_last, ..self }
    }
}

/// Writes a column's runs, leaving out those that are empty for certain.
pub(super) struct ColumnWriter<'a> {
    runs: &'a mut Vec<Run>,
    /// First block at which the next run may begin.
    begin: u32,
}

impl<'a> ColumnWriter<'a> {
    pub fn new(runs: &'a mut Vec<Run>) -> Self {
        Self { runs, begin: 0 }
    }

    /// Appends a run that ends in [first, last]; its node is made only if the run may have a block.
    pub fn push(&mut self, [first, last]: [u32; 2], node: impl FnOnce() -> Id) {
        if last > self.begin {
            self.runs.push(Run { node: node(), end_first: first, end_last: last });
        }
        self.begin = first;
    }
}

/// The value in `first..=last` with the most trailing zero bits; `first` is positive.
pub(super) fn roundest(first: u32, last: u32) -> u32 {
    let highest_difference = 31 - ((first - 1) ^ last).leading_zeros();
    (last >> highest_difference) << highest_difference
}

/// Multiples of 2^log2 in `first..=last`, divided by it; `None` if there are none.
pub(super) fn multiples([first, last]: [u32; 2], log2: u32) -> Option<[u32; 2]> {
    let low = first.div_ceil(1 << log2);
    let high = last >> log2;
    (low <= high).then_some([low, high])
}

/// Appends the column of a tile of 2^`log2` texels per side, all of which turn from lit to shadowed at any one slice
/// in `[enter, exit]`. The light has 2^`resolution_log2` slices.
pub(super) fn push_plane(
    runs: &mut Vec<Run>,
    nodes: &mut Interner<'_>,
    span: [u32; 2],
    log2: u32,
    resolution_log2: u32,
) {
    let blocks = 1u32 << (resolution_log2 - log2);
    let mut column = ColumnWriter::new(runs);
    if span[1] >> resolution_log2 != 0 {
        return column.push([blocks; 2], || LIT);
    }
    if let Some(boundary) = multiples(span, log2) {
        column.push(boundary, || LIT);
    } else {
        let slice = roundest(span[0], span[1]);
        let block = slice >> log2;
        column.push([block; 2], || LIT);
        column.push([block + 1; 2], || constant_depth(nodes, log2, slice & ((1 << log2) - 1)));
    }
    column.push([blocks; 2], || SHADOWED);
}

/// A node of 2^`log2` voxels per side that is lit before slice `depth` of its own, 0 < depth < 2^`log2`.
fn constant_depth(nodes: &mut Interner<'_>, log2: u32, depth: u32) -> Id {
    if log2 == 3 {
        return nodes.slice_node(core::array::from_fn(|z| if (z as u32) < depth { LIT } else { SHADOWED }));
    }
    let half = 1 << (log2 - 1);
    let (near, far) = match depth {
        d if d == half => (LIT, SHADOWED),
        d if d < half => (constant_depth(nodes, log2 - 1, d), SHADOWED),
        d => (LIT, constant_depth(nodes, log2 - 1, d - half)),
    };
    nodes.inner_node([near, near, near, near, far, far, far, far])
}

/// Merges four sibling columns into their parent's, appended to `out`. `blocks` is the parent's length.
pub(super) fn merge(children: [&[Run]; 4], blocks: u32, nodes: &mut Interner<'_>, out: &mut Vec<Run>) {
    let mut cursors = children.map(Cursor::new);
    // Pieces that end where the column begins are empty.
    for cursor in &mut cursors {
        cursor.skip_to(0);
    }
    loop {
        // Stab by the closest end: every boundary that can lie there does.
        let end_last = cursors.iter().map(|c| c.piece.end_last).min().unwrap_or(blocks);
        let node = nodes.inner_node(core::array::from_fn(|i| cursors[i & 3].piece.halves[i >> 2]));
        if end_last >= blocks {
            out.push(Run { node, end_first: blocks, end_last: blocks });
            return;
        }
        let end_first = cursors.iter_mut().map(|c| c.skip_to(end_last)).max().unwrap_or(end_last);
        out.push(Run { node, end_first, end_last });
    }
}

/// Blocks of the parent's size in one child's column.
#[derive(Clone, Copy)]
struct Piece {
    /// The child's node in the nearer and in the farther half of each block.
    halves: [Id; 2],
    end_first: u32,
    end_last: u32,
}

/// Walks a child's column in the parent's blocks.
struct Cursor<'a> {
    runs: &'a [Run],
    piece: Piece,
    /// Whether the piece is to be followed by the block in which the run gives way to the next.
    split_follows: bool,
}

impl<'a> Cursor<'a> {
    fn new(runs: &'a [Run]) -> Self {
        let piece = Piece { halves: [LIT; 2], end_first: 0, end_last: 0 };
        let mut cursor = Self { runs, piece, split_follows: false };
        cursor.load();
        cursor
    }

    /// The piece of the current run's own blocks.
    fn load(&mut self) {
        let run = self.runs[0];
        let boundary = multiples([run.end_first, run.end_last], 1);
        self.split_follows = boundary.is_none();
        // An interval without an even value is one odd value, in the middle of a block of the parent's.
        let [end_first, end_last] = boundary.unwrap_or([run.end_first >> 1; 2]);
        self.piece = Piece { halves: [run.node; 2], end_first, end_last };
    }

    fn advance(&mut self) {
        if self.split_follows {
            self.split_follows = false;
            let end = (self.runs[0].end_first >> 1) + 1;
            self.piece = Piece { halves: [self.runs[0].node, self.runs[1].node], end_first: end, end_last: end };
        } else {
            self.runs = &self.runs[1..];
            self.load();
        }
    }

    /// Puts every boundary that can lie at `block` there; returns the first block at which they all could.
    fn skip_to(&mut self, block: u32) -> u32 {
        let mut first = 0;
        while self.piece.end_first <= block {
            first = self.piece.end_first;
            self.advance();
        }
        first
    }
}
