//! The node hierarchy, flattened: where every node that the scene shows is in the world.

use glam::{DAffine3, DMat3, DQuat, DVec3, DVec4};

use super::schema::{self, Root, item};
use crate::error::SceneError;

/// Deeper hierarchies are mistakes.
const MAX_DEPTH: usize = 4096;
/// Larger transforms would overflow once applied to the largest `f32` positions and squared.
const MAX_ELEMENT: f64 = 1e100;

/// A node that the scene shows.
pub(super) struct Placed<'a> {
    pub index: usize,
    pub node: &'a schema::Node,
    pub name: String,
    pub world_from_node: DAffine3,
    /// Marked in extras, here or further up.
    pub dynamic: bool,
}

/// All nodes that the default scene shows, in the file's order (so by index). KHR_node_visibility hides whole branches.
pub(super) fn place(root: &Root) -> Result<Vec<Placed<'_>>, SceneError> {
    let mut placed: Vec<Option<Placed<'_>>> = root.nodes.iter().map(|_| None).collect();
    let mut open: Vec<Visit> = scene_roots(root)?.into_iter().map(Visit::root).collect();
    while let Some(visit) = open.pop() {
        let node = item(&root.nodes, visit.index, "node")?;
        let slot = &mut placed[visit.index];
        if slot.is_some() {
            return Err(SceneError::format(format!("its nodes are no tree: node {} is reached twice", visit.index)));
        }
        if visit.depth > MAX_DEPTH {
            return Err(SceneError::limit(format!("its nodes are nested deeper than {MAX_DEPTH}")));
        }
        if node.extensions.visibility.as_ref().is_some_and(|v| v.visible == Some(false)) {
            continue;
        }
        let world_from_node = compose(visit.world_from_parent, local_transform(node, visit.index)?, visit.index)?;
        let dynamic = visit.dynamic || is_dynamic(node);
        open.extend(node.children.iter().map(|&child| Visit {
            index: child,
            depth: visit.depth + 1,
            world_from_parent: world_from_node,
            dynamic,
        }));
        let name = node.name.clone().unwrap_or_else(|| format!("node{}", visit.index));
        *slot = Some(Placed { index: visit.index, node, name, world_from_node, dynamic });
    }
    Ok(placed.into_iter().flatten().collect())
}

/// A node yet to be placed.
struct Visit {
    index: usize,
    depth: usize,
    world_from_parent: DAffine3,
    dynamic: bool,
}

impl Visit {
    fn root(index: usize) -> Self {
        Self { index, depth: 0, world_from_parent: DAffine3::IDENTITY, dynamic: false }
    }
}

/// The default scene's nodes; without scenes, all nodes that are nobody's child.
fn scene_roots(root: &Root) -> Result<Vec<usize>, SceneError> {
    if root.scene.is_some() || !root.scenes.is_empty() {
        return Ok(item(&root.scenes, root.scene.unwrap_or(0), "scene")?.nodes.clone());
    }
    let mut is_child = vec![false; root.nodes.len()];
    for &child in root.nodes.iter().flat_map(|n| &n.children) {
        item(&root.nodes, child, "node")?;
        is_child[child] = true;
    }
    let roots: Vec<usize> = (0..root.nodes.len()).filter(|&i| !is_child[i]).collect();
    if roots.is_empty() && !root.nodes.is_empty() {
        return Err(SceneError::format("its nodes are no tree: each is another's child"));
    }
    Ok(roots)
}

fn is_dynamic(node: &schema::Node) -> bool {
    node.extras.get("antumbra").and_then(|v| v.as_str()) == Some("dynamic")
}

fn local_transform(node: &schema::Node, index: usize) -> Result<DAffine3, SceneError> {
    match &node.matrix {
        Some(matrix) => from_matrix(matrix, index),
        None => from_trs(node.translation, node.rotation, node.scale)
            .ok_or_else(|| SceneError::format(format!("the rotation of node {index} is no quaternion"))),
    }
}

/// A transform from glTF's 16 numbers, column by column; `index` is the node it is about.
pub(super) fn from_matrix(m: &[f64; 16], index: usize) -> Result<DAffine3, SceneError> {
    let column = |c: usize| DVec3::new(m[4 * c], m[4 * c + 1], m[4 * c + 2]);
    let last_row = DVec4::new(m[3], m[7], m[11], m[15]);
    // Exporters that invert matrices leave rounding behind.
    if !last_row.abs_diff_eq(DVec4::W, 1e-4) {
        return Err(SceneError::format(format!("the matrix of node {index} is not affine")));
    }
    Ok(DAffine3 { matrix3: DMat3::from_cols(column(0), column(1), column(2)), translation: column(3) })
}

/// A transform from glTF's translation, rotation (xyzw) and scale; `None` where the rotation has no direction.
pub(super) fn from_trs(
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
) -> Option<DAffine3> {
    let rotation = DVec4::from_array(rotation.unwrap_or([0.0, 0.0, 0.0, 1.0])).try_normalize()?;
    Some(DAffine3::from_scale_rotation_translation(
        scale.map_or(DVec3::ONE, DVec3::from_array),
        DQuat::from_vec4(rotation),
        translation.map_or(DVec3::ZERO, DVec3::from_array),
    ))
}

/// Parent times child, refused where it leaves the range in which world positions can be computed.
pub(super) fn compose(parent: DAffine3, child: DAffine3, index: usize) -> Result<DAffine3, SceneError> {
    // Kept exact where nothing is above.
    let product = if parent == DAffine3::IDENTITY { child } else { parent * child };
    if product.to_cols_array().iter().all(|v| v.abs() <= MAX_ELEMENT) {
        Ok(product)
    } else {
        Err(SceneError::format(format!("the transform of node {index} is not finite or absurdly large")))
    }
}
