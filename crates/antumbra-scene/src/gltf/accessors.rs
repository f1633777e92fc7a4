//! Accessors: typed elements in a buffer view, checked once against the bytes there are, then read without surprises.

use std::array;

use super::schema::{Accessor, Sparse, item};
use super::source::Source;
use crate::error::SceneError;

/// The number format of one component.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn from_gl(code: u32, accessor: usize) -> Result<Self, SceneError> {
        Ok(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return Err(SceneError::format(format!("accessor {accessor} has the unknown component type {code}"))),
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }
}

/// Elements to read.
#[derive(Clone, Copy)]
pub(super) enum Pick<'p> {
    /// All, in order.
    All,
    /// These, ascending and below the count.
    These(&'p [u32]),
}

/// An accessor whose elements are known to lie inside its bytes.
pub(super) struct Elements<'s> {
    index: usize,
    pub count: usize,
    component: Component,
    /// Components per element.
    pub width: usize,
    normalized: bool,
    /// `None` reads as zeros.
    data: Option<Strided<'s>>,
    overlay: Option<Overlay<'s>>,
}

/// Bytes from the first element on.
struct Strided<'s> {
    bytes: &'s [u8],
    stride: usize,
}

/// Elements that replace others (glTF's sparse accessors), with ascending positions.
struct Overlay<'s> {
    at: Vec<u32>,
    values: Strided<'s>,
}

impl<'s> Elements<'s> {
    /// Checks an accessor against its buffer views.
    pub fn open(source: &'s Source<'_>, index: usize) -> Result<Self, SceneError> {
        let accessor = item(&source.root.accessors, index, "accessor")?;
        let component = Component::from_gl(accessor.component_type, index)?;
        let width = width(&accessor.shape)
            .ok_or_else(|| SceneError::format(format!("accessor {index} has the type {:?}", accessor.shape)))?;
        if u32::try_from(accessor.count).is_err() {
            return Err(SceneError::limit(format!("accessor {index} claims {} elements", accessor.count)));
        }
        let size = width * component.size();
        let data = match accessor.buffer_view {
            Some(view) => Some(strided(source, view, accessor.byte_offset, accessor.count, size, index)?),
            None => None,
        };
        let overlay = match &accessor.sparse {
            Some(sparse) => Some(Overlay::open(source, accessor, sparse, size, index)?),
            None => None,
        };
        Ok(Self { index, count: accessor.count, component, width, normalized: accessor.normalized, data, overlay })
    }

    /// Reads the first `N` components of elements as floats; a vertex attribute.
    pub fn floats<const N: usize>(&self, pick: Pick<'_>) -> Result<Vec<[f32; N]>, SceneError> {
        self.floats_as(pick, self.normalized)
    }

    /// As [`Self::floats`]; `normalized` says whether integers stand for 0..1 or -1..1.
    pub fn floats_as<const N: usize>(&self, pick: Pick<'_>, normalized: bool) -> Result<Vec<[f32; N]>, SceneError> {
        if self.width < N {
            return Err(SceneError::format(format!(
                "accessor {} has {} components where {N} are needed",
                self.index, self.width
            )));
        }
        let signed = |v: f32, max: f32| if normalized { (v / max).max(-1.0) } else { v };
        let unsigned = |v: f32, max: f32| if normalized { v / max } else { v };
        Ok(match self.component {
            Component::F32 => self.gather(pick, f32::from_le_bytes),
            Component::I8 => self.gather(pick, |b| signed(i8::from_le_bytes(b).into(), 127.0)),
            Component::U8 => self.gather(pick, |b| unsigned(u8::from_le_bytes(b).into(), 255.0)),
            Component::I16 => self.gather(pick, |b| signed(i16::from_le_bytes(b).into(), 32767.0)),
            Component::U16 => self.gather(pick, |b| unsigned(u16::from_le_bytes(b).into(), 65535.0)),
            Component::U32 => {
                return Err(SceneError::format(format!(
                    "accessor {} is a vertex attribute of 32-bit integers, which glTF does not allow",
                    self.index
                )));
            }
        })
    }

    /// Reads all elements as vertex indices.
    pub fn indices(&self) -> Result<Vec<u32>, SceneError> {
        let read = match (self.width, self.component) {
            (1, Component::U8) => self.gather(Pick::All, |b| u8::from_le_bytes(b).into()),
            (1, Component::U16) => self.gather(Pick::All, |b| u16::from_le_bytes(b).into()),
            (1, Component::U32) => self.gather(Pick::All, u32::from_le_bytes),
            _ => {
                let index = self.index;
                return Err(SceneError::format(format!("accessor {index} holds indices, but is no unsigned scalar")));
            }
        };
        Ok(read.into_iter().map(|[i]| i).collect())
    }

    fn gather<T: Copy + Default, const N: usize, const B: usize>(
        &self,
        pick: Pick<'_>,
        convert: impl Fn([u8; B]) -> T,
    ) -> Vec<[T; N]> {
        let read = |data: &Strided<'_>, i: usize| {
            let (parts, _) = data.bytes[i * data.stride..].as_chunks::<B>();
            array::from_fn(|c| convert(parts[c]))
        };
        let base = |i: usize| self.data.as_ref().map_or([T::default(); N], |data| read(data, i));
        let mut out: Vec<[T; N]> = match pick {
            Pick::All => (0..self.count).map(base).collect(),
            Pick::These(wanted) => wanted.iter().map(|&i| base(i as usize)).collect(),
        };
        for (k, &i) in self.overlay.iter().flat_map(|o| o.at.iter().enumerate().map(move |(k, i)| ((o, k), i))) {
            let slot = match pick {
                Pick::All => Some(i as usize),
                Pick::These(wanted) => wanted.binary_search(&i).ok(),
            };
            if let Some(slot) = slot {
                out[slot] = read(&k.0.values, k.1);
            }
        }
        out
    }
}

impl<'s> Overlay<'s> {
    fn open(
        source: &'s Source<'_>,
        accessor: &Accessor,
        sparse: &Sparse,
        size: usize,
        index: usize,
    ) -> Result<Self, SceneError> {
        source.spend(sparse.count)?;
        let component = Component::from_gl(sparse.indices.component_type, index)?;
        let places = &sparse.indices;
        let data = strided(source, places.buffer_view, places.byte_offset, sparse.count, component.size(), index)?;
        let scalars = Elements {
            index,
            count: sparse.count,
            component,
            width: 1,
            normalized: false,
            data: Some(data),
            overlay: None,
        };
        let at = scalars.indices()?;
        if at.iter().any(|&i| i as usize >= accessor.count) {
            return Err(SceneError::format(format!("accessor {index} replaces an element that it does not have")));
        }
        let values = &sparse.values;
        let values = strided(source, values.buffer_view, values.byte_offset, sparse.count, size, index)?;
        Ok(Self { at, values })
    }
}

/// Components per element of an accessor's `type`. The smaller matrices, which have padding, occur nowhere in a scene.
fn width(shape: &str) -> Option<usize> {
    match shape {
        "SCALAR" => Some(1),
        "VEC2" => Some(2),
        "VEC3" => Some(3),
        "VEC4" => Some(4),
        "MAT4" => Some(16),
        _ => None,
    }
}

/// The bytes of `count` elements of `size` bytes, checked to be all there.
fn strided<'s>(
    source: &'s Source<'_>,
    view: usize,
    offset: usize,
    count: usize,
    size: usize,
    index: usize,
) -> Result<Strided<'s>, SceneError> {
    let view = source.view(view)?;
    let stride = view.stride.unwrap_or(size);
    let needed = match count {
        0 => Some(0),
        _ if stride < size => None,
        _ => stride.checked_mul(count - 1).and_then(|n| n.checked_add(size)),
    };
    let bytes = view.bytes.get(offset..).filter(|bytes| needed.is_some_and(|n| n <= bytes.len()));
    let bytes = bytes.ok_or_else(|| {
        SceneError::format(format!("accessor {index} ({count} elements) reaches past the end of its buffer view"))
    })?;
    Ok(Strided { bytes, stride })
}
