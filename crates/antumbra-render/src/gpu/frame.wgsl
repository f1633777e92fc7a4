// What every pass knows: the camera, the picture, and the light of the scene. Positions are relative to the eye, along the
// world's axes, in metres.

struct Frame {
    // Half the picture's width and height at distance 1, and where the camera looks: a pixel's ray is
    // forward + right * x + up * y, with x and y from -1 to 1.
    right: vec4<f32>,
    up: vec4<f32>,
    forward: vec4<f32>,
    size: vec2<u32>,
    // Which of the pixel's samples this is, and of how many.
    sample: u32,
    samples: u32,
    // Where in the pixel it lies.
    jitter: vec2<f32>,
    // Side of what a sample stands for, at distance 1.
    footprint: f32,
    near: f32,
    // Distance at which haze hides all but 2 % of a surface.
    visible_m: f32,
    // Radiance of a surface whose material is emissive by 1.
    glow: f32,
    suns: u32,
    // The sky, as in `sky.wgsl`: the brightest star's radiance, then what the rest is made of.
    stars: f32,
    towards_sun: vec4<f32>,
    sun_azimuth: vec4<f32>,
    plain: vec4<f32>,
    overhead: vec4<f32>,
    disc: vec4<f32>,
    exposure: f32,
    lamps: u32,
    // Filter of shadow lookups: taps on either side of the middle one, and box (0), tent (1) or bilinear (2).
    radius: u32,
    kernel: u32,
    // Tangent of the sun's radius, for penumbrae.
    sun_tangent: f32,
    // Lists of lamps: the side of a tile in pixels, tiles per row, layers of clusters (0: boxes of what is seen), words of a
    // list.
    tile: u32,
    tiles_x: u32,
    layers: u32,
    list_words: u32,
    // Depths where the first layer ends and by what factor each is deeper; cascades in use for each sun.
    first_layer_m: f32,
    layer_ratio: f32,
    cascades: u32,
    // Fog: extinction per metre (0 for none), how far it reaches, Henyey and Greenstein's g.
    fog_per_m: f32,
    fog_end_m: f32,
    fog_anisotropy: f32,
    // Lights with a surface.
    area_lights: u32,
}

// The ray through a point of the picture, in pixels from the upper left corner; its part along `forward` is 1.
fn ray_through(frame: Frame, pixel: vec2<f32>) -> vec3<f32> {
    let at = 2.0 * pixel / vec2<f32>(frame.size) - 1.0;
    return frame.forward.xyz + frame.right.xyz * at.x - frame.up.xyz * at.y;
}

fn pixel_index(frame: Frame, pixel: vec2<u32>) -> u32 {
    return pixel.y * frame.size.x + pixel.x;
}

// Wellons (2018), "Prospecting for Hash Functions": `lowbias32`.
fn hash(seed: u32) -> u32 {
    var x = (seed ^ (seed >> 16u)) * 0x7feb352du;
    x = (x ^ (x >> 15u)) * 0x846ca68bu;
    return x ^ (x >> 16u);
}

// A number in 0..1 from three indices.
fn unit(x: u32, y: u32, sample: u32) -> f32 {
    return f32(hash(x ^ hash(y ^ hash(sample))) >> 8u) / 16777216.0;
}
