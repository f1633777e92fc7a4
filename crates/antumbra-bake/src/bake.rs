//! From a scene and its lights to a file's bytes.

use std::time::Instant;

use antumbra::format::dag8::NodeCounts;
use antumbra::format::packed::Packing;
use antumbra::format::stat::BakeStats;
use antumbra::format::write::{Contents, write_paced};
use antumbra::{DepthDistribution, Encoding, Interior, LightKind};
use antumbra_scene::{Light, Scene};
use rayon::prelude::*;

use crate::casters::{Blend, CasterOptions, Casters, Inverted};
use crate::dag::{EncodeError, Encoded, Id, LevelsError, Tables, coarse_levels, encode};
use crate::light_space::Resolution;
use crate::lights::{BuiltLight, Lights, Nodes};
use crate::silhouette::{self, Tree};

/// How fine a light's grid is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ResolutionRequest {
    /// The default of the light's kind.
    #[default]
    Default,
    /// So many texels per side and depth slices.
    Texels(Resolution),
    /// The least power of two whose texels are no larger than so many metres.
    TexelSize(f64),
}

/// How a light's graph is constructed. The bytes are good either way; speed, memory and, where a policy leaves a choice,
/// the graph differ.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// By columns: see [`crate::columns`].
    #[default]
    Columns,
    /// As Kämpe et al. 2015 do, for comparison.
    Kampe2015,
    /// As Sintorn et al. 2014 do, for comparison.
    Sintorn2014,
}

impl Method {
    /// As commands and tables call it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Columns => "columns",
            Self::Kampe2015 => "kampe2015",
            Self::Sintorn2014 => "sintorn2014",
        }
    }
}

/// What to bake, and within which limits.
#[derive(Clone, Copy, Debug)]
pub struct BakeOptions {
    /// Where the bake is free to choose.
    pub interior: Interior,
    /// Of every light.
    pub resolution: ResolutionRequest,
    /// Lone closed parts that are turned inward.
    pub inverted: Inverted,
    /// Translucent casters.
    pub blend: Blend,
    /// Casters nearer to a spot or point light than this, along a face's axis, are ignored, metres; `None` for 1/1024 of
    /// its range.
    pub near_m: Option<f64>,
    /// How slices of spot and point lights are spread: logarithmically, but for comparisons.
    pub local_depth: DepthDistribution,
    /// Whether to add coarse levels, for prefiltered lookups. Silhouettes have them without more ado.
    pub levels: bool,
    /// Whether to add enter depths, for blocker lookups.
    pub enter_depths: bool,
    /// How shadows are stored: `None` for [`BakeOptions::encoding_of`].
    pub encoding: Option<Encoding>,
    /// Whether to store silhouettes as they are looked up, so that a file can be mapped and uploaded as it is, rather than packed.
    pub is_unpacked: bool,
    /// How graphs are constructed.
    pub method: Method,
    /// Whether Kämpe et al.'s method reuses the adjacent node in front where that is identical, instead of merging it away
    /// later. The others take no notice.
    pub cull_identical: bool,
    /// No vector instructions but those that every processor of the target has: slower, the same bytes.
    pub plain_code: bool,
    /// Threads; 0 takes one per core.
    pub threads: usize,
    /// Bytes that the bake may hold beside the scene.
    pub memory_limit: Option<u64>,
}

impl BakeOptions {
    /// How shadows are stored: as asked for; else as silhouettes, but as voxel graphs by other methods than columns, which make no others.
    #[must_use]
    pub fn encoding_of(&self) -> Encoding {
        let best = if self.method == Method::Columns { Encoding::Silhouette } else { Encoding::Dag8 };
        self.encoding.unwrap_or(best)
    }
}

impl Default for BakeOptions {
    fn default() -> Self {
        Self {
            interior: Interior::Auto,
            resolution: ResolutionRequest::Default,
            inverted: Inverted::Open,
            blend: Blend::Skip,
            near_m: None,
            local_depth: DepthDistribution::Logarithmic,
            levels: false,
            enter_depths: false,
            encoding: None,
            is_unpacked: false,
            method: Method::Columns,
            cull_identical: true,
            plain_code: false,
            threads: 0,
            memory_limit: None,
        }
    }
}

/// Hears how a bake gets on; called from any thread.
pub trait Progress: Sync {
    /// A new stage begins.
    fn stage(&self, name: &str);
    /// Share of the stage that is done, 0 to 1.
    fn advance(&self, share: f64);
    /// Called by threads at work every small part of a millisecond, wherever they may rest: may block for as long as it
    /// likes. False ends the bake early, with [`BakeError::Cancelled`].
    fn pause(&self) -> bool {
        true
    }
}

/// Hears nothing.
pub struct Silent;

impl Progress for Silent {
    fn stage(&self, _: &str) {}
    fn advance(&self, _: f64) {}
}

/// A finished bake.
#[derive(Clone, Debug)]
pub struct Baked {
    /// The `.antumbra` file.
    pub bytes: Vec<u8>,
    /// One report per light, in the file's order.
    pub lights: Vec<LightReport>,
    /// Bytes of nodes that only coarse levels have.
    pub levels_bytes: u64,
    /// Triangles by what they were judged.
    pub stats: BakeStats,
    /// What all lights share, by stages.
    pub stages: Vec<Stage>,
    /// Threads that built.
    pub threads: usize,
    /// Sentences for whoever asked for the bake.
    pub warnings: Vec<String>,
}

/// A part of the work, and its wall time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stage {
    /// What was done.
    pub name: &'static str,
    /// How long it took; of work that threads do side by side, their sum over the number of threads.
    pub seconds: f64,
}

/// What one light took.
#[derive(Clone, Debug)]
pub struct LightReport {
    /// The light's name.
    pub name: String,
    /// Its kind.
    pub kind: LightKind,
    /// Texels per side.
    pub resolution: u32,
    /// Side of a texel, metres.
    pub texel_size_m: f64,
    /// Bytes of nodes that no earlier light of the file has.
    pub bytes: u64,
    /// Wall time of its construction.
    pub build_seconds: f64,
    /// The same by stages.
    pub stages: Vec<Stage>,
    /// Nodes that no earlier light of the file has.
    pub nodes: NodeCounts,
}

/// Why there is no bake.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BakeError {
    /// Nothing casts a shadow.
    #[error(
        "the scene has no triangles that cast shadows; check --exclude, --blend and \"antumbra\": \"dynamic\" extras"
    )]
    NoCasters,
    /// No lights were given.
    #[error("there is no light to bake; add one with --sun AZIMUTH,ELEVATION")]
    NoLights,
    /// A local light that stands nowhere, or whose range is none.
    #[error("light \"{0}\" has no finite position and range; fix its node's transform or give it a range")]
    LightPlace(String),
    /// A near distance that does not fit a light's range.
    #[error(
        "light \"{light}\" shines to {far_m} m: its near distance cannot be {near_m} m; give --near {least_m:.3e} to less than its range"
    )]
    Near {
        /// The light.
        light: String,
        /// The near distance.
        near_m: f64,
        /// What would do.
        least_m: f64,
        /// The light's range.
        far_m: f64,
    },
    /// A light whose direction is not finite or zero.
    #[error("light \"{0}\" has no direction; fix its node's rotation")]
    LightDirection(String),
    /// A node that lies nowhere.
    #[error(
        "node \"{0}\" lies at coordinates that are no finite numbers of a sane size; fix its transform or add --exclude"
    )]
    Misplaced(String),
    /// A texel size that is none.
    #[error("a texel of {0:e} m cannot be; give a positive number of metres")]
    TexelSizeSign(f64),
    /// More distinct nodes than ids or file offsets can number.
    #[error("the lights need more nodes than a file can hold; lower --resolution or bake fewer lights per file")]
    TooManyNodes,
    /// Lamps whose tables of slices no reader would hold.
    #[error(
        "the lamps' slices need {mib} MiB of tables, one for each ratio of far to near distance, and readers hold 256; lower --resolution, leave out --near, or use --encoding dag8"
    )]
    Slices {
        /// What they need.
        mib: u64,
    },
    /// A policy's length that is none.
    #[error("interior policy {0} needs a length of 0 m or more")]
    Interior(&'static str),
    /// A policy that a method does not know.
    #[error("method {method} knows open and closed geometry only, not {policy}; use the method columns")]
    MethodInterior {
        /// The method.
        method: &'static str,
        /// The policy.
        policy: &'static str,
    },
    /// A method that makes no silhouettes.
    #[error("--method {0} makes no silhouettes; use --encoding dag8")]
    Method(&'static str),
    /// Texels so small that no grid has them.
    #[error(
        "texels of {texel_m:e} m over {extent_m:.1} m need more than 1048576 per side; ask for at least {least_m:.3e} m"
    )]
    TexelSize {
        /// What was asked for.
        texel_m: f64,
        /// Side of the light's grid.
        extent_m: f64,
        /// What would do.
        least_m: f64,
    },
    /// More memory is needed than may be taken, by a careful estimate.
    #[error("the bake needs more than the {} MiB that it may take, at {stage}; allow more or lower --resolution", .limit >> 20)]
    Memory {
        /// The limit.
        limit: u64,
        /// Where it was reached.
        stage: &'static str,
    },
    /// [`Progress::pause`] said so.
    #[error("the bake was cancelled")]
    Cancelled,
    /// The system would not give the threads.
    #[error("cannot start {threads} threads: {reason}; ask for fewer")]
    Threads {
        /// How many.
        threads: usize,
        /// The system's words.
        reason: String,
    },
}

/// Bakes lights of a scene into one file. The same scene, lights and options give the same bytes, whatever the number
/// of threads.
///
/// # Errors
/// [`BakeError`], which says what to do.
pub fn bake(
    scene: &Scene,
    lights: &[Light],
    options: &BakeOptions,
    progress: &dyn Progress,
) -> Result<Baked, BakeError> {
    pool(options.threads)?.install(|| {
        check(lights, options)?;
        progress.stage("finding closed parts");
        let mut clock = Stopwatch::start();
        let casters = judge_casters(scene, options)?;
        clock.lap("finding closed parts");
        bake_lights(&casters, lights, options, progress, clock)
    })
}

/// Threads to work on.
pub(crate) fn pool(threads: usize) -> Result<rayon::ThreadPool, BakeError> {
    let builder = rayon::ThreadPoolBuilder::new().num_threads(threads);
    builder.build().map_err(|e| BakeError::Threads { threads, reason: e.to_string() })
}

/// Chooses and judges the casters as the options say.
pub(crate) fn judge_casters<'a>(scene: &'a Scene, options: &BakeOptions) -> Result<Casters<'a>, BakeError> {
    let find_solids = options.interior != Interior::Open;
    let limit = options.memory_limit.unwrap_or(u64::MAX);
    let caster_options =
        CasterOptions { find_solids, inverted: options.inverted, blend: options.blend, memory_limit: limit };
    let casters =
        Casters::new(scene, caster_options).map_err(|_| BakeError::Memory { limit, stage: "finding closed parts" })?;
    if casters.counts.open + casters.counts.closed == 0 {
        return Err(BakeError::NoCasters);
    }
    Ok(casters)
}

/// Bakes on the current pool.
pub(crate) fn bake_lights(
    casters: &Casters<'_>,
    lights: &[Light],
    options: &BakeOptions,
    progress: &dyn Progress,
    mut clock: Stopwatch,
) -> Result<Baked, BakeError> {
    let mut warnings = casters_warnings(casters, options);
    let tables = Tables::default();
    let encoding = options.encoding_of();
    let mut built = Lights { casters, options, encoding, tables: &tables, progress }.build(lights)?;
    built.iter_mut().for_each(|light| warnings.append(&mut light.warnings));
    clock.skip();
    let mut baked = finish(casters, tables, built, (options, encoding), progress, warnings)?;
    clock.lap("encoding");
    baked.stages = clock.stages;
    Ok(baked)
}

/// Times stages.
pub(crate) struct Stopwatch {
    since: Instant,
    pub stages: Vec<Stage>,
}

impl Stopwatch {
    pub fn start() -> Self {
        Self { since: Instant::now(), stages: Vec::new() }
    }

    /// What has been done since the last lap is a stage.
    pub fn lap(&mut self, name: &'static str) {
        self.add(Stage { name, seconds: self.since.elapsed().as_secs_f64() });
        self.skip();
    }

    /// Adds to a stage that came before, or else a stage.
    pub fn add(&mut self, stage: Stage) {
        match self.stages.iter_mut().find(|before| before.name == stage.name) {
            Some(before) => before.seconds += stage.seconds,
            None => self.stages.push(stage),
        }
    }

    /// What has been done since the last lap does not count.
    pub fn skip(&mut self) {
        self.since = Instant::now();
    }
}

pub(crate) fn check(lights: &[Light], options: &BakeOptions) -> Result<(), BakeError> {
    if let Interior::Thickness(m) | Interior::Static(m) = options.interior
        && !(m >= 0.0 && m.is_finite())
    {
        return Err(BakeError::Interior(options.interior.name()));
    }
    if options.method != Method::Columns && matches!(options.interior, Interior::Thickness(_) | Interior::Static(_)) {
        return Err(BakeError::MethodInterior { method: options.method.name(), policy: options.interior.name() });
    }
    if options.encoding == Some(Encoding::Silhouette) && options.method != Method::Columns {
        return Err(BakeError::Method(options.method.name()));
    }
    let is_direction = |d: glam::DVec3| d.is_finite() && d != glam::DVec3::ZERO;
    let has_direction = |l: &Light| l.kind == antumbra_scene::LightKind::Point || is_direction(l.direction_world);
    if let Some(light) = lights.iter().find(|l| !has_direction(l)) {
        return Err(BakeError::LightDirection(light.name.clone()));
    }
    if let ResolutionRequest::TexelSize(texel_m) = options.resolution
        && !(texel_m > 0.0 && texel_m.is_finite())
    {
        return Err(BakeError::TexelSizeSign(texel_m));
    }
    if lights.is_empty() { Err(BakeError::NoLights) } else { Ok(()) }
}

fn casters_warnings(casters: &Casters<'_>, options: &BakeOptions) -> Vec<String> {
    let mut warnings = Vec::new();
    let counts = &casters.counts;
    if options.interior == Interior::Closed && counts.open > 0 {
        warnings.push(format!("{} of the casters' triangles bound no solid and stay open surfaces", counts.open));
    }
    if counts.lone_inverted_parts > 0 && options.inverted == Inverted::Open {
        let parts = counts.lone_inverted_parts;
        warnings.push(format!(
            "{parts} closed part(s) are turned inside out and lie in no solid; they stay open surfaces (--inverted solid turns them)"
        ));
    }
    warnings
}

fn finish(
    casters: &Casters<'_>,
    tables: Tables,
    mut built: Vec<BuiltLight>,
    (options, encoding): (&BakeOptions, Encoding),
    progress: &dyn Progress,
    warnings: Vec<String>,
) -> Result<Baked, BakeError> {
    let limit = options.memory_limit.unwrap_or(u64::MAX);
    let (mut roots, mut trees): (Vec<(Id, u32)>, Vec<Tree>) = (Vec::new(), Vec::new());
    let mut faces = Vec::with_capacity(built.len());
    for light in &mut built {
        faces.push(light.roots.len());
        for nodes in std::mem::take(&mut light.roots) {
            match nodes {
                Nodes::Graph(root) => roots.push((root, light.record.log2_resolution)),
                Nodes::Tree(tree) => trees.push(tree),
            }
        }
    }
    let light_roots = roots.len() + trees.len();
    let has_levels = options.levels && encoding == Encoding::Dag8;
    if has_levels {
        progress.stage("making coarse levels");
        let mut next = 0;
        let of_lights: Vec<(Vec<Id>, u32)> = built
            .iter()
            .zip(&faces)
            .map(|(light, faces)| {
                let own = roots[next..next + faces].iter().map(|(root, _)| *root).collect();
                next += faces;
                (own, light.record.log2_resolution)
            })
            .collect();
        let lights = of_lights.iter().map(|(roots, log2)| (&roots[..], *log2));
        roots.extend(coarse_levels(&tables, lights, limit, &|| progress.pause()).map_err(|e| match e {
            LevelsError::MemoryLimit => BakeError::Memory { limit, stage: "making coarse levels" },
            LevelsError::TooManyNodes => BakeError::TooManyNodes,
            LevelsError::Cancelled => BakeError::Cancelled,
        })?);
    }
    progress.stage("encoding");
    let encoded: Encoded = match encoding {
        Encoding::Dag8 => encode(tables, &roots, limit, &|| progress.pause()),
        Encoding::Silhouette => silhouette::encode(trees, limit, &|| progress.pause()),
    }
    .map_err(|e| match e {
        EncodeError::MemoryLimit => BakeError::Memory { limit, stage: "encoding" },
        EncodeError::TooManyWords => BakeError::TooManyNodes,
        EncodeError::Cancelled => BakeError::Cancelled,
    })?;
    let (policy, parameter) = options.interior.to_record();
    let mut names = String::new();
    let mut records = Vec::with_capacity(built.len());
    let mut reports = Vec::with_capacity(built.len());
    let mut enters = Vec::new();
    let mut next_root = 0;
    for (light, faces) in built.iter().zip(faces) {
        let of_light = next_root..next_root + faces;
        next_root = of_light.end;
        let mut record = light.record;
        record.name_offset = names.len() as u32;
        record.name_length = light.name.len() as u32;
        names.push_str(&light.name);
        record.interior = policy;
        record.interior_parameter_m = parameter;
        record.roots[..faces].copy_from_slice(&encoded.roots[of_light.clone()]);
        records.push(record);
        enters.extend_from_slice(&light.enters);
        reports.push(light.report(&encoded.added[of_light]));
    }
    let stats = stats(casters);
    let levels_bytes = encoded.added[light_roots..].iter().map(|(_, words)| 4 * words).sum();
    let is_packed = encoding == Encoding::Silhouette && !options.is_unpacked;
    let packed = is_packed.then(|| pack(&encoded.pool, &encoded.roots, progress));
    let mut contents = Contents::new(&records, &names, &encoded.pool, stats);
    contents.packed = packed.as_deref();
    contents.levels = has_levels.then_some(&encoded.roots[light_roots..]);
    contents.enters = options.enter_depths.then_some(&enters[..]);
    let bytes = write_paced(&contents, &mut || _ = progress.pause());
    if !progress.pause() {
        return Err(BakeError::Cancelled);
    }
    Ok(Baked {
        bytes,
        lights: reports,
        levels_bytes,
        stats,
        stages: Vec::new(),
        threads: rayon::current_num_threads(),
        warnings,
    })
}

/// Packs silhouettes, on all threads.
fn pack(pool: &[u32], roots: &[u32], progress: &dyn Progress) -> Vec<u8> {
    let pause = || _ = progress.pause();
    let packing = Packing::new(pool, roots.iter().copied(), &pause);
    let deflated: Vec<Vec<u8>> =
        (0..packing.pieces()).into_par_iter().map(|piece| packing.deflate(piece, &pause)).collect();
    packing.finish(&deflated)
}

fn stats(casters: &Casters<'_>) -> BakeStats {
    let scene = casters.scene();
    let counts = casters.counts;
    BakeStats {
        triangles_total: scene.triangle_count(),
        triangles_closed: counts.closed,
        triangles_cavity: counts.cavity,
        triangles_open: counts.open,
        triangles_alpha_masked: counts.alpha_masked,
        triangles_dropped: scene.dropped.total(),
        triangles_left_out: counts.left_out,
        zero: 0,
    }
}
