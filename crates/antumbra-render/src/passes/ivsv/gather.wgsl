// What a batch of VPLs does to each sample: twin of `gather`. Constants before this text say how:
// SHADOWS 0 none, 1 voxels, 2 maps; GATHERING 0 full, 1 interleaved, 2 half; INTERPOLATION 0 none, 1 plain, 2 fast; EXACT;
// QUADS, texels of 128 bits along phi.

// What area lights do to a sample: light on its surface, what that mirrors, light in the fog before it.
struct AreaLit {
    irradiance: vec4<f32>,
    glossy: vec4<f32>,
    airlight: vec4<f32>,
}

@group(0) @binding(0) var<storage, read> frame: Frame;
@group(0) @binding(1) var<storage, read> batch: Batch;
@group(0) @binding(2) var<storage, read> gbuffer: array<Texel>;
@group(0) @binding(3) var<storage, read> vpls: array<Vpl>;
@group(0) @binding(4) var<storage, read> voxels: array<vec4<u32>>;
@group(0) @binding(5) var<storage, read> maps: array<u32>;
@group(0) @binding(6) var<storage, read> tails: array<vec2<f32>>;
@group(0) @binding(7) var<storage, read_write> gathered: array<AreaLit>;

const CELLS_OFF: f32 = 0.6;
const ALPHA_BIAS: f32 = -1.0;
const MAP_BIAS: f32 = 0.03;

// A sample's way through a VPL's shadows.
struct Way {
    place: Place,
    // 0 lit, 1 dark, 2 in texels, 3 in a map.
    kind: u32,
    // First texels of two planes, and how much the second counts.
    first: u32,
    second: u32,
    share: f32,
    // Where the VPL's map begins.
    map: u32,
}

fn way_of(vpl: Vpl, slot: u32, place: Place, stop: f32, bias: f32) -> Way {
    var way = Way(place, SHADOWS, 0u, 0u, 0.0, slot * batch.map * batch.map);
    if SHADOWS != 1u {
        way.kind = select(0u, 3u, SHADOWS == 2u);
        return way;
    }
    // At the epipole a voxel is as long as the ray: what is seen stands before the light, or nothing does.
    if place.alpha * vpl.alpha_scale < 1.0 {
        way.kind = select(0u, 1u, stop < vpl.distance);
        return way;
    }
    let column = (place.alpha - vpl.alpha_min) * vpl.alpha_scale + bias;
    let own_column = min(u32(max(column, 0.0)), batch.alpha - 1u);
    let index = theta_index(vpl, place.theta);
    way.kind = 2u;
    let planes = slot * batch.theta;
    if INTERPOLATION == 0u {
        let row = row_of(vpl, batch.theta, i32(floor(index)));
        way.first = ((planes + row) * batch.alpha + own_column) * QUADS;
        way.second = way.first;
        return way;
    }
    let lower = floor(index - 0.5);
    let first = row_of(vpl, batch.theta, i32(lower));
    let second = row_of(vpl, batch.theta, i32(lower) + 1);
    way.first = ((planes + first) * batch.alpha + own_column) * QUADS;
    way.second = ((planes + second) * batch.alpha + own_column) * QUADS;
    way.share = index - 0.5 - lower;
    return way;
}

// Whether a place lies in the shadow of what a map shows.
fn is_dark(vpl: Vpl, first: u32, at: vec3<f32>) -> bool {
    let away = at - vpl.position;
    let r = length(away);
    let seen = map_place(vpl, batch.map, away / max(r, 1e-9));
    if seen.z <= HORIZON {
        return false;
    }
    let blocked = map_between(first, batch.map, seen.xy);
    return blocked > 0.0 && r > blocked * (1.0 + MAP_BIAS);
}

// A bit of a texel, 1 where it is lit: by indexing.
fn lit_plain(texel: u32, bit: u32) -> f32 {
    let quad = voxels[texel + bit / 128u];
    return select(1.0, 0.0, (quad[bit / 32u % 4u] >> (bit & 31u) & 1u) == 1u);
}

// The word of a texel that a bit lies in, by selections.
fn word_of(quad: vec4<u32>, word: u32) -> u32 {
    let pair = select(quad.xy, quad.zw, (word & 2u) != 0u);
    return select(pair.x, pair.y, (word & 1u) != 0u);
}

// Visibility between two bits of two texels: one comparison of four bits at a time.
fn lit_fast(way: Way, bits: vec2<u32>, weight: f32) -> f32 {
    let quads = bits / 128u;
    let words = bits / 32u;
    let near_first = voxels[way.first + quads.x];
    let near_second = voxels[way.second + quads.x];
    var far_first = near_first;
    var far_second = near_second;
    if QUADS > 1u {
        far_first = voxels[way.first + quads.y];
        far_second = voxels[way.second + quads.y];
    }
    let masks = vec2(1u) << (bits & vec2(31u));
    let seen = vec4(
        word_of(near_first, words.x) & masks.x, word_of(near_second, words.x) & masks.x,
        word_of(far_first, words.y) & masks.y, word_of(far_second, words.y) & masks.y,
    );
    let both = way.share * weight;
    let weights = vec4(1.0 - weight - way.share + both, way.share - both, weight - both, both);
    return dot(select(weights, vec4(0.0), seen != vec4(0u)), vec4(1.0));
}

// How much of the light arrives at a place, from 0 to 1.
fn visible(vpl: Vpl, slot: u32, at: vec3<f32>, stop: f32) -> f32 {
    let t = length(at);
    let way = way_of(vpl, slot, place_of(vpl, at / max(t, 1e-9), t), stop, ALPHA_BIAS);
    if way.kind < 2u {
        return f32(1u - way.kind);
    }
    if SHADOWS == 2u {
        return select(1.0, 0.0, is_dark(vpl, way.map, at));
    }
    let index = way.place.phi * vpl.phi_scale;
    let last = i32(batch.phi) - 1;
    if INTERPOLATION == 0u {
        return lit_plain(way.first, u32(clamp(i32(floor(index)), 0, last)));
    }
    let lower = floor(index - 0.5);
    let weight = index - 0.5 - lower;
    let bits = vec2<u32>(clamp(vec2(i32(lower), i32(lower) + 1), vec2(0), vec2(last)));
    if INTERPOLATION == 2u {
        return lit_fast(way, bits, weight);
    }
    let first = lit_plain(way.first, bits.x) * (1.0 - weight) + lit_plain(way.first, bits.y) * weight;
    let second = lit_plain(way.second, bits.x) * (1.0 - weight) + lit_plain(way.second, bits.y) * weight;
    return first * (1.0 - way.share) + second * way.share;
}

// What fog needs to know of a view ray and a VPL.
struct Ray {
    direction: vec3<f32>,
    beside: Beside,
    // Of the light's nearest place on the ray, nearer than h where it is nearer than its own radius.
    stretch: f32,
    // What the emitter lights, angles at the light.
    lit: vec2<f32>,
    // Where the ray ends: phi.
    end: f32,
}

// What comes from behind an angle phi.
fn behind_phi(ray: Ray, alpha: f32, phi: f32) -> f32 {
    var theta = phi - HALF_PI + alpha;
    if ray.stretch < 1.0 {
        theta = atan(ray.stretch * tan(clamp(theta, -STEEPEST, STEEPEST)));
    }
    return behind(ray.beside, clamp(theta, ray.lit.x, ray.lit.y));
}

// One quad of the texel of a ray.
fn quad_of(vpl: Vpl, way: Way, ray: Ray, texel: u32, quad: u32, bits: u32) -> vec4<u32> {
    if SHADOWS != 2u {
        return voxels[texel + quad];
    }
    var out = vec4(0u);
    for (var bit = 128u * quad; bit < min(bits, 128u * quad + 128u); bit++) {
        let phi = (f32(bit) + 0.5) / vpl.phi_scale;
        let t = vpl.distance * sin(phi) / max(sin(way.place.alpha + phi), 1e-6);
        if is_dark(vpl, way.map, ray.direction * t) {
            out[bit / 32u % 4u] |= 1u << (bit & 31u);
        }
    }
    return out;
}

fn whole(ray: Ray) -> f32 {
    return behind(ray.beside, ray.lit.x) - behind(ray.beside, ray.lit.y);
}

// The share of a texel's bits that are lit, up to the end.
fn share_lit(vpl: Vpl, way: Way, ray: Ray, texel: u32) -> f32 {
    let bits = clamp(u32(ray.end * vpl.phi_scale), 1u, batch.phi);
    var dark = 0u;
    for (var quad = 0u; quad < QUADS; quad++) {
        let own = quad_of(vpl, way, ray, texel, quad, bits);
        for (var i = 0u; i < 4u; i++) {
            let first = 128u * quad + 32u * i;
            let left = select(0u, bits - first, bits > first);
            let mask = select((1u << (left & 31u)) - 1u, 0xffffffffu, left >= 32u);
            dark += countOneBits(own[i] & mask);
        }
    }
    return 1.0 - f32(dark) / f32(bits);
}

// The sum over a texel's lit runs of differences of what comes from behind their ends.
fn runs(vpl: Vpl, way: Way, ray: Ray, texel: u32) -> f32 {
    let end_index = ray.end * vpl.phi_scale;
    let bits = clamp(u32(ceil(end_index)), 1u, batch.phi);
    var dark = 0u;
    var sum = behind_phi(ray, way.place.alpha, 0.0);
    for (var quad = 0u; 128u * quad < bits; quad++) {
        let own = quad_of(vpl, way, ray, texel, quad, bits);
        for (var i = 0u; i < 4u; i++) {
            let word = own[i];
            var changes = word ^ (word << 1u | dark);
            while changes != 0u {
                let bit = 128u * quad + 32u * i + firstTrailingBit(changes);
                changes &= changes - 1u;
                if f32(bit) >= end_index {
                    break;
                }
                dark ^= 1u;
                let there = behind_phi(ray, way.place.alpha, f32(bit) / vpl.phi_scale);
                sum += select(there, -there, dark == 1u);
            }
        }
    }
    return select(sum, sum - behind_phi(ray, way.place.alpha, min(ray.end, PI)), dark == 0u);
}

fn of_texel(vpl: Vpl, way: Way, ray: Ray, texel: u32) -> f32 {
    if EXACT {
        return runs(vpl, way, ray, texel);
    }
    return whole(ray) * share_lit(vpl, way, ray, texel);
}

// Airlight of a VPL per intensity and scattering.
fn scattered(vpl: Vpl, way: Way, direction: vec3<f32>, fog_m: f32) -> f32 {
    if way.kind == 1u {
        return 0.0;
    }
    let foot = vpl.distance * dot(direction, vpl.axis);
    let from_light = direction * foot - vpl.position;
    let own_h = length(from_light);
    let h = max(max(own_h, vpl.radius_m), 1e-4 * vpl.distance);
    let a = dot(vpl.normal, from_light) / max(own_h, 1e-9);
    let b = dot(vpl.normal, direction);
    let beside = Beside(foot, h, a, b, frame.fog_per_m, vpl.start_m);
    // The emitter's cosine is positive within a quarter turn of this angle.
    let middle = atan2(b, a);
    let ends = vec2(atan(-foot / h), atan((fog_m - foot) / h));
    let lit = clamp(ends, vec2(middle - HALF_PI), vec2(middle + HALF_PI));
    let ray = Ray(direction, beside, own_h / h, lit, place_of(vpl, direction, fog_m).phi);
    if way.kind == 0u {
        return whole(ray);
    }
    let first = of_texel(vpl, way, ray, way.first);
    if SHADOWS == 2u || INTERPOLATION == 0u || way.share == 0.0 {
        return first;
    }
    return first * (1.0 - way.share) + of_texel(vpl, way, ray, way.second) * way.share;
}

// Interleaved, those next to one another in a workgroup gather the same VPLs: every third pixel of every third row.
fn gathering_pixel(id: vec3<u32>) -> vec2<u32> {
    if GATHERING == 1u {
        return 3u * id.xy + vec2(id.z % 3u, id.z / 3u);
    }
    return select(id.xy, 2u * id.xy, GATHERING == 2u);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = gathering_pixel(id);
    if any(pixel >= frame.size) {
        return;
    }
    let texel = gbuffer[pixel_index(frame, pixel)];
    let s = unpacked(frame, pixel, texel);
    let has_surface = texel.depth > 0.0;
    let direction = -s.towards_eye;
    let distance = select(frame.fog_end_m, s.distance, has_surface);
    let fog_m = min(distance, frame.fog_end_m);
    // Behind what is no surface nothing stands before the light.
    let stop = select(1e30, distance, has_surface);
    var index = pixel_index(frame, pixel);
    if GATHERING == 2u {
        index = id.y * ((frame.size.x + 1u) / 2u) + id.x;
    }
    var lit = AreaLit();
    if batch.first > 0u {
        lit = gathered[index];
    }
    let end = batch.first + batch.count;
    let step = select(1u, 9u, GATHERING == 1u);
    // Interleaved: the VPLs of one part, one of each nine.
    for (var nine = batch.first / step * step; nine < end; nine += step) {
        var number = nine;
        if GATHERING == 1u {
            number += (id.z + 9u - nine / 9u % 9u) % 9u;
        }
        if number < batch.first || number >= end {
            continue;
        }
        let vpl = vpls[number];
        let slot = number - batch.first;
        let place = place_of(vpl, direction, distance);
        if has_surface {
            let at = direction * distance;
            let from_light = vpl.position - at;
            let r = max(length(from_light), 1e-9);
            let towards = from_light / r;
            let emitted = -dot(vpl.normal, towards);
            if emitted > 0.0 && can_be_lit(s, towards) {
                let clear = exp(-frame.fog_per_m * (r - vpl.start_m));
                let falloff = emitted * clear / (r * r + vpl.radius_m * vpl.radius_m);
                let of_map = 2.0 * (1.0 + emitted) / (vpl.per_spread * f32(batch.map));
                let cell = r * max(max(1.0 / vpl.phi_scale, sin(place.phi) / vpl.theta_scale), of_map);
                let seen = visible(vpl, slot, at + s.face_normal * (CELLS_OFF * cell), stop) * falloff * incidence(s, towards);
                let irradiance = vpl.intensity * seen;
                lit.irradiance += vec4(irradiance, 0.0);
                lit.glossy += vec4(highlight(s, towards) * irradiance, 0.0);
            }
        }
        if frame.fog_per_m > 0.0 {
            let way = way_of(vpl, slot, place, stop, 0.0);
            let airlight = frame.fog_per_m * scattered(vpl, way, direction, fog_m);
            lit.airlight += vec4(vpl.intensity * airlight, 0.0);
        }
    }
    gathered[index] = lit;
}
