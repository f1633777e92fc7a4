// Where each cell's triangles begin: sums of the counts before it. Three steps: sums of blocks of 1024 cells, sums of the blocks
// before each, and those within blocks.

@group(0) @binding(0) var<storage, read> grid: CullGrid;
@group(0) @binding(1) var<storage, read> counts: array<u32>;
@group(0) @binding(2) var<storage, read_write> blocks: array<u32>;
// One more than there are cells: the last says how many triangles all have.
@group(0) @binding(3) var<storage, read_write> begins: array<u32>;

const BLOCK: u32 = 1024u;
// Sums stop here, far beyond all room: what has none is culled by nothing.
const MOST: u32 = 0x3fffffffu;

var<workgroup> sums: array<u32, 256>;

fn count_of(cell: u32) -> u32 {
    if cell < grid.cells {
        return min(counts[cell], MOST / 4u);
    }
    return 0u;
}

// The sum of the values before this lane's (Hillis and Steele 1986); `sums[255]` is that of all.
fn before(lane: u32, own: u32) -> u32 {
    sums[lane] = min(own, MOST);
    workgroupBarrier();
    for (var step = 1u; step < 256u; step *= 2u) {
        var other = 0u;
        if lane >= step {
            other = sums[lane - step];
        }
        workgroupBarrier();
        sums[lane] = min(sums[lane] + other, MOST);
        workgroupBarrier();
    }
    if lane == 0u {
        return 0u;
    }
    return sums[lane - 1u];
}

@compute @workgroup_size(256)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    if STEP == 1u {
        // One workgroup for all blocks.
        let all = (grid.cells + BLOCK) / BLOCK;
        var carried = 0u;
        for (var first = 0u; first < all; first += 256u) {
            let at = first + lane;
            var own = 0u;
            if at < all {
                own = blocks[at];
            }
            let sum = min(carried + before(lane, own), MOST);
            if at < all {
                blocks[at] = sum;
            }
            carried = min(carried + sums[255], MOST);
            workgroupBarrier();
        }
        return;
    }
    let cell = group.x * BLOCK + 4u * lane;
    let own = vec4(count_of(cell), count_of(cell + 1u), count_of(cell + 2u), count_of(cell + 3u));
    let sum = before(lane, own.x + own.y + own.z + own.w);
    if STEP == 0u {
        if lane == 0u {
            blocks[group.x] = sums[255];
        }
        return;
    }
    var at = min(blocks[group.x] + sum, MOST);
    for (var i = 0u; i < 4u; i++) {
        if cell + i <= grid.cells {
            begins[cell + i] = at;
        }
        at = min(at + own[i], MOST);
    }
}
