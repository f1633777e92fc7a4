//! Loads the real scenes of `shared/scenes`, where a checkout has them beside it.

use std::path::{Path, PathBuf};

use antumbra_scene::LightKind;

/// Triangles placed by the file, whether usable or not, and point lights.
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
        let start = std::time::Instant::now();
        let scene = antumbra_scene::load(&path).expect(name);
        println!("{name}: {:?}, {} triangles, {:?}", start.elapsed(), scene.triangle_count(), scene.dropped);
        assert_eq!(scene.name, name);
        assert!(scene.copyright.is_some(), "{name}");
        assert_eq!(scene.triangle_count() + scene.dropped.total(), triangles, "{name}");
        let (suns, lamps): (Vec<_>, Vec<_>) = scene.lights.iter().partition(|l| l.kind == LightKind::Directional);
        assert_eq!(suns.len(), 1, "{name}");
        assert_eq!(suns[0].name, "sun", "{name}");
        assert_eq!(lamps.len(), points, "{name}");
        assert_eq!(scene.cameras[0].name, "overview", "{name}");
    }
}
