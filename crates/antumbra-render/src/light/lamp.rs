//! Spot and point lights, by the formulas of glTF's KHR_lights_punctual.

use antumbra_scene::{Light, LightKind};
use glam::{DVec3, Vec3};

use super::{LUX, luminance};

/// Near distance per range: what is nearer to a lamp than that casts no shadow, as in a bake.
const NEAR_PER_RANGE: f64 = 1.0 / 1024.0;

/// A spot or point light.
#[derive(Clone, Debug)]
pub struct Lamp {
    /// The light's name in the scene, by which a shadow file knows it.
    pub name: String,
    /// Where it is, metres.
    pub position_world: DVec3,
    /// Linear RGB intensity: the irradiance that it gives a surface 1 m away that faces it, in the unit of pictures.
    pub intensity: Vec3,
    /// Where its light ends, metres; infinite where the file does not say.
    pub range_m: f64,
    /// Casters nearer than this, metres along the longest of the light's axes, are ignored.
    pub near_m: f64,
    /// Light gets no brighter nearer than this, metres: a lamp has a size.
    pub(crate) core_m: f64,
    cone: Option<Cone>,
    /// Of a virtual point light, the unit normal of its surface: it sends light by the cosine to that.
    surface_normal: Option<DVec3>,
}

/// A spot light's cone.
#[derive(Clone, Copy, Debug)]
struct Cone {
    /// Unit vector along which the light travels.
    axis_world: DVec3,
    cos_outer: f64,
    /// Takes the cosine from the outer angle's to 0 and the inner one's to 1.
    per_cosine: f64,
}

/// What a lamp gives a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lamplight {
    /// Unit vector towards the lamp.
    pub towards: Vec3,
    /// Linear RGB irradiance of a surface that faces the lamp, nothing in the way.
    pub irradiance: Vec3,
}

impl Lamp {
    /// `None` for a directional light, and for one that gives no light. A lamp without a range has its near distance
    /// from `diagonal_m`, the scene's.
    #[must_use]
    pub fn of_light(light: &Light, diagonal_m: f64) -> Option<Self> {
        let cone = match light.kind {
            LightKind::Directional => return None,
            LightKind::Point => None,
            LightKind::Spot { inner_angle, outer_angle } => {
                Some(Cone::new(light.direction_world, inner_angle, outer_angle)?)
            }
        };
        let intensity = Vec3::from(light.color) * (light.intensity * LUX);
        (luminance(intensity) > 0.0 && light.position_world.is_finite()).then(|| Self {
            name: light.name.clone(),
            position_world: light.position_world,
            intensity,
            range_m: light.range_m.unwrap_or(f64::INFINITY),
            near_m: light.range_m.unwrap_or(diagonal_m) * NEAR_PER_RANGE,
            core_m: light.range_m.unwrap_or(diagonal_m) * NEAR_PER_RANGE,
            cone,
            surface_normal: None,
        })
    }

    /// A point of a surface that sends on light: a virtual point light. `intensity` is its irradiance at 1 m along its normal, in
    /// the unit of pictures. Nearer than `core_m` it gets no brighter (Keller 1997, *Instant radiosity*, has its singularity there).
    pub(crate) fn of_surface(
        name: String,
        position_world: DVec3,
        normal_world: DVec3,
        intensity: Vec3,
        core_m: f64,
    ) -> Self {
        Self {
            name,
            position_world,
            intensity,
            range_m: f64::INFINITY,
            near_m: core_m * NEAR_PER_RANGE * 16.0,
            core_m,
            cone: None,
            surface_normal: Some(normal_world),
        }
    }

    /// The light at a point with nothing in the way: intensity over the squared distance, faded out towards the range
    /// and the cone's edge; `None` where there is none.
    #[must_use]
    pub fn at(&self, point_world: DVec3) -> Option<Lamplight> {
        let to_lamp = self.position_world - point_world;
        let distance = to_lamp.length();
        let squared = distance.max(self.core_m).powi(2);
        let window = self.window(distance);
        let towards = to_lamp.try_normalize()?;
        let share = window * self.share(-towards) / squared;
        (share > 0.0 && share.is_finite())
            .then(|| Lamplight { towards: towards.as_vec3(), irradiance: self.intensity * share as f32 })
    }

    /// Share of its light that is left at a distance before its range.
    pub(crate) fn window(&self, distance: f64) -> f64 {
        (1.0 - (distance / self.range_m).powi(4)).clamp(0.0, 1.0)
    }

    /// Share of its intensity that it has in a direction.
    fn share(&self, direction: DVec3) -> f64 {
        match (self.surface_normal, self.cone) {
            (Some(normal), _) => normal.dot(direction).max(0.0),
            (None, Some(cone)) => cone.share(direction),
            (None, None) => 1.0,
        }
    }

    /// A direction that the lamp shines in, by a point of the unit square, and the power that it would give if all directions
    /// had as much.
    pub(crate) fn emitted(&self, [x, y]: [f64; 2]) -> (DVec3, Vec3) {
        let direction = self.direction(x, y);
        let solid_angle = std::f64::consts::TAU * (1.0 - self.axis().1);
        (direction, self.intensity * (self.share(direction) * solid_angle) as f32)
    }

    /// How far the lamp gives at least `least` of irradiance (in the unit of pictures), metres.
    pub(crate) fn reach_m(&self, least: f32) -> f64 {
        // Of virtual lights there are many: what little each of them gives counts together.
        if self.is_virtual() {
            return self.range_m;
        }
        self.range_m.min(f64::from(luminance(self.intensity) / least).sqrt())
    }

    /// Whether it is a virtual point light: a point of a surface that sends on what it receives.
    #[must_use]
    pub fn is_virtual(&self) -> bool {
        self.surface_normal.is_some()
    }

    /// A spot light's axis, the cosine of its outer angle, and what takes cosines from the outer angle's to 0 and the inner
    /// one's to 1; a virtual light's normal.
    #[cfg(feature = "gpu")]
    pub(crate) fn cone_parts(&self) -> Option<(DVec3, f64, f64)> {
        let of_cone = |cone: Cone| (cone.axis_world, cone.cos_outer, cone.per_cosine);
        self.surface_normal.map(|normal| (normal, 0.0, 0.0)).or(self.cone.map(of_cone))
    }

    /// How far along a ray from a point (parameter 0) to the lamp (parameter 1) casters count.
    pub(crate) fn casters_end(&self, point_world: DVec3) -> f64 {
        let from_lamp = point_world - self.position_world;
        let depth = match &self.cone {
            None => from_lamp.abs().max_element(),
            Some(cone) => {
                // In a narrow cone its axis is the longest; a wide one is a cube about it, turned anyhow.
                let (right, down) = cone.axis_world.any_orthonormal_pair();
                [cone.axis_world, right, down].map(|axis| axis.dot(from_lamp).abs()).into_iter().fold(0.0, f64::max)
            }
        };
        if depth > self.near_m { 1.0 - self.near_m / depth } else { 0.0 }
    }

    /// The axis of its light, and the cosine of the angle to it that all of it lies within.
    fn axis(&self) -> (DVec3, f64) {
        let of_cone = |cone: Cone| (cone.axis_world, cone.cos_outer);
        let of_surface = self.surface_normal.map(|normal| (normal, 0.0));
        of_surface.or(self.cone.map(of_cone)).unwrap_or((DVec3::NEG_Y, -1.0))
    }

    /// A unit direction that the lamp shines in, by a point of the unit square: evenly over its cone, or all round.
    pub(crate) fn direction(&self, x: f64, y: f64) -> DVec3 {
        let (axis, cos_outer) = self.axis();
        let cos = 1.0 - y * (1.0 - cos_outer);
        let (sin_turn, cos_turn) = (std::f64::consts::TAU * x).sin_cos();
        let (right, down) = axis.any_orthonormal_pair();
        axis * cos + (right * cos_turn + down * sin_turn) * (1.0 - cos * cos).max(0.0).sqrt()
    }
}

impl Cone {
    fn new(direction_world: DVec3, inner_angle: f64, outer_angle: f64) -> Option<Self> {
        let (cos_inner, cos_outer) = (inner_angle.cos(), outer_angle.cos());
        let per_cosine = 1.0 / (cos_inner - cos_outer).max(0.001);
        Some(Self { axis_world: direction_world.try_normalize()?, cos_outer, per_cosine })
    }

    /// Share of the light in a direction from the lamp.
    fn share(&self, direction: DVec3) -> f64 {
        ((self.axis_world.dot(direction) - self.cos_outer) * self.per_cosine).clamp(0.0, 1.0).powi(2)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn light(kind: LightKind, range_m: Option<f64>) -> Light {
        Light {
            name: "lamp".into(),
            kind,
            position_world: DVec3::new(0.0, 2.0, 0.0),
            direction_world: DVec3::NEG_Y,
            color: [1.0, 0.5, 0.25],
            intensity: 128_000.0,
            range_m,
            dynamic: false,
        }
    }

    fn green(lamp: &Lamp, point: DVec3) -> f64 {
        lamp.at(point).map_or(0.0, |light| f64::from(light.irradiance.y))
    }

    #[test]
    fn light_falls_off_with_the_squared_distance_and_ends_at_the_range() {
        let endless = Lamp::of_light(&light(LightKind::Point, None), 10.0).expect("a lamp");
        let ranged = Lamp::of_light(&light(LightKind::Point, Some(4.0)), 10.0).expect("a lamp");
        for i in 1..80 {
            let distance = f64::from(i) * 0.1;
            let point = endless.position_world + DVec3::X * distance;
            let plain = 0.5 / distance.powi(2);
            assert!((green(&endless, point) / plain - 1.0).abs() < 1e-6);
            let window = (1.0 - (distance / 4.0).powi(4)).max(0.0);
            assert!((green(&ranged, point) - plain * window).abs() < 1e-6 * plain, "{distance}");
        }
        assert_eq!(ranged.at(ranged.position_world + DVec3::X * 4.0), None);
        assert_eq!(ranged.near_m, 4.0 / 1024.0);
        assert_eq!(endless.near_m, 10.0 / 1024.0);
    }

    #[test]
    fn a_cone_is_full_within_its_inner_and_dark_beyond_its_outer_angle() {
        let kind = LightKind::Spot { inner_angle: 0.3, outer_angle: 0.6 };
        let lamp = Lamp::of_light(&light(kind, None), 10.0).expect("a lamp");
        let at = |angle: f64| green(&lamp, lamp.position_world + DVec3::new(angle.sin(), -angle.cos(), 0.0));
        assert!((at(0.0) - 0.5).abs() < 1e-6 && (at(0.299) - 0.5).abs() < 1e-6);
        assert!(at(0.59) > 0.0 && at(0.601) == 0.0 && at(3.0) == 0.0);
        let share = (0.45_f64.cos() - 0.6_f64.cos()) / (0.3_f64.cos() - 0.6_f64.cos());
        assert!((at(0.45) - 0.5 * share * share).abs() < 1e-6);
    }

    #[test]
    fn directions_stay_within_the_cone() {
        let kind = LightKind::Spot { inner_angle: 0.3, outer_angle: 0.6 };
        let spot = Lamp::of_light(&light(kind, None), 10.0).expect("a lamp");
        let round = Lamp::of_light(&light(LightKind::Point, None), 10.0).expect("a lamp");
        let points = || (0..64).map(|i| (f64::from(i % 8) / 8.0 + 0.05, f64::from(i / 8) / 8.0 + 0.05));
        assert!(points().all(|(x, y)| spot.direction(x, y).dot(DVec3::NEG_Y) >= 0.6_f64.cos()));
        let sum: DVec3 = points().map(|(x, y)| round.direction(x, y)).sum();
        assert!(sum.length() < 10.0 && points().all(|(x, y)| (round.direction(x, y).length() - 1.0).abs() < 1e-12));
    }

    #[test]
    fn the_point_at_the_lamp_itself_gets_no_infinite_light() {
        let lamp = Lamp::of_light(&light(LightKind::Point, Some(4.0)), 10.0).expect("a lamp");
        assert_eq!(lamp.at(lamp.position_world), None);
        let close = lamp.at(lamp.position_world + DVec3::X * 1e-9).expect("light");
        assert!((close.irradiance.x - 256.0_f32.powi(2)).abs() < 1.0 && close.towards == Vec3::NEG_X);
        assert_eq!(lamp.casters_end(lamp.position_world + DVec3::X * 1e-3), 0.0);
        assert!(Lamp::of_light(&light(LightKind::Directional, None), 10.0).is_none());
    }
}
