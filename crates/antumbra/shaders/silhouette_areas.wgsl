
// Silhouettes over more than a texel: windows, means, and the boxes of walks.

// 8 x 8 texels of one slice of a level: from a corner that is a multiple of 8, on the light's own texels 2^stride apart.
struct AntumbraTile {
    corner: vec2<u32>,
    stride: u32,
    slice: AntumbraSlice,
}

// The texels of a tile to the left of an edge: bit 8y + x, rows 0 to 3 in the first word.
fn antumbra_left_mask(edge: AntumbraForm, tile: AntumbraTile) -> vec2<u32> {
    let first = antumbra_middle(tile.corner, tile.stride);
    let ends = antumbra_ends(edge, vec4(first, antumbra_middle(tile.corner + 7u, tile.stride)));
    if antumbra_is_negative(ends.xy) == antumbra_is_negative(ends.zw) {
        return vec2(select(0xffffffffu, 0u, antumbra_is_negative(ends.xy)));
    }
    let across = antumbra_shifted(edge.a, tile.stride);
    let down = antumbra_shifted(edge.b, tile.stride);
    var mask = vec2(0u);
    var row = antumbra_form_at(edge, first);
    for (var y = 0u; y < 8u; y++) {
        var value = row;
        var bits = 0u;
        for (var x = 0u; x < 8u; x++) {
            bits |= ((value.y >> 31u) ^ 1u) << x;
            value = antumbra_plus(value, across);
        }
        mask |= select(vec2(bits, 0u), vec2(0u, bits), y >= 4u) << vec2(8u * (y & 3u));
        row = antumbra_plus(row, down);
    }
    return mask;
}

fn antumbra_part_mask(part: u32, tile: AntumbraTile) -> vec2<u32> {
    if antumbra_kind(part) == ANTUMBRA_DEPTH {
        return vec2(select(0u, 0xffffffffu, tile.slice.z < antumbra_payload(part)));
    }
    var lit = array(vec2(0u), vec2(0u), vec2(0xffffffffu));
    let planes = antumbra_planes(part);
    for (var i = planes.x; i < planes.y; i++) {
        lit[i] = antumbra_left_mask(antumbra_behind(antumbra_plane(part, i, tile.slice.is_even), tile.slice), tile);
    }
    return lit[0] | (lit[1] & lit[2]);
}

// A tile's mask, given a node of 2^level of the light's texels per side that holds it. Of bits that are not wanted nothing is said.
fn antumbra_tile_mask(start: AntumbraStart, tile: AntumbraTile, wanted: vec2<u32>) -> vec2<u32> {
    let first = antumbra_middle(tile.corner, tile.stride);
    let found = antumbra_descend(start.node, start.level, ANTUMBRA_MASK_LEVEL + tile.stride, first);
    let leaf = found.node;
    if antumbra_kind(leaf) == ANTUMBRA_MASKS {
        return antumbra_turn(leaf, tile.slice.z);
    }
    if antumbra_kind(leaf) == ANTUMBRA_INNER {
        // On coarse levels alone: texel by texel.
        var mask = vec2(0u);
        for (var i = 0u; i < 64u; i++) {
            let texel = antumbra_middle(tile.corner + vec2(i & 7u, i >> 3u), tile.stride);
            let bit = select(vec2(1u, 0u), vec2(0u, 1u), i >= 32u) << vec2(i & 31u);
            if any((wanted & bit) != vec2(0u)) && antumbra_tile_is_lit(leaf, found.level, texel, tile.slice) {
                mask |= bit;
            }
        }
        return mask;
    }
    let edges = antumbra_edges(leaf);
    var left = array<vec2<u32>, 2>();
    for (var i = 0u; i < edges; i++) {
        left[i] = antumbra_left_mask(antumbra_form(antumbra_word(antumbra_payload(leaf) + i)), tile);
    }
    var mask = vec2(0u);
    for (var i = 0u; i < 1u << edges; i++) {
        let part = select(~left[0], left[0], (i & 1u) != 0u) & select(~left[1], left[1], (i & 2u) != 0u);
        if any((part & wanted) != vec2(0u)) {
            mask |= part & antumbra_part_mask(antumbra_part(leaf, edges, i), tile);
        }
    }
    return mask;
}

// Weight of a window's lit taps inside the grid.
fn antumbra_window_weight(face: AntumbraFace, w: AntumbraWindow) -> u32 {
    let first = vec2<u32>(w.first);
    let last = vec2<u32>(w.last);
    let rectangle = vec4(antumbra_middle(first, face.stride), antumbra_middle(last, face.stride));
    let slice = antumbra_slice_of(face, w.z);
    var start = antumbra_start(face, rectangle.xy);
    let is_in_cells = ANTUMBRA_MASK_LEVEL + face.stride <= start.level;
    if !is_in_cells {
        // A coarse level's tiles may be wider than cells.
        start = AntumbraStart(face.root, face.log2_side + face.stride);
    }
    // The least level whose one tile holds the whole window.
    let different = (first.x ^ last.x) | (first.y ^ last.y);
    let joint = max(32u - countLeadingZeros(different), ANTUMBRA_MASK_LEVEL) + face.stride;
    let settled = antumbra_settled(face, rectangle.xy, joint, slice.z);
    if settled == ANTUMBRA_ALL_LIT {
        return antumbra_rectangle_weight(w, w.first, w.last);
    }
    if settled == ANTUMBRA_ALL_SHADOWED {
        return 0u;
    }
    let is_shared = joint <= start.level;
    if is_shared {
        start = antumbra_descend(start.node, start.level, joint, rectangle.xy);
        if antumbra_kind(start.node) != ANTUMBRA_INNER {
            let lit = antumbra_lit_over(start.node, rectangle, slice);
            if lit.x {
                return antumbra_rectangle_weight(w, w.first, w.last);
            }
            if !lit.y {
                return 0u;
            }
        }
    }
    var sum = 0u;
    for (var y = w.first.y & -8; y <= w.last.y; y += 8) {
        for (var x = w.first.x & -8; x <= w.last.x; x += 8) {
            let corner = vec2(x, y);
            let tile = AntumbraTile(vec2<u32>(corner), face.stride, slice);
            let texel = antumbra_middle(tile.corner, face.stride);
            let known = antumbra_settled(face, texel, ANTUMBRA_MASK_LEVEL + face.stride, slice.z);
            var mask = vec2(select(0u, 0xffffffffu, known == ANTUMBRA_ALL_LIT));
            if known == ANTUMBRA_IN_DOUBT {
                if !is_shared {
                    start = antumbra_start(face, texel);
                }
                mask = antumbra_tile_mask(start, tile, antumbra_window_mask(w, corner));
            }
            sum += antumbra_mask_weight(w, mask, corner);
        }
    }
    return sum;
}

// log2 of the columns per side by which a cube's mean is measured.
const ANTUMBRA_COLUMNS_LOG2: u32 = 3u;

// Mean visibility of the cube of 2^level voxels per side that holds a voxel of a face: over the lit length of each of its columns up
// to 8 x 8, and of wider ones over that of the 64 in the middles of its parts.
fn antumbra_voxel_mean(face: AntumbraFace, voxel: vec3<u32>, level: u32) -> f32 {
    var start = antumbra_start(face, voxel.xy);
    if level > start.level {
        start = AntumbraStart(face.root, face.log2_side);
    }
    let spread = antumbra_slices(face);
    let first = (voxel.z >> level) << level;
    let near = antumbra_settled(face, voxel.xy, level, first);
    if near != ANTUMBRA_IN_DOUBT && near == antumbra_settled(face, voxel.xy, level, first + (1u << level) - 1u) {
        return f32(near == ANTUMBRA_ALL_LIT);
    }
    let tile = antumbra_descend(start.node, start.level, level, voxel.xy);
    var log2_columns = min(level, ANTUMBRA_COLUMNS_LOG2);
    if antumbra_kind(tile.node) == ANTUMBRA_DEPTH {
        log2_columns = 0u;
    }
    let stride = level - log2_columns;
    let corner = (voxel.xy >> vec2(level)) << vec2(log2_columns);
    var lit = 0u;
    for (var i = 0u; i < 1u << (2u * log2_columns); i++) {
        let column = corner + vec2(i & ((1u << log2_columns) - 1u), i >> log2_columns);
        let texel = antumbra_middle(column, stride);
        let leaf = antumbra_descend(tile.node, tile.level, 0u, texel).node;
        let depth = antumbra_depth(leaf, texel, spread);
        lit += min(max(depth, first) - first, 1u << level);
    }
    // No more bits than single precision holds; divided by a power of two.
    let bits = 2u * log2_columns + level;
    let dropped = max(bits, 24u) - 24u;
    return f32(lit >> dropped) * bitcast<f32>((127u + dropped - bits) << 23u);
}

// The box about a voxel of the volume in which all are alike: squares of the top grid before or behind all that they hold, or a column.
fn antumbra_cell(walk: ptr<function, AntumbraWalk>, voxel: vec3<u32>) -> AntumbraCell {
    let log2_side = (*walk).log2_side;
    let shift = antumbra_bounds_shift(log2_side);
    let finest = log2_side - (*walk).grid_log2 - 1u;
    var is_found = false;
    var cell: AntumbraCell;
    for (var level = finest; ANTUMBRA_TOP_GRID && level <= log2_side; level++) {
        let square = voxel.xy >> vec2(level);
        let bounds = antumbra_square((*walk).grid, log2_side - level, log2_side, voxel.xy);
        let settled = antumbra_settled_by(bounds, voxel.z, log2_side);
        if settled == ANTUMBRA_IN_DOUBT {
            break;
        }
        is_found = true;
        let corner = square << vec2(level);
        let is_lit = settled == ANTUMBRA_ALL_LIT;
        let first_slice = select((bounds >> 16u) << shift, 0u, is_lit);
        let end_slice = select(1u << log2_side, (bounds & 0xffffu) << shift, is_lit);
        cell = AntumbraCell(vec3(corner, first_slice), vec3(corner + (1u << level), end_slice), is_lit);
    }
    if is_found {
        return cell;
    }
    return antumbra_column(walk, voxel);
}

// A column about a voxel of the volume that no depth ends, before them or behind them: as wide as the quadtree allows.
fn antumbra_column(walk: ptr<function, AntumbraWalk>, voxel: vec3<u32>) -> AntumbraCell {
    let different = voxel ^ (*walk).described;
    let shared_level = 32u - countLeadingZeros(different.x | different.y);
    (*walk).described = voxel;
    var level = max((*walk).level, shared_level);
    var tile = (*walk).nodes[level];
    while antumbra_kind(tile) == ANTUMBRA_INNER {
        level -= 1u;
        let quadrant = ((voxel.x >> level) & 1u) | (((voxel.y >> level) & 1u) << 1u);
        tile = antumbra_word(antumbra_payload(tile) + quadrant);
        (*walk).nodes[level] = tile;
    }
    (*walk).level = level;
    let spread = AntumbraSpread((*walk).log2_side, (*walk).slices);
    let slice = AntumbraSlice(voxel.z, spread.table == 0u, antumbra_least_behind(spread, voxel.z));
    while level > 0u {
        let first = (voxel.xy >> vec2(level)) << vec2(level);
        let lit = antumbra_lit_over(tile, vec4(first, first + ((1u << level) - 1u)), slice);
        if lit.x || !lit.y {
            break;
        }
        level -= 1u;
    }
    let corner = (voxel.xy >> vec2(level)) << vec2(level);
    var bounds = vec2(0u);
    if level == 0u {
        bounds = vec2(antumbra_depth(tile, voxel.xy, spread));
    } else {
        bounds = antumbra_bounds(tile, vec4(corner, corner + ((1u << level) - 1u)), spread);
    }
    let end = corner + (1u << level);
    if voxel.z < bounds.x {
        return AntumbraCell(vec3(corner, 0u), vec3(end, bounds.x), true);
    }
    return AntumbraCell(vec3(corner, bounds.y), vec3(end, 1u << spread.log2), false);
}
