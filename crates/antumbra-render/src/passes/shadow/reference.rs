//! Shadow lookups, on the CPU.

use super::SunVisibilities;
use crate::{
    light::Sun,
    passes::{World, gbuffer::Texel},
    surface::Surface,
};

/// Visibility of each sun for each sample of a row: sample by sample, sun by sun.
pub(crate) fn row(world: &World<'_>, visibilities: &SunVisibilities<'_>, texels: &[Texel]) -> Vec<f32> {
    let suns = || world.suns.iter().zip(visibilities);
    let at = |texel: &Texel| {
        let surface = texel.surface;
        suns().map(move |(sun, shadow)| {
            let lookup =
                |s: Surface| if faces(&s, sun) { shadow.visibility(s.position, s.face_normal.as_dvec3()) } else { 0.0 };
            surface.map_or(1.0, lookup)
        })
    };
    texels.iter().flat_map(at).collect()
}

/// Whether light can fall on the side that is seen: the triangle's own side decides, not its smooth normal's, or light
/// would come through from behind.
fn faces(surface: &Surface, sun: &Sun) -> bool {
    let towards = sun.towards_world.as_vec3();
    surface.face_normal.dot(towards) > 0.0 && surface.normal.dot(towards) > 0.0
}
