// Lists the cells that have triangles, and those in which something is seen.

@group(0) @binding(0) var<storage, read> grid: CullGrid;
@group(0) @binding(1) var<storage, read> begins: array<u32>;
@group(0) @binding(2) var<storage, read> boxes: array<u32>;
// How many have triangles, and their numbers.
@group(0) @binding(3) var<storage, read_write> occupied: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read_write> sources: SourceList;

// `Sources`, as it grows.
struct SourceList {
    count: atomic<u32>,
    pad_0: u32,
    pad_1: u32,
    pad_2: u32,
    cells: array<SourceCell>,
}

fn unsorted(bits: u32) -> f32 {
    return bitcast<f32>(select(~bits, bits & 0x7fffffffu, (bits & 0x80000000u) != 0u));
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let cell = id.x;
    if cell >= grid.cells {
        return;
    }
    if begins[cell + 1u] > begins[cell] {
        atomicStore(&occupied[1u + atomicAdd(&occupied[0], 1u)], cell);
    }
    let side = source_side(grid);
    if cell < side * side * side && boxes[6u * cell] != 0u {
        var low: vec3<f32>;
        var high: vec3<f32>;
        for (var axis = 0u; axis < 3u; axis++) {
            low[axis] = unsorted(~boxes[6u * cell + axis]);
            high[axis] = unsorted(boxes[6u * cell + 3u + axis]);
        }
        sources.cells[atomicAdd(&sources.count, 1u)] = SourceCell(low, cell, high, 0u);
    }
}
