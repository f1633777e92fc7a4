// Projection: from a point, relative to the lights' reference point, to a face and voxel coordinates on it. The only part
// of a lookup that is not whole numbers.

// A point as a light sees it.
struct AntumbraPoint {
    face: u32,
    // z is negative before the first slice.
    voxel: vec3<i32>,
    // The voxel coordinates' fractions.
    fraction: vec3<f32>,
    // A spot light's cone does not hold it: visibility 0.
    is_outside_cone: bool,
}

// The light's grid about a point: unit axes of its face in the world, size of a voxel there in metres.
struct AntumbraFrame {
    right: vec3<f32>,
    down: vec3<f32>,
    along: vec3<f32>,
    texel_m: f32,
    slice_m: f32,
}

const ANTUMBRA_DIRECTIONAL: u32 = 0u;
// The only face of a narrow spot light.
const ANTUMBRA_SPOT_FACE: u32 = 4u;

fn antumbra_rotated(light: AntumbraLight, offset: vec3<f32>) -> vec3<f32> {
    return vec3(dot(light.row_x.xyz, offset), dot(light.row_y.xyz, offset), dot(light.row_z.xyz, offset));
}

// The face of a cube about the light that sees a point in its axes.
fn antumbra_cube_face(p: vec3<f32>) -> u32 {
    let size = abs(p);
    if size.x >= size.y && size.x >= size.z {
        return select(0u, 1u, p.x < 0.0);
    }
    if size.y >= size.z {
        return select(2u, 3u, p.y < 0.0);
    }
    return select(4u, 5u, p.z < 0.0);
}

// A point in the light's axes, in a face's: right, down, along.
fn antumbra_on_face(p: vec3<f32>, face: u32) -> vec3<f32> {
    var turned = p.yzx;
    if face / 2u == 1u {
        turned = p.zxy;
    } else if face / 2u == 2u {
        turned = p.xyz;
    }
    if (face & 1u) == 0u {
        return turned;
    }
    return vec3(turned.y, turned.x, -turned.z);
}

// The inverse.
fn antumbra_from_face(p: vec3<f32>, face: u32) -> vec3<f32> {
    var turned = p;
    if (face & 1u) == 1u {
        turned = vec3(p.y, p.x, -p.z);
    }
    if face / 2u == 0u {
        return turned.zxy;
    }
    if face / 2u == 1u {
        return turned.yzx;
    }
    return turned;
}

fn antumbra_face_of(light: AntumbraLight, p: vec3<f32>) -> u32 {
    if light.faces == 6u {
        return antumbra_cube_face(p);
    }
    return ANTUMBRA_SPOT_FACE;
}

// Real-valued slice of a depth along a local light's face.
fn antumbra_slice(light: AntumbraLight, depth_m: f32) -> f32 {
    let side = f32(1u << light.log2_resolution);
    if light.ndc_near_share != 0.0 {
        return max((1.0 - light.near_m / depth_m) / (1.0 - light.ndc_near_share) * side, 0.0);
    }
    return max((log2(depth_m) - light.log2_near) * light.slices_per_octave, 0.0);
}

// Depth of a real-valued slice, metres: the inverse; of a directional light from its first slice.
fn antumbra_depth_of_slice(light: AntumbraLight, slice: f32) -> f32 {
    if light.kind == ANTUMBRA_DIRECTIONAL {
        return slice * light.slice;
    }
    let side = f32(1u << light.log2_resolution);
    if light.ndc_near_share != 0.0 {
        return light.near_m / (1.0 - slice / side * (1.0 - light.ndc_near_share));
    }
    return exp2(light.log2_near + slice / light.slices_per_octave);
}

// Whole and fractional part, saturated far outside any grid.
fn antumbra_voxel(face: u32, whole: vec3<i32>, rest: vec3<f32>, is_outside_cone: bool) -> AntumbraPoint {
    let near = clamp(rest, vec3(-1e9), vec3(1e9));
    let floors = floor(near);
    return AntumbraPoint(face, whole + vec3<i32>(floors), near - floors, is_outside_cone);
}

// The face that sees a point, and its voxel there.
fn antumbra_project(light: AntumbraLight, point: vec3<f32>) -> AntumbraPoint {
    let p = antumbra_rotated(light, point) + light.fraction.xyz;
    if light.kind == ANTUMBRA_DIRECTIONAL {
        return antumbra_voxel(0u, light.whole.xyz, p, false);
    }
    let is_outside_cone = light.cone_cosine > -1.0 && p.z < light.cone_cosine * length(p);
    let face = antumbra_face_of(light, p);
    let q = antumbra_on_face(p, face);
    let own_face = select(0u, face, light.faces == 6u);
    let middle = f32(1u << (light.log2_resolution - 1u));
    // Nor is a point that is no number in reach.
    if !(q.z >= light.near_m) {
        return AntumbraPoint(own_face, vec3<i32>(vec3(middle, middle, -1.0)), vec3(0.0), is_outside_cone);
    }
    let xy = q.xy * (light.texels_per_tangent / q.z) + middle;
    return antumbra_voxel(own_face, vec3(0), vec3(xy, antumbra_slice(light, q.z)), is_outside_cone);
}

// The grid about a point.
fn antumbra_frame(light: AntumbraLight, point: vec3<f32>) -> AntumbraFrame {
    let x = light.row_x.xyz;
    let y = light.row_y.xyz;
    let z = light.row_z.xyz;
    if light.kind == ANTUMBRA_DIRECTIONAL {
        return AntumbraFrame(x * light.texel, y * light.texel, z * light.slice, light.texel, light.slice);
    }
    let p = antumbra_rotated(light, point) + light.fraction.xyz;
    let face = antumbra_face_of(light, p);
    let depth = max(antumbra_on_face(p, face).z, light.near_m);
    var slice_m = depth * light.slice;
    if light.ndc_near_share != 0.0 {
        slice_m = depth * depth * light.slice;
    }
    // The axes turn as a point's coordinates do, component by component.
    let turned_x = antumbra_on_face(vec3(x.x, y.x, z.x), face);
    let turned_y = antumbra_on_face(vec3(x.y, y.y, z.y), face);
    let turned_z = antumbra_on_face(vec3(x.z, y.z, z.z), face);
    let axes = transpose(mat3x3(turned_x, turned_y, turned_z));
    return AntumbraFrame(axes[0], axes[1], axes[2], depth * light.texel, slice_m);
}

// Beside half a filter's width: swallows the snapping of vertices to the bake's lattice.
const ANTUMBRA_SNAP_BIAS: f32 = 1.0 / 16.0;

// How far along a unit normal a lookup of K x K taps moves off its surface, metres: just far enough that a plane with that
// normal does not shadow itself under any tap.
fn antumbra_bias_m(light: AntumbraLight, point: vec3<f32>, normal: vec3<f32>, filter_: AntumbraFilter) -> f32 {
    let frame = antumbra_frame(light, point);
    let lateral = abs(dot(frame.right, normal)) + abs(dot(frame.down, normal));
    let half_width = f32(filter_.radius) + 0.5 + ANTUMBRA_SNAP_BIAS;
    return half_width * frame.texel_m * lateral + 0.5 * frame.slice_m;
}

// Visibility at a point: 0 shadowed, 1 lit.
fn antumbra_visibility(light: AntumbraLight, point: vec3<f32>) -> f32 {
    let at = antumbra_project(light, point);
    if at.is_outside_cone {
        return 0.0;
    }
    return antumbra_voxel_visibility(antumbra_face(light, 0u, at.face), at.voxel);
}

// Filtered visibility at a point of a surface with a unit normal; a zero normal for a point in the air.
fn antumbra_filtered(light: AntumbraLight, point: vec3<f32>, normal: vec3<f32>, filter_: AntumbraFilter) -> f32 {
    // The cone is the unmoved point's.
    if antumbra_project(light, point).is_outside_cone {
        return 0.0;
    }
    let at = antumbra_project(light, point + normal * antumbra_bias_m(light, point, normal, filter_));
    let face = antumbra_face(light, 0u, at.face);
    if filter_.kernel == ANTUMBRA_CONTINUOUS {
        return antumbra_voxel_continuous(face, at.voxel, at.fraction);
    }
    return antumbra_voxel_filtered(face, at.voxel, filter_);
}
