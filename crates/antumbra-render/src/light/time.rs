//! When a picture is taken.

use antumbra_scene::{Light, LightKind};

/// Day or night: which lights rule a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Time {
    /// The first directional light is the sun, whatever its lux; lamps keep theirs, and are as good as invisible.
    Day,
    /// Lamps rule under a dark sky. Of the directional lights only those shine that are as dim as a moon.
    Night,
}

/// Directional lights of less than this, lux, are moons: they shine at night. The full moon gives a quarter of one.
pub(super) const MOON_BELOW_LUX: f32 = 10.0;

impl Time {
    /// The time that suits the lights of a scene: night where lamps shine and no directional light is brighter than a
    /// moon (10 lux), else day.
    pub fn suiting<'l>(lights: impl IntoIterator<Item = &'l Light>) -> Self {
        let (mut lamps, mut suns) = (false, false);
        for light in lights {
            let directional = light.kind == LightKind::Directional;
            suns |= directional && light.intensity >= MOON_BELOW_LUX;
            lamps |= !directional && light.intensity > 0.0;
        }
        if lamps && !suns { Self::Night } else { Self::Day }
    }
}
