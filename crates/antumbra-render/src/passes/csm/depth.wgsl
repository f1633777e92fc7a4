// Draws the depth of casters into one cascade's map.

@group(1) @binding(0) var<storage, read> cascade: Cascade;

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
    let i = index % 3u;
    let p = vec4(position_of(part, vertices_of(part, triangle)[i]), 1.0);
    let texels_xy = vec2(dot(cascade.row_x, p), dot(cascade.row_y, p));
    let at = texels_xy * (2.0 / cascade.size) - 1.0;
    var weights = vec3(0.0);
    weights[i] = 1.0;
    return Corner(vec4(at.x, -at.y, dot(cascade.row_z, p), 1.0), instance, triangle, weights);
}

@fragment
fn cut_out(c: Corner) {
    let part = part_of(c.part);
    let color = color_at(part, vertices_of(part, c.triangle), c.weights, 0.0);
    if color.w < material_value(part.material, 10u) {
        discard;
    }
}
