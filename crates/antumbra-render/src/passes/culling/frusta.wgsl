// Marks the cells in the convex hull of the camera's frustum and a light: the standard, twin of `Hull`.

@group(0) @binding(0) var<storage, read> grid: CullGrid;
@group(0) @binding(1) var<storage, read> chunk: Chunk;
@group(0) @binding(2) var<storage, read> clusters: array<Cluster>;
@group(0) @binding(3) var<storage, read> occupied: array<u32>;
// Outward normals, and what their dot products are with the points of the plane, relative to the eye.
@group(0) @binding(4) var<storage, read> planes: array<vec4<f32>>;
@group(0) @binding(5) var<storage, read_write> marks: array<atomic<u32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let cluster = clusters[chunk.first + id.y];
    let words = cell_words(grid);
    for (var i = id.x; i < occupied[0]; i += 64u * groups.x) {
        let number = occupied[1u + i];
        let cell = cell_box(grid, cell_of(grid, number));
        // What lookups read lies outside of the frustum by as much as they read beside their points.
        let farthest = max(abs(cell[1] - cluster.low), abs(cluster.high - cell[0])) / grid.cells_per_m;
        let reach = 1.1 * cluster.reach * length(farthest);
        let low = (cell[0] - grid.eye) / grid.cells_per_m - reach;
        let high = (cell[1] - grid.eye) / grid.cells_per_m + reach;
        var is_kept = true;
        for (var p = cluster.first_plane; p < cluster.first_plane + cluster.planes; p++) {
            let plane = planes[p];
            let nearest = select(high, low, plane.xyz >= vec3(0.0));
            is_kept = is_kept && dot(plane.xyz, nearest) <= plane.w;
        }
        if is_kept {
            atomicOr(&marks[id.y * words + number / 32u], 1u << (number & 31u));
        }
    }
}
