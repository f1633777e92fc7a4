//! What the user can choose of lamps' shadow maps and of virtual lights.

use antumbra::Filter;
use antumbra_render::{Culling, LampMaps, MapProjection, Marking};

/// Choices of the panel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Lamps {
    /// Whether lamps that no bake holds, and what moves in the light of others, have shadow maps.
    pub is_on: bool,
    pub projection: MapProjection,
    /// Texels per side.
    pub size: u32,
    pub culling: Culling,
    /// Cells along each axis.
    pub grid: u32,
    /// Points of light that stand for what surfaces send on; 0 for none.
    pub virtual_lights: u32,
}

/// Ways to cull that the panel offers, with their names.
pub(crate) const CULLINGS: [(Culling, &str); 3] =
    [(Culling::Voxels(Marking::Sides), "voxels"), (Culling::Frusta, "frusta"), (Culling::None, "none")];

impl Default for Lamps {
    fn default() -> Self {
        let LampMaps { projection, size, culling, grid, .. } = LampMaps::default();
        Self { is_on: true, projection, size, culling, grid, virtual_lights: 0 }
    }
}

impl Lamps {
    /// How the renderer draws them.
    pub fn maps(&self, filter: Filter) -> Option<LampMaps> {
        let Self { projection, size, culling, grid, .. } = *self;
        self.is_on.then(|| LampMaps { projection, size, culling, grid, filter, ..LampMaps::default() })
    }

    /// Changes a setting by a script's words; `None` for a key of another kind.
    pub fn set(
        &mut self,
        key: &str,
        value: &str,
        within: impl Fn(f64, f64) -> Result<f64, String>,
    ) -> Option<Result<(), String>> {
        let one_of = |known: &str| Err(format!("`{value}` is not one of: {known}"));
        let whole = |low, high| within(low, high).map(|number| number as u32);
        Some(match key {
            "lamp-maps" => {
                let projection = match value {
                    "off" => None,
                    "cube" => Some(MapProjection::Cube),
                    "paraboloid" => Some(MapProjection::Paraboloid),
                    _ => return Some(one_of("cube, paraboloid, off")),
                };
                self.is_on = projection.is_some();
                self.projection = projection.unwrap_or(self.projection);
                Ok(())
            }
            "culling" => match CULLINGS.iter().find(|(_, name)| *name == value) {
                Some((culling, _)) => {
                    self.culling = *culling;
                    Ok(())
                }
                None => one_of("voxels, frusta, none"),
            },
            "map-size" => whole(64.0, 4096.0).map(|size| self.size = size),
            "grid" => whole(8.0, 128.0).map(|grid| self.grid = grid),
            "virtual-lights" => whole(0.0, 4096.0).map(|lights| self.virtual_lights = lights),
            _ => return None,
        })
    }
}
