//! Where a document's bytes come from: the GLB's own chunk, files beside it, data URIs, and buffer views over them.

use std::borrow::Cow;
use std::cell::{Cell, OnceCell};
use std::path::{Component, Path, PathBuf};

use super::meshopt;
use super::schema::{BufferView, Root, item};
use crate::error::SceneError;

/// Vertices and triangles that any file may ask for, however few bytes it has.
const BASE_BUDGET: usize = 1 << 24;
/// Vertices and triangles more per byte of input. Honest files stay far below one: only accessors without data and
/// primitives that share accessors cost less than a byte each.
const BUDGET_PER_BYTE: usize = 32;

/// A document together with its bytes, read when first needed.
pub(super) struct Source<'a> {
    pub root: &'a Root,
    bin: Option<&'a [u8]>,
    folder: Option<&'a Path>,
    buffers: Vec<OnceCell<Cow<'a, [u8]>>>,
    unpacked_views: Vec<OnceCell<Vec<u8>>>,
    budget: Cell<usize>,
}

/// The bytes of a buffer view.
pub(super) struct View<'s> {
    pub bytes: &'s [u8],
    /// Bytes from one element to the next, where the file says.
    pub stride: Option<usize>,
}

impl<'a> Source<'a> {
    /// A document, the GLB's chunk, and the folder that relative URIs start from.
    pub fn new(root: &'a Root, bin: Option<&'a [u8]>, folder: Option<&'a Path>) -> Self {
        Self {
            root,
            bin,
            folder,
            buffers: root.buffers.iter().map(|_| OnceCell::new()).collect(),
            unpacked_views: root.buffer_views.iter().map(|_| OnceCell::new()).collect(),
            budget: Cell::new(BASE_BUDGET.saturating_add(bin.map_or(0, <[u8]>::len).saturating_mul(BUDGET_PER_BYTE))),
        }
    }

    /// Takes `count` vertices or triangles from what this file may unpack to. Call before allocating them.
    pub fn spend(&self, count: usize) -> Result<(), SceneError> {
        let left = self.budget.get().checked_sub(count).ok_or_else(|| {
            SceneError::limit("it unpacks to far more vertices or triangles than its size can honestly hold")
        })?;
        self.budget.set(left);
        Ok(())
    }

    /// A buffer view, unpacked if it is compressed.
    pub fn view(&self, index: usize) -> Result<View<'_>, SceneError> {
        let view = item(&self.root.buffer_views, index, "buffer view")?;
        // Zero is not allowed, but some writers mean "packed" by it.
        let stride = view.byte_stride.filter(|&s| s > 0);
        let packed = view.extensions.meshopt_khr.as_ref().or(view.extensions.meshopt_ext.as_ref());
        let Some(packed) = packed else {
            return Ok(View { bytes: self.plain_view(index, view)?, stride });
        };
        let cell = &self.unpacked_views[index];
        if cell.get().is_none() {
            let input = cut(self.buffer(packed.buffer)?, packed.byte_offset, packed.byte_length, "buffer view", index)?;
            let _ = cell.set(meshopt::unpack(input, packed)?);
        }
        let bytes = cell.get().map_or(&[][..], Vec::as_slice);
        Ok(View { bytes, stride: stride.or(Some(packed.byte_stride)) })
    }

    fn plain_view(&self, index: usize, view: &BufferView) -> Result<&[u8], SceneError> {
        cut(self.buffer(view.buffer)?, view.byte_offset, view.byte_length, "buffer view", index)
    }

    fn buffer(&self, index: usize) -> Result<&[u8], SceneError> {
        let buffer = item(&self.root.buffers, index, "buffer")?;
        let cell = &self.buffers[index];
        if cell.get().is_none() {
            let bytes = match (&buffer.uri, self.bin) {
                (Some(uri), _) => Cow::Owned(self.resource(uri)?),
                (None, Some(bin)) if index == 0 => Cow::Borrowed(bin),
                (None, _) => return Err(SceneError::format(format!("buffer {index} has no data"))),
            };
            let _ = cell.set(bytes);
        }
        let bytes = cell.get().map_or(&[][..], Cow::as_ref);
        cut(bytes, 0, buffer.byte_length, "buffer", index)
    }

    /// What a URI stands for: data, or a file in the document's folder.
    pub fn resource(&self, uri: &str) -> Result<Vec<u8>, SceneError> {
        let bytes = if uri.starts_with("data:") { decode_data_uri(uri)? } else { self.read_file(uri)? };
        self.budget.set(self.budget.get().saturating_add(bytes.len().saturating_mul(BUDGET_PER_BYTE)));
        Ok(bytes)
    }

    fn read_file(&self, uri: &str) -> Result<Vec<u8>, SceneError> {
        let folder = self.folder.ok_or_else(|| {
            SceneError::format(format!("it refers to the file {uri:?}, but was read from memory and has no folder"))
        })?;
        let path = folder.join(relative_path(uri)?);
        std::fs::read(&path).map_err(|source| SceneError::Read { path, source })
    }
}

fn cut<'s>(bytes: &'s [u8], offset: usize, length: usize, kind: &str, index: usize) -> Result<&'s [u8], SceneError> {
    offset.checked_add(length).and_then(|end| bytes.get(offset..end)).ok_or_else(|| {
        let have = bytes.len();
        SceneError::format(format!("{kind} {index} wants {length} bytes from byte {offset} of a buffer of {have}"))
    })
}

fn decode_data_uri(uri: &str) -> Result<Vec<u8>, SceneError> {
    let damaged = || SceneError::format("a data URI is damaged");
    let url = data_url::DataUrl::process(uri).map_err(|_| damaged())?;
    url.decode_to_vec().map(|(bytes, _)| bytes).map_err(|_| damaged())
}

/// Turns a relative URI into a path that stays below the folder it starts from: a scene has no business with other
/// files of the machine.
pub(crate) fn relative_path(uri: &str) -> Result<PathBuf, SceneError> {
    let outside =
        || SceneError::format(format!("it refers to {uri:?}, which is not a relative path inside its folder"));
    let decoded = percent_encoding::percent_decode_str(uri).decode_utf8().map_err(|_| outside())?;
    let path = PathBuf::from(decoded.replace('\\', "/"));
    let mut depth = 0_usize;
    for part in path.components() {
        depth = match part {
            // A colon would be a scheme or a drive letter.
            Component::Normal(name) if !name.to_string_lossy().contains(':') => depth + 1,
            Component::CurDir => depth,
            Component::ParentDir => depth.checked_sub(1).ok_or_else(outside)?,
            _ => return Err(outside()),
        };
    }
    if depth == 0 { Err(outside()) } else { Ok(path) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn relative_paths_stay_inside() {
        let good = |uri: &str| relative_path(uri).map(|p| p.to_string_lossy().into_owned()).ok();
        assert_eq!(good("my%20scene.bin").as_deref(), Some("my scene.bin"));
        assert_eq!(good("./textures/%E2%82%AC.png").as_deref(), Some("./textures/€.png"));
        assert_eq!(good("a\\b.png").as_deref(), Some("a/b.png"));
        assert_eq!(good("a/../b.png").as_deref(), Some("a/../b.png"));
        for bad in ["", ".", "..", "../x", "a/../../x", "/etc/x", "%2Fetc/x", "C:\\x", "https://x/y", "%ff"] {
            assert!(relative_path(bad).is_err(), "{bad}");
        }
    }
}
