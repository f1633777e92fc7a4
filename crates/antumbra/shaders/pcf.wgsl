// Percentage-closer filtering on flat masks (Sintorn et al. 2014, section 5): all taps share a depth, so a K x K window
// touches few 8 x 8 masks: at most 4 for K <= 9, at most 9 for K <= 17. Descents to them share their joint part, and a mask
// is weighed as a whole: by a population count (box) or row by row (tent).

const ANTUMBRA_BOX: u32 = 0u;
const ANTUMBRA_TENT: u32 = 1u;
// Of radius 0: by the casters' own edges and planes, between the middles of texels too, where the file has silhouettes.
const ANTUMBRA_CONTINUOUS: u32 = 3u;

struct AntumbraFilter {
    // Taps on either side of the middle one: 0 to 8.
    radius: u32,
    kernel: u32,
}

// Weights of a window's taps: of the lit ones inside the grid, of all inside it, of all.
struct AntumbraWeights {
    lit: u32,
    inside: u32,
    all: u32,
}

struct AntumbraWindow {
    filter_: AntumbraFilter,
    // The middle tap.
    center: vec2<i32>,
    // First and last texel inside the grid, inclusive.
    first: vec2<i32>,
    last: vec2<i32>,
    z: u32,
}

// Weight along one axis of the tap at a distance from the middle.
fn antumbra_axis_weight(filter_: AntumbraFilter, distance: u32) -> u32 {
    if filter_.kernel != ANTUMBRA_TENT {
        return select(0u, 1u, distance <= filter_.radius);
    }
    return max(filter_.radius + 1u, distance) - distance;
}

fn antumbra_all_weight(filter_: AntumbraFilter) -> u32 {
    let side = select(filter_.radius + 1u, 2u * filter_.radius + 1u, filter_.kernel != ANTUMBRA_TENT);
    // A tent's weights add up to the square of its middle one.
    let axis = select(side * side, side, filter_.kernel != ANTUMBRA_TENT);
    return axis * axis;
}

// Weight of all taps from one texel to another along an axis.
fn antumbra_run_weight(filter_: AntumbraFilter, center: i32, first: i32, last: i32) -> u32 {
    if filter_.kernel != ANTUMBRA_TENT {
        return u32(last + 1 - first);
    }
    var sum = 0u;
    for (var c = first; c <= last; c++) {
        sum += antumbra_axis_weight(filter_, u32(abs(center - c)));
    }
    return sum;
}

fn antumbra_rectangle_weight(w: AntumbraWindow, first: vec2<i32>, last: vec2<i32>) -> u32 {
    return antumbra_run_weight(w.filter_, w.center.x, first.x, last.x)
        * antumbra_run_weight(w.filter_, w.center.y, first.y, last.y);
}

// Byte i is 0xff where bit i of the low four is set, else 0.
fn antumbra_spread(bits: u32) -> u32 {
    // Bit i goes to i, i + 7, i + 14, i + 21: no two meet.
    return (((bits & 15u) * 0x00204081u) & 0x01010101u) * 0xffu;
}

// Weighs four rows of a mask row by row: a row's bits, spread to bytes, choose among its columns' weights.
fn antumbra_tent_rows(w: AntumbraWindow, word: u32, corner: vec2<i32>) -> u32 {
    var columns = vec2(0u);
    for (var i = 0u; i < 4u; i++) {
        let left = antumbra_axis_weight(w.filter_, u32(abs(w.center.x - corner.x - i32(i))));
        let right = antumbra_axis_weight(w.filter_, u32(abs(w.center.x - corner.x - i32(i) - 4)));
        columns |= vec2(left, right) << vec2(8u * i);
    }
    var sum = 0u;
    for (var row = 0u; row < 4u; row++) {
        let bits = (word >> (8u * row)) & 0xffu;
        let chosen = (columns.x & antumbra_spread(bits)) + (columns.y & antumbra_spread(bits >> 4u));
        // Eight weights of at most 9 each add up to less than 256.
        let row_sum = (chosen * 0x01010101u) >> 24u;
        sum += row_sum * antumbra_axis_weight(w.filter_, u32(abs(w.center.y - corner.y - i32(row))));
    }
    return sum;
}

// First and last texel of a window in the tile at a corner.
fn antumbra_within(w: AntumbraWindow, corner: vec2<i32>) -> vec4<i32> {
    return vec4(max(w.first, corner), min(w.last, corner + 7));
}

// The texels of a window in the tile at a corner, as a mask.
fn antumbra_window_mask(w: AntumbraWindow, corner: vec2<i32>) -> vec2<u32> {
    let part = antumbra_within(w, corner);
    let length = vec2<u32>(part.zw + 1 - part.xy);
    let run = ((vec2(1u) << length) - 1u) << vec2<u32>(part.xy - corner);
    return vec2(antumbra_spread(run.y), antumbra_spread(run.y >> 4u)) & vec2(run.x * 0x01010101u);
}

// Weight of the window's lit taps in the tile at a corner, whose mask is given.
fn antumbra_mask_weight(w: AntumbraWindow, mask: vec2<u32>, corner: vec2<i32>) -> u32 {
    if all(mask == vec2(0u)) {
        return 0u;
    }
    if all(mask == vec2(0xffffffffu)) {
        let part = antumbra_within(w, corner);
        return antumbra_rectangle_weight(w, part.xy, part.zw);
    }
    let chosen = mask & antumbra_window_mask(w, corner);
    if w.filter_.kernel != ANTUMBRA_TENT {
        return countOneBits(chosen.x) + countOneBits(chosen.y);
    }
    return antumbra_tent_rows(w, chosen.x, corner) + antumbra_tent_rows(w, chosen.y, corner + vec2(0, 4));
}

// The weights of a window about a voxel, which may lie anywhere. Before the first slice no tap is inside.
fn antumbra_weights(face: AntumbraFace, voxel: vec3<i32>, filter_: AntumbraFilter) -> AntumbraWeights {
    let side = 1i << face.log2_side;
    let radius = i32(filter_.radius);
    let all_weight = antumbra_all_weight(filter_);
    // Far outside, so that no sum overflows.
    let center = clamp(voxel.xy, vec2(-32), vec2(side + 32));
    let first = max(center - radius, vec2(0));
    let last = min(center + radius, vec2(side - 1));
    if any(first > last) || voxel.z < 0 {
        return AntumbraWeights(0u, 0u, all_weight);
    }
    let w = AntumbraWindow(filter_, center, first, last, min(u32(voxel.z), u32(side) - 1u));
    return AntumbraWeights(antumbra_window_weight(face, w), antumbra_rectangle_weight(w, first, last), all_weight);
}

// Filtered visibility about a voxel; taps outside the grid are lit.
fn antumbra_voxel_filtered(face: AntumbraFace, voxel: vec3<i32>, filter_: AntumbraFilter) -> f32 {
    if filter_.radius == 0u {
        return antumbra_voxel_visibility(face, voxel);
    }
    let w = antumbra_weights(face, voxel, filter_);
    return f32(w.lit + w.all - w.inside) / f32(w.all);
}
