//! OBJ files and their material libraries.

use std::path::Path;

use antumbra_scene::{AlphaMode, Dropped, Scene, SceneError, load};
use proptest::prelude::*;

fn load_in(folder: &Path, text: impl AsRef<[u8]>) -> Result<Scene, SceneError> {
    let path = folder.join("thing.obj");
    std::fs::write(&path, text).expect("written");
    load(&path)
}

fn load_text(text: &str) -> Result<Scene, SceneError> {
    load_in(tempfile::tempdir().expect("a folder").path(), text)
}

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 0 -1\nv 0 0 -1\n";

#[test]
fn polygons_objects_and_relative_indices() {
    let text = format!("# a comment\n{SQUARE}o floor\nf 1 2 3 4\ng wall\r\nf -4/1/1 \\\n -3// -2\n");
    let scene = load_text(&text).expect("loads");
    assert_eq!(scene.name, "thing");
    assert_eq!(scene.nodes.iter().map(|n| n.name.as_str()).collect::<Vec<_>>(), ["floor", "wall"]);
    assert_eq!(scene.meshes[0].primitives[0].triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(scene.meshes[1].primitives[0].triangles.len(), 1);
    assert!(scene.meshes[1].primitives[0].normals.is_empty());
}

#[test]
fn attributes_of_a_corner() {
    let text = format!("{SQUARE}vt 0.25 0.25\nvt 1 0\nvn 0 1 0\nf 1/1/1 2/2/1 3/1/1\nf 1/2/1 3/1/1 4/1/1\n");
    let scene = load_text(&text).expect("loads");
    let primitive = &scene.meshes[0].primitives[0];
    // The first position is used with two texture coordinates.
    assert_eq!(primitive.positions.len(), 5);
    assert_eq!(primitive.texcoords[..2], [[0.25, 0.75], [1.0, 1.0]]);
    assert_eq!(primitive.normals, [[0.0, 1.0, 0.0]; 5]);
    assert_eq!(scene.nodes[0].name, "node0");
}

#[test]
fn vertex_colours() {
    let text = "v 0 0 0 1 0.5 0\nv 1 0 0\nv 1 0 -1 0 0 1\nf 1 2 3\n";
    let colors = &load_text(text).expect("loads").meshes[0].primitives[0].colors;
    assert_eq!(colors[..], [[1.0, 0.5, 0.0, 1.0], [1.0; 4], [0.0, 0.0, 1.0, 1.0]]);
}

#[test]
fn bad_faces_are_dropped() {
    let text = format!(
        "{SQUARE}v nan 0 0\nv 1e999 0 0\nv x\nv 2 0 0\nf 1 2 3\nf 1 2 9\nf 0 1 2\nf 1 2 -99\nf 1 2 5\nf 1 2 6\nf 1 2 7\nf 1 2 8\n\
         f 1 1 2\nf 1 2\nf\nf 1/9/9 2/9223372036854775807/1 3//-9223372036854775808\n"
    );
    let scene = load_text(&text).expect("loads");
    assert_eq!(scene.dropped, Dropped { not_finite: 3, zero_area: 2, bad_index: 3 });
    assert_eq!(scene.triangle_count(), 2);
    assert_eq!(scene.meshes[0].primitives[0].seams.len(), 1);
    let message = load_text("v 0 0 0\nf 1 1 1\n").expect_err("fails").to_string();
    assert!(message.contains("thing.obj") && message.contains("1 without area"), "{message}");
}

#[test]
fn materials() {
    let folder = tempfile::tempdir().expect("a folder");
    image::RgbaImage::new(2, 1).save(folder.path().join("brick wall.png")).expect("written");
    std::fs::write(folder.path().join("broken.png"), "no picture").expect("written");
    let library = "Kd 1 1 1\nnewmtl brick\nKd 0.5 0.25 0\nmap_Kd -s 1 1 1 C:\\work\\brick wall.png\n\
                   newmtl leaf\nmap_d brick wall.png\nmap_Kd brick wall.png\nKe 3 0 0\n\
                   newmtl glass\nd 0.25\nmap_Kd broken.png\nnewmtl none\nmap_Kd gone.png\n";
    std::fs::write(folder.path().join("lib one.mtl"), library).expect("written");
    let text = format!(
        "mtllib lib one.mtl\nmtllib gone.mtl\nmtllib ../../etc/passwd\n{SQUARE}usemtl brick\nf 1 2 3\nusemtl leaf\nf 1 3 4\n\
         usemtl brick\nf 2 3 4\nusemtl unheard-of\nf 1 2 4\n"
    );
    let scene = load_in(folder.path(), text).expect("loads");
    let materials: Vec<_> = scene.meshes[0].primitives.iter().map(|p| (p.material, p.triangles.len())).collect();
    assert_eq!(materials, [(Some(0), 2), (Some(1), 1), (None, 1)]);
    let [brick, leaf, glass, none] = &scene.materials[..] else { panic!("{:?}", scene.materials) };
    assert_eq!((brick.name.as_str(), brick.base_color), ("brick", [0.5, 0.25, 0.0, 1.0]));
    assert_eq!(
        (brick.base_color_texture.map(|t| t.image), leaf.base_color_texture.map(|t| t.image)),
        (Some(0), Some(0))
    );
    assert_eq!(scene.images.len(), 1);
    assert_eq!((brick.alpha_mode, leaf.alpha_mode), (AlphaMode::Opaque, AlphaMode::Mask));
    assert_eq!(leaf.emissive, [1.0, 0.0, 0.0]);
    assert_eq!((glass.alpha_mode, glass.base_color[3]), (AlphaMode::Blend, 0.25));
    assert!(glass.base_color_texture.is_none() && none.base_color_texture.is_none());
}

#[test]
fn unknown_files_are_named() {
    let message = load(Path::new("scene.fbx")).expect_err("fails").to_string();
    assert!(message.contains("scene.fbx") && message.contains(".glb, .gltf and .obj"), "{message}");
    let message = load(Path::new("nowhere/gone.glb")).expect_err("fails").to_string();
    assert!(message.contains("cannot read nowhere/gone.glb"), "{message}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn random_lines(lines in prop::collection::vec("(v|vt|vn|f|o|g|usemtl|l)( [-0-9./e\\\\na]{0,12}){0,5}", 0..30)) {
        let _ = load_text(&format!("{SQUARE}{}", lines.join("\n")));
    }

    #[test]
    fn random_bytes(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        let _ = load_in(tempfile::tempdir().expect("a folder").path(), bytes);
    }
}
