//! Asks a graphics card what the lookups in WGSL answer.

use antumbra::shaders::{GpuLight, Lookup, Tables, pages, source};
use antumbra::{LightShadow, ShadowFile};
use antumbra_render::gpu::{Gpu, Kernel, Slot};
use bytemuck::{Pod, Zeroable};
use glam::{DVec3, IVec3};

/// What to ask; see `query.wgsl` for what answers hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum Op {
    /// Whether a voxel is lit.
    IsLit,
    /// Weights of a filter about a voxel.
    Weights,
    /// Mean of a node about a voxel.
    Mean,
    /// Bounds of enter depths in a window.
    EnterWindow,
    /// The homogeneous box about a voxel.
    Cell,
    /// The voxel of a position.
    Project,
    /// The same, off the surface.
    ProjectBiased,
    /// Filtered visibility at a position.
    Filtered,
    /// Mean visibility over a footprint.
    Prefiltered,
    /// Filtered on coarse levels.
    Levels,
    /// Bounds of a blocker's distance.
    Blocker,
    /// Lit share of the segment from a position on.
    LitShare,
}

/// One question. Positions count from the card's reference point.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Query {
    /// Voxel of the face, or of its level.
    pub voxel: IVec3,
    /// An [`Op`].
    pub op: u32,
    /// By op: radius and kernel of a filter, a width's bits, a level, or a window's corners.
    pub arguments: [u32; 4],
    /// Which of the file's lights.
    pub light: u32,
    /// Which of its faces.
    pub face: u32,
    /// Which of its coarse levels; 0 for itself.
    pub level: u32,
    /// Zero.
    pub pad: u32,
    /// From the reference point.
    pub position: [f32; 4],
    /// A normal, or a segment's direction.
    pub normal: [f32; 4],
}

/// An answer.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Answer {
    /// By op; the last is how many words were read, on a card that counts.
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
    /// As far as the card's buffers reach.
    ///
    /// # Panics
    /// When they do not suffice.
    #[must_use]
    pub fn new(gpu: &'a Gpu, file: &ShadowFile, lookup: Lookup, reference: DVec3) -> Self {
        Self::paged(gpu, file, lookup, reference, gpu.most_bytes())
    }

    /// With a pool in pages of at most so many bytes.
    ///
    /// # Panics
    /// When pages would be too small.
    #[must_use]
    pub fn paged(gpu: &'a Gpu, file: &ShadowFile, lookup: Lookup, reference: DVec3, most_bytes: u64) -> Self {
        let (log2_page_words, parts) = pages(file.pool(), most_bytes).expect("pages that are large enough");
        let lookup =
            Lookup { encoding: file.encoding(), group: 1, pages: parts.len() as u32, log2_page_words, ..lookup };
        let counted = if lookup.counting { "antumbra_words_read" } else { "0u" };
        let count = format!("fn words_read() -> u32 {{ return {counted}; }}\n");
        let text = [&source(&lookup), &count, include_str!("query.wgsl")].concat();
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

    /// Into how many pages the pool is divided.
    #[must_use]
    pub fn pages(&self) -> usize {
        self.pages.len()
    }

    /// A question about a face.
    #[must_use]
    pub fn query(&self, op: Op, light: LightShadow<'_>, face: usize) -> Query {
        Query { op: op as u32, light: light.index() as u32, face: face as u32, ..Query::zeroed() }
    }

    /// A question about a world point and a direction.
    #[must_use]
    pub fn at(&self, op: Op, light: LightShadow<'_>, point: DVec3, normal: DVec3) -> Query {
        let four = |v: DVec3| v.as_vec3().extend(0.0).to_array();
        Query { position: four(point - self.reference), normal: four(normal), ..self.query(op, light, 0) }
    }

    /// A point as the card gets it.
    #[must_use]
    pub fn rounded(&self, point: DVec3) -> DVec3 {
        self.reference + self.direction(point - self.reference)
    }

    /// A direction as the card gets it.
    #[must_use]
    pub fn direction(&self, direction: DVec3) -> DVec3 {
        direction.as_vec3().as_dvec3()
    }

    /// Asks the card.
    ///
    /// # Panics
    /// When the card is lost.
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
