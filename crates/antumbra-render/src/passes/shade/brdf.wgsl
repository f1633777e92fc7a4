// How surfaces reflect: Lambert, and glTF 2.0's microfacets (appendix B: GGX, Smith, Schlick).

// Reflectance at right angles: 4 % for all but metals.
fn head_on(s: Surface) -> vec3<f32> {
    return mix(vec3(0.04), s.albedo, s.metallic);
}

// Cosine of a light to the shading normal, taken to zero where the triangle itself turns away: Chiang, Li and Burley
// (2019), "Taming the Shadow Terminator".
fn incidence(s: Surface, towards: vec3<f32>) -> f32 {
    let smoothed = max(dot(s.normal, towards), 0.0);
    let face = max(dot(s.face_normal, towards), 0.0);
    let between = max(dot(s.normal, s.face_normal), 1e-3);
    let g = min(face / max(smoothed * between, 1e-6), 1.0);
    return smoothed * (-g * g * g + g * g + g);
}

fn highlight(s: Surface, towards: vec3<f32>) -> vec3<f32> {
    let between = s.towards_eye + towards;
    let size = length(between);
    let h = select(vec3(0.0), between / size, size > 0.0);
    let nv = max(dot(s.normal, s.towards_eye), 1e-3);
    let nl = max(dot(s.normal, towards), 1e-3);
    // A sharper mirror would show a light as a handful of blinding samples.
    let rough = max(s.roughness, 0.15);
    let alpha = rough * rough;
    let alpha_2 = alpha * alpha;
    let nh = dot(s.normal, h);
    let peak = nh * nh * (alpha_2 - 1.0) + 1.0;
    let distribution = alpha_2 / (PI * peak * peak);
    let smith = nl * sqrt(nv * nv * (1.0 - alpha_2) + alpha_2) + nv * sqrt(nl * nl * (1.0 - alpha_2) + alpha_2);
    let away = 1.0 - clamp(dot(s.towards_eye, h), 0.0, 1.0);
    let fresnel = head_on(s) + (1.0 - head_on(s)) * (away * away * away * away * away);
    return fresnel * (distribution * 0.5 / smith);
}

// What a light sends to the eye by way of a surface.
fn reflected(s: Surface, towards: vec3<f32>, irradiance: vec3<f32>, visible: f32) -> vec3<f32> {
    let diffuse = s.albedo * (1.0 - s.metallic) / PI;
    return (diffuse + highlight(s, towards)) * irradiance * (incidence(s, towards) * visible);
}

// Whether light can fall on the side that is seen.
fn can_be_lit(s: Surface, towards: vec3<f32>) -> bool {
    return dot(s.face_normal, towards) > 0.0 && dot(s.normal, towards) > 0.0;
}

// Optical depth at which haze hides all but 2 % of a surface.
const HIDDEN: f32 = 3.9;

// Share of a surface's light that comes through the haze.
fn clearness(s: Surface) -> f32 {
    return exp(-HIDDEN * s.distance / frame.visible_m);
}
