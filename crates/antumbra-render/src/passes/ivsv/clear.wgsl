// Empties maps.

@group(0) @binding(0) var<storage, read> batch: Batch;
@group(0) @binding(1) var<storage, read_write> maps: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < batch.map * batch.map {
        maps[id.y * batch.map * batch.map + id.x] = EMPTY;
    }
}
