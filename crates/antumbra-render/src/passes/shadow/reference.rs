//! Shadow lookups, on the CPU.

use super::{Beam, Beams, Place, Shadows, faces};
use crate::{
    passes::{World, gbuffer::Texel},
    surface::Surface,
};

/// The lights that reach each sample of a row.
pub(crate) fn row(world: &World<'_>, shadows: &Shadows<'_>, texels: &[Texel]) -> Beams {
    let mut row = Beams::default();
    for texel in texels {
        if let Some(surface) = &texel.surface {
            from_suns(world, shadows, surface, &mut row.beams);
            from_lamps(world, shadows, surface, &mut row.beams);
        }
        row.ends.push(row.beams.len());
    }
    row
}

fn from_suns(world: &World<'_>, shadows: &Shadows<'_>, surface: &Surface, beams: &mut Vec<Beam>) {
    for (index, sun) in world.lighting.suns.iter().enumerate() {
        let towards = sun.towards_world.as_vec3();
        let visible = if faces(surface, towards) { shadows.of_sun(index, &Place::of(surface)) } else { 0.0 };
        if visible > 0.0 {
            beams.push(Beam { towards, irradiance: sun.irradiance, visible });
        }
    }
}

fn from_lamps(world: &World<'_>, shadows: &Shadows<'_>, surface: &Surface, beams: &mut Vec<Beam>) {
    world.lighting.lamps.reaching(surface.position, |index, light| {
        let visible = if faces(surface, light.towards) { shadows.of_lamp(index, &Place::of(surface)) } else { 0.0 };
        if visible > 0.0 {
            beams.push(Beam::of_lamp(light, visible));
        }
    });
}
