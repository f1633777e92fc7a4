//! Valleys cut by water: uplift against stream-power erosion.
//!
//! Based on Braun and Willett 2013, "A very efficient O(n), implicit and parallel method to solve the stream power
//! equation governing fluvial incision and landscape evolution" (sections 2 and 3), as used for pictures by Cordonnier
//! et al. 2016, "Large Scale Terrain Generation from Tectonic Uplift and Fluvial Erosion". Each step sends every cell's
//! rain to its steepest neighbour, adds up the drained area, and lowers the bed the more the larger the area and the
//! slope; a cap on slopes stands in for rockfall. Departures: pits are not routed through lakes, they rise until they
//! spill; and the cap varies from place to place.

/// A square grid of heights that is worn down in place.
pub(crate) struct Rivers {
    side: usize,
    cell_m: f64,
    /// Heights, row by row.
    pub(crate) heights: Vec<f64>,
    /// The area that drains through each cell, square metres.
    pub(crate) drained_m2: Vec<f64>,
    receivers: Vec<usize>,
    order: Vec<usize>,
}

/// What is done to a cell in each step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ground {
    /// Rise per step, metres; a cell that does not rise keeps its height for ever, and everything drains to it.
    pub(crate) uplift_m: f64,
    /// How easily water cuts it, about 1.
    pub(crate) softness: f64,
    /// Steepest slope that stands, rise over run.
    pub(crate) repose: f64,
}

/// The erosion coefficient and time step in one, for areas in square metres and the exponent 1/2.
const STRENGTH: f64 = 0.05;

impl Rivers {
    pub(crate) fn new(side: usize, cell_m: f64, heights: Vec<f64>) -> Self {
        let count = side * side;
        debug_assert_eq!(heights.len(), count);
        Self {
            side,
            cell_m,
            heights,
            drained_m2: vec![0.0; count],
            receivers: (0..count).collect(),
            order: Vec::with_capacity(count),
        }
    }

    /// One step of uplift and erosion.
    pub(crate) fn step(&mut self, ground: &[Ground]) {
        let receiver = |(i, ground): (usize, &Ground)| if ground.uplift_m > 0.0 { self.steepest(i) } else { i };
        self.receivers = ground.iter().enumerate().map(receiver).collect();
        self.sort_upstream();
        self.drain();
        self.incise(ground);
    }

    /// The neighbour to which water runs, or the cell itself in a pit.
    fn steepest(&self, i: usize) -> usize {
        let (x, z) = ((i % self.side) as i64, (i / self.side) as i64);
        let (mut best, mut best_drop) = (i, 0.0);
        for (dx, dz) in [(-1, 0), (1, 0), (0, -1), (0, 1), (-1, -1), (1, -1), (-1, 1), (1, 1)] {
            let (nx, nz) = (x + dx, z + dz);
            let inside = 0..self.side as i64;
            if !inside.contains(&nx) || !inside.contains(&nz) {
                continue;
            }
            let neighbour = nz as usize * self.side + nx as usize;
            let drop = (self.heights[i] - self.heights[neighbour]) / if dx != 0 && dz != 0 { DIAGONAL } else { 1.0 };
            if drop > best_drop {
                (best, best_drop) = (neighbour, drop);
            }
        }
        best
    }

    /// Orders the cells so that each comes after the one it drains to: a walk up the trees of donors.
    fn sort_upstream(&mut self) {
        let count = self.receivers.len();
        let mut starts = vec![0_usize; count + 1];
        for (i, &r) in self.receivers.iter().enumerate() {
            starts[r + 1] += usize::from(r != i);
        }
        for i in 0..count {
            starts[i + 1] += starts[i];
        }
        let (mut fill, mut donors) = (starts.clone(), vec![0_usize; starts[count]]);
        for (i, &r) in self.receivers.iter().enumerate().filter(|&(i, &r)| r != i) {
            donors[fill[r]] = i;
            fill[r] += 1;
        }
        self.order.clear();
        self.order.extend((0..count).filter(|&i| self.receivers[i] == i));
        let mut at = 0;
        while at < self.order.len() {
            let i = self.order[at];
            self.order.extend_from_slice(&donors[starts[i]..starts[i + 1]]);
            at += 1;
        }
    }

    fn drain(&mut self) {
        self.drained_m2.fill(self.cell_m * self.cell_m);
        for &i in self.order.iter().rev() {
            let receiver = self.receivers[i];
            if receiver != i {
                self.drained_m2[receiver] += self.drained_m2[i];
            }
        }
    }

    /// Braun and Willett's implicit step (their equation 23, slope exponent 1), from the mouths upwards.
    fn incise(&mut self, ground: &[Ground]) {
        for &i in &self.order {
            let (receiver, ground) = (self.receivers[i], ground[i]);
            if receiver == i {
                self.heights[i] += ground.uplift_m;
                continue;
            }
            let diagonal = i % self.side != receiver % self.side && i / self.side != receiver / self.side;
            let run = self.cell_m * if diagonal { DIAGONAL } else { 1.0 };
            let cut = STRENGTH * ground.softness * self.drained_m2[i].sqrt() / run;
            let below = self.heights[receiver];
            let height = (self.heights[i] + ground.uplift_m + cut * below) / (1.0 + cut);
            self.heights[i] = height.min(below + ground.repose * run);
        }
    }
}

const DIAGONAL: f64 = core::f64::consts::SQRT_2;
