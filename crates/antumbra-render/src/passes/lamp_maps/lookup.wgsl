// Looks a point up in a lamp's map: twin of `Shape`.

// Where a point appears: side, and texel and depth in it.
struct Mapped {
    side: u32,
    at: vec2<f32>,
    depth: f32,
}

// Error of a depth, relative to itself.
const MAP_ROUNDING: f32 = 1e-5;

fn map_scale(size: f32) -> f32 {
    return (size - 2.0 * map_layout.border) / size;
}

// The axis along which a vector is longest.
fn longest(v: vec3<f32>) -> u32 {
    let a = abs(v);
    return select(select(2u, 1u, a.y >= a.z), 0u, a.x >= max(a.y, a.z));
}

// What `map_offset` is on the sides along an axis.
fn side_offset(from_light: vec3<f32>, normal: vec3<f32>, inner: f32, reach: f32, axis: u32) -> f32 {
    // The moved point's texel may be wider than the point's, by as much as it moves along the axis.
    let texel = 2.0 * abs(from_light[axis]) / (inner - 1.42 * reach);
    return reach * texel * (abs(normal[(axis + 1u) % 3u]) + abs(normal[(axis + 2u) % 3u]));
}

// How far along its unit normal a point moves off its surface, so that no tap of the filter falls on the surface itself.
fn map_offset(from_light: vec3<f32>, normal: vec3<f32>, size: f32, reach: f32) -> f32 {
    let inner = size - 2.0 * map_layout.border;
    if IS_CUBE {
        let first = side_offset(from_light, normal, inner, reach, longest(from_light));
        // It may move over to another side.
        return max(first, side_offset(from_light, normal, inner, reach, longest(from_light + normal * first)));
    }
    // A step on the map is a turn by an angle of twice that over 1 + r^2.
    let distance = length(from_light);
    let r = clamp(length(from_light.xz) / (distance + abs(from_light.y)) - 2.83 * reach / inner, 0.0, 1.0);
    let turn = sin(min(5.66 * reach / inner / (1.0 + r * r), 1.0));
    var moved = from_light;
    var offset = 0.0;
    for (var i = 0; i < 2; i++) {
        let cosine = dot(normal, moved) / max(length(moved), 1e-30);
        offset = distance * turn * sqrt(max(1.0 - cosine * cosine, 0.0)) / (1.0 - turn) + 0.125 * distance / inner;
        moved = from_light + normal * offset;
    }
    return offset;
}

fn mapped(p: vec3<f32>, size: f32, near_m: f32) -> Mapped {
    var side: u32;
    var at: vec2<f32>;
    var depth: f32;
    if IS_CUBE {
        let axis = longest(p);
        side = 2u * axis + select(0u, 1u, p[axis] < 0.0);
        depth = abs(p[axis]);
        at = vec2(p[(axis + 1u) % 3u], p[(axis + 2u) % 3u]) / depth;
    } else {
        side = select(0u, 1u, p.y < 0.0);
        depth = length(p);
        at = p.xz / (depth + abs(p.y));
    }
    return Mapped(side, (at * map_scale(size) + 1.0) * (0.5 * size), near_m / depth);
}

// How much of a lamp reaches a point, both relative to the eye: 0 to 1.
fn map_visibility(lamp: MappedLamp, light: vec3<f32>, point: vec3<f32>, normal: vec3<f32>) -> f32 {
    let radius = i32(map_layout.radius);
    let reach = f32(radius) + 0.5 + 0.0625;
    let from_light = point - light;
    let here = mapped(from_light + normal * map_offset(from_light, normal, lamp.size, reach), lamp.size, lamp.near_m);
    let tile = lamp.first_tile + here.side;
    let in_layer = tile % (map_layout.tiles * map_layout.tiles);
    let layer = tile / (map_layout.tiles * map_layout.tiles);
    let origin = vec2<i32>(vec2(in_layer % map_layout.tiles, in_layer / map_layout.tiles) * map_layout.tile_size);
    let middle = clamp(vec2<i32>(here.at), vec2(radius), vec2(i32(lamp.size) - 1 - radius));
    var sum = 0.0;
    var weights = 0.0;
    for (var y = -radius; y <= radius; y++) {
        for (var x = -radius; x <= radius; x++) {
            let tent = f32((radius + 1 - abs(x)) * (radius + 1 - abs(y)));
            let weight = select(tent, 1.0, map_layout.kernel == 0u);
            let nearest = textureLoad(maps, origin + middle + vec2(x, y), layer, 0);
            sum += weight * select(0.0, 1.0, here.depth * (1.0 + MAP_ROUNDING) >= nearest);
            weights += weight;
        }
    }
    return sum / weights;
}
