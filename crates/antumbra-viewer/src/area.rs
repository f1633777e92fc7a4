//! Choices about lights with a surface.

use antumbra_render::area::{
    Airlight, AreaLight, AreaLighting, AreaShape, AreaTechnique, Gathering, Interpolation, Showing, VoxelResolution,
};
use antumbra_scene::{Bounds, Camera, Scene};
use glam::{DVec2, DVec3, Vec3};

/// Lights with a surface, and how their shadows are found.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Area {
    pub is_on: bool,
    /// At least one. The first is the one that is changed.
    pub lights: Vec<Showing>,
    pub technique: AreaTechnique,
    pub vpls: u32,
    pub voxels: VoxelResolution,
    pub gathering: Gathering,
    pub airlight: Airlight,
    pub interpolation: Interpolation,
}

impl Area {
    /// The scene's own, or one over its middle, which is off.
    pub fn new(scene: &Scene) -> Self {
        let mut lights = Showing::of_scene(scene);
        let is_on = !lights.is_empty();
        if !is_on {
            lights.push(over(&scene.bounds(|_| true)));
        }
        let AreaLighting { technique, voxels, airlight, interpolation, .. } = AreaLighting::new(Vec::new());
        Self { is_on, lights, technique, vpls: 64, voxels, gathering: Gathering::Interleaved, airlight, interpolation }
    }

    /// The lights as they are at a time of their videos.
    pub fn lighting(&self, seconds: f64) -> Option<AreaLighting> {
        self.is_on.then(|| AreaLighting {
            technique: self.technique,
            vpls: self.vpls,
            voxels: VoxelResolution { points: self.voxels.map * self.voxels.map / 2, ..self.voxels },
            gathering: self.gathering,
            airlight: self.airlight,
            interpolation: self.interpolation,
            ..AreaLighting::new(self.lights.iter().map(|showing| showing.at(seconds)).collect())
        })
    }

    /// The light that is changed.
    pub fn light(&mut self) -> &mut AreaLight {
        &mut self.lights[0].light
    }

    /// Moves it along the picture: by pixels to the right and down, and by steps away from the eye.
    pub fn drag(&mut self, camera: &Camera, height: u32, pixels: DVec2, steps: f64) {
        let light = self.light();
        let away = light.position_world - camera.eye_world;
        let depth = away.dot(camera.forward_world).abs().max(1e-3);
        let per_pixel = 2.0 * depth * (0.5 * camera.fov_y).tan() / f64::from(height.max(1));
        let right = camera.forward_world.cross(camera.up_world);
        light.position_world += (right * pixels.x - camera.up_world * pixels.y) * per_pixel;
        light.position_world += camera.forward_world * (0.05 * depth * steps);
    }

    /// Shines towards a place, its picture upright.
    pub fn aim(&mut self, target: DVec3) -> Result<(), String> {
        let light = self.light();
        let turned = AreaLight::towards(light.shape, light.position_world, target, light.luminance);
        let turned = turned.map_err(|error| error.to_string())?;
        (light.direction_world, light.up_world) = (turned.direction_world, turned.up_world);
        Ok(())
    }

    /// Shines along an azimuth and an elevation, degrees.
    pub fn turn(&mut self, [azimuth, elevation]: [f64; 2]) {
        let direction = crate::settings::direction([azimuth, elevation.clamp(-89.9, 89.9)]);
        let at = self.light().position_world;
        // It never points at itself.
        let _ = self.aim(at + direction);
    }

    /// Width and height, or the diameter of what is round, metres.
    pub fn size_m(&mut self) -> DVec2 {
        match self.light().shape {
            AreaShape::Rectangle { width_m, height_m } => DVec2::new(width_m, height_m),
            AreaShape::Disc { radius_m } | AreaShape::Sphere { radius_m } => DVec2::splat(2.0 * radius_m),
            AreaShape::Environment => DVec2::ONE,
        }
    }

    /// Changes what it is: `rectangle`, `disc`, `sphere` or `environment`, of a size.
    pub fn reshape(&mut self, name: &str, size_m: DVec2) -> Result<(), String> {
        let radius_m = 0.5 * size_m.x;
        self.light().shape = match name {
            "rectangle" => AreaShape::Rectangle { width_m: size_m.x, height_m: size_m.y },
            "disc" => AreaShape::Disc { radius_m },
            "sphere" => AreaShape::Sphere { radius_m },
            "environment" => AreaShape::Environment,
            _ => return Err(format!("`{name}` is not one of: rectangle, disc, sphere, environment")),
        };
        Ok(())
    }

    /// The name of what it is.
    pub fn shape_name(&mut self) -> &'static str {
        match self.light().shape {
            AreaShape::Rectangle { .. } => "rectangle",
            AreaShape::Disc { .. } => "disc",
            AreaShape::Sphere { .. } => "sphere",
            AreaShape::Environment => "environment",
        }
    }

    /// Its brightest channel's luminance, candela per square metre, and its colour beside that.
    pub fn luminance(&mut self) -> (f32, Vec3) {
        let luminance = Vec3::from(self.light().luminance);
        let brightest = luminance.max_element();
        (brightest, if brightest > 0.0 { luminance / brightest } else { Vec3::ONE })
    }
}

/// A light over the middle of a scene.
fn over(bounds: &Bounds) -> Showing {
    let size = bounds.diagonal().max(1e-3);
    let middle = if bounds.is_empty() { DVec3::ZERO } else { bounds.center() };
    let light = AreaLight {
        shape: AreaShape::Rectangle { width_m: 0.08 * size, height_m: 0.045 * size },
        position_world: middle + DVec3::Y * (0.25 * size),
        direction_world: DVec3::NEG_Y,
        up_world: DVec3::NEG_Z,
        luminance: [3000.0; 3],
        emission: None,
    };
    Showing { light, frames: Vec::new(), frames_per_second: 25.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_light_follows_the_pointer() {
        let mut area = Area::new(&Scene::default());
        let camera = antumbra_render::look_at(DVec3::new(0.0, 0.0, 10.0), DVec3::ZERO, 1.0).expect("a camera");
        area.light().position_world = DVec3::ZERO;
        // From the middle of the picture to its upper edge.
        area.drag(&camera, 100, DVec2::new(0.0, -50.0), 0.0);
        assert!(area.light().position_world.distance(DVec3::Y * 10.0 * 0.5_f64.tan()) < 1e-9);
        area.drag(&camera, 100, DVec2::ZERO, 1.0);
        assert!(area.light().position_world.z < -0.4);
        area.aim(DVec3::ZERO).expect("somewhere else");
        assert!(area.light().direction_world.y < -0.9);
        area.turn([90.0, 0.0]);
        assert!(area.light().direction_world.abs_diff_eq(DVec3::X, 1e-9));
        area.reshape("sphere", DVec2::splat(3.0)).expect("a shape");
        assert_eq!((area.shape_name(), area.size_m()), ("sphere", DVec2::splat(3.0)));
        assert!(area.reshape("cube", DVec2::ONE).is_err() && area.lighting(0.0).is_none());
    }
}
