//! Which sun reaches what is seen.

pub(crate) mod reference;

use antumbra::{Filter, LightShadow, ShadowFile};
use glam::DVec3;

use super::World;
use crate::{RenderError, light::Sun};

/// Where a picture's shadows come from.
#[derive(Clone, Copy, Debug, Default)]
pub enum ShadowSource<'a> {
    /// There are none.
    None,
    /// Rays to the sun: hard and exact.
    #[default]
    Traced,
    /// A baked file, which must have every directional light of the scene by name.
    Dag {
        /// The bake.
        shadows: &'a ShadowFile,
        /// The taps of percentage-closer filtering.
        filter: Filter,
    },
}

/// Answers whether a sun reaches a point: what stands between the shading of a picture and its shadows' source.
pub trait SunVisibility: Sync {
    /// 0 in shadow to 1 in full light, at a point of a surface whose unit normal looks towards the sun.
    fn visibility(&self, point_world: DVec3, normal_world: DVec3) -> f32;
}

/// Light everywhere.
struct Unshadowed;

impl SunVisibility for Unshadowed {
    fn visibility(&self, _: DVec3, _: DVec3) -> f32 {
        1.0
    }
}

/// A ray to the sun.
struct Traced<'w, 's> {
    world: &'w World<'s>,
    towards_sun: DVec3,
}

impl SunVisibility for Traced<'_, '_> {
    fn visibility(&self, point_world: DVec3, normal_world: DVec3) -> f32 {
        let World { tracer, surfaces, .. } = self.world;
        let ray = self.world.leaving(point_world, normal_world.as_vec3(), self.towards_sun);
        if tracer.occluded_if(&ray, |hit| surfaces.casts_shadow(tracer, hit)) { 0.0 } else { 1.0 }
    }
}

/// A baked light and how to filter it.
struct Baked<'a> {
    light: LightShadow<'a>,
    filter: Filter,
}

impl SunVisibility for Baked<'_> {
    fn visibility(&self, point_world: DVec3, normal_world: DVec3) -> f32 {
        self.light.filtered(point_world, Some(normal_world), self.filter)
    }
}

/// The answers for each sun of a world, in the same order.
pub(crate) type SunVisibilities<'a> = Vec<Box<dyn SunVisibility + 'a>>;

impl<'a> ShadowSource<'a> {
    pub(crate) fn visibilities<'w>(self, world: &'w World<'_>) -> Result<SunVisibilities<'w>, RenderError>
    where
        'a: 'w,
    {
        world.suns.iter().map(|sun| self.visibility(world, sun)).collect()
    }

    fn visibility<'w>(self, world: &'w World<'_>, sun: &Sun) -> Result<Box<dyn SunVisibility + 'w>, RenderError>
    where
        'a: 'w,
    {
        Ok(match self {
            Self::None => Box::new(Unshadowed),
            Self::Traced => Box::new(Traced { world, towards_sun: sun.towards_world }),
            Self::Dag { shadows, filter } => Box::new(Baked { light: baked_light(shadows, sun)?, filter }),
        })
    }
}

fn baked_light<'a>(shadows: &'a ShadowFile, sun: &Sun) -> Result<LightShadow<'a>, RenderError> {
    // The sun that stands in for a missing one is baked under the name that `--sun` gives.
    let name = sun.name.as_deref().unwrap_or("sun");
    shadows.light(name).ok_or_else(|| RenderError::LightNotInFile {
        light: name.to_owned(),
        present: shadows.lights().map(LightShadow::name).collect::<Vec<_>>().join(", "),
    })
}
