struct Query {
    voxel: vec3<i32>,
    op: u32,
    arguments: vec4<u32>,
    light: u32,
    face: u32,
    level: u32,
    pad: u32,
    position: vec4<f32>,
    normal: vec4<f32>,
}

@group(0) @binding(0) var<storage, read> lights: array<AntumbraLight>;
@group(0) @binding(1) var<storage, read> queries: array<Query>;
@group(0) @binding(2) var<storage, read_write> answers: array<array<u32, 8>>;

fn projected(light: AntumbraLight, point: vec3<f32>) -> array<u32, 8> {
    let at = antumbra_project(light, point);
    let voxel = bitcast<vec3<u32>>(at.voxel);
    let fraction = bitcast<vec3<u32>>(at.fraction);
    return array<u32, 8>(at.face, voxel.x, voxel.y, voxel.z, fraction.x, fraction.y, fraction.z, 0u);
}

fn one(value: f32) -> array<u32, 8> {
    return array<u32, 8>(bitcast<u32>(value), 0u, 0u, 0u, 0u, 0u, 0u, 0u);
}

fn answer(q: Query) -> array<u32, 8> {
    let light = lights[q.light];
    let face = antumbra_face(light, q.level, q.face);
    let filter_ = AntumbraFilter(q.arguments.x, q.arguments.y);
    let footprint_m = bitcast<f32>(q.arguments.z);
    let position = q.position.xyz;
    let normal = q.normal.xyz;
    switch q.op {
        case 0u: {
            return array<u32, 8>(u32(antumbra_voxel_is_lit(face, vec3<u32>(q.voxel))), 0u, 0u, 0u, 0u, 0u, 0u, 0u);
        }
        case 1u: {
            let w = antumbra_weights(face, q.voxel, filter_);
            return array<u32, 8>(w.lit, w.inside, w.all, 0u, 0u, 0u, 0u, 0u);
        }
        case 2u: { return one(antumbra_voxel_mean(face, vec3<u32>(q.voxel), q.arguments.x)); }
        case 3u: {
            let shift = vec2(light.log2_resolution - light.enter_log2);
            let depth = u32(q.voxel.z) >> light.enter_shift;
            let found = antumbra_enter_window(light, q.face, q.arguments.xy >> shift, q.arguments.zw >> shift, depth);
            return array<u32, 8>(found.x, found.y, 0u, 0u, 0u, 0u, 0u, 0u);
        }
        case 4u: {
            var walk = antumbra_walk_on(face);
            // A second descent begins where the first ended.
            let elsewhere = antumbra_cell(&walk, vec3<u32>(q.voxel) ^ vec3(5u, 9u, 12u));
            let cell = antumbra_cell(&walk, vec3<u32>(q.voxel));
            if elsewhere.end.x == 0u {
                return one(0.0);
            }
            let lit = u32(cell.is_lit);
            return array<u32, 8>(
                cell.first.x, cell.first.y, cell.first.z, lit, cell.end.x, cell.end.y, cell.end.z, 0u);
        }
        case 5u: { return projected(light, position); }
        case 6u: { return projected(light, position + normal * antumbra_bias_m(light, position, normal, filter_)); }
        case 7u: { return one(antumbra_filtered(light, position, normal, filter_)); }
        case 8u: { return one(antumbra_mean(light, position, normal, footprint_m)); }
        case 9u: { return one(antumbra_levels(light, position, normal, footprint_m, filter_)); }
        case 10u: {
            let bounds = bitcast<vec2<u32>>(antumbra_blocker(light, position, footprint_m));
            return array<u32, 8>(bounds.x, bounds.y, 0u, 0u, 0u, 0u, 0u, 0u);
        }
        default: { return one(antumbra_lit_share(light, position, position + normal)); }
    }
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < arrayLength(&queries) {
        var found = answer(queries[id.x]);
        found[7] = words_read();
        answers[id.x] = found;
    }
}
