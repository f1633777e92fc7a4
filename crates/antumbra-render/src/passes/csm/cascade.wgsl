// One shadow map: an orthographic view along a light.
struct Cascade {
    // From a point relative to the eye (and 1) to texels and to depth from 0 to 1.
    row_x: vec4<f32>,
    row_y: vec4<f32>,
    row_z: vec4<f32>,
    texel_m: f32,
    depth_m: f32,
    size: f32,
    pad: f32,
}
