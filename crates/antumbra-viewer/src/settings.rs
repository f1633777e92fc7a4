//! What the user can choose.

use antumbra::{Filter, Kernel, Prefilter, ShadowFile};
use antumbra_render::gpu::Lookup;
use antumbra_render::{Cascades, Fog, MapFilter, Time};
use antumbra_scene::{Light, LightKind, Scene};
use glam::DVec3;

use crate::area::Area;
use crate::lamps::Lamps;

/// Where shadows come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Technique {
    Baked,
    Maps,
    None,
}

/// How baked shadows are averaged over pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Averaging {
    None,
    Mean,
    Levels,
}

/// All choices of the panel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Settings {
    pub technique: Technique,
    /// Taps per side: odd, 1 to 17.
    pub taps: u32,
    pub kernel: Kernel,
    pub averaging: Averaging,
    /// Penumbrae of the sun, degrees of its diameter; 0 for none.
    pub penumbra_deg: f64,
    pub cascades: u32,
    pub is_clustered: bool,
    pub has_top_grid: bool,
    pub time: Option<Time>,
    pub samples: u32,
    /// Stops above or below what suits the picture.
    pub exposure_stops: f32,
    /// Extinction per metre; 0 for none.
    pub fog_per_m: f64,
    /// How much fog scatters forwards: Henyey and Greenstein's g.
    pub anisotropy: f64,
    /// Lights with a surface.
    pub area: Area,
    /// Lamps' shadow maps, and virtual lights.
    pub lamps: Lamps,
    /// Time of their videos, seconds.
    pub video_s: f64,
    /// Whether what is dynamic moves to and fro.
    pub is_moving: bool,
    /// Azimuth and elevation of the first directional light, degrees.
    pub sun_deg: [f64; 2],
}

impl Settings {
    pub fn new(scene: &Scene) -> Self {
        let sun = scene.lights.iter().find(|light| light.kind == LightKind::Directional);
        Self {
            technique: Technique::Baked,
            taps: 3,
            kernel: Kernel::Box,
            averaging: Averaging::None,
            penumbra_deg: 0.0,
            cascades: 4,
            is_clustered: false,
            has_top_grid: true,
            time: None,
            samples: 1,
            exposure_stops: 0.0,
            fog_per_m: 0.0,
            anisotropy: 0.5,
            area: Area::new(scene),
            lamps: Lamps::default(),
            video_s: 0.0,
            is_moving: false,
            sun_deg: sun.map_or([225.0, 45.0], |sun| angles(-sun.direction_world)),
        }
    }

    pub fn filter(&self) -> Filter {
        match self.kernel {
            Kernel::Continuous => Filter::continuous(),
            kernel => Filter::new(self.taps, kernel).unwrap_or_default(),
        }
    }

    /// How to look up shadows; `bake` is what the lights have, if anything.
    pub fn lookup(&self, bake: Option<&ShadowFile>) -> Lookup {
        match self.technique {
            Technique::None => Lookup::None,
            Technique::Maps => {
                let filter = if self.taps == 1 { MapFilter::Bilinear } else { MapFilter::Taps(self.filter()) };
                Lookup::Maps(Cascades { count: self.cascades, ..Cascades::default() }, filter)
            }
            Technique::Baked if bake.is_none() => Lookup::None,
            Technique::Baked if self.penumbra_deg > 0.0 && bake.is_some_and(ShadowFile::has_enter_depths) => {
                Lookup::Penumbra((0.5 * self.penumbra_deg.to_radians()).tan(), self.filter())
            }
            Technique::Baked => match self.averaging {
                Averaging::Mean => Lookup::Prefiltered(Prefilter::Mean),
                Averaging::Levels if bake.is_some_and(ShadowFile::has_levels) => {
                    Lookup::Prefiltered(Prefilter::Levels(self.filter()))
                }
                _ => Lookup::Filter(self.filter()),
            },
        }
    }

    pub fn fog(&self) -> Option<Fog> {
        (self.fog_per_m > 0.0).then_some(Fog { density_per_m: self.fog_per_m, anisotropy: self.anisotropy })
    }

    /// The scene's lights with the sun where it was dragged; a scene without one gets one.
    pub fn lights(&self, lights: &[Light]) -> Vec<Light> {
        let mut lights = lights.to_vec();
        let towards = direction(self.sun_deg);
        let sun = lights.iter_mut().find(|light| light.kind == LightKind::Directional);
        if let Some(sun) = sun {
            // One that was not dragged stays as it is to the bit.
            if towards.dot(-sun.direction_world) < 1.0 - 1e-12 {
                sun.direction_world = -towards;
            }
        } else if lights.is_empty() {
            lights.push(Light {
                name: "sun".to_owned(),
                kind: LightKind::Directional,
                position_world: DVec3::ZERO,
                direction_world: -towards,
                color: [1.0; 3],
                intensity: 100_000.0,
                range_m: None,
                dynamic: false,
            });
        }
        lights
    }
}

/// Azimuth clockwise from north (-Z) and elevation of a direction towards the sun, degrees.
pub(crate) fn angles(towards: DVec3) -> [f64; 2] {
    let azimuth = towards.x.atan2(-towards.z).to_degrees();
    [azimuth.rem_euclid(360.0), towards.y.clamp(-1.0, 1.0).asin().to_degrees()]
}

pub(crate) fn direction([azimuth, elevation]: [f64; 2]) -> DVec3 {
    let ((sin, cos), (sin_up, cos_up)) = (azimuth.to_radians().sin_cos(), elevation.to_radians().sin_cos());
    DVec3::new(cos_up * sin, sin_up, -cos_up * cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_and_directions_are_inverse() {
        for angle in [[0.0, 10.0], [225.0, 45.0], [359.0, 80.0]] {
            let back = angles(direction(angle));
            assert!((back[0] - angle[0]).abs() < 1e-9 && (back[1] - angle[1]).abs() < 1e-9, "{back:?}");
        }
    }

    #[test]
    fn a_sun_that_was_not_dragged_stays_to_the_bit() {
        let sun = Light {
            name: "s".to_owned(),
            kind: LightKind::Directional,
            position_world: DVec3::ZERO,
            direction_world: DVec3::new(0.3, -0.8, 0.1).normalize(),
            color: [1.0; 3],
            intensity: 1.0,
            range_m: None,
            dynamic: false,
        };
        let lights = [sun];
        let scene = Scene { lights: lights.to_vec(), ..Scene::default() };
        let mut settings = Settings::new(&scene);
        assert_eq!(settings.lights(&lights)[0].direction_world, lights[0].direction_world);
        settings.sun_deg[1] += 5.0;
        assert!(settings.lights(&lights)[0].direction_world.y < lights[0].direction_world.y);
        assert_eq!(settings.lights(&[]).len(), 1);
    }
}
