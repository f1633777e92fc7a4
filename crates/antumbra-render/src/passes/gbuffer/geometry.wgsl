// The scene's meshes and materials, as unsigned words.
//
//   parts (12 words)      first index, first vertex, first normal, first texture coordinate, first colour (each ~0 for none),
//                         material, node, number of its first triangle, and four spare
//   materials (24 words)  base colour (4), emissive (3), metallic, roughness, alpha mode (0 opaque, 1 mask, 2 blend), cutoff,
//                         image (~0 for none), wrap modes (2: 0 repeat, 1 mirror, 2 clamp), transform (2 x 3), four spare
//   images (4 words)      first level, number of levels, two spare
//   levels (4 words)      first texel, width, height, spare
const NONE: u32 = 0xffffffffu;

struct Geometry {
    // Where each table begins.
    parts: u32,
    materials: u32,
    images: u32,
    levels: u32,
}

const MASK: u32 = 1u;
const BLEND: u32 = 2u;

@group(0) @binding(0) var<storage, read> frame: Frame;
@group(0) @binding(1) var<storage, read> geometry: Geometry;
@group(0) @binding(2) var<storage, read> tables: array<u32>;
// World from mesh, relative to the eye: three rows each.
@group(0) @binding(3) var<storage, read> nodes: array<mat3x4<f32>>;
@group(0) @binding(4) var<storage, read> indices: array<u32>;
@group(0) @binding(5) var<storage, read> positions: array<f32>;
// Normals, texture coordinates, colours.
@group(0) @binding(6) var<storage, read> attributes: array<f32>;
@group(0) @binding(7) var<storage, read> texels: array<u32>;

struct Part {
    first_index: u32,
    first_vertex: u32,
    normals: u32,
    texcoords: u32,
    colors: u32,
    material: u32,
    node: u32,
    first_triangle: u32,
}

fn part_of(index: u32) -> Part {
    let at = geometry.parts + 12u * index;
    return Part(tables[at], tables[at + 1u], tables[at + 2u], tables[at + 3u], tables[at + 4u], tables[at + 5u],
        tables[at + 6u], tables[at + 7u]);
}

// A number of a material.
fn material_value(material: u32, i: u32) -> f32 {
    return bitcast<f32>(tables[geometry.materials + 24u * material + i]);
}

fn material_word(material: u32, i: u32) -> u32 {
    return tables[geometry.materials + 24u * material + i];
}

// The three vertices of a triangle of a part.
fn vertices_of(part: Part, triangle: u32) -> vec3<u32> {
    let at = part.first_index + 3u * triangle;
    return vec3(indices[at], indices[at + 1u], indices[at + 2u]);
}

// A vertex relative to the eye.
fn position_of(part: Part, vertex: u32) -> vec3<f32> {
    let at = 3u * (part.first_vertex + vertex);
    let p = vec4(positions[at], positions[at + 1u], positions[at + 2u], 1.0);
    return p * nodes[part.node];
}

fn texcoord_of(part: Part, vertex: u32) -> vec2<f32> {
    let at = part.texcoords + 2u * vertex;
    return vec2(attributes[at], attributes[at + 1u]);
}

fn color_of(part: Part, vertex: u32) -> vec4<f32> {
    let at = part.colors + 4u * vertex;
    return vec4(attributes[at], attributes[at + 1u], attributes[at + 2u], attributes[at + 3u]);
}

fn normal_of(part: Part, vertex: u32) -> vec3<f32> {
    let at = part.normals + 3u * vertex;
    return vec3(attributes[at], attributes[at + 1u], attributes[at + 2u]);
}

fn remainder(a: i32, n: i32) -> i32 {
    return ((a % n) + n) % n;
}

// The texel that an index stands for in a row of `side` texels.
fn wrapped(mode: u32, index: i32, side: i32) -> u32 {
    if mode == 0u {
        return u32(remainder(index, side));
    }
    if mode == 2u {
        return u32(clamp(index, 0, side - 1));
    }
    let twice = remainder(index, 2 * side);
    return u32(min(twice, 2 * side - 1 - twice));
}

// Reduced first, so that large coordinates keep their fraction.
fn reduced(mode: u32, coordinate: f32) -> f32 {
    if mode == 0u {
        return coordinate - floor(coordinate);
    }
    if mode == 2u {
        return clamp(coordinate, -1.0, 2.0);
    }
    return coordinate - 2.0 * floor(0.5 * coordinate);
}

// sRGB to linear (IEC 61966-2-1).
fn linear_from_srgb(c: vec3<f32>) -> vec3<f32> {
    return select(pow((c + 0.055) / 1.055, vec3(2.4)), c / 12.92, c <= vec3(0.04045));
}

fn texel_at(first: u32, width: u32, x: u32, y: u32) -> vec4<f32> {
    let rgba = unpack4x8unorm(texels[first + y * width + x]);
    return vec4(linear_from_srgb(rgba.xyz), rgba.w);
}

// The base-colour texture's linear RGBA at one mip level: bilinear between texel centres.
fn bilinear(material: u32, level: u32, at: vec2<f32>) -> vec4<f32> {
    let entry = geometry.levels + 4u * level;
    let first = tables[entry];
    let size = vec2(tables[entry + 1u], tables[entry + 2u]);
    let wrap_s = material_word(material, 12u);
    let wrap_t = material_word(material, 13u);
    let xy = vec2(reduced(wrap_s, at.x), reduced(wrap_t, at.y)) * vec2<f32>(size) - 0.5;
    let corner = floor(xy);
    let f = xy - corner;
    let i = vec2<i32>(corner);
    let side = vec2<i32>(size);
    let x0 = wrapped(wrap_s, i.x, side.x);
    let x1 = wrapped(wrap_s, i.x + 1, side.x);
    let y0 = wrapped(wrap_t, i.y, side.y);
    let y1 = wrapped(wrap_t, i.y + 1, side.y);
    let top = mix(texel_at(first, size.x, x0, y0), texel_at(first, size.x, x1, y0), f.x);
    let bottom = mix(texel_at(first, size.x, x0, y1), texel_at(first, size.x, x1, y1), f.x);
    return mix(top, bottom, f.y);
}

fn transformed(material: u32, uv: vec2<f32>) -> vec2<f32> {
    let u = material_value(material, 14u) * uv.x + material_value(material, 15u) * uv.y + material_value(material, 16u);
    let v = material_value(material, 17u) * uv.x + material_value(material, 18u) * uv.y + material_value(material, 19u);
    return vec2(u, v);
}

// Linear RGBA of a surface: factor, vertex colour and texture multiplied; linear between mip levels.
fn color_at(part: Part, vertices: vec3<u32>, weights: vec3<f32>, mip: f32) -> vec4<f32> {
    let m = part.material;
    var color = vec4(material_value(m, 0u), material_value(m, 1u), material_value(m, 2u), material_value(m, 3u));
    if part.colors != NONE {
        color *= color_of(part, vertices.x) * weights.x + color_of(part, vertices.y) * weights.y
            + color_of(part, vertices.z) * weights.z;
    }
    let image = material_word(m, 11u);
    if image == NONE || part.texcoords == NONE {
        return color;
    }
    let uv = texcoord_of(part, vertices.x) * weights.x + texcoord_of(part, vertices.y) * weights.y
        + texcoord_of(part, vertices.z) * weights.z;
    let at = transformed(m, uv);
    let first = tables[geometry.images + 4u * image];
    let last = f32(tables[geometry.images + 4u * image + 1u] - 1u);
    let level = clamp(mip, 0.0, last);
    var texture = bilinear(m, first + u32(level), at);
    if fract(level) > 0.0 {
        texture = mix(texture, bilinear(m, first + u32(level) + 1u, at), fract(level));
    }
    return color * texture;
}
