// What one side of a lamp's map is drawn from.
struct MapSide {
    // The lamp, relative to the eye.
    light: vec3<f32>,
    near_m: f32,
    // Upper left texel, and texels per side.
    origin: vec2<f32>,
    size: f32,
    // Share of the side within its border.
    scale: f32,
    side: u32,
    // Where its list begins and ends.
    begin: u32,
    end: u32,
    pad: u32,
}

@group(1) @binding(0) var<storage, read> grid: CullGrid;
@group(1) @binding(1) var<storage, read> triangles: array<vec2<u32>>;
@group(1) @binding(2) var<storage, read> refs: array<u32>;
@group(1) @binding(3) var<storage, read> pieces: array<f32>;
@group(1) @binding(4) var<storage, read> lists: array<u32>;

@group(2) @binding(0) var<storage, read> target_: MapSide;

// Covers a side, infinitely far away.
@vertex
fn everything(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return vec4(f32(index & 1u) * 4.0 - 1.0, f32(index >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

fn corner_of(triangle: u32, i: u32) -> vec3<f32> {
    let part = part_of(triangles[triangle].x & PART);
    return position_of(part, vertices_of(part, triangles[triangle].y)[i]) - target_.light;
}

fn piece_corner(slot: u32, i: u32) -> vec3<f32> {
    let at = 9u * slot + 3u * i;
    let in_grid = vec3(pieces[at], pieces[at + 1u], pieces[at + 2u]);
    return (in_grid - grid.eye) / grid.cells_per_m - target_.light;
}

fn is_piece(item: u32) -> bool {
    return grid.binning == CUT && item < grid.most_refs;
}

fn triangle_of(item: u32) -> u32 {
    if is_piece(item) {
        return refs[item];
    }
    return item - select(0u, grid.most_refs, grid.binning == CUT);
}

fn item_corner(item: u32, i: u32) -> vec3<f32> {
    if is_piece(item) {
        return piece_corner(item, i);
    }
    return corner_of(triangle_of(item), i);
}

// The item of a draw, from one end of the list or the other.
fn listed(index: u32, is_cut_out: bool) -> u32 {
    return lists[select(target_.begin + index, target_.end - 1u - index, is_cut_out)];
}

// Weights of a triangle's corners at a point of it.
fn weights_at(triangle: u32, point: vec3<f32>) -> vec3<f32> {
    let a = corner_of(triangle, 0u);
    let b = corner_of(triangle, 1u);
    let c = corner_of(triangle, 2u);
    let normal = cross(b - a, c - a);
    let scale = 1.0 / dot(normal, normal);
    let u = dot(cross(c - b, point - b), normal) * scale;
    let v = dot(cross(a - c, point - c), normal) * scale;
    return vec3(u, v, 1.0 - u - v);
}

// Whether a masked surface is there.
fn is_there(triangle: u32, weights: vec3<f32>) -> bool {
    let part = part_of(triangles[triangle].x & PART);
    let color = color_at(part, vertices_of(part, triangles[triangle].y), weights, 0.0);
    return color.w >= material_value(part.material, 10u);
}
