// Reads maps: twin of `splat::Map::between`.

const ONE_SURFACE: f32 = 0.15;
const HOLE: i32 = 2;

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

// Distance of the one surface that lies before a texel's on both sides of it, a few texels away at most; 0 for none.
fn before_between(first: u32, side: u32, own: vec2<i32>, r: f32, step: vec2<i32>) -> f32 {
    var found = vec2(0.0);
    for (var i = 0; i < 2; i++) {
        let way = select(step, -step, i == 0);
        for (var reach = 1; reach <= HOLE && found[i] == 0.0; reach++) {
            let texel = own + way * reach;
            if all(texel >= vec2(0)) && all(texel < vec2(i32(side))) {
                let there = map_texel(first, side, texel);
                if r == 0.0 || there < r * (1.0 - ONE_SURFACE) {
                    found[i] = there;
                }
            }
        }
    }
    let is_one = found.x > 0.0 && found.y > 0.0 && abs(found.x / found.y - 1.0) < ONE_SURFACE;
    return select(0.0, 0.5 * (found.x + found.y), is_one);
}

// The same on all four sides: seen through a hole between the surface's discs.
fn before_hole(first: u32, side: u32, own: vec2<i32>, r: f32) -> f32 {
    let across = before_between(first, side, own, r, vec2(1, 0));
    let along = before_between(first, side, own, r, vec2(0, 1));
    let is_one = across > 0.0 && along > 0.0 && abs(across / along - 1.0) < ONE_SURFACE;
    return select(0.0, 0.5 * (across + along), is_one);
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
    let before = before_hole(first, side, own, nearest);
    if before > 0.0 {
        return before;
    }
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
