//! Builds the lights of a bake: directional ones one after the other, each on all threads; local ones side by side.

use std::sync::atomic::{AtomicU64, Ordering};

use antumbra::format::dag8::NodeCounts;
use antumbra::format::enter;
use antumbra::format::slices;
use antumbra::{Encoding, LightKind, LightRecord};
use antumbra_scene::Light;
use rayon::prelude::*;

use crate::bake::{BakeError, BakeOptions, LightReport, Method, Progress, Stage, Stopwatch};
use crate::baseline;
use crate::casters::Casters;
use crate::columns::{Build, BuildError, BuildTriangle, Cutout, EnterGrid, Freedom, build};
use crate::dag::{Id, LIT, Tables};
use crate::light_space::Slices;
use crate::place::{FaceCasters, LightSpace, SpaceRequest, for_each_placed, place_all};
use crate::silhouette::{self, Tree};

/// What all lights of a bake share.
#[derive(Clone, Copy)]
pub(crate) struct Lights<'a> {
    pub casters: &'a Casters<'a>,
    pub options: &'a BakeOptions,
    pub encoding: Encoding,
    pub tables: &'a Tables,
    pub progress: &'a dyn Progress,
}

/// What a face is built into.
pub(crate) enum Nodes {
    /// A root in the shared tables.
    Graph(Id),
    /// A tree of its own.
    Tree(Tree),
}

/// A finished light.
pub(crate) struct BuiltLight {
    pub name: String,
    /// But for name, policy and roots.
    pub record: LightRecord,
    /// One per face.
    pub roots: Vec<Nodes>,
    /// Its part of the `ENTR` section.
    pub enters: Vec<u8>,
    pub stages: Vec<Stage>,
    pub warnings: Vec<String>,
}

impl BuiltLight {
    /// What it took, given what each of its roots added to the pool.
    pub fn report(&self, added: &[(NodeCounts, u64)]) -> LightReport {
        let sum = |count: fn(&NodeCounts) -> u64| added.iter().map(|(counts, _)| count(counts)).sum();
        LightReport {
            name: self.name.clone(),
            kind: self.record.light_kind().unwrap_or(LightKind::Directional),
            resolution: self.record.resolution(),
            texel_size_m: self.record.texel_size_m,
            bytes: added.iter().map(|(_, words)| 4 * words).sum(),
            build_seconds: self.stages.iter().map(|stage| stage.seconds).sum(),
            stages: self.stages.clone(),
            nodes: NodeCounts {
                inner: sum(|c| c.inner),
                slices: sum(|c| c.slices),
                masks: sum(|c| c.masks),
                cuts: sum(|c| c.cuts),
            },
        }
    }
}

/// Memory that lights in the making hold, and how many are done.
#[derive(Default)]
struct Running {
    bytes: AtomicU64,
    done: AtomicU64,
}

impl Lights<'_> {
    /// Builds all lights; results are in their order, and the same whatever the number of threads.
    pub fn build(self, lights: &[Light]) -> Result<Vec<BuiltLight>, BakeError> {
        self.check_slices(lights)?;
        let mut built: Vec<Option<BuiltLight>> = Vec::new();
        let running = Running::default();
        for light in lights {
            let directional = light.kind == antumbra_scene::LightKind::Directional;
            built.push(if directional { Some(self.build_directional(light, &running)?) } else { None });
        }
        let local = built.iter().filter(|light| light.is_none()).count() as u64;
        if local > 0 {
            self.progress.stage(&format!("building {local} spot and point light(s)"));
            let places = built.par_iter_mut().zip(lights).filter(|(place, _)| place.is_none());
            let results: Vec<Result<(), BakeError>> = places
                .map(|(place, light)| {
                    *place = Some(self.build_local(light, &running)?);
                    let done = running.done.fetch_add(1, Ordering::Relaxed) + 1;
                    self.progress.advance(done as f64 / local as f64);
                    Ok(())
                })
                .collect();
            // Of several errors the first light's, whatever the threads did.
            results.into_iter().collect::<Result<(), BakeError>>()?;
        }
        Ok(built.into_iter().flatten().collect())
    }

    /// Before any work: that readers will hold what silhouettes of lamps need beside the file.
    fn check_slices(self, lights: &[Light]) -> Result<(), BakeError> {
        if self.encoding != Encoding::Silhouette {
            return Ok(());
        }
        let lamps = lights.iter().filter(|light| light.kind != antumbra_scene::LightKind::Directional);
        let records = lamps.map(|light| Ok(self.space(light)?.record())).collect::<Result<Vec<_>, BakeError>>()?;
        match slices::table_words(records) {
            words if words > slices::MOST_WORDS => Err(BakeError::Slices { mib: words >> 18 }),
            _ => Ok(()),
        }
    }

    fn build_directional(self, light: &Light, running: &Running) -> Result<BuiltLight, BakeError> {
        self.progress.stage(&format!("placing casters for {}", light.name));
        let all = triangle_bytes(self.casters.len() as u64);
        self.limit().checked_sub(all).ok_or(self.out_of_memory("placing the casters"))?;
        let mut clock = Stopwatch::start();
        let space = self.space(light)?;
        let slices = space.slices();
        let (casters, first_hits) = place_all(self.casters, &space, &slices, &|| self.progress.pause());
        clock.lap("placing casters");
        self.progress.stage(&format!("building {}", light.name));
        let progress = |share| self.progress.advance(share);
        let mut built = self.build_faces(light, &space, &slices, &[casters], running, clock, &progress)?;
        built.warnings.extend(first_hits.warning(self.casters.scene()));
        let is_lit = |nodes: &Nodes| match nodes {
            Nodes::Graph(root) => *root == LIT,
            Nodes::Tree(tree) => tree.is_lit(space.resolution().texels()),
        };
        if built.roots.iter().all(is_lit) {
            built.warnings.push(format!(
                "no caster covers a texel of \"{}\": everything is lit; look at the casters' sizes and places",
                light.name
            ));
        }
        Ok(built)
    }

    fn build_local(self, light: &Light, running: &Running) -> Result<BuiltLight, BakeError> {
        let mut clock = Stopwatch::start();
        let space = self.space(light)?;
        let slices = space.slices();
        let opened = space.opened_parts(self.casters);
        let mut faces = vec![FaceCasters::default(); space.faces()];
        for_each_placed(self.casters, &space, &opened, |face, triangle, caster| {
            faces[face].insert(triangle, caster, &space, &slices, face);
        });
        clock.lap("placing casters");
        self.build_faces(light, &space, &slices, &faces, running, clock, &|_| {})
    }

    fn space(self, light: &Light) -> Result<LightSpace, BakeError> {
        let Self { casters, options, .. } = self;
        let request =
            SpaceRequest { resolution: options.resolution, near_m: options.near_m, distribution: options.local_depth };
        LightSpace::new(casters, light, request, &|| self.progress.pause())
    }

    fn build_faces(
        self,
        light: &Light,
        space: &LightSpace,
        slices: &Slices,
        faces: &[FaceCasters<'_>],
        running: &Running,
        mut clock: Stopwatch,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<BuiltLight, BakeError> {
        let held = self.held_bytes(faces, slices);
        running.bytes.fetch_add(held, Ordering::Relaxed);
        let freedom = space.freedom(self.options.interior);
        let mut enters = Vec::new();
        let built = faces
            .iter()
            .map(|face| self.build_face(face, slices, &freedom, running, &mut enters, progress))
            .collect::<Result<Vec<(Nodes, Vec<Stage>)>, BakeError>>();
        running.bytes.fetch_sub(held, Ordering::Relaxed);
        let mut roots = Vec::with_capacity(faces.len());
        for (root, stages) in built? {
            roots.push(root);
            stages.into_iter().for_each(|stage| clock.add(stage));
        }
        if self.options.method == Method::Columns {
            clock.lap("building columns");
        }
        let mut section = Vec::new();
        if self.options.enter_depths {
            let log2 = space.resolution().log2();
            enter::push(&mut section, enter::log2_cells(log2), enter::shift(log2), &enters);
        }
        Ok(BuiltLight {
            name: light.name.clone(),
            record: LightRecord { encoding: self.encoding as u32, ..space.record() },
            roots,
            enters: section,
            stages: clock.stages,
            warnings: Vec::new(),
        })
    }

    fn build_face(
        self,
        face: &FaceCasters<'_>,
        slices: &Slices,
        freedom: &Freedom,
        running: &Running,
        enters: &mut Vec<Vec<enter::Cell>>,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<(Nodes, Vec<Stage>), BakeError> {
        let memory_limit = self.limit().saturating_sub(running.bytes.load(Ordering::Relaxed));
        let grid = self.options.enter_depths.then(|| EnterGrid::new(slices.resolution()));
        let face = Build {
            triangles: &face.triangles,
            cutouts: &face.cutouts,
            slices,
            freedom,
            enters: grid.as_ref(),
            tables: self.tables,
            memory_limit,
            progress,
            pause: &|| self.progress.pause(),
            plain_code: self.options.plain_code,
        };
        let built = match self.options.method {
            _ if self.encoding == Encoding::Silhouette => {
                silhouette::build(&face).map(|tree| (Nodes::Tree(tree), Vec::new()))
            }
            Method::Columns => build(&face).map(|root| (Nodes::Graph(root), Vec::new())),
            method => {
                let built = baseline::build(baseline::Request::new(&face, method, self.options.cull_identical));
                built.map(|(root, stages)| (Nodes::Graph(root), stages))
            }
        };
        enters.extend(grid.map(|grid| grid.cells()));
        built.map_err(|e| match e {
            BuildError::MemoryLimit => self.out_of_memory("building"),
            BuildError::TooManyNodes => BakeError::TooManyNodes,
            BuildError::Cancelled => BakeError::Cancelled,
        })
    }

    fn held_bytes(self, faces: &[FaceCasters<'_>], slices: &Slices) -> u64 {
        let of_face = |face: &FaceCasters<'_>| {
            let cutouts = face.cutouts.len() * size_of::<Cutout<'_>>();
            triangle_bytes(face.triangles.len() as u64) + cutouts as u64
        };
        let enters = if self.options.enter_depths { EnterGrid::bytes(slices.resolution()) } else { 0 };
        faces.iter().map(of_face).sum::<u64>() + slices.bytes() + enters
    }

    fn limit(self) -> u64 {
        self.options.memory_limit.unwrap_or(u64::MAX)
    }

    fn out_of_memory(self, stage: &'static str) -> BakeError {
        BakeError::Memory { limit: self.limit(), stage }
    }
}

/// Bytes that so many triangles take with their tiles' lists.
fn triangle_bytes(triangles: u64) -> u64 {
    // A list holds every triangle once; those of a tile's descendants add up to less than twice that.
    triangles * (size_of::<BuildTriangle>() as u64 + 3 * 16)
}
