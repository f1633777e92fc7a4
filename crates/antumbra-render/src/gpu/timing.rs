//! How long passes take on the card.

use super::Gpu;
use crate::RenderError;

/// Most passes of one frame.
const MOST: u32 = 64;

/// Takes the time before and after passes.
#[derive(Debug)]
pub(crate) struct Timer {
    /// `None` where the card has no clock.
    queries: Option<wgpu::QuerySet>,
    names: Vec<&'static str>,
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
        let queries = gpu.has_timestamps().then(|| gpu.device.create_query_set(&descriptor));
        Self { queries, names: Vec::new() }
    }

    pub fn begin_frame(&mut self) {
        self.names.clear();
    }

    /// The numbers of the next pass's two times.
    fn next(&mut self, name: &'static str) -> Option<(u32, u32)> {
        let at = 2 * self.names.len() as u32;
        (at < 2 * MOST && self.queries.is_some()).then(|| {
            self.names.push(name);
            (at, at + 1)
        })
    }

    pub fn compute(&mut self, name: &'static str) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        let (begin, end) = self.next(name)?;
        Some(wgpu::ComputePassTimestampWrites {
            query_set: self.queries.as_ref()?,
            beginning_of_pass_write_index: Some(begin),
            end_of_pass_write_index: Some(end),
        })
    }

    pub fn render(&mut self, name: &'static str) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        let (begin, end) = self.next(name)?;
        Some(wgpu::RenderPassTimestampWrites {
            query_set: self.queries.as_ref()?,
            beginning_of_pass_write_index: Some(begin),
            end_of_pass_write_index: Some(end),
        })
    }

    /// Waits for the frame and reads its passes' times, in order; passes of one name in a row add up.
    pub fn read(&self, gpu: &Gpu) -> Result<Vec<PassTime>, RenderError> {
        let Some(queries) = self.queries.as_ref().filter(|_| !self.names.is_empty()) else { return Ok(Vec::new()) };
        let count = 2 * self.names.len() as u32;
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("times"),
            size: 8 * u64::from(count),
            usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
            mapped_at_creation: false,
        });
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        encoder.resolve_query_set(queries, 0..count, &buffer, 0);
        gpu.queue.submit([encoder.finish()]);
        let ticks: Vec<u64> = gpu.read(&buffer)?;
        let period_ms = f64::from(gpu.queue.get_timestamp_period()) * 1e-6;
        let mut times: Vec<PassTime> = Vec::new();
        for (name, pair) in self.names.iter().zip(ticks.chunks(2)) {
            let ms = pair[1].saturating_sub(pair[0]) as f64 * period_ms;
            match times.last_mut().filter(|last| last.name == *name) {
                Some(last) => last.ms += ms,
                None => times.push(PassTime { name, ms }),
            }
        }
        Ok(times)
    }
}
