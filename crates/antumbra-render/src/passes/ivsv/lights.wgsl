// Lights with a surface, as they are seen: twin of `area::AreaLight::seen`.

struct AreaLight {
    // Relative to the eye.
    position: vec3<f32>,
    // 0 rectangle, 1 disc, 2 sphere, 3 environment.
    shape: u32,
    direction: vec3<f32>,
    // Width, or radius.
    width_m: f32,
    up: vec3<f32>,
    height_m: f32,
    left: vec3<f32>,
    // Its picture's first texel, then its size; none where the size is 0.
    texels: u32,
    radiance: vec3<f32>,
    picture: u32,
}

struct Seen {
    t: f32,
    radiance: vec3<f32>,
}

const TAU: f32 = 6.28318531;
// No light is as far away as this.
const NOWHERE: f32 = 1e30;

fn shown(light: AreaLight, uv: vec2<f32>) -> vec3<f32> {
    let size = vec2(light.picture & 0xffffu, light.picture >> 16u);
    if size.x == 0u {
        return light.radiance;
    }
    let last = vec2<f32>(size - 1u);
    let at = clamp(saturate(uv) * vec2<f32>(size) - 0.5, vec2(0.0), last);
    let first = vec2<u32>(at);
    let second = min(first + 1u, size - 1u);
    let share = at - vec2<f32>(first);
    let rows = light.texels + vec2(first.y, second.y) * size.x;
    let upper = mix(pictures[rows.x + first.x], pictures[rows.x + second.x], share.x);
    let lower = mix(pictures[rows.y + first.x], pictures[rows.y + second.x], share.x);
    return light.radiance * mix(upper, lower, share.y).xyz;
}

fn around(out: vec3<f32>) -> vec2<f32> {
    return vec2(atan2(out.x, -out.z) / TAU + 0.5, acos(clamp(out.y, -1.0, 1.0)) / PI);
}

// What a light shows along a ray, and how far away.
fn seen(light: AreaLight, direction: vec3<f32>) -> Seen {
    if light.shape == 2u {
        let b = -dot(light.position, direction);
        let root = b * b - dot(light.position, light.position) + light.width_m * light.width_m;
        let t = -b - sqrt(max(root, 0.0));
        if root < 0.0 || t <= 0.0 {
            return Seen(NOWHERE, vec3(0.0));
        }
        return Seen(t, shown(light, around((direction * t - light.position) / light.width_m)));
    }
    let facing = dot(direction, light.direction);
    let t = dot(light.position, light.direction) / facing;
    if facing >= 0.0 || !(t > 0.0) {
        return Seen(NOWHERE, vec3(0.0));
    }
    let from_middle = direction * t - light.position;
    let at = vec2(dot(from_middle, light.left), dot(from_middle, light.up));
    if light.shape == 0u {
        let uv = 0.5 - at / vec2(light.width_m, light.height_m);
        let inside = all(uv >= vec2(0.0)) && all(uv <= vec2(1.0));
        return Seen(select(NOWHERE, t, inside), shown(light, uv));
    }
    let inside = length(at) <= light.width_m;
    return Seen(select(NOWHERE, t, inside), shown(light, 0.5 - at / (2.0 * light.width_m)));
}
