//! Lamps' shadow maps in tiles of one texture.

use super::Gpu;
use super::targets::DEPTH_FORMAT;

/// Maps in tiles of the layers of a texture.
#[derive(Debug)]
pub(crate) struct Sheets {
    /// Texels per side of a tile, tiles per row of a layer, tiles in all.
    pub of: (u32, u32, u32),
    pub layers: Vec<wgpu::TextureView>,
    pub all: wgpu::TextureView,
}

impl Sheets {
    pub fn new(gpu: &Gpu, size: u32, tiles: u32) -> Self {
        let most = gpu.device.limits().max_texture_dimension_2d / size;
        let per_row = (1..4).find(|n| n * n >= tiles).unwrap_or(4).min(most).max(1);
        let layers = tiles.div_ceil(per_row * per_row);
        let rows = if layers == 1 { tiles.div_ceil(per_row) } else { per_row };
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("lamp maps"),
            size: wgpu::Extent3d { width: per_row * size, height: rows * size, depth_or_array_layers: layers },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: DEPTH_FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let view = |base_array_layer, array_layer_count, dimension| {
            let dimension = Some(dimension);
            texture.create_view(&wgpu::TextureViewDescriptor {
                dimension,
                base_array_layer,
                array_layer_count,
                ..Default::default()
            })
        };
        Self {
            of: (size, per_row, tiles),
            layers: (0..layers).map(|i| view(i, Some(1), wgpu::TextureViewDimension::D2)).collect(),
            all: view(0, None, wgpu::TextureViewDimension::D2Array),
        }
    }

    pub fn tiles_per_layer(&self) -> u32 {
        self.of.1 * self.of.1
    }

    /// Layer, and upper left texel, of a tile.
    pub fn place(&self, tile: u32) -> (u32, [u32; 2]) {
        let (size, per_row, _) = self.of;
        let in_layer = tile % self.tiles_per_layer();
        (tile / self.tiles_per_layer(), [in_layer % per_row * size, in_layer / per_row * size])
    }
}
