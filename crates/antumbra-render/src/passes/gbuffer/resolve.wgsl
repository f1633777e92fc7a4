// From visible triangles to surfaces: twin of `Surfaces::at`.

@group(1) @binding(0) var visible: texture_2d<u32>;
@group(1) @binding(1) var<storage, read_write> gbuffer: array<Texel>;

// The mip level whose texels are as large as the footprint.
fn mip_level(part: Part, vertices: vec3<u32>, area_m2: f32, footprint_m: f32) -> f32 {
    let image = material_word(part.material, 11u);
    if image == NONE || part.texcoords == NONE {
        return 0.0;
    }
    let level = geometry.levels + 4u * tables[geometry.images + 4u * image];
    let texels_all = f32(tables[level + 1u]) * f32(tables[level + 2u]);
    let m = part.material;
    let scale = abs(material_value(m, 14u) * material_value(m, 18u) - material_value(m, 15u) * material_value(m, 17u));
    let a = texcoord_of(part, vertices.x);
    let b = texcoord_of(part, vertices.y) - a;
    let c = texcoord_of(part, vertices.z) - a;
    let uv_area = abs(b.x * c.y - b.y * c.x) * scale;
    return 0.5 * log2(max(uv_area * texels_all / area_m2 * footprint_m * footprint_m, 1e-12));
}

fn facing(normal: vec3<f32>, side: vec3<f32>, otherwise: vec3<f32>) -> vec3<f32> {
    let size = length(normal);
    let n = select(otherwise, normal / size, size > 0.0);
    return select(n, -n, dot(n, side) < 0.0);
}

fn surface_texel(ray: vec3<f32>, seen: vec2<u32>) -> Texel {
    let part = part_of(seen.x - 1u);
    let vertices = vertices_of(part, seen.y);
    let a = position_of(part, vertices.x);
    let ab = position_of(part, vertices.y) - a;
    let ac = position_of(part, vertices.z) - a;
    // Möller, Trumbore (1997), from the eye at the origin.
    let p = cross(ray, ac);
    let q = cross(-a, ab);
    let scale = 1.0 / dot(ab, p);
    let u = dot(-a, p) * scale;
    let v = dot(ray, q) * scale;
    let weights = vec3(1.0 - u - v, u, v);
    let depth = dot(ac, q) * scale;
    let stretch = length(ray);
    let towards_eye = ray / -stretch;
    let flat_normal = cross(ab, ac);
    let face_normal = facing(flat_normal, towards_eye, vec3(0.0, 1.0, 0.0));
    var normal = face_normal;
    if part.normals != NONE {
        let smoothed = normal_of(part, vertices.x) * weights.x + normal_of(part, vertices.y) * weights.y
            + normal_of(part, vertices.z) * weights.z;
        // Normals turn by the inverse's transpose: the matrix of cofactors, up to a positive scale.
        let rows = nodes[part.node];
        let x = rows[0].xyz;
        let y = rows[1].xyz;
        let z = rows[2].xyz;
        let cofactors = mat3x3(cross(y, z), cross(z, x), cross(x, y));
        normal = facing(smoothed * cofactors, face_normal, face_normal);
    }
    // A shading normal that looks away from the viewer bends back to the rim.
    let cosine = dot(normal, towards_eye);
    if cosine < 0.01 {
        normal = normalize(normal + towards_eye * (0.01 - cosine));
    }
    let footprint_m = depth * stretch * frame.footprint;
    let mip = mip_level(part, vertices, length(flat_normal), footprint_m);
    let color = clamp(color_at(part, vertices, weights, mip).xyz, vec3(0.0), vec3(1.0));
    let m = part.material;
    let roughness = clamp(material_value(m, 8u), 0.0, 1.0);
    return Texel(
        depth,
        packed_normal(normal),
        packed_normal(face_normal),
        pack2x16float(color.xy),
        pack2x16float(vec2(color.z, roughness)),
        clamp(material_value(m, 7u), 0.0, 1.0),
        pack2x16float(vec2(material_value(m, 4u), material_value(m, 5u))),
        pack2x16float(vec2(material_value(m, 6u), 0.0)),
    );
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= frame.size) {
        return;
    }
    let seen = textureLoad(visible, id.xy, 0).xy;
    var texel = Texel(0.0, 0u, 0u, 0u, 0u, 0.0, 0u, 0u);
    if seen.x != 0u {
        texel = surface_texel(ray_through(frame, vec2<f32>(id.xy) + frame.jitter), seen);
    }
    gbuffer[pixel_index(frame, id.xy)] = texel;
}
