// Fills holes in maps, in blocks of 8 x 8 texels: twin of `splat::Map::filled`. A hole takes the smallest block's mean that
// is mostly full.

@group(0) @binding(0) var<storage, read> batch: Batch;
@group(0) @binding(1) var<storage, read_write> maps: array<u32>;

// The block's texels, then its coarser copies: of 4 x 4, 2 x 2 and 1. 0 is nothing.
var<workgroup> levels: array<f32, 85>;

// The mean of four, of which three are there.
fn pulled(first: u32, side: u32, x: u32, y: u32) -> f32 {
    var sum = 0.0;
    var count = 0.0;
    for (var i = 0u; i < 4u; i++) {
        let r = levels[first + (2u * y + (i >> 1u)) * side + 2u * x + (i & 1u)];
        sum += r;
        count += select(0.0, 1.0, r > 0.0);
    }
    return select(0.0, sum / count, count >= 3.0);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_id) local: vec3<u32>) {
    let x = local.x;
    let y = local.y;
    let side = batch.map;
    let at = group.z * side * side + (8u * group.y + y) * side + 8u * group.x + x;
    let bits = maps[at];
    levels[8u * y + x] = select(bitcast<f32>(bits), 0.0, bits == EMPTY);
    workgroupBarrier();
    if x < 4u && y < 4u {
        levels[64u + 4u * y + x] = pulled(0u, 8u, x, y);
    }
    workgroupBarrier();
    if x < 2u && y < 2u {
        levels[80u + 2u * y + x] = pulled(64u, 4u, x, y);
    }
    workgroupBarrier();
    if x == 0u && y == 0u {
        levels[84] = pulled(80u, 2u, 0u, 0u);
    }
    workgroupBarrier();
    if bits != EMPTY {
        return;
    }
    var r = levels[64u + 4u * (y / 2u) + x / 2u];
    if r == 0.0 {
        r = levels[80u + 2u * (y / 4u) + x / 4u];
    }
    if r == 0.0 {
        r = levels[84];
    }
    if r > 0.0 {
        maps[at] = bitcast<u32>(r);
    }
}
