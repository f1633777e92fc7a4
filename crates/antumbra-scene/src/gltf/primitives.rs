//! Meshes: vertex attributes and triangles of each primitive.

use std::collections::BTreeMap;

use super::accessors::{Elements, Pick};
use super::schema;
use super::source::Source;
use crate::error::SceneError;
use crate::model::{Dropped, Mesh, Primitive};

/// glTF's primitive modes that have triangles. Points and lines cast no shadow.
#[derive(Clone, Copy)]
enum Mode {
    Triangles,
    Strip,
    Fan,
}

/// Reads a mesh; `texcoord_set` says which set of texture coordinates a material uses.
pub(super) fn read_mesh(
    source: &Source<'_>,
    mesh: &schema::Mesh,
    texcoord_set: impl Fn(Option<usize>) -> Result<usize, SceneError>,
    dropped: &mut Dropped,
) -> Result<Mesh, SceneError> {
    let mut primitives = Vec::with_capacity(mesh.primitives.len());
    for primitive in &mesh.primitives {
        let mode = match primitive.mode.unwrap_or(4) {
            0..=3 => continue,
            4 => Mode::Triangles,
            5 => Mode::Strip,
            6 => Mode::Fan,
            other => return Err(SceneError::format(format!("a primitive has the unknown mode {other}"))),
        };
        let set = texcoord_set(primitive.material)?;
        primitives.extend(read_primitive(source, primitive, mode, set, dropped)?);
    }
    Ok(Mesh { name: mesh.name.clone().unwrap_or_default(), primitives })
}

fn read_primitive(
    source: &Source<'_>,
    primitive: &schema::Primitive,
    mode: Mode,
    texcoord_set: usize,
    dropped: &mut Dropped,
) -> Result<Option<Primitive>, SceneError> {
    let Some(&position) = primitive.attributes.get("POSITION") else {
        return Ok(None);
    };
    let positions = Elements::open(source, position)?;
    let mut corners = read_corners(source, primitive.indices, positions.count)?;
    let used = compact(&mut corners, positions.count);
    let pick = used.as_deref().map_or(Pick::All, Pick::These);
    let vertices = Vertices { source, attributes: &primitive.attributes, count: positions.count, pick };

    source.spend(used.as_ref().map_or(positions.count, Vec::len))?;
    let mut out = Primitive {
        positions: positions.floats(pick)?,
        normals: vertices.optional("NORMAL")?,
        texcoords: vertices.optional(&format!("TEXCOORD_{texcoord_set}"))?,
        colors: vertices.colors()?,
        material: primitive.material,
        ..Primitive::default()
    };
    out.set_triangles(assemble(mode, &corners, dropped), dropped);
    Ok(if out.triangles.is_empty() && out.seams.is_empty() { None } else { Some(out) })
}

/// The primitive's corners in order: its indices, or all vertices.
fn read_corners(source: &Source<'_>, indices: Option<usize>, vertices: usize) -> Result<Vec<u32>, SceneError> {
    match indices {
        Some(accessor) => {
            let elements = Elements::open(source, accessor)?;
            source.spend(elements.count)?;
            elements.indices()
        }
        None => {
            source.spend(vertices)?;
            Ok((0..u32::try_from(vertices).unwrap_or(u32::MAX)).collect())
        }
    }
}

/// Where many primitives share one large vertex buffer, keeps only the vertices that this one uses.
///
/// Returns them, and renumbers the corners to match.
fn compact(corners: &mut [u32], vertices: usize) -> Option<Vec<u32>> {
    if corners.len() >= vertices {
        return None;
    }
    let mut used: Vec<u32> = corners.iter().copied().filter(|&i| (i as usize) < vertices).collect();
    used.sort_unstable();
    used.dedup();
    for corner in corners {
        // A bad index stays bad.
        *corner = used.binary_search(corner).map_or(u32::MAX, |i| u32::try_from(i).unwrap_or(u32::MAX));
    }
    Some(used)
}

/// Turns corners into triangles, all wound as the first.
fn assemble<'c>(mode: Mode, corners: &'c [u32], dropped: &mut Dropped) -> Box<dyn Iterator<Item = [u32; 3]> + 'c> {
    match mode {
        Mode::Triangles => {
            let (triangles, rest) = corners.as_chunks::<3>();
            dropped.bad_index += u64::from(!rest.is_empty());
            Box::new(triangles.iter().copied())
        }
        Mode::Strip => Box::new(corners.windows(3).enumerate().map(|(i, w)| match i % 2 {
            0 => [w[0], w[1], w[2]],
            _ => [w[0], w[2], w[1]],
        })),
        Mode::Fan => Box::new(corners.windows(2).skip(1).map(|w| [w[0], w[1], corners[0]])),
    }
}

/// The attributes of one primitive.
struct Vertices<'v, 's> {
    source: &'v Source<'s>,
    attributes: &'v BTreeMap<String, usize>,
    count: usize,
    pick: Pick<'v>,
}

impl<'v> Vertices<'v, '_> {
    fn open(&self, name: &str) -> Result<Option<Elements<'v>>, SceneError> {
        let Some(&accessor) = self.attributes.get(name) else {
            return Ok(None);
        };
        let elements = Elements::open(self.source, accessor)?;
        if elements.count != self.count {
            return Err(SceneError::format(format!(
                "a primitive has {} positions, but {} of {name}",
                self.count, elements.count
            )));
        }
        Ok(Some(elements))
    }

    fn optional<const N: usize>(&self, name: &str) -> Result<Vec<[f32; N]>, SceneError> {
        self.open(name)?.map_or(Ok(Vec::new()), |elements| Ok(finite(elements.floats(self.pick)?)))
    }

    /// Colours come with or without alpha, and as integers always stand for 0..1.
    fn colors(&self) -> Result<Vec<[f32; 4]>, SceneError> {
        let Some(elements) = self.open("COLOR_0")? else {
            return Ok(Vec::new());
        };
        Ok(finite(if elements.width == 3 {
            let rgb = elements.floats_as::<3>(self.pick, true)?;
            rgb.into_iter().map(|[r, g, b]| [r, g, b, 1.0]).collect()
        } else {
            elements.floats_as(self.pick, true)?
        }))
    }
}

/// Zeroes what is not a number: a broken normal or texture coordinate should not cost a triangle its shadow.
fn finite<const N: usize>(mut values: Vec<[f32; N]>) -> Vec<[f32; N]> {
    for value in values.as_flattened_mut() {
        if !value.is_finite() {
            *value = 0.0;
        }
    }
    values
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_keep_their_winding() {
        let mut dropped = Dropped::default();
        let strip: Vec<_> = assemble(Mode::Strip, &[0, 1, 2, 3, 4], &mut dropped).collect();
        assert_eq!(strip, [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        let fan: Vec<_> = assemble(Mode::Fan, &[0, 1, 2, 3], &mut dropped).collect();
        assert_eq!(fan, [[1, 2, 0], [2, 3, 0]]);
        for mode in [Mode::Triangles, Mode::Strip, Mode::Fan] {
            assert_eq!(assemble(mode, &[], &mut dropped).count(), 0);
            assert_eq!(assemble(mode, &[0, 1], &mut dropped).count(), 0);
        }
        assert_eq!(dropped.bad_index, 1);
    }

    #[test]
    fn compaction_keeps_order_and_bad_indices() {
        let mut corners = [9, 3, 5, 3, 10, 5];
        assert_eq!(compact(&mut corners, 10), Some(vec![3, 5, 9]));
        assert_eq!(corners, [2, 0, 1, 0, u32::MAX, 1]);
        assert_eq!(compact(&mut [0, 1, 2], 3), None);
    }
}
