// Adds the light of all lamps that reach a pixel, shadows looked up in the bake (Kämpe et al. 2015, section 4).

@group(0) @binding(0) var<storage, read> frame: Frame;
@group(0) @binding(1) var<storage, read> gbuffer: array<Texel>;
@group(0) @binding(2) var<storage, read> lamps: array<Lamp>;
@group(0) @binding(3) var<storage, read> lists: array<u32>;
@group(0) @binding(4) var<storage, read_write> hdr: array<vec4<f32>>;
// By pixel: how many lamps its shading looked at.
@group(0) @binding(5) var<storage, read_write> counts: array<u32>;
@group(0) @binding(6) var<storage, read> veils: array<vec4<f32>>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= frame.size) {
        return;
    }
    let index = pixel_index(frame, id.xy);
    let texel = gbuffer[index];
    counts[index] = 0u;
    if texel.depth == 0.0 {
        return;
    }
    let s = unpacked(frame, id.xy, texel);
    let first = list_of(id.xy, texel.depth);
    var light = vec3(0.0);
    var count = 0u;
    for (var word = 0u; word < frame.list_words; word++) {
        var bits = lists[first + word];
        while bits != 0u {
            let lamp = lamps[32u * word + countTrailingZeros(bits)];
            bits &= bits - 1u;
            count += 1u;
            if lamp.is_mapped != 0u {
                continue;
            }
            let from_lamp = lamplight(lamp, s.position);
            if all(from_lamp.irradiance <= vec3(0.0)) || !can_be_lit(s, from_lamp.towards) {
                continue;
            }
            let seen = baked_share(lamp, s);
            if seen > 0.0 {
                light += reflected(s, from_lamp.towards, from_lamp.irradiance, seen);
            }
        }
    }
    counts[index] = count;
    var clear = clearness(s);
    if frame.fog_per_m > 0.0 {
        clear *= veils[index].w;
    }
    hdr[index] += vec4(light * clear, luminance(light));
}
