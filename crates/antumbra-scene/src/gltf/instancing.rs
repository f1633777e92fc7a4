//! EXT_mesh_gpu_instancing: one node that shows its mesh many times.

use glam::DAffine3;

use super::accessors::{Elements, Pick};
use super::nodes::{Placed, compose, from_trs};
use super::schema::Instancing;
use super::source::Source;
use crate::error::SceneError;

/// Where a node's mesh goes: once at the node, or once per instance.
pub(super) fn placements(source: &Source<'_>, place: &Placed<'_>) -> Result<Vec<DAffine3>, SceneError> {
    let Some(instancing) = &place.node.extensions.instancing else {
        return Ok(vec![place.world_from_node]);
    };
    let index = place.index;
    let translations = column::<3>(source, instancing, "TRANSLATION")?;
    let rotations = column::<4>(source, instancing, "ROTATION")?;
    let scales = column::<3>(source, instancing, "SCALE")?;
    let counts = [translations.as_ref().map(Vec::len), rotations.as_ref().map(Vec::len), scales.as_ref().map(Vec::len)];
    let count = counts.into_iter().flatten().max().unwrap_or(0);
    if counts.into_iter().flatten().any(|c| c != count) {
        return Err(SceneError::format(format!("the instances of node {index} have attributes of different lengths")));
    }
    let at = |column: &Option<Vec<[f64; 3]>>, i: usize| column.as_ref().map(|c| c[i]);
    (0..count)
        .map(|i| {
            let local = from_trs(at(&translations, i), rotations.as_ref().map(|r| r[i]), at(&scales, i));
            let local =
                local.ok_or_else(|| SceneError::format(format!("an instance of node {index} has no rotation")))?;
            compose(place.world_from_node, local, index)
        })
        .collect()
}

fn column<const N: usize>(
    source: &Source<'_>,
    instancing: &Instancing,
    name: &str,
) -> Result<Option<Vec<[f64; N]>>, SceneError> {
    let Some(&accessor) = instancing.attributes.get(name) else {
        return Ok(None);
    };
    let elements = Elements::open(source, accessor)?;
    source.spend(elements.count)?;
    let values = elements.floats::<N>(Pick::All)?;
    Ok(Some(values.into_iter().map(|v| v.map(f64::from)).collect()))
}
