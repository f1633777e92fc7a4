//! Penumbrae that harden on contact: a light of some size casts shadows whose edges are as soft as their casters are far
//! (Fernando 2005, *Percentage-closer soft shadows*).

use glam::DVec3;

use super::filter::Filter;
use super::light::LightShadow;
use super::prefilter::Prefilter;

/// Texels to every side in which a penumbra's casters are looked for.
const SEARCH_TEXELS: f64 = 16.0;
/// Radius of the widest filter at full depth, and of those on coarse levels.
const MOST_RADIUS: u32 = 4;

impl LightShadow<'_> {
    /// Visibility under a light of some size, whose radius is seen from the point under an angle of the given tangent (the
    /// sun's: 0.00465). Needs enter depths ([`LightShadow::has_enter_depths`]), without which shadows come out hard; where
    /// the penumbra is wider than five texels it uses coarse levels, if there are any.
    ///
    /// The distance of the caster is the middle of what [`LightShadow::blocker`] says, so the width is an estimate: enter
    /// depths are known for cells of 32 texels. Cost: two blocker lookups and two filtered ones.
    #[must_use]
    pub fn penumbra(self, point_world: DVec3, normal_world: Option<DVec3>, tangent: f64) -> f32 {
        let mut radius_m = SEARCH_TEXELS * self.projection().texel_m(point_world);
        // The farther casters may be, the wider to look for them; then only as wide as the penumbra is.
        for _ in 0..2 {
            let blocker = self.blocker(point_world, radius_m);
            radius_m = tangent * blocker.map_or(0.0, |b| 0.5 * (b.least_m + b.greatest_m));
        }
        self.filtered_over(point_world, normal_world, 2.0 * radius_m)
    }

    /// Filtered over a width in metres by a tent: 1 to 9 taps per side at full depth, blended between two filters, or 9 on the
    /// coarse levels as wide.
    #[must_use]
    pub fn filtered_over(self, point_world: DVec3, normal_world: Option<DVec3>, width_m: f64) -> f32 {
        // A tent of radius r is r + 1 texels wide.
        let radius = (width_m / self.projection().texel_m(point_world) - 1.0).max(0.0);
        let tent = |radius: u32| Filter::tent_of_radius(radius.min(MOST_RADIUS));
        if radius > f64::from(MOST_RADIUS) {
            return self.prefiltered(point_world, normal_world, width_m, Prefilter::Levels(tent(MOST_RADIUS)));
        }
        let (whole, share) = (radius as u32, (radius - libm::floor(radius)) as f32);
        let narrow = self.filtered(point_world, normal_world, tent(whole));
        if share == 0.0 {
            return narrow;
        }
        narrow + (self.filtered(point_world, normal_world, tent(whole + 1)) - narrow) * share
    }
}
