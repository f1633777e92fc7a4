// What both passes over lamps know: those whose shadows are baked alone, and those with maps.

@group(1) @binding(0) var<storage, read> lights: array<AntumbraLight>;

fn luminance(color: vec3<f32>) -> f32 {
    return dot(color, vec3(0.2126, 0.7152, 0.0722));
}

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

// How much of a lamp a bake lets through; all, where none holds it.
fn baked_share(lamp: Lamp, s: Surface) -> f32 {
    if lamp.light == NOT_BAKED {
        return 1.0;
    }
    return looked_up(lights[lamp.light], s);
}
