// The slow way from thresholds to voxels, first pass: a bit where each light ray's shadow begins, in voxels that are empty.

@group(0) @binding(0) var<storage, read> batch: Batch;
@group(0) @binding(1) var<storage, read> thresholds: array<u32>;
// Words of texels.
@group(0) @binding(2) var<storage, read_write> voxels: array<atomic<u32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= batch.theta * batch.phi {
        return;
    }
    let plane = id.y * batch.theta + id.x / batch.phi;
    let phi = id.x % batch.phi;
    let column = thresholds[id.y * batch.theta * batch.phi + id.x];
    if column < batch.alpha {
        let texel = (plane * batch.alpha + column) * batch.quads;
        atomicOr(&voxels[4u * texel + phi / 32u], 1u << (phi & 31u));
    }
}
