// The node encoding: papers' own, `dag8` (Sintorn et al. 2014). What the other modules ask of an encoding is what
// stands here; another one brings the same functions.
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
