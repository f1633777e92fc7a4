//! Where shadows come from: rays or a bake.

use antumbra::{Filter, LightKind, LightShadow, Prefilter, ShadowFile};
use antumbra_scene::Light;
use glam::DVec3;

use crate::{
    LampMaps, RenderError,
    camera::View,
    passes::{
        World,
        csm::{Cascades, Casters, MapFilter, reference::Maps},
        lamp_maps,
    },
    surface::Surface,
};

/// Where a picture's shadows come from.
///
/// A bake knows lights by their names. Lights of the scene that it lacks stay dark ([`Renderer::left_dark`] names them);
/// one that has none of them is an error.
///
/// [`Renderer::left_dark`]: crate::Renderer::left_dark
#[derive(Clone, Copy, Debug, Default)]
pub enum ShadowSource<'a> {
    /// There are none.
    None,
    /// Rays to the lights: hard and exact.
    #[default]
    Traced,
    /// A baked file.
    Dag {
        /// The bake.
        shadows: &'a ShadowFile,
        /// The taps of percentage-closer filtering.
        filter: Filter,
    },
    /// A baked file, averaged over what each pixel covers.
    Prefiltered {
        /// The bake.
        shadows: &'a ShadowFile,
        /// How to average. [`Prefilter::Levels`] wants a file with levels ([`LightShadow::has_levels`]).
        how: Prefilter,
    },
    /// A baked file, with penumbrae that harden on contact.
    Penumbra {
        /// The bake; it wants enter depths ([`LightShadow::has_enter_depths`]).
        shadows: &'a ShadowFile,
        /// Tangent of the angle under which the sun's radius is seen; the real one's is 0.00465.
        sun_tangent: f64,
        /// For lamps, which have no size.
        filter: Filter,
    },
    /// Cascaded shadow maps of the suns; lamps are not shadowed.
    Maps {
        /// How many, how large.
        cascades: Cascades,
        /// How they are filtered.
        filter: MapFilter,
    },
}

impl<'a> ShadowSource<'a> {
    /// A bake, however it is looked up.
    #[cfg(feature = "gpu")]
    pub(crate) fn of_file(shadows: &'a ShadowFile) -> Self {
        Self::Prefiltered { shadows, how: Prefilter::Mean }
    }

    /// The bake, if there is one.
    pub(crate) fn file(self) -> Option<&'a ShadowFile> {
        match self {
            Self::None | Self::Traced | Self::Maps { .. } => None,
            Self::Dag { shadows, .. } | Self::Prefiltered { shadows, .. } | Self::Penumbra { shadows, .. } => {
                Some(shadows)
            }
        }
    }

    /// The lights of a scene whose shadows are known: of lamps with maps, all.
    pub(crate) fn known(self, lights: &[Light], has_lamp_maps: bool) -> Result<Vec<Light>, RenderError> {
        let is_mapped = |light: &Light| has_lamp_maps && light.kind != antumbra_scene::LightKind::Directional;
        let known: Vec<Light> = lights.iter().filter(|light| self.knows(light) || is_mapped(light)).cloned().collect();
        let Some(file) = self.file() else { return Ok(known) };
        let is_sun = |light: &&Light| light.kind == antumbra_scene::LightKind::Directional;
        let first = lights.iter().find(is_sun).or(lights.first());
        let missing = match first {
            Some(first) if known.is_empty() => &first.name[..],
            None if file.light(STAND_IN).is_none() => STAND_IN,
            _ => return Ok(known),
        };
        let present = file.lights().map(LightShadow::name).collect::<Vec<_>>().join(", ");
        Err(RenderError::LightNotInFile { light: missing.to_owned(), present })
    }

    /// Whether the shadows of a scene's light are known.
    pub(crate) fn knows(self, light: &Light) -> bool {
        let kind = match light.kind {
            antumbra_scene::LightKind::Directional => LightKind::Directional,
            antumbra_scene::LightKind::Point => LightKind::Point,
            antumbra_scene::LightKind::Spot { .. } => LightKind::Spot,
        };
        self.file().is_none_or(|file| baked(file, &light.name, |baked| baked == kind).is_some())
    }
}

fn baked<'a>(file: &'a ShadowFile, name: &str, kind: impl Fn(LightKind) -> bool) -> Option<LightShadow<'a>> {
    file.light(name).filter(|light| kind(light.kind()))
}

/// The shadow maps that a source needs: of everything, or over a bake of what moves.
fn maps<'w>(world: &'w World<'_>, source: ShadowSource<'_>, view: &View) -> Vec<Maps<'w>> {
    let World { tracer, surfaces, lighting, .. } = world;
    let of = |cascades: Cascades, casters| {
        lighting.suns.iter().map(|sun| Maps::new(&cascades, view, sun, tracer, surfaces, casters)).collect()
    };
    match source {
        ShadowSource::Maps { cascades, .. } => of(cascades, Casters::All),
        ShadowSource::None | ShadowSource::Traced => Vec::new(),
        _ if !surfaces.any_moves() => Vec::new(),
        _ => of(Cascades::for_dynamic(), Casters::Dynamic),
    }
}

/// How a source filters its shadow maps.
fn map_filter(source: ShadowSource<'_>) -> MapFilter {
    match source {
        ShadowSource::Maps { filter, .. } => filter,
        ShadowSource::Dag { filter, .. }
        | ShadowSource::Penumbra { filter, .. }
        | ShadowSource::Prefiltered { how: Prefilter::Levels(filter), .. } => MapFilter::Taps(filter),
        _ => MapFilter::Taps(Filter::default()),
    }
}

/// The baked light of a sun (whose name may be missing) or of a lamp.
pub(crate) fn baked_light<'a>(file: &'a ShadowFile, name: Option<&str>, is_lamp: bool) -> Option<LightShadow<'a>> {
    baked(file, name.unwrap_or(STAND_IN), |kind| (kind != LightKind::Directional) == is_lamp)
}

/// The sun that stands in for a missing one is baked under the name that `--sun` gives.
const STAND_IN: &str = "sun";

/// A point of a surface that asks for its shadows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub position: DVec3,
    /// The triangle's own unit normal; it looks towards the light that is asked for.
    pub normal: DVec3,
    /// Width of what the point stands for, metres.
    pub footprint_m: f64,
}

impl Place {
    pub(crate) fn of(surface: &Surface) -> Self {
        Self { position: surface.position, normal: surface.face_normal.as_dvec3(), footprint_m: surface.footprint_m }
    }
}

/// Answers which lights of a world reach a point: what stands between a picture's shading and its shadows' source.
pub(crate) struct Shadows<'w> {
    world: &'w World<'w>,
    source: ShadowSource<'w>,
    /// By sun and by lamp, where the source is a bake; `None` for lights that it lacks.
    suns: Vec<Option<LightShadow<'w>>>,
    lamps: Vec<Option<LightShadow<'w>>>,
    /// By sun: maps of everything, or over a bake of what moves.
    maps: Vec<Maps<'w>>,
    lamp_maps: Option<lamp_maps::reference::Maps<'w>>,
}

/// Points of a ray through fog at which rays and maps are asked.
const FOG_STEPS: u32 = 64;

impl<'w> Shadows<'w> {
    pub(crate) fn new(
        world: &'w World<'_>,
        source: ShadowSource<'w>,
        lamp_maps: Option<&LampMaps>,
        view: &View,
    ) -> Self {
        let lamp_maps = lamp_maps.map(|how| lamp_maps::reference::Maps::new(how, world, view));
        let maps = maps(world, source, view);
        let mut shadows = Self { world, source, suns: Vec::new(), lamps: Vec::new(), maps, lamp_maps };
        if let Some(file) = source.file() {
            let suns = world.lighting.suns.iter();
            shadows.suns = suns.map(|sun| baked_light(file, sun.name.as_deref(), false)).collect();
            let lamps = world.lighting.lamps.all().iter();
            shadows.lamps = lamps.map(|lamp| baked_light(file, Some(&lamp.name), true)).collect();
        }
        shadows
    }

    /// How much of a sun reaches a point: 0 in shadow to 1 in full light.
    pub(crate) fn of_sun(&self, index: usize, place: &Place) -> f32 {
        let Place { position, normal, .. } = *place;
        let seen = match self.source {
            ShadowSource::Penumbra { sun_tangent, .. } => {
                self.suns[index].map_or(0.0, |light| light.penumbra(position, Some(normal), sun_tangent))
            }
            _ => self.of(&self.suns, index, place, || (self.world.lighting.suns[index].towards_world, f64::INFINITY)),
        };
        match self.maps.get(index).filter(|_| seen > 0.0) {
            Some(maps) => seen * maps.visibility(position, normal, map_filter(self.source)),
            None => seen,
        }
    }

    /// Light of a sun that fog along a way scatters and lets through to its start: see
    /// [`antumbra::LightShadow::lit_through`]. A bake says so exactly; rays and maps are asked at [`FOG_STEPS`] points.
    pub(crate) fn through_fog(&self, index: usize, from: DVec3, to: DVec3, optical_depth: f64) -> f64 {
        if self.source.file().is_some() {
            return self.suns[index].map_or(0.0, |light| light.lit_through(from, to, optical_depth));
        }
        let through = |t: f64| (-optical_depth * t).exp();
        let step = |i: u32| {
            let [begin, end] = [i, i + 1].map(|i| f64::from(i) / f64::from(FOG_STEPS));
            let place = Place { position: from.lerp(to, 0.5 * (begin + end)), normal: DVec3::ZERO, footprint_m: 0.0 };
            let seen = match self.source {
                ShadowSource::Maps { .. } => self
                    .maps
                    .get(index)
                    .map_or(1.0, |m| m.visibility(place.position, DVec3::ZERO, MapFilter::Taps(Filter::default()))),
                _ => self.of_sun(index, &place),
            };
            f64::from(seen) * (through(begin) - through(end))
        };
        (0..FOG_STEPS).map(step).sum()
    }

    /// How much of a lamp reaches a point.
    pub(crate) fn of_lamp(&self, index: usize, place: &Place) -> f32 {
        let lamp = &self.world.lighting.lamps.all()[index];
        let Some(maps) = &self.lamp_maps else {
            // Virtual lights are in no bake.
            if lamp.is_virtual() && self.source.file().is_some() {
                return 1.0;
            }
            let way = || (lamp.position_world - place.position, lamp.casters_end(place.position));
            return self.of(&self.lamps, index, place, way);
        };
        let visible = |is_of_movers| maps.visibility(lamp, place.position, place.normal, is_of_movers);
        match self.lamps.get(index) {
            Some(Some(_)) => {
                // The way is for rays alone.
                let baked = self.of(&self.lamps, index, place, || (DVec3::ZERO, 0.0));
                if baked > 0.0 && self.world.surfaces.any_moves() { baked * visible(true) } else { baked }
            }
            _ => visible(false),
        }
    }

    /// `way` is the direction from the point to the light, and the parameter along it up to which casters count.
    fn of(
        &self,
        baked: &[Option<LightShadow<'_>>],
        index: usize,
        place: &Place,
        way: impl Fn() -> (DVec3, f64),
    ) -> f32 {
        let Place { position, normal, footprint_m } = *place;
        match self.source {
            ShadowSource::None | ShadowSource::Maps { .. } => 1.0,
            ShadowSource::Traced => self.traced(place, way()),
            ShadowSource::Dag { filter, .. } | ShadowSource::Penumbra { filter, .. } => {
                baked[index].map_or(0.0, |light| light.filtered(position, Some(normal), filter))
            }
            ShadowSource::Prefiltered { how, .. } => {
                baked[index].map_or(0.0, |light| light.prefiltered(position, Some(normal), footprint_m, how))
            }
        }
    }

    fn traced(&self, place: &Place, (direction, end): (DVec3, f64)) -> f32 {
        let World { tracer, surfaces, .. } = self.world;
        let ray = self.world.leaving(place.position, place.normal.as_vec3(), direction).between(0.0, end);
        if tracer.occluded_if(&ray, |hit| surfaces.casts_shadow(tracer, hit)) { 0.0 } else { 1.0 }
    }
}
