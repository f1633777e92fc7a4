// What a sample of a pixel sees: 32 bytes.
struct Texel {
    // Along the camera's axis; 0 for the sky.
    depth: f32,
    // Unit normals for shading and of the triangle, on the viewer's side: octahedral, 16 bits each.
    normal: u32,
    face_normal: u32,
    // Linear albedo and perceptual roughness in half precision.
    albedo_rg: u32,
    albedo_b_roughness: u32,
    metallic: f32,
    // Linear light that the material gives off: half precision, in `emissive_b_footprint` with the sample's width in metres.
    emissive_rg: u32,
    emissive_b_footprint: u32,
}

// The same, unpacked.
struct Surface {
    position: vec3<f32>,
    distance: f32,
    towards_eye: vec3<f32>,
    normal: vec3<f32>,
    face_normal: vec3<f32>,
    albedo: vec3<f32>,
    emissive: vec3<f32>,
    metallic: f32,
    roughness: f32,
    footprint_m: f32,
}

// Meyer et al. (2010), "On Floating-Point Normal Vectors".
fn packed_normal(n: vec3<f32>) -> u32 {
    let p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
    let folded = (1.0 - abs(p.yx)) * select(vec2(-1.0), vec2(1.0), p >= vec2(0.0));
    return pack2x16snorm(select(folded, p, n.z >= 0.0));
}

fn unpacked_normal(packed: u32) -> vec3<f32> {
    let p = unpack2x16snorm(packed);
    let z = 1.0 - abs(p.x) - abs(p.y);
    let folded = (1.0 - abs(p.yx)) * select(vec2(-1.0), vec2(1.0), p >= vec2(0.0));
    return normalize(vec3(select(folded, p, z >= 0.0), z));
}

fn unpacked(frame: Frame, pixel: vec2<u32>, texel: Texel) -> Surface {
    let ray = ray_through(frame, vec2<f32>(pixel) + frame.jitter);
    let blue_roughness = unpack2x16float(texel.albedo_b_roughness);
    let glow_footprint = unpack2x16float(texel.emissive_b_footprint);
    let stretch = length(ray);
    return Surface(
        ray * texel.depth,
        stretch * texel.depth,
        ray / -stretch,
        unpacked_normal(texel.normal),
        unpacked_normal(texel.face_normal),
        vec3(unpack2x16float(texel.albedo_rg), blue_roughness.x),
        vec3(unpack2x16float(texel.emissive_rg), glow_footprint.x),
        texel.metallic,
        blue_roughness.y,
        stretch * texel.depth * frame.footprint,
    );
}
