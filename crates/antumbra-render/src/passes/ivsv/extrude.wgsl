// The slow way from thresholds to voxels, further passes: each takes up what lies `stride` columns before (Hillis and Steele
// 1986, "Data Parallel Algorithms").

@group(0) @binding(0) var<storage, read> batch: Batch;
@group(0) @binding(1) var<storage, read> before: array<vec4<u32>>;
@group(0) @binding(2) var<storage, read_write> after: array<vec4<u32>>;
@group(0) @binding(3) var<storage, read> stride: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let texels = batch.theta * batch.alpha * batch.quads;
    if id.x >= texels {
        return;
    }
    let at = id.y * texels + id.x;
    let column = id.x / batch.quads % batch.alpha;
    let reach = stride[0];
    let there = select(at - reach * batch.quads, at, column < reach);
    after[at] = before[at] | before[there];
}
