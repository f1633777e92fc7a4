// Cascaded shadow maps: twin of `csm::reference`.

// By sun, then by cascade.
@group(2) @binding(0) var<storage, read> cascades: array<Cascade>;
@group(2) @binding(1) var maps: texture_depth_2d_array;

const CSM_BORDER: f32 = 10.0;
const CSM_ROUNDING: f32 = 1e-6;
const CSM_BILINEAR: u32 = 2u;

fn csm_lit(layer: u32, x: i32, y: i32, depth: f32) -> f32 {
    return select(0.0, 1.0, depth <= textureLoad(maps, vec2(x, y), layer, 0));
}

fn csm_filtered(layer: u32, at: vec3<f32>, radius: i32, kernel: u32) -> f32 {
    if kernel == CSM_BILINEAR {
        let corner = floor(at.xy - 0.5);
        let f = at.xy - 0.5 - corner;
        let i = vec2<i32>(corner);
        let top = mix(csm_lit(layer, i.x, i.y, at.z), csm_lit(layer, i.x + 1, i.y, at.z), f.x);
        let bottom = mix(csm_lit(layer, i.x, i.y + 1, at.z), csm_lit(layer, i.x + 1, i.y + 1, at.z), f.x);
        return mix(top, bottom, f.y);
    }
    let middle = vec2<i32>(at.xy);
    var sum = 0.0;
    var weights = 0.0;
    for (var y = -radius; y <= radius; y++) {
        for (var x = -radius; x <= radius; x++) {
            let tent = f32((radius + 1 - abs(x)) * (radius + 1 - abs(y)));
            let weight = select(tent, 1.0, kernel == 0u);
            sum += weight * csm_lit(layer, middle.x + x, middle.y + y, at.z);
            weights += weight;
        }
    }
    return sum / weights;
}

// How much of a sun reaches a point of a surface, by its cascades from `first` on; lit where no map holds it.
fn csm_visibility(first: u32, count: u32, point: vec3<f32>, normal: vec3<f32>, radius: u32, kernel: u32) -> f32 {
    let taps = select(2.0 * f32(radius) + 1.0, 2.0, kernel == CSM_BILINEAR);
    for (var i = first; i < first + count; i++) {
        let c = cascades[i];
        let across = (abs(dot(c.row_x.xyz, normal)) + abs(dot(c.row_y.xyz, normal))) * c.texel_m;
        let bias_m = (0.5 * taps + 1.0 / 16.0) * c.texel_m * across + CSM_ROUNDING * c.depth_m;
        let p = vec4(point + normal * bias_m, 1.0);
        let at = vec3(dot(c.row_x, p), dot(c.row_y, p), dot(c.row_z, p));
        if all(at.xy >= vec2(CSM_BORDER - 1.0)) && all(at.xy < vec2(c.size - CSM_BORDER + 1.0)) {
            return csm_filtered(i, at, i32(radius), kernel);
        }
    }
    return 1.0;
}
