// VPLs, their maps, and their epipolar spaces: twin of `area::Vpl`, `splat::Paraboloid` and `epipolar`.

struct Batch {
    // VPLs: the first's number, and how many.
    first: u32,
    count: u32,
    // Samples of each axis; texels of 128 bits for phi.
    map: u32,
    alpha: u32,
    theta: u32,
    phi: u32,
    quads: u32,
    // Points of each map; of the cloud.
    points: u32,
    cloud: u32,
    pad_0: u32,
    pad_1: u32,
    pad_2: u32,
}

// Positions are relative to the eye.
struct Vpl {
    position: vec3<f32>,
    radius_m: f32,
    normal: vec3<f32>,
    start_m: f32,
    intensity: vec3<f32>,
    // Of its map's axes.
    per_spread: f32,
    x: vec3<f32>,
    // From the eye.
    distance: f32,
    y: vec3<f32>,
    alpha_min: f32,
    axis: vec3<f32>,
    theta_min: f32,
    across: vec3<f32>,
    alpha_scale: f32,
    along: vec3<f32>,
    theta_scale: f32,
    phi_scale: f32,
    wraps: u32,
    pad_0: u32,
    pad_1: u32,
}

const EMPTY: u32 = 0xffffffffu;
const HORIZON: f32 = 0.02;

// A point in epipolar space: angles.
struct Place {
    alpha: f32,
    theta: f32,
    phi: f32,
}

fn place_of(vpl: Vpl, ray: vec3<f32>, t: f32) -> Place {
    let cosine = dot(ray, vpl.axis);
    let aside = ray - vpl.axis * cosine;
    let sine = length(aside);
    return Place(
        atan2(sine, cosine),
        atan2(dot(aside, vpl.along), dot(aside, vpl.across)),
        atan2(t * sine, vpl.distance - t * cosine),
    );
}

fn theta_index(vpl: Vpl, theta: f32) -> f32 {
    return (theta - vpl.theta_min) * vpl.theta_scale;
}

// A plane's number, from one that may lie outside.
fn row_of(vpl: Vpl, planes: u32, index: i32) -> u32 {
    let last = i32(planes);
    let around = (index % last + last) % last;
    return u32(select(clamp(index, 0, last - 1), around, vpl.wraps == 1u));
}

fn light_ray(vpl: Vpl, theta: f32, phi: f32) -> vec3<f32> {
    return vpl.axis * -cos(phi) + (vpl.across * cos(theta) + vpl.along * sin(theta)) * sin(phi);
}

// Where a direction lies in a map, in texels, and its cosine to the normal: none below the horizon.
fn map_place(vpl: Vpl, side: u32, direction: vec3<f32>) -> vec3<f32> {
    let z = dot(direction, vpl.normal);
    let at = vec2(dot(direction, vpl.x), dot(direction, vpl.y)) * (vpl.per_spread / max(1.0 + z, 1e-6));
    return vec3((at * 0.5 + 0.5) * f32(side), z);
}

// The direction of the middle of a texel.
fn map_direction(vpl: Vpl, side: u32, texel: vec2<i32>) -> vec3<f32> {
    let at = ((vec2<f32>(texel) + 0.5) * (2.0 / f32(side)) - 1.0) / vpl.per_spread;
    let z = 2.0 / (1.0 + dot(at, at)) - 1.0;
    return (vpl.x * at.x + vpl.y * at.y) * (1.0 + z) + vpl.normal * z;
}
