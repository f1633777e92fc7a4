//! What passes write: one value per pixel, for one size of picture.

use super::Gpu;
use super::frame::Frame;

/// Format of what is seen: part + 1 and triangle.
pub(crate) const VISIBLE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Uint;
/// Format of depth.
pub(crate) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Bytes of the struct `Texel`.
pub(crate) const TEXEL_BYTES: u64 = 32;

/// Buffers and textures of one size.
#[derive(Debug)]
pub(crate) struct Targets {
    pub size: [u32; 2],
    suns: u32,
    has_fog: bool,
    has_area: bool,
    pub visible_part: wgpu::TextureView,
    pub depth: wgpu::TextureView,
    pub gbuffer: wgpu::Buffer,
    pub sunlit: wgpu::Buffer,
    pub hdr: wgpu::Buffer,
    pub screen: wgpu::Buffer,
    pub counts: wgpu::Buffer,
    /// Empty without fog.
    pub veils: wgpu::Buffer,
    /// Empty without area lights.
    pub gathered: wgpu::Buffer,
    pub area: wgpu::Buffer,
}

impl Targets {
    pub fn new(gpu: &Gpu, frame: &Frame) -> Self {
        let Frame { size, suns, .. } = *frame;
        let (has_fog, has_area) = (frame.fog_per_m > 0.0, frame.area_lights > 0);
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        let texture = |format| {
            let extra = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
            let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
                label: None,
                size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: extra,
                view_formats: &[],
            });
            texture.create_view(&wgpu::TextureViewDescriptor::default())
        };
        Self {
            size,
            suns,
            has_fog,
            has_area,
            visible_part: texture(VISIBLE_FORMAT),
            depth: texture(DEPTH_FORMAT),
            gbuffer: gpu.zeros("G-buffer", TEXEL_BYTES * pixels),
            sunlit: gpu.zeros("sunlit", 4 * pixels * u64::from(suns)),
            hdr: gpu.zeros("HDR", 16 * pixels),
            screen: gpu.zeros("screen", 4 * pixels),
            counts: gpu.zeros("lamps per pixel", 4 * pixels),
            veils: gpu.zeros("fog", if has_fog { 16 * pixels } else { 16 }),
            gathered: gpu.zeros("gathered", if has_area { 48 * pixels } else { 0 }),
            area: gpu.zeros("area light", if has_area { 32 * pixels } else { 0 }),
        }
    }

    /// Whether they suit a picture.
    pub fn suit(&self, frame: &Frame) -> bool {
        let (has_fog, has_area) = (frame.fog_per_m > 0.0, frame.area_lights > 0);
        self.size == frame.size && self.suns == frame.suns && self.has_fog == has_fog && self.has_area == has_area
    }
}
