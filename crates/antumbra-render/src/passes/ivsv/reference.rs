//! Imperfect voxelized shadow volumes on the CPU: the twin of the graphics card's passes.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::airlight::Airlight;
use super::cloud::Cloud;
use super::epipolar::Epipolar;
use super::gather::{Gather, Sample, Volume};
use super::splat::Map;
use super::{AreaLit, rectify, scan};
use crate::area::{AreaLighting, AreaTechnique, sampled};
use crate::camera::View;
use crate::passes::fog::Fog;
use crate::passes::gbuffer::Texel;
use crate::passes::{World, shade};

/// Points of the scene, from which maps take theirs.
const CLOUD: u32 = 1 << 18;

/// All VPLs of one picture, with their shadows.
pub(crate) struct Volumes {
    volumes: Vec<Volume>,
    airlight: Airlight,
    sigma_t: f32,
    how: AreaLighting,
}

impl Volumes {
    /// Samples the lights, and makes a shadow volume for each sample.
    pub fn new(world: &World<'_>, view: &View, fog: Option<&Fog>, lighting: &AreaLighting) -> Self {
        let bounds = world.tracer.bounds();
        let vpls = sampled(&lighting.lights, lighting.vpls, &bounds, view.eye);
        // From far outside, surfaces are seen behind the end of the fog.
        let to_corner = |corner: DVec3| corner.distance(view.eye);
        let far_m = bounds.corners().map(to_corner).into_iter().fold(far_m(world), f64::max);
        let size = lighting.voxels;
        let scene = world.surfaces.scene();
        let cast = match lighting.technique {
            AreaTechnique::Voxels => Some(Cloud::new(scene, CLOUD).cast(&scene.nodes, view.eye, &vpls, size.points)),
            AreaTechnique::None | AreaTechnique::Traced => None,
        };
        let volume = |(number, vpl): (usize, &crate::area::Vpl)| {
            let space = Epipolar::new(vpl, view, far_m, size);
            let voxels = cast.as_ref().map_or(Vec::new(), |cast| {
                let map = Map::draw(vpl, number as u32, cast, size.map, size.points).filled();
                scan::voxels(size, &rectify::thresholds(vpl, &space, &map))
            });
            Volume { vpl: *vpl, space, voxels }
        };
        Self {
            volumes: vpls.par_iter().enumerate().map(volume).collect(),
            airlight: Airlight::new(fog.map_or(0.0, |fog| fog.anisotropy)),
            sigma_t: fog.map_or(0.0, |fog| fog.density_per_m as f32),
            how: lighting.clone(),
        }
    }

    /// What the lights do to one row's samples.
    pub fn row(&self, world: &World<'_>, texels: &[Texel]) -> Vec<AreaLit> {
        let gather = Gather {
            sigma_t: self.sigma_t,
            airlight: &self.airlight,
            how: self.how.airlight,
            interpolate: self.how.interpolate,
        };
        texels.iter().map(|texel| self.sample(&gather, world, texel)).collect()
    }

    fn sample(&self, gather: &Gather<'_>, world: &World<'_>, texel: &Texel) -> AreaLit {
        let end_m = far_m(world);
        let surface = texel.surface.as_ref();
        let distance = surface.map_or(end_m, |surface| surface.distance);
        let fog_m = distance.min(end_m) as f32;
        let sample = Sample { ray: texel.direction, distance: distance as f32, fog_m, surface };
        let mut out = AreaLit::default();
        for volume in &self.volumes {
            let reflected = |towards, irradiance| {
                if let Some(surface) = surface {
                    out.reflected += shade::reference::reflected(surface, towards, irradiance);
                }
            };
            gather.add(volume, &sample, reflected, &mut out.airlight);
        }
        out.airlight = out.airlight.max(Vec3::ZERO);
        out
    }
}

/// How far fog and lights reach: as far as the fog's other light.
pub(crate) fn far_m(world: &World<'_>) -> f64 {
    world.lighting.diagonal_m
}
