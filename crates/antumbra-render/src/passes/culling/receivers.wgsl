// Boxes of what is seen, by cell: twin of `Receivers`.

@group(0) @binding(0) var<storage, read> frame: Frame;
@group(0) @binding(1) var<storage, read> gbuffer: array<Texel>;
@group(0) @binding(2) var<storage, read> grid: CullGrid;
// Least corner, then greatest, as numbers that sort as they do.
@group(0) @binding(3) var<storage, read_write> boxes: array<atomic<u32>>;

// 0 is below all numbers: boxes begin as zeros, and least corners are kept upside down.
fn sortable(value: f32) -> u32 {
    let bits = bitcast<u32>(value);
    return select(bits | 0x80000000u, ~bits, (bits & 0x80000000u) != 0u);
}

fn raise(at: u32, value: u32) {
    if atomicLoad(&boxes[at]) < value {
        atomicMax(&boxes[at], value);
    }
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= frame.size) {
        return;
    }
    let depth = gbuffer[pixel_index(frame, id.xy)].depth;
    if depth == 0.0 {
        return;
    }
    let at = in_cells(grid, ray_through(frame, vec2<f32>(id.xy) + frame.jitter) * depth);
    // What lies outside belongs to the nearest cell.
    let cell = clamp(floor(at), vec3(0.0), vec3(f32(grid.side - 1u)));
    let block = vec3<u32>(cell) >> vec3(grid.source_level);
    let side = source_side(grid);
    let number = block.x + side * (block.y + side * block.z);
    for (var axis = 0u; axis < 3u; axis++) {
        raise(6u * number + axis, ~sortable(at[axis]));
        raise(6u * number + 3u + axis, sortable(at[axis]));
    }
}
