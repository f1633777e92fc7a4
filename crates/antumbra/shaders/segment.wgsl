// Segments: which parts of a straight line a light reaches, exactly, without marching: a box of voxels that are all lit or
// all shadowed costs one step, however long the way through it. After Amanatides, Woo 1987; whole numbers keep the walk in
// order, so that no rounding makes it loop: at most 3N steps on each face.
//
// A line is affine in its parameter t in the light's axes, and every boundary of the grid is a plane there, so each is
// crossed where a linear function of t is zero, whatever the projection.

// A line on one face, in the face's axes: voxels from `whole` (directional) or metres (local).
struct AntumbraLine {
    start: vec3<f32>,
    step: vec3<f32>,
    whole: vec3<i32>,
    face: u32,
}

// A box of voxels that are all lit or all shadowed: its least voxel, and the one past its greatest on every axis.
struct AntumbraCell {
    first: vec3<u32>,
    end: vec3<u32>,
    is_lit: bool,
}

// What is left of a walk along a line.
struct AntumbraWalk {
    line: AntumbraLine,
    // By level: the node that holds the voxel, from the root's level down to `level`. A descent to the next voxel begins at
    // the least node which holds both: neighbours share most of their way.
    nodes: array<u32, 21>,
    level: u32,
    // log2 of the voxels per side.
    log2_side: u32,
    // Where the beginnings of the slices are: see AntumbraFace.
    slices: u32,
    // The top grid: see AntumbraFace.
    grid: u32,
    grid_log2: u32,
    // The voxel that `nodes` lead to.
    described: vec3<u32>,
    // Parameters: here, and where the walk ends.
    at: f32,
    end: f32,
    // Where the walk stands, and where it ends.
    voxel: vec3<u32>,
    last: vec3<u32>,
    is_done: bool,
}

// A part of a line, up to a parameter, that is all lit or all shadowed.
struct AntumbraSpan {
    to: f32,
    is_lit: bool,
}

// The linear function of t that is zero where a line crosses boundary c of an axis (0 and 1: texels, 2: slices): its value
// at 0, and its slope. It rises with the voxel coordinate.
fn antumbra_boundary(light: AntumbraLight, line: AntumbraLine, axis: u32, c: i32) -> vec2<f32> {
    if light.kind == ANTUMBRA_DIRECTIONAL {
        return vec2(line.start[axis] - f32(c - line.whole[axis]), line.step[axis]);
    }
    if axis < 2u {
        let middle = 1i << (light.log2_resolution - 1u);
        let tangent = f32(c - middle) / light.texels_per_tangent;
        return vec2(line.start[axis] - tangent * line.start.z, line.step[axis] - tangent * line.step.z);
    }
    var depth = light.near_m;
    if c > 0 {
        depth = antumbra_depth_of_slice(light, f32(c));
    }
    return vec2(line.start.z - depth, line.step.z);
}

fn antumbra_crossing(light: AntumbraLight, line: AntumbraLine, axis: u32, c: u32) -> f32 {
    let f = antumbra_boundary(light, line, axis, i32(c));
    return -f.x / f.y;
}

// The voxel at parameter t, within the volume; behind the last slice the last.
fn antumbra_voxel_at(light: AntumbraLight, line: AntumbraLine, t: f32) -> vec3<u32> {
    let p = line.start + line.step * t;
    let greatest = (1i << light.log2_resolution) - 1;
    var voxel = vec3(0i);
    if light.kind == ANTUMBRA_DIRECTIONAL {
        voxel = antumbra_voxel(0u, line.whole, p, false).voxel;
    } else {
        let middle = f32(1u << (light.log2_resolution - 1u));
        let depth = max(p.z, light.near_m);
        let xy = p.xy * (light.texels_per_tangent / depth) + middle;
        voxel = antumbra_voxel(0u, vec3(0), vec3(xy, antumbra_slice(light, depth)), false).voxel;
    }
    return vec3<u32>(clamp(voxel, vec3(0), vec3(greatest)));
}

// The part of a line between two parameters that lies in the volume: within the grid sideways and not before its first
// slice, but for all its length behind the last (Liang, Barsky 1984). Empty where the first is not less.
fn antumbra_clipped(light: AntumbraLight, line: AntumbraLine, leg: vec2<f32>) -> vec2<f32> {
    let side = 1i << light.log2_resolution;
    var part = leg;
    for (var i = 0u; i < 5u; i++) {
        // Slice 0 inward, then both sides of x and y.
        let axis = select((i - 1u) / 2u, 2u, i == 0u);
        let is_upper = i != 0u && (i & 1u) == 0u;
        let f = antumbra_boundary(light, line, axis, select(0i, side, is_upper)) * select(1.0, -1.0, is_upper);
        let t = -f.x / f.y;
        if f.y > 0.0 {
            part.x = max(part.x, t);
        } else if f.y < 0.0 {
            part.y = min(part.y, t);
        } else if f.x < 0.0 {
            return vec2(1.0, 0.0);
        }
    }
    return part;
}

// A walk on a face that has not begun.
fn antumbra_walk_on(face: AntumbraFace) -> AntumbraWalk {
    var walk: AntumbraWalk;
    walk.level = face.log2_side;
    walk.log2_side = face.log2_side;
    walk.slices = face.slices;
    walk.grid = face.grid;
    walk.grid_log2 = face.grid_log2;
    walk.nodes[face.log2_side] = face.root;
    return walk;
}

fn antumbra_walk(light: AntumbraLight, line: AntumbraLine, part: vec2<f32>) -> AntumbraWalk {
    var walk = antumbra_walk_on(antumbra_face(light, 0u, line.face));
    walk.line = line;
    walk.at = part.x;
    walk.end = part.y;
    walk.voxel = antumbra_voxel_at(light, line, part.x);
    walk.last = antumbra_voxel_at(light, line, part.y);
    return walk;
}

// The next box of a walk that is not done.
fn antumbra_step(light: AntumbraLight, walk: ptr<function, AntumbraWalk>) -> AntumbraSpan {
    let cell = antumbra_cell(walk, (*walk).voxel);
    let voxel = (*walk).voxel;
    let last = (*walk).last;
    var to = (*walk).end;
    var exit = 3u;
    for (var axis = 0u; axis < 3u; axis++) {
        let is_up = last[axis] >= cell.end[axis];
        if !is_up && last[axis] >= cell.first[axis] {
            // The walk ends before it leaves along this axis.
            continue;
        }
        let boundary = select(cell.first[axis], cell.end[axis], is_up);
        let crossing = max(antumbra_crossing(light, (*walk).line, axis, boundary), (*walk).at);
        if crossing < to {
            to = crossing;
            exit = axis;
        }
    }
    if exit == 3u {
        (*walk).is_done = true;
        return AntumbraSpan(to, cell.is_lit);
    }
    // Across the boundary the coordinate is the neighbour's. The others follow from the position, within the box just left,
    // and never turn back.
    var next = antumbra_voxel_at(light, (*walk).line, to);
    for (var axis = 0u; axis < 3u; axis++) {
        let is_up = last[axis] >= voxel[axis];
        if axis == exit {
            next[axis] = select(cell.first[axis] - 1u, cell.end[axis], last[axis] >= cell.end[axis]);
        } else if is_up {
            next[axis] = clamp(next[axis], voxel[axis], min(last[axis], cell.end[axis] - 1u));
        } else {
            next[axis] = clamp(next[axis], max(last[axis], cell.first[axis]), voxel[axis]);
        }
    }
    (*walk).voxel = next;
    (*walk).at = to;
    return AntumbraSpan(to, cell.is_lit);
}

// What a lit part of a line counts: its length, or what reaches the line's start through fog of some optical depth in all.
fn antumbra_lit_weight(optical_depth: f32, from_t: f32, to_t: f32) -> f32 {
    if optical_depth == 0.0 {
        return to_t - from_t;
    }
    return exp(-optical_depth * from_t) - exp(-optical_depth * to_t);
}

// Lit part of one leg of a line, which stays on one face.
fn antumbra_lit_leg(light: AntumbraLight, line: AntumbraLine, leg: vec2<f32>, optical_depth: f32) -> f32 {
    let part = antumbra_clipped(light, line, leg);
    if !(part.x < part.y) {
        return antumbra_lit_weight(optical_depth, leg.x, leg.y);
    }
    // Beside the volume and before it: lit.
    var lit = antumbra_lit_weight(optical_depth, leg.x, part.x) + antumbra_lit_weight(optical_depth, part.y, leg.y);
    var walk = antumbra_walk(light, line, part);
    while !walk.is_done {
        let from_t = walk.at;
        let span = antumbra_step(light, &walk);
        if span.is_lit {
            lit += antumbra_lit_weight(optical_depth, from_t, span.to);
        }
    }
    return lit;
}

// Where a line passes the cone's double, p.z^2 = cos^2 |p|^2.
fn antumbra_cone_crossings(light: AntumbraLight, line: AntumbraLine) -> vec2<f32> {
    let size = max(abs(line.start), abs(line.step));
    let scale = 1.0 / max(max(size.x, size.y), size.z);
    let p = line.start * scale;
    let d = line.step * scale;
    let cos2 = light.cone_cosine * light.cone_cosine;
    let a = d.z * d.z - cos2 * dot(d, d);
    let b = p.z * d.z - cos2 * dot(p, d);
    let c = p.z * p.z - cos2 * dot(p, p);
    let root = sqrt(max(b * b - a * c, 0.0));
    let sum = -(b + select(root, -root, b < 0.0));
    return vec2(sum / a, c / sum);
}

// How much of the segment from one point to another is lit: 0 to 1.
fn antumbra_lit_share(light: AntumbraLight, from_point: vec3<f32>, to_point: vec3<f32>) -> f32 {
    return antumbra_lit_through(light, from_point, to_point, 0.0);
}

// Light that fog along a segment, of some optical depth in all, scatters and lets through to the segment's start, relative
// to that of endless fog in full light: the sum over lit runs of the difference of transmittance. With an optical depth of 0
// it is the lit share.
fn antumbra_lit_through(
    light: AntumbraLight,
    from_point: vec3<f32>,
    to_point: vec3<f32>,
    optical_depth: f32,
) -> f32 {
    let start = antumbra_rotated(light, from_point) + light.fraction.xyz;
    let step = antumbra_rotated(light, to_point - from_point);
    var line = AntumbraLine(start, step, light.whole.xyz, 0u);
    if light.kind == ANTUMBRA_DIRECTIONAL {
        return clamp(antumbra_lit_leg(light, line, vec2(0.0, 1.0), optical_depth), 0.0, 1.0);
    }
    // Parameters at which the line may change faces or pass the cone. One too many does no harm: legs are judged by their
    // middles.
    var cuts = array<f32, 8>(2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0, 2.0);
    if light.faces == 6u {
        for (var i = 0u; i < 3u; i++) {
            let j = (i + 1u) % 3u;
            cuts[2u * i] = (start[j] - start[i]) / (step[i] - step[j]);
            cuts[2u * i + 1u] = -(start[j] + start[i]) / (step[i] + step[j]);
        }
    }
    if light.cone_cosine > -1.0 {
        let crossings = antumbra_cone_crossings(light, line);
        cuts[6] = crossings.x;
        cuts[7] = crossings.y;
    }
    var lit = 0.0;
    var at = 0.0;
    while at < 1.0 {
        var end = 1.0;
        for (var i = 0u; i < 8u; i++) {
            if cuts[i] > at && cuts[i] < end {
                end = cuts[i];
            }
        }
        let middle = start + step * (0.5 * (at + end));
        if !(light.cone_cosine > -1.0 && middle.z < light.cone_cosine * length(middle)) {
            let face = antumbra_face_of(light, middle);
            line = AntumbraLine(antumbra_on_face(start, face), antumbra_on_face(step, face), vec3(0), 0u);
            line.face = select(0u, face, light.faces == 6u);
            lit += antumbra_lit_leg(light, line, vec2(at, end), optical_depth);
        }
        at = end;
    }
    return clamp(lit, 0.0, 1.0);
}
