// Where the list of the lamps that may reach a pixel begins.
fn list_of(pixel: vec2<u32>, depth: f32) -> u32 {
    let tile = pixel / frame.tile;
    let index = tile.y * frame.tiles_x + tile.x;
    if frame.layers == 0u {
        return index * frame.list_words;
    }
    let layer = log2(max(depth / frame.first_layer_m, 1.0)) / log2(frame.layer_ratio) + select(0.0, 1.0, depth > frame.first_layer_m);
    return (index * frame.layers + min(u32(layer), frame.layers - 1u)) * frame.list_words;
}
