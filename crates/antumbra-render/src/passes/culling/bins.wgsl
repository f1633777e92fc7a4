// Triangles by the cells that they touch: twin of `Bins`. Runs twice: to count each cell's, and, once it is known where each cell's
// begin, to put them there. Their order in a cell depends on timing; what is drawn from them does not.

@group(1) @binding(0) var<storage, read> grid: CullGrid;
@group(1) @binding(1) var<storage, read> triangles: array<vec2<u32>>;
@group(1) @binding(2) var<storage, read_write> counts: array<atomic<u32>>;
@group(1) @binding(3) var<storage, read> begins: array<u32>;
@group(1) @binding(4) var<storage, read_write> refs: array<u32>;
// A bit for each item: those that nothing culls.
@group(1) @binding(5) var<storage, read_write> always: array<atomic<u32>>;
// Corners of pieces, in cells, nine numbers each.
@group(1) @binding(6) var<storage, read_write> pieces: array<f32>;

// Slivers of more cells than this are culled by nothing: their plane says too little about where they are.
const MOST_SLIVER_CELLS: i32 = 4096;

struct Polygon {
    corners: array<vec3<f32>, 10>,
    count: u32,
}

fn keep_always(triangle: u32) {
    let item = whole_item(grid, triangle);
    atomicOr(&always[item / 32u], 1u << (item & 31u));
}

fn is_apart(axis: vec3<f32>, a: vec3<f32>, b: vec3<f32>, c: vec3<f32>, half: f32) -> bool {
    let p = dot(axis, a);
    let q = dot(axis, b);
    let r = dot(axis, c);
    let reach = half * (abs(axis.x) + abs(axis.y) + abs(axis.z));
    return min(p, min(q, r)) > reach || max(p, max(q, r)) < -reach;
}

// Whether a triangle and a cell touch: Akenine-Möller 2001, "Fast 3D triangle-box overlap testing".
fn touches(t: array<vec3<f32>, 3>, cell: vec3<f32>) -> bool {
    let half = 0.5 + grid.hair;
    let a = t[0] - (cell + 0.5);
    let b = t[1] - (cell + 0.5);
    let c = t[2] - (cell + 0.5);
    if any(min(a, min(b, c)) > vec3(half)) || any(max(a, max(b, c)) < vec3(-half)) {
        return false;
    }
    let ab = b - a;
    let bc = c - b;
    let ca = a - c;
    if is_apart(cross(ab, bc), a, b, c, half) {
        return false;
    }
    for (var i = 0u; i < 3u; i++) {
        var axis = vec3(0.0);
        axis[i] = 1.0;
        if is_apart(cross(axis, ab), a, b, c, half) || is_apart(cross(axis, bc), a, b, c, half)
            || is_apart(cross(axis, ca), a, b, c, half) {
            return false;
        }
    }
    return true;
}

// The part of a polygon beyond a plane across an axis, seen along a sign of the axis (Sutherland and Hodgman 1974). Edges are cut
// from their lesser end, so that both cells at a plane cut them alike.
fn clipped(polygon: Polygon, axis: u32, plane: f32, sign: f32) -> Polygon {
    var cut: Polygon;
    for (var i = 0u; i < polygon.count; i++) {
        let here = polygon.corners[i];
        let there = polygon.corners[(i + 1u) % polygon.count];
        let f = (here[axis] - plane) * sign;
        let g = (there[axis] - plane) * sign;
        if f >= 0.0 {
            cut.corners[cut.count] = here;
            cut.count += 1u;
        }
        if f * g < 0.0 {
            let is_up = here[axis] < there[axis];
            let low = select(there, here, is_up);
            let high = select(here, there, is_up);
            var at = low + (high - low) * ((plane - low[axis]) / (high[axis] - low[axis]));
            at[axis] = plane;
            cut.corners[cut.count] = at;
            cut.count += 1u;
        }
    }
    return cut;
}

fn piece_in(t: array<vec3<f32>, 3>, cell: vec3<f32>) -> Polygon {
    var polygon: Polygon;
    polygon.corners[0] = t[0];
    polygon.corners[1] = t[1];
    polygon.corners[2] = t[2];
    polygon.count = 3u;
    for (var axis = 0u; axis < 3u; axis++) {
        polygon = clipped(polygon, axis, cell[axis], 1.0);
        polygon = clipped(polygon, axis, cell[axis] + 1.0, -1.0);
    }
    return polygon;
}

fn put(triangle: u32, t: array<vec3<f32>, 3>, number: u32, cell: vec3<i32>) {
    if grid.binning != CUT {
        let place = atomicAdd(&counts[number], 1u);
        if FILL {
            let slot = begins[number] + place;
            if slot < grid.most_refs {
                refs[slot] = triangle;
            } else {
                keep_always(triangle);
            }
        }
        return;
    }
    let polygon = piece_in(t, vec3<f32>(cell));
    if polygon.count < 3u {
        return;
    }
    let place = atomicAdd(&counts[number], polygon.count - 2u);
    if !FILL {
        return;
    }
    for (var i = 0u; i < polygon.count - 2u; i++) {
        let slot = begins[number] + place + i;
        if slot >= grid.most_refs {
            keep_always(triangle);
            return;
        }
        refs[slot] = triangle;
        for (var axis = 0u; axis < 3u; axis++) {
            pieces[9u * slot + axis] = polygon.corners[0][axis];
            pieces[9u * slot + 3u + axis] = polygon.corners[i + 1u][axis];
            pieces[9u * slot + 6u + axis] = polygon.corners[i + 2u][axis];
        }
    }
}

// Visits the cells of a level that a triangle touches, and says how many; more than `most` are not counted on. Columns of cells along
// the axis that its plane faces most, in each of which the plane runs through three cells at most. Corners are in cells of the level.
fn visit(triangle: u32, t: array<vec3<f32>, 3>, level: u32, most: u32, is_put: bool) -> u32 {
    let side = side_of(grid, level);
    let first_number = first_of(grid, level);
    let last = f32(side - 1u);
    let low = vec3<i32>(clamp(floor(min(t[0], min(t[1], t[2])) - grid.hair), vec3(0.0), vec3(last)));
    let high = vec3<i32>(clamp(floor(max(t[0], max(t[1], t[2])) + grid.hair), vec3(0.0), vec3(last)));
    let normal = cross(t[1] - t[0], t[2] - t[0]);
    let facing = abs(normal);
    let w = select(select(2u, 1u, facing.y >= facing.z), 0u, facing.x >= max(facing.y, facing.z));
    let u = (w + 1u) % 3u;
    let v = (w + 2u) % 3u;
    let longest = max(dot(t[1] - t[0], t[1] - t[0]), dot(t[2] - t[0], t[2] - t[0]));
    let is_sliver = facing[w] < 1e-2 * longest;
    let span = high - low + 1;
    if is_sliver && span.x * span.y * span.z > MOST_SLIVER_CELLS {
        return ~0u;
    }
    let slope_u = normal[u] / normal[w];
    let slope_v = normal[v] / normal[w];
    let reach = (0.5 + grid.hair) * (abs(slope_u) + abs(slope_v)) + 2.0 * grid.hair;
    var count = 0u;
    for (var i = low[u]; i <= high[u]; i++) {
        for (var j = low[v]; j <= high[v]; j++) {
            var first = low[w];
            var final_ = high[w];
            if !is_sliver {
                let middle = t[0][w] - slope_u * (f32(i) + 0.5 - t[0][u]) - slope_v * (f32(j) + 0.5 - t[0][v]);
                first = max(first, i32(floor(clamp(middle - reach, -1.0, last + 1.0))));
                final_ = min(final_, i32(floor(clamp(middle + reach, -1.0, last + 1.0))));
            }
            for (var k = first; k <= final_; k++) {
                var cell = vec3(0);
                cell[u] = i;
                cell[v] = j;
                cell[w] = k;
                if touches(t, vec3<f32>(cell)) {
                    count += 1u;
                    if is_put {
                        put(triangle, t, first_number + number_of(side, cell), cell);
                    }
                }
            }
            if count > most {
                return count;
            }
        }
    }
    return count;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let triangle = id.y * groups.x * 64u + id.x;
    if triangle >= grid.triangles {
        return;
    }
    let info = triangles[triangle];
    if (info.x & CASTS_NOTHING) != 0u {
        return;
    }
    let part = part_of(info.x & PART);
    let vertices = vertices_of(part, info.y);
    var t: array<vec3<f32>, 3>;
    for (var i = 0u; i < 3u; i++) {
        t[i] = in_cells(grid, position_of(part, vertices[i]));
    }
    let side = vec3(f32(grid.side));
    if !(all(min(t[0], min(t[1], t[2])) >= vec3(0.0)) && all(max(t[0], max(t[1], t[2])) <= side)) {
        keep_always(triangle);
        return;
    }
    var level = 0u;
    if grid.binning == LISTED || grid.binning == LEVELS {
        while visit(triangle, t, level, grid.most_cells, false) > grid.most_cells {
            level += 1u;
            if level >= grid.levels {
                keep_always(triangle);
                return;
            }
            for (var i = 0u; i < 3u; i++) {
                t[i] *= 0.5;
            }
        }
    }
    if visit(triangle, t, level, ~0u - 1u, true) == ~0u {
        keep_always(triangle);
    }
}
