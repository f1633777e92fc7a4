// Sets the bits of the items in marked cells, for each side of a cluster's maps that the cell may appear in.

@group(0) @binding(0) var<storage, read> grid: CullGrid;
@group(0) @binding(1) var<storage, read> chunk: Chunk;
@group(0) @binding(2) var<storage, read> clusters: array<Cluster>;
@group(0) @binding(3) var<storage, read> occupied: array<u32>;
@group(0) @binding(4) var<storage, read> begins: array<u32>;
@group(0) @binding(5) var<storage, read> refs: array<u32>;
@group(0) @binding(6) var<storage, read> marks: array<u32>;
// By cluster, side and item.
@group(0) @binding(7) var<storage, read_write> survivors: array<atomic<u32>>;
@group(0) @binding(8) var<storage, read> stale: array<u32>;

fn sides_to_draw(cluster: u32, number: u32) -> u32 {
    var all = 0u;
    for (var side = 0u; side < chunk.sides; side++) {
        all |= stale[cluster * chunk.sides + side] << side;
    }
    if all == 0u || chunk.culling == NO_CULLING {
        return all;
    }
    let words = cell_words(grid);
    var sides = 0u;
    for (var side = 0u; side < chunk.marked_sides; side++) {
        let word = marks[(cluster * chunk.marked_sides + side) * words + number / 32u];
        sides |= (word >> (number & 31u) & 1u) << side;
    }
    if chunk.marked_sides == 1u {
        sides = select(0u, all, sides != 0u);
    }
    sides &= all;
    if sides == 0u {
        return 0u;
    }
    let cell = cell_box(grid, cell_of(grid, number));
    let own = clusters[chunk.first + cluster];
    return sides & sides_of(grid.cells_per_m, cell[0], cell[1], own, chunk.sides, own.border);
}

var<workgroup> cells: array<u32, 32>;
var<workgroup> sides_of_cells: array<u32, 32>;

@compute @workgroup_size(32)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    for (var first = 32u * group.x; first < occupied[0]; first += 32u * groups.x) {
        // Each lane looks at a cell, then all of them at the triangles of each cell that is left.
        workgroupBarrier();
        sides_of_cells[lane] = 0u;
        if first + lane < occupied[0] {
            cells[lane] = occupied[1u + first + lane];
            sides_of_cells[lane] = sides_to_draw(group.y, cells[lane]);
        }
        workgroupBarrier();
        for (var i = 0u; i < 32u; i++) {
            if sides_of_cells[i] != 0u {
                keep(group.y, cells[i], sides_of_cells[i], lane);
            }
        }
    }
}

fn keep(cluster: u32, cell: u32, sides: u32, lane: u32) {
    let end = min(begins[cell + 1u], grid.most_refs);
    for (var slot = begins[cell] + lane; slot < end; slot += 32u) {
        let item = select(refs[slot], slot, grid.binning == CUT);
        for (var left = sides; left != 0u; left &= left - 1u) {
            let side = cluster * chunk.sides + countTrailingZeros(left);
            let at = side * grid.item_words + item / 32u;
            let bit = 1u << (item & 31u);
            if (atomicLoad(&survivors[at]) & bit) == 0u {
                atomicOr(&survivors[at], bit);
            }
        }
    }
}
