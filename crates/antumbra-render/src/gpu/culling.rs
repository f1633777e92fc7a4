//! Voxel culling on the graphics card: triangles sorted into the grid, cells in which something is seen, and for each cluster of
//! lamps the triangles that are left to draw.

use antumbra_scene::Bounds;
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, IVec3, Vec3};

use super::passes::CullPasses;
use super::scene::{DrawnPart, SceneBuffers};
use super::targets::Targets;
use super::timing::{Recorder, Step, Timer};
use super::{Gpu, Kernel};
use crate::RenderError;
use crate::culling::{Binning, Grid, Marks};
use crate::passes::lamp_maps::{Culling, LampMaps, Marking};

/// The struct `CullGrid` of `grid.wgsl`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct CullGrid {
    pub cells_per_m: [f32; 3],
    pub side: u32,
    pub eye: [f32; 3],
    pub triangles: u32,
    pub most_refs: u32,
    pub item_words: u32,
    pub binning: u32,
    pub most_cells: u32,
    pub hair: f32,
    pub source_level: u32,
    pub levels: u32,
    pub cells: u32,
}

/// The struct `Cluster` of `cluster.wgsl`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct GpuCluster {
    pub low: [f32; 3],
    pub reach: f32,
    pub high: [f32; 3],
    pub is_of_movers: u32,
    pub first_plane: u32,
    pub planes: u32,
    pub range_m: f32,
    pub is_new: u32,
    pub border: f32,
    pub pad_0: u32,
    pub pad_1: u32,
    pub pad_2: u32,
}

/// The struct `Chunk` of `cluster.wgsl`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Chunk {
    pub first: u32,
    pub count: u32,
    pub sides: u32,
    pub marked_sides: u32,
    pub culling: u32,
    pub first_in_batch: u32,
    pub pad_0: u32,
    pub pad_1: u32,
}

/// Bytes of lists of triangles at a time: clusters that need more come in chunks.
const LIST_BYTES: u64 = 64 << 20;

/// Most triangles of all cells, and most pieces of them, that room is made for: others are culled by nothing.
const MOST_REFS: u64 = 1 << 26;
const MOST_PIECES: u64 = 1 << 23;

/// By how much boxes of what moves are widened, in cells.
const HAIR: f32 = 0.01;

/// Workgroups that share out cells among themselves.
const SHARERS: u32 = 256;

/// Bits beside a part's number in the table of triangles: see `grid.wgsl`.
const IS_CUT_OUT: u32 = 1 << 31;
const CASTS_NOTHING: u32 = 1 << 30;
const MOVES: u32 = 1 << 29;

/// Values of `binning`: see `grid.wgsl`.
const LISTED: u32 = 2;
const LEVELS: u32 = 3;

/// What culling needs on the card.
#[derive(Debug)]
pub(crate) struct Culler {
    passes: CullPasses,
    pub grid: Grid,
    values: CullGrid,
    /// The struct `CullGrid`.
    pub uniform: wgpu::Buffer,
    /// By triangle: its part with flags, and its number in the part.
    pub triangles: wgpu::Buffer,
    counts: wgpu::Buffer,
    blocks: wgpu::Buffer,
    begins: wgpu::Buffer,
    boxes: wgpu::Buffer,
    occupied: wgpu::Buffer,
    sources: wgpu::Buffer,
    /// What is as large as the triangles of all cells; not there before they are counted.
    items: Option<Items>,
    /// Whether triangles lie where they were sorted.
    is_binned: bool,
    /// Cells in which something has moved since the last sample.
    moved: Marks,
    moved_buffer: wgpu::Buffer,
}

/// Buffers whose size follows from how many triangles all cells have.
#[derive(Debug)]
pub(crate) struct Items {
    pub refs: wgpu::Buffer,
    pub pieces: wgpu::Buffer,
    always: wgpu::Buffer,
    marks: wgpu::Buffer,
    /// The marks of what maps hold, and which of their sides need drawing.
    drawn: wgpu::Buffer,
    stale: wgpu::Buffer,
    survivors: wgpu::Buffer,
    pub lists: wgpu::Buffer,
    /// Clusters at a time.
    pub chunk: u32,
    /// Room in each list.
    pub list_len: u32,
}

/// A frame's clusters, as culling sees them.
pub(crate) struct Clusters<'a> {
    /// Structs `Cluster`.
    pub clusters: &'a wgpu::Buffer,
    pub planes: &'a wgpu::Buffer,
    /// Indirect draws, two for each cluster and side.
    pub draws: &'a wgpu::Buffer,
}

/// What decides how large buffers are: the rest of the options may change from frame to frame.
pub(crate) fn same_room(a: &LampMaps, b: &LampMaps) -> bool {
    (a.grid, a.binning, a.projection) == (b.grid, b.binning, b.projection)
        && (marking(a), marked_sides(a), source_level(a)) == (marking(b), marked_sides(b), source_level(b))
}

fn marking(how: &LampMaps) -> u32 {
    match how.culling {
        Culling::Voxels(Marking::Cells) => 1,
        Culling::Voxels(Marking::Steps) => 2,
        _ => 0,
    }
}

fn marked_sides(how: &LampMaps) -> u32 {
    if how.culling == Culling::Voxels(Marking::Sides) { how.projection.sides() } else { 1 }
}

/// Boxes of what is seen are those of blocks of so many cells that there are no more than 32 blocks to a side: of finer grids they
/// would be many and small. Beams between whole cells know no boxes.
fn source_level(how: &LampMaps) -> u32 {
    match how.culling {
        Culling::Voxels(Marking::Sides | Marking::Boxes) => (how.grid / 32).max(1).ilog2(),
        _ => 0,
    }
}

/// The table of triangles.
fn triangle_rows(parts: &[DrawnPart]) -> Vec<[u32; 2]> {
    let flags = |part: &DrawnPart| {
        let flag = |is_set: bool, bit: u32| if is_set { bit } else { 0 };
        flag(part.is_cut_out, IS_CUT_OUT) | flag(part.is_translucent, CASTS_NOTHING) | flag(part.is_dynamic, MOVES)
    };
    let of_part = |(i, part): (u32, &DrawnPart)| {
        let first = i | flags(part);
        (0..part.vertices / 3).map(move |triangle| [first, triangle])
    };
    (0..).zip(parts).flat_map(of_part).collect()
}

impl Culler {
    pub fn new(gpu: &Gpu, how: &LampMaps, scene: &SceneBuffers, bounds: &Bounds) -> Result<Self, RenderError> {
        let grid = Grid::new(bounds, how.grid);
        let rows = triangle_rows(&scene.parts);
        gpu.check_size("the table of triangles", 8 * rows.len() as u64)?;
        let levels = how.binning.levels(&grid);
        let cells = grid.cells_to(levels) as u64;
        let (binning, most_cells) = match how.binning {
            Binning::Whole => (0, 0),
            Binning::Clip => (1, 0),
            Binning::NoCull { most_cells } => (LISTED, most_cells),
            Binning::Levels { most_cells } => (LEVELS, most_cells),
        };
        let values = CullGrid {
            cells_per_m: grid.cells_per_m().as_vec3().to_array(),
            side: grid.side(),
            triangles: rows.len() as u32,
            binning,
            most_cells,
            source_level: source_level(how),
            levels,
            cells: cells as u32,
            ..CullGrid::default()
        };
        Ok(Self {
            passes: CullPasses::new(gpu, marking(how), how.projection),
            grid,
            values,
            uniform: gpu.zeros("culling grid", size_of::<CullGrid>() as u64),
            triangles: gpu.buffer("triangles", &rows),
            counts: gpu.zeros("triangles per cell", 4 * cells),
            blocks: gpu.zeros("block sums", 4 * (cells / 1024 + 2)),
            begins: gpu.zeros("begins of cells", 4 * (cells + 1)),
            boxes: gpu.zeros("boxes of what is seen", 24 * cells),
            occupied: gpu.zeros("occupied cells", 4 * (cells + 1)),
            sources: gpu.zeros("source cells", 16 + 32 * cells),
            items: None,
            is_binned: false,
            moved: Marks::none(&grid),
            moved_buffer: gpu.zeros("cells of what moved", 4 * cells.div_ceil(32)),
        })
    }

    /// Notes that something has moved from one box of the world to another; false where its shadows may fall anywhere.
    pub fn moved(&mut self, boxes: [Bounds; 2]) -> bool {
        self.is_binned = false;
        for bounds in boxes {
            let [low, high] = [self.grid.at(bounds.min) - HAIR, self.grid.at(bounds.max) + HAIR];
            let last = self.grid.side() as f32;
            // What nothing culls may cast shadows anywhere.
            let is_culled = self.values.binning != LISTED && low.min_element() >= 0.0 && high.max_element() <= last;
            if !is_culled && !bounds.is_empty() {
                return false;
            }
            let [low, high] = [low, high].map(|p| p.floor().min(Vec3::splat(last - 1.0)).as_ivec3());
            for z in low.z..=high.z {
                for y in low.y..=high.y {
                    let row = (low.x..=high.x).filter_map(|x| self.grid.number(IVec3::new(x, y, z)));
                    row.for_each(|cell| self.moved.set(cell));
                }
            }
        }
        true
    }

    /// Writes what has moved, and forgets it.
    pub fn take_moved(&mut self, gpu: &Gpu) {
        gpu.queue.write_buffer(&self.moved_buffer, 0, bytemuck::cast_slice(self.moved.words()));
        self.moved = Marks::none(&self.grid);
    }

    pub fn items(&self) -> Option<&Items> {
        self.items.as_ref()
    }

    /// Sets the point from which positions count, and makes room for the triangles of cells the first time.
    pub fn see_from(
        &mut self,
        gpu: &Gpu,
        how: &LampMaps,
        scene: &SceneBuffers,
        frame: &wgpu::Buffer,
        eye: DVec3,
    ) -> Result<(), RenderError> {
        let eye_cells = self.grid.at(eye);
        self.values.eye = eye_cells.to_array();
        // Far away from the scene positions are coarser.
        self.values.hair = (1e-3_f32).max(1e-6 * eye_cells.abs().max_element());
        self.write(gpu);
        if self.items.is_none() {
            self.items = Some(self.make_room(gpu, how, scene, frame)?);
            self.write(gpu);
        }
        Ok(())
    }

    fn write(&self, gpu: &Gpu) {
        gpu.queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&self.values));
    }

    /// Counts the triangles of all cells, waits, and makes room for them and a quarter more: what moves later and finds none is
    /// culled by nothing.
    fn make_room(
        &mut self,
        gpu: &Gpu,
        how: &LampMaps,
        scene: &SceneBuffers,
        frame: &wgpu::Buffer,
    ) -> Result<Items, RenderError> {
        let few = Items::new(gpu, how, &mut CullGrid { ..self.values }, 0)?;
        let mut timer = Timer::off();
        let mut recorder = Recorder::new(gpu, &mut timer);
        self.record_counts(gpu, &mut recorder, &few, scene, frame);
        recorder.submit();
        let begins: Vec<u32> = gpu.read(&self.begins)?;
        let all = begins.get(self.values.cells as usize).copied().unwrap_or(0);
        Items::new(gpu, how, &mut self.values, u64::from(all) + u64::from(all) / 4 + 4096)
    }

    fn record_counts(
        &self,
        gpu: &Gpu,
        recorder: &mut Recorder<'_>,
        items: &Items,
        scene: &SceneBuffers,
        frame: &wgpu::Buffer,
    ) {
        let Self { passes, uniform, counts, blocks, begins, .. } = self;
        recorder.clear(counts);
        recorder.clear(&items.always);
        let groups = self.bin_groups(gpu, items, scene, frame);
        let workgroups = lanes(self.values.triangles);
        recorder.computes("bins", &[Step { kernel: &passes.count, groups: &[&groups[0], &groups[1]], workgroups }]);
        let own = [uniform, counts, blocks, begins].map(|b| b.as_entire_binding());
        let group = gpu.group(&passes.scan[0].layouts[0], &own);
        let all = [self.values.cells / 1024 + 1, 1, 1];
        let groups = [&group];
        let step = |kernel, workgroups| Step { kernel, groups: &groups, workgroups };
        let [sums, spine, spread] = &passes.scan;
        recorder.computes("bins", &[step(sums, all), step(spine, [1, 1, 1]), step(spread, all)]);
    }

    fn bin_groups(&self, gpu: &Gpu, items: &Items, scene: &SceneBuffers, frame: &wgpu::Buffer) -> [wgpu::BindGroup; 2] {
        let Self { passes, uniform, triangles, counts, begins, .. } = self;
        let own = [uniform, triangles, counts, begins, &items.refs, &items.always, &items.pieces];
        let own = own.map(|b| b.as_entire_binding());
        let [geometry, bins] = [&passes.count.layouts[0], &passes.count.layouts[1]];
        [gpu.group(geometry, &scene.resources(frame)), gpu.group(bins, &own)]
    }

    /// Records the sorting of triangles into cells, unless they are there.
    pub fn bin(
        &mut self,
        gpu: &Gpu,
        recorder: &mut Recorder<'_>,
        always: bool,
        scene: &SceneBuffers,
        frame: &wgpu::Buffer,
    ) {
        let Some(items) = self.items.as_ref().filter(|_| always || !self.is_binned) else { return };
        self.record_counts(gpu, recorder, items, scene, frame);
        recorder.clear(&self.counts);
        let groups = self.bin_groups(gpu, items, scene, frame);
        recorder.compute("bins", &self.passes.fill, &[&groups[0], &groups[1]], lanes(self.values.triangles));
        self.is_binned = true;
    }

    /// Records which cells hold what a sample sees.
    pub fn see(&self, gpu: &Gpu, recorder: &mut Recorder<'_>, targets: &Targets, frame: &wgpu::Buffer) {
        let Self { passes, uniform, begins, boxes, occupied, sources, .. } = self;
        [boxes, occupied, sources].into_iter().for_each(|buffer| recorder.clear(buffer));
        let group = |kernel: &Kernel, own: &[&wgpu::Buffer]| {
            gpu.group(&kernel.layouts[0], &own.iter().map(|b| b.as_entire_binding()).collect::<Vec<_>>())
        };
        let seen = group(&passes.receivers, &[frame, &targets.gbuffer, uniform, boxes]);
        let listed = group(&passes.cells, &[uniform, begins, boxes, occupied, sources]);
        let [width, height] = targets.size;
        recorder.computes(
            "source cells",
            &[
                Step {
                    kernel: &passes.receivers,
                    groups: &[&seen],
                    workgroups: [width.div_ceil(8), height.div_ceil(8), 1],
                },
                Step { kernel: &passes.cells, groups: &[&listed], workgroups: [self.values.cells.div_ceil(64), 1, 1] },
            ],
        );
    }

    /// Records the culling of a chunk of clusters, whose lists and draws are there afterwards.
    pub fn cull(&self, gpu: &Gpu, recorder: &mut Recorder<'_>, how: &LampMaps, clusters: &Clusters<'_>, chunk: &Chunk) {
        let Some(items) = &self.items else { return };
        let Self { passes, uniform, triangles, begins, occupied, sources, .. } = self;
        let Items { refs, always, marks, drawn, stale, survivors, lists, .. } = items;
        let of_chunk = gpu.buffer("chunk", &[*chunk]);
        let group = |kernel: &Kernel, own: &[&wgpu::Buffer]| {
            gpu.group(&kernel.layouts[0], &own.iter().map(|b| b.as_entire_binding()).collect::<Vec<_>>())
        };
        let Clusters { clusters, planes, draws } = clusters;
        let shared = [SHARERS, chunk.count, 1];
        match how.culling {
            Culling::None => {}
            Culling::Frusta => {
                recorder.clear(marks);
                let own = group(&passes.frusta, &[uniform, &of_chunk, clusters, occupied, planes, marks]);
                recorder.compute("marks", &passes.frusta, &[&own], shared);
            }
            Culling::Voxels(_) => {
                recorder.clear(marks);
                let own = group(&passes.mark, &[uniform, &of_chunk, clusters, sources, marks]);
                recorder.compute("marks", &passes.mark, &[&own], shared);
            }
        }
        recorder.clear(survivors);
        let reused = group(&passes.reuse, &[uniform, &of_chunk, clusters, &self.moved_buffer, marks, drawn, stale]);
        let own = [uniform, &of_chunk, clusters, occupied, begins, refs, marks, survivors, stale];
        let kept = group(&passes.survivors, &own);
        let own = [uniform, &of_chunk, clusters, triangles, refs, always, survivors, lists, draws, stale];
        let listed = group(&passes.list, &own);
        let words = [self.values.item_words.div_ceil(64), chunk.count * chunk.sides, 1];
        recorder.computes(
            "survivors",
            &[
                Step {
                    kernel: &passes.reuse,
                    groups: &[&reused],
                    workgroups: [chunk.count * chunk.marked_sides, 1, 1],
                },
                Step { kernel: &passes.survivors, groups: &[&kept], workgroups: shared },
                Step { kernel: &passes.list, groups: &[&listed], workgroups: words },
            ],
        );
    }

    /// What a chunk of clusters is culled by.
    pub fn chunk(&self, how: &LampMaps, first: u32, count: u32, first_in_batch: u32) -> Chunk {
        Chunk {
            first,
            count,
            sides: how.projection.sides(),
            marked_sides: marked_sides(how),
            culling: match how.culling {
                Culling::None => 0,
                Culling::Frusta => 1,
                Culling::Voxels(_) => 2,
            },
            first_in_batch,
            pad_0: 0,
            pad_1: 0,
        }
    }

    /// What the card found, for tests: the cells' marks of the last chunk, by cluster and side; the source cells; and where each
    /// cell's triangles begin.
    #[cfg(test)]
    pub fn found(&self, gpu: &Gpu) -> Result<(Vec<u32>, crate::culling::Receivers, Vec<u32>), RenderError> {
        use crate::culling::{Receivers, SourceCell};
        use glam::Vec3;
        let words: Vec<u32> = gpu.read(&self.sources)?;
        let three = |row: &[u32]| Vec3::new(f32::from_bits(row[0]), f32::from_bits(row[1]), f32::from_bits(row[2]));
        let source = |row: &[u32]| SourceCell {
            cell: self.grid.cell(row[3] as usize),
            low: three(&row[..3]),
            high: three(&row[4..7]),
        };
        let mut cells: Vec<SourceCell> = words[4..].chunks_exact(8).take(words[0] as usize).map(source).collect();
        cells.sort_by_key(|source| self.grid.number(source.cell));
        let marks = self.items.as_ref().map_or(Ok(Vec::new()), |items| gpu.read(&items.marks))?;
        Ok((marks, Receivers { cells }, gpu.read(&self.begins)?))
    }
}

impl Items {
    /// Room for so many triangles of cells.
    fn new(gpu: &Gpu, how: &LampMaps, values: &mut CullGrid, refs: u64) -> Result<Self, RenderError> {
        let is_cut = how.binning == Binning::Clip;
        let most = if is_cut { MOST_PIECES.min(gpu.most_bytes() / 36) } else { MOST_REFS.min(gpu.most_bytes() / 4) };
        let refs = refs.min(most).max(64);
        let items = u64::from(values.triangles) + if is_cut { refs } else { 0 };
        (values.most_refs, values.item_words) = (refs as u32, items.div_ceil(32).max(1) as u32);
        let sides = u64::from(how.projection.sides());
        // Room for whole words.
        let list_len = 32 * u64::from(values.item_words);
        let of_cluster = sides * list_len * 4;
        gpu.check_size("the list of triangles of a lamp's map", of_cluster)?;
        let chunk = (LIST_BYTES.min(gpu.most_bytes()) / of_cluster).clamp(1, u64::from(how.batch));
        let marked = 4 * u64::from(values.cells).div_ceil(32) * u64::from(marked_sides(how));
        Ok(Self {
            refs: gpu.zeros("triangles of cells", 4 * refs),
            pieces: gpu.zeros("pieces", if is_cut { 36 * refs } else { 0 }),
            always: gpu.zeros("unculled triangles", 4 * u64::from(values.item_words)),
            marks: gpu.zeros("marks", chunk * marked),
            drawn: gpu.zeros("marks of maps", u64::from(how.batch) * marked),
            stale: gpu.zeros("stale sides", 4 * chunk * sides),
            survivors: gpu.zeros("survivors", chunk * sides * 4 * u64::from(values.item_words)),
            lists: gpu.zeros("lists of triangles", chunk * of_cluster),
            chunk: chunk as u32,
            list_len: list_len as u32,
        })
    }
}

/// Workgroups of 64 lanes, in rows: a dispatch has at most 65535 to a side.
fn lanes(count: u32) -> [u32; 3] {
    let groups = count.div_ceil(64).max(1);
    let rows = groups.div_ceil(65535);
    [groups.div_ceil(rows), rows, 1]
}
