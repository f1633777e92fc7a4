// The papers' own encoding, `dag8` (Sintorn et al. 2014). The other modules ask of an encoding whether a voxel is lit
// (antumbra_voxel_is_lit), the weight of a filter's lit taps (antumbra_window_weight), the mean over a node (antumbra_voxel_mean)
// and the box about a voxel in which all are alike (antumbra_cell).
//
//   node reference   0 lit, 1 shadowed, else a word of the pool
//   header           bits 2i+1..2i: child i is 0 lit, 1 shadowed, 2 mixed; bits 31..16: mean visibility
//   then             one reference per mixed child, in the children's order

const ANTUMBRA_LIT: u32 = 0u;
const ANTUMBRA_SHADOWED: u32 = 1u;
// log2 of the voxels per side of a slice node: eight slices of 8 x 8 texels.
const ANTUMBRA_SLICE_LEVEL: u32 = 3u;

// Child i of a node that is not homogeneous.
fn antumbra_child(node: u32, i: u32) -> u32 {
    let header = antumbra_word(node);
    let code = (header >> (2u * i)) & 3u;
    if code <= ANTUMBRA_SHADOWED {
        return code;
    }
    // Code 3 does not occur: a high bit is a mixed child.
    let mixed_before = header & 0xaaaau & ((1u << (2u * i)) - 1u);
    return antumbra_word(node + 1u + countOneBits(mixed_before));
}

fn antumbra_octant(voxel: vec3<u32>, level: u32) -> u32 {
    let bits = (voxel >> vec3(level)) & vec3(1u);
    return bits.x | (bits.y << 1u) | (bits.z << 2u);
}

// Descends from a node of 2^from voxels per side towards a voxel, until the node is homogeneous or has 2^to per side;
// `to` is at least ANTUMBRA_SLICE_LEVEL. Only the voxel's low bits count.
fn antumbra_descend(start: u32, from_level: u32, to_level: u32, voxel: vec3<u32>) -> u32 {
    var node = start;
    var level = from_level;
    while node > ANTUMBRA_SHADOWED && level > to_level {
        level -= 1u;
        node = antumbra_child(node, antumbra_octant(voxel, level));
    }
    return node;
}

// The 8 x 8 texels of one slice of a node at ANTUMBRA_SLICE_LEVEL or of a homogeneous one: bit 8y + x is 1 where lit, rows
// 0 to 3 in the first word.
fn antumbra_mask(node: u32, z: u32) -> vec2<u32> {
    var mask = node;
    if node > ANTUMBRA_SHADOWED {
        mask = antumbra_child(node, z & 7u);
    }
    if mask > ANTUMBRA_SHADOWED {
        return vec2(antumbra_word(mask), antumbra_word(mask + 1u));
    }
    return vec2(select(0u, 0xffffffffu, mask == ANTUMBRA_LIT));
}

// Whether a voxel below a node of 2^level voxels per side is lit.
fn antumbra_node_is_lit(start: u32, level: u32, voxel: vec3<u32>) -> bool {
    let node = antumbra_descend(start, level, ANTUMBRA_SLICE_LEVEL, voxel);
    if node <= ANTUMBRA_SHADOWED {
        return node == ANTUMBRA_LIT;
    }
    let mask = antumbra_child(node, voxel.z & 7u);
    if mask <= ANTUMBRA_SHADOWED {
        return mask == ANTUMBRA_LIT;
    }
    // One word of the two.
    let word = antumbra_word(mask + ((voxel.y >> 2u) & 1u));
    return ((word >> (8u * (voxel.y & 3u) + (voxel.x & 7u))) & 1u) != 0u;
}

// Mean visibility of a node of at least 8 voxels per side.
fn antumbra_node_mean(node: u32) -> f32 {
    if node <= ANTUMBRA_SHADOWED {
        return select(0.0, 1.0, node == ANTUMBRA_LIT);
    }
    return f32(antumbra_word(node) >> 16u) * (1.0 / 65535.0);
}

// The slices about slice z of a slice node that are as homogeneous as it: first, and one past the last; z itself where a
// mask is mixed. The last number is the slice's reference.
fn antumbra_like_slices(node: u32, z: u32) -> vec3<u32> {
    let reference = antumbra_child(node, z);
    if reference > ANTUMBRA_SHADOWED {
        return vec3(z, z + 1u, reference);
    }
    // Two bits for each slice, not both zero where it is unlike this one.
    let unlike = (antumbra_word(node) ^ (reference * 0x5555u)) & 0xffffu;
    let before = unlike & ((1u << (2u * z)) - 1u);
    let behind = unlike >> (2u * z);
    let first = (32u - countLeadingZeros(before) + 1u) / 2u;
    let end = select(z + countTrailingZeros(behind) / 2u, 8u, behind == 0u);
    return vec3(first, min(end, 8u), reference);
}

// Where descents to a voxel begin: a cell of the top grid (Kämpe et al. 2015, section 4), or the root.
fn antumbra_start(face: AntumbraFace, voxel: vec3<u32>) -> AntumbraStart {
    if !ANTUMBRA_TOP_GRID {
        return AntumbraStart(face.root, face.log2_side);
    }
    let level = face.log2_side - face.grid_log2;
    let cell = voxel >> vec3(level);
    let index = (((cell.z << face.grid_log2) + cell.y) << face.grid_log2) + cell.x;
    return AntumbraStart(antumbra_table(face.grid + index), level);
}

// Whether a voxel of a face is lit; its indices are less than the face's side.
fn antumbra_voxel_is_lit(face: AntumbraFace, voxel: vec3<u32>) -> bool {
    let start = antumbra_start(face, voxel);
    return antumbra_node_is_lit(start.node, start.level, voxel);
}

// Weight of the lit taps inside the grid.
fn antumbra_window_weight(face: AntumbraFace, w: AntumbraWindow) -> u32 {
    let first = vec3(vec2<u32>(w.first), w.z);
    let last = vec2<u32>(w.last);
    let top = antumbra_start(face, first);
    // The least level whose one node holds the whole window, not below the slices.
    let different = (first.x ^ last.x) | (first.y ^ last.y);
    let joint = max(32u - countLeadingZeros(different), ANTUMBRA_SLICE_LEVEL);
    let is_shared = joint <= top.level;
    var below = joint - 1u;
    var quadrants = array<u32, 4>(0u, 0u, 0u, 0u);
    if is_shared {
        let node = antumbra_descend(top.node, top.level, joint, first);
        if node == ANTUMBRA_LIT {
            return antumbra_rectangle_weight(w, w.first, w.last);
        }
        if node == ANTUMBRA_SHADOWED {
            return 0u;
        }
        if joint == ANTUMBRA_SLICE_LEVEL {
            return antumbra_mask_weight(w, antumbra_mask(node, w.z), w.first & vec2(-8));
        }
        // The window is split by this node: its children in the window's slice are looked up once.
        let z_bit = ((w.z >> below) & 1u) << 2u;
        for (var i = 0u; i < 4u; i++) {
            quadrants[i] = antumbra_child(node, i | z_bit);
        }
    }
    var sum = 0u;
    for (var y = w.first.y & -8; y <= w.last.y; y += 8) {
        for (var x = w.first.x & -8; x <= w.last.x; x += 8) {
            let tile = vec3(u32(x), u32(y), w.z);
            var start = AntumbraStart(0u, below);
            if is_shared {
                let quadrant = antumbra_octant(tile, below) & 3u;
                start.node = quadrants[quadrant];
            } else {
                start = antumbra_start(face, tile);
            }
            let node = antumbra_descend(start.node, start.level, ANTUMBRA_SLICE_LEVEL, tile);
            sum += antumbra_mask_weight(w, antumbra_mask(node, w.z), vec2(x, y));
        }
    }
    return sum;
}

// Lit texels of the cube of 2^level voxels per side, level 0 to 2, that holds a voxel of a slice node.
fn antumbra_lit_within(node: u32, voxel: vec3<u32>, level: u32) -> u32 {
    let side = 1u << level;
    let corner = voxel & vec3(7u) & vec3(~(side - 1u));
    // Rows of a cube of 4 or fewer do not cross the words' border.
    let row = ((1u << side) - 1u) << (8u * (corner.y & 3u) + corner.x);
    var square = row;
    for (var i = 1u; i < side; i++) {
        square |= row << (8u * i);
    }
    var lit = 0u;
    for (var z = corner.z; z < corner.z + side; z++) {
        let mask = antumbra_mask(node, z);
        lit += countOneBits(select(mask.x, mask.y, corner.y >= 4u) & square);
    }
    return lit;
}

// Mean visibility of the node of 2^level voxels per side that holds a voxel of a face.
fn antumbra_voxel_mean(face: AntumbraFace, voxel: vec3<u32>, level: u32) -> f32 {
    var start = antumbra_start(face, voxel);
    if level > start.level {
        start = AntumbraStart(face.root, face.log2_side);
    }
    let node = antumbra_descend(start.node, start.level, max(level, ANTUMBRA_SLICE_LEVEL), voxel);
    if level >= ANTUMBRA_SLICE_LEVEL || node <= ANTUMBRA_SHADOWED {
        return antumbra_node_mean(node);
    }
    // Divided by a power of two: exact.
    return f32(antumbra_lit_within(node, voxel, level)) * exp2(-3.0 * f32(level));
}

// The largest homogeneous box that the graph has about a voxel of the volume.
fn antumbra_cell(walk: ptr<function, AntumbraWalk>, voxel: vec3<u32>) -> AntumbraCell {
    let different = voxel ^ (*walk).described;
    let shared_level = 32u - countLeadingZeros(different.x | different.y | different.z);
    (*walk).described = voxel;
    var level = max((*walk).level, shared_level);
    var node = (*walk).nodes[level];
    while node > ANTUMBRA_SHADOWED && level > ANTUMBRA_SLICE_LEVEL {
        level -= 1u;
        node = antumbra_child(node, antumbra_octant(voxel, level));
        (*walk).nodes[level] = node;
    }
    (*walk).level = level;
    var corner = (voxel >> vec3(level)) << vec3(level);
    if node <= ANTUMBRA_SHADOWED {
        return AntumbraCell(corner, corner + (1u << level), node == ANTUMBRA_LIT);
    }
    let slices = antumbra_like_slices(node, voxel.z & 7u);
    if slices.z <= ANTUMBRA_SHADOWED {
        let first = vec3(corner.xy, corner.z + slices.x);
        return AntumbraCell(first, vec3(corner.xy + 8u, corner.z + slices.y), slices.z == ANTUMBRA_LIT);
    }
    let word = antumbra_word(slices.z + ((voxel.y >> 2u) & 1u));
    let is_lit = ((word >> (8u * (voxel.y & 3u) + (voxel.x & 7u))) & 1u) != 0u;
    return AntumbraCell(voxel, voxel + 1u, is_lit);
}

// Whether a place in a voxel of a face is lit: here that of the voxel.
fn antumbra_place_is_lit(face: AntumbraFace, voxel: vec3<u32>, place: vec3<f32>) -> bool {
    return antumbra_voxel_is_lit(face, voxel);
}
