// Lights that share what is culled, and what is seen.
struct Cluster {
    // The box about the lights, in cells.
    low: vec3<f32>,
    // How far beside its point a lookup reads, metres per metre from the light.
    reach: f32,
    high: vec3<f32>,
    // Whether what moves alone casts shadows.
    is_of_movers: u32,
    // Planes about what frustum culling keeps.
    first_plane: u32,
    planes: u32,
    // No light is farther from what it lights, metres.
    range_m: f32,
    // Whether its lights' maps need drawing in any case.
    is_new: u32,
    // Slope beyond its border that a side of a map still shows.
    border: f32,
    pad_0: u32,
    pad_1: u32,
    pad_2: u32,
}

// The clusters at work.
struct Chunk {
    first: u32,
    count: u32,
    // Sides of a map: 6 of a cube, 2 paraboloids.
    sides: u32,
    // Sides that marks are kept for: as many, or one for all.
    marked_sides: u32,
    // NO_CULLING, FRUSTA or VOXELS.
    culling: u32,
    // Where its first cluster is among those whose maps are there.
    first_in_batch: u32,
    pad_0: u32,
    pad_1: u32,
}

const NO_CULLING: u32 = 0u;
const FRUSTA: u32 = 1u;
const VOXELS: u32 = 2u;

// Where something is seen: the box of it, in cells, and the number of its block (see `CullGrid`).
struct SourceCell {
    low: vec3<f32>,
    cell: u32,
    high: vec3<f32>,
    pad: u32,
}

struct Sources {
    count: u32,
    pad_0: u32,
    pad_1: u32,
    pad_2: u32,
    cells: array<SourceCell>,
}

// Which sides of a map a box may appear in, from any point of a light's box, both in cells: of a cube, twin of `faces_of`.
fn sides_of(cells_per_m: vec3<f32>, low: vec3<f32>, high: vec3<f32>, cluster: Cluster, sides: u32, border: f32) -> u32 {
    let from_light = (low - cluster.high) / cells_per_m;
    let to_light = (high - cluster.low) / cells_per_m;
    if sides == 2u {
        let far = max(abs(from_light), abs(to_light));
        let slack = border * (far.x + far.z);
        return select(0u, 1u, to_light.y + slack >= 0.0) | select(0u, 2u, from_light.y - slack <= 0.0);
    }
    // The least that coordinates differ from 0 by.
    let aside = max(max(from_light, -to_light), vec3(0.0));
    var mask = 0u;
    for (var axis = 0u; axis < 3u; axis++) {
        let least = max(aside[(axis + 1u) % 3u], aside[(axis + 2u) % 3u]);
        mask |= select(0u, 1u << (2u * axis), to_light[axis] * (1.0 + border) >= least);
        mask |= select(0u, 2u << (2u * axis), -from_light[axis] * (1.0 + border) >= least);
    }
    return mask;
}
