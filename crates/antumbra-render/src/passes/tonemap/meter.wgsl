// Picks pixels from all over a picture, for its exposure.

@group(0) @binding(0) var<storage, read> frame: Frame;
@group(0) @binding(1) var<storage, read> hdr: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read_write> samples: array<vec4<f32>>;

const COLUMNS: u32 = 64u;
const ROWS: u32 = 36u;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= COLUMNS || id.y >= ROWS {
        return;
    }
    let pixel = (2u * id.xy + 1u) * frame.size / vec2(2u * COLUMNS, 2u * ROWS);
    samples[id.y * COLUMNS + id.x] = hdr[pixel_index(frame, pixel)] / f32(frame.samples);
}
