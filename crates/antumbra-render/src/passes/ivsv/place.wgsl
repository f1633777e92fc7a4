// Places the cloud's points relative to the eye: twin of `cloud::Cloud::cast`.

struct CloudPoint {
    position: vec3<f32>,
    node: u32,
    normal: vec3<f32>,
    pad: u32,
}

struct Placed {
    position: vec3<f32>,
    pad_0: u32,
    normal: vec3<f32>,
    pad_1: u32,
}

@group(0) @binding(0) var<storage, read> batch: Batch;
@group(0) @binding(1) var<storage, read> cloud: array<CloudPoint>;
// Three rows for each node.
@group(0) @binding(2) var<storage, read> nodes: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> placed: array<Placed>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= batch.cloud {
        return;
    }
    let own = cloud[id.x];
    let x = nodes[3u * own.node];
    let y = nodes[3u * own.node + 1u];
    let z = nodes[3u * own.node + 2u];
    let at = vec4(own.position, 1.0);
    // Normals turn with the matrix of cofactors, which is the inverse's transpose but for a factor; discs have no back.
    let turned = vec3(
        dot(cross(y.xyz, z.xyz), own.normal), dot(cross(z.xyz, x.xyz), own.normal), dot(cross(x.xyz, y.xyz), own.normal),
    );
    placed[id.x] = Placed(vec3(dot(x, at), dot(y, at), dot(z, at)), 0u, turned / max(length(turned), 1e-30), 0u);
}
