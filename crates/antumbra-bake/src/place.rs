//! Joins casters and light space: fits a light's grid to the casters and puts them on its lattice.

use glam::DVec3;

use crate::bake::{BakeError, ResolutionRequest};
use crate::casters::Casters;
use crate::light_space::{DirectionalSpace, LatticeTriangle, Resolution};

/// Corners farther out than this are taken for a mistake: squares of such lengths still fit an `f64`.
const FARTHEST_M: f64 = 1e100;

/// The grid of a directional light about the casters.
///
/// # Errors
/// [`BakeError::TexelSize`] if no resolution has such small texels, [`BakeError::Misplaced`] if a corner is not finite.
pub fn fit_directional(
    casters: &Casters<'_>,
    direction_world: DVec3,
    request: ResolutionRequest,
) -> Result<DirectionalSpace, BakeError> {
    let axes = DirectionalSpace::axes(direction_world);
    let mut origin = None;
    let mut extent = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let mut misplaced = None;
    casters.for_each(|t| {
        if t.corners.iter().any(|c| c.abs().max_element() > FARTHEST_M || c.is_nan()) {
            misplaced.get_or_insert(t.node);
            return;
        }
        let origin = *origin.get_or_insert(t.corners[0]);
        let [min, max] = DirectionalSpace::extent(&axes, origin, t.corners.into_iter());
        extent = [extent[0].min(min), extent[1].max(max)];
    });
    if let Some(node) = misplaced {
        return Err(BakeError::Misplaced(casters.scene().nodes[node].name.clone()));
    }
    let side_m = DirectionalSpace::side_m(extent);
    let resolution = match request {
        ResolutionRequest::Default => Resolution::DEFAULT_DIRECTIONAL,
        ResolutionRequest::Texels(resolution) => resolution,
        ResolutionRequest::TexelSize(texel_m) => Resolution::for_texel_size(side_m, texel_m).ok_or_else(|| {
            let least_m = side_m / f64::from(Resolution::MAX.texels());
            BakeError::TexelSize { texel_m, extent_m: side_m, least_m }
        })?,
    };
    Ok(DirectionalSpace::fit(axes, origin.unwrap_or_default(), extent, resolution))
}

/// Calls `each` with every caster on the light's lattice and its node, in the scene's order.
pub fn for_each_placed(casters: &Casters<'_>, space: &DirectionalSpace, mut each: impl FnMut(&LatticeTriangle, usize)) {
    casters.for_each(|t| {
        let corners = t.corners.map(|c| space.snap(c));
        let triangle = LatticeTriangle {
            x: corners.map(|c| c.0[0]),
            y: corners.map(|c| c.0[1]),
            z: corners.map(|c| c.1),
            solid: t.solid,
        };
        each(&triangle, t.node);
    });
}
