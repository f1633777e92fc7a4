// Which lamps may reach which part of the picture (Olsson, Billeter, Assarsson 2012, "Clustered deferred and forward
// shading"): a list is one bit per lamp, so that its order never depends on timing.

@group(0) @binding(0) var<storage, read> frame: Frame;
@group(0) @binding(1) var<storage, read> lamps: array<Lamp>;
@group(0) @binding(2) var<storage, read> boxes: array<Box>;
@group(0) @binding(3) var<storage, read_write> lists: array<u32>;

fn touches(lamp: Lamp, box: Box) -> bool {
    // The sphere of its light against the box.
    let nearest = clamp(lamp.position.xyz, box.low.xyz, box.high.xyz) - lamp.position.xyz;
    let reach = lamp.reach_m;
    if dot(nearest, nearest) > reach * reach {
        return false;
    }
    if lamp.cos_outer <= 0.0 {
        return true;
    }
    // Its cone against the sphere about the box (Wronski 2017, "Cull that cone!").
    let center = 0.5 * (box.low.xyz + box.high.xyz) - lamp.position.xyz;
    let radius = 0.5 * length(box.high.xyz - box.low.xyz);
    let along = dot(center, lamp.axis.xyz);
    let across = sqrt(max(dot(center, center) - along * along, 0.0));
    let sine = sqrt(1.0 - lamp.cos_outer * lamp.cos_outer);
    return lamp.cos_outer * across - sine * along <= radius && along >= -radius;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    // Rows of workgroups: a dispatch has at most 65535 to a side.
    let at = id.y * groups.x * 64u + id.x;
    if at >= arrayLength(&boxes) * frame.list_words {
        return;
    }
    let box = boxes[at / frame.list_words];
    let word = at % frame.list_words;
    var bits = 0u;
    if all(box.low.xyz <= box.high.xyz) {
        let end = min(frame.lamps, 32u * word + 32u);
        for (var lamp = 32u * word; lamp < end; lamp++) {
            bits |= select(0u, 1u << (lamp & 31u), touches(lamps[lamp], box));
        }
    }
    lists[at] = bits;
}
