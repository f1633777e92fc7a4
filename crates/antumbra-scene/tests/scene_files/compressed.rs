//! Meshopt-compressed buffer views. The streams come from meshoptimizer's own encoder.

use serde_json::json;

use crate::builder::Glb;

const SQUARE: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, -2.0], [0.0, 0.0, -2.0]];
#[rustfmt::skip]
const SQUARE_V0: &[u8] = &[
    160, 0, 0, 1, 51, 0, 0, 0, 255, 255, 1, 51, 0, 0, 0, 126, 125, 0, 0, 0, 0, 0, 0, 0, 1, 12, 0, 0, 0, 127, 0, 0, 0, 0, 0,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
];
#[rustfmt::skip]
const SQUARE_V1: &[u8] = &[
    161, 234, 170, 234, 0, 127, 0, 127, 0, 0, 127, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 18, 0, 0,
];
/// The square's numbers as 24-bit mantissas with exponents.
#[rustfmt::skip]
const SQUARE_EXPONENTIAL: &[u8] = &[
    160, 0, 1, 51, 0, 0, 0, 64, 63, 0, 1, 32, 0, 0, 0, 0, 0, 0, 0, 0, 1, 12, 0, 0, 0, 63, 1, 4, 0, 0, 0, 1, 12, 0, 0, 0, 4, 0,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 242, 0, 0, 0, 242, 0, 0, 0, 242,
];
/// Twenty elements of four halfwords: 300 i, 1000 - 7 i, i i, 0.
#[rustfmt::skip]
const HALFWORDS_V1: &[u8] = &[
    161, 151, 171, 0, 88, 88, 88, 88, 88, 88, 88, 88, 88, 88, 88, 88, 88, 88, 88, 88, 88, 88, 88, 5, 42, 170, 170, 170, 170, 0, 0,
    0, 2, 13, 221, 221, 221, 221, 221, 221, 221, 15, 0, 13, 13, 13, 13, 0, 2, 6, 10, 14, 18, 22, 26, 30, 34, 38, 42, 46, 50, 54,
    58, 62, 66, 70, 74, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 232, 3, 0, 0, 0, 0, 1, 1,
];
const TRIANGLES: &[u8] = &[225, 240, 0, 0, 118, 135, 86, 103, 120, 169, 134, 101, 137, 104, 152, 1, 105, 0, 0];
const SEQUENCE: &[u8] = &[209, 0, 4, 4, 6, 8, 4, 0, 0, 0, 0];
/// The normals (0, 1, 0), (0.6, 0, -0.8), (0, 0, 1), (-1, 0, 0).
#[rustfmt::skip]
const NORMALS: &[u8] = &[
    160, 1, 63, 0, 0, 0, 254, 253, 253, 1, 60, 0, 0, 0, 107, 145, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0,
    0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 127, 127, 0,
];

/// Adds a compressed view; the uncompressed one lives in a fallback buffer that nobody may touch.
fn packed(
    glb: &mut Glb,
    extension: &str,
    bytes: &[u8],
    count: usize,
    stride: usize,
    mode: &str,
    filter: &str,
) -> usize {
    let offset = glb.bin.len();
    glb.bin.extend_from_slice(bytes);
    let view = json!({ "buffer": 1, "byteLength": count * stride, "extensions": { extension: {
        "buffer": 0, "byteOffset": offset, "byteLength": bytes.len(), "byteStride": stride, "count": count, "mode": mode,
        "filter": filter,
    } } });
    glb.push("bufferViews", view)
}

fn close_buffers(glb: &mut Glb) {
    let fallback = json!({ "byteLength": 1 << 20, "extensions": { "EXT_meshopt_compression": { "fallback": true } } });
    glb.json["buffers"] = json!([{ "byteLength": glb.bin.len() }, fallback]);
}

fn square(extension: &str, positions: &[u8], filter: &str, indices: &[u8], mode: &str) -> Glb {
    let mut glb = Glb::new();
    glb.json["extensionsRequired"] = json!([extension]);
    let view = packed(&mut glb, extension, positions, 4, 12, "ATTRIBUTES", filter);
    let positions =
        glb.push("accessors", json!({ "bufferView": view, "componentType": 5126, "count": 4, "type": "VEC3" }));
    let view = packed(&mut glb, extension, indices, 6, 2, mode, "NONE");
    let indices =
        glb.push("accessors", json!({ "bufferView": view, "componentType": 5123, "count": 6, "type": "SCALAR" }));
    glb.show(json!({ "attributes": { "POSITION": positions }, "indices": indices }));
    close_buffers(&mut glb);
    glb
}

#[test]
fn every_mode_in_both_versions() {
    for (extension, positions, filter, indices, mode) in [
        ("EXT_meshopt_compression", SQUARE_V0, "NONE", TRIANGLES, "TRIANGLES"),
        ("KHR_meshopt_compression", SQUARE_V1, "NONE", SEQUENCE, "INDICES"),
        ("EXT_meshopt_compression", SQUARE_EXPONENTIAL, "EXPONENTIAL", TRIANGLES, "TRIANGLES"),
    ] {
        let scene = square(extension, positions, filter, indices, mode).load();
        let primitive = &scene.meshes[0].primitives[0];
        assert_eq!(primitive.positions, SQUARE);
        assert_eq!(primitive.triangles, [[0, 1, 2], [0, 2, 3]]);
    }
}

#[test]
fn halfwords_at_once() {
    let mut glb = Glb::new();
    let view = packed(&mut glb, "KHR_meshopt_compression", HALFWORDS_V1, 20, 8, "ATTRIBUTES", "NONE");
    let accessor = json!({ "bufferView": view, "componentType": 5123, "count": 20, "type": "VEC3" });
    let positions = glb.push("accessors", accessor);
    glb.show(json!({ "attributes": { "POSITION": positions } }));
    close_buffers(&mut glb);
    let expected: Vec<[f32; 3]> = (0..20_u16).map(|i| [i * 300, 1000 - i * 7, i * i].map(f32::from)).collect();
    assert_eq!(glb.load().meshes[0].primitives[0].positions, expected);
}

#[test]
fn octahedral_normals() {
    let mut glb = square("EXT_meshopt_compression", SQUARE_V0, "NONE", TRIANGLES, "TRIANGLES");
    let view = packed(&mut glb, "EXT_meshopt_compression", NORMALS, 4, 4, "ATTRIBUTES", "OCTAHEDRAL");
    let accessor = json!({ "bufferView": view, "componentType": 5120, "normalized": true, "count": 4, "type": "VEC3" });
    let normals = glb.push("accessors", accessor);
    glb.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = normals.into();
    close_buffers(&mut glb);
    let scene = glb.load();
    let expected: [[f32; 3]; 4] = [[0.0, 1.0, 0.0], [0.6, 0.0, -0.8], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0]];
    for (got, want) in scene.meshes[0].primitives[0].normals.iter().flatten().zip(expected.as_flattened()) {
        assert!((got - want).abs() < 0.02, "{got} {want}");
    }
}

#[test]
fn damaged_streams_are_errors() {
    for cut in 0..SQUARE_V0.len() {
        assert!(
            square("EXT_meshopt_compression", &SQUARE_V0[..cut], "NONE", TRIANGLES, "TRIANGLES").try_load().is_err()
        );
    }
    for cut in 0..SEQUENCE.len() {
        assert!(square("EXT_meshopt_compression", SQUARE_V1, "NONE", &SEQUENCE[..cut], "INDICES").try_load().is_err());
    }
    for (filter, mode) in [("NONE", "PARTICLES"), ("SEPIA", "TRIANGLES")] {
        assert!(square("EXT_meshopt_compression", SQUARE_V0, filter, TRIANGLES, mode).try_load().is_err());
    }
    let mut glb = square("EXT_meshopt_compression", SQUARE_V0, "NONE", TRIANGLES, "TRIANGLES");
    let claim = &mut glb.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"]["count"];
    for count in [5_u64, 1 << 40, u64::MAX] {
        *claim = count.into();
    }
    assert!(glb.try_load().is_err());
}
