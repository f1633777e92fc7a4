// Copies the screen buffer into a window, pixel by pixel. The buffer holds sRGB; a target that encodes by itself gets it
// decoded first.

@group(0) @binding(0) var<storage, read> frame: Frame;
@group(0) @binding(1) var<storage, read> screen: array<u32>;

override ENCODES: bool = false;

@vertex
fn corner(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
    return vec4(f32(i32(i & 1u) * 4 - 1), f32(i32(i >> 1u) * 4 - 1), 0.0, 1.0);
}

@fragment
fn color(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    let pixel = min(vec2<u32>(at.xy), frame.size - 1u);
    let c = unpack4x8unorm(screen[pixel_index(frame, pixel)]);
    let decoded = select(pow((c.xyz + 0.055) / 1.055, vec3(2.4)), c.xyz / 12.92, c.xyz <= vec3(0.04045));
    return vec4(select(c.xyz, decoded, ENCODES), 1.0);
}
