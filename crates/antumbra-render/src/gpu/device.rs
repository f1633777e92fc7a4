//! The graphics card: opening it, and what is the same for every buffer and kernel.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use bytemuck::Pod;
use wgpu::util::DeviceExt;

use crate::RenderError;

/// An open graphics card. Cheap to clone.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// How to make things on it.
    pub device: wgpu::Device,
    /// How to give it work.
    pub queue: wgpu::Queue,
    /// What it can be asked to show pictures through.
    pub adapter: wgpu::Adapter,
    has_timestamps: bool,
    lost: Arc<AtomicBool>,
}

/// How to get a Vulkan driver, with a graphics card or without, for messages.
pub const ADVICE: &str = "install your graphics card's driver, or a software one (Debian and Ubuntu: apt-get install \
    mesa-vulkan-drivers; Fedora: dnf install mesa-vulkan-drivers)";

impl Gpu {
    /// Opens the best graphics card there is; a software one if there is no other.
    ///
    /// # Errors
    /// [`RenderError::NoGpu`], which says what to install.
    pub fn open() -> Result<Self, RenderError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle().with_env());
        Self::open_for(&instance, None)
    }

    /// Opens the best graphics card that can show pictures on a surface of an instance.
    ///
    /// # Errors
    /// As [`Gpu::open`].
    pub fn open_for(instance: &wgpu::Instance, surface: Option<&wgpu::Surface<'_>>) -> Result<Self, RenderError> {
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            compatible_surface: surface,
            ..Default::default()
        };
        let adapter = pollster::block_on(instance.request_adapter(&options))
            .map_err(|error| RenderError::NoGpu { reason: error.to_string(), advice: ADVICE })?;
        Self::of_adapter(adapter)
    }

    fn of_adapter(adapter: wgpu::Adapter) -> Result<Self, RenderError> {
        let wished = wgpu::Features::TIMESTAMP_QUERY;
        let features = adapter.features() & wished;
        // All that it has: node pools and meshes are large.
        let descriptor = wgpu::DeviceDescriptor {
            label: Some("antumbra"),
            required_features: features,
            required_limits: adapter.limits(),
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|error| RenderError::NoGpu { reason: error.to_string(), advice: ADVICE })?;
        let lost = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&lost);
        device.set_device_lost_callback(move |_, _| flag.store(true, Ordering::Relaxed));
        Ok(Self { device, queue, adapter, has_timestamps: features.contains(wgpu::Features::TIMESTAMP_QUERY), lost })
    }

    /// Its name and driver, for people.
    #[must_use]
    pub fn name(&self) -> String {
        let info = self.adapter.get_info();
        format!("{} ({:?}, {} {})", info.name, info.backend, info.driver, info.driver_info)
    }

    /// Whether it is no card at all but a program on the CPU.
    #[must_use]
    pub fn is_software(&self) -> bool {
        self.adapter.get_info().device_type == wgpu::DeviceType::Cpu
    }

    /// Whether it can time passes.
    #[must_use]
    pub fn has_timestamps(&self) -> bool {
        self.has_timestamps
    }

    /// Whether it went away (a driver was updated, a card pulled out, the system reset it): then everything on it is gone.
    #[must_use]
    pub fn is_lost(&self) -> bool {
        self.lost.load(Ordering::Relaxed)
    }

    /// Most bytes of one buffer that a kernel can read.
    #[must_use]
    pub fn most_bytes(&self) -> u64 {
        let limits = self.device.limits();
        limits.max_storage_buffer_binding_size.min(limits.max_buffer_size)
    }

    /// Whether a kernel can read a buffer of so many bytes; else the error says what is too large.
    pub(crate) fn check_size(&self, what: &'static str, bytes: u64) -> Result<(), RenderError> {
        if bytes <= self.most_bytes() {
            Ok(())
        } else {
            Err(RenderError::TooLargeForGpu { what, bytes, most: self.most_bytes() })
        }
    }

    /// A buffer with contents that kernels read and write. An empty slice gives 256 zero bytes: room for one of anything.
    #[must_use]
    pub fn buffer<T: Pod>(&self, label: &str, contents: &[T]) -> wgpu::Buffer {
        let bytes: &[u8] = bytemuck::cast_slice(contents);
        self.device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
            label: Some(label),
            contents: if bytes.is_empty() { &[0; 256] } else { bytes },
            usage: USAGE,
        })
    }

    /// A buffer of so many bytes (at least 256), all zero.
    #[must_use]
    pub fn zeros(&self, label: &str, bytes: u64) -> wgpu::Buffer {
        self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: bytes.max(256),
            usage: USAGE,
            mapped_at_creation: false,
        })
    }

    /// Waits for the card and copies a buffer back.
    ///
    /// # Errors
    /// [`RenderError::GpuLost`] when the card went away.
    pub fn read<T: Pod>(&self, buffer: &wgpu::Buffer) -> Result<Vec<T>, RenderError> {
        let copy = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("readback"),
            size: buffer.size(),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(buffer, 0, &copy, 0, buffer.size());
        self.queue.submit([encoder.finish()]);
        let mapped = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&mapped);
        copy.map_async(wgpu::MapMode::Read, .., move |result| flag.store(result.is_ok(), Ordering::Relaxed));
        self.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|_| RenderError::GpuLost)?;
        if !mapped.load(Ordering::Relaxed) {
            return Err(RenderError::GpuLost);
        }
        let view = copy.get_mapped_range(..).map_err(|_| RenderError::GpuLost)?;
        Ok(bytemuck::pod_collect_to_vec(&view))
    }

    /// A compute kernel of WGSL text with the entry point `main`; `groups` say what its bindings are.
    #[must_use]
    pub fn kernel(&self, label: &str, source: &str, groups: &[&[Slot]]) -> Kernel {
        let module = self.device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(label),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let layouts: Vec<_> = groups.iter().map(|slots| self.layout(slots, wgpu::ShaderStages::COMPUTE)).collect();
        let references: Vec<_> = layouts.iter().map(Some).collect();
        let layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(label),
            bind_group_layouts: &references,
            immediate_size: 0,
        });
        let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(label),
            layout: Some(&layout),
            module: &module,
            entry_point: Some("main"),
            compilation_options: Default::default(),
            cache: None,
        });
        Kernel { label: label.to_owned(), pipeline, layouts }
    }

    /// The layout of a bind group whose bindings are these, in order.
    pub(crate) fn layout(&self, slots: &[Slot], visibility: wgpu::ShaderStages) -> wgpu::BindGroupLayout {
        let entries: Vec<_> = slots
            .iter()
            .enumerate()
            .map(|(i, slot)| wgpu::BindGroupLayoutEntry {
                binding: i as u32,
                visibility,
                ty: slot.binding_type(),
                count: None,
            })
            .collect();
        self.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: None, entries: &entries })
    }

    /// A bind group of buffers and views, in the order of their bindings.
    #[must_use]
    pub fn group(&self, layout: &wgpu::BindGroupLayout, resources: &[wgpu::BindingResource<'_>]) -> wgpu::BindGroup {
        let entries: Vec<_> = resources
            .iter()
            .enumerate()
            .map(|(i, resource)| wgpu::BindGroupEntry { binding: i as u32, resource: resource.clone() })
            .collect();
        self.device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout, entries: &entries })
    }
}

const USAGE: wgpu::BufferUsages =
    wgpu::BufferUsages::STORAGE.union(wgpu::BufferUsages::COPY_DST).union(wgpu::BufferUsages::COPY_SRC);

/// What a binding of a kernel is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slot {
    /// A storage buffer that is only read.
    Read,
    /// A row of a storage buffer that is only read: which one is said when it is bound.
    ReadAt,
    /// A storage buffer that is read and written.
    Write,
    /// A texture of unsigned numbers, read texel by texel.
    Uints,
    /// Layers of depth, read texel by texel.
    DepthLayers,
}

impl Slot {
    fn binding_type(self) -> wgpu::BindingType {
        let texture = |sample_type, view_dimension| wgpu::BindingType::Texture {
            sample_type,
            view_dimension,
            multisampled: false,
        };
        match self {
            Self::Read | Self::ReadAt | Self::Write => wgpu::BindingType::Buffer {
                ty: wgpu::BufferBindingType::Storage { read_only: self != Self::Write },
                has_dynamic_offset: self == Self::ReadAt,
                min_binding_size: None,
            },
            Self::Uints => texture(wgpu::TextureSampleType::Uint, wgpu::TextureViewDimension::D2),
            Self::DepthLayers => texture(wgpu::TextureSampleType::Depth, wgpu::TextureViewDimension::D2Array),
        }
    }
}

/// A compute pipeline, and the layouts of its bind groups.
#[derive(Clone, Debug)]
pub struct Kernel {
    label: String,
    pipeline: wgpu::ComputePipeline,
    /// One for each group.
    pub layouts: Vec<wgpu::BindGroupLayout>,
}

impl Kernel {
    /// Records a pass of so many workgroups.
    pub fn run(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        timestamps: Option<wgpu::ComputePassTimestampWrites<'_>>,
        groups: &[&wgpu::BindGroup],
        workgroups: [u32; 3],
    ) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some(&self.label),
            timestamp_writes: timestamps,
        });
        self.record(&mut pass, groups, workgroups);
    }

    /// Records so many workgroups in a pass.
    pub(crate) fn record(&self, pass: &mut wgpu::ComputePass<'_>, groups: &[&wgpu::BindGroup], [x, y, z]: [u32; 3]) {
        pass.set_pipeline(&self.pipeline);
        for (i, group) in groups.iter().enumerate() {
            pass.set_bind_group(i as u32, *group, &[]);
        }
        pass.dispatch_workgroups(x, y, z);
    }
}
