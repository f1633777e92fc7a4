//! Loads the real scenes of `shared/scenes`, where a checkout has them beside it.

use std::path::{Path, PathBuf};

use antumbra_scene::{LightKind, load_glb_slice, to_glb};

/// Triangles in the file and point lights. A few triangles have no area (36 in delft, 34 in kaykit-city, 60 in colosseum,
/// 25 in kitchen), so that those dropped and those kept add up to the file's.
const SCENES: [(&str, u64, usize); 9] = [
    ("delft", 101_362, 0),
    ("jacksboro-terrain", 280_242, 0),
    ("kaykit-city", 284_468, 60),
    ("colosseum", 111_297, 73),
    ("temple", 20_060, 0),
    ("grove", 221_067, 0),
    ("fzk-haus", 36_290, 0),
    ("kitchen", 56_939, 0),
    ("spot", 5_856, 0),
];

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/scenes")
}

#[test]
fn every_scene_has_its_triangles_and_lights() {
    for (name, triangles, points) in SCENES {
        let path = folder().join(name).with_extension("glb");
        if !path.exists() {
            continue;
        }
        let scene = antumbra_scene::load(&path).expect(name);
        assert_eq!(scene.name, name);
        assert!(scene.copyright.is_some(), "{name}");
        assert_eq!(scene.triangle_count() + scene.dropped.zero_area, triangles, "{name}");
        assert_eq!(scene.dropped.total(), scene.dropped.zero_area, "{name}");
        let (suns, lamps): (Vec<_>, Vec<_>) = scene.lights.iter().partition(|l| l.kind == LightKind::Directional);
        assert_eq!(suns.len(), 1, "{name}");
        assert_eq!(suns[0].name, "sun", "{name}");
        assert_eq!(lamps.len(), points, "{name}");
        assert_eq!(scene.cameras[0].name, "overview", "{name}");

        let back = load_glb_slice(&to_glb(&scene).expect(name), name).expect(name);
        assert_eq!(format!("{:?}", back.nodes), format!("{:?}", scene.nodes), "{name}");
        for (a, b) in back.meshes.iter().zip(&scene.meshes).flat_map(|(a, b)| a.primitives.iter().zip(&b.primitives)) {
            assert!(a.positions == b.positions && a.triangles == b.triangles && a.seams == b.seams, "{name}");
            assert!(a.texcoords == b.texcoords && a.normals == b.normals && a.material == b.material, "{name}");
        }
        assert_eq!(back.meshes.len(), scene.meshes.len());
        assert!(back.images.iter().zip(&scene.images).all(|(a, b)| a.rgba == b.rgba), "{name}");
    }
}
