//! Arguments of area lights.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use antumbra_render::area::{
    Airlight, AreaLight, AreaLighting, AreaShape, AreaTechnique, Emission, Gathering, Showing, VoxelResolution,
};
use antumbra_scene::Scene;
use anyhow::{Context, Result};
use clap::ValueEnum;
use glam::DVec3;

use crate::{args, inputs};

/// Lights with a surface.
#[derive(clap::Args, Clone, Debug)]
pub struct LightArgs {
    /// A light with a surface, which casts soft shadows, in --fog too: rectangle=WIDTH,HEIGHT, disc=RADIUS, sphere=RADIUS
    /// (metres), or environment [default: those of the scene, if it has any, at night]
    #[arg(long, value_name = "SHAPE", value_parser = parse_shape, requires = "light_at")]
    area_light: Option<AreaShape>,
    /// Where its middle is, metres
    #[arg(long, value_name = "X,Y,Z", value_parser = args::parse_point, allow_hyphen_values = true, requires = "area_light")]
    light_at: Option<DVec3>,
    /// What it shines towards [default: straight down from where it is]
    #[arg(long, value_name = "X,Y,Z", value_parser = args::parse_point, allow_hyphen_values = true, requires = "area_light")]
    light_towards: Option<DVec3>,
    /// Its luminance, candela per square metre; a television has 300
    #[arg(long, value_name = "CD", default_value_t = 300.0)]
    luminance: f32,
    /// Its colour, linear; multiplied by the picture
    #[arg(long, value_name = "R,G,B", value_parser = args::parse_point, default_value = "1,1,1")]
    light_color: DVec3,
    /// A picture that it shows: PNG, JPEG, WebP or HDR
    #[arg(long, value_name = "FILE", requires = "area_light")]
    light_image: Option<PathBuf>,
    /// Time at which the scene's lights show a frame of their videos, seconds
    #[arg(long, value_name = "SECONDS", default_value_t = 0.0, conflicts_with = "area_light")]
    video_time: f64,
}

/// Lights with a surface, and how their shadows are found.
#[derive(clap::Args, Clone, Debug)]
pub struct AreaArgs {
    #[command(flatten)]
    light: LightArgs,
    /// How its shadows are found
    #[arg(long, value_enum, value_name = "HOW", default_value_t = Shadows::Voxels)]
    area_shadows: Shadows,
    /// Points of light that stand for its surface, 1 to 1024; rays per sample with --area-shadows traced
    #[arg(long, value_name = "N", default_value_t = 256, value_parser = clap::value_parser!(u32).range(1..=1024))]
    vpls: u32,
    /// Samples of their shadows along each axis, 32 to 512
    #[arg(long, value_name = "N", default_value_t = 128, value_parser = parse_voxels)]
    voxels: u32,
    /// Which pixels gather the light of which of those points
    #[arg(long, value_enum, value_name = "HOW", default_value_t = GatheringArg::Full)]
    area_gather: GatheringArg,
    /// Memory for their shadows at a time, MB: more of them come in batches
    #[arg(long, value_name = "MB", default_value_t = 128, value_parser = clap::value_parser!(u64).range(1..=65536))]
    area_memory: u64,
    /// How the light in fog is integrated
    #[arg(long, value_enum, value_name = "HOW", default_value_t = AirlightArg::Exact)]
    airlight: AirlightArg,
}

/// `--area-shadows`.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shadows {
    /// Imperfect voxelized shadow volumes
    Voxels,
    /// The same, one point of light after the other: slow, for comparison
    OneByOne,
    /// Shadow maps through which view rays march: for comparison
    Maps,
    /// Rays: the truth, but for noise
    Traced,
    /// There are none
    None,
}

/// `--area-gather`.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum GatheringArg {
    /// All of all
    Full,
    /// Each of 3 x 3 pixels a ninth, then shared among them
    Interleaved,
    /// One of 2 x 2 pixels, then those beside it take over
    Half,
}

/// `--airlight`.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum AirlightArg {
    /// Exactly, over each lit stretch of a view ray
    Exact,
    /// All of it times the share of the ray that is lit
    Average,
}

fn parse_shape(text: &str) -> Result<AreaShape, String> {
    let size = |text| args::parse_metres(text);
    match text.split_once('=') {
        None if text == "environment" => Ok(AreaShape::Environment),
        Some(("rectangle", sides)) => {
            let (width, height) = sides.split_once(',').unwrap_or((sides, sides));
            Ok(AreaShape::Rectangle { width_m: size(width)?, height_m: size(height)? })
        }
        Some(("disc", radius)) => Ok(AreaShape::Disc { radius_m: size(radius)? }),
        Some(("sphere", radius)) => Ok(AreaShape::Sphere { radius_m: size(radius)? }),
        _ => Err("it must be rectangle=WIDTH,HEIGHT, disc=RADIUS, sphere=RADIUS or environment".to_owned()),
    }
}

pub fn parse_voxels(text: &str) -> Result<u32, String> {
    let side = text.parse().ok().filter(|side: &u32| (32..=512).contains(side) && side.is_multiple_of(32));
    side.ok_or_else(|| "it must be a multiple of 32 from 32 to 512".to_owned())
}

impl LightArgs {
    /// The light that they describe; without one, those of the scene.
    pub fn lights(&self, scene: &Scene) -> Result<Vec<AreaLight>> {
        Ok(match self.light()? {
            Some(light) => vec![light],
            None => Showing::of_scene(scene).iter().map(|showing| showing.at(self.video_time)).collect(),
        })
    }

    fn light(&self) -> Result<Option<AreaLight>> {
        let (Some(shape), Some(at)) = (self.area_light, self.light_at) else { return Ok(None) };
        let towards = self.light_towards.unwrap_or(at - DVec3::Y);
        let luminance = (self.light_color * f64::from(self.luminance)).as_vec3().to_array();
        let mut light = AreaLight::towards(shape, at, towards, luminance)?;
        light.emission = self.light_image.as_deref().map(emission).transpose()?;
        Ok(Some(light))
    }
}

impl AreaArgs {
    /// The lights, those of the scene if none is described, with their shadows found as wished.
    pub fn lighting(&self, scene: &Scene) -> Result<Option<AreaLighting>> {
        let lights = self.light.lights(scene)?;
        Ok((!lights.is_empty()).then(|| self.of(lights)))
    }

    fn of(&self, lights: Vec<AreaLight>) -> AreaLighting {
        AreaLighting {
            technique: match self.area_shadows {
                Shadows::Voxels => AreaTechnique::Voxels,
                Shadows::OneByOne => AreaTechnique::OneByOne,
                Shadows::Maps => AreaTechnique::MarchedMaps,
                Shadows::Traced => AreaTechnique::Traced,
                Shadows::None => AreaTechnique::None,
            },
            vpls: self.vpls,
            voxels: VoxelResolution::cube(self.voxels),
            gathering: match self.area_gather {
                GatheringArg::Full => Gathering::Full,
                GatheringArg::Interleaved => Gathering::Interleaved,
                GatheringArg::Half => Gathering::Half,
            },
            budget_bytes: self.area_memory << 20,
            airlight: match self.airlight {
                AirlightArg::Exact => Airlight::Exact,
                AirlightArg::Average => Airlight::Average,
            },
            ..AreaLighting::new(lights)
        }
    }
}

fn emission(path: &Path) -> Result<Arc<Emission>> {
    let bytes = inputs::file(path)?;
    let empty = || format!("{} is empty", path.display());
    if let Ok(image::ImageFormat::Hdr) = image::guess_format(&bytes) {
        let wrong = || format!("{} is no HDR picture that can be read", path.display());
        let linear = image::load_from_memory(&bytes).with_context(wrong)?.into_rgb32f();
        let (width, height) = linear.dimensions();
        let texels: Vec<[f32; 3]> = linear.pixels().map(|pixel| pixel.0).collect();
        return Ok(Arc::new(Emission::of_linear(width, height, &texels).with_context(empty)?));
    }
    let image = antumbra_scene::decode_image(&path.display().to_string(), &bytes)?;
    Ok(Arc::new(Emission::of_image(&image).with_context(empty)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes() {
        let rectangle = |width_m, height_m| Ok(AreaShape::Rectangle { width_m, height_m });
        assert_eq!(parse_shape("rectangle=2,1.5"), rectangle(2.0, 1.5));
        assert_eq!(parse_shape("rectangle=2"), rectangle(2.0, 2.0));
        assert_eq!(parse_shape("sphere=0.1"), Ok(AreaShape::Sphere { radius_m: 0.1 }));
        assert_eq!(parse_shape("environment"), Ok(AreaShape::Environment));
        assert!(["disc", "disc=0", "disc=-1", "rectangle=1,x", "cube=1", ""].iter().all(|t| parse_shape(t).is_err()));
        assert!(["31", "100", "1024", "x"].iter().all(|text| parse_voxels(text).is_err()));
    }
}
