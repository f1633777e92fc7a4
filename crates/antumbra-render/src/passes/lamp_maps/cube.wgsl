// Draws depth into one face of a cube map.

struct Corner {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) triangle: u32,
    @location(1) weights: vec3<f32>,
}

fn clip_of(p: vec3<f32>) -> vec4<f32> {
    let axis = target_.side / 2u;
    let w = select(p[axis], -p[axis], (target_.side & 1u) != 0u);
    return vec4(p[(axis + 1u) % 3u] * target_.scale, -p[(axis + 2u) % 3u] * target_.scale, target_.near_m, w);
}

@vertex
fn corner(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return clip_of(item_corner(listed(index / 3u, false), index % 3u));
}

@vertex
fn corner_cut_out(@builtin(vertex_index) index: u32) -> Corner {
    let item = listed(index / 3u, true);
    let p = item_corner(item, index % 3u);
    let triangle = triangle_of(item);
    var weights = vec3(0.0);
    weights[index % 3u] = 1.0;
    if is_piece(item) {
        weights = weights_at(triangle, p);
    }
    return Corner(clip_of(p), triangle, weights);
}

@fragment
fn cut_out(c: Corner) {
    if !is_there(c.triangle, c.weights) {
        discard;
    }
}
