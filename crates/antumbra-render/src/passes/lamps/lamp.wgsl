// Spot and point lights, by the formulas of glTF's KHR_lights_punctual: twin of `light::Lamp`.

struct Lamp {
    // Relative to the eye.
    position: vec4<f32>,
    intensity: vec4<f32>,
    // Of a spot light, the way its light goes.
    axis: vec4<f32>,
    range_m: f32,
    // Nearer than this its light gets no brighter.
    core_m: f32,
    // Beyond this it gives too little to count.
    reach_m: f32,
    // -2 for light all round, 0 for a point of a surface.
    cos_outer: f32,
    // Takes the cosine from the outer angle's to 0 and the inner one's to 1.
    per_cosine: f32,
    // Which of the baked lights it is, or NOT_BAKED.
    light: u32,
    // Whether its shadows are in a map.
    is_mapped: u32,
    // Whether it is a point of a surface, which sends light by the cosine to its axis.
    is_lambertian: u32,
}

const NOT_BAKED: u32 = 0xffffffffu;

struct Lamplight {
    towards: vec3<f32>,
    irradiance: vec3<f32>,
}

// A box of space, relative to the eye; empty where low is not below high.
struct Box {
    low: vec4<f32>,
    high: vec4<f32>,
}

// Light at a point with nothing in the way: none where the irradiance is 0.
fn lamplight(lamp: Lamp, point: vec3<f32>) -> Lamplight {
    let to_lamp = lamp.position.xyz - point;
    let distance = length(to_lamp);
    if distance == 0.0 || any(abs(to_lamp) > vec3(lamp.reach_m)) {
        return Lamplight(vec3(0.0), vec3(0.0));
    }
    let towards = to_lamp / distance;
    let ratio = distance / lamp.range_m;
    let window = clamp(1.0 - ratio * ratio * ratio * ratio, 0.0, 1.0);
    var share = window / (max(distance, lamp.core_m) * max(distance, lamp.core_m));
    if lamp.is_lambertian != 0u {
        share *= max(dot(lamp.axis.xyz, -towards), 0.0);
    } else if lamp.cos_outer > -2.0 {
        let cone = clamp((dot(lamp.axis.xyz, -towards) - lamp.cos_outer) * lamp.per_cosine, 0.0, 1.0);
        share *= cone * cone;
    }
    return Lamplight(towards, lamp.intensity.xyz * share);
}
