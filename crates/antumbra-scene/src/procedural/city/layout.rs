//! Where things are: a grid of blocks with avenues, a river that cuts through it, and what each block is for.

use glam::DVec2;

use crate::procedural::rng::Rng;

/// Width of an ordinary street, kerb to kerb.
const STREET_M: f64 = 13.0;
/// Width of an avenue; every fourth street is one.
pub(crate) const AVENUE_M: f64 = 26.0;
/// Water from quay to quay.
const RIVER_HALF_WIDTH_M: f64 = 46.0;
/// Street and promenade along the river.
pub(crate) const EMBANKMENT_M: f64 = 24.0;
/// Ground beyond the outermost blocks.
const MARGIN_M: f64 = 16.0;

/// What a block is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Use {
    /// Towers.
    Downtown,
    /// Mid-rise offices and apartments.
    Midtown,
    /// Terraced houses around courtyards.
    OldTown,
    /// Slabs on lawns, turned out of the grid.
    Estate,
    /// Warehouses, silos, chimneys.
    Works,
    /// The big park.
    Park,
    /// The domed capitol, at the head of the main avenue.
    Capitol,
    /// The square with the obelisk.
    Square,
    /// The stadium.
    Stadium,
    /// The cathedral and its close.
    Cathedral,
}

/// A block, kerb to kerb.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Block {
    pub(crate) min: DVec2,
    pub(crate) max: DVec2,
    pub(crate) purpose: Use,
    /// Typical height of its buildings, metres.
    pub(crate) height: f64,
    /// A number of its own.
    pub(crate) tag: u64,
}

impl Block {
    pub(crate) fn center(&self) -> DVec2 {
        (self.min + self.max) * 0.5
    }

    pub(crate) fn size(&self) -> DVec2 {
        self.max - self.min
    }
}

/// A street's middle line and width.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Street {
    pub(crate) middle: f64,
    pub(crate) width: f64,
}

impl Street {
    pub(crate) fn is_avenue(&self) -> bool {
        self.width > STREET_M
    }
}

/// The river's course: a gently winding line across the city from west to east.
#[derive(Clone, Copy, Debug)]
pub(crate) struct River {
    middle: f64,
    swing: f64,
    phase: f64,
    half_length: f64,
}

impl River {
    fn course(&self, x: f64) -> f64 {
        self.middle + self.swing * libm::sin(self.phase + 3.4 * x / self.half_length)
    }

    pub(crate) fn north_bank(&self, x: f64) -> f64 {
        self.course(x) - RIVER_HALF_WIDTH_M
    }

    pub(crate) fn south_bank(&self, x: f64) -> f64 {
        self.course(x) + RIVER_HALF_WIDTH_M
    }
}

/// The whole plan.
#[derive(Clone, Debug)]
pub(crate) struct Plan {
    /// Half the ground's size.
    pub(crate) half: DVec2,
    pub(crate) river: Option<River>,
    pub(crate) blocks: Vec<Block>,
    /// Middle line of the main avenue, which runs north to south.
    pub(crate) main_x: f64,
    /// Streets that run north to south, by x.
    pub(crate) meridians: Vec<Street>,
    /// Streets that run west to east, by z.
    pub(crate) parallels: Vec<Street>,
}

/// The lengths of blocks along one axis and the streets between them.
struct Axis {
    spans: Vec<(f64, f64)>,
    streets: Vec<Street>,
    /// Middle line of the avenue in the middle.
    main: f64,
}

impl Axis {
    /// `count` blocks, centred on 0.
    fn new(rng: &mut Rng, count: usize, lengths: (f64, f64)) -> Self {
        let middle = count / 2;
        let is_avenue = |gap: usize| (gap + 4 * count - middle).is_multiple_of(4);
        let (mut spans, mut streets, mut at) = (Vec::new(), Vec::new(), 0.0);
        for i in 0..count {
            if i > 0 {
                let width = if is_avenue(i) { AVENUE_M } else { STREET_M };
                streets.push(Street { middle: at + width * 0.5, width });
                at += width;
            }
            let length = rng.range(lengths.0, lengths.1);
            spans.push((at, at + length));
            at += length;
        }
        let origin = at * 0.5;
        spans.iter_mut().for_each(|s| *s = (s.0 - origin, s.1 - origin));
        streets.iter_mut().for_each(|s| s.middle -= origin);
        let main = streets.get(middle.wrapping_sub(1)).map_or(-origin - MARGIN_M * 0.5, |s| s.middle);
        Self { spans, streets, main }
    }

    fn reach(&self) -> f64 {
        self.spans.last().map_or(0.0, |s| s.1) + MARGIN_M
    }
}

/// Places that take several cells of the grid: what, first and last column, first and last row, counted from the middle.
const LANDMARKS: [(Use, [i32; 2], [i32; 2]); 5] = [
    (Use::Capitol, [-1, 0], [-5, -5]),
    (Use::Park, [-5, -4], [-4, -2]),
    (Use::Square, [-1, -1], [1, 1]),
    (Use::Stadium, [3, 4], [-5, -4]),
    (Use::Cathedral, [-5, -5], [1, 1]),
];

impl Plan {
    pub(crate) fn new(rng: &Rng, scale: f64) -> Self {
        let count = (11.0 * scale).round().max(1.0) as usize;
        let columns = Axis::new(&mut rng.fork(1), count, (80.0, 114.0));
        let rows = Axis::new(&mut rng.fork(2), count, (74.0, 104.0));
        let half = DVec2::new(columns.reach(), rows.reach());
        let river = (count >= 6).then(|| River {
            middle: half.y * 0.56,
            swing: 26.0,
            phase: rng.fork(3).range(0.0, 6.0),
            half_length: half.x,
        });
        let mut plan = Self {
            half,
            river,
            blocks: Vec::new(),
            main_x: columns.main,
            meridians: columns.streets,
            parallels: rows.streets,
        };
        plan.fill(rng, &columns.spans, &rows.spans);
        plan
    }

    fn fill(&mut self, rng: &Rng, columns: &[(f64, f64)], rows: &[(f64, f64)]) {
        let middle = (columns.len() / 2) as i32;
        let cell = |range: [i32; 2]| range.map(|i| (i + middle) as usize);
        let mut taken = vec![false; columns.len() * rows.len()];
        let landmarks = if columns.len() >= 11 { &LANDMARKS[..] } else { &[] };
        for &(purpose, across, down) in landmarks {
            let ([c0, c1], [r0, r1]) = (cell(across), cell(down));
            (r0..=r1).for_each(|r| (c0..=c1).for_each(|c| taken[r * columns.len() + c] = true));
            let (min, max) = (DVec2::new(columns[c0].0, rows[r0].0), DVec2::new(columns[c1].1, rows[r1].1));
            self.push(rng, min, max, Some(purpose));
        }
        for (r, row) in rows.iter().enumerate() {
            for (c, column) in columns.iter().enumerate() {
                if !taken[r * columns.len() + c] {
                    self.push(rng, DVec2::new(column.0, row.0), DVec2::new(column.1, row.1), None);
                }
            }
        }
    }

    /// Adds a block, cut back to the embankment where the river runs through it.
    fn push(&mut self, rng: &Rng, min: DVec2, max: DVec2, purpose: Option<Use>) {
        let tag = self.blocks.len() as u64;
        let Some((min, max)) = self.cut_back(min, max) else { return };
        let center = (min + max) * 0.5;
        let mut rng = rng.fork(1000 + tag);
        let purpose = purpose.unwrap_or_else(|| self.purpose(&mut rng, center));
        let height = self.height(purpose, center);
        self.blocks.push(Block { min, max, purpose, height, tag });
    }

    fn cut_back(&self, mut min: DVec2, mut max: DVec2) -> Option<(DVec2, DVec2)> {
        const SAMPLES: usize = 8;
        let Some(river) = self.river else { return Some((min, max)) };
        let xs = (0..=SAMPLES).map(|i| min.x + (max.x - min.x) * i as f64 / SAMPLES as f64);
        let north = xs.clone().map(|x| river.north_bank(x)).fold(f64::INFINITY, f64::min) - EMBANKMENT_M;
        let south = xs.map(|x| river.south_bank(x)).fold(f64::NEG_INFINITY, f64::max) + EMBANKMENT_M;
        if (min.y + max.y) * 0.5 < (north + south) * 0.5 {
            max.y = max.y.min(north);
        } else {
            min.y = min.y.max(south);
        }
        (max.y - min.y > 26.0).then_some((min, max))
    }

    /// 0 in the middle of downtown, about 1 at the city's edge.
    fn remoteness(&self, at: DVec2) -> f64 {
        ((at - DVec2::new(0.1, -0.02) * self.half) / self.half).length()
    }

    fn purpose(&self, rng: &mut Rng, at: DVec2) -> Use {
        let remoteness = self.remoteness(at) + rng.range(-0.05, 0.05);
        let south = self.river.is_some_and(|river| at.y > river.south_bank(at.x));
        match remoteness {
            _ if south && at.x > 0.25 * self.half.x => Use::Works,
            _ if south => Use::OldTown,
            r if r < 0.46 => Use::Downtown,
            r if r < 0.66 => Use::Midtown,
            _ if at.x < -0.40 * self.half.x => Use::OldTown,
            _ if at.x > 0.72 * self.half.x && at.y > 0.0 => Use::Works,
            _ if at.y < -0.1 * self.half.y && rng.chance(0.75) => Use::Estate,
            _ => Use::Midtown,
        }
    }

    fn height(&self, purpose: Use, at: DVec2) -> f64 {
        let r = self.remoteness(at) / 0.34;
        let bell = libm::exp(-r * r);
        match purpose {
            Use::Downtown => 32.0 + 130.0 * bell,
            Use::Midtown => 21.0 + 42.0 * bell,
            Use::Estate => 34.0,
            _ => 16.0,
        }
    }
}

/// A piece of ground for one building.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lot {
    pub(crate) min: DVec2,
    pub(crate) max: DVec2,
    /// Sides that face a street: south (+z), east, north, west.
    pub(crate) street: [bool; 4],
}

impl Lot {
    /// Cuts the lot in two until no side is longer than `longest`.
    pub(crate) fn split(self, rng: &mut Rng, longest: f64, out: &mut Vec<Self>) {
        let size = self.max - self.min;
        if size.max_element() <= longest {
            out.push(self);
            return;
        }
        let share = rng.range(0.42, 0.58);
        let (mut a, mut b) = (self, self);
        if size.x > size.y {
            let x = self.min.x + size.x * share;
            (a.max.x, b.min.x) = (x, x);
            (a.street[1], b.street[3]) = (false, false);
        } else {
            let z = self.min.y + size.y * share;
            (a.max.y, b.min.y) = (z, z);
            (a.street[0], b.street[2]) = (false, false);
        }
        a.split(rng, longest, out);
        b.split(rng, longest, out);
    }

    /// Quarter turns that bring a building's front (+z) to a street.
    pub(crate) fn quarters(&self) -> usize {
        self.street.iter().position(|&s| s).unwrap_or(0)
    }
}
