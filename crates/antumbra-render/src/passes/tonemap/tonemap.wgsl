// From light to a screen's bytes: twin of `tonemap::reference`.

@group(0) @binding(0) var<storage, read> frame: Frame;
@group(0) @binding(1) var<storage, read> hdr: array<vec4<f32>>;
// sRGB, one word per pixel, red in the low byte.
@group(0) @binding(2) var<storage, read_write> screen: array<u32>;

const INTO = mat3x3<f32>(0.59719, 0.07600, 0.02840, 0.35458, 0.90834, 0.13383, 0.04823, 0.01566, 0.83777);
const BACK = mat3x3<f32>(1.60475, -0.10208, -0.00327, -0.53108, 1.10813, -0.07276, -0.07367, -0.00605, 1.07602);
const CONTRAST: f32 = 0.93;
const GREY: f32 = 0.18;

fn filmic(color: vec3<f32>) -> vec3<f32> {
    // Less contrast about middle grey.
    let softened = GREY * pow(min(color, vec3(1e6)) / GREY, vec3(CONTRAST));
    let v = INTO * softened;
    let rise = v * (v + 0.0245786) - 0.000090537;
    let fall = v * (0.983729 * v + 0.432951) + 0.238081;
    return clamp(BACK * (rise / fall), vec3(0.0), vec3(1.0));
}

fn srgb_from_linear(c: vec3<f32>) -> vec3<f32> {
    return select(1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, 12.92 * c, c <= vec3(0.0031308));
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if any(id.xy >= frame.size) {
        return;
    }
    let index = pixel_index(frame, id.xy);
    let radiance = hdr[index].xyz / f32(frame.samples);
    let color = srgb_from_linear(filmic(max(radiance * frame.exposure, vec3(0.0))));
    // Dithered, so that clear skies show no steps.
    let bytes = vec3<u32>(color * 255.0 + unit(id.x, id.y, 0u));
    screen[index] = bytes.x | (bytes.y << 8u) | (bytes.z << 16u) | 0xff000000u;
}
