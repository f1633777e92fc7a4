// Draws points as discs into the maps: twin of `splat::Map::draw`.

struct Placed {
    position: vec3<f32>,
    pad_0: u32,
    normal: vec3<f32>,
    pad_1: u32,
}

struct Share {
    begin: u32,
    first: u32,
    count: u32,
    radius_m: f32,
    middle: vec3<f32>,
    area_m2: f32,
    along: vec3<f32>,
    half_along_m: f32,
    across: vec3<f32>,
    half_across_m: f32,
    half_third_m: f32,
    pad_0: u32,
    pad_1: u32,
    pad_2: u32,
}

@group(0) @binding(0) var<storage, read> batch: Batch;
@group(0) @binding(1) var<storage, read> vpls: array<Vpl>;
@group(0) @binding(2) var<storage, read> shares: array<Share>;
@group(0) @binding(3) var<storage, read> placed: array<Placed>;
@group(0) @binding(4) var<storage, read_write> maps: array<atomic<u32>>;

const MOST_TEXELS: f32 = 4.0;
const EDGE_ON: f32 = 0.02;

// The number of the point that a VPL draws as its `index`-th: which share, which of its points.
fn chosen(vpl: u32, index: u32) -> vec2<u32> {
    let stride = 0xffffffffu / batch.points;
    let at = stride * index + hash(vpl) % stride;
    // The last share that begins at or before it.
    var low = 0u;
    var high = arrayLength(&shares);
    while low < high {
        let middle = (low + high) / 2u;
        if shares[middle].begin <= at {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    let share = max(low, 1u) - 1u;
    // A chunk's points lie along a curve: van der Corput's sequence, turned for each VPL, spreads any few evenly over it.
    let turn = reverseBits((at - shares[share].begin) / stride) + hash(vpl ^ hash(share));
    return vec2(share, shares[share].first + ((turn >> 16u) * shares[share].count >> 16u));
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= batch.points {
        return;
    }
    let number = batch.first + id.y;
    let vpl = vpls[number];
    let choice = chosen(number, id.x);
    let point = placed[choice.y];
    let away = point.position - vpl.position;
    let r = length(away);
    let seen = map_place(vpl, batch.map, away / max(r, 1e-9));
    if seen.z <= HORIZON {
        return;
    }
    let per_radian = 0.5 * f32(batch.map) * vpl.per_spread / (1.0 + seen.z);
    let share = shares[choice.x];
    let radius_m = min(share.radius_m, MOST_TEXELS * r / per_radian);
    let per_metre = per_radian / r;
    let radius = radius_m * per_metre;
    let box = vec3(share.half_along_m, share.half_across_m, share.half_third_m);
    let axes = transpose(mat3x3(share.along, share.across, cross(share.along, share.across)));
    let middle = share.middle - vpl.position;
    // What fills less than a texel has it as often.
    let texels = share.area_m2 * abs(dot(away / max(r, 1e-9), point.normal)) * per_metre * per_metre;
    let has_own = f32(hash(id.x ^ hash(number)) >> 8u) / 16777216.0 < texels;
    let last = vec2(i32(batch.map) - 1);
    let low = max(vec2<i32>(floor(seen.xy - radius)), vec2(0));
    let high = min(vec2<i32>(floor(seen.xy + radius)), last);
    let own = vec2<i32>(floor(seen.xy));
    let before = dot(away, point.normal);
    for (var y = low.y; y <= high.y; y++) {
        for (var x = low.x; x <= high.x; x++) {
            let direction = map_direction(vpl, batch.map, vec2(x, y));
            let facing = dot(direction, point.normal);
            let t = before / facing;
            let aside = direction * t - away;
            let meets = abs(facing) > EDGE_ON && t > 0.0 && dot(aside, aside) <= radius_m * radius_m
                && all(abs(axes * (direction * t - middle)) <= box);
            if meets || has_own && all(vec2(x, y) == own) {
                let first = id.y * batch.map * batch.map;
                let bits = bitcast<u32>(select(r, t, meets));
                atomicMin(&maps[first + u32(y) * batch.map + u32(x)], bits);
            }
        }
    }
}
