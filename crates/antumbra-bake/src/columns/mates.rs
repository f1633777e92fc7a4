//! Where every ray of a tile meets a set of triangles equally often: where each edge that crosses the tile has its mate,
//! the same edge the other way round. Triangles count as counter-clockwise seen along the light, so that the two sides
//! of a fold do not cancel.

use rustc_hash::FxHashMap;

use super::tile::{COVERS, COVERS_FIRST, CUTOUT, Entry, Tile};
use super::triangle::BuildTriangle;
use crate::light_space::Resolution;

/// Larger sets are not looked at.
const MOST_TRIANGLES: usize = 96;

/// An edge by its lesser and its greater end.
type Key = ([i32; 2], [i32; 2]);

/// Sets of triangles that grow from front to back.
pub(super) struct Mates<'a> {
    triangles: &'a [BuildTriangle],
    /// First and last texel centre of the tile.
    rectangle: [[i64; 2]; 2],
    /// Edges that cross the tile: the sum of +1 one way, -1 the other.
    edges: FxHashMap<Key, i32>,
    /// Edges whose sum is not 0.
    unmatched: usize,
    /// Triangles over the tile's first texel.
    over_first: u32,
    length: usize,
    has_cutout: bool,
}

impl<'a> Mates<'a> {
    pub fn new(triangles: &'a [BuildTriangle], tile: Tile, resolution: Resolution) -> Self {
        let first = [resolution.texel_center(tile.x), resolution.texel_center(tile.y)];
        let side = ((1i64 << tile.log2) - 1) * resolution.texel_steps();
        Self {
            triangles,
            rectangle: [first, first.map(|c| c + side)],
            edges: FxHashMap::default(),
            unmatched: 0,
            over_first: 0,
            length: 0,
            has_cutout: false,
        }
    }

    pub fn insert(&mut self, entry: &Entry) {
        self.length += 1;
        self.has_cutout |= entry.has(CUTOUT);
        self.over_first += u32::from(entry.has(COVERS_FIRST));
        if entry.has(COVERS) || !self.is_of_use() {
            return;
        }
        let triangle = &self.triangles[entry.triangle as usize];
        if !triangle.is_edge_on() {
            (0..3).for_each(|i| self.insert_edge(triangle, i));
        }
    }

    /// Whether a set that only grows can still tell anything.
    pub fn is_of_use(&self) -> bool {
        !self.has_cutout && self.length <= MOST_TRIANGLES
    }

    /// How many triangles of the set every ray of the tile meets, if that is known to be one number.
    pub fn count(&self) -> Option<u32> {
        (self.is_of_use() && self.unmatched == 0).then_some(self.over_first)
    }

    fn insert_edge(&mut self, triangle: &BuildTriangle, i: usize) {
        let [a, b] = triangle.edge_ends(i);
        let [low, high] = self.rectangle;
        let beside = |axis: usize| {
            let (least, greatest) = (i64::from(a[axis].min(b[axis])), i64::from(a[axis].max(b[axis])));
            greatest < low[axis] || least > high[axis]
        };
        if beside(0) || beside(1) {
            return;
        }
        let edge = triangle.edge(i);
        let at = [[low[0], low[1]], [high[0], low[1]], [low[0], high[1]], [high[0], high[1]]].map(|p| edge.at(p));
        if at.iter().all(|v| *v > 0) || at.iter().all(|v| *v < 0) {
            return;
        }
        let (key, way) = if a < b { ((a, b), 1) } else { ((b, a), -1) };
        let sum = self.edges.entry(key).or_default();
        let was_matched = *sum == 0;
        *sum += way;
        match (was_matched, *sum == 0) {
            (true, false) => self.unmatched += 1,
            (false, true) => self.unmatched -= 1,
            _ => {}
        }
    }
}
