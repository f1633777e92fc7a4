//! The BIN chunk as it grows, with the buffer views and accessors over it.

use serde_json::{Value, json};

const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;

/// Bytes, and what describes them.
#[derive(Default)]
pub(super) struct Binary {
    pub bytes: Vec<u8>,
    pub views: Vec<Value>,
    pub accessors: Vec<Value>,
}

impl Binary {
    /// Adds bytes of any kind and returns their buffer view.
    pub fn add(&mut self, bytes: impl IntoIterator<Item = u8>) -> usize {
        let start = self.bytes.len();
        self.bytes.extend(bytes);
        self.views.push(json!({ "buffer": 0, "byteOffset": start, "byteLength": self.bytes.len() - start }));
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.len() - 1
    }

    /// Adds a vertex attribute and returns its accessor.
    pub fn attribute<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        let view = self.add(values.as_flattened().iter().flat_map(|v| v.to_le_bytes()));
        self.views[view]["target"] = ARRAY_BUFFER.into();
        let shape = format!("VEC{N}");
        self.accessor(json!({ "bufferView": view, "componentType": FLOAT, "count": values.len(), "type": shape }))
    }

    /// Adds positions with the bounds that glTF wants for them.
    pub fn positions(&mut self, positions: &[[f32; 3]]) -> usize {
        let accessor = self.attribute(positions);
        let fold = |start: f32, pick: fn(f32, f32) -> f32| -> [f32; 3] {
            std::array::from_fn(|c| positions.iter().map(|p| p[c]).filter(|v| v.is_finite()).fold(start, pick))
        };
        self.accessors[accessor]["min"] = json!(fold(f32::INFINITY, f32::min));
        self.accessors[accessor]["max"] = json!(fold(f32::NEG_INFINITY, f32::max));
        accessor
    }

    /// Adds vertex indices, in two bytes each where that is enough for this many vertices.
    pub fn indices(&mut self, triangles: impl Iterator<Item = [u32; 3]>, vertices: usize) -> usize {
        let size = if vertices <= usize::from(u16::MAX) { 2 } else { 4 };
        let view = self.add(triangles.flatten().flat_map(|i| i.to_le_bytes().into_iter().take(size)));
        self.views[view]["target"] = ELEMENT_ARRAY_BUFFER.into();
        let component = if size == 2 { UNSIGNED_SHORT } else { UNSIGNED_INT };
        let count = self.views[view]["byteLength"].as_u64().unwrap_or(0) / size as u64;
        self.accessor(json!({ "bufferView": view, "componentType": component, "count": count, "type": "SCALAR" }))
    }

    fn accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }
}
