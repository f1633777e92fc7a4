//! Lamps' shadow maps on the graphics card: batch after batch they are culled, drawn and looked up.

use std::ops::Range;

use antumbra::Kernel as FilterKernel;
use antumbra_scene::Bounds;
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, IVec3};

use super::culling::{Chunk, Clusters, Culler, GpuCluster, same_room};
use super::passes::{MapRaster, Way, mapped_kernel};
use super::scene::{DrawnPart, SceneBuffers};
use super::sheets::Sheets;
use super::targets::Targets;
use super::timing::Recorder;
use super::{Gpu, Kernel};
use crate::RenderError;
use crate::camera::View;
use crate::culling::Hull;
use crate::light::Lamp;
use crate::passes::lamp_maps::{Clustering, Culling, LampMaps, MapProjection, Shape};

/// The struct `MappedLamp` of `map.wgsl`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct MappedLamp {
    pub lamp: u32,
    pub first_tile: u32,
    pub size: f32,
    pub near_m: f32,
}

/// The struct `MapLayout` of `map.wgsl`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct MapLayout {
    pub first: u32,
    pub count: u32,
    pub tiles: u32,
    pub tile_size: u32,
    pub border: f32,
    pub radius: u32,
    pub kernel: u32,
    pub pad: u32,
}

/// The struct `MapSide` of `target.wgsl`, and room up to where the next may begin.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct MapSide {
    pub light: [f32; 3],
    pub near_m: f32,
    pub origin: [f32; 2],
    pub size: f32,
    pub scale: f32,
    pub side: u32,
    pub begin: u32,
    pub end: u32,
    pub pad: u32,
    room: [u32; 52],
}

/// Bytes of the struct `MapSide`.
pub(crate) const MAP_SIDE_BYTES: u64 = 48;

/// A lamp to draw a map of.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chosen<'a> {
    pub index: u32,
    pub lamp: &'a Lamp,
    /// Whether a bake holds what stands still.
    pub is_of_movers: bool,
    /// It lights nothing farther away: its reach is half a box's side.
    pub lit_m: f64,
    /// Its map.
    pub shape: Shape,
}

/// What lamps' maps need on the card.
#[derive(Debug)]
pub(crate) struct Mapper {
    how: LampMaps,
    culler: Culler,
    raster: MapRaster,
    lights: Vec<(Way, Kernel)>,
    sheets: Option<Sheets>,
    /// Of the last sample: indirect draws, and lamps of each cluster.
    drawn: Option<(wgpu::Buffer, Vec<u32>)>,
    /// The lamps whose maps are there, in the order of their tiles, and which of them each cluster has.
    kept: (Vec<Kept>, Vec<Range<usize>>),
}

/// A lamp whose map is there: which one, where it stood, and whether the map is of what moves alone.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Kept {
    index: u32,
    position_world: DVec3,
    is_of_movers: bool,
    shape: Shape,
}

/// Lamps whose maps are there at once, in order: a range of them for each cluster.
#[derive(Debug, Default)]
struct Batch {
    clusters: Vec<Range<usize>>,
}

/// What a sample is drawn with.
pub(crate) struct Stage<'a> {
    pub gpu: &'a Gpu,
    pub view: &'a View,
    pub scene: &'a SceneBuffers,
    pub frame: &'a wgpu::Buffer,
    pub targets: &'a Targets,
    /// How the bake is looked up, and its text and bindings.
    pub way: Way,
    pub baked: &'a super::baked::Baked,
    pub lamps: &'a wgpu::Buffer,
    pub lists: &'a wgpu::Buffer,
}

impl Kept {
    fn new(own: &Chosen<'_>) -> Self {
        let Chosen { index, lamp, is_of_movers, shape, .. } = *own;
        Self { index, position_world: lamp.position_world, is_of_movers, shape }
    }
}

impl Mapper {
    pub fn new(gpu: &Gpu, how: &LampMaps, scene: &SceneBuffers, bounds: &Bounds) -> Result<Self, RenderError> {
        how.check()?;
        Ok(Self {
            culler: Culler::new(gpu, how, scene, bounds)?,
            raster: MapRaster::new(gpu, how.projection),
            how: how.clone(),
            lights: Vec::new(),
            sheets: None,
            drawn: None,
            kept: Default::default(),
        })
    }

    /// Whether it can draw maps in another way without being made anew; then it does from now on.
    pub fn turn_to(&mut self, how: &LampMaps) -> bool {
        let suits = same_room(&self.how, how) && how.batch == self.how.batch && how.check().is_ok();
        if suits && self.how != *how {
            self.how = how.clone();
            self.kept = Default::default();
        }
        suits
    }

    /// Notes that something has moved from one box of the world to another.
    pub fn moved(&mut self, boxes: [Bounds; 2]) {
        if !self.culler.moved(boxes) {
            self.kept = Default::default();
        }
    }

    /// Notes that the lamps may be others.
    pub fn forget(&mut self) {
        self.kept = Default::default();
        // The bake may be another, with other bindings.
        self.lights.clear();
    }

    /// Gets ready for a frame.
    pub fn begin(&mut self, stage: &Stage<'_>, lamps: usize) -> Result<(), RenderError> {
        let Self { how, culler, .. } = self;
        culler.see_from(stage.gpu, how, stage.scene, stage.frame, stage.view.eye)?;
        if !self.lights.iter().any(|(known, _)| *known == stage.way) {
            let kernel = mapped_kernel(stage.gpu, stage.way, how.projection, &stage.baked.lookups, &stage.baked.slots);
            self.lights.push((stage.way, kernel));
        }
        // As many as a batch takes, but no more than a few times as many as there are.
        let at_once = how.lamps_at_once().min((lamps as u32).next_power_of_two());
        let tiles = at_once * how.projection.sides();
        if self.sheets.as_ref().is_none_or(|sheets| (sheets.of.0, sheets.of.2) != (how.size, tiles)) {
            self.kept = Default::default();
            self.sheets = None;
            self.sheets = Some(Sheets::new(stage.gpu, how.size, tiles));
        }
        Ok(())
    }

    /// Records a sample: maps, and the light of their lamps.
    pub fn draw(&mut self, recorder: &mut Recorder<'_>, stage: &Stage<'_>, chosen: &[Chosen<'_>]) {
        let Stage { gpu, scene, frame, targets, view, .. } = *stage;
        self.culler.bin(gpu, recorder, self.how.always_bin, scene, frame);
        self.culler.see(gpu, recorder, targets, frame);
        self.culler.take_moved(gpu);
        let (kept, kept_ranges) = std::mem::take(&mut self.kept);
        let (Some(sheets), Some(items)) = (&self.sheets, self.culler.items()) else { return };
        let Self { how, culler, .. } = &*self;
        let sides = how.projection.sides();
        let at_once = (sheets.of.2 / sides) as usize;
        let (order, batches) = self.batches(chosen, at_once);
        let ranges: Vec<Range<usize>> = batches.iter().flat_map(|batch| batch.clusters.clone()).collect();
        let now: Vec<Kept> = order.iter().map(Kept::new).collect();
        let can_reuse = how.reuse && matches!(how.culling, Culling::Voxels(_)) && batches.len() == 1;
        let is_same = |(a, b): (&Kept, &Kept)| (a.index, a.is_of_movers) == (b.index, b.is_of_movers);
        let reuses = can_reuse && kept_ranges == ranges && kept.iter().zip(&now).all(is_same);
        // Everything that is the same for all batches.
        let deepest = |corner: DVec3| (corner - view.eye).dot(view.forward);
        let (mut planes, mut clusters) = (Vec::new(), Vec::new());
        for range in &ranges {
            let cluster = self.cluster(&order[range.clone()], view, deepest, &mut planes);
            let stands_still = reuses && kept[range.clone()] == now[range.clone()];
            clusters.push(GpuCluster { is_new: (!stands_still).into(), ..cluster });
        }
        let tile_of = |lamp: usize| (lamp % at_once) as u32 * sides;
        let mapped = |(i, own): (usize, &Chosen<'_>)| MappedLamp {
            lamp: own.index,
            first_tile: tile_of(i),
            size: own.shape.size() as f32,
            near_m: own.lamp.near_m as f32,
        };
        let mapped: Vec<MappedLamp> = order.iter().enumerate().map(mapped).collect();
        let chunks = self.chunks(&batches, items.chunk as usize);
        let side_of = |(place, lamp, side): (u32, usize, u32)| {
            let begin = (place * sides + side) * items.list_len;
            map_side(&order[lamp], view, sheets.place(tile_of(lamp) + side).1, side, begin..begin + items.list_len)
        };
        let all_sides = chunks.iter().flat_map(|drawn| drawn.sides(sides));
        let sides_drawn: Vec<MapSide> = all_sides.map(side_of).collect();
        let draws = indirect_draws(gpu, ranges.len() as u32 * sides);
        let [of_clusters, of_planes] = [gpu.buffer("clusters", &clusters), gpu.buffer("planes", &planes)];
        let of_sides = gpu.buffer("sides of maps", &sides_drawn);
        let of_mapped = gpu.buffer("mapped lamps", &mapped);
        let geometry = gpu.group(&self.raster.layouts[0], &scene.resources(frame));
        let own = [&culler.uniform, &culler.triangles, &items.refs, &items.pieces, &items.lists];
        let own = gpu.group(&self.raster.layouts[1], &own.map(|b| b.as_entire_binding()));
        let side = wgpu::BufferBinding { buffer: &of_sides, offset: 0, size: core::num::NonZero::new(MAP_SIDE_BYTES) };
        let side = gpu.group(&self.raster.layouts[2], &[wgpu::BindingResource::Buffer(side)]);
        let for_draws = Clusters { clusters: &of_clusters, planes: &of_planes, draws: &draws };
        for (i, drawn) in chunks.iter().enumerate() {
            culler.cull(gpu, recorder, how, &for_draws, &drawn.chunk);
            self.draw_chunk(recorder, sheets, (drawn, &order, reuses), [&geometry, &own, &side], &draws);
            let lamps = drawn.lamps();
            let ends_batch = chunks.get(i + 1).is_none_or(|next| next.lamps().start % at_once == 0);
            if ends_batch {
                let first = (lamps.end - 1) / at_once * at_once;
                self.light(recorder, stage, sheets, first..lamps.end, &of_mapped);
            }
        }
        let lamps_of = ranges.iter().map(|range| range.len() as u32).collect();
        self.drawn = Some((draws, lamps_of));
        self.kept = if can_reuse { (now, ranges) } else { Default::default() };
    }

    /// The clusters of batches, so many at a time.
    fn chunks(&self, batches: &[Batch], at_a_time: usize) -> Vec<DrawnChunk> {
        let (mut chunks, mut first) = (Vec::new(), 0);
        for batch in batches {
            let first_of_batch = first;
            for clusters in batch.clusters.chunks(at_a_time) {
                let count = clusters.len() as u32;
                let chunk = self.culler.chunk(&self.how, first, count, first - first_of_batch);
                chunks.push(DrawnChunk { chunk, clusters: clusters.to_vec() });
                first += count;
            }
        }
        chunks
    }

    /// Lamps in order, and batches of their clusters. They are in Morton's order of their cells, which keeps blocks together
    /// however large they are: the order, and with it every rounding, depends on neither culling nor clustering.
    fn batches<'c>(&self, chosen: &[Chosen<'c>], at_once: usize) -> (Vec<Chosen<'c>>, Vec<Batch>) {
        let block_bits = match (self.how.clustering, self.how.culling) {
            // Frusta are those of one lamp.
            (Clustering::None, _) | (_, Culling::Frusta) => None,
            (Clustering::Cells(cells), _) => Some(3 * cells.ilog2()),
        };
        let key = |own: &Chosen<'_>| (own.is_of_movers, morton(self.culler.grid.at(own.lamp.position_world)));
        let mut order: Vec<((bool, u64), Chosen<'c>)> = chosen.iter().map(|own| (key(own), *own)).collect();
        order.sort_by_key(|(key, _)| *key);
        let is_same =
            |a: (bool, u64), b: (bool, u64)| block_bits.is_some_and(|bits| (a.0, a.1 >> bits) == (b.0, b.1 >> bits));
        let mut batches: Vec<Batch> = Vec::new();
        for at in 0..order.len() {
            let begins_batch = at % at_once == 0;
            if begins_batch {
                batches.push(Batch::default());
            }
            let Some(batch) = batches.last_mut() else { continue };
            match batch.clusters.last_mut() {
                Some(range) if !begins_batch && is_same(order[at - 1].0, order[at].0) => range.end = at + 1,
                _ => batch.clusters.push(at..at + 1),
            }
        }
        (order.into_iter().map(|(_, own)| own).collect(), batches)
    }

    /// What lamps have in common.
    fn cluster(
        &self,
        lamps: &[Chosen<'_>],
        view: &View,
        deepest: impl Fn(DVec3) -> f64,
        planes: &mut Vec<[f32; 4]>,
    ) -> GpuCluster {
        let Self { how, culler, .. } = self;
        let at = |own: &Chosen<'_>| culler.grid.at(own.lamp.position_world);
        let (low, high) = lamps
            .iter()
            .map(at)
            .fold((glam::Vec3::INFINITY, glam::Vec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
        let first_plane = planes.len() as u32;
        if let (Culling::Frusta, Some(own)) = (how.culling, lamps.first()) {
            // As deep as the grid.
            let last = IVec3::splat(culler.grid.side() as i32 - 1);
            let [near, far] = [culler.grid.bounds(IVec3::ZERO), culler.grid.bounds(last)];
            let bounds = Bounds { min: near.min, max: far.max };
            let depth = bounds.corners().into_iter().map(deepest).fold(1e-3, f64::max);
            let corner = |x: f64, y: f64| (view.forward + view.half_right * x + view.half_up * y) * depth;
            let corners = [corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)];
            let hull = Hull::of_view(corners, DVec3::ZERO, own.lamp.position_world - view.eye);
            planes.extend(hull.planes().map(|(normal, at)| normal.as_vec3().extend(at as f32).to_array()));
        }
        GpuCluster {
            low: low.to_array(),
            reach: lamps.iter().map(|own| own.shape.footprint().per_m).fold(0.0, f64::max) as f32,
            border: lamps.iter().map(|own| own.shape.border_slope()).fold(0.0, f64::max) as f32,
            high: high.to_array(),
            is_of_movers: lamps.iter().all(|own| own.is_of_movers).into(),
            first_plane,
            planes: planes.len() as u32 - first_plane,
            range_m: lamps.iter().map(|own| own.lit_m).fold(0.0, f64::max).min(1e18) as f32 * 1.001,
            is_new: 1,
            pad_0: 0,
            pad_1: 0,
            pad_2: 0,
        }
    }

    /// Records the drawing of a chunk's maps, layer by layer.
    fn draw_chunk(
        &self,
        recorder: &mut Recorder<'_>,
        sheets: &Sheets,
        (drawn, order, reuses): (&DrawnChunk, &[Chosen<'_>], bool),
        [geometry, own, side]: [&wgpu::BindGroup; 3],
        draws: &wgpu::Buffer,
    ) {
        let sides = self.how.projection.sides();
        let at_once = (sheets.of.2 / sides) as usize;
        let lamps = drawn.lamps();
        let begin = (lamps.start % at_once) as u32 * sides;
        let end = begin + lamps.len() as u32 * sides;
        let cluster_of =
            |lamp: usize| (0..).zip(&drawn.clusters).find(|(_, r)| r.contains(&lamp)).map_or(0, |(i, _)| i);
        for layer in begin / sheets.tiles_per_layer()..=(end - 1) / sheets.tiles_per_layer() {
            let first = (layer * sheets.tiles_per_layer()).max(begin);
            let last = ((layer + 1) * sheets.tiles_per_layer()).min(end);
            // A layer begins empty unless an earlier chunk of the batch has drawn into it.
            // Where maps are kept, each side is cleared by a draw of its own.
            let is_new = first == layer * sheets.tiles_per_layer();
            let load = if is_new && !reuses { wgpu::LoadOp::Clear(0.0) } else { wgpu::LoadOp::Load };
            recorder.draw("lamp maps", None, (&sheets.layers[layer as usize], load), |pass| {
                pass.set_bind_group(0, geometry, &[]);
                pass.set_bind_group(1, own, &[]);
                let MapRaster { opaque, cut_out, clear, .. } = &self.raster;
                let clear = reuses.then_some((clear, 2));
                for (pipeline, kind) in clear.into_iter().chain([(opaque, 0), (cut_out, 1)]) {
                    pass.set_pipeline(pipeline);
                    for tile in first..last {
                        let lamp = lamps.start + ((tile - begin) / sides) as usize;
                        let of_side = tile % sides;
                        let (_, [x, y]) = sheets.place(tile);
                        let size = order[lamp].shape.size();
                        pass.set_viewport(x as f32, y as f32, size as f32, size as f32, 0.0, 1.0);
                        pass.set_scissor_rect(x, y, size, size);
                        let row = lamp as u32 * sides + of_side;
                        pass.set_bind_group(2, side, &[row * size_of::<MapSide>() as u32]);
                        let cluster = drawn.chunk.first + cluster_of(lamp);
                        let draw = DRAWS * (cluster * sides + of_side) + kind;
                        pass.draw_indirect(draws, 16 * u64::from(draw));
                    }
                }
            });
        }
    }

    /// Records the light of a batch's lamps.
    fn light(
        &self,
        recorder: &mut Recorder<'_>,
        stage: &Stage<'_>,
        sheets: &Sheets,
        lamps: Range<usize>,
        mapped: &wgpu::Buffer,
    ) {
        let Stage { gpu, frame, targets, baked, .. } = *stage;
        let Some((_, kernel)) = self.lights.iter().find(|(known, _)| *known == stage.way) else { return };
        let layout = MapLayout {
            first: lamps.start as u32,
            count: lamps.len() as u32,
            tiles: sheets.of.1,
            tile_size: sheets.of.0,
            border: (self.how.filter.radius() + 1) as f32,
            radius: self.how.filter.radius(),
            kernel: u32::from(self.how.filter.kernel() == FilterKernel::Tent),
            pad: 0,
        };
        let layout = gpu.buffer("layout of maps", &[layout]);
        let own = [frame, &targets.gbuffer, stage.lamps, stage.lists, &targets.hdr, &targets.veils, mapped, &layout];
        let groups = [
            gpu.group(&kernel.layouts[0], &own.map(|b| b.as_entire_binding())),
            gpu.group(&kernel.layouts[1], &baked.resources()),
            gpu.group(&kernel.layouts[2], &[wgpu::BindingResource::TextureView(&sheets.all)]),
        ];
        let [width, height] = targets.size;
        let groups: Vec<_> = groups.iter().collect();
        recorder.compute("mapped lamps", kernel, &groups, [width.div_ceil(8), height.div_ceil(8), 1]);
    }

    /// Triangles drawn into all maps of the last sample.
    pub fn triangles(&self, gpu: &Gpu) -> Result<u64, RenderError> {
        let Some((draws, lamps)) = &self.drawn else { return Ok(0) };
        let sides = self.how.projection.sides() as usize;
        let words: Vec<u32> = gpu.read(draws)?;
        let vertices = vertices(self.how.projection);
        let of_cluster = |(i, lamps): (usize, &u32)| {
            let own = words.chunks(4 * DRAWS as usize).skip(i * sides).take(sides);
            let items = own.map(|draws| u64::from(draws[0] / vertices) + u64::from(draws[4] / vertices));
            u64::from(*lamps) * items.sum::<u64>()
        };
        Ok(lamps.iter().enumerate().map(of_cluster).sum())
    }
}

/// Some clusters' maps, culled and drawn at a time.
struct DrawnChunk {
    chunk: Chunk,
    /// Which of the lamps belong to each.
    clusters: Vec<Range<usize>>,
}

impl DrawnChunk {
    /// Their lamps.
    fn lamps(&self) -> Range<usize> {
        let end = |range: Option<&Range<usize>>| range.map_or(0, |range| range.end);
        self.clusters.first().map_or(0, |range| range.start)..end(self.clusters.last())
    }

    /// Each lamp's sides, with the place of its cluster.
    fn sides(&self, sides: u32) -> impl Iterator<Item = (u32, usize, u32)> + '_ {
        let of_cluster = move |(place, range): (u32, &Range<usize>)| {
            range.clone().flat_map(move |lamp| (0..sides).map(move |side| (place, lamp, side)))
        };
        (0..).zip(&self.clusters).flat_map(of_cluster)
    }
}

/// Vertices that a triangle is drawn with.
pub(crate) fn vertices(projection: MapProjection) -> u32 {
    match projection {
        MapProjection::Cube => 3,
        MapProjection::Paraboloid => 6,
    }
}

/// The bits of a cell's coordinates, taken in turns (Morton 1966, *A computer oriented geodetic data base*); lamps far outside the
/// grid are taken to be no farther.
fn morton(cell: glam::Vec3) -> u64 {
    const MIDDLE: f32 = (1 << 20) as f32;
    let at = (cell.floor() + MIDDLE).clamp(glam::Vec3::ZERO, glam::Vec3::splat(2.0 * MIDDLE - 1.0)).as_uvec3();
    let spread = |x: u32| (0..21).fold(0, |sum, bit| sum | u64::from(x >> bit & 1) << (3 * bit));
    spread(at.x) | spread(at.y) << 1 | spread(at.z) << 2
}

/// Indirect draws of a side: opaque triangles, cut-out ones, and one that clears it.
const DRAWS: u32 = 3;

/// The draws of each side, of nothing yet.
fn indirect_draws(gpu: &Gpu, sides: u32) -> wgpu::Buffer {
    let none: Vec<[u32; 4]> = vec![[0, 1, 0, 0]; (DRAWS * sides) as usize];
    let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::INDIRECT | wgpu::BufferUsages::COPY_SRC;
    let contents = bytemuck::cast_slice(&none);
    let descriptor = wgpu::util::BufferInitDescriptor { label: Some("draws"), contents, usage };
    wgpu::util::DeviceExt::create_buffer_init(&gpu.device, &descriptor)
}

/// A side of a lamp's map, from its upper left texel on, drawn from a list.
fn map_side(own: &Chosen<'_>, view: &View, origin: [u32; 2], side: u32, list: Range<u32>) -> MapSide {
    MapSide {
        light: (own.lamp.position_world - view.eye).as_vec3().to_array(),
        near_m: own.lamp.near_m as f32,
        origin: origin.map(|at| at as f32),
        size: own.shape.size() as f32,
        scale: own.shape.scale() as f32,
        side,
        begin: list.start,
        end: list.end,
        pad: 0,
        room: [0; 52],
    }
}

/// The lamps that maps are drawn of: those that no bake holds and, where something moves in their light, those that one does.
pub(crate) fn chosen<'a>(
    lamps: &'a [Lamp],
    is_baked: impl Fn(usize) -> bool,
    least: f32,
    scene: &SceneBuffers,
    (how, view): (&LampMaps, &View),
) -> Vec<Chosen<'a>> {
    let is_met = |lamp: &Lamp, reach_m: f64| {
        let movers = scene.parts.iter().filter(|part| part.is_dynamic && part.vertices > 0);
        movers
            .map(DrawnPart::sphere)
            .any(|(center, radius_m)| (center - lamp.position_world).length() <= radius_m + reach_m)
    };
    let chosen = |(i, lamp): (usize, &'a Lamp)| {
        let (is_of_movers, reach_m) = (is_baked(i), lamp.reach_m(least));
        let lit_m = lamp.range_m.min(reach_m * 3.0_f64.sqrt());
        let is_needed = !is_of_movers || is_met(lamp, lit_m);
        is_needed.then(|| {
            let distance_m = (lamp.position_world - view.eye).length();
            let shape = how.shape(reach_m, distance_m, view.pixel_size);
            Chosen { index: i as u32, lamp, is_of_movers, lit_m, shape }
        })
    };
    lamps.iter().enumerate().filter_map(chosen).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use antumbra_scene::procedural::{self, Options};
    use antumbra_scene::{AlphaMode, LightKind};

    use super::*;
    use crate::culling::{Binning, Bins, Footprint, Marks};
    use crate::gpu::{GpuRenderer, Lookup, Setting};
    use crate::{Marking, RenderOptions, Time, Tracer, TriangleId};

    /// Of the first lamp of a village, the card finds what the processor finds: which triangles lie in which cells, and which cells
    /// lie between the lamp and what is seen.
    #[test]
    fn bins_and_marks_are_the_processors() {
        let gpu = Gpu::open().expect("a graphics card");
        let options = Options { scale: 0.1, ..Options::default() };
        let mut scene = procedural::build("village", &options).expect("a scene");
        scene.lights.retain(|light| light.kind == LightKind::Point);
        scene.lights.truncate(1);
        // It lights everything there is.
        (scene.lights[0].range_m, scene.lights[0].intensity) = (None, 1e12);
        let light = scene.lights[0].position_world;
        let scene = Arc::new(scene);
        let tracer = Tracer::new(&scene, |_, material| material.alpha_mode != AlphaMode::Blend);
        let corners: Vec<[DVec3; 3]> =
            (0..tracer.triangle_count()).map(|i| tracer.corners(TriangleId(i as u32))).collect();
        for (marking, binning) in [
            (Marking::Boxes, Binning::Whole),
            (Marking::Cells, Binning::Clip),
            (Marking::Steps, Binning::NoCull { most_cells: 2 }),
            (Marking::Boxes, Binning::Levels { most_cells: 8 }),
        ] {
            let lights = scene.lights.clone();
            let setting = Setting { lights, time: Some(Time::Night), has_lamp_maps: true, ..Setting::default() };
            let mut renderer = GpuRenderer::new(&gpu, Arc::clone(&scene), setting).expect("a renderer");
            let how = LampMaps { culling: Culling::Voxels(marking), binning, size: 256, ..LampMaps::default() };
            let footprint = how.shape(f64::INFINITY, 0.0, 1.0).footprint();
            let options = RenderOptions {
                width: 96,
                height: 54,
                samples: 1,
                lamp_maps: Some(how),
                exposure: Some(1.0),
                ..RenderOptions::default()
            };
            renderer.render(&scene.cameras[0], &options, Lookup::None).expect("a picture");
            let culler = &renderer.mapper.as_ref().expect("maps were drawn").culler;
            let (on_card, receivers, begins) = culler.found(&gpu).expect("the card is there");
            let grid = &culler.grid;
            let bins = Bins::new(grid, &corners, binning);
            let own = |cell: usize| bins.of_cell(cell).len() as u32;
            let cells = 0..grid.cells_to(binning.levels(grid));
            let cells_off = cells.filter(|c| begins[c + 1] - begins[*c] != own(*c)).count();
            assert!(bins.occupied().count() > 500 && cells_off <= 4, "{binning:?}: {cells_off} cells differ");
            let marks = marks(&receivers, grid, light, marking, footprint);
            let marked = (0..grid.cells()).filter(|cell| marks.has(*cell)).count();
            let differ = |cell: &usize| marks.has(*cell) != (on_card[cell / 32] >> (cell % 32) & 1 != 0);
            let marks_off = (0..grid.cells()).filter(differ).count();
            assert!(marked > 200 && marks_off <= 4, "{marking:?}: {marks_off} of {marked} marks differ");
            // Of coarser grids those are marked in which cells are.
            for level in 1..binning.levels(grid) {
                let coarser = grid.coarser(level);
                let is_set = |number: usize| on_card[number / 32] >> (number % 32) & 1 != 0;
                let mut expected = vec![false; coarser.cells()];
                for cell in (0..grid.cells()).filter(|number| is_set(*number)).map(|number| grid.cell(number)) {
                    expected[coarser.number(cell / (1 << level)).expect("inside")] = true;
                }
                let first = grid.cells_to(level);
                let found: Vec<bool> = (first..first + coarser.cells()).map(is_set).collect();
                assert_eq!(found, expected, "level {level}");
            }
        }
    }

    fn marks(
        receivers: &crate::culling::Receivers,
        grid: &crate::culling::Grid,
        light: DVec3,
        marking: Marking,
        footprint: Footprint,
    ) -> Marks {
        let mut marks = Marks::none(grid);
        match marking {
            Marking::Steps => {
                let of_light = grid.at(light).floor().as_ivec3();
                let sources = receivers.cells.iter();
                sources.for_each(|s| crate::culling::mark_by_steps(grid, s.cell, of_light, &mut marks));
            }
            Marking::Cells => receivers.mark_cells(grid, light, footprint, &mut marks),
            Marking::Boxes | Marking::Sides => receivers.mark(grid, [light, light], footprint, &mut marks),
        }
        marks
    }
}
