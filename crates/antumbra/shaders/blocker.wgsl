// Blocker depth, from the coarse enter depths of the file's `ENTR` section: how far before a point its shadow is cast.

// No caster.
const ANTUMBRA_NO_ENTER: u32 = 0xffffu;
// Cells per side of the level that a window may touch.
const ANTUMBRA_MOST_CELLS: u32 = 4u;

// Least and greatest enter depth, in stored units, of all cells from `first` to `last` that hold something at or before a
// depth; ANTUMBRA_NO_ENTER twice where nothing does. Cells count those of the finest level.
fn antumbra_enter_window(light: AntumbraLight, face: u32, first: vec2<u32>, last: vec2<u32>, depth: u32) -> vec2<u32> {
    var log2_cells = light.enter_log2;
    // Four cells to one, level by level: a face's cells are (4^(k+1) - 1) / 3.
    let face_cells = ((4u << (2u * log2_cells)) - 1u) / 3u;
    var at = light.enters + face * face_cells;
    var low = first;
    var high = last;
    while any(high - low >= vec2(ANTUMBRA_MOST_CELLS)) {
        at += 1u << (2u * log2_cells);
        log2_cells -= 1u;
        low >>= vec2(1u);
        high >>= vec2(1u);
    }
    var found = vec2(ANTUMBRA_NO_ENTER, 0u);
    for (var y = low.y; y <= high.y; y++) {
        for (var x = low.x; x <= high.x; x++) {
            let cell = antumbra_table(at + (y << log2_cells) + x);
            let bounds = vec2(cell & 0xffffu, cell >> 16u);
            if bounds.x != ANTUMBRA_NO_ENTER && bounds.x <= depth {
                found = vec2(min(found.x, bounds.x), max(found.y, bounds.y));
            }
        }
    }
    return select(found, vec2(ANTUMBRA_NO_ENTER), found.x == ANTUMBRA_NO_ENTER);
}

// Bounds on the distance of what shadows a point, metres along the light's face: least and greatest over a square window of
// `radius_m` to every side. Negative where nothing lies before the point, and without enter depths.
fn antumbra_blocker(light: AntumbraLight, point: vec3<f32>, radius_m: f32) -> vec2<f32> {
    let at = antumbra_project(light, point);
    if light.enters == 0u || antumbra_is_outside(light.log2_resolution, at.voxel) {
        return vec2(-1.0);
    }
    let shift = light.log2_resolution - light.enter_log2;
    let radius = max(radius_m, 0.0) / antumbra_frame(light, point).texel_m;
    let side = f32(1u << light.log2_resolution) - 1.0;
    let middle = vec2<f32>(at.voxel.xy) + at.fraction.xy;
    let first = vec2<u32>(clamp(middle - radius, vec2(0.0), vec2(side))) >> vec2(shift);
    let last = vec2<u32>(clamp(middle + radius, vec2(0.0), vec2(side))) >> vec2(shift);
    let found = antumbra_enter_window(light, at.face, first, last, u32(at.voxel.z) >> light.enter_shift);
    if found.x == ANTUMBRA_NO_ENTER {
        return vec2(-1.0);
    }
    let unit = f32(1u << light.enter_shift);
    let z = f32(at.voxel.z) + at.fraction.z;
    // A ray that is first shadowed in slice s meets its caster in slice s - 1.
    let nearest_to_light = max(f32(found.x) * unit - 1.0, 0.0);
    let nearest_to_point = min(f32(found.y) * unit, z);
    let here = antumbra_depth_of_slice(light, z);
    return vec2(
        max(here - antumbra_depth_of_slice(light, nearest_to_point), 0.0),
        here - antumbra_depth_of_slice(light, nearest_to_light),
    );
}
