//! The passes' programs: which text, which bindings.

use super::scene::GEOMETRY_SLOTS;
use super::targets::{DEPTH_FORMAT, VISIBLE_FORMAT};
use super::{Gpu, Kernel, Slot};
use crate::area::{Gathering, Interpolation};
use crate::passes::lamp_maps::MapProjection;

const FRAME: &str = include_str!("frame.wgsl");
const TEXEL: &str = include_str!("../passes/gbuffer/texel.wgsl");
const GEOMETRY: &str = include_str!("../passes/gbuffer/geometry.wgsl");
const RASTER: &str = include_str!("../passes/gbuffer/raster.wgsl");
const RESOLVE: &str = include_str!("../passes/gbuffer/resolve.wgsl");
const SUN: &str = include_str!("../passes/shadow/sun.wgsl");
const LOOKUP: &str = include_str!("../passes/shadow/lookup.wgsl");
const SHADOW: &str = include_str!("../passes/shadow/shadow.wgsl");
const CASCADE: &str = include_str!("../passes/csm/cascade.wgsl");
const CSM: &str = include_str!("../passes/csm/csm.wgsl");
const DEPTH: &str = include_str!("../passes/csm/depth.wgsl");
const FOG: &str = include_str!("../passes/fog/fog.wgsl");
const SKY: &str = include_str!("../passes/shade/sky.wgsl");
const BRDF: &str = include_str!("../passes/shade/brdf.wgsl");
const SHADE: &str = include_str!("../passes/shade/shade.wgsl");
const TONEMAP: &str = include_str!("../passes/tonemap/tonemap.wgsl");
const METER: &str = include_str!("../passes/tonemap/meter.wgsl");
const LAMP: &str = include_str!("../passes/lamps/lamp.wgsl");
const BOXES: &str = include_str!("../passes/lamps/boxes.wgsl");
const CLUSTERS: &str = include_str!("../passes/lamps/clusters.wgsl");
const LISTS: &str = include_str!("../passes/lamps/lists.wgsl");
const LAMPS: &str = include_str!("../passes/lamps/lamps.wgsl");
const LAMPS_SHARED: &str = include_str!("../passes/lamps/shared.wgsl");
const GRID: &str = include_str!("../passes/culling/grid.wgsl");
const CLUSTER: &str = include_str!("../passes/culling/cluster.wgsl");
const MAP_TARGET: &str = include_str!("../passes/lamp_maps/target.wgsl");
const LAMP_MAP: &str = include_str!("../passes/lamp_maps/map.wgsl");
const MAP_LOOKUP: &str = include_str!("../passes/lamp_maps/lookup.wgsl");
const MAP_LIGHT: &str = include_str!("../passes/lamp_maps/light.wgsl");
const VPL: &str = include_str!("../passes/ivsv/vpl.wgsl");
const MAP: &str = include_str!("../passes/ivsv/map.wgsl");
const AIRLIGHT: &str = include_str!("../passes/ivsv/airlight.wgsl");
const LIGHTS: &str = include_str!("../passes/ivsv/lights.wgsl");
const CONSTANTS: &str = "const PI: f32 = 3.14159265;";

use Slot::{DepthLayers, Read, ReadAt, Uints, Write};

/// How passes look up shadows. Each way has programs of its own: a branch that is never taken costs registers, and on some
/// cards time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Way {
    /// 0 not at all, 1 filtered, 2 means, 3 levels, 4 penumbrae, 5 in maps.
    pub shadow: u32,
    /// Whether there are shadow maps: of everything, or of what moves.
    pub has_maps: bool,
}

/// The text of each pass, for tests without a driver. `lookups` is that of the baked lights.
pub(crate) fn sources(lookups: &str, way: Way) -> Vec<(&'static str, String)> {
    let way = format!("const SHADOW: u32 = {}u;\nconst HAS_MAPS: bool = {};\n", way.shadow, way.has_maps);
    let way = &way[..];
    vec![
        ("raster", [FRAME, GEOMETRY, RASTER].concat()),
        ("resolve", [FRAME, TEXEL, GEOMETRY, RESOLVE].concat()),
        ("shadow map", [FRAME, GEOMETRY, CASCADE, DEPTH].concat()),
        ("sun shadows", [lookups, way, FRAME, TEXEL, CONSTANTS, BRDF, SUN, CASCADE, CSM, LOOKUP, SHADOW].concat()),
        ("fog", [lookups, way, FRAME, TEXEL, CONSTANTS, SUN, CASCADE, CSM, FOG].concat()),
        ("shading", [FRAME, TEXEL, SKY, BRDF, SUN, SHADE].concat()),
        ("tone mapping", [FRAME, TONEMAP].concat()),
        ("meter", [FRAME, METER].concat()),
        ("tile boxes", [FRAME, TEXEL, LAMP, BOXES].concat()),
        ("clusters", [FRAME, LAMP, CLUSTERS].concat()),
        ("light lists", [FRAME, LAMP, LISTS].concat()),
        ("lamps", [lookups, way, FRAME, TEXEL, CONSTANTS, BRDF, LAMP, LAMPS_SHARED, LOOKUP, LAMPS].concat()),
    ]
}

/// How area lights' shadows are looked up and gathered: constants of `gather.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct GatherWay {
    /// 0 none, 1 in voxels, 2 in maps.
    pub shadows: u32,
    pub gathering: Gathering,
    pub interpolation: Interpolation,
    pub is_exact: bool,
    /// Texels of 128 bits along phi.
    pub quads: u32,
}

/// The text of each pass of area lights.
pub(crate) fn area_sources(way: GatherWay) -> Vec<(&'static str, String)> {
    let GatherWay { shadows, quads, is_exact, .. } = way;
    let gathering = way.gathering as u32;
    let interpolation = way.interpolation as u32;
    let constants = format!(
        "{CONSTANTS}\nconst SHADOWS: u32 = {shadows}u;\nconst GATHERING: u32 = {gathering}u;\n\
         const INTERPOLATION: u32 = {interpolation}u;\nconst EXACT: bool = {is_exact};\nconst QUADS: u32 = {quads}u;\n"
    );
    let own = |name, parts: &[&str]| (name, [&[VPL], parts].concat().concat());
    vec![
        own("place points", &[include_str!("../passes/ivsv/place.wgsl")]),
        own("clear maps", &[include_str!("../passes/ivsv/clear.wgsl")]),
        own("splat", &[FRAME, include_str!("../passes/ivsv/splat.wgsl")]),
        own("rectify", &[MAP, include_str!("../passes/ivsv/rectify.wgsl")]),
        own("scan", &[include_str!("../passes/ivsv/scan.wgsl")]),
        own("begin", &[include_str!("../passes/ivsv/begin.wgsl")]),
        own("extrude", &[include_str!("../passes/ivsv/extrude.wgsl")]),
        own("gather", &[&constants, FRAME, TEXEL, BRDF, MAP, AIRLIGHT, include_str!("../passes/ivsv/gather.wgsl")]),
        ("light surfaces", [CONSTANTS, FRAME, TEXEL, LIGHTS, include_str!("../passes/ivsv/show.wgsl")].concat()),
        ("share", [&constants, FRAME, TEXEL, LIGHTS, include_str!("../passes/ivsv/share.wgsl")].concat()),
    ]
}

/// Programs of area lights that do not depend on how they are gathered.
#[derive(Debug)]
pub(crate) struct AreaPasses {
    pub place: Kernel,
    pub clear: Kernel,
    pub splat: Kernel,
    pub rectify: Kernel,
    pub scan: Kernel,
    pub begin: Kernel,
    pub extrude: Kernel,
    pub show: Kernel,
}

/// Programs that gather the light of area lights in one way.
#[derive(Debug)]
pub(crate) struct AreaGather {
    pub gather: Kernel,
    pub share: Kernel,
}

impl AreaPasses {
    pub fn new(gpu: &Gpu, way: GatherWay) -> Self {
        let sources = area_sources(way);
        let kernel = |name: &str, slots: &[Slot]| gpu.kernel(name, source(&sources, name), &[slots]);
        Self {
            place: kernel("place points", &[Read, Read, Read, Write]),
            clear: kernel("clear maps", &[Read, Write]),
            splat: kernel("splat", &[Read, Read, Read, Read, Write]),
            rectify: kernel("rectify", &[Read, Read, Read, Write]),
            scan: kernel("scan", &[Read, Read, Write]),
            begin: kernel("begin", &[Read, Read, Write]),
            extrude: kernel("extrude", &[Read, Read, Write, Read]),
            show: kernel("light surfaces", &[Read, Read, Read, Write]),
        }
    }
}

impl AreaGather {
    pub fn new(gpu: &Gpu, way: GatherWay) -> Self {
        let sources = area_sources(way);
        let kernel = |name: &str, slots: &[Slot]| gpu.kernel(name, source(&sources, name), &[slots]);
        Self {
            gather: kernel("gather", &[Read, Read, Read, Read, Read, Read, Read, Write]),
            share: kernel("share", &[Read, Read, Read, Read, Read, Write]),
        }
    }
}

/// The text of each pass of voxel culling; `marking` says how cells are marked (see `mark.wgsl`).
pub(crate) fn culling_sources(marking: u32, projection: MapProjection) -> Vec<(&'static str, String)> {
    let vertices = super::lamp_maps::vertices(projection);
    let constants = format!("const MARKING: u32 = {marking}u;\nconst VERTICES: u32 = {vertices}u;\n");
    let bins = |fill: bool| {
        let fill = format!("const FILL: bool = {fill};\n");
        [FRAME, GEOMETRY, GRID, &fill, include_str!("../passes/culling/bins.wgsl")].concat()
    };
    let scan = |step: u32| {
        let step = format!("const STEP: u32 = {step}u;\n");
        [GRID, &step, include_str!("../passes/culling/scan.wgsl")].concat()
    };
    let clusters = |text: &str| [GRID, CLUSTER, &constants, text].concat();
    let target = match projection {
        MapProjection::Cube => include_str!("../passes/lamp_maps/cube.wgsl"),
        MapProjection::Paraboloid => include_str!("../passes/lamp_maps/paraboloid.wgsl"),
    };
    vec![
        ("count triangles", bins(false)),
        ("bin triangles", bins(true)),
        ("sums", scan(0)),
        ("spine", scan(1)),
        ("spread", scan(2)),
        ("receivers", [FRAME, TEXEL, GRID, include_str!("../passes/culling/receivers.wgsl")].concat()),
        ("cells", clusters(include_str!("../passes/culling/cells.wgsl"))),
        ("mark", clusters(include_str!("../passes/culling/mark.wgsl"))),
        ("frusta", clusters(include_str!("../passes/culling/frusta.wgsl"))),
        ("reuse", clusters(include_str!("../passes/culling/reuse.wgsl"))),
        ("survivors", clusters(include_str!("../passes/culling/survivors.wgsl"))),
        ("list", clusters(include_str!("../passes/culling/list.wgsl"))),
        ("lamp map", [FRAME, GEOMETRY, GRID, MAP_TARGET, target].concat()),
    ]
}

/// The text of the pass that looks lamps up in their maps.
pub(crate) fn mapped_source(lookups: &str, way: Way, projection: MapProjection) -> String {
    let is_cube = projection == MapProjection::Cube;
    let way = format!("const SHADOW: u32 = {}u;\nconst IS_CUBE: bool = {is_cube};\n", way.shadow);
    let parts =
        [lookups, &way, FRAME, TEXEL, CONSTANTS, BRDF, LAMP, LAMPS_SHARED, LOOKUP, LAMP_MAP, MAP_LOOKUP, MAP_LIGHT];
    parts.concat()
}

/// The program that looks lamps up in their maps.
pub(crate) fn mapped_kernel(gpu: &Gpu, way: Way, projection: MapProjection, lookups: &str, slots: &[Slot]) -> Kernel {
    let own: &[Slot] = &[Read, Read, Read, Read, Write, Read, Read, Read];
    gpu.kernel("mapped lamps", &mapped_source(lookups, way, projection), &[own, slots, &[DepthLayers]])
}

/// Programs of voxel culling.
#[derive(Debug)]
pub(crate) struct CullPasses {
    pub count: Kernel,
    pub fill: Kernel,
    /// Sums of blocks, sums before blocks, sums before cells.
    pub scan: [Kernel; 3],
    pub receivers: Kernel,
    pub cells: Kernel,
    pub mark: Kernel,
    pub frusta: Kernel,
    pub reuse: Kernel,
    pub survivors: Kernel,
    pub list: Kernel,
}

impl CullPasses {
    pub fn new(gpu: &Gpu, marking: u32, projection: MapProjection) -> Self {
        let sources = culling_sources(marking, projection);
        let kernel = |name: &str, groups: &[&[Slot]]| gpu.kernel(name, source(&sources, name), groups);
        let bins = |name| kernel(name, &[&GEOMETRY_SLOTS, &[Read, Read, Write, Read, Write, Write, Write]]);
        Self {
            count: bins("count triangles"),
            fill: bins("bin triangles"),
            scan: ["sums", "spine", "spread"].map(|name| kernel(name, &[&[Read, Read, Write, Write]])),
            receivers: kernel("receivers", &[&[Read, Read, Read, Write]]),
            cells: kernel("cells", &[&[Read, Read, Read, Write, Write]]),
            mark: kernel("mark", &[&[Read, Read, Read, Read, Write]]),
            frusta: kernel("frusta", &[&[Read, Read, Read, Read, Read, Write]]),
            reuse: kernel("reuse", &[&[Read, Read, Read, Read, Read, Write, Write]]),
            survivors: kernel("survivors", &[&[Read, Read, Read, Read, Read, Read, Read, Write, Read]]),
            list: kernel("list", &[&[Read, Read, Read, Read, Read, Read, Read, Write, Write, Read]]),
        }
    }
}

/// Draws triangles into lamps' maps.
#[derive(Debug)]
pub(crate) struct MapRaster {
    pub layouts: [wgpu::BindGroupLayout; 3],
    pub opaque: wgpu::RenderPipeline,
    pub cut_out: wgpu::RenderPipeline,
    /// Clears a side.
    pub clear: wgpu::RenderPipeline,
}

impl MapRaster {
    pub fn new(gpu: &Gpu, projection: MapProjection) -> Self {
        let sources = culling_sources(0, projection);
        let stages = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let layouts = [
            gpu.layout(&GEOMETRY_SLOTS, stages),
            gpu.layout(&[Read, Read, Read, Read, Read], stages),
            gpu.layout(&[ReadAt], stages),
        ];
        let text = source(&sources, "lamp map");
        let make = Pipelines::new(gpu, "lamp map", text, &layouts, wgpu::CompareFunction::Greater);
        let opaque = (projection == MapProjection::Paraboloid).then_some("opaque");
        let opaque = make.pipeline("corner", opaque, &[]);
        let cut_out = make.pipeline("corner_cut_out", Some("cut_out"), &[]);
        let make = Pipelines { nearer: wgpu::CompareFunction::Always, ..make };
        let clear = make.pipeline("everything", None, &[]);
        Self { layouts, opaque, cut_out, clear }
    }
}

/// Programs that do not depend on the bake.
#[derive(Debug)]
pub(crate) struct Passes {
    pub raster: Raster,
    pub shadow_map: DepthRaster,
    pub resolve: Kernel,
    pub shade: Kernel,
    pub tonemap: Kernel,
    pub meter: Kernel,
    pub boxes: Kernel,
    pub clusters: Kernel,
    pub lists: Kernel,
}

/// Programs that look up baked shadows.
#[derive(Debug)]
pub(crate) struct Lookups {
    pub sun: Kernel,
    pub fog: Kernel,
    pub lamps: Kernel,
}

fn source<'a>(sources: &'a [(&str, String)], name: &str) -> &'a str {
    sources.iter().find(|(known, _)| *known == name).map_or("", |(_, text)| text)
}

impl Passes {
    pub fn new(gpu: &Gpu) -> Self {
        let sources = sources("", Way::default());
        let kernel = |name: &str, groups: &[&[Slot]]| gpu.kernel(name, source(&sources, name), groups);
        Self {
            raster: Raster::new(gpu, source(&sources, "raster")),
            shadow_map: DepthRaster::new(gpu, source(&sources, "shadow map")),
            resolve: kernel("resolve", &[&GEOMETRY_SLOTS, &[Uints, Write]]),
            shade: kernel("shading", &[&[Read, Read, Read, Read, Read, Write, Read, Read]]),
            tonemap: kernel("tone mapping", &[&[Read, Read, Write]]),
            meter: kernel("meter", &[&[Read, Read, Write]]),
            boxes: kernel("tile boxes", &[&[Read, Read, Write]]),
            clusters: kernel("clusters", &[&[Read, Write]]),
            lists: kernel("light lists", &[&[Read, Read, Read, Write]]),
        }
    }
}

impl Lookups {
    pub fn new(gpu: &Gpu, lookups: &str, slots: &[Slot], way: Way) -> Self {
        let sources = sources(lookups, way);
        let kernel = |name: &str, groups: &[&[Slot]]| gpu.kernel(name, source(&sources, name), groups);
        Self {
            sun: kernel("sun shadows", &[&[Read, Read, Read, Write], slots, &[Read, DepthLayers]]),
            lamps: kernel("lamps", &[&[Read, Read, Read, Read, Write, Write, Read], slots]),
            fog: kernel("fog", &[&[Read, Read, Read, Write], slots, &[Read, DepthLayers]]),
        }
    }
}

/// Draws triangles into the visibility buffer.
#[derive(Debug)]
pub(crate) struct Raster {
    pub layout: wgpu::BindGroupLayout,
    pub opaque: wgpu::RenderPipeline,
    pub cut_out: wgpu::RenderPipeline,
}

impl Raster {
    fn new(gpu: &Gpu, text: &str) -> Self {
        let layouts = [gpu.layout(&GEOMETRY_SLOTS, wgpu::ShaderStages::VERTEX_FRAGMENT)];
        let make = Pipelines::new(gpu, "raster", text, &layouts, wgpu::CompareFunction::Greater);
        let targets = [Some(VISIBLE_FORMAT.into())];
        let pipeline = |fragment| make.pipeline("corner", Some(fragment), &targets);
        let (opaque, cut_out) = (pipeline("opaque"), pipeline("cut_out"));
        let [layout] = layouts;
        Self { layout, opaque, cut_out }
    }
}

/// Draws the depth of triangles into shadow maps.
#[derive(Debug)]
pub(crate) struct DepthRaster {
    pub layouts: [wgpu::BindGroupLayout; 2],
    pub opaque: wgpu::RenderPipeline,
    pub cut_out: wgpu::RenderPipeline,
}

impl DepthRaster {
    fn new(gpu: &Gpu, text: &str) -> Self {
        let stages = wgpu::ShaderStages::VERTEX_FRAGMENT;
        let layouts = [gpu.layout(&GEOMETRY_SLOTS, stages), gpu.layout(&[Read], stages)];
        let make = Pipelines::new(gpu, "shadow map", text, &layouts, wgpu::CompareFunction::Less);
        let pipeline = |fragment| make.pipeline("corner", fragment, &[]);
        let (opaque, cut_out) = (pipeline(None), pipeline(Some("cut_out")));
        Self { layouts, opaque, cut_out }
    }
}

/// What pipelines that draw triangles have in common.
struct Pipelines<'a> {
    gpu: &'a Gpu,
    module: wgpu::ShaderModule,
    layout: wgpu::PipelineLayout,
    nearer: wgpu::CompareFunction,
}

impl<'a> Pipelines<'a> {
    fn new(
        gpu: &'a Gpu,
        label: &str,
        text: &str,
        layouts: &[wgpu::BindGroupLayout],
        nearer: wgpu::CompareFunction,
    ) -> Self {
        let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(label),
            source: wgpu::ShaderSource::Wgsl(text.into()),
        });
        let layout = gpu.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(label),
            bind_group_layouts: &layouts.iter().map(Some).collect::<Vec<_>>(),
            immediate_size: 0,
        });
        Self { gpu, module, layout, nearer }
    }

    /// With a fragment shader, or depth alone.
    fn pipeline(
        &self,
        vertex: &str,
        fragment: Option<&str>,
        targets: &[Option<wgpu::ColorTargetState>],
    ) -> wgpu::RenderPipeline {
        self.gpu.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: fragment,
            layout: Some(&self.layout),
            vertex: wgpu::VertexState {
                module: &self.module,
                entry_point: Some(vertex),
                compilation_options: Default::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH_FORMAT,
                depth_write_enabled: Some(true),
                depth_compare: Some(self.nearer),
                stencil: Default::default(),
                bias: Default::default(),
            }),
            multisample: Default::default(),
            fragment: fragment.map(|entry_point| wgpu::FragmentState {
                module: &self.module,
                entry_point: Some(entry_point),
                compilation_options: Default::default(),
                targets,
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use antumbra::shaders;
    use naga::valid::{Capabilities, ValidationFlags, Validator};

    use super::*;
    use crate::gpu::area::{Batch, GpuAreaLight, GpuVpl};
    use crate::gpu::csm::GpuCascade;
    use crate::gpu::culling::{Chunk, CullGrid, GpuCluster};
    use crate::gpu::frame::{Frame, GpuLamp};
    use crate::gpu::lamp_maps::{MAP_SIDE_BYTES, MapLayout, MapSide, MappedLamp};
    use crate::passes::ivsv::cloud::Share;

    fn parsed((name, text): (&'static str, String)) -> (&'static str, naga::Module) {
        let module =
            naga::front::wgsl::parse_str(&text).unwrap_or_else(|e| panic!("{name}: {}", e.emit_to_string(&text)));
        let mut validator = Validator::new(ValidationFlags::all(), Capabilities::SHADER_FLOAT16_IN_FLOAT32);
        validator.validate(&module).unwrap_or_else(|e| panic!("{name}: {}", e.emit_to_string(&text)));
        (name, module)
    }

    fn modules() -> Vec<(&'static str, naga::Module)> {
        let lookups = shaders::source(&shaders::Lookup { group: 1, binding: 1, ..shaders::Lookup::default() });
        let ways = (0..6).map(|shadow| Way { shadow, has_maps: shadow % 2 == 1 });
        ways.flat_map(|way| sources(&lookups, way)).map(parsed).collect()
    }

    /// Names and offsets of a struct's members, and its size.
    fn layout(module: &naga::Module, name: &str) -> Option<(Vec<(String, usize)>, usize)> {
        let (_, found) = module.types.iter().find(|(_, t)| t.name.as_deref() == Some(name))?;
        let naga::TypeInner::Struct { members, span } = &found.inner else { return None };
        let member = |m: &naga::StructMember| (m.name.clone().unwrap_or_default(), m.offset as usize);
        Some((members.iter().map(member).collect(), *span as usize))
    }

    macro_rules! offsets {
        ($of:ty: $($member:ident)*) => {
            (vec![$((stringify!($member).to_owned(), offset_of!($of, $member))),*], size_of::<$of>())
        };
    }

    #[test]
    fn passes_are_valid_and_their_structs_lie_in_memory_as_here() {
        let frame = offsets!(Frame: right up forward size sample samples jitter footprint near visible_m glow suns stars
            towards_sun sun_azimuth plain overhead disc exposure lamps radius kernel sun_tangent tile tiles_x layers
            list_words first_layer_m layer_ratio cascades fog_per_m fog_end_m fog_anisotropy area_lights);
        let mut found = [0; 4];
        for (name, module) in modules() {
            if let Some(there) = layout(&module, "Frame") {
                assert_eq!(there, frame, "{name}");
                found[0] += 1;
            }
            if let Some((members, size)) = layout(&module, "Lamp") {
                let here = offsets!(GpuLamp: position intensity axis range_m core_m reach_m cos_outer per_cosine light
                    is_mapped is_lambertian);
                assert_eq!((members, size), here, "{name}");
                found[1] += 1;
            }
            if let Some(there) = layout(&module, "Cascade") {
                let here = offsets!(GpuCascade: row_x row_y row_z texel_m depth_m size pad);
                assert_eq!(there, here, "{name}");
                found[3] += 1;
            }
            if let Some((_, size)) = layout(&module, "Texel") {
                assert_eq!(size as u64, crate::gpu::targets::TEXEL_BYTES, "{name}");
                found[2] += 1;
            }
        }
        assert_eq!(found, [12, 4, 6, 3].map(|n| 6 * n));
    }

    #[test]
    fn passes_of_area_lights_are_valid_and_their_structs_lie_in_memory_as_here() {
        let mut found = [0; 4];
        for i in 0..54 {
            let way = GatherWay {
                shadows: i % 3,
                gathering: [Gathering::Full, Gathering::Interleaved, Gathering::Half][i as usize / 3 % 3],
                interpolation: [Interpolation::None, Interpolation::Plain, Interpolation::Fast][i as usize / 9 % 3],
                is_exact: i % 2 == 0,
                quads: 1 + i / 27 * 3,
            };
            for (name, module) in area_sources(way).into_iter().map(parsed) {
                let expected = [
                    (
                        "Vpl",
                        offsets!(GpuVpl: position radius_m normal start_m intensity per_spread x distance y alpha_min
                        axis theta_min across alpha_scale along theta_scale phi_scale wraps pad_0 pad_1),
                    ),
                    ("Batch", offsets!(Batch: first count map alpha theta phi quads points cloud pad_0 pad_1 pad_2)),
                    (
                        "AreaLight",
                        offsets!(GpuAreaLight: position shape direction width_m up height_m left texels
                        radiance picture),
                    ),
                    (
                        "Share",
                        offsets!(Share: begin first count radius_m middle area_m2 along half_along_m
                        across half_across_m half_third_m pad),
                    ),
                ];
                for ((name_of, here), found) in expected.into_iter().zip(&mut found) {
                    if let Some(there) = layout(&module, name_of) {
                        let known = here.0.len().min(there.0.len()) - usize::from(name_of == "Share");
                        assert_eq!((&there.0[..known], there.1), (&here.0[..known], here.1), "{name}: {name_of}");
                        *found += 1;
                    }
                }
            }
        }
        assert_eq!(found, [8, 8, 2, 1].map(|n| 54 * n));
    }

    #[test]
    fn passes_of_lamp_maps_are_valid_and_their_structs_lie_in_memory_as_here() {
        let lookups = shaders::source(&shaders::Lookup { group: 1, binding: 1, ..shaders::Lookup::default() });
        let mut found = [0; 6];
        for projection in [MapProjection::Cube, MapProjection::Paraboloid] {
            let looked_up = mapped_source(&lookups, Way::default(), projection);
            let all = (0..3).flat_map(|marking| culling_sources(marking, projection));
            for (name, module) in all.chain([("mapped lamps", looked_up)]).map(parsed) {
                let expected = [
                    (
                        "CullGrid",
                        offsets!(CullGrid: cells_per_m side eye triangles most_refs item_words binning most_cells
                        hair source_level levels cells),
                    ),
                    (
                        "Cluster",
                        offsets!(GpuCluster: low reach high is_of_movers first_plane planes range_m is_new
                        border pad_0 pad_1 pad_2),
                    ),
                    ("Chunk", offsets!(Chunk: first count sides marked_sides culling first_in_batch pad_0 pad_1)),
                    (
                        "MapSide",
                        (
                            offsets!(MapSide: light near_m origin size scale side begin end pad).0,
                            MAP_SIDE_BYTES as usize,
                        ),
                    ),
                    ("MapLayout", offsets!(MapLayout: first count tiles tile_size border radius kernel pad)),
                    ("MappedLamp", offsets!(MappedLamp: lamp first_tile size near_m)),
                ];
                for ((of, here), found) in expected.into_iter().zip(&mut found) {
                    if let Some(there) = layout(&module, of) {
                        assert_eq!(there, here, "{name}: {of}");
                        *found += 1;
                    }
                }
            }
        }
        assert_eq!(found, [78, 36, 36, 6, 2, 2]);
    }
}
