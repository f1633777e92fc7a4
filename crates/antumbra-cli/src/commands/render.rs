//! `antumbra render`: a picture of a scene.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use antumbra::{LightKind as BakedKind, LightShadow, Prefilter, ShadowFile};
use antumbra_render::area::AreaTechnique;
use antumbra_render::gpu::{Gpu, GpuRenderer, Lookup, Setting};
use antumbra_render::{Cascades, Fog, MapFilter, Picture, RenderOptions, Renderer, ShadowSource, Time};
use antumbra_scene::{Camera, LightKind, Scene};
use anyhow::{Result, bail};
use clap::ValueEnum;

use crate::area::AreaArgs;
use crate::args::{self, FilterArgs, RunArgs};
use crate::camera::CameraArgs;
use crate::lamp_maps::LampMapArgs;
use crate::output::{self, OutputFile};
use crate::progress::Progress;
use crate::{inputs, lights};

const EXAMPLE: &str =
    "Example:\n  antumbra render city.glb --shadows city.antumbra --filter 5 --size 1920x1080 -o city.png";

/// Draws a picture of a scene, in daylight or lit by its lamps at night.
#[derive(clap::Args)]
#[command(after_help = EXAMPLE)]
pub struct Args {
    /// The scene: .glb, .gltf or .obj
    scene: PathBuf,
    /// A bake of the scene; its lights light the picture
    #[arg(long, value_name = "FILE")]
    shadows: Option<PathBuf>,
    #[command(flatten)]
    camera: CameraArgs,
    /// Pixels
    #[arg(long, value_name = "WxH", value_parser = args::parse_picture_size, default_value = "1280x720")]
    size: [u32; 2],
    /// Where shadows come from [default: dag with --shadows, else traced]
    #[arg(long, value_enum)]
    technique: Option<Technique>,
    #[command(flatten)]
    filter: FilterArgs,
    /// Average baked shadows over what each pixel covers
    #[arg(long, value_enum, value_name = "HOW", default_value_t = PrefilterArg::None)]
    prefilter: PrefilterArg,
    /// Penumbrae of a sun of so many degrees in diameter (the real one has 0.53), which harden on contact; for a bake made
    /// with --enter-depths
    #[arg(long, value_name = "DEG", conflicts_with = "prefilter")]
    penumbra: Option<f64>,
    /// Shadow maps of --technique csm: 1 to 8
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=8))]
    cascades: u32,
    /// Texels per side of each of them: 64 to 8192
    #[arg(long, value_name = "N", default_value_t = 2048, value_parser = clap::value_parser!(u32).range(64..=8192))]
    map_size: u32,
    /// Fog: the share of light that a metre of it takes away, such as 0.002. The sun makes shafts in it
    #[arg(long, value_name = "PER-METRE")]
    fog: Option<f64>,
    #[command(flatten)]
    area: AreaArgs,
    #[command(flatten)]
    lamp_maps: LampMapArgs,
    /// In daylight [default: unless the scene has lamps and no directional light of 10 lux or more]
    #[arg(long, conflicts_with_all = ["night", "area_light"])]
    day: bool,
    /// At night: lit by spot and point lights, and by directional lights of less than 10 lux
    #[arg(long)]
    night: bool,
    /// Rays through each pixel
    #[arg(long, value_name = "N", default_value_t = 4)]
    samples: u32,
    /// What draws. `cpu` and `gpu` draw the same picture by the same passes; `auto` is the processor with gathered light
    #[arg(long, value_enum, default_value_t = Device::Auto)]
    device: Device,
    /// Rays per pixel that gather light from the sky and other surfaces; not on the graphics card [default: 12, or 0 with
    /// --device cpu and gpu]
    #[arg(long, value_name = "RAYS")]
    gather: Option<u32>,
    /// Where to write
    #[arg(short, long, value_name = "OUT.png")]
    output: PathBuf,
    #[command(flatten)]
    run: RunArgs,
}

/// `--technique`.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
enum Technique {
    /// Looked up in the file that --shadows names
    Dag,
    /// Rays towards the light
    Traced,
    /// Cascaded shadow maps of the sun; lamps cast no shadows
    Csm,
}

/// `--prefilter`.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
enum PrefilterArg {
    /// Looked up at full depth
    None,
    /// The mean over the node that is as wide as a pixel
    Mean,
    /// --filter on coarse levels, for a bake made with --levels
    Levels,
}

/// `--device`.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
enum Device {
    /// The processor, with gathered light: the best picture, not the fastest
    Auto,
    /// The processor, by the passes of the graphics card
    Cpu,
    /// The graphics card, or a software one
    Gpu,
}

const NO_RAYS: &str = "the graphics card traces no rays: name a bake with --shadows FILE, or leave out --device gpu";

/// Draws.
pub fn run(args: &Args) -> Result<()> {
    let baked = is_baked(args)?;
    let output = OutputFile::new(&args.output)?;
    let progress = Progress::new(args.run.quiet);
    progress.stage("reading");
    let mut scene = inputs::scene(&args.scene, &[])?;
    let file = args.shadows.as_ref().map(|path| inputs::shadows(path)).transpose()?.map(|(file, _)| Arc::new(file));
    if let Some(file) = &file {
        light_as_baked(&mut scene, file);
    }
    let camera = args.camera.camera(&scene, &args.scene)?;
    let area = if args.day { None } else { args.area.lighting(&scene)? };
    if args.device == Device::Gpu && area.as_ref().is_some_and(|area| area.technique == AreaTechnique::Traced) {
        bail!("the processor alone traces area lights: leave out --device gpu, or --area-shadows traced");
    }
    let by_rays = !baked && args.device != Device::Gpu && args.technique != Some(Technique::Csm);
    let lamp_maps = args.lamp_maps.maps(args.filter.filter(1)?, by_rays);
    let shadows = match (args.technique, &file) {
        (Some(Technique::Csm), _) => maps(args)?,
        (_, Some(file)) if baked => {
            warn_of_policies(&scene, file);
            looked_up(args, file)?
        }
        _ if args.device == Device::Gpu && lamp_maps.is_some() => maps(args)?,
        _ if args.device == Device::Gpu && area.is_none() => bail!("{NO_RAYS}"),
        _ if args.device == Device::Gpu => {
            if !scene.lights.is_empty() && Time::suiting(&scene.lights) == Time::Night {
                let words =
                    "the scene's own lights are left out: on the graphics card they need a bake (--shadows FILE)";
                output::warn(&[words.to_owned()]);
            }
            scene.lights.clear();
            ShadowSource::None
        }
        _ => ShadowSource::Traced,
    };
    let [width, height] = args.size;
    let ao_samples = args.gather.unwrap_or(if args.device == Device::Auto { 12 } else { 0 });
    let options = RenderOptions {
        width,
        height,
        samples: args.samples,
        time: time(args),
        ao_samples,
        area,
        lamp_maps,
        fog: args.fog.map(|density_per_m| Fog { density_per_m, anisotropy: 0.5 }),
        ..RenderOptions::default()
    };
    options.check()?;
    let picture = args.run.pool()?.install(|| match args.device {
        Device::Gpu => draw_on_gpu(scene, &camera, options, (shadows, file.clone(), &args.lamp_maps), &progress),
        Device::Auto | Device::Cpu => draw_on_cpu(&scene, &camera, options, (shadows, &args.lamp_maps), &progress),
    })?;
    progress.stage("writing");
    output.write(&picture.to_png()?)?;
    drop(progress);
    if args.run.quiet {
        return Ok(());
    }
    output::print(&format!("{}: {width} x {height} pixels\n", args.output.display()))
}

/// Whether shadows come from a bake; refuses what a later version brings.
fn is_baked(args: &Args) -> Result<bool> {
    if args.device == Device::Gpu {
        if args.gather.is_some_and(|rays| rays > 0) {
            bail!("--gather sends rays, which the graphics card does not: leave it out, or --device gpu");
        }
        if args.technique == Some(Technique::Traced) {
            bail!("{NO_RAYS}");
        }
    }
    match (args.technique, args.shadows.is_some()) {
        (Some(Technique::Dag), false) => bail!("--technique dag needs a bake: name one with --shadows FILE"),
        (technique, shadows) => {
            let baked = technique.map_or(shadows, |t| t == Technique::Dag);
            if args.prefilter != PrefilterArg::None && !baked {
                bail!("--prefilter averages baked shadows: name a bake with --shadows FILE, and no other --technique");
            }
            if args.filter.continuous && !baked {
                bail!(
                    "--continuous looks up a bake of silhouettes: name one with --shadows FILE, and no other --technique"
                );
            }
            Ok(baked)
        }
    }
}

/// The bake as a source of shadows, filtered as wished.
fn looked_up<'a>(args: &Args, file: &'a ShadowFile) -> Result<ShadowSource<'a>> {
    let filter = args.filter.of_file(1, file)?;
    if args.filter.continuous && (args.penumbra.is_some() || args.prefilter != PrefilterArg::None) {
        bail!("--continuous shadows are hard: leave out --penumbra and --prefilter");
    }
    if let Some(degrees) = args.penumbra {
        if !(degrees > 0.0 && degrees <= 30.0) {
            bail!("--penumbra {degrees}: give more than 0 and at most 30 degrees");
        }
        if !file.lights().any(LightShadow::has_enter_depths) {
            let path = args.shadows.as_deref().unwrap_or(Path::new("the bake"));
            bail!("{} has no enter depths for --penumbra; bake it again with --enter-depths", path.display());
        }
        let sun_tangent = (0.5 * degrees.to_radians()).tan();
        return Ok(ShadowSource::Penumbra { shadows: file, sun_tangent, filter });
    }
    let how = match args.prefilter {
        PrefilterArg::None => return Ok(ShadowSource::Dag { shadows: file, filter }),
        PrefilterArg::Mean if args.filter.filter.is_some() => {
            bail!("--prefilter mean takes no --filter: it averages over nodes; use --prefilter levels with a filter")
        }
        PrefilterArg::Mean => Prefilter::Mean,
        PrefilterArg::Levels => Prefilter::Levels(filter),
    };
    if args.prefilter == PrefilterArg::Levels && !file.lights().any(LightShadow::has_levels) {
        let path = args.shadows.as_deref().unwrap_or(Path::new("the bake"));
        bail!("{} has no coarse levels for --prefilter levels; bake it again with --levels", path.display());
    }
    Ok(ShadowSource::Prefiltered { shadows: file, how })
}

/// Shadow maps as wished: filtered over four texels, or by --filter.
fn maps<'a>(args: &Args) -> Result<ShadowSource<'a>> {
    let filter = match args.filter.filter {
        None => MapFilter::Bilinear,
        Some(_) => MapFilter::Taps(args.filter.filter(1)?),
    };
    let cascades = Cascades { count: args.cascades, size: args.map_size, ..Cascades::default() };
    Ok(ShadowSource::Maps { cascades, filter })
}

fn time(args: &Args) -> Option<Time> {
    match (args.day, args.night) {
        (true, _) => Some(Time::Day),
        (_, true) => Some(Time::Night),
        _ => None,
    }
}

/// Draws on the processor.
fn draw_on_cpu(
    scene: &Scene,
    camera: &Camera,
    mut options: RenderOptions,
    (shadows, lamp_maps): (ShadowSource<'_>, &LampMapArgs),
    progress: &Progress,
) -> Result<Picture> {
    if lamp_maps.has_virtual_lights() {
        progress.stage("tracing light");
        options.virtual_lights = lamp_maps.virtual_lights(&Renderer::new(scene), options.area.as_ref());
    }
    draw(scene, camera, &options, shadows, progress)
}

/// Draws with progress shown.
pub fn draw(
    scene: &Scene,
    camera: &Camera,
    options: &RenderOptions,
    shadows: ShadowSource<'_>,
    progress: &Progress,
) -> Result<Picture> {
    progress.stage("preparing the scene");
    let renderer = Renderer::new(scene);
    warn_of_dark(scene, &renderer.left_dark(shadows));
    progress.count("drawing", 0, "rows");
    let picture = renderer.render(camera, options, shadows, &|done, all| progress.set(done as u64, all as u64))?;
    Ok(picture)
}

/// Draws on the graphics card.
fn draw_on_gpu(
    scene: Scene,
    camera: &Camera,
    mut options: RenderOptions,
    (shadows, bake, lamp_maps): (ShadowSource<'_>, Option<Arc<ShadowFile>>, &LampMapArgs),
    progress: &Progress,
) -> Result<Picture> {
    progress.stage("opening the graphics card");
    let gpu = Gpu::open()?;
    progress.stage("preparing the scene");
    let scene = Arc::new(scene);
    // Rays say how bright lamps make a scene.
    let rays = (is_night(&scene, &options) || lamp_maps.has_virtual_lights()).then(|| Renderer::new(&scene));
    if let Some(rays) = &rays {
        options.virtual_lights = lamp_maps.virtual_lights(rays, options.area.as_ref());
    }
    let area = options.area.as_ref().map_or(&[][..], |area| &area.lights);
    let lookup = match shadows {
        ShadowSource::Dag { filter, .. } => Lookup::Filter(filter),
        ShadowSource::Prefiltered { how, .. } => Lookup::Prefiltered(how),
        ShadowSource::Penumbra { sun_tangent, filter, .. } => Lookup::Penumbra(sun_tangent, filter),
        ShadowSource::Maps { cascades, filter } => Lookup::Maps(cascades, filter),
        _ => Lookup::None,
    };
    // Maps shadow all suns, baked or not.
    let bake = bake.filter(|_| !matches!(lookup, Lookup::Maps(..)));
    let setting = Setting {
        lights: scene.lights.clone(),
        time: options.time,
        area,
        bake,
        has_lamp_maps: options.lamp_maps.is_some(),
        virtual_lights: &options.virtual_lights,
        top_grid: true,
        rays: rays.as_ref(),
    };
    let mut on_gpu = GpuRenderer::new(&gpu, Arc::clone(&scene), setting)?;
    progress.stage("drawing");
    Ok(on_gpu.render(camera, &options, lookup)?)
}

fn is_night(scene: &Scene, options: &RenderOptions) -> bool {
    options.time.unwrap_or_else(|| options.suiting(&scene.lights)) == Time::Night
}

/// Says which lights of the scene the bake lacks. Where it has none at all the picture fails, which says enough.
/// What moves was not baked: it receives shadows in mid-air, which not every policy defines.
fn warn_of_policies(scene: &Scene, file: &ShadowFile) {
    if scene.nodes.iter().any(|node| node.dynamic) {
        let warnings = file.lights().map(|light| lights::policy_warnings(light, "receivers that move"));
        output::warn(&warnings.take(1).flatten().collect::<Vec<_>>());
    }
}

fn warn_of_dark(scene: &Scene, names: &[&str]) {
    if (1..scene.lights.len()).contains(&names.len()) {
        let listed = inputs::listed(names.iter().copied());
        let many = names.len();
        output::warn(&[format!("{many} light(s) of the scene are not in the bake and stay dark: {listed}")]);
    }
}

/// Gives the scene the directional lights of a bake: they shine from where they shone then, and those that `--sun` added
/// are there. Lamps stay as the scene has them.
fn light_as_baked(scene: &mut Scene, file: &ShadowFile) {
    for baked in file.lights().filter(|light| light.kind() == BakedKind::Directional) {
        let direction_world = baked.direction_world();
        let same_name = scene.lights.iter_mut().find(|light| light.name == baked.name());
        match same_name.filter(|light| light.kind == LightKind::Directional) {
            Some(light) => light.direction_world = direction_world,
            None => lights::put(scene, lights::directional(baked.name(), direction_world)),
        }
    }
}
