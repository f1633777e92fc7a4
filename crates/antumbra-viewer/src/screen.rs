//! The window's surface, the panel's painter, and pictures of both.

use std::path::Path;
use std::sync::Arc;

use antumbra_render::RenderError;
use antumbra_render::gpu::{ADVICE, Gpu, GpuRenderer};
use egui_wgpu::{RendererOptions, ScreenDescriptor};
use winit::window::Window;

use crate::ViewError;

/// A window and what is drawn in it.
pub(crate) struct Screen {
    pub window: Arc<Window>,
    pub gpu: Gpu,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    pub context: egui::Context,
    pub input: egui_winit::State,
    painter: egui_wgpu::Renderer,
}

/// The panel, ready to be painted.
pub(crate) struct Painted {
    pub output: egui::FullOutput,
}

impl Screen {
    /// Opens the graphics card that can draw in a window.
    pub fn new(window: Arc<Window>) -> Result<Self, ViewError> {
        let instance = wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle().with_env());
        // Without any driver there is no surface either.
        let no_driver =
            |error: wgpu::CreateSurfaceError| RenderError::NoGpu { reason: error.to_string(), advice: ADVICE };
        let surface = instance.create_surface(Arc::clone(&window)).map_err(no_driver)?;
        let gpu = Gpu::open_for(&instance, Some(&surface))?;
        let size = window.inner_size();
        let mut config = surface
            .get_default_config(&gpu.adapter, size.width.max(1), size.height.max(1))
            .ok_or_else(|| ViewError::Surface("it has no format in common with it".to_owned()))?;
        // The panel blends as browsers do, without the card's own encoding.
        let formats = surface.get_capabilities(&gpu.adapter).formats;
        let plain = formats
            .iter()
            .find(|format| matches!(format, wgpu::TextureFormat::Bgra8Unorm | wgpu::TextureFormat::Rgba8Unorm));
        config.format = plain.copied().unwrap_or(config.format);
        surface.configure(&gpu.device, &config);
        let context = egui::Context::default();
        let side = gpu.device.limits().max_texture_dimension_2d as usize;
        let scale = Some(window.scale_factor() as f32);
        let input = egui_winit::State::new(context.clone(), egui::ViewportId::ROOT, &window, scale, None, Some(side));
        let painter = egui_wgpu::Renderer::new(&gpu.device, config.format, RendererOptions::default());
        Ok(Self { window, gpu, surface, config, context, input, painter })
    }

    /// Pixels.
    pub fn size(&self) -> [u32; 2] {
        [self.config.width, self.config.height]
    }

    /// The window has another size.
    pub fn resize(&mut self, width: u32, height: u32) {
        if width > 0 && height > 0 {
            (self.config.width, self.config.height) = (width, height);
            self.surface.configure(&self.gpu.device, &self.config);
        }
    }

    /// Shows the renderer's last frame with the panel over it. A surface that is not there right now skips the frame.
    pub fn present(&mut self, renderer: &mut GpuRenderer, painted: Painted) {
        let frame = match self.surface.get_current_texture() {
            wgpu::CurrentSurfaceTexture::Success(frame) | wgpu::CurrentSurfaceTexture::Suboptimal(frame) => frame,
            wgpu::CurrentSurfaceTexture::Outdated | wgpu::CurrentSurfaceTexture::Lost => {
                self.surface.configure(&self.gpu.device, &self.config);
                return self.forget(painted);
            }
            _ => return self.forget(painted),
        };
        let view = frame.texture.create_view(&wgpu::TextureViewDescriptor::default());
        self.draw(renderer, painted, &view);
        self.window.pre_present_notify();
        self.gpu.queue.present(frame);
    }

    /// Saves the renderer's last frame with the panel over it.
    pub fn screenshot(&mut self, renderer: &mut GpuRenderer, painted: Painted, path: &Path) -> Result<(), ViewError> {
        let [width, height] = self.size();
        let texture = self.gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("screenshot"),
            size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: self.config.format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        self.draw(renderer, painted, &view);
        // Rows of copies are multiples of 256 bytes.
        let row = (4 * width).next_multiple_of(256);
        let copy = self.gpu.zeros("screenshot", u64::from(row) * u64::from(height));
        let mut encoder = self.gpu.device.create_command_encoder(&Default::default());
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &copy,
                layout: wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(row), rows_per_image: None },
            },
            texture.size(),
        );
        self.gpu.queue.submit([encoder.finish()]);
        let bytes: Vec<u8> = self.gpu.read(&copy)?;
        let is_bgra =
            matches!(self.config.format, wgpu::TextureFormat::Bgra8Unorm | wgpu::TextureFormat::Bgra8UnormSrgb);
        let rows = bytes.chunks(row as usize).take(height as usize).flat_map(|row| row[..4 * width as usize].chunks(4));
        let rgb: Vec<u8> = rows.flat_map(|p| if is_bgra { [p[2], p[1], p[0]] } else { [p[0], p[1], p[2]] }).collect();
        image::save_buffer(path, &rgb, width, height, image::ExtendedColorType::Rgb8)
            .map_err(|error| ViewError::Screenshot { path: path.to_owned(), reason: error.to_string() })
    }

    fn draw(&mut self, renderer: &mut GpuRenderer, painted: Painted, view: &wgpu::TextureView) {
        let Self { gpu, config, context, painter, .. } = self;
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        renderer.blit(&mut encoder, view, config.format);
        let egui::FullOutput { mut textures_delta, shapes, pixels_per_point, .. } = painted.output;
        for (id, deltas) in &textures_delta.set {
            deltas.iter().for_each(|delta| painter.update_texture(&gpu.device, &gpu.queue, *id, delta));
        }
        let jobs = context.tessellate(shapes, pixels_per_point);
        let descriptor = ScreenDescriptor { size_in_pixels: [config.width, config.height], pixels_per_point };
        let mut commands = painter.update_buffers(&gpu.device, &gpu.queue, &mut encoder, &jobs, &descriptor);
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("panel"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        });
        painter.render(&mut pass.forget_lifetime(), &jobs, &descriptor);
        commands.push(encoder.finish());
        gpu.queue.submit(commands);
        textures_delta.free.iter().for_each(|id| painter.free_texture(id));
        textures_delta.clear();
    }

    /// Keeps the panel's textures, though nothing is shown.
    fn forget(&mut self, mut painted: Painted) {
        let delta = &mut painted.output.textures_delta;
        for (id, deltas) in &delta.set {
            deltas.iter().for_each(|delta| self.painter.update_texture(&self.gpu.device, &self.gpu.queue, *id, delta));
        }
        delta.free.iter().for_each(|id| self.painter.free_texture(id));
        delta.clear();
    }
}
