// From surfaces and the suns' light on them to radiance: twin of `shade::reference`. Lamps add theirs in `lamps.wgsl`.

@group(0) @binding(0) var<storage, read> frame: Frame;
@group(0) @binding(1) var<storage, read> gbuffer: array<Texel>;
@group(0) @binding(2) var<storage, read> sky: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> suns: array<SunLight>;
// By pixel and sun: 0 shadowed to 1 lit.
@group(0) @binding(4) var<storage, read> visible: array<f32>;
// Radiance; brightness of what surfaces reflect, by which pictures are exposed.
@group(0) @binding(5) var<storage, read_write> hdr: array<vec4<f32>>;
// Radiance of the fog before each pixel, and the share of light that comes through it, where there is fog.
@group(0) @binding(6) var<storage, read> veils: array<vec4<f32>>;
// Of area lights, where there are any, two for each pixel: what its surface or the sky around the scene sends, and fog.
@group(0) @binding(7) var<storage, read> area: array<vec4<f32>>;

// The sky in a surface. The split sum's second factor is Karis's (2014) fit.
fn reflected_sky(s: Surface, ambient: vec3<f32>) -> vec3<f32> {
    let nv = clamp(dot(s.normal, s.towards_eye), 0.0, 1.0);
    let rough = s.roughness;
    let a = min((1.0 - rough) * (1.0 - rough), exp2(-9.28 * nv)) * (1.0 - rough) + (0.0425 - 0.0275 * rough);
    let scale = a * -1.04 + 1.04 - 0.572 * rough;
    let bias = a * 1.04 - 0.04 + 0.022 * rough;
    let mirror = 2.0 * nv * s.normal - s.towards_eye;
    let unoccluded = sky_ambient(s.normal);
    let blurred = mix(sky_radiance(mirror), unoccluded, rough);
    let open = clamp(dot(ambient, vec3(1.0)) / dot(unoccluded, vec3(1.0)), 0.0, 1.0);
    return blurred * open * max(head_on(s) * scale + bias, vec3(0.0));
}

fn shaded(pixel: vec2<u32>, index: u32) -> vec4<f32> {
    let texel = gbuffer[index];
    let direction = normalize(ray_through(frame, vec2<f32>(pixel) + frame.jitter));
    var by_area = vec3(0.0);
    if frame.area_lights > 0u {
        by_area = area[2u * index].xyz;
    }
    if texel.depth == 0.0 {
        return vec4(sky_with_disc(direction) + by_area, 0.0);
    }
    let s = unpacked(frame, pixel, texel);
    let glow = s.emissive * frame.glow;
    let ambient = sky_ambient(s.normal);
    var light = s.albedo * (1.0 - s.metallic) * ambient + reflected_sky(s, ambient) + glow + by_area;
    for (var sun = 0u; sun < frame.suns; sun++) {
        let seen = visible[index * frame.suns + sun];
        if seen > 0.0 {
            light += reflected(s, suns[sun].towards.xyz, suns[sun].irradiance.xyz, seen);
        }
    }
    // Aerial perspective: the farther, the more of the horizon's light and the less of the surface's.
    let size = length(direction.xz);
    let level = select(vec3(1.0, 0.0, 0.0), vec3(direction.x, 0.0, direction.z) / size, size > 0.0);
    return vec4(mix(sky_radiance(level) * 0.8, light, clearness(s)), luminance(light - glow));
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= frame.size) {
        return;
    }
    let index = pixel_index(frame, id.xy);
    let before = select(hdr[index], vec4(0.0), frame.sample == 0u);
    var light = shaded(id.xy, index);
    if frame.fog_per_m > 0.0 {
        let veil = veils[index];
        light = vec4(light.xyz * veil.w + veil.xyz, light.w);
        if frame.area_lights > 0u {
            light += vec4(area[2u * index + 1u].xyz, 0.0);
        }
    }
    hdr[index] = before + light;
}
