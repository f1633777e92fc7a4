//! Cheaper gathers: which sample gathers the light of which VPLs, and what a sample takes from its neighbours.
//!
//! Light and fog change slowly over a picture, and most of a gather's cost is in reading voxels: so neighbours share
//! (Wyman and Dai 2013, section 3.4). What they share is light, not colour: textures stay sharp.

use glam::{UVec2, Vec3};

use super::AreaLit;
use crate::area::Gathering;

/// What decides whether two samples of a picture share light.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Key {
    /// Shading normal; zero where there is no surface.
    pub normal: Vec3,
    /// Relative to the eye.
    pub position: Vec3,
    /// How far fog is looked through.
    pub fog_m: f32,
}

/// Surfaces farther than this from one another's planes, relative to the distance, share nothing.
const OFF_PLANE: f32 = 0.02;
/// Samples whose ways through fog differ by more than this share have no fog in common.
const OFF_WAY: f32 = 0.2;
/// Counts of those that have nothing in common: some light, when there is no other.
const LEAST: f32 = 1e-5;

impl Key {
    /// How much another sample's light on its surface, and in its fog, is worth to this one.
    fn affinity(&self, other: &Self) -> [f32; 2] {
        let off_plane = self.normal.dot(other.position - self.position).abs();
        let near = (1.0 - off_plane / (OFF_PLANE * self.position.length()).max(1e-9)).max(0.0);
        let alike = self.normal.dot(other.normal).max(0.0);
        let [square, other_fog] = [alike * alike, (self.fog_m - other.fog_m).abs()];
        let through = 1.0 - other_fog / (OFF_WAY * self.fog_m.max(other.fog_m)).max(1e-9);
        [near * square * square * square * square + LEAST, through.max(0.0) + LEAST]
    }
}

/// The samples of a picture that gather: their grid, and who is who.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grid {
    pub gathering: Gathering,
    /// Of the picture, pixels.
    pub size: UVec2,
}

/// Parts of the VPLs that interleaved pixels gather: 3 x 3.
const PARTS: u32 = 9;

impl Grid {
    /// For a picture; one that is too small to share gathers everything everywhere.
    pub fn new(gathering: Gathering, size: UVec2) -> Self {
        Self { gathering: if size.min_element() < 3 { Gathering::Full } else { gathering }, size }
    }

    /// Samples that gather, across and down.
    pub fn gathered(&self) -> UVec2 {
        if self.gathering == Gathering::Half { (self.size + 1) / 2 } else { self.size }
    }

    /// The pixel that a gathered sample belongs to.
    pub fn pixel(&self, at: UVec2) -> UVec2 {
        if self.gathering == Gathering::Half { 2 * at } else { at }
    }

    /// Whether a gathered sample takes the light of a VPL. Of nine VPLs in a row each part has one, of the next nine another
    /// one: Halton's points at equal places of each nine lie in one strip.
    pub fn takes(&self, at: UVec2, vpl: u32) -> bool {
        self.gathering != Gathering::Interleaved || (vpl + vpl / PARTS) % PARTS == at.x % 3 + 3 * (at.y % 3)
    }

    /// A pixel's light, from what samples around it gathered.
    pub fn shared<'a>(&self, pixel: UVec2, key: &Key, of: impl Fn(UVec2) -> (&'a Key, &'a AreaLit)) -> AreaLit {
        let mut sum = Sum::default();
        let mut add = |at: UVec2| {
            let (there, lit) = of(at);
            sum.add(lit, key.affinity(there));
        };
        match self.gathering {
            Gathering::Full => *of(pixel).1,
            Gathering::Interleaved => {
                // Three by three with all nine parts, at the border too.
                let middle = pixel.clamp(UVec2::ONE, self.size - 2);
                (0..9).for_each(|i| add(middle + UVec2::new(i % 3, i / 3) - 1));
                sum.mean(PARTS as f32)
            }
            Gathering::Half => {
                let (first, odd, last) = (pixel / 2, pixel % 2, self.gathered() - 1);
                for step in (0..4).map(|i| UVec2::new(i % 2, i / 2)).filter(|step| step.cmple(odd).all()) {
                    add((first + step).min(last));
                }
                sum.mean(1.0)
            }
        }
    }
}

/// A mean in the making, by weights for surfaces and for fog.
#[derive(Default)]
struct Sum {
    lit: AreaLit,
    weights: [f32; 2],
}

impl Sum {
    fn add(&mut self, lit: &AreaLit, [surface, fog]: [f32; 2]) {
        self.lit.irradiance += lit.irradiance * surface;
        self.lit.glossy += lit.glossy * surface;
        self.lit.airlight += lit.airlight * fog;
        self.weights = [self.weights[0] + surface, self.weights[1] + fog];
    }

    fn mean(self, times: f32) -> AreaLit {
        let [surface, fog] = self.weights.map(|weight| times / weight);
        let AreaLit { irradiance, glossy, airlight } = self.lit;
        AreaLit { irradiance: irradiance * surface, glossy: glossy * surface, airlight: airlight * fog }
    }
}
