// Boxes of space by tile and depth, whatever there is to see.

@group(0) @binding(0) var<storage, read> frame: Frame;
@group(0) @binding(1) var<storage, read_write> boxes: array<Box>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&boxes) {
        return;
    }
    let layer = id.x % frame.layers;
    let tile = vec2((id.x / frame.layers) % frame.tiles_x, id.x / frame.layers / frame.tiles_x);
    let near = select(frame.first_layer_m * pow(frame.layer_ratio, f32(layer) - 1.0), 0.0, layer == 0u);
    // The last layer has no end.
    let far = select(frame.first_layer_m * pow(frame.layer_ratio, f32(layer)), 1e30, layer + 1u == frame.layers);
    var box = Box(vec4(3.4e38), vec4(-3.4e38));
    for (var i = 0u; i < 4u; i++) {
        let pixel = (tile + vec2(i & 1u, i >> 1u)) * frame.tile;
        // A little more, for rounding at layers' and tiles' borders.
        let ray = ray_through(frame, vec2<f32>(pixel));
        let ends = array<vec3<f32>, 2>(ray * (near * 0.999), ray * (far * 1.001));
        box.low = min(box.low, vec4(min(ends[0], ends[1]), 0.0));
        box.high = max(box.high, vec4(max(ends[0], ends[1]), 0.0));
    }
    boxes[id.x] = box;
}
