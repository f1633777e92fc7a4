// The box about what each tile of 8 x 8 pixels shows.

@group(0) @binding(0) var<storage, read> frame: Frame;
@group(0) @binding(1) var<storage, read> gbuffer: array<Texel>;
@group(0) @binding(2) var<storage, read_write> boxes: array<Box>;

var<workgroup> lows: array<vec3<f32>, 64>;
var<workgroup> highs: array<vec3<f32>, 64>;

@compute @workgroup_size(8, 8)
fn main(
    @builtin(global_invocation_id) id: vec3<u32>,
    @builtin(workgroup_id) tile: vec3<u32>,
    @builtin(local_invocation_index) i: u32,
) {
    lows[i] = vec3(3.4e38);
    highs[i] = vec3(-3.4e38);
    if all(id.xy < frame.size) {
        let depth = gbuffer[pixel_index(frame, id.xy)].depth;
        if depth > 0.0 {
            let p = ray_through(frame, vec2<f32>(id.xy) + frame.jitter) * depth;
            lows[i] = p;
            highs[i] = p;
        }
    }
    for (var half = 32u; half > 0u; half /= 2u) {
        workgroupBarrier();
        if i < half {
            lows[i] = min(lows[i], lows[i + half]);
            highs[i] = max(highs[i], highs[i + half]);
        }
    }
    if i == 0u {
        boxes[tile.y * frame.tiles_x + tile.x] = Box(vec4(lows[0], 0.0), vec4(highs[0], 0.0));
    }
}
