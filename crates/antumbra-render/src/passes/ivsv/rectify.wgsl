// From maps to epipolar space: twin of `rectify`. A light ray is lit in columns less than its threshold.

@group(0) @binding(0) var<storage, read> batch: Batch;
@group(0) @binding(1) var<storage, read> vpls: array<Vpl>;
@group(0) @binding(2) var<storage, read> maps: array<u32>;
// By VPL, theta, phi.
@group(0) @binding(3) var<storage, read_write> thresholds: array<u32>;

fn threshold(vpl: Vpl, first: u32, theta: u32, phi: u32) -> u32 {
    let angle = (f32(phi) + 0.5) / vpl.phi_scale;
    let direction = light_ray(vpl, vpl.theta_min + (f32(theta) + 0.5) / vpl.theta_scale, angle);
    let seen = map_place(vpl, batch.map, direction);
    if seen.z <= HORIZON {
        return batch.alpha;
    }
    let r = map_between(first, batch.map, seen.xy);
    if r == 0.0 {
        return batch.alpha;
    }
    let alpha = atan2(r * sin(angle), vpl.distance - r * cos(angle));
    return min(u32(max((alpha - vpl.alpha_min) * vpl.alpha_scale, 0.0)), batch.alpha);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x < batch.theta * batch.phi {
        let vpl = vpls[batch.first + id.y];
        let own = threshold(vpl, id.y * batch.map * batch.map, id.x / batch.phi, id.x % batch.phi);
        thresholds[id.y * batch.theta * batch.phi + id.x] = own;
    }
}
