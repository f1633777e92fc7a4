//! From a scene and its lights to a file's bytes.

use std::time::Instant;

use antumbra::format::dag8::NodeCounts;
use antumbra::format::stat::BakeStats;
use antumbra::format::write::{Contents, write};
use antumbra::{Interior, LightKind, LightRecord};
use antumbra_scene::{Light, Scene};

use crate::casters::occluder::FirstHits;
use crate::casters::{Blend, CasterOptions, Casters, Inverted};
use crate::columns::{Build, BuildError, BuildTriangle, build};
use crate::dag::{EncodeError, Encoded, Id, LIT, Tables, encode};
use crate::light_space::Resolution;
use crate::place::{fit_directional, for_each_placed};

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
    /// Threads; 0 takes one per core.
    pub threads: usize,
    /// Bytes that the bake may hold beside the scene.
    pub memory_limit: Option<u64>,
}

impl Default for BakeOptions {
    fn default() -> Self {
        Self {
            interior: Interior::Auto,
            resolution: ResolutionRequest::Default,
            inverted: Inverted::Open,
            blend: Blend::Skip,
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
    /// Triangles by what they were judged.
    pub stats: BakeStats,
    /// Threads that built.
    pub threads: usize,
    /// Sentences for whoever asked for the bake.
    pub warnings: Vec<String>,
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
    /// A light of a kind that cannot be baked.
    #[error("light \"{0}\" is no directional light: this version bakes directional lights only")]
    LightKind(String),
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
    /// A policy that is not there.
    #[error("interior policy {0} is not in this version; use auto, open or closed")]
    Interior(&'static str),
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
    let builder = rayon::ThreadPoolBuilder::new().num_threads(options.threads);
    let pool = builder.build().map_err(|e| BakeError::Threads { threads: options.threads, reason: e.to_string() })?;
    pool.install(|| bake_here(scene, lights, options, progress))
}

fn bake_here(
    scene: &Scene,
    lights: &[Light],
    options: &BakeOptions,
    progress: &dyn Progress,
) -> Result<Baked, BakeError> {
    check(lights, options)?;
    progress.stage("finding closed parts");
    let find_solids = options.interior != Interior::Open;
    let limit = options.memory_limit.unwrap_or(u64::MAX);
    let caster_options =
        CasterOptions { find_solids, inverted: options.inverted, blend: options.blend, memory_limit: limit };
    let casters =
        Casters::new(scene, caster_options).map_err(|_| BakeError::Memory { limit, stage: "finding closed parts" })?;
    if casters.counts.open + casters.counts.closed == 0 {
        return Err(BakeError::NoCasters);
    }
    let mut warnings = casters_warnings(&casters, options);
    let tables = Tables::default();
    let mut built = Vec::with_capacity(lights.len());
    for light in lights {
        built.push(build_light(&casters, light, options, &tables, progress, &mut warnings)?);
    }
    progress.stage("encoding");
    finish(scene, &casters, tables, built, lights, options, warnings)
}

fn check(lights: &[Light], options: &BakeOptions) -> Result<(), BakeError> {
    if matches!(options.interior, Interior::Thickness(_) | Interior::Static(_)) {
        return Err(BakeError::Interior(options.interior.name()));
    }
    if let Some(light) = lights.iter().find(|l| l.kind != antumbra_scene::LightKind::Directional) {
        return Err(BakeError::LightKind(light.name.clone()));
    }
    let has_direction = |l: &Light| l.direction_world.is_finite() && l.direction_world != glam::DVec3::ZERO;
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
    if counts.alpha_masked > 0 {
        let masked = counts.alpha_masked;
        warnings
            .push(format!("{masked} alpha-masked triangles cast as if opaque: this version does not test alpha masks"));
    }
    warnings
}

struct BuiltLight {
    record: LightRecord,
    root: Id,
    seconds: f64,
}

fn build_light(
    casters: &Casters<'_>,
    light: &Light,
    options: &BakeOptions,
    tables: &Tables,
    progress: &dyn Progress,
    warnings: &mut Vec<String>,
) -> Result<BuiltLight, BakeError> {
    let start = Instant::now();
    progress.stage(&format!("placing casters for {}", light.name));
    let space = fit_directional(casters, light.direction_world, options.resolution)?;
    let limit = options.memory_limit.unwrap_or(u64::MAX);
    let out_of_memory = |stage| BakeError::Memory { limit, stage };
    let casters_bytes = triangle_bytes(casters.len() as u64);
    let tables_limit = limit.checked_sub(casters_bytes).ok_or(out_of_memory("placing the casters"))?;
    let mut triangles = Vec::with_capacity(casters.len());
    let mut first_hits = FirstHits::default();
    for_each_placed(casters, &space, |t, node| {
        first_hits.insert(t, node);
        triangles.extend(BuildTriangle::new(t, space.resolution()));
    });
    warnings.extend(first_hits.warning(casters.scene()));
    progress.stage(&format!("building {}", light.name));
    let root = build(&Build {
        triangles: &triangles,
        resolution: space.resolution(),
        tables,
        memory_limit: tables_limit,
        progress: &|share| progress.advance(share),
    });
    let root = root.map_err(|e| match e {
        BuildError::MemoryLimit => out_of_memory("building"),
        BuildError::TooManyNodes => BakeError::TooManyNodes,
    })?;
    if root == LIT {
        let name = &light.name;
        warnings.push(format!(
            "no caster covers a texel of \"{name}\": everything is lit; look at the casters' sizes and places"
        ));
    }
    Ok(BuiltLight { record: space.record(), root, seconds: start.elapsed().as_secs_f64() })
}

/// Bytes that so many triangles take with their tiles' lists.
fn triangle_bytes(triangles: u64) -> u64 {
    // A list holds every triangle once; those of a tile's descendants add up to less than twice that.
    triangles * (size_of::<BuildTriangle>() as u64 + 3 * 16)
}

fn finish(
    scene: &Scene,
    casters: &Casters<'_>,
    tables: Tables,
    built: Vec<BuiltLight>,
    lights: &[Light],
    options: &BakeOptions,
    warnings: Vec<String>,
) -> Result<Baked, BakeError> {
    let roots: Vec<(Id, u32)> = built.iter().map(|b| (b.root, b.record.log2_resolution)).collect();
    let limit = options.memory_limit.unwrap_or(u64::MAX);
    let encoded: Encoded = encode(tables, &roots, limit).map_err(|e| match e {
        EncodeError::MemoryLimit => BakeError::Memory { limit, stage: "encoding" },
        EncodeError::TooManyWords => BakeError::TooManyNodes,
    })?;
    let (policy, parameter) = options.interior.to_record();
    let mut names = String::new();
    let mut records = Vec::with_capacity(built.len());
    let mut reports = Vec::with_capacity(built.len());
    for (i, (built, light)) in built.into_iter().zip(lights).enumerate() {
        let mut record = built.record;
        record.name_offset = names.len() as u32;
        record.name_length = light.name.len() as u32;
        names.push_str(&light.name);
        record.interior = policy;
        record.interior_parameter_m = parameter;
        record.roots[0] = encoded.roots[i];
        records.push(record);
        let (nodes, words) = encoded.added[i];
        reports.push(LightReport {
            name: light.name.clone(),
            kind: LightKind::Directional,
            resolution: record.resolution(),
            texel_size_m: record.texel_size_m,
            bytes: 4 * words,
            build_seconds: built.seconds,
            nodes,
        });
    }
    let stats = stats(scene, casters);
    let bytes = write(&Contents::new(&records, &names, &encoded.pool, stats));
    Ok(Baked { bytes, lights: reports, stats, threads: rayon::current_num_threads(), warnings })
}

fn stats(scene: &Scene, casters: &Casters<'_>) -> BakeStats {
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
