//! Arguments of lamps' shadow maps and of virtual lights.

use antumbra::Filter;
use antumbra_render::light::{LightTracing, VirtualLight};
use antumbra_render::{LampMaps, MapProjection, Renderer};
use clap::ValueEnum;

use antumbra_render::area::AreaLighting;

/// Shadow maps of lamps, and light that surfaces send on.
#[derive(clap::Args, Clone, Debug)]
pub struct LampMapArgs {
    /// Draw shadow maps of the spot and point lights that no bake holds, and over a bake of what moves
    #[arg(long, value_enum, value_name = "HOW")]
    lamp_maps: Option<Projection>,
    /// Texels per side of each side of them, 64 to 4096; less for lamps far away
    #[arg(long, value_name = "N", default_value_t = 512, value_parser = clap::value_parser!(u32).range(64..=4096))]
    lamp_map_size: u32,
    /// About so many points of light that stand for what surfaces send on of the lamps' light: 1 to 4096. Shadowed by rays, or
    /// by --lamp-maps
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096), conflicts_with = "day")]
    virtual_lights: Option<u32>,
    /// Most surfaces by way of which their light comes, 1 to 16
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=16))]
    bounces: u32,
}

/// `--lamp-maps`.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Projection {
    /// Six sides of a cube
    Cube,
    /// Two paraboloids
    Paraboloid,
}

impl Projection {
    /// As the renderer knows it.
    pub fn projection(self) -> MapProjection {
        match self {
            Self::Cube => MapProjection::Cube,
            Self::Paraboloid => MapProjection::Paraboloid,
        }
    }
}

impl LampMapArgs {
    /// How the maps are drawn, if there are to be any: in any case for virtual lights where no rays are traced.
    pub fn maps(&self, filter: Filter, by_rays: bool) -> Option<LampMaps> {
        let for_virtual = (!by_rays && self.virtual_lights.is_some()).then_some(Projection::Cube);
        let projection = self.lamp_maps.or(for_virtual)?.projection();
        Some(LampMaps { projection, size: self.lamp_map_size, filter, ..LampMaps::default() })
    }

    /// Whether there are to be virtual lights.
    pub fn has_virtual_lights(&self) -> bool {
        self.virtual_lights.is_some()
    }

    /// The virtual lights of a scene.
    pub fn virtual_lights(&self, renderer: &Renderer<'_>, area: Option<&AreaLighting>) -> Vec<VirtualLight> {
        let Some(lights) = self.virtual_lights else { return Vec::new() };
        let how = LightTracing { lights, bounces: self.bounces };
        renderer.virtual_lights(&how, area.map_or(&[], |area| &area.lights))
    }
}
