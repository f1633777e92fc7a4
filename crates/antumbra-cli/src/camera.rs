//! Arguments of a camera.

use std::path::Path;

use antumbra_render::{default_camera, look_at};
use antumbra_scene::{Camera, Scene};
use anyhow::{Context, Result};
use glam::DVec3;

use crate::{args, inputs};

/// Where a picture is seen from.
#[derive(clap::Args, Clone, Debug)]
pub struct CameraArgs {
    /// A camera of the scene [default: its first, or one that sees everything]
    #[arg(long, value_name = "NAME")]
    camera: Option<String>,
    /// Instead of --camera: where the eye is, metres
    #[arg(long, value_name = "X,Y,Z", value_parser = args::parse_point, allow_hyphen_values = true, requires = "target", conflicts_with = "camera")]
    eye: Option<DVec3>,
    /// What the eye looks at, metres
    #[arg(long, value_name = "X,Y,Z", value_parser = args::parse_point, allow_hyphen_values = true, requires = "eye")]
    target: Option<DVec3>,
    /// Vertical field of view of --eye, degrees
    #[arg(long, value_name = "DEG", default_value_t = 45.0, requires = "eye")]
    fov: f64,
}

impl CameraArgs {
    /// The camera that they describe, of a scene that was read from a file.
    pub fn camera(&self, scene: &Scene, path: &Path) -> Result<Camera> {
        if let (Some(eye), Some(target)) = (self.eye, self.target) {
            return look_at(eye, target, self.fov.to_radians()).context("--eye and --target make no camera");
        }
        let Some(name) = &self.camera else {
            return scene.cameras.first().map_or_else(|| Ok(default_camera(scene)?), |camera| Ok(camera.clone()));
        };
        scene.cameras.iter().find(|camera| camera.name == *name).cloned().with_context(|| {
            let names = inputs::listed(scene.cameras.iter().map(|camera| camera.name.as_str()));
            format!("{} has no camera \"{name}\"; it has: {names}", path.display())
        })
    }
}
