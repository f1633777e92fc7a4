//! Materials and textures.

use std::io::Cursor;

use antumbra_scene::{AlphaMode, Scene, SceneError, Wrap};
use image::{ImageFormat, Rgba, RgbaImage};
use serde_json::{Value, json};

use crate::builder::Glb;

/// Two by two pixels.
fn picture(format: ImageFormat) -> Vec<u8> {
    let image = RgbaImage::from_fn(2, 2, |x, y| Rgba([x as u8 * 255, y as u8 * 255, 0, 255]));
    let mut out = Cursor::new(Vec::new());
    let image = image::DynamicImage::from(image);
    match format {
        ImageFormat::Jpeg => image.to_rgb8().write_to(&mut out, format),
        _ => image.write_to(&mut out, format),
    }
    .expect("encodes");
    out.into_inner()
}

/// A triangle with a material.
fn with_material(material: Value) -> Glb {
    let mut glb = Glb::triangle();
    let material = glb.push("materials", material);
    glb.json["meshes"][0]["primitives"][0]["material"] = material.into();
    glb
}

/// A triangle with a base-colour texture: a texture's JSON, then the image's.
fn with_texture(texture: Value, image: Value) -> Glb {
    let mut glb = with_material(json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }));
    glb.push("textures", texture);
    glb.push("images", image);
    glb
}

#[test]
fn materials() {
    let mut glb = with_material(json!({
        "name": "leaf",
        "pbrMetallicRoughness": { "baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.5, "roughnessFactor": 0.6 },
        "emissiveFactor": [1, 0.5, 0],
        "alphaMode": "MASK", "alphaCutoff": 0.3, "doubleSided": true,
        "extensions": {
            "KHR_materials_emissive_strength": { "emissiveStrength": 4 },
            "KHR_materials_clearcoat": { "clearcoatFactor": 1 },
        },
    }));
    glb.push("materials", json!({ "alphaMode": "BLEND" }));
    glb.json["extensionsRequired"] = json!(["KHR_materials_clearcoat"]);
    glb.json["asset"]["copyright"] = "somebody".into();
    let scene = glb.load();
    assert_eq!(scene.copyright.as_deref(), Some("somebody"));
    let material = &scene.materials[0];
    assert_eq!(material.name, "leaf");
    assert_eq!(material.base_color, [0.1, 0.2, 0.3, 0.4]);
    assert_eq!((material.metallic, material.roughness), (0.5, 0.6));
    assert_eq!(material.emissive, [4.0, 2.0, 0.0]);
    assert_eq!((material.alpha_mode, material.alpha_cutoff, material.double_sided), (AlphaMode::Mask, 0.3, true));
    let plain = &scene.materials[1];
    assert_eq!((plain.metallic, plain.roughness, plain.alpha_mode), (1.0, 1.0, AlphaMode::Blend));
    assert_eq!(scene.meshes[0].primitives[0].material, Some(0));
}

#[test]
fn specular_glossiness_keeps_its_alpha() {
    let mut glb = with_texture(json!({ "source": 0 }), json!({}));
    let view = glb.view(&picture(ImageFormat::Png));
    glb.json["images"][0]["bufferView"] = view.into();
    glb.json["extensionsRequired"] = json!(["KHR_materials_pbrSpecularGlossiness"]);
    glb.json["materials"][0] = json!({ "alphaMode": "MASK", "extensions": { "KHR_materials_pbrSpecularGlossiness": {
        "diffuseFactor": [0.5, 0.5, 0.5, 1], "glossinessFactor": 0.25, "diffuseTexture": { "index": 0 },
    } } });
    let material = &glb.load().materials[0];
    assert_eq!((material.base_color[0], material.metallic, material.roughness), (0.5, 0.0, 0.75));
    assert!(material.base_color_texture.is_some());
}

#[test]
fn pictures_of_every_kind_from_a_view() {
    for format in [ImageFormat::Png, ImageFormat::Jpeg, ImageFormat::WebP] {
        let mut glb = with_texture(json!({ "source": 0 }), json!({ "name": "p" }));
        let view = glb.view(&picture(format));
        glb.json["images"][0]["bufferView"] = view.into();
        if format == ImageFormat::WebP {
            glb.json["textures"][0] = json!({ "extensions": { "EXT_texture_webp": { "source": 0 } } });
            glb.json["extensionsRequired"] = json!(["EXT_texture_webp"]);
        }
        let scene = glb.load();
        assert_eq!((scene.images[0].width, scene.images[0].height), (2, 2), "{format:?}");
        assert_eq!(scene.images[0].rgba.len(), 16);
        if format != ImageFormat::Jpeg {
            assert_eq!(scene.images[0].rgba, [0, 0, 0, 255, 255, 0, 0, 255, 0, 255, 0, 255, 255, 255, 0, 255]);
        }
        let texture = scene.materials[0].base_color_texture.expect("has one");
        assert_eq!(texture.transform, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        assert_eq!((texture.image, texture.wrap_s), (0, Wrap::Repeat));
    }
}

#[test]
fn samplers_and_shared_images() {
    let mut glb = with_texture(json!({ "source": 0, "sampler": 0 }), json!({}));
    let view = glb.view(&picture(ImageFormat::Png));
    glb.json["images"][0]["bufferView"] = view.into();
    glb.json["samplers"] = json!([{ "wrapS": 33071, "wrapT": 33648, "magFilter": 9728 }]);
    glb.push("materials", json!({ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }));
    let scene = glb.load();
    assert_eq!(scene.images.len(), 1);
    let texture = scene.materials[0].base_color_texture.expect("has one");
    assert_eq!((texture.wrap_s, texture.wrap_t), (Wrap::Clamp, Wrap::Mirror));
    assert_eq!(scene.images[0].name, "image0");
}

#[test]
fn texture_transform_and_its_set_of_coordinates() {
    let mut glb = with_texture(json!({ "source": 0 }), json!({}));
    let view = glb.view(&picture(ImageFormat::Png));
    glb.json["images"][0]["bufferView"] = view.into();
    let sets: Vec<usize> = (0..3_u8).map(|set| glb.floats(&[[f32::from(set); 2]; 3])).collect();
    let attributes = &mut glb.json["meshes"][0]["primitives"][0]["attributes"];
    for (i, &set) in sets.iter().enumerate() {
        attributes[format!("TEXCOORD_{i}")] = set.into();
    }
    let set_of = |glb: &Glb| glb.load().meshes[0].primitives[0].texcoords[0][0];
    assert_eq!(set_of(&glb), 0.0);
    glb.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["texCoord"] = 1.into();
    assert_eq!(set_of(&glb), 1.0);
    // The extension's own example: the lower left quarter, turned.
    glb.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] = json!({
        "KHR_texture_transform":
            { "offset": [0, 1], "rotation": std::f64::consts::FRAC_PI_2, "scale": [0.5, 0.5], "texCoord": 2 },
    });
    assert_eq!(set_of(&glb), 2.0);
    let transform = glb.load().materials[0].base_color_texture.expect("has one").transform;
    let apply = |u: f32, v: f32| transform.map(|[a, b, c]| a * u + b * v + c);
    for ((u, v), expected) in [((0.0, 0.0), [0.0, 1.0]), ((1.0, 0.0), [0.0, 0.5]), ((0.0, 1.0), [0.5, 1.0])] {
        let got = apply(u, v);
        assert!((got[0] - expected[0]).abs() < 1e-6 && (got[1] - expected[1]).abs() < 1e-6, "{got:?} {expected:?}");
    }
}

#[test]
fn data_uris_and_files_beside() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut glb = with_texture(json!({ "source": 0 }), json!({ "uri": "my%20pictures/p%231.png" }));
    std::fs::create_dir(folder.path().join("my pictures")).expect("a folder");
    std::fs::write(folder.path().join("my pictures/p#1.png"), picture(ImageFormat::Png)).expect("written");
    std::fs::write(folder.path().join("scene data.bin"), &glb.bin).expect("written");
    glb.json["buffers"] = json!([{ "byteLength": glb.bin.len(), "uri": "scene%20data.bin" }]);
    let path = folder.path().join("outside.gltf");
    let load = |json: &Value| -> Result<Scene, SceneError> {
        std::fs::write(&path, json.to_string()).expect("written");
        antumbra_scene::load(&path)
    };
    let scene = load(&glb.json).expect("loads");
    assert_eq!((scene.name.as_str(), scene.triangle_count(), scene.images.len()), ("outside", 1, 1));
    assert_eq!(scene.images[0].name, "my%20pictures/p%231.png");

    glb.json["buffers"][0]["uri"] =
        "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAAAAAAIC/".into();
    assert_eq!(load(&glb.json).expect("loads").meshes[0].primitives[0].positions, crate::builder::TRIANGLE);

    for (uri, part) in [("gone.bin", "gone.bin"), ("../x.bin", "inside its folder"), ("data:;base64,A*", "data URI")] {
        glb.json["buffers"][0]["uri"] = uri.into();
        let message = load(&glb.json).expect_err("fails").to_string();
        assert!(message.contains(part), "{message}");
    }
    assert!(glb.error().contains("data URI"));
}

#[test]
fn broken_and_huge_pictures_are_errors() {
    let mut glb = with_texture(json!({ "source": 0 }), json!({}));
    let wide = [ImageFormat::Png, ImageFormat::Jpeg].map(|format| {
        let mut out = Cursor::new(Vec::new());
        image::RgbImage::new(16385, 1).write_to(&mut out, format).expect("encodes");
        out.into_inner()
    });
    let cut = &picture(ImageFormat::Png)[..40];
    for (bytes, part) in [
        (cut, "cannot be decoded"),
        (&wide[0], "16384 by 16384"),
        (&wide[1], "16384 by 16384"),
        (b"hello", "not supported"),
    ] {
        let view = glb.view(bytes);
        glb.json["images"][0]["bufferView"] = view.into();
        let message = glb.error();
        assert!(message.contains(part), "{message}");
    }
}
