// Lists what is left to draw into each side of each cluster's maps, and says so to the draws: opaque items from the list's begin,
// cut-out ones from its end.

@group(0) @binding(0) var<storage, read> grid: CullGrid;
@group(0) @binding(1) var<storage, read> chunk: Chunk;
@group(0) @binding(2) var<storage, read> clusters: array<Cluster>;
@group(0) @binding(3) var<storage, read> triangles: array<vec2<u32>>;
@group(0) @binding(4) var<storage, read> refs: array<u32>;
@group(0) @binding(5) var<storage, read> always: array<u32>;
@group(0) @binding(6) var<storage, read> survivors: array<u32>;
@group(0) @binding(7) var<storage, read_write> lists: array<u32>;
// By cluster and side, three indirect draws: of opaque items, of cut-out ones, and of what clears the side first. Each is a number
// of vertices, instances, first vertex, first instance.
@group(0) @binding(8) var<storage, read_write> draws: array<atomic<u32>>;

@group(0) @binding(9) var<storage, read> stale: array<u32>;

var<workgroup> opaque_sums: array<u32, 64>;
var<workgroup> cut_out_sums: array<u32, 64>;
var<workgroup> opaque_first: u32;
var<workgroup> cut_out_first: u32;

// Whether an item casts shadows here, and is cut out.
fn kind_of(item: u32, is_of_movers: u32) -> vec2<bool> {
    var triangle = item;
    if grid.binning == CUT {
        triangle = item - grid.most_refs;
        if item < grid.most_refs {
            triangle = refs[item];
        }
    }
    let info = triangles[triangle].x;
    let casts = (info & CASTS_NOTHING) == 0u && (is_of_movers == 0u || (info & MOVES) != 0u);
    return vec2(casts, (info & IS_CUT_OUT) != 0u);
}

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let side = group.y;
    let word = group.x * 64u + lane;
    // Of the whole workgroup.
    if stale[side] == 0u {
        return;
    }
    let is_of_movers = clusters[chunk.first + side / chunk.sides].is_of_movers;
    var opaque = 0u;
    var cut_out = 0u;
    if word < grid.item_words {
        for (var left = survivors[side * grid.item_words + word] | always[word]; left != 0u; left &= left - 1u) {
            let bit = countTrailingZeros(left);
            let kind = kind_of(32u * word + bit, is_of_movers);
            if kind.x {
                opaque |= select(1u << bit, 0u, kind.y);
                cut_out |= select(0u, 1u << bit, kind.y);
            }
        }
    }
    opaque_sums[lane] = countOneBits(opaque);
    cut_out_sums[lane] = countOneBits(cut_out);
    workgroupBarrier();
    for (var step = 1u; step < 64u; step *= 2u) {
        var others = vec2(0u);
        if lane >= step {
            others = vec2(opaque_sums[lane - step], cut_out_sums[lane - step]);
        }
        workgroupBarrier();
        opaque_sums[lane] += others.x;
        cut_out_sums[lane] += others.y;
        workgroupBarrier();
    }
    if lane == 63u {
        let at = 12u * (chunk.first * chunk.sides + side);
        opaque_first = atomicAdd(&draws[at], VERTICES * opaque_sums[63]) / VERTICES;
        cut_out_first = atomicAdd(&draws[at + 4u], VERTICES * cut_out_sums[63]) / VERTICES;
        atomicStore(&draws[at + 8u], 3u);
    }
    workgroupBarrier();
    let most = 32u * grid.item_words;
    var at = side * most + opaque_first + opaque_sums[lane] - countOneBits(opaque);
    for (var left = opaque; left != 0u; left &= left - 1u) {
        lists[at] = 32u * word + countTrailingZeros(left);
        at += 1u;
    }
    at = (side + 1u) * most - 1u - (cut_out_first + cut_out_sums[lane] - countOneBits(cut_out));
    for (var left = cut_out; left != 0u; left &= left - 1u) {
        lists[at] = 32u * word + countTrailingZeros(left);
        at -= 1u;
    }
}
