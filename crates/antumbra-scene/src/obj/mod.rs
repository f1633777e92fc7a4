//! Wavefront OBJ in: polygons as triangle fans, one node per `o` or `g`, materials from `.mtl` files.
//!
//! Read here rather than with the crate `tobj`, which gives up on a whole file for one bad index and can be made to
//! panic. In a text format of this age leniency is worth more: a number that cannot be read becomes NaN, so that the
//! triangles it spoils are dropped and counted, and missing materials or pictures only cost looks.

mod mtl;

use std::borrow::Cow;
use std::path::Path;

use glam::DAffine3;
use rustc_hash::FxHashMap;

use self::mtl::Library;
use crate::error::SceneError;
use crate::model::{Mesh, Node, Primitive, Scene};

/// Reads a scene from the bytes of an OBJ; materials and pictures are looked for in `folder`.
pub(crate) fn read(bytes: &[u8], name: &str, folder: Option<&Path>) -> Result<Scene, SceneError> {
    let mut reader = Reader::default();
    let mut library = Library::new(folder);
    let mut rest = bytes;
    while !rest.is_empty() {
        let line = next_line(&mut rest);
        let (keyword, arguments) = line.trim().split_once(char::is_whitespace).unwrap_or((line.trim(), ""));
        match keyword {
            "mtllib" => library.load(arguments.trim())?,
            _ => reader.line(keyword, arguments.trim()),
        }
    }
    let scene = reader.finish(name, &library)?;
    let (materials, images) = library.into_parts();
    Ok(Scene { materials, images, ..scene })
}

/// Cuts off a line; a backslash at the end joins it with the next one. Bytes that are no UTF-8 are replaced.
fn next_line<'b>(rest: &mut &'b [u8]) -> Cow<'b, str> {
    let mut end = 0;
    loop {
        let length = rest[end..].iter().position(|&b| b == b'\n');
        let stop = length.map_or(rest.len(), |n| end + n);
        let goes_on = rest[..stop].trim_ascii_end().ends_with(b"\\") && stop < rest.len();
        if goes_on {
            end = stop + 1;
            continue;
        }
        let line = &rest[..stop];
        *rest = rest.get(stop + 1..).unwrap_or_default();
        let text = String::from_utf8_lossy(line);
        return if end == 0 { text } else { Cow::Owned(text.replace("\\\r\n", " ").replace("\\\n", " ")) };
    }
}

/// What a face's corner refers to, from 0; the position may be out of range.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
struct Corner {
    position: usize,
    texcoord: Option<usize>,
    normal: Option<usize>,
}

/// The file so far.
#[derive(Default)]
struct Reader {
    positions: Vec<[f32; 3]>,
    colors: Vec<[f32; 3]>,
    texcoords: Vec<[f32; 2]>,
    normals: Vec<[f32; 3]>,
    objects: Vec<Object>,
    material: Option<String>,
}

/// The faces under one `o` or `g`.
#[derive(Default)]
struct Object {
    name: String,
    parts: Vec<Part>,
}

/// The faces of an object with one material.
struct Part {
    material: Option<String>,
    corners: Vec<[Corner; 3]>,
}

impl Reader {
    fn line(&mut self, keyword: &str, arguments: &str) {
        match keyword {
            "v" => self.vertex(arguments),
            "vt" => {
                let [u, v] = numbers(arguments, 0.0);
                // OBJ counts rows of a picture from the bottom.
                self.texcoords.push([u, 1.0 - v]);
            }
            "vn" => self.normals.push(numbers(arguments, f32::NAN)),
            "f" => self.face(arguments),
            "o" | "g" => self.objects.push(Object { name: arguments.to_owned(), parts: Vec::new() }),
            "usemtl" => self.material = Some(arguments.to_owned()),
            _ => {}
        }
    }

    /// `x y z`, then perhaps a weight or a colour.
    fn vertex(&mut self, arguments: &str) {
        self.positions.push(numbers(arguments, f32::NAN));
        if arguments.split_whitespace().nth(5).is_some() {
            let [_, _, _, r, g, b] = numbers(arguments, 1.0);
            self.colors.resize(self.positions.len() - 1, [1.0; 3]);
            self.colors.push([r, g, b]);
        }
    }

    fn face(&mut self, arguments: &str) {
        let corners: Vec<Corner> = arguments.split_whitespace().map(|word| self.corner(word)).collect();
        let fan = corners.windows(2).skip(1).map(|pair| [corners[0], pair[0], pair[1]]);
        self.part().corners.extend(fan);
    }

    /// `position`, `position/texcoord`, `position//normal` or all three.
    fn corner(&self, word: &str) -> Corner {
        let mut parts = word.split('/');
        let mut next = |count: usize| parts.next().and_then(|text| resolve(text, count));
        Corner {
            position: next(self.positions.len()).unwrap_or(usize::MAX),
            texcoord: next(self.texcoords.len()),
            normal: next(self.normals.len()),
        }
    }

    /// Where faces go now.
    fn part(&mut self) -> &mut Part {
        if self.objects.is_empty() {
            self.objects.push(Object::default());
        }
        let last = self.objects.len() - 1;
        let parts = &mut self.objects[last].parts;
        let at = parts.iter().rposition(|p| p.material == self.material).unwrap_or_else(|| {
            parts.push(Part { material: self.material.clone(), corners: Vec::new() });
            parts.len() - 1
        });
        &mut parts[at]
    }

    fn finish(mut self, name: &str, library: &Library<'_>) -> Result<Scene, SceneError> {
        if !self.colors.is_empty() {
            self.colors.resize(self.positions.len(), [1.0; 3]);
        }
        let mut scene = Scene { name: name.to_owned(), ..Scene::default() };
        for object in std::mem::take(&mut self.objects) {
            let mut mesh = Mesh { name: object.name, primitives: Vec::new() };
            for part in object.parts {
                let mut primitive = self.gather(&part.corners, &mut scene);
                primitive.material = part.material.and_then(|m| library.index(&m));
                mesh.primitives.push(primitive);
            }
            mesh.primitives.retain(|p| !(p.triangles.is_empty() && p.seams.is_empty()));
            if !mesh.primitives.is_empty() {
                let index = scene.meshes.len();
                let name = if mesh.name.is_empty() { format!("node{index}") } else { mesh.name.clone() };
                scene.nodes.push(Node { name, mesh: index, world_from_mesh: DAffine3::IDENTITY, dynamic: false });
                scene.meshes.push(mesh);
            }
        }
        scene.with_something_left()
    }

    /// Makes a primitive of its own vertices from corners that refer to the file's.
    fn gather(&self, faces: &[[Corner; 3]], scene: &mut Scene) -> Primitive {
        let corners = || faces.iter().flatten();
        let has_texcoords = corners().any(|c| c.texcoord.is_some());
        // A normal missing anywhere leaves face normals everywhere.
        let has_normals = corners().all(|c| c.normal.is_some_and(|n| self.normals[n].iter().all(|v| v.is_finite())));
        let mut out = Primitive::default();
        let mut vertices: FxHashMap<Corner, u32> = FxHashMap::default();
        let mut vertex = |corner: Corner| {
            let Some(&position) = self.positions.get(corner.position) else { return u32::MAX };
            *vertices.entry(corner).or_insert_with(|| {
                out.positions.push(position);
                if has_texcoords {
                    out.texcoords.push(corner.texcoord.map_or([0.0; 2], |t| self.texcoords[t]));
                }
                if let (true, Some(normal)) = (has_normals, corner.normal) {
                    out.normals.push(self.normals[normal]);
                }
                if let Some(&[r, g, b]) = self.colors.get(corner.position) {
                    out.colors.push([r, g, b, 1.0]);
                }
                u32::try_from(out.positions.len() - 1).unwrap_or(u32::MAX)
            })
        };
        let triangles: Vec<[u32; 3]> = faces.iter().map(|face| face.map(&mut vertex)).collect();
        out.set_triangles(triangles, &mut scene.dropped);
        out
    }
}

/// The first `N` numbers of a line; those that are missing or cannot be read become `otherwise`.
fn numbers<const N: usize>(text: &str, otherwise: f32) -> [f32; N] {
    let mut words = text.split_whitespace();
    std::array::from_fn(|_| words.next().and_then(|w| w.parse().ok()).unwrap_or(otherwise))
}

/// An index as OBJ writes it, from 1 or back from the end, as one from 0 and in range.
fn resolve(text: &str, count: usize) -> Option<usize> {
    let number: i64 = text.parse().ok()?;
    let index = match number {
        0 => return None,
        1.. => usize::try_from(number - 1).ok()?,
        _ => count.checked_sub(usize::try_from(number.unsigned_abs()).ok()?)?,
    };
    (index < count).then_some(index)
}
