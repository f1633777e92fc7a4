//! A bake on the graphics card.

use antumbra::shaders::{GpuLight, Lookup, Tables, pages, source};
use antumbra::{LightKind, LightShadow, ShadowFile};
use glam::DVec3;

use super::{Gpu, Slot};
use crate::RenderError;

/// Node pool, tables and lights, as bind group 1 of the passes that look up shadows.
#[derive(Debug)]
pub(crate) struct Baked {
    /// The lookups' WGSL, for this pool.
    pub lookups: String,
    /// One for each binding.
    pub slots: Vec<Slot>,
    tables: Tables,
    lights: wgpu::Buffer,
    buffers: Vec<wgpu::Buffer>,
    /// Which lights of the file passes know, in their order.
    order: Vec<usize>,
}

impl Baked {
    /// A file, of which passes know these lights.
    pub fn new(gpu: &Gpu, file: &ShadowFile, lights: &[LightShadow<'_>], top_grid: bool) -> Result<Self, RenderError> {
        let pool = file.pool();
        let limits = gpu.device.limits();
        // Six other buffers in a pass at most.
        let most_pages = limits.max_storage_buffers_per_shader_stage.saturating_sub(8) as usize;
        let too_large =
            || RenderError::TooLargeForGpu { what: "the bake", bytes: 4 * pool.len() as u64, most: gpu.most_bytes() };
        let (log2_page_words, parts) =
            pages(pool, gpu.most_bytes()).filter(|(_, parts)| parts.len() <= most_pages).ok_or_else(too_large)?;
        let lookup = Lookup {
            encoding: file.encoding(),
            group: 1,
            binding: 1,
            pages: parts.len() as u32,
            log2_page_words,
            top_grid,
            counting: false,
        };
        // Lamps have no size, and so no penumbrae.
        let tables = Tables::new(file, |light| light.kind() == LightKind::Directional);
        gpu.check_size("the bake's tables", 4 * tables.words().len() as u64)?;
        let mut buffers = vec![gpu.buffer("lookup tables", tables.words())];
        buffers.extend(parts.iter().map(|part| gpu.buffer("node pool", part)));
        Ok(Self {
            lookups: source(&lookup),
            slots: vec![Slot::Read; 1 + buffers.len()],
            tables,
            lights: gpu.zeros("baked lights", (lights.len() * size_of::<GpuLight>()) as u64),
            buffers,
            order: lights.iter().map(|light| light.index()).collect(),
        })
    }

    /// A file without lights, for passes that look nothing up.
    pub fn none(gpu: &Gpu) -> Self {
        let buffers = vec![gpu.buffer("no tables", &[0u32; 4]), gpu.buffer("no pool", &[0u32; 8])];
        Self {
            lookups: source(&Lookup { group: 1, binding: 1, ..Lookup::default() }),
            slots: vec![Slot::Read; 3],
            tables: Tables::none(),
            lights: gpu.zeros("no lights", size_of::<GpuLight>() as u64),
            buffers,
            order: Vec::new(),
        }
    }

    /// Sets the point from which positions count.
    pub fn see_from(&self, gpu: &Gpu, file: &ShadowFile, eye: DVec3) {
        let all: Vec<_> = file.lights().collect();
        let lights: Vec<_> = self.order.iter().map(|i| GpuLight::new(all[*i], &self.tables, eye)).collect();
        if !lights.is_empty() {
            gpu.queue.write_buffer(&self.lights, 0, bytemuck::cast_slice(&lights));
        }
    }

    /// Bytes on the card.
    pub fn bytes(&self) -> u64 {
        self.buffers.iter().map(wgpu::Buffer::size).sum()
    }

    pub fn resources(&self) -> Vec<wgpu::BindingResource<'_>> {
        std::iter::once(&self.lights).chain(&self.buffers).map(wgpu::Buffer::as_entire_binding).collect()
    }
}
