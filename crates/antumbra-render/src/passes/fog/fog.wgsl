// Fog before what is seen, with the shafts of light in it: twin of `fog::reference`.

@group(0) @binding(0) var<storage, read> frame: Frame;
@group(0) @binding(1) var<storage, read> gbuffer: array<Texel>;
@group(0) @binding(2) var<storage, read> suns: array<SunLight>;
// Radiance of the fog, and the share of light that comes through it.
@group(0) @binding(3) var<storage, read_write> veils: array<vec4<f32>>;

@group(1) @binding(0) var<storage, read> lights: array<AntumbraLight>;

// Henyey, Greenstein (1941).
fn phase(g: f32, cosine: f32) -> f32 {
    return (1.0 - g * g) / (4.0 * PI * pow(1.0 + g * g - 2.0 * g * cosine, 1.5));
}

const MAPS: u32 = 5u;
// Steps through shadow maps, which know single points alone.
const STEPS: u32 = 64u;

fn lit_through(sun: u32, end: vec3<f32>, optical_depth: f32) -> f32 {
    if SHADOW == 0u {
        return antumbra_lit_weight(optical_depth, 0.0, 1.0);
    }
    if SHADOW != MAPS {
        return antumbra_lit_through(lights[sun], vec3(0.0), end, optical_depth);
    }
    var lit = 0.0;
    for (var i = 0u; i < STEPS; i++) {
        let from_t = f32(i) / f32(STEPS);
        let to_t = f32(i + 1u) / f32(STEPS);
        let at = end * (0.5 * (from_t + to_t));
        let seen = csm_visibility(sun * frame.cascades, frame.cascades, at, vec3(0.0), 0u, 0u);
        lit += seen * antumbra_lit_weight(optical_depth, from_t, to_t);
    }
    return lit;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= frame.size) {
        return;
    }
    let index = pixel_index(frame, id.xy);
    let ray = ray_through(frame, vec2<f32>(id.xy) + frame.jitter);
    let stretch = length(ray);
    let depth = gbuffer[index].depth;
    // Behind the scene there is none.
    let distance = select(min(depth * stretch, frame.fog_end_m), frame.fog_end_m, depth == 0.0);
    let direction = ray / stretch;
    let optical_depth = frame.fog_per_m * distance;
    let clear = exp(-optical_depth);
    // The sky lights fog from all sides.
    var light = frame.overhead.xyz * (1.0 - clear);
    for (var sun = 0u; sun < frame.suns; sun++) {
        let lit = lit_through(sun, direction * distance, optical_depth);
        light += suns[sun].irradiance.xyz * (phase(frame.fog_anisotropy, dot(direction, suns[sun].towards.xyz)) * lit);
    }
    veils[index] = vec4(light, clear);
}
