//! Area lights of a scene, with what they show: pictures, or videos as sequences of frames.

use std::sync::Arc;

use antumbra_scene::Scene;

use super::{AreaLight, Emission};

/// An area light and the frames that it shows one after the other.
#[derive(Clone, Debug, PartialEq)]
pub struct Showing {
    /// The light, without a picture.
    pub light: AreaLight,
    /// What it shows; empty for plain light.
    pub frames: Vec<Arc<Emission>>,
    /// Frames that are shown in a second.
    pub frames_per_second: f64,
}

impl Showing {
    /// The area lights of a scene. Frames that are no pictures are left out.
    #[must_use]
    pub fn of_scene(scene: &Scene) -> Vec<Self> {
        let frame = |index: &usize| Emission::of_image(scene.images.get(*index)?).map(Arc::new);
        let showing = |light: &antumbra_scene::AreaLight| Self {
            light: AreaLight {
                shape: light.shape,
                position_world: light.position_world,
                direction_world: light.direction_world,
                up_world: light.up_world,
                luminance: light.luminance,
                emission: None,
            },
            frames: light.frames.iter().filter_map(frame).collect(),
            frames_per_second: light.frames_per_second,
        };
        scene.area_lights.iter().map(showing).collect()
    }

    /// The light at a time after its first frame: the last frame is followed by the first.
    #[must_use]
    pub fn at(&self, seconds: f64) -> AreaLight {
        let count = self.frames.len() as f64;
        let frame = (seconds.max(0.0) * self.frames_per_second).floor().rem_euclid(count.max(1.0));
        AreaLight { emission: self.frames.get(frame as usize).cloned(), ..self.light.clone() }
    }
}

#[cfg(test)]
mod tests {
    use antumbra_scene::{AreaShape, Image};
    use glam::{DVec2, DVec3};

    use super::*;

    #[test]
    fn videos_go_round() {
        let image = |gray| Image { name: String::new(), width: 1, height: 1, rgba: vec![gray, gray, gray, 255] };
        let light = antumbra_scene::AreaLight {
            name: "screen".to_owned(),
            shape: AreaShape::Disc { radius_m: 1.0 },
            position_world: DVec3::ZERO,
            direction_world: DVec3::NEG_Z,
            up_world: DVec3::Y,
            luminance: [300.0; 3],
            frames: vec![0, 1, 9],
            frames_per_second: 10.0,
        };
        let scene = Scene { images: vec![image(0), image(255)], area_lights: vec![light], ..Scene::default() };
        let showing = &Showing::of_scene(&scene)[0];
        let shown = |seconds| showing.at(seconds).emission.map_or(-1.0, |emission| emission.at(DVec2::ZERO).x);
        assert_eq!([0.0, 0.05, 0.1, 0.19, 0.2, 1e9].map(shown), [0.0, 0.0, 1.0, 1.0, 0.0, 0.0]);
        let plain = Showing { frames: Vec::new(), ..showing.clone() };
        assert!(plain.at(3.0).emission.is_none());
    }
}
