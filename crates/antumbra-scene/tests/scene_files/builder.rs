//! Builds small glTF files by hand.

use antumbra_scene::{Scene, SceneError, load_glb_slice};
use serde_json::{Value, json};

pub const FLOAT: u32 = 5126;
pub const TRIANGLE: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]];

/// A document and its buffer.
pub struct Glb {
    pub json: Value,
    pub bin: Vec<u8>,
}

impl Glb {
    pub fn new() -> Self {
        Self { json: json!({ "asset": { "version": "2.0" } }), bin: Vec::new() }
    }

    /// One node that shows one triangle.
    pub fn triangle() -> Self {
        let mut glb = Self::new();
        let positions = glb.floats(&TRIANGLE);
        let mesh = glb.push("meshes", json!({ "primitives": [{ "attributes": { "POSITION": positions } }] }));
        glb.push("nodes", json!({ "mesh": mesh }));
        glb
    }

    /// Appends to one of the document's lists and returns the index.
    pub fn push(&mut self, list: &str, value: Value) -> usize {
        if self.json[list].is_null() {
            self.json[list] = json!([]);
        }
        let list = self.json[list].as_array_mut().expect("a list");
        list.push(value);
        list.len() - 1
    }

    /// Adds bytes to the buffer and returns their view.
    pub fn view(&mut self, bytes: &[u8]) -> usize {
        let offset = self.bin.len();
        self.bin.extend_from_slice(bytes);
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        self.push("bufferViews", json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() }))
    }

    /// An accessor over bytes of its own.
    pub fn accessor(&mut self, bytes: &[u8], component: u32, count: usize, shape: &str) -> usize {
        let view = self.view(bytes);
        let accessor = json!({ "bufferView": view, "componentType": component, "count": count, "type": shape });
        self.push("accessors", accessor)
    }

    pub fn floats<const N: usize>(&mut self, values: &[[f32; N]]) -> usize {
        self.accessor(&float_bytes(values), FLOAT, values.len(), &format!("VEC{N}"))
    }

    pub fn indices(&mut self, values: &[u16]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_le_bytes()).collect();
        self.accessor(&bytes, 5123, values.len(), "SCALAR")
    }

    /// A node that shows a mesh of one primitive.
    pub fn show(&mut self, primitive: Value) {
        let mesh = self.push("meshes", json!({ "primitives": [primitive] }));
        self.push("nodes", json!({ "mesh": mesh }));
    }

    pub fn to_bytes(&self) -> Vec<u8> {
        let mut json = self.json.clone();
        if json["buffers"].is_null() && !self.bin.is_empty() {
            json["buffers"] = json!([{ "byteLength": self.bin.len() }]);
        }
        let mut json = json.to_string().into_bytes();
        json.resize(json.len().next_multiple_of(4), b' ');
        let mut out = b"glTF\x02\0\0\0".to_vec();
        out.extend(((12 + 8 + json.len() + 8 + self.bin.len()) as u32).to_le_bytes());
        out.extend((json.len() as u32).to_le_bytes());
        out.extend(b"JSON");
        out.extend(json);
        out.extend((self.bin.len() as u32).to_le_bytes());
        out.extend(b"BIN\0");
        out.extend(&self.bin);
        out
    }

    pub fn try_load(&self) -> Result<Scene, SceneError> {
        load_glb_slice(&self.to_bytes(), "test")
    }

    pub fn load(&self) -> Scene {
        self.try_load().expect("loads")
    }

    /// The message that loading fails with.
    pub fn error(&self) -> String {
        self.try_load().expect_err("fails").to_string()
    }
}

pub fn float_bytes<const N: usize>(values: &[[f32; N]]) -> Vec<u8> {
    values.as_flattened().iter().flat_map(|v| v.to_le_bytes()).collect()
}
