// How much of each sun reaches what is seen: twin of `shadow::reference`.

@group(0) @binding(0) var<storage, read> frame: Frame;
@group(0) @binding(1) var<storage, read> gbuffer: array<Texel>;
@group(0) @binding(2) var<storage, read> suns: array<SunLight>;
@group(0) @binding(3) var<storage, read_write> visible: array<f32>;

// The baked lights: suns in their order, then lamps in theirs.
@group(1) @binding(0) var<storage, read> lights: array<AntumbraLight>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= frame.size) {
        return;
    }
    let index = pixel_index(frame, id.xy);
    let texel = gbuffer[index];
    for (var sun = 0u; sun < frame.suns; sun++) {
        var seen = 0.0;
        if texel.depth > 0.0 {
            let s = unpacked(frame, id.xy, texel);
            if can_be_lit(s, suns[sun].towards.xyz) {
                seen = looked_up(lights[sun], s);
                // Maps of everything, or over a bake of what moves.
                if HAS_MAPS && seen > 0.0 {
                    seen *= csm_visibility(
                        sun * frame.cascades, frame.cascades, s.position, s.face_normal, frame.radius, frame.kernel);
                }
            }
        }
        visible[index * frame.suns + sun] = seen;
    }
}
