//! The ruins are open and overgrown.

use super::{scene, unbalanced_edges};
use crate::model::{AlphaMode, Scene, Wrap};

/// Triangles over all nodes whose material is of that kind.
fn triangles(ruins: &Scene, mode: AlphaMode) -> u64 {
    let of_mesh = |mesh: usize| -> u64 {
        let parts = ruins.meshes[mesh].primitives.iter();
        parts.filter(|p| ruins.material(p).alpha_mode == mode).map(|p| p.triangles.len() as u64).sum()
    };
    ruins.nodes.iter().map(|n| of_mesh(n.mesh)).sum()
}

#[test]
fn nothing_is_closed() {
    let ruins = scene("ruins", 1, 0.5);
    for mesh in &ruins.meshes {
        let open = unbalanced_edges(mesh);
        // Thick walls are open along their feet and ends only, leaves along all their edges.
        assert!(open as u64 * 40 > mesh.triangle_count(), "`{}` has but {open} open edges", mesh.name);
    }
}

#[test]
fn a_third_or_more_are_leaves() {
    for seed in [1, 2, 3] {
        let ruins = scene("ruins", seed, 1.0);
        let (masked, all) = (triangles(&ruins, AlphaMode::Mask), ruins.triangle_count());
        assert_eq!(masked + triangles(&ruins, AlphaMode::Opaque), all);
        assert!((all / 3..2 * all / 3).contains(&masked), "{masked} of {all}");
    }
}

#[test]
fn leaves_have_holes_and_show_every_wrap() {
    let ruins = scene("ruins", 1, 0.1);
    let mut wraps = Vec::new();
    let mut transformed = 0;
    for material in ruins.materials.iter().filter(|m| m.alpha_mode == AlphaMode::Mask) {
        let texture = material.base_color_texture.expect("a texture");
        assert!(material.double_sided && material.alpha_cutoff == 0.5);
        wraps.extend([texture.wrap_s, texture.wrap_t]);
        transformed += usize::from(texture.transform != [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        let image = &ruins.images[texture.image];
        assert_eq!(image.rgba.len(), 4 * (image.width * image.height) as usize);
        let there = image.rgba.chunks(4).filter(|pixel| pixel[3] >= 128).count() * 4;
        let share = there as f64 / image.rgba.len() as f64;
        assert!((0.2..0.8).contains(&share), "{} covers {share}", image.name);
    }
    assert!([Wrap::Repeat, Wrap::Mirror, Wrap::Clamp].iter().all(|wrap| wraps.contains(wrap)));
    assert!(transformed >= 3);
}
