// Penumbrae that harden on contact.

// Visibility under a light of some size, whose radius is seen from here under an angle of the given tangent: the shadow's
// edge is as soft as its caster is far (Fernando 2005, "Percentage-closer soft shadows"), by filters of five to nine taps on
// the level that is as wide.
fn antumbra_penumbra(light: AntumbraLight, point: vec3<f32>, normal: vec3<f32>, tangent: f32) -> f32 {
    let frame = antumbra_frame(light, point);
    var radius_m = ANTUMBRA_SEARCH_TEXELS * frame.texel_m;
    // The farther casters may be, the wider to look for them; then only as wide as the penumbra is.
    for (var i = 0u; i < 2u; i++) {
        let blocker = antumbra_blocker(light, point, radius_m);
        radius_m = tangent * max(0.5 * (blocker.x + blocker.y), 0.0);
    }
    return antumbra_wide(light, point, normal, 2.0 * radius_m);
}

// Texels to every side in which a penumbra's casters are looked for.
const ANTUMBRA_SEARCH_TEXELS: f32 = 16.0;

// Tent-filtered over a width in metres: 1 to 9 taps at full depth, blended between two filters, or 9 on coarse levels.
fn antumbra_wide(light: AntumbraLight, point: vec3<f32>, normal: vec3<f32>, width_m: f32) -> f32 {
    // A tent of radius r is r + 1 texels wide.
    let radius = max(width_m / antumbra_frame(light, point).texel_m - 1.0, 0.0);
    if radius > 4.0 {
        return antumbra_levels(light, point, normal, width_m, AntumbraFilter(4u, ANTUMBRA_TENT));
    }
    let whole = u32(radius);
    let narrow = antumbra_filtered(light, point, normal, AntumbraFilter(whole, ANTUMBRA_TENT));
    if radius == f32(whole) {
        return narrow;
    }
    return mix(narrow, antumbra_filtered(light, point, normal, AntumbraFilter(whole + 1u, ANTUMBRA_TENT)), fract(radius));
}
