//! Cascaded shadow maps on the card.

use antumbra_scene::Bounds;
use bytemuck::{Pod, Zeroable};

use super::Gpu;
use super::passes::DepthRaster;
use super::scene::{DrawnPart, SceneBuffers};
use super::timing::Recorder;
use crate::camera::View;
use crate::light::Sun;
use crate::passes::csm::{Cascade, Cascades, Casters, fit};

/// The struct `Cascade` of `csm.wgsl`.
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct GpuCascade {
    pub row_x: [f32; 4],
    pub row_y: [f32; 4],
    pub row_z: [f32; 4],
    pub texel_m: f32,
    pub depth_m: f32,
    pub size: f32,
    pub pad: f32,
}

impl GpuCascade {
    fn new(cascade: &Cascade, size: u32) -> Self {
        let [row_x, row_y, row_z] = cascade.rows.map(|row| row.as_vec4().to_array());
        let Cascade { texel_m, depth_m, .. } = *cascade;
        Self { row_x, row_y, row_z, texel_m: texel_m as f32, depth_m: depth_m as f32, size: size as f32, pad: 0.0 }
    }
}

/// Maps of all suns, for one choice of options.
#[derive(Debug)]
pub(crate) struct Maps {
    options: Cascades,
    suns: usize,
    cascades: wgpu::Buffer,
    /// One for each map, for its drawing.
    own: Vec<wgpu::Buffer>,
    layers: Vec<wgpu::TextureView>,
    all: wgpu::TextureView,
}

/// Whether maps of those casters hold a part.
fn hold(casters: Casters, part: &DrawnPart) -> bool {
    !part.is_translucent && part.vertices > 0 && (casters == Casters::All || part.is_dynamic)
}

impl Maps {
    pub fn new(gpu: &Gpu, options: Cascades, suns: usize) -> Self {
        let count = (options.count as usize * suns).max(1);
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("shadow maps"),
            size: wgpu::Extent3d { width: options.size, height: options.size, depth_or_array_layers: count as u32 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: super::targets::DEPTH_FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let view = |base_array_layer, array_layer_count, dimension| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(dimension),
                base_array_layer,
                array_layer_count,
                ..Default::default()
            })
        };
        let bytes = size_of::<GpuCascade>() as u64;
        Self {
            options,
            suns,
            cascades: gpu.zeros("cascades", bytes * count as u64),
            own: (0..count).map(|_| gpu.zeros("cascade", bytes)).collect(),
            layers: (0..count as u32).map(|i| view(i, Some(1), wgpu::TextureViewDimension::D2)).collect(),
            all: view(0, None, wgpu::TextureViewDimension::D2Array),
        }
    }

    /// One texel, for passes that look at no map.
    pub fn none(gpu: &Gpu) -> Self {
        Self::new(gpu, Cascades { count: 1, size: 1, ..Cascades::default() }, 1)
    }

    pub fn suit(&self, options: &Cascades, suns: usize) -> bool {
        self.options == *options && self.suns == suns
    }

    pub fn resources(&self) -> [wgpu::BindingResource<'_>; 2] {
        [self.cascades.as_entire_binding(), wgpu::BindingResource::TextureView(&self.all)]
    }

    /// Fits the cascades to a view and records the drawing of their maps; returns how many there are for each sun.
    pub fn draw(
        &self,
        gpu: &Gpu,
        recorder: &mut Recorder<'_>,
        raster: &DepthRaster,
        scene: &SceneBuffers,
        frame: &wgpu::Buffer,
        casters: Casters,
        (view, suns, bounds): (&View, &[Sun], &Bounds),
    ) -> u32 {
        let fitted: Vec<Cascade> = suns.iter().flat_map(|sun| fit(&self.options, view, sun, bounds)).collect();
        let rows: Vec<_> = fitted.iter().map(|cascade| GpuCascade::new(cascade, self.options.size)).collect();
        if rows.is_empty() {
            return 0;
        }
        gpu.queue.write_buffer(&self.cascades, 0, bytemuck::cast_slice(&rows));
        let geometry = gpu.group(&raster.layouts[0], &scene.resources(frame));
        for (i, (cascade, row)) in fitted.iter().zip(&rows).enumerate() {
            gpu.queue.write_buffer(&self.own[i], 0, bytemuck::bytes_of(row));
            let own = gpu.group(&raster.layouts[1], &[self.own[i].as_entire_binding()]);
            recorder.draw("shadow maps", None, (&self.layers[i], wgpu::LoadOp::Clear(1.0)), |pass| {
                pass.set_bind_group(0, &geometry, &[]);
                pass.set_bind_group(1, &own, &[]);
                for (pipeline, cut_out) in [(&raster.opaque, false), (&raster.cut_out, true)] {
                    pass.set_pipeline(pipeline);
                    for (part, drawn) in (0..).zip(&scene.parts) {
                        if drawn.is_cut_out == cut_out && hold(casters, drawn) && self.touches(cascade, view, drawn) {
                            pass.draw(0..drawn.vertices, part..part + 1);
                        }
                    }
                }
            });
        }
        self.options.count
    }

    /// Whether a part may lie in a map, by the sphere about it.
    fn touches(&self, cascade: &Cascade, view: &View, part: &DrawnPart) -> bool {
        let (center, radius_m) = part.sphere();
        let at = cascade.project(center - view.eye);
        let (radius, side) = (radius_m / cascade.texel_m + 1.0, f64::from(self.options.size));
        at.x + radius >= 0.0 && at.x - radius <= side && at.y + radius >= 0.0 && at.y - radius <= side
    }
}
