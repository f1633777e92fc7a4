// What samples take from those around them, and their light by colour: twin of `filter`. Constant: GATHERING.

struct AreaLit {
    irradiance: vec4<f32>,
    glossy: vec4<f32>,
    airlight: vec4<f32>,
}

@group(0) @binding(0) var<storage, read> frame: Frame;
@group(0) @binding(1) var<storage, read> gbuffer: array<Texel>;
@group(0) @binding(2) var<storage, read> gathered: array<AreaLit>;
@group(0) @binding(3) var<storage, read> lights: array<AreaLight>;
@group(0) @binding(4) var<storage, read> pictures: array<vec4<f32>>;
// Two for each pixel: what its surface or the sky around the scene sends, and fog.
@group(0) @binding(5) var<storage, read_write> area: array<vec4<f32>>;

const OFF_PLANE: f32 = 0.02;
const OFF_WAY: f32 = 0.2;
const LEAST: f32 = 1e-5;

// What decides whether two samples share light.
struct Key {
    normal: vec3<f32>,
    position: vec3<f32>,
    fog_m: f32,
}

fn key_of(s: Surface, depth: f32) -> Key {
    let has_surface = depth > 0.0;
    let distance = select(frame.fog_end_m, s.distance, has_surface);
    return Key(select(vec3(0.0), s.normal, has_surface), s.towards_eye * -distance, min(distance, frame.fog_end_m));
}

fn affinity(own: Key, other: Key) -> vec2<f32> {
    let off_plane = abs(dot(own.normal, other.position - own.position));
    let near = max(1.0 - off_plane / max(OFF_PLANE * length(own.position), 1e-9), 0.0);
    let alike = max(dot(own.normal, other.normal), 0.0);
    let square = alike * alike;
    let through = 1.0 - abs(own.fog_m - other.fog_m) / max(OFF_WAY * max(own.fog_m, other.fog_m), 1e-9);
    return vec2(near * square * square * square * square, max(through, 0.0)) + LEAST;
}

fn shared_lit(pixel: vec2<u32>, own: Key) -> AreaLit {
    if GATHERING == 0u {
        return gathered[pixel_index(frame, pixel)];
    }
    var sum = AreaLit();
    var weights = vec2(0.0);
    let across = select(frame.size.x, (frame.size.x + 1u) / 2u, GATHERING == 2u);
    let middle = clamp(pixel, vec2(1u), frame.size - 2u);
    let last = (frame.size + 1u) / 2u - 1u;
    for (var i = 0u; i < select(4u, 9u, GATHERING == 1u); i++) {
        var at = middle + vec2(i % 3u, i / 3u) - 1u;
        var there = at;
        if GATHERING == 2u {
            let step = vec2(i & 1u, i >> 1u);
            if any(step > (pixel & vec2(1u))) {
                continue;
            }
            at = min(pixel / 2u + step, last);
            there = 2u * at;
        }
        let texel = gbuffer[pixel_index(frame, there)];
        let weight = affinity(own, key_of(unpacked(frame, there, texel), texel.depth));
        let lit = gathered[at.y * across + at.x];
        sum.irradiance += lit.irradiance * weight.x;
        sum.glossy += lit.glossy * weight.x;
        sum.airlight += lit.airlight * weight.y;
        weights += weight;
    }
    let times = select(1.0, 9.0, GATHERING == 1u) / weights;
    return AreaLit(sum.irradiance * times.x, sum.glossy * times.x, sum.airlight * times.y);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= frame.size) {
        return;
    }
    let index = pixel_index(frame, id.xy);
    let texel = gbuffer[index];
    let s = unpacked(frame, id.xy, texel);
    let lit = shared_lit(id.xy, key_of(s, texel.depth));
    var reflected = s.albedo * (1.0 - s.metallic) / PI * lit.irradiance.xyz + lit.glossy.xyz;
    if texel.depth == 0.0 {
        reflected = vec3(0.0);
        for (var i = 0u; i < frame.area_lights; i++) {
            if lights[i].shape == 3u {
                reflected += shown(lights[i], around(-s.towards_eye));
            }
        }
    }
    area[2u * index] = vec4(reflected, 0.0);
    area[2u * index + 1u] = max(lit.airlight, vec4(0.0));
}
