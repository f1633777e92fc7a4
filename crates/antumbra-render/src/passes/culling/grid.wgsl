// The grid of cells over a scene: twin of `Grid`. Positions in cells count from its least corner.
struct CullGrid {
    cells_per_m: vec3<f32>,
    // Cells along each axis.
    side: u32,
    // Where the eye is, in cells.
    eye: vec3<f32>,
    // Triangles of the scene.
    triangles: u32,
    // Room for the triangles of cells.
    most_refs: u32,
    // Words of a bit for each item: a triangle or, where they are cut, a piece of one or a triangle.
    item_words: u32,
    // WHOLE, CUT or LISTED.
    binning: u32,
    // Listed: triangles of more cells are culled by nothing.
    most_cells: u32,
    // By how much boxes are widened, in cells: more than rounding errs by.
    hair: f32,
    // Boxes of what is seen are those of blocks of 2^n cells along each axis.
    source_level: u32,
    pad_0: u32,
    pad_1: u32,
}

const WHOLE: u32 = 0u;
const CUT: u32 = 1u;
const LISTED: u32 = 2u;

// What `triangles` says of each: its part, with these bits, and its number in the part.
const PART: u32 = 0x1fffffffu;
const IS_CUT_OUT: u32 = 0x80000000u;
const CASTS_NOTHING: u32 = 0x40000000u;
const MOVES: u32 = 0x20000000u;

fn in_cells(grid: CullGrid, point: vec3<f32>) -> vec3<f32> {
    return point * grid.cells_per_m + grid.eye;
}

fn number_of(grid: CullGrid, cell: vec3<i32>) -> u32 {
    return u32(cell.x) + grid.side * (u32(cell.y) + grid.side * u32(cell.z));
}

fn cell_of(grid: CullGrid, number: u32) -> vec3<u32> {
    return vec3(number % grid.side, number / grid.side % grid.side, number / grid.side / grid.side);
}

// Blocks of cells along each axis in which boxes of what is seen are kept.
fn source_side(grid: CullGrid) -> u32 {
    return (grid.side + (1u << grid.source_level) - 1u) >> grid.source_level;
}

// The item that a whole triangle is.
fn whole_item(grid: CullGrid, triangle: u32) -> u32 {
    return select(triangle, grid.most_refs + triangle, grid.binning == CUT);
}
