// Prefiltered lookups, two ways (Sintorn et al. 2014): a pixel that covers many texels asks for their mean.

// The power of two at or below a width of 1 or more, and how far the width lies from it to the next. Narrower widths count
// as 1.
fn antumbra_octave(width: f32) -> vec2<f32> {
    let bits = bitcast<u32>(clamp(width, 1.0, 1073741824.0));
    return vec2(f32((bits >> 23u) - 127u), bitcast<f32>((bits & 0x007fffffu) | 0x3f800000u) - 1.0);
}

// Mean visibility over a footprint as wide as the pixel that asks, in metres. The point moves off its surface as far as what
// it averages over is wide.
fn antumbra_mean(light: AntumbraLight, point: vec3<f32>, normal: vec3<f32>, footprint_m: f32) -> f32 {
    let frame = antumbra_frame(light, point);
    let level = min(u32(antumbra_octave(footprint_m * 1.41421356 / frame.texel_m).x), light.log2_resolution);
    let side = f32(1u << level);
    let lateral = abs(dot(frame.right, normal)) + abs(dot(frame.down, normal));
    var bias_m = side * (lateral * frame.texel_m + abs(dot(frame.along, normal)) * frame.slice_m);
    if level == 0u {
        bias_m = antumbra_bias_m(light, point, normal, AntumbraFilter(0u, ANTUMBRA_BOX));
    }
    if antumbra_project(light, point).is_outside_cone {
        return 0.0;
    }
    let at = antumbra_project(light, point + normal * bias_m);
    if at.is_outside_cone {
        return 0.0;
    }
    if antumbra_is_outside(light.log2_resolution, at.voxel) {
        return 1.0;
    }
    let z = min(u32(at.voxel.z), (1u << light.log2_resolution) - 1u);
    return antumbra_voxel_mean(antumbra_face(light, 0u, at.face), vec3(vec2<u32>(at.voxel.xy), z), level);
}

// Where a tap beyond a cube face's edge belongs. `at` is real-valued, in the light's own texels and slices.
fn antumbra_around_corner(light: AntumbraLight, face: u32, at: vec3<f32>) -> AntumbraPoint {
    let middle = f32(1u << (light.log2_resolution - 1u));
    let ray = antumbra_from_face(vec3((at.xy - middle) / light.texels_per_tangent, 1.0), face);
    let there = antumbra_cube_face(ray);
    let p = antumbra_on_face(ray, there);
    // Depth along the other face's axis.
    let slice = antumbra_slice(light, antumbra_depth_of_slice(light, at.z) * p.z);
    let xy = p.xy * (light.texels_per_tangent / p.z) + middle;
    return antumbra_voxel(there, vec3(0), vec3(xy, slice), false);
}

// Filtered about a point on a coarse level (0: the light itself). Taps beyond a face's grid see the neighbouring face of a
// cube; they are left out beside a spot light's cone, and lit beside a directional light's grid.
fn antumbra_level_filtered(light: AntumbraLight, at: AntumbraPoint, filter_: AntumbraFilter, level: u32) -> f32 {
    let face = antumbra_face(light, level, at.face);
    let voxel = at.voxel >> vec3(level);
    let w = antumbra_weights(face, voxel, filter_);
    if w.inside == w.all || light.kind == ANTUMBRA_DIRECTIONAL || at.voxel.z < 0 {
        return f32(w.lit + w.all - w.inside) / f32(w.all);
    }
    var lit = w.lit;
    var inside = w.inside;
    let radius = i32(filter_.radius);
    let scale = exp2(f32(level));
    let z = f32(at.voxel.z) + at.fraction.z;
    for (var y = -radius; y <= radius && light.faces == 6u; y++) {
        for (var x = -radius; x <= radius; x++) {
            let tap = voxel.xy + vec2(x, y);
            if !antumbra_is_outside(face.log2_side, vec3(tap, 0)) {
                continue;
            }
            let weight = antumbra_axis_weight(filter_, u32(abs(x))) * antumbra_axis_weight(filter_, u32(abs(y)));
            let there = antumbra_around_corner(light, at.face, vec3((vec2<f32>(tap) + 0.5) * scale, z));
            let other = antumbra_face(light, level, there.face);
            lit += u32(antumbra_voxel_visibility(other, there.voxel >> vec3(level))) * weight;
            inside += weight;
        }
    }
    return select(f32(lit) / f32(inside), 1.0, inside == 0u);
}

// Filtered on the coarse levels about a footprint's scale, blended between two.
fn antumbra_levels(
    light: AntumbraLight,
    point: vec3<f32>,
    normal: vec3<f32>,
    footprint_m: f32,
    filter_: AntumbraFilter,
) -> f32 {
    let frame = antumbra_frame(light, point);
    let width = select(f32(filter_.radius) + 1.0, 2.0 * f32(filter_.radius) + 1.0, filter_.kernel != ANTUMBRA_TENT);
    let octave = antumbra_octave(footprint_m / (frame.texel_m * width));
    var level = u32(octave.x);
    var share = octave.y;
    if level >= light.levels {
        level = light.levels;
        share = 0.0;
    }
    if antumbra_project(light, point).is_outside_cone {
        return 0.0;
    }
    // The filter's bias at the wider level's scale, and half a coarse slice for the voxels' rounding.
    let widest = level + select(0u, 1u, share > 0.0);
    let scale = exp2(f32(widest));
    let rounding = select(0.5 * scale * frame.slice_m, 0.0, widest == 0u);
    let bias_m = antumbra_bias_m(light, point, normal, filter_) * scale + rounding;
    let at = antumbra_project(light, point + normal * bias_m);
    let fine = antumbra_level_filtered(light, at, filter_, level);
    if share == 0.0 {
        return fine;
    }
    return fine * (1.0 - share) + antumbra_level_filtered(light, at, filter_, level + 1u) * share;
}
