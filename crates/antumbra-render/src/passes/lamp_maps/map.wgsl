// One lamp's shadow map: six sides of a cube along the world's axes, or two paraboloids about its vertical axis. Depth is the
// near distance over depth, along the side's axis or, in a paraboloid, along the ray: 1 is near, 0 infinitely far.
struct MappedLamp {
    // Which of the lamps it is.
    lamp: u32,
    // Its sides lie in tiles from this one on.
    first_tile: u32,
    // Texels per side of a side.
    size: f32,
    near_m: f32,
}

// How maps are laid out.
struct MapLayout {
    // Lamps whose maps are there, from which on.
    first: u32,
    count: u32,
    // Tiles per row of a layer, and texels per side of a tile.
    tiles: u32,
    tile_size: u32,
    // Texels around what is looked up, for filters.
    border: f32,
    // Filter: taps on either side of the middle one, and box (0) or tent (1).
    radius: u32,
    kernel: u32,
    pad: u32,
}
