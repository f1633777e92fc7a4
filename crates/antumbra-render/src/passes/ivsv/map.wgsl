// Reads maps: twin of `splat::Map::between`.

const ONE_SURFACE: f32 = 0.15;

// Distance of what a texel shows; 0 for nothing.
fn map_texel(first: u32, side: u32, texel: vec2<i32>) -> f32 {
    let bits = maps[first + u32(texel.y) * side + u32(texel.x)];
    return select(bitcast<f32>(bits), 0.0, bits == EMPTY);
}

// Distance at a hole: of the surface that both texels to its sides show, or those above and below.
fn across_hole(first: u32, side: u32, own: vec2<i32>) -> f32 {
    for (var i = 0; i < 2; i++) {
        let step = vec2(1 - i, i);
        if all(own - step >= vec2(0)) && all(own + step < vec2(i32(side))) {
            let before = map_texel(first, side, own - step);
            let after = map_texel(first, side, own + step);
            if after > 0.0 && abs(before / after - 1.0) < ONE_SURFACE {
                return 0.5 * (before + after);
            }
        }
    }
    return 0.0;
}

// Distance at a place: between the middles of four texels of one surface, or else that of the nearest, which may be a hole in a
// surface; 0 for nothing.
fn map_between(first: u32, side: u32, at: vec2<f32>) -> f32 {
    let last = vec2(i32(side) - 1);
    let own = vec2<i32>(floor(at));
    if any(own < vec2(0)) || any(own > last) {
        return 0.0;
    }
    let nearest = map_texel(first, side, own);
    if nearest == 0.0 {
        return across_hole(first, side, own);
    }
    let corner = floor(at - 0.5);
    let share = at - 0.5 - corner;
    var sum = 0.0;
    for (var i = 0; i < 4; i++) {
        let step = vec2(i & 1, i >> 1u);
        let r = map_texel(first, side, clamp(vec2<i32>(corner) + step, vec2(0), last));
        if !(abs(r / nearest - 1.0) < ONE_SURFACE) {
            return nearest;
        }
        let weight = select(1.0 - share, share, step == vec2(1));
        sum += r * weight.x * weight.y;
    }
    return sum;
}
