// Adds the light of the lamps whose maps are there, a batch of them at a time.

@group(0) @binding(0) var<storage, read> frame: Frame;
@group(0) @binding(1) var<storage, read> gbuffer: array<Texel>;
@group(0) @binding(2) var<storage, read> lamps: array<Lamp>;
@group(0) @binding(3) var<storage, read> lists: array<u32>;
@group(0) @binding(4) var<storage, read_write> hdr: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read> veils: array<vec4<f32>>;
@group(0) @binding(6) var<storage, read> mapped_lamps: array<MappedLamp>;
@group(0) @binding(7) var<storage, read> map_layout: MapLayout;

@group(2) @binding(0) var maps: texture_depth_2d_array;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= frame.size) {
        return;
    }
    let index = pixel_index(frame, id.xy);
    let texel = gbuffer[index];
    if texel.depth == 0.0 {
        return;
    }
    let s = unpacked(frame, id.xy, texel);
    let first = list_of(id.xy, texel.depth);
    var light = vec3(0.0);
    for (var i = map_layout.first; i < map_layout.first + map_layout.count; i++) {
        let own = mapped_lamps[i];
        if (lists[first + own.lamp / 32u] >> (own.lamp & 31u) & 1u) == 0u {
            continue;
        }
        let lamp = lamps[own.lamp];
        let from_lamp = lamplight(lamp, s.position);
        if all(from_lamp.irradiance <= vec3(0.0)) || !can_be_lit(s, from_lamp.towards) {
            continue;
        }
        var seen = baked_share(lamp, s);
        if seen > 0.0 {
            seen *= map_visibility(own, lamp.position.xyz, s.position, s.face_normal);
        }
        if seen > 0.0 {
            light += reflected(s, from_lamp.towards, from_lamp.irradiance, seen);
        }
    }
    var clear = clearness(s);
    if frame.fog_per_m > 0.0 {
        clear *= veils[index].w;
    }
    hdr[index] += vec4(light * clear, luminance(light));
}
