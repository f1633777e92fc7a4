//! Accessors and primitives.

use antumbra_scene::{Dropped, Primitive};
use serde_json::json;

use crate::builder::{FLOAT, Glb, TRIANGLE, float_bytes};

const SQUARE: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, -1.0], [0.0, 0.0, -1.0]];

fn only(glb: &Glb) -> Primitive {
    let mut scene = glb.load();
    assert_eq!((scene.meshes.len(), scene.meshes[0].primitives.len()), (1, 1));
    scene.meshes.remove(0).primitives.remove(0)
}

/// Positions of the corners of all triangles, whatever the vertices' numbers.
fn corners(primitive: &Primitive) -> Vec<[[f32; 3]; 3]> {
    primitive.triangles.iter().map(|t| t.map(|i| primitive.positions[i as usize])).collect()
}

#[test]
fn without_indices() {
    let primitive = only(&Glb::triangle());
    assert_eq!(primitive.positions, TRIANGLE);
    assert_eq!(primitive.triangles, [[0, 1, 2]]);
    assert!(primitive.normals.is_empty() && primitive.texcoords.is_empty() && primitive.colors.is_empty());
}

#[test]
fn indices_of_every_size() {
    for (component, bytes) in [
        (5121, vec![0, 1, 2, 0, 2, 3]),
        (5123, [0_u16, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()).collect()),
        (5125, [0_u32, 1, 2, 0, 2, 3].iter().flat_map(|i| i.to_le_bytes()).collect()),
    ] {
        let mut glb = Glb::new();
        let positions = glb.floats(&SQUARE);
        let indices = glb.accessor(&bytes, component, 6, "SCALAR");
        glb.show(json!({ "attributes": { "POSITION": positions }, "indices": indices }));
        assert_eq!(only(&glb).triangles, [[0, 1, 2], [0, 2, 3]], "{component}");
    }
}

#[test]
fn strips_fans_points_and_lines() {
    let load = |mode: u32, order: &[u16]| {
        let mut glb = Glb::triangle();
        let positions = glb.floats(&SQUARE);
        let indices = glb.indices(order);
        glb.show(json!({ "attributes": { "POSITION": positions }, "indices": indices, "mode": mode }));
        glb.load().meshes.remove(1).primitives
    };
    assert_eq!(load(5, &[0, 1, 3, 2])[0].triangles, [[0, 1, 3], [1, 2, 3]]);
    assert_eq!(load(6, &[0, 1, 2, 3])[0].triangles, [[1, 2, 0], [2, 3, 0]]);
    for mode in 0..4 {
        assert!(load(mode, &[0, 1, 2]).is_empty(), "{mode}");
    }
}

#[test]
fn interleaved_vertices() {
    let mut glb = Glb::new();
    let vertices: Vec<[f32; 8]> = TRIANGLE.iter().map(|p| [p[0], p[1], p[2], 0.0, 1.0, 0.0, p[0], -p[2]]).collect();
    let view = glb.view(&float_bytes(&vertices));
    glb.json["bufferViews"][view]["byteStride"] = 32.into();
    let mut at = |offset: usize, shape: &str| {
        let accessor =
            json!({ "bufferView": view, "byteOffset": offset, "componentType": FLOAT, "count": 3, "type": shape });
        glb.push("accessors", accessor)
    };
    let (position, normal, texcoord) = (at(0, "VEC3"), at(12, "VEC3"), at(24, "VEC2"));
    glb.show(json!({ "attributes": { "POSITION": position, "NORMAL": normal, "TEXCOORD_0": texcoord } }));
    let primitive = only(&glb);
    assert_eq!(primitive.positions, TRIANGLE);
    assert_eq!(primitive.normals, [[0.0, 1.0, 0.0]; 3]);
    assert_eq!(primitive.texcoords, [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
}

#[test]
fn sparse_over_data_and_over_nothing() {
    for base in [true, false] {
        let mut glb = Glb::new();
        let accessor = glb.floats(&[[0.0; 3]; 3]);
        let places = glb.view(&[1, 2]);
        let values = glb.view(&float_bytes(&TRIANGLE[1..]));
        glb.json["accessors"][accessor]["sparse"] = json!({
            "count": 2,
            "indices": { "bufferView": places, "componentType": 5121 },
            "values": { "bufferView": values },
        });
        if !base {
            glb.json["accessors"][accessor].as_object_mut().expect("object").remove("bufferView");
        }
        glb.show(json!({ "attributes": { "POSITION": accessor } }));
        assert_eq!(only(&glb).positions, TRIANGLE);
    }
}

#[test]
fn sparse_of_shared_vertices() {
    let mut glb = Glb::new();
    // More vertices than corners, so that only those used are read.
    let accessor = glb.floats(&[[9.0; 3]; 50]);
    let places = glb.view(&[10, 20, 30]);
    let values = glb.view(&float_bytes(&TRIANGLE));
    glb.json["accessors"][accessor]["sparse"] = json!({
        "count": 3,
        "indices": { "bufferView": places, "componentType": 5121 },
        "values": { "bufferView": values },
    });
    let indices = glb.indices(&[10, 20, 30]);
    glb.show(json!({ "attributes": { "POSITION": accessor }, "indices": indices }));
    let primitive = only(&glb);
    assert_eq!(primitive.positions, TRIANGLE);
    assert_eq!(primitive.triangles, [[0, 1, 2]]);
}

#[test]
fn accessor_without_view_is_zeros() {
    let mut glb = Glb::triangle();
    let normals = glb.push("accessors", json!({ "componentType": FLOAT, "count": 3, "type": "VEC3" }));
    glb.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = normals.into();
    assert_eq!(only(&glb).normals, [[0.0; 3]; 3]);
}

#[test]
fn quantized_attributes() {
    let signed8 = [0_i8, 127, -128].map(|v| v.to_le_bytes()[0]);
    let signed16: Vec<u8> = [0_i16, 32767, -32768].iter().flat_map(|v| v.to_le_bytes()).collect();
    let unsigned16: Vec<u8> = [0_u16, 65535, 13107].iter().flat_map(|v| v.to_le_bytes()).collect();
    for (component, bytes, plain, normalized) in [
        (5120, &signed8[..], [0.0, 127.0, -128.0], [0.0, 1.0, -1.0]),
        (5121, &[0, 255, 51], [0.0, 255.0, 51.0], [0.0, 1.0, 0.2]),
        (5122, &signed16, [0.0, 32767.0, -32768.0], [0.0, 1.0, -1.0]),
        (5123, &unsigned16, [0.0, 65535.0, 13107.0], [0.0, 1.0, 0.2]),
    ] {
        for (flag, [a, b, c]) in [(false, plain), (true, normalized)] {
            // Corners (a, b, c), (b, c, a), (c, a, b) from one run of numbers, each at a stride of 4 bytes or 8.
            let (size, stride) = (bytes.len() / 3, if bytes.len() == 3 { 4 } else { 8 });
            let mut data = Vec::new();
            for first in 0..3 {
                let start = data.len();
                for c in 0..3 {
                    data.extend_from_slice(&bytes[(first + c) % 3 * size..][..size]);
                }
                data.resize(start + stride, 0);
            }
            let mut glb = Glb::new();
            glb.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
            let accessor = glb.accessor(&data, component, 3, "VEC3");
            glb.json["bufferViews"][0]["byteStride"] = stride.into();
            glb.json["accessors"][accessor]["normalized"] = flag.into();
            let texcoord =
                json!({ "bufferView": 0, "componentType": component, "count": 3, "type": "VEC2", "normalized": flag });
            let texcoord = glb.push("accessors", texcoord);
            glb.show(json!({ "attributes": { "POSITION": accessor, "NORMAL": accessor, "TEXCOORD_0": texcoord } }));
            let primitive = only(&glb);
            assert_eq!(primitive.positions, [[a, b, c], [b, c, a], [c, a, b]], "{component} {flag}");
            assert_eq!(primitive.normals, primitive.positions);
            assert_eq!(primitive.texcoords, [[a, b], [b, c], [c, a]]);
        }
    }
}

#[test]
fn vertex_colours() {
    let mut glb = Glb::triangle();
    let rgb = glb.accessor(&[255, 0, 51, 0, 0, 255, 0, 0, 0, 0, 255, 0], 5121, 3, "VEC3");
    let view = glb.json["accessors"][rgb]["bufferView"].as_u64().expect("index") as usize;
    glb.json["bufferViews"][view]["byteStride"] = 4.into();
    glb.json["accessors"][rgb]["normalized"] = true.into();
    glb.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = rgb.into();
    assert_eq!(only(&glb).colors, [[1.0, 0.0, 0.2, 1.0], [0.0, 1.0, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0]]);
    let rgba = glb.floats(&[[0.5, 0.25, f32::NAN, 0.75]; 3]);
    glb.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = rgba.into();
    assert_eq!(only(&glb).colors, [[0.5, 0.25, 0.0, 0.75]; 3]);
}

#[test]
fn bad_triangles_are_counted_and_seams_kept() {
    let mut glb = Glb::new();
    let positions = glb.floats(&[
        TRIANGLE[0],
        TRIANGLE[1],
        TRIANGLE[2],
        [f32::NAN, 0.0, 0.0],
        [0.0, f32::INFINITY, 0.0],
        [3.0, 0.0, 0.0],
    ]);
    let indices = glb.indices(&[0, 1, 2, 0, 1, 3, 4, 1, 0, 0, 1, 5, 1, 1, 2, 0, 1, 6, 0, 1, 65535, 0]);
    glb.show(json!({ "attributes": { "POSITION": positions }, "indices": indices }));
    let scene = glb.load();
    assert_eq!(scene.dropped, Dropped { not_finite: 2, zero_area: 2, bad_index: 3 });
    assert_eq!(scene.triangle_count(), 1);
    assert_eq!(scene.meshes[0].primitives[0].seams, [[0, 1, 5]]);
}

#[test]
fn nothing_left_is_an_error() {
    let mut glb = Glb::new();
    let positions = glb.floats(&[[1.0_f32, f32::NAN, 0.0]; 6]);
    glb.show(json!({ "attributes": { "POSITION": positions } }));
    let message = glb.error();
    assert!(message.contains("all 2 were unusable") && message.contains("2 with corners"), "{message}");
    let message = Glb::new().error();
    assert!(message.contains("places no triangles"), "{message}");
}

#[test]
fn primitives_share_a_vertex_buffer_without_copying_it() {
    let mut glb = Glb::new();
    let many: Vec<[f32; 3]> = (0..100_u8).map(|i| [f32::from(i), f32::from(i % 7), 0.0]).collect();
    let positions = glb.floats(&many);
    let indices = glb.indices(&[90, 3, 5, 3, 5, 200]);
    glb.show(json!({ "attributes": { "POSITION": positions }, "indices": indices }));
    let scene = glb.load();
    let primitive = &scene.meshes[0].primitives[0];
    assert_eq!(primitive.positions, [many[3], many[5], many[90]]);
    assert_eq!(corners(primitive), [[many[90], many[3], many[5]]]);
    assert_eq!(scene.dropped.bad_index, 1);
}
