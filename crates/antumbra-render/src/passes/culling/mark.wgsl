// Marks the cells between what is seen and each cluster of lights: twin of `Beam::mark`, a lane for each slice.

@group(0) @binding(0) var<storage, read> grid: CullGrid;
@group(0) @binding(1) var<storage, read> chunk: Chunk;
@group(0) @binding(2) var<storage, read> clusters: array<Cluster>;
@group(0) @binding(3) var<storage, read> sources: Sources;
// A bit for each cell, by cluster and marked side.
@group(0) @binding(4) var<storage, read_write> marks: array<atomic<u32>>;

struct Beam {
    low: array<vec3<f32>, 2>,
    high: array<vec3<f32>, 2>,
}

fn mark(cluster: u32, sides: u32, cell: vec3<i32>) {
    if any(cell < vec3(0)) || any(cell >= vec3(i32(grid.side))) {
        return;
    }
    let words = cell_words(grid);
    var first = 0u;
    var unmarked = sides;
    // Whoever marks a cell marks those about it in the coarser grids.
    for (var level = 0u; level < grid.levels && unmarked != 0u; level++) {
        let side = side_of(grid, level);
        let number = first + number_of(side, cell >> vec3(level));
        let bit = 1u << (number & 31u);
        for (var left = unmarked; left != 0u; left &= left - 1u) {
            let at = (cluster * chunk.marked_sides + countTrailingZeros(left)) * words + number / 32u;
            if (atomicLoad(&marks[at]) & bit) == 0u {
                atomicOr(&marks[at], bit);
            } else {
                unmarked &= ~(left & (~left + 1u));
            }
        }
        first += side * side * side;
    }
}

// The part of a span of shares in which a linear function is not negative, given its values at shares 0 and 1; none if it
// begins after it ends.
fn kept(span: vec2<f32>, first: f32, last: f32) -> vec2<f32> {
    if first >= 0.0 && last >= 0.0 {
        return span;
    }
    if first < 0.0 && last < 0.0 {
        return vec2(1.0, 0.0);
    }
    let turn = first / (first - last);
    if first < 0.0 {
        return vec2(max(span.x, turn), span.y);
    }
    return vec2(span.x, min(span.y, turn));
}

// The part of a span in which the beam is over a cell's extent along an axis.
fn over(beam: Beam, axis: u32, cell: i32, span: vec2<f32>) -> vec2<f32> {
    let low = f32(cell);
    let high = f32(cell + 1);
    let part = kept(span, high - beam.low[0][axis], high - beam.low[1][axis]);
    return kept(part, beam.high[0][axis] - low, beam.high[1][axis] - low);
}

// First and last cell along an axis that the beam may touch within a span.
fn range_of(beam: Beam, axis: u32, span: vec2<f32>) -> vec2<i32> {
    let l = vec2(beam.low[0][axis]) + (beam.low[1][axis] - beam.low[0][axis]) * span;
    let h = vec2(beam.high[0][axis]) + (beam.high[1][axis] - beam.high[0][axis]) * span;
    let last = f32(grid.side - 1u);
    return vec2<i32>(clamp(floor(vec2(min(l.x, l.y), max(h.x, h.y))), vec2(0.0, -1.0), vec2(last + 1.0, last)));
}

fn mark_slice(beam: Beam, cluster: u32, sides: u32, major: u32, slice: i32) {
    let span = over(beam, major, slice, vec2(0.0, 1.0));
    if span.x > span.y {
        return;
    }
    let u = (major + 1u) % 3u;
    let v = (major + 2u) % 3u;
    let columns = range_of(beam, u, span);
    for (var i = columns.x; i <= columns.y; i++) {
        let in_column = over(beam, u, i, span);
        if in_column.x > in_column.y {
            continue;
        }
        let rows = range_of(beam, v, in_column);
        for (var j = rows.x; j <= rows.y; j++) {
            let in_row = over(beam, v, j, in_column);
            if in_row.x <= in_row.y {
                var cell = vec3(0);
                cell[major] = slice;
                cell[u] = i;
                cell[v] = j;
                mark(cluster, sides, cell);
            }
        }
    }
}

// A source cell, or the whole cell that it is in, widened by what lookups read beside their points.
fn widened(source: SourceCell, reach_per_m: f32, light: array<vec3<f32>, 2>) -> array<vec3<f32>, 2> {
    var low = source.low;
    var high = source.high;
    if MARKING != BOXES {
        let cell = vec3<f32>(cell_of(grid, source.cell).at);
        low = min(low, cell);
        high = max(high, cell + 1.0);
    }
    let farthest = max(abs(high - light[0]), abs(light[1] - low)) / grid.cells_per_m;
    let reach = reach_per_m * length(farthest) * grid.cells_per_m + grid.hair;
    return array<vec3<f32>, 2>(low - reach, high + reach);
}

// The sides that a source cell is seen in, if a light reaches it.
fn sides_seen(own: array<vec3<f32>, 2>, cluster: Cluster) -> u32 {
    let apart = max(max(own[0] - cluster.high, cluster.low - own[1]), vec3(0.0)) / grid.cells_per_m;
    if dot(apart, apart) > cluster.range_m * cluster.range_m {
        return 0u;
    }
    if chunk.marked_sides == 1u {
        return 1u;
    }
    return sides_of(grid.cells_per_m, own[0], own[1], cluster, chunk.sides, 1e-3);
}

const BOXES: u32 = 0u;
const CELLS: u32 = 1u;
const STEPS: u32 = 2u;

fn mark_ring(cluster: u32, sides: u32, cell: vec3<i32>) {
    for (var i = 0; i < 27; i++) {
        mark(cluster, sides, cell + vec3(i % 3, i / 3 % 3, i / 9) - 1);
    }
}

// The paper's earlier way: step by step, with all neighbours (Amanatides and Woo 1987). Twin of `mark_by_steps`.
fn mark_by_steps(cluster: u32, sides: u32, start: vec3<i32>, end: vec3<i32>) {
    let way = vec3<f32>(end - start);
    let step = vec3<i32>(sign(way));
    let between = select(vec3(3e38), 1.0 / abs(way), way != vec3(0.0));
    var next = between * 0.5;
    var cell = start;
    mark_ring(cluster, sides, cell);
    while any(cell != end) && all(cell >= vec3(-1)) && all(cell <= vec3(i32(grid.side))) {
        let axis = select(select(2u, 1u, next.y <= next.z), 0u, next.x <= min(next.y, next.z));
        cell[axis] += step[axis];
        next[axis] = select(next[axis] + between[axis], 3e38, cell[axis] == end[axis]);
        mark_ring(cluster, sides, cell);
    }
}

@compute @workgroup_size(32)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let cluster = clusters[chunk.first + group.y];
    var light = array<vec3<f32>, 2>(cluster.low, cluster.high);
    if MARKING == CELLS {
        light = array<vec3<f32>, 2>(floor(cluster.low), floor(cluster.high) + 1.0);
    }
    if MARKING == STEPS {
        for (var i = group.x * 32u + lane; i < sources.count; i += 32u * groups.x) {
            let own = widened(sources.cells[i], cluster.reach, light);
            let middle = clamp(floor(0.5 * (cluster.low + cluster.high)), vec3(-1e6), vec3(1e6));
            mark_by_steps(group.y, sides_seen(own, cluster), vec3<i32>(cell_of(grid, sources.cells[i].cell).at), vec3<i32>(middle));
        }
        return;
    }
    for (var i = group.x; i < sources.count; i += groups.x) {
        let own = widened(sources.cells[i], cluster.reach, light);
        let sides = sides_seen(own, cluster);
        if sides == 0u {
            continue;
        }
        let low = array<vec3<f32>, 2>(own[0], light[0] - grid.hair);
        let beam = Beam(low, array<vec3<f32>, 2>(own[1], light[1] + grid.hair));
        let way = abs(beam.low[1] + beam.high[1] - beam.low[0] - beam.high[0]);
        let major = select(select(2u, 1u, way.y >= way.z), 0u, way.x >= max(way.y, way.z));
        let slices = range_of(beam, major, vec2(0.0, 1.0));
        for (var slice = slices.x + i32(lane); slice <= slices.y; slice += 32) {
            mark_slice(beam, group.y, sides, major, slice);
        }
    }
}
