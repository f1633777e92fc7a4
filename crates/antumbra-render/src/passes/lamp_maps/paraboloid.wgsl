// Draws depth into one half of a dual paraboloid map (Brabec, Annen, Seidel 2002, "Shadow mapping for hemispherical and omnidirectional
// light sources"). Their edges are arcs there, so corners alone will not do: each triangle is drawn as a box about its
// arcs, in which every texel intersects its own ray with the triangle (after Gascuel, Holzschuch, Fournier, Péroche 2008, "Fast
// non-linear projections using graphics hardware"). Large triangles need no cutting, and nothing depends on how they are cut.

struct Corner {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) a: vec3<f32>,
    @location(1) @interpolate(flat) b: vec3<f32>,
    @location(2) @interpolate(flat) c: vec3<f32>,
    @location(3) @interpolate(flat) item: u32,
}

// Turned so that the paraboloid's axis is z.
fn turned(p: vec3<f32>) -> vec3<f32> {
    return vec3(p.x, p.z, select(p.y, -p.y, target_.side == 1u));
}

// How far an arc's image may bulge beyond its chord: a great circle's image is a circle whose radius is the length of its
// normal over the normal's z, and within the paraboloid's rim it is at most half of it.
fn bulge(start: vec3<f32>, end: vec3<f32>, chord: vec2<f32>) -> f32 {
    let normal = cross(start, end);
    let height = abs(normal.z);
    let size = length(normal);
    let half = 0.5 * length(chord);
    // A circle through the axis is a line.
    if height * half < 1e-7 * size {
        return 0.5 * half * half * height / max(size, 1e-30) + 1e-6;
    }
    let radius = size / height;
    return half * half / (radius + sqrt(max(radius * radius - half * half, 0.0))) + 1e-6;
}

// A box about a triangle's image: least corner, then greatest.
fn box_of(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>) -> vec4<f32> {
    let all = vec4(-1e9, -1e9, 1e9, 1e9);
    let sizes = vec3(length(a), length(b), length(c));
    if min(a.z, min(b.z, c.z)) < 0.0 || any(sizes == vec3(0.0)) {
        // Over the rim: a disc about the image of the least cap that is found around the directions.
        let axis = normalize(a / max(sizes.x, 1e-30) + b / max(sizes.y, 1e-30) + c / max(sizes.z, 1e-30));
        let cosine = min(dot(axis, a) / sizes.x, min(dot(axis, b) / sizes.y, dot(axis, c) / sizes.z)) - 1e-6;
        let tilt = acos(clamp(axis.z, -1.0, 1.0));
        let width = acos(clamp(cosine, -1.0, 1.0)) + 1e-3;
        if !(cosine > 0.0) || tilt + width > 3.1 {
            return all;
        }
        let near = tan(0.5 * (tilt - width));
        let far = tan(0.5 * (tilt + width));
        let across = length(axis.xy);
        let way = select(vec2(1.0, 0.0), axis.xy / across, across > 0.0);
        let middle = way * (0.5 * (near + far));
        let radius = 0.5 * (far - near) * 1.001;
        return vec4(middle - radius, middle + radius);
    }
    let p = a.xy / (sizes.x + a.z);
    let q = b.xy / (sizes.y + b.z);
    let r = c.xy / (sizes.z + c.z);
    let wider = max(bulge(a, b, p - q), max(bulge(b, c, q - r), bulge(c, a, r - p)));
    return vec4(min(p, min(q, r)) - wider, max(p, max(q, r)) + wider);
}

fn drawn(index: u32, is_cut_out: bool) -> Corner {
    let item = listed(index / 6u, is_cut_out);
    let a = turned(item_corner(item, 0u));
    let b = turned(item_corner(item, 1u));
    let c = turned(item_corner(item, 2u));
    let box = box_of(a, b, c);
    // Two triangles: corners 0 1 2, 2 1 3.
    let which = array<u32, 6>(0u, 1u, 2u, 2u, 1u, 3u)[index % 6u];
    let at = vec2(select(box.x, box.z, (which & 1u) != 0u), select(box.y, box.w, (which & 2u) != 0u));
    let clip = clamp(at, vec2(-2.0), vec2(2.0)) * target_.scale;
    return Corner(vec4(clip.x, -clip.y, 0.5, 1.0), a, b, c, item);
}

@vertex
fn corner(@builtin(vertex_index) index: u32) -> Corner {
    return drawn(index, false);
}

@vertex
fn corner_cut_out(@builtin(vertex_index) index: u32) -> Corner {
    return drawn(index, true);
}

struct Met {
    // Near over distance; 0 for nothing.
    depth: f32,
    point: vec3<f32>,
}

// Where a texel's ray meets the triangle.
fn met(c: Corner) -> Met {
    let texel = floor(c.clip.xy) + 0.5 - target_.origin;
    let at = (texel / target_.size * 2.0 - 1.0) / target_.scale;
    let squared = dot(at, at);
    let ray = vec3(2.0 * at, 1.0 - squared) / (1.0 + squared);
    let inside = vec3(dot(cross(c.a, c.b), ray), dot(cross(c.b, c.c), ray), dot(cross(c.c, c.a), ray));
    let normal = cross(c.b - c.a, c.c - c.a);
    let distance = dot(normal, c.a) / dot(normal, ray);
    let is_met = (all(inside >= vec3(0.0)) || all(inside <= vec3(0.0))) && distance >= target_.near_m && distance < 1e30;
    return Met(select(0.0, target_.near_m / distance, is_met), ray * distance);
}

@fragment
fn opaque(c: Corner) -> @builtin(frag_depth) f32 {
    let depth = met(c).depth;
    if depth == 0.0 {
        discard;
    }
    return depth;
}

@fragment
fn cut_out(c: Corner) -> @builtin(frag_depth) f32 {
    let there = met(c);
    let triangle = triangle_of(c.item);
    // Turning is its own inverse.
    let point = vec3(there.point.x, select(there.point.z, -there.point.z, target_.side == 1u), there.point.y);
    if there.depth == 0.0 || !is_there(triangle, weights_at(triangle, point)) {
        discard;
    }
    return there.depth;
}
