//! Baked shadows in a shader of your own, with nothing but wgpu: `cargo run --release -p bare-wgpu -- city.antumbra`.
//!
//! Draws as text which points of a plane across the first light's volume that light reaches.

use antumbra::shaders::{GpuLight, Lookup, Tables, pages, source};
use antumbra::{FacePoint, ShadowFile};
use glam::{DVec3, Vec4};
use wgpu::util::DeviceExt;

/// Letters of a row, and rows.
const COLUMNS: usize = 100;
const ROWS: usize = 40;

/// Your own shader: the lookups are functions like any other.
const SHADER: &str = "
@group(0) @binding(0) var<storage, read> light: AntumbraLight;
@group(0) @binding(1) var<storage, read> points: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> visible: array<f32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&points) {
        // 9 x 9 taps that fall off to the edge, in the air: without a normal.
        visible[id.x] = antumbra_filtered(light, points[id.x].xyz, vec3(0.0), AntumbraFilter(4u, ANTUMBRA_TENT));
    }
}";

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("name a file: bare-wgpu city.antumbra")?;
    let file = ShadowFile::from_bytes(&std::fs::read(path)?)?;
    let light = file.lights().next().ok_or("the file has no light")?;

    // The card, with room for large node pools.
    let instance = wgpu::Instance::default();
    let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions::default()))?;
    let wished = wgpu::DeviceDescriptor { required_limits: adapter.limits(), ..Default::default() };
    let (device, queue) = pollster::block_on(adapter.request_device(&wished))?;

    // The points to ask for, relative to a reference point: single precision is then enough anywhere.
    let side = f64::from(light.record().resolution());
    let at = |x: usize, y: usize| {
        let share = DVec3::new((x as f64 + 0.5) / COLUMNS as f64, (y as f64 + 0.5) / ROWS as f64, 0.5);
        light.unproject(FacePoint { face: 0, voxel: share * side }).unwrap_or_default()
    };
    let camera = at(COLUMNS / 2, ROWS / 2);
    let relative = |i: usize| Vec4::from(((at(i % COLUMNS, i / COLUMNS) - camera).as_vec3(), 1.0)).to_array();
    let points: Vec<[f32; 4]> = (0..COLUMNS * ROWS).map(relative).collect();

    // What goes to the card: the light as seen from the reference point, its tables, and the node pool in pages.
    let tables = Tables::new(&file, |_| true);
    let most = adapter.limits().max_storage_buffer_binding_size;
    let (log2_page_words, pool) = pages(file.pool(), most).ok_or("the card's buffers are too small")?;
    let buffer = |bytes: &[u8]| {
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
        device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents: bytes, usage })
    };
    let light = buffer(bytemuck::bytes_of(&GpuLight::new(light, &tables, camera)));
    let visible = buffer(bytemuck::cast_slice(&vec![0.0f32; points.len()]));
    let own = [light, buffer(bytemuck::cast_slice(&points)), visible.clone()];
    let lookups = std::iter::once(tables.words()).chain(pool.iter().copied());
    let lookups: Vec<_> = lookups.map(|words| buffer(bytemuck::cast_slice(words))).collect();

    // The lookups' text before the shader's own, in a bind group of their own.
    let encoding = file.encoding();
    let lookup = Lookup { encoding, group: 1, pages: pool.len() as u32, log2_page_words, ..Lookup::default() };
    let source = wgpu::ShaderSource::Wgsl((source(&lookup) + SHADER).into());
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &module,
        entry_point: Some("main"),
        compilation_options: Default::default(),
        cache: None,
    });
    let group = |index: u32, buffers: &[wgpu::Buffer]| {
        let entry = |(i, b)| wgpu::BindGroupEntry { binding: i, resource: wgpu::Buffer::as_entire_binding(b) };
        let entries: Vec<_> = (0..).zip(buffers).map(entry).collect();
        let layout = pipeline.get_bind_group_layout(index);
        device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout: &layout, entries: &entries })
    };
    let (own, lookups) = (group(0, &own), group(1, &lookups));
    let mut encoder = device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &own, &[]);
    pass.set_bind_group(1, &lookups, &[]);
    pass.dispatch_workgroups(points.len().div_ceil(64) as u32, 1, 1);
    drop(pass);
    queue.submit([encoder.finish()]);

    // Reads the answers back and prints them.
    let shades = [b'#', b'+', b'-', b'.'];
    wgpu::util::DownloadBuffer::read_buffer(&device, &queue, &visible.slice(..), move |read| {
        let Ok(bytes) = read else { return eprintln!("the card did not answer") };
        for row in bytemuck::cast_slice::<u8, f32>(&bytes).chunks(COLUMNS) {
            let line = row.iter().map(|v| char::from(shades[(v * 3.99) as usize]));
            println!("{}", line.collect::<String>());
        }
    });
    device.poll(wgpu::PollType::wait_indefinitely())?;
    Ok(())
}
