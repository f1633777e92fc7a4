// How much of a baked light reaches a surface, in the way that this program is for (`SHADOW`).

const FILTER: u32 = 1u;
const MEAN: u32 = 2u;
const LEVELS: u32 = 3u;
const PENUMBRA: u32 = 4u;

fn looked_up(light: AntumbraLight, s: Surface) -> f32 {
    let filter_ = AntumbraFilter(frame.radius, frame.kernel);
    switch SHADOW {
        case FILTER: { return antumbra_filtered(light, s.position, s.face_normal, filter_); }
        case MEAN: { return antumbra_mean(light, s.position, s.face_normal, s.footprint_m); }
        case LEVELS: { return antumbra_levels(light, s.position, s.face_normal, s.footprint_m, filter_); }
        case PENUMBRA: {
            // Lamps have no size.
            if light.kind != ANTUMBRA_DIRECTIONAL {
                return antumbra_filtered(light, s.position, s.face_normal, filter_);
            }
            return antumbra_penumbra(light, s.position, s.face_normal, frame.sun_tangent);
        }
        default: { return 1.0; }
    }
}
