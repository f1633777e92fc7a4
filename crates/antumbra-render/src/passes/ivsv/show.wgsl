// Puts the lights' own surfaces into the G-buffer: twin of `World::light_surface`.

@group(0) @binding(0) var<storage, read> frame: Frame;
@group(0) @binding(1) var<storage, read> lights: array<AreaLight>;
@group(0) @binding(2) var<storage, read> pictures: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read_write> gbuffer: array<Texel>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= frame.size) {
        return;
    }
    let index = pixel_index(frame, id.xy);
    let ray = ray_through(frame, vec2<f32>(id.xy) + frame.jitter);
    let stretch = length(ray);
    let direction = ray / stretch;
    let depth = gbuffer[index].depth;
    var nearest = Seen(select(depth * stretch, NOWHERE, depth == 0.0), vec3(0.0));
    var is_light = false;
    for (var i = 0u; i < frame.area_lights; i++) {
        if lights[i].shape == 3u {
            continue;
        }
        let there = seen(lights[i], direction);
        if there.t < nearest.t {
            nearest = there;
            is_light = true;
        }
    }
    if !is_light {
        return;
    }
    let normal = packed_normal(-direction);
    let emissive = min(nearest.radiance / frame.glow, vec3(65504.0));
    gbuffer[index] = Texel(
        nearest.t / stretch, normal, normal, 0u, pack2x16float(vec2(0.0, 1.0)), 1.0,
        pack2x16float(emissive.xy), pack2x16float(vec2(emissive.z, 0.0)),
    );
}
