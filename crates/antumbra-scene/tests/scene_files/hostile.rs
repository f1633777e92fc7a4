//! Damaged and malicious bytes: always an error or a smaller scene, never a panic.

use antumbra_scene::load_glb_slice;
use proptest::prelude::*;
use serde_json::{Value, json};

use crate::builder::{FLOAT, Glb};

/// A small file with a bit of everything.
fn sample() -> Glb {
    let mut glb = Glb::triangle();
    let colors = glb.floats(&[[0.5_f32; 4]; 3]);
    let texcoords = glb.floats(&[[0.5_f32; 2]; 3]);
    let indices = glb.indices(&[0, 1, 2]);
    let places = glb.view(&[1, 0]);
    glb.json["accessors"][colors]["sparse"] = json!({
        "count": 1,
        "indices": { "bufferView": places, "componentType": 5121 },
        "values": { "bufferView": 0 },
    });
    let mut png = std::io::Cursor::new(Vec::new());
    image::RgbaImage::new(3, 3).write_to(&mut png, image::ImageFormat::Png).expect("encodes");
    let picture = glb.view(png.get_ref());
    glb.json["images"] = json!([{ "bufferView": picture }]);
    glb.json["textures"] = json!([{ "source": 0, "sampler": 0 }]);
    glb.json["samplers"] = json!([{ "wrapS": 33071 }]);
    glb.json["materials"] = json!([{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }]);
    let attributes = json!({ "POSITION": 0, "COLOR_0": colors, "TEXCOORD_0": texcoords });
    glb.json["meshes"][0]["primitives"][0] = json!({ "attributes": attributes, "indices": indices, "material": 0 });
    glb.json["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 1, "znear": 1 } }]);
    glb.json["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{ "type": "spot" }] } });
    glb.push("nodes", json!({ "camera": 0, "extensions": { "KHR_lights_punctual": { "light": 0 } } }));
    glb.json["scenes"] = json!([{ "nodes": [0, 1] }]);
    glb
}

#[test]
fn truncated_anywhere() {
    let bytes = sample().to_bytes();
    assert!(load_glb_slice(&bytes, "whole").is_ok());
    for cut in 0..bytes.len() {
        assert!(load_glb_slice(&bytes[..cut], "cut").is_err(), "{cut}");
    }
}

#[test]
fn every_byte_flipped() {
    let mut bytes = sample().to_bytes();
    for at in 0..bytes.len() {
        for flip in [0x01, 0x10, 0x80, 0xff] {
            bytes[at] ^= flip;
            let _ = load_glb_slice(&bytes, "flipped");
            bytes[at] ^= flip;
        }
    }
}

/// Puts `replacement` in place of each number of the document in turn.
fn each_number(value: &Value, replacement: &Value, found: &mut Vec<Value>, rebuild: &dyn Fn(Value) -> Value) {
    match value {
        Value::Number(_) => found.push(rebuild(replacement.clone())),
        Value::Array(list) => {
            for (i, item) in list.iter().enumerate() {
                let put = |v: Value| {
                    let mut copy = list.clone();
                    copy[i] = v;
                    rebuild(copy.into())
                };
                each_number(item, replacement, found, &put);
            }
        }
        Value::Object(map) => {
            for (key, item) in map {
                let put = |v: Value| {
                    let mut copy = map.clone();
                    copy.insert(key.clone(), v);
                    rebuild(copy.into())
                };
                each_number(item, replacement, found, &put);
            }
        }
        _ => {}
    }
}

#[test]
fn every_number_replaced() {
    let glb = sample();
    let mut whole = glb.json.clone();
    whole["buffers"] = json!([{ "byteLength": glb.bin.len() }]);
    for replacement in [0_u64, 1, 2, 7, 255, 65535, 1 << 28, 1 << 32, u64::MAX, u64::MAX / 2].map(Value::from) {
        let mut documents = Vec::new();
        each_number(&whole, &replacement, &mut documents, &|v| v);
        assert!(documents.len() > 50);
        for json in documents {
            let _ = Glb { json, bin: glb.bin.clone() }.try_load();
        }
    }
    for replacement in [json!(-1), json!(1e300), json!(0.5), json!(null), json!("x"), json!([])] {
        let mut documents = Vec::new();
        each_number(&whole, &replacement, &mut documents, &|v| v);
        for json in documents {
            let _ = Glb { json, bin: glb.bin.clone() }.try_load();
        }
    }
}

#[test]
fn claims_beyond_the_bytes_are_errors() {
    for (path, value, part) in [
        ("/accessors/0/count", json!(4), "reaches past the end"),
        ("/accessors/0/count", json!(u64::MAX), "claims"),
        ("/accessors/0/byteOffset", json!(u64::MAX), "reaches past the end"),
        ("/accessors/0/bufferView", json!(99), "buffer view 99"),
        ("/accessors/0/componentType", json!(5124), "component type"),
        ("/accessors/0/type", json!("VEC2"), "components"),
        ("/bufferViews/0/byteLength", json!(1 << 20), "wants"),
        ("/bufferViews/0/byteOffset", json!(u64::MAX), "wants"),
        ("/bufferViews/0/byteStride", json!(4), "reaches past the end"),
        ("/meshes/0/primitives/0/material", json!(1), "material 1"),
        ("/meshes/0/primitives/0/mode", json!(7), "mode 7"),
        ("/nodes/0/mesh", json!(5), "mesh 5"),
        ("/asset/version", json!("1.0"), "glTF 1.0"),
        ("/asset/version", json!("3.0"), "glTF 3.0"),
        ("/textures/0/source", json!(3), "image 3"),
    ] {
        let mut glb = sample();
        for needed in ["byteOffset", "byteStride"] {
            let list = path.split('/').nth(1).expect("a list").to_owned();
            if path.ends_with(needed) {
                glb.json[list][0][needed] = json!(0);
            }
        }
        if path.ends_with("mode") {
            glb.json["meshes"][0]["primitives"][0]["mode"] = json!(4);
        }
        *glb.json.pointer_mut(path).expect(path) = value;
        let message = glb.error();
        assert!(message.contains(part), "{path}: {message}");
        assert!(message.starts_with("test: "), "{message}");
    }
}

#[test]
fn zeros_from_nothing_are_bounded() {
    let mut glb = Glb::triangle();
    let nothing = glb.push("accessors", json!({ "componentType": FLOAT, "count": 200_000_000, "type": "VEC3" }));
    glb.show(json!({ "attributes": { "POSITION": nothing } }));
    assert!(glb.error().contains("honestly"));
    let mut glb = Glb::triangle();
    let nothing = glb.push("accessors", json!({ "componentType": FLOAT, "count": 1_000_000, "type": "VEC3" }));
    for _ in 0..100 {
        glb.show(json!({ "attributes": { "POSITION": nothing } }));
    }
    assert!(glb.error().contains("honestly"));
}

#[test]
fn required_extensions_are_named() {
    let mut glb = Glb::triangle();
    glb.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    let message = glb.error();
    assert!(message.contains("KHR_draco_mesh_compression") && message.contains("without Draco"), "{message}");
    glb.json["extensionsRequired"] = json!(["KHR_mesh_quantization", "ACME_soup"]);
    assert!(glb.error().contains("ACME_soup"));
    glb.json["extensionsRequired"] = json!(null);
    glb.json["extensionsUsed"] = json!(["ACME_soup"]);
    assert!(glb.try_load().is_err(), "null is no list");
    glb.json["extensionsRequired"] = json!([]);
    assert!(glb.try_load().is_ok());
}

#[test]
fn things_that_a_scene_ignores_may_be_of_any_shape() {
    let mut glb = Glb::triangle();
    glb.json["animations"] = json!([{ "channels": [{ "target": { "path": "pointer" } }] }]);
    glb.json["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": 99 }]);
    glb.json["nodes"][0]["weights"] = json!("heavy");
    assert_eq!(glb.load().triangle_count(), 1);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn random_damage(edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..20)) {
        let mut bytes = sample().to_bytes();
        for (at, value) in edits {
            let at = at.index(bytes.len());
            bytes[at] = value;
        }
        let _ = load_glb_slice(&bytes, "damaged");
    }
}
