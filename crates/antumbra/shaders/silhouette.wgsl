// Our own encoding, `silhouette`: a quadtree over the shadow map whose leaves are cut by the casters' edges and bounded by their
// planes. With `silhouette_areas` it brings the same functions as `dag8`: antumbra_voxel_is_lit, antumbra_window_weight,
// antumbra_voxel_mean, antumbra_cell.
//
//   form        four words: v(x, y) = a x + b y + c over texels, an edge or a plane; c has 56 bits, then a shift
//   reference   what it is in the upper three bits, and a depth, a form's number or a node's word in the others

// The depth itself.
const ANTUMBRA_DEPTH: u32 = 0u;
// v >> shift, in slices or in lattice steps.
const ANTUMBRA_PLANE: u32 = 1u;
// Two planes. By the first word's upper bits: a wedge, max(first, min(first's deep one, second)), the nearer one, or the farther one.
const ANTUMBRA_PAIR: u32 = 2u;
const ANTUMBRA_WEDGE: u32 = 0u;
const ANTUMBRA_NEARER: u32 = 1u;
// In a pair's words: the deep one is meant.
const ANTUMBRA_DEEP_BIT: u32 = 0x10000000u;
// Four references, x fastest.
const ANTUMBRA_INNER: u32 = 3u;
// An edge, and references to its right and its left.
const ANTUMBRA_CUT: u32 = 4u;
// Two edges, and four references: bit i of their order is set to the left of edge i.
const ANTUMBRA_CROSS: u32 = 5u;
// Depths by masks, 8 x 8 texels: how many, the first, bits of the texels' turns, and how far the other depths lie behind the first.
const ANTUMBRA_MASKS: u32 = 6u;
// A plane half a slice behind its deepest point within each texel.
const ANTUMBRA_DEEP: u32 = 7u;
// log2 of the texels per side of a mask.
const ANTUMBRA_MASK_LEVEL: u32 = 3u;
const ANTUMBRA_FIRST_FORM: u32 = 8u;

fn antumbra_kind(reference: u32) -> u32 {
    return reference >> 29u;
}

fn antumbra_payload(reference: u32) -> u32 {
    return reference & 0x1fffffffu;
}

// Whole numbers of 64 bits, two's complement: low word, high word.
fn antumbra_plus(p: vec2<u32>, q: vec2<u32>) -> vec2<u32> {
    let low = p.x + q.x;
    return vec2(low, p.y + q.y + select(0u, 1u, low < p.x));
}

// Numbers of 32 bits, shifted left by less than 32: whole ones, and ones with a sign.
fn antumbra_lifted(number: u32, shift: u32) -> vec2<u32> {
    return vec2(number << shift, select(number >> (32u - shift), 0u, shift == 0u));
}

fn antumbra_shifted(number: i32, shift: u32) -> vec2<u32> {
    let high = number >> select(32u - shift, 31u, shift == 0u);
    return vec2(bitcast<u32>(number) << shift, bitcast<u32>(high));
}

fn antumbra_is_negative(number: vec2<u32>) -> bool {
    return (number.y >> 31u) != 0u;
}

struct AntumbraForm {
    a: i32,
    b: i32,
    c: vec2<u32>,
    shift: u32,
    // Whether it is a plane's deep one.
    is_deep: bool,
}

// How a light's slices follow one another.
struct AntumbraSpread {
    // log2 of how many.
    log2: u32,
    // Where the table of the lattice steps is at which they begin; 0 where they are even, and planes count in them.
    table: u32,
}

// One of the light's own slices.
struct AntumbraSlice {
    z: u32,
    is_even: bool,
    // The least whole values with which a plane, and a deep one, lie behind it, so that it is lit.
    least_behind: vec2<u32>,
}

fn antumbra_form(number: u32) -> AntumbraForm {
    let words = antumbra_four_words(ANTUMBRA_FIRST_FORM + 4u * number);
    // The last word's low 24 bits are c's high ones, with their sign.
    let high = bitcast<i32>(words.w << 8u) >> 8u;
    return AntumbraForm(
        bitcast<i32>(words.x), bitcast<i32>(words.y), vec2(words.z, bitcast<u32>(high)), words.w >> 24u, false);
}

// A form's value at a texel.
fn antumbra_form_at(form: AntumbraForm, texel: vec2<u32>) -> vec2<u32> {
    // Factors in pieces of 11, 11 and 10 bits: their products with texels below 2^20, and sums of two of them, fit 32 bits.
    let a = vec2(u32(form.a) & 0x7ffu, (u32(form.a) >> 11u) & 0x7ffu);
    let b = vec2(u32(form.b) & 0x7ffu, (u32(form.b) >> 11u) & 0x7ffu);
    let low = a * texel.x + b * texel.y;
    let high = (form.a >> 22u) * i32(texel.x) + (form.b >> 22u) * i32(texel.y);
    let sum = antumbra_plus(form.c, vec2(low.x, 0u));
    return antumbra_plus(antumbra_plus(sum, vec2(low.y << 11u, low.y >> 21u)), antumbra_shifted(high, 22u));
}

fn antumbra_slices(face: AntumbraFace) -> AntumbraSpread {
    return AntumbraSpread(face.log2_side + face.stride, face.slices);
}

fn antumbra_least_behind(spread: AntumbraSpread, z: u32) -> vec2<u32> {
    if spread.table == 0u {
        return vec2(z + 1u);
    }
    let begin = antumbra_table(spread.table + z);
    let before = antumbra_table(spread.table + max(z, 1u) - 1u);
    return vec2(begin, before + ((begin - before) >> 1u));
}

// A slice of a face, given as its level counts them.
fn antumbra_slice_of(face: AntumbraFace, z: u32) -> AntumbraSlice {
    let own = antumbra_middle(vec2(z), face.stride).x;
    return AntumbraSlice(own, face.slices == 0u, antumbra_least_behind(antumbra_slices(face), own));
}

// The deep one of a plane, within half a slice: the deepest point of each texel.
fn antumbra_deep(form: AntumbraForm, is_even: bool) -> AntumbraForm {
    let a = u32(abs(form.a));
    let b = u32(abs(form.b));
    let one = 1u << form.shift;
    // Half of a sum that may need one more bit.
    let rise = (a >> 1u) + (b >> 1u) + (a & b & 1u);
    let c = antumbra_plus(form.c, vec2(rise + select(one, (one >> 1u) + (one >> 8u), is_even), 0u));
    return AntumbraForm(form.a, form.b, c, form.shift, true);
}

// The edge to whose left are the texels at which a plane lies behind a slice, so that it is lit.
fn antumbra_behind(plane: AntumbraForm, slice: AntumbraSlice) -> AntumbraForm {
    let least = select(slice.least_behind.x, slice.least_behind.y, plane.is_deep);
    let less = antumbra_plus(~antumbra_lifted(least, plane.shift), vec2(1u, 0u));
    return AntumbraForm(plane.a, plane.b, antumbra_plus(plane.c, less), plane.shift, false);
}

fn antumbra_is_left(edge: AntumbraForm, texel: vec2<u32>) -> bool {
    return !antumbra_is_negative(antumbra_form_at(edge, texel));
}

// Descends from a tile of 2^from texels per side towards a texel, until a tile is no inner node or has 2^to per side.
fn antumbra_descend(start: u32, from_level: u32, to_level: u32, texel: vec2<u32>) -> AntumbraStart {
    var tile = start;
    var level = from_level;
    while antumbra_kind(tile) == ANTUMBRA_INNER && level > to_level {
        level -= 1u;
        let quadrant = ((texel.x >> level) & 1u) | (((texel.y >> level) & 1u) << 1u);
        tile = antumbra_word(antumbra_payload(tile) + quadrant);
    }
    return AntumbraStart(tile, level);
}

// How many edges cut a leaf.
fn antumbra_edges(leaf: u32) -> u32 {
    let kind = antumbra_kind(leaf);
    return select(0u, kind - ANTUMBRA_CUT + 1u, kind == ANTUMBRA_CUT || kind == ANTUMBRA_CROSS);
}

// The i-th part of a leaf that so many edges cut.
fn antumbra_part(leaf: u32, edges: u32, i: u32) -> u32 {
    if edges == 0u {
        return leaf;
    }
    return antumbra_word(antumbra_payload(leaf) + edges + i);
}

// The part of a leaf that holds a texel.
fn antumbra_part_at(leaf: u32, texel: vec2<u32>) -> u32 {
    let edges = antumbra_edges(leaf);
    var sides = 0u;
    for (var i = 0u; i < edges; i++) {
        sides |= u32(antumbra_is_left(antumbra_form(antumbra_word(antumbra_payload(leaf) + i)), texel)) << i;
    }
    return antumbra_part(leaf, edges, sides);
}

// A part is max(plane 0, min(plane 1, plane 2)). It has the planes from x to below y; others are before or behind everything, the last one behind.
fn antumbra_planes(part: u32) -> vec2<u32> {
    if antumbra_kind(part) != ANTUMBRA_PAIR {
        return vec2(0u, 1u);
    }
    let pair = antumbra_kind(antumbra_word(antumbra_payload(part)));
    return vec2(select(0u, 1u, pair == ANTUMBRA_NEARER), select(2u, 3u, pair <= ANTUMBRA_NEARER));
}

fn antumbra_plane(part: u32, i: u32, is_even: bool) -> AntumbraForm {
    var number = antumbra_payload(part);
    var is_deep = antumbra_kind(part) == ANTUMBRA_DEEP;
    if antumbra_kind(part) == ANTUMBRA_PAIR {
        let first = antumbra_word(number);
        let is_wedge = antumbra_kind(first) == ANTUMBRA_WEDGE;
        var word = i;
        if is_wedge {
            word = i >> 1u;
        } else if antumbra_kind(first) == ANTUMBRA_NEARER {
            word = i - 1u;
        }
        let plane = antumbra_word(number + word);
        is_deep = (plane & ANTUMBRA_DEEP_BIT) != 0u || (is_wedge && i == 1u);
        number = plane & (ANTUMBRA_DEEP_BIT - 1u);
    }
    let form = antumbra_form(number);
    if is_deep {
        return antumbra_deep(form, is_even);
    }
    return form;
}

// A tile of masks: its first word, where its masks begin, one for each bit of texels' turns, and where the differences of its depths do.
struct AntumbraTurns {
    head: u32,
    masks: u32,
    steps: u32,
}

fn antumbra_turns(tile: u32) -> AntumbraTurns {
    let at = antumbra_payload(tile);
    let head = antumbra_word(at);
    return AntumbraTurns(head, at + 1u, at + 1u + 2u * (32u - countLeadingZeros(antumbra_turn_count(head))));
}

// How many depths there are.
fn antumbra_turn_count(head: u32) -> u32 {
    return (head >> 20u) & 0x7fu;
}

// The depth of a turn.
fn antumbra_depth_of_turn(turns: AntumbraTurns, turn: u32) -> u32 {
    let first = turns.head & 0xfffffu;
    if turn == 0u {
        return first;
    }
    // 8, 16 or 32 bits for each difference.
    let width = turns.head >> 27u;
    let bit = (turn - 1u) << (3u + width);
    let most = 0xffffffffu >> (32u - (8u << width));
    return first + ((antumbra_word(turns.steps + (bit >> 5u)) >> (bit & 31u)) & most);
}

// The first shadowed slice at a texel of a tile of masks, of N slices.
fn antumbra_turn_depth(tile: u32, texel: vec2<u32>, slices: u32) -> u32 {
    let turns = antumbra_turns(tile);
    let bit = 8u * (texel.y & 3u) + (texel.x & 7u);
    var turn = 0u;
    for (var mask = turns.masks; mask < turns.steps; mask += 2u) {
        turn |= ((antumbra_word(mask + ((texel.y >> 2u) & 1u)) >> bit) & 1u) << ((mask - turns.masks) >> 1u);
    }
    if turn == antumbra_turn_count(turns.head) {
        return slices;
    }
    return antumbra_depth_of_turn(turns, turn);
}

// The texels of a tile of masks that are lit in slice z: those whose turn is not before the first depth behind it.
fn antumbra_turn(tile: u32, z: u32) -> vec2<u32> {
    let turns = antumbra_turns(tile);
    var turn = 0u;
    let count = antumbra_turn_count(turns.head);
    while turn < count && antumbra_depth_of_turn(turns, turn) <= z {
        turn++;
    }
    // From the highest bit on: those that were less, and those that were the same.
    var before = vec2(0u);
    var same = vec2(0xffffffffu);
    for (var mask = turns.steps; mask > turns.masks; mask -= 2u) {
        let bits = vec2(antumbra_word(mask - 2u), antumbra_word(mask - 1u));
        let is_set = ((turn >> ((mask - turns.masks - 2u) >> 1u)) & 1u) != 0u;
        before |= select(vec2(0u), same & ~bits, is_set);
        same &= select(~bits, bits, is_set);
    }
    return ~before;
}

// Whether a slice of the face is lit at one of its texels, below a tile of 2^level texels per side.
fn antumbra_tile_is_lit(start: u32, level: u32, texel: vec2<u32>, slice: AntumbraSlice) -> bool {
    let part = antumbra_part_at(antumbra_descend(start, level, 0u, texel).node, texel);
    if antumbra_kind(part) == ANTUMBRA_DEPTH {
        return slice.z < antumbra_payload(part);
    }
    if antumbra_kind(part) == ANTUMBRA_MASKS {
        return slice.z < antumbra_turn_depth(part, texel, slice.z + 1u);
    }
    // Before the first plane, or before both others.
    let planes = antumbra_planes(part);
    for (var i = planes.x; i < planes.y; i++) {
        let is_before = antumbra_is_left(antumbra_behind(antumbra_plane(part, i, slice.is_even), slice), texel);
        if is_before == (i == 0u) {
            return is_before;
        }
    }
    return planes.y > 1u;
}

// The first shadowed slice of a plane's value, 0 to N.
fn antumbra_depth_of(v: vec2<u32>, plane: AntumbraForm, spread: AntumbraSpread) -> u32 {
    let slices = 1u << spread.log2;
    if antumbra_is_negative(v) {
        return 0u;
    }
    if (v.y >> plane.shift) != 0u {
        return slices;
    }
    let value = (v.x >> plane.shift) | select(v.y << (32u - plane.shift), 0u, plane.shift == 0u);
    if spread.table == 0u {
        return min(value, slices);
    }
    // How many slices it lies behind.
    var depth = 0u;
    for (var more = slices; more > 0u; more >>= 1u) {
        if depth + more <= slices && antumbra_table(spread.table + depth + more - 1u) <= value {
            depth += more;
        }
    }
    if plane.is_deep && depth < slices {
        depth += select(0u, 1u, antumbra_least_behind(spread, depth).y <= value);
    }
    return depth;
}

// The first shadowed slice at a texel of a leaf, 0 to N.
fn antumbra_depth(leaf: u32, texel: vec2<u32>, spread: AntumbraSpread) -> u32 {
    let part = antumbra_part_at(leaf, texel);
    let at = antumbra_payload(part);
    if antumbra_kind(part) == ANTUMBRA_DEPTH {
        return at;
    }
    if antumbra_kind(part) == ANTUMBRA_MASKS {
        return antumbra_turn_depth(part, texel, 1u << spread.log2);
    }
    var depths = vec3(0u, 0u, 0xffffffffu);
    let planes = antumbra_planes(part);
    for (var i = planes.x; i < planes.y; i++) {
        let plane = antumbra_plane(part, i, spread.table == 0u);
        depths[i] = antumbra_depth_of(antumbra_form_at(plane, texel), plane, spread);
    }
    return max(depths.x, min(depths.y, depths.z));
}

// Where descents to one of the face's own texels begin: a cell of the top grid (after Kämpe et al. 2015, section 4), or the root.
fn antumbra_start(face: AntumbraFace, texel: vec2<u32>) -> AntumbraStart {
    let log2_side = face.log2_side + face.stride;
    if !ANTUMBRA_TOP_GRID {
        return AntumbraStart(face.root, log2_side);
    }
    // Behind all bounds.
    let cells = face.grid + antumbra_squares_before(face.grid_log2 + 2u);
    let cell = texel >> vec2(log2_side - face.grid_log2);
    return AntumbraStart(antumbra_table(cells + (cell.y << face.grid_log2) + cell.x), log2_side - face.grid_log2);
}

// The top grid begins with bounds, one for each square of a quadtree: how many squares there are that are wider than those of which there
// are 2^log2 per side.
fn antumbra_squares_before(log2: u32) -> u32 {
    return 0x55555555u & ((1u << (2u * log2)) - 1u);
}

// The bounds of the square that holds a texel, of 2^log2 per side on a face of 2^log2_side texels.
fn antumbra_square(grid: u32, log2: u32, log2_side: u32, texel: vec2<u32>) -> u32 {
    let square = texel >> vec2(log2_side - log2);
    return antumbra_table(grid + antumbra_squares_before(log2) + (square.y << log2) + square.x);
}

const ANTUMBRA_IN_DOUBT: u32 = 0u;
const ANTUMBRA_ALL_LIT: u32 = 1u;
const ANTUMBRA_ALL_SHADOWED: u32 = 2u;

// What the top grid knows of one of the face's own slices, about a texel: of the square of 2^level texels per side, or the least that there is.
fn antumbra_settled(face: AntumbraFace, texel: vec2<u32>, level: u32, z: u32) -> u32 {
    if !ANTUMBRA_TOP_GRID {
        return ANTUMBRA_IN_DOUBT;
    }
    let log2_side = face.log2_side + face.stride;
    // Squares are quarters of cells and wider.
    let log2 = min(log2_side - level, face.grid_log2 + 1u);
    return antumbra_settled_by(antumbra_square(face.grid, log2, log2_side, texel), z, log2_side);
}

// The same by bounds, of a face of 2^log2_side texels per side.
fn antumbra_settled_by(bounds: u32, z: u32, log2_side: u32) -> u32 {
    let depth = z >> antumbra_bounds_shift(log2_side);
    if depth < (bounds & 0xffffu) {
        return ANTUMBRA_ALL_LIT;
    }
    return select(ANTUMBRA_IN_DOUBT, ANTUMBRA_ALL_SHADOWED, depth >= (bounds >> 16u));
}

// Bits by which bounds are shifted, so that all slices fit into 16.
fn antumbra_bounds_shift(log2_side: u32) -> u32 {
    return max(log2_side, 15u) - 15u;
}

// The light's own texels, or slices, in the middle of a coarse level's.
fn antumbra_middle(c: vec2<u32>, stride: u32) -> vec2<u32> {
    return (c << vec2(stride)) + ((1u << stride) >> 1u);
}

// Whether a voxel of a face is lit; its indices are less than the face's side.
fn antumbra_voxel_is_lit(face: AntumbraFace, voxel: vec3<u32>) -> bool {
    let texel = antumbra_middle(voxel.xy, face.stride);
    let slice = antumbra_slice_of(face, voxel.z);
    let settled = antumbra_settled(face, texel, 0u, slice.z);
    if settled != ANTUMBRA_IN_DOUBT {
        return settled == ANTUMBRA_ALL_LIT;
    }
    let start = antumbra_start(face, texel);
    return antumbra_tile_is_lit(start.node, start.level, texel, slice);
}

// A form's value at a place, so far from its texel's middle, less a whole number: small where its sign is in doubt.
fn antumbra_value_less(form: AntumbraForm, texel: vec2<u32>, rest: vec2<f32>, less: vec2<u32>) -> f32 {
    let whole = antumbra_plus(antumbra_form_at(form, texel), antumbra_plus(~less, vec2(1u, 0u)));
    let size = select(whole, antumbra_plus(~whole, vec2(1u, 0u)), antumbra_is_negative(whole));
    let value = f32(size.y) * 4294967296.0 + f32(size.x);
    return select(value, -value, antumbra_is_negative(whole)) + dot(vec2(f32(form.a), f32(form.b)), rest);
}

// Whether a place in a voxel of a face is lit, by edges and planes there: so far from the texel's middle sideways, such a share of the slice behind
// its beginning.
fn antumbra_place_is_lit(face: AntumbraFace, voxel: vec3<u32>, place: vec3<f32>) -> bool {
    let start = antumbra_start(face, voxel.xy);
    let leaf = antumbra_descend(start.node, start.level, 0u, voxel.xy).node;
    let edges = antumbra_edges(leaf);
    var sides = 0u;
    for (var i = 0u; i < edges; i++) {
        let edge = antumbra_form(antumbra_word(antumbra_payload(leaf) + i));
        sides |= u32(antumbra_value_less(edge, voxel.xy, place.xy, vec2(0u)) >= 0.0) << i;
    }
    let part = antumbra_part(leaf, edges, sides);
    if antumbra_kind(part) == ANTUMBRA_DEPTH {
        return voxel.z < antumbra_payload(part);
    }
    if antumbra_kind(part) == ANTUMBRA_MASKS {
        return voxel.z < antumbra_turn_depth(part, voxel.xy, voxel.z + 1u);
    }
    // The values with which planes lie behind a whole slice are those of its end.
    let spread = antumbra_slices(face);
    let end = antumbra_least_behind(spread, voxel.z);
    let width = select(antumbra_least_behind(spread, 1u) - end, end - antumbra_least_behind(spread, max(voxel.z, 1u) - 1u), voxel.z > 0u);
    let planes = antumbra_planes(part);
    for (var i = planes.x; i < planes.y; i++) {
        let plane = antumbra_plane(part, i, face.slices == 0u);
        let least = select(vec2(end.x, width.x), vec2(end.y, width.y), plane.is_deep);
        let more = place.z * f32(least.y) * f32(1u << plane.shift);
        let value = antumbra_value_less(plane, voxel.xy, place.xy, antumbra_begin(least, plane.shift));
        let is_before = value >= more;
        if is_before == (i == 0u) {
            return is_before;
        }
    }
    return planes.y > 1u;
}

// The value at the beginning of a slice whose end and width are given, which may be negative.
fn antumbra_begin(slice: vec2<u32>, shift: u32) -> vec2<u32> {
    let width = antumbra_lifted(slice.y, shift);
    return antumbra_plus(antumbra_lifted(slice.x, shift), antumbra_plus(~width, vec2(1u, 0u)));
}

// Which sides of a leaf's edges a rectangle of texels touches, both ends in it: 1 right, 2 left.
fn antumbra_touched(leaf: u32, edges: u32, rectangle: vec4<u32>) -> vec2<u32> {
    var touched = vec2(1u);
    for (var i = 0u; i < edges; i++) {
        let edge = antumbra_form(antumbra_word(antumbra_payload(leaf) + i));
        let ends = antumbra_ends(edge, rectangle);
        touched[i] = select(2u, 1u, antumbra_is_negative(ends.xy)) | select(2u, 1u, antumbra_is_negative(ends.zw));
    }
    return touched;
}

fn antumbra_is_touched(part: u32, touched: vec2<u32>) -> bool {
    return all(((touched >> (vec2(part, part >> 1u) & vec2(1u))) & vec2(1u)) != vec2(0u));
}

// Whether all, and whether some, of a rectangle of a leaf's texels are surely lit in a slice, or may be.
fn antumbra_lit_over(leaf: u32, rectangle: vec4<u32>, slice: AntumbraSlice) -> vec2<bool> {
    if antumbra_kind(leaf) == ANTUMBRA_MASKS {
        return vec2(false, true);
    }
    let edges = antumbra_edges(leaf);
    let touched = antumbra_touched(leaf, edges, rectangle);
    var lit = vec2(true, false);
    for (var i = 0u; i < 1u << edges; i++) {
        if !antumbra_is_touched(i, touched) {
            continue;
        }
        let part = antumbra_part(leaf, edges, i);
        var of_planes = array(vec2(false), vec2(false), vec2(true));
        if antumbra_kind(part) == ANTUMBRA_DEPTH {
            of_planes[0] = vec2(slice.z < antumbra_payload(part));
        } else {
            let planes = antumbra_planes(part);
            for (var j = planes.x; j < planes.y; j++) {
                let ends = antumbra_ends(antumbra_behind(antumbra_plane(part, j, slice.is_even), slice), rectangle);
                of_planes[j] = vec2(!antumbra_is_negative(ends.xy), !antumbra_is_negative(ends.zw));
            }
        }
        let of_part = of_planes[0] | (of_planes[1] & of_planes[2]);
        lit = vec2(lit.x && of_part.x, lit.y || of_part.y);
    }
    return lit;
}

// The least and the greatest first shadowed slice over a rectangle of a leaf's texels, both ends in it; wider of masks.
fn antumbra_bounds(leaf: u32, rectangle: vec4<u32>, spread: AntumbraSpread) -> vec2<u32> {
    let slices = 1u << spread.log2;
    if antumbra_kind(leaf) == ANTUMBRA_MASKS {
        return vec2(0u, slices);
    }
    let edges = antumbra_edges(leaf);
    let touched = antumbra_touched(leaf, edges, rectangle);
    var bounds = vec2(slices, 0u);
    for (var i = 0u; i < 1u << edges; i++) {
        if !antumbra_is_touched(i, touched) {
            continue;
        }
        let part = antumbra_part(leaf, edges, i);
        var depths = array(vec2(0u), vec2(0u), vec2(0xffffffffu));
        if antumbra_kind(part) == ANTUMBRA_DEPTH {
            depths[0] = vec2(antumbra_payload(part));
        } else {
            let planes = antumbra_planes(part);
            for (var j = planes.x; j < planes.y; j++) {
                let plane = antumbra_plane(part, j, spread.table == 0u);
                let ends = antumbra_ends(plane, rectangle);
                depths[j] = vec2(antumbra_depth_of(ends.xy, plane, spread), antumbra_depth_of(ends.zw, plane, spread));
            }
        }
        let depth = max(depths[0], min(depths[1], depths[2]));
        bounds = vec2(min(bounds.x, depth.x), max(bounds.y, depth.y));
    }
    return bounds;
}

// The least and the greatest value of a form over a rectangle.
fn antumbra_ends(form: AntumbraForm, rectangle: vec4<u32>) -> vec4<u32> {
    let is_falling = vec2(form.a, form.b) < vec2(0i);
    let least = antumbra_form_at(form, select(rectangle.xy, rectangle.zw, is_falling));
    return vec4(least, antumbra_form_at(form, select(rectangle.zw, rectangle.xy, is_falling)));
}
