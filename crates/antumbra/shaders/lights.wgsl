// Lights and their faces.

// One light, as seen from a reference point of the world (the camera, say): positions that lookups are given are relative
// to it, so that single precision serves worlds of any size. Made by `GpuLight::new`.
struct AntumbraLight {
    // Directional: voxels per metre along x, y, z. Local: the light's unit axes.
    row_x: vec4<f32>,
    row_y: vec4<f32>,
    row_z: vec4<f32>,
    // Directional: voxel coordinates of the reference point, their whole part and their fraction. Local: the reference point
    // in the light's axes, metres (in `fraction`), and where the beginnings of its slices are in the tables (in `whole.w`; 0 for none).
    whole: vec4<i32>,
    fraction: vec4<f32>,
    // 0 directional, 1 spot, 2 point.
    kind: u32,
    log2_resolution: u32,
    // 1 or 6.
    faces: u32,
    // Where its faces begin in the tables: 4 words each, the light's own faces first, then those of coarse levels.
    first_face: u32,
    // Coarse levels.
    levels: u32,
    // Where the enter depths begin in the tables; 0 for none.
    enters: u32,
    // log2 of the cells per side of the finest enter depths, and the slices' shift.
    enter_log2: u32,
    enter_shift: u32,
    // Directional: size of a texel and a slice, metres. Local: 1 / texels per tangent, and slices' height per depth.
    texel: f32,
    slice: f32,
    // Local lights: texels per unit of tangent, near distance in metres, log2 of it, slices per octave of depth.
    texels_per_tangent: f32,
    near_m: f32,
    log2_near: f32,
    slices_per_octave: f32,
    // Near over far distance; slices even in normalized device coordinates where it is not 0.
    ndc_near_share: f32,
    // -1 without a cone.
    cone_cosine: f32,
}

// A face of a light, or of one of its coarse levels.
struct AntumbraFace {
    root: u32,
    // log2 of the voxels per side.
    log2_side: u32,
    // The top grid: where it begins in the tables, log2 of its cells per side.
    grid: u32,
    grid_log2: u32,
    // log2 of how many of the light's own texels lie between neighbours: on coarse levels without nodes of their own.
    stride: u32,
    // Where the beginnings of the slices are in the tables, of silhouettes; 0 where slices are even.
    slices: u32,
}

fn antumbra_face(light: AntumbraLight, level: u32, face: u32) -> AntumbraFace {
    let at = light.first_face + 4u * (level * light.faces + face);
    let last = antumbra_table(at + 3u);
    return AntumbraFace(
        antumbra_table(at), antumbra_table(at + 1u), antumbra_table(at + 2u), last & 0xffffu, last >> 16u,
        u32(light.whole.w));
}

// A node and log2 of its voxels per side.
struct AntumbraStart {
    node: u32,
    level: u32,
}
