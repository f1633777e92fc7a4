//! Asks a graphics card what the lookups in WGSL answer.

use antumbra::shaders::{GpuLight, Lookup, Tables, pages, source};
use antumbra::{LightShadow, ShadowFile};
use antumbra_render::gpu::{Gpu, Kernel, Slot};
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, IVec3};

/// What to ask.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Op {
    IsLit,
    Weights,
    Mean,
    EnterWindow,
    Cell,
    Project,
    ProjectBiased,
    Filtered,
    Prefiltered,
    Levels,
    Blocker,
    LitShare,
}

/// One question. Positions count from the card's reference point.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Query {
    pub voxel: IVec3,
    pub op: u32,
    pub arguments: [u32; 4],
    pub light: u32,
    pub face: u32,
    pub level: u32,
    pub pad: u32,
    pub position: [f32; 4],
    pub normal: [f32; 4],
}

#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Answer {
    pub words: [u32; 8],
}

/// A file on a card.
pub struct Card<'a> {
    gpu: &'a Gpu,
    kernel: Kernel,
    lights: wgpu::Buffer,
    tables: wgpu::Buffer,
    pages: Vec<wgpu::Buffer>,
    reference: DVec3,
}

impl<'a> Card<'a> {
    pub fn new(gpu: &'a Gpu, file: &ShadowFile, lookup: Lookup, reference: DVec3) -> Self {
        Self::paged(gpu, file, lookup, reference, gpu.most_bytes())
    }

    /// With a pool in pages of at most so many bytes.
    pub fn paged(gpu: &'a Gpu, file: &ShadowFile, lookup: Lookup, reference: DVec3, most_bytes: u64) -> Self {
        let (log2_page_words, parts) = pages(file.pool(), most_bytes).expect("pages that are large enough");
        let lookup = Lookup { group: 1, pages: parts.len() as u32, log2_page_words, ..lookup };
        let text = format!("{}\n{}", source(&lookup), include_str!("query.wgsl"));
        let lookups = vec![Slot::Read; 1 + parts.len()];
        let kernel = gpu.kernel("query", &text, &[&[Slot::Read, Slot::Read, Slot::Write], &lookups]);
        let tables = Tables::new(file, |_| true);
        let lights: Vec<_> = file.lights().map(|light| GpuLight::new(light, &tables, reference)).collect();
        Self {
            gpu,
            kernel,
            lights: gpu.buffer("lights", &lights),
            tables: gpu.buffer("tables", tables.words()),
            pages: parts.iter().map(|part| gpu.buffer("pool", part)).collect(),
            reference,
        }
    }

    pub fn pages(&self) -> usize {
        self.pages.len()
    }

    /// A question about a face.
    pub fn query(&self, op: Op, light: LightShadow<'_>, face: usize) -> Query {
        Query { op: op as u32, light: index(light), face: face as u32, ..Query::zeroed() }
    }

    /// A question about a world point and a direction.
    pub fn at(&self, op: Op, light: LightShadow<'_>, point: DVec3, normal: DVec3) -> Query {
        let four = |v: DVec3| v.as_vec3().extend(0.0).to_array();
        Query { position: four(point - self.reference), normal: four(normal), ..self.query(op, light, 0) }
    }

    /// A point as the card gets it.
    pub fn rounded(&self, point: DVec3) -> DVec3 {
        self.reference + self.direction(point - self.reference)
    }

    /// A direction as the card gets it.
    pub fn direction(&self, direction: DVec3) -> DVec3 {
        direction.as_vec3().as_dvec3()
    }

    pub fn ask(&self, queries: impl IntoIterator<Item = Query>) -> Vec<Answer> {
        let queries: Vec<Query> = queries.into_iter().collect();
        let gpu = self.gpu;
        let asked = gpu.buffer("queries", &queries);
        let answers = gpu.zeros("answers", (queries.len() * size_of::<Answer>()) as u64);
        let first = gpu.group(
            &self.kernel.layouts[0],
            &[self.lights.as_entire_binding(), asked.as_entire_binding(), answers.as_entire_binding()],
        );
        let buffers: Vec<_> = std::iter::once(&self.tables).chain(&self.pages).map(|b| b.as_entire_binding()).collect();
        let second = gpu.group(&self.kernel.layouts[1], &buffers);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        self.kernel.run(&mut encoder, None, &[&first, &second], [queries.len().div_ceil(64) as u32, 1, 1]);
        gpu.queue.submit([encoder.finish()]);
        gpu.read(&answers).expect("answers")
    }
}

fn index(light: LightShadow<'_>) -> u32 {
    light.index() as u32
}
