// A directional light: towards it, and the irradiance of what faces it.
struct SunLight {
    towards: vec4<f32>,
    irradiance: vec4<f32>,
}
