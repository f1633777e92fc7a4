// Point lookups (Sintorn et al. 2014, section 5).

// Whether a voxel lies beside a grid of 2^log2 texels per side, or before its first slice: lit.
fn antumbra_is_outside(log2_side: u32, voxel: vec3<i32>) -> bool {
    return any((voxel.xy >> vec2(log2_side)) != vec2(0)) || voxel.z < 0;
}

// Visibility of any voxel: behind the last slice as there.
fn antumbra_voxel_visibility(face: AntumbraFace, voxel: vec3<i32>) -> f32 {
    if antumbra_is_outside(face.log2_side, voxel) {
        return 1.0;
    }
    let z = min(u32(voxel.z), (1u << face.log2_side) - 1u);
    return select(0.0, 1.0, antumbra_voxel_is_lit(face, vec3(vec2<u32>(voxel.xy), z)));
}

// Visibility of a place in a voxel, whose fractions are given, by edges and planes between the middles of texels.
fn antumbra_voxel_continuous(face: AntumbraFace, voxel: vec3<i32>, fraction: vec3<f32>) -> f32 {
    if antumbra_is_outside(face.log2_side, voxel) {
        return 1.0;
    }
    let last = (1i << face.log2_side) - 1;
    // Behind the last slice is as its end.
    let share = select(fraction.z, 1.0, voxel.z > last);
    let inside = vec3<u32>(vec3(voxel.xy, min(voxel.z, last)));
    return select(0.0, 1.0, antumbra_place_is_lit(face, inside, vec3(fraction.xy - 0.5, share)));
}
