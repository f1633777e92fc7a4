//! What covers the ground: meadow, forest, heath, scree, rock and snow, blended into one colour per vertex.

use glam::{DVec2, DVec3};

use super::terrain::{LAKE_M, Terrain};
use crate::procedural::noise::{fractal_noise, smoothstep};
use crate::procedural::palette::linear_color;

const SHORE: u32 = 0xc4b28a;
const MEADOW: u32 = 0x939257;
const PASTURE: u32 = 0x747f47;
const FOREST: u32 = 0x50653a;
const DARK_FOREST: u32 = 0x3e5334;
const HEATH: u32 = 0x87805a;
const SCREE: u32 = 0xa39a88;
const ROCK: u32 = 0x7f776d;
const SNOW: u32 = 0xf4f6f8;

/// Colours the ground of one landscape.
pub(crate) struct Cover<'a> {
    terrain: &'a Terrain,
    seed: u64,
    palette: [DVec3; 9],
}

impl<'a> Cover<'a> {
    pub(crate) fn new(terrain: &'a Terrain, seed: u64) -> Self {
        let palette = [SHORE, MEADOW, PASTURE, FOREST, DARK_FOREST, HEATH, SCREE, ROCK, SNOW].map(linear_color);
        Self { terrain, seed, palette }
    }

    /// The linear colour at a vertex. Each layer lies over the ones before it.
    pub(crate) fn color(&self, at: DVec3, normal: DVec3) -> DVec3 {
        let [shore, meadow, pasture, forest, dark_forest, heath, scree, rock, snow] = self.palette;
        let p = DVec2::new(at.x, at.z);
        let slope = self.terrain.slope(p);
        let mottle = fractal_noise(self.seed ^ 0x51, p / 280.0, 4, 0.55);
        let grain = fractal_noise(self.seed ^ 0x52, p / 36.0, 2, 0.6);
        let height = at.y - LAKE_M + 18.0 * grain;
        let tree_line = 440.0 + 120.0 * mottle - 200.0 * (slope - 0.45).max(0.0);

        let mut color = meadow.lerp(pasture, smoothstep(-0.35, 0.35, mottle + 0.3 * grain));
        let wooded = smoothstep(70.0, 105.0, height + 190.0 * slope + 125.0 * mottle);
        color = color.lerp(forest.lerp(dark_forest, smoothstep(-0.5, 0.5, grain + mottle)), wooded);
        color = color.lerp(heath, smoothstep(tree_line - 35.0, tree_line + 35.0, height));
        let stony = smoothstep(tree_line + 90.0, tree_line + 250.0, height);
        let steep = smoothstep(0.74, 0.98, slope + 0.22 * mottle + 0.12 * grain);
        color = color.lerp(scree, stony.max(steep * smoothstep(120.0, 420.0, height)));
        color = color.lerp(rock, 1.0 - smoothstep(0.66, 0.76, normal.y + 0.05 * grain));
        color = color.lerp(shore, (1.0 - smoothstep(2.0, 5.0, at.y - LAKE_M + grain)) * (1.0 - steep));
        // Snow lies longer on slopes that face north, and slides off steep ones.
        let snow_line = 690.0 + 90.0 * mottle + 170.0 * normal.z;
        let lies = smoothstep(snow_line - 45.0, snow_line + 45.0, height) * smoothstep(0.58, 0.70, normal.y);
        color = color.lerp(snow, lies);
        color * (1.0 + 0.10 * grain * (1.0 - lies))
    }
}
