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
    // WHOLE, CUT, LISTED or LEVELS.
    binning: u32,
    // Listed: triangles of more cells are culled by nothing. Levels: they lie in a coarser grid.
    most_cells: u32,
    // By how much boxes are widened, in cells: more than rounding errs by.
    hair: f32,
    // Boxes of what is seen are those of blocks of 2^n cells along each axis.
    source_level: u32,
    // Grids, each of cells twice as wide as the one before: more than one where large triangles lie in coarser ones.
    levels: u32,
    // Cells of all of them, numbered one grid after the other.
    cells: u32,
}

const WHOLE: u32 = 0u;
const CUT: u32 = 1u;
const LISTED: u32 = 2u;
const LEVELS: u32 = 3u;

// What `triangles` says of each: its part, with these bits, and its number in the part.
const PART: u32 = 0x1fffffffu;
const IS_CUT_OUT: u32 = 0x80000000u;
const CASTS_NOTHING: u32 = 0x40000000u;
const MOVES: u32 = 0x20000000u;

fn in_cells(grid: CullGrid, point: vec3<f32>) -> vec3<f32> {
    return point * grid.cells_per_m + grid.eye;
}

struct Cell {
    at: vec3<u32>,
    level: u32,
}

fn side_of(grid: CullGrid, level: u32) -> u32 {
    return (grid.side + (1u << level) - 1u) >> level;
}

// Numbers of all cells of a level come after this.
fn first_of(grid: CullGrid, level: u32) -> u32 {
    var first = 0u;
    for (var finer = 0u; finer < level; finer++) {
        let side = side_of(grid, finer);
        first += side * side * side;
    }
    return first;
}

fn number_of(side: u32, cell: vec3<i32>) -> u32 {
    return u32(cell.x) + side * (u32(cell.y) + side * u32(cell.z));
}

fn cell_of(grid: CullGrid, number: u32) -> Cell {
    var level = 0u;
    var side = grid.side;
    var own = number;
    while level + 1u < grid.levels && own >= side * side * side {
        own -= side * side * side;
        level += 1u;
        side = side_of(grid, level);
    }
    return Cell(vec3(own % side, own / side % side, own / side / side), level);
}

// The box of a cell, widened by a hair, in cells of the finest grid.
fn cell_box(grid: CullGrid, cell: Cell) -> array<vec3<f32>, 2> {
    let low = vec3<f32>(cell.at << vec3(cell.level)) - grid.hair;
    let high = vec3<f32>((cell.at + 1u) << vec3(cell.level)) + grid.hair;
    return array<vec3<f32>, 2>(low, high);
}

// Words of a bit for each cell.
fn cell_words(grid: CullGrid) -> u32 {
    return (grid.cells + 31u) / 32u;
}

// Blocks of cells along each axis in which boxes of what is seen are kept.
fn source_side(grid: CullGrid) -> u32 {
    return (grid.side + (1u << grid.source_level) - 1u) >> grid.source_level;
}

// The item that a whole triangle is.
fn whole_item(grid: CullGrid, triangle: u32) -> u32 {
    return select(triangle, grid.most_refs + triangle, grid.binning == CUT);
}
