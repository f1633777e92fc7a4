//! Imperfect voxelized shadow volumes on the CPU: the twin of the graphics card's passes.

use glam::{DVec3, UVec2, Vec3};
use rayon::prelude::*;

use super::airlight::Airlight;
use super::cloud::{Cast, Cloud};
use super::epipolar::Epipolar;
use super::filter::{Grid, Key};
use super::gather::{Gather, Sample, Shadows, Volume};
use super::splat::{Map, Paraboloid};
use super::{AreaLit, rectify, scan};
use crate::area::{AreaLighting, AreaTechnique, Interpolation, Vpl, sampled};
use crate::camera::View;
use crate::passes::World;
use crate::passes::fog::Fog;
use crate::passes::gbuffer::{self, Texel};

/// Points of the scene, from which maps take theirs.
pub(crate) const CLOUD: u32 = 1 << 18;

/// What a picture's samples gathered, before they share it.
pub(crate) struct Gathered {
    grid: Grid,
    samples: u32,
    /// By row, then pixel, then sample.
    lit: Vec<(Key, AreaLit)>,
}

/// What makes a picture's shadows: which scene, seen from where, by which light.
pub(crate) struct Job<'j> {
    pub world: &'j World<'j>,
    pub view: &'j View,
    pub fog: Option<&'j Fog>,
    pub lighting: &'j AreaLighting,
    pub samples: u32,
}

impl Job<'_> {
    /// Gathers the light of all VPLs, batch after batch. `step` is called after each row of the last.
    pub fn gather(&self, step: &(dyn Fn() + Sync)) -> Gathered {
        let Job { world, view, lighting, samples, .. } = *self;
        let vpls = sampled(&lighting.lights, lighting.vpls, &world.tracer.bounds(), view.eye);
        let scene = world.surfaces.scene();
        let cast = match lighting.technique {
            AreaTechnique::None | AreaTechnique::Traced => None,
            AreaTechnique::Voxels | AreaTechnique::OneByOne | AreaTechnique::MarchedMaps => {
                Some(Cloud::new(scene, CLOUD).cast(&scene.nodes, view.eye, &vpls, lighting.voxels.points))
            }
        };
        let grid = self.grid();
        let UVec2 { x: width, y: height } = grid.gathered();
        let airlight = Airlight::new(self.fog.map_or(0.0, |fog| fog.anisotropy));
        let gather = Gather {
            sigma_t: self.fog.map_or(0.0, |fog| fog.density_per_m as f32),
            airlight: &airlight,
            how: lighting.airlight,
            interpolate: lighting.interpolation != Interpolation::None,
        };
        let mut lit = vec![(Key::default(), AreaLit::default()); (width * height * samples) as usize];
        let batch = lighting.batch() as usize;
        for first in (0..vpls.len()).step_by(batch) {
            let own = &vpls[first..vpls.len().min(first + batch)];
            let numbered = own.par_iter().enumerate().map(|(i, vpl)| (first + i, vpl));
            let volumes: Vec<Volume> =
                numbered.map(|(number, vpl)| self.volume(number as u32, vpl, cast.as_ref())).collect();
            let is_last = first + batch >= vpls.len();
            lit.par_chunks_mut((width * samples) as usize).enumerate().for_each(|(y, lit)| {
                let row = gbuffer::reference::row(world, view, grid.pixel(UVec2::new(0, y as u32)).y, samples);
                for (x, lit) in lit.chunks_mut(samples as usize).enumerate() {
                    let at = UVec2::new(x as u32, y as u32);
                    let first_texel = (grid.pixel(at).x * samples) as usize;
                    for (texel, (key, lit)) in row[first_texel..].iter().zip(lit) {
                        let sample = self.sample(texel);
                        *key = Key::of(&sample);
                        let taken = (first as u32..).zip(&volumes).filter(|(number, _)| grid.takes(at, *number));
                        taken.for_each(|(_, volume)| gather.add(volume, &sample, lit));
                    }
                }
                if is_last {
                    step();
                }
            });
        }
        Gathered { grid, samples, lit }
    }

    fn grid(&self) -> Grid {
        Grid::new(self.lighting.gathering, UVec2::new(self.view.width, self.view.height))
    }

    /// Rows that [`Job::gather`] steps through.
    pub fn rows(&self) -> usize {
        self.grid().gathered().y as usize
    }

    fn volume(&self, number: u32, vpl: &Vpl, cast: Option<&Cast>) -> Volume {
        let AreaLighting { voxels: size, technique, .. } = *self.lighting;
        let space = Epipolar::new(vpl, self.view, far_m(self.world, self.view), size);
        let Some(cast) = cast else { return Volume { vpl: *vpl, space, shadows: Shadows::None } };
        let map = Map::draw(vpl, number, cast, size.map, size.points);
        let shadows = if technique == AreaTechnique::MarchedMaps {
            Shadows::Map(map, Paraboloid::new(vpl, size.map))
        } else {
            Shadows::Voxels(scan::voxels(size, &rectify::thresholds(vpl, &space, &map)))
        };
        Volume { vpl: *vpl, space, shadows }
    }

    fn sample<'t>(&self, texel: &'t Texel) -> Sample<'t> {
        let end_m = fog_end_m(self.world);
        let surface = texel.surface.as_ref();
        let distance = surface.map_or(end_m, |surface| surface.distance);
        Sample { ray: texel.direction, distance: distance as f32, fog_m: distance.min(end_m) as f32, surface }
    }

    /// What area lights do to one row's samples.
    pub fn row(&self, gathered: &Gathered, y: u32, texels: &[Texel]) -> Vec<AreaLit> {
        let samples = gathered.samples;
        let across = gathered.grid.gathered().x;
        let one = |(i, texel): (usize, &Texel)| {
            let (x, sample) = (i as u32 / samples, i as u32 % samples);
            let of = |at: UVec2| {
                let (key, lit) = &gathered.lit[((at.y * across + at.x) * samples + sample) as usize];
                (key, lit)
            };
            let mut lit = gathered.grid.shared(UVec2::new(x, y), &Key::of(&self.sample(texel)), of);
            lit.airlight = lit.airlight.max(Vec3::ZERO);
            lit
        };
        texels.iter().enumerate().map(one).collect()
    }
}

impl Key {
    fn of(sample: &Sample<'_>) -> Self {
        let normal = sample.surface.map_or(Vec3::ZERO, |surface| surface.normal);
        Self { normal, position: sample.ray * sample.distance, fog_m: sample.fog_m }
    }
}

/// How far fog and lights reach: as far as the fog's other light.
pub(crate) fn fog_end_m(world: &World<'_>) -> f64 {
    world.lighting.diagonal_m
}

/// How far is looked: from far outside, surfaces are seen behind the end of the fog.
fn far_m(world: &World<'_>, view: &View) -> f64 {
    far_from(view.eye, &world.tracer.bounds(), fog_end_m(world))
}

/// How far an eye looks at a scene within bounds, in fog that reaches so far.
pub(crate) fn far_from(eye: DVec3, bounds: &antumbra_scene::Bounds, fog_end_m: f64) -> f64 {
    bounds.corners().map(|corner| corner.distance(eye)).into_iter().fold(fog_end_m, f64::max)
}
