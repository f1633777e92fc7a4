// Which sides of the clusters' maps need drawing: those in which a cell is marked that was not when they were drawn, or in a marked
// cell of which something has moved since. The others still hold all that lookups can read.

@group(0) @binding(0) var<storage, read> grid: CullGrid;
@group(0) @binding(1) var<storage, read> chunk: Chunk;
@group(0) @binding(2) var<storage, read> clusters: array<Cluster>;
// A bit for each cell in which something has moved.
@group(0) @binding(3) var<storage, read> moved: array<u32>;
@group(0) @binding(4) var<storage, read> marks: array<u32>;
// The marks of what was drawn.
@group(0) @binding(5) var<storage, read_write> drawn: array<u32>;
// By cluster and side: whether it needs drawing.
@group(0) @binding(6) var<storage, read_write> stale: array<u32>;

var<workgroup> is_stale: atomic<u32>;

@compute @workgroup_size(64)
fn main(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let words = cell_words(grid);
    let first = group.x * words;
    let kept = first + chunk.first_in_batch * chunk.marked_sides * words;
    let cluster = group.x / chunk.marked_sides;
    var found = clusters[chunk.first + cluster].is_new;
    for (var word = lane; word < words; word += 64u) {
        let before = drawn[kept + word];
        found |= (marks[first + word] & ~before) | (before & moved[word]);
    }
    if found != 0u {
        atomicStore(&is_stale, 1u);
    }
    workgroupBarrier();
    let needs_drawing = atomicLoad(&is_stale);
    if needs_drawing != 0u {
        for (var word = lane; word < words; word += 64u) {
            drawn[kept + word] = marks[first + word];
        }
    }
    // One mark for all sides speaks for all of them.
    let sides = chunk.sides / chunk.marked_sides;
    if lane < sides {
        stale[group.x * sides + lane] = needs_drawing;
    }
}
