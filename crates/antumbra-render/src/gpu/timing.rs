//! How long passes take on the card.

use std::time::{Duration, Instant};

use super::{Gpu, Kernel};
use crate::RenderError;

/// Most passes of one frame that the card times.
const MOST: u32 = 2048;

/// Takes the time of a frame's passes.
#[derive(Debug)]
pub(crate) struct Timer {
    clock: Clock,
    times: Vec<PassTime>,
}

#[derive(Debug)]
enum Clock {
    /// The card's own, read before and after each pass.
    Card(wgpu::QuerySet),
    /// The processor's, which waits for each pass to end. Software cards write their times when they draw, and not when they
    /// compute.
    Wall,
    None,
}

/// Time that a pass took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassTime {
    /// The pass.
    pub name: &'static str,
    /// Milliseconds on the card.
    pub ms: f64,
}

impl Timer {
    pub fn new(gpu: &Gpu) -> Self {
        let descriptor =
            wgpu::QuerySetDescriptor { label: Some("times"), ty: wgpu::QueryType::Timestamp, count: 2 * MOST };
        let clock = if gpu.is_software() {
            Clock::Wall
        } else if gpu.has_timestamps() {
            Clock::Card(gpu.device.create_query_set(&descriptor))
        } else {
            Clock::None
        };
        Self { clock, times: Vec::new() }
    }

    /// Times nothing.
    pub fn off() -> Self {
        Self { clock: Clock::None, times: Vec::new() }
    }

    pub fn begin_frame(&mut self) {
        self.times.clear();
    }

    /// Waits for the frame and reads its passes' times, in order; those of one name add up.
    pub fn read(&self, gpu: &Gpu) -> Result<Vec<PassTime>, RenderError> {
        let mut times = self.times.clone();
        if let Clock::Card(queries) = &self.clock {
            let period_ms = f64::from(gpu.queue.get_timestamp_period()) * 1e-6;
            for (time, pair) in
                times.iter_mut().zip(ticks(gpu, queries, self.times.len().min(MOST as usize))?.chunks(2))
            {
                time.ms = pair[1].saturating_sub(pair[0]) as f64 * period_ms;
            }
        }
        let mut summed: Vec<PassTime> = Vec::new();
        for time in times {
            match summed.iter_mut().find(|known| known.name == time.name) {
                Some(known) => known.ms += time.ms,
                None => summed.push(time),
            }
        }
        Ok(summed)
    }
}

/// Two times for each pass.
fn ticks(gpu: &Gpu, queries: &wgpu::QuerySet, passes: usize) -> Result<Vec<u64>, RenderError> {
    if passes == 0 {
        return Ok(Vec::new());
    }
    let count = 2 * passes as u32;
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("times"),
        size: 8 * u64::from(count),
        usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    encoder.resolve_query_set(queries, 0..count, &buffer, 0);
    gpu.queue.submit([encoder.finish()]);
    gpu.read(&buffer)
}

/// A kernel with its bindings, and how many workgroups of it run.
pub(crate) struct Step<'a> {
    pub kernel: &'a Kernel,
    pub groups: &'a [&'a wgpu::BindGroup],
    pub workgroups: [u32; 3],
}

/// Records passes one after the other, and times them.
pub(crate) struct Recorder<'a> {
    gpu: &'a Gpu,
    timer: &'a mut Timer,
    encoder: wgpu::CommandEncoder,
}

impl<'a> Recorder<'a> {
    pub fn new(gpu: &'a Gpu, timer: &'a mut Timer) -> Self {
        Self { gpu, timer, encoder: gpu.device.create_command_encoder(&Default::default()) }
    }

    /// A pass of so many workgroups.
    pub fn compute(&mut self, name: &'static str, kernel: &Kernel, groups: &[&wgpu::BindGroup], workgroups: [u32; 3]) {
        self.computes(name, &[Step { kernel, groups, workgroups }]);
    }

    /// Kernels that are timed as one pass.
    pub fn computes(&mut self, name: &'static str, steps: &[Step<'_>]) {
        let start = self.begin(name);
        let writes = self.writes();
        let writes = writes.as_ref().map(|(query_set, begin, end)| wgpu::ComputePassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(*begin),
            end_of_pass_write_index: Some(*end),
        });
        let mut pass = self
            .encoder
            .begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some(name), timestamp_writes: writes });
        steps.iter().for_each(|step| step.kernel.record(&mut pass, step.groups, step.workgroups));
        drop(pass);
        self.end(start);
    }

    /// Sets a buffer to zeros.
    pub fn clear(&mut self, buffer: &wgpu::Buffer) {
        self.encoder.clear_buffer(buffer, 0, None);
    }

    /// A pass that draws triangles, over a depth that begins as it says.
    pub fn draw(
        &mut self,
        name: &'static str,
        color: Option<&wgpu::TextureView>,
        (depth, load): (&wgpu::TextureView, wgpu::LoadOp<f32>),
        record: impl FnOnce(&mut wgpu::RenderPass<'_>),
    ) {
        let start = self.begin(name);
        let writes = self.writes();
        let writes = writes.as_ref().map(|(query_set, begin, end)| wgpu::RenderPassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: Some(*begin),
            end_of_pass_write_index: Some(*end),
        });
        let color = color.map(|view| wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT), store: wgpu::StoreOp::Store },
        });
        let colors: Vec<_> = color.into_iter().map(Some).collect();
        let ops = wgpu::Operations { load, store: wgpu::StoreOp::Store };
        let mut pass = self.encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some(name),
            color_attachments: &colors,
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: depth,
                depth_ops: Some(ops),
                stencil_ops: None,
            }),
            timestamp_writes: writes,
            occlusion_query_set: None,
            multiview_mask: None,
        });
        record(&mut pass);
        drop(pass);
        self.end(start);
    }

    /// Hands everything to the card.
    pub fn submit(self) {
        self.gpu.queue.submit([self.encoder.finish()]);
    }

    /// Notes the next pass; by the processor's clock, what was recorded before has ended.
    fn begin(&mut self, name: &'static str) -> Option<Instant> {
        if !matches!(self.timer.clock, Clock::None) {
            self.timer.times.push(PassTime { name, ms: 0.0 });
        }
        matches!(self.timer.clock, Clock::Wall).then(|| {
            self.flush();
            Instant::now()
        })
    }

    /// The card's clock, and where the pass just begun writes its times.
    fn writes(&self) -> Option<(wgpu::QuerySet, u32, u32)> {
        let Clock::Card(queries) = &self.timer.clock else { return None };
        let at = 2 * self.timer.times.len() as u32;
        (at <= 2 * MOST).then(|| (queries.clone(), at - 2, at - 1))
    }

    fn end(&mut self, start: Option<Instant>) {
        let Some(start) = start else { return };
        self.flush();
        let elapsed: Duration = start.elapsed();
        if let Some(time) = self.timer.times.last_mut() {
            time.ms = 1e3 * elapsed.as_secs_f64();
        }
    }

    /// Submits what was recorded and waits for it; a lost card shows when results are read.
    fn flush(&mut self) {
        let next = self.gpu.device.create_command_encoder(&Default::default());
        let recorded = std::mem::replace(&mut self.encoder, next);
        self.gpu.queue.submit([recorded.finish()]);
        let _ = self.gpu.device.poll(wgpu::PollType::wait_indefinitely());
    }
}
