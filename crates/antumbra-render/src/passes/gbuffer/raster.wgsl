// Draws which triangle each sample sees: a visibility buffer (Burns, Hunt 2013). Materials follow in `resolve.wgsl`, so that a
// pixel pays for what it shows alone; only masked and translucent surfaces look at their textures here.

struct Corner {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) part: u32,
    @location(1) @interpolate(flat) triangle: u32,
    @location(2) weights: vec3<f32>,
}

@vertex
fn corner(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> Corner {
    let part = part_of(instance);
    let triangle = index / 3u;
    let vertices = vertices_of(part, triangle);
    let i = index % 3u;
    let p = position_of(part, vertices[i]);
    // Depth is near over distance: 1 at the near plane, 0 at infinity, as fine as single precision everywhere.
    let depth = dot(p, frame.forward.xyz);
    let x = dot(p, frame.right.xyz) / dot(frame.right.xyz, frame.right.xyz);
    let y = dot(p, frame.up.xyz) / dot(frame.up.xyz, frame.up.xyz);
    let shift = (0.5 - frame.jitter) * 2.0 / vec2<f32>(frame.size);
    let clip = vec4(x + shift.x * depth, y - shift.y * depth, frame.near, depth);
    var weights = vec3(0.0);
    weights[i] = 1.0;
    return Corner(clip, instance, triangle, weights);
}

@fragment
fn opaque(c: Corner) -> @location(0) vec2<u32> {
    return vec2(c.part + 1u, c.triangle);
}

@fragment
fn cut_out(c: Corner) -> @location(0) vec2<u32> {
    let part = part_of(c.part);
    let color = color_at(part, vertices_of(part, c.triangle), c.weights, 0.0);
    if material_word(part.material, 9u) == MASK {
        if color.w < material_value(part.material, 10u) {
            discard;
        }
    } else {
        // Translucent layers are there or not, sample by sample: each triangle gets its own numbers, and a pixel's samples
        // share them out evenly.
        let pixel = vec2<u32>(c.clip.xy);
        let layer = unit(pixel.x, pixel.y, part.first_triangle + c.triangle);
        if fract(layer + f32(frame.sample) / f32(frame.samples)) >= color.w {
            discard;
        }
    }
    return vec2(c.part + 1u, c.triangle);
}
