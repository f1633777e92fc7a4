//! Skinned meshes in their rest pose.
//!
//! A skin takes each vertex by its joints and leaves the node's own transform aside. In the pose that a mesh was bound in,
//! all joints move it alike, so that one of them says where it stands; bent limbs are not followed.

use glam::DAffine3;

use super::accessors::{Elements, Pick};
use super::nodes::{Placed, compose, from_matrix};
use super::schema::item;
use super::source::Source;
use crate::error::SceneError;

/// Where a skinned mesh stands, or `None` where nothing but the node says so.
pub(super) fn world_from_skinned(
    source: &Source<'_>,
    placed: &[Placed<'_>],
    skin: Option<usize>,
) -> Result<Option<DAffine3>, SceneError> {
    let Some(skin) = skin else { return Ok(None) };
    let skin = item(&source.root.skins, skin, "skin")?;
    let joint = skin.joints.first().and_then(|&joint| placed.binary_search_by_key(&joint, |p| p.index).ok());
    let Some(joint) = joint.map(|at| &placed[at]) else { return Ok(None) };
    let Some(matrices) = skin.inverse_bind_matrices else { return Ok(Some(joint.world_from_node)) };
    let matrices = Elements::open(source, matrices)?;
    if matrices.count == 0 {
        return Ok(None);
    }
    let [matrix] = matrices.floats::<16>(Pick::These(&[0]))?[..] else { return Ok(None) };
    let joint_from_mesh = from_matrix(&matrix.map(f64::from), joint.index)?;
    compose(joint.world_from_node, joint_from_mesh, joint.index).map(Some)
}
