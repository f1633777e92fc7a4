// Light that fog scatters from a point light towards the eye: twin of `airlight`, which explains it.

const COLUMNS: u32 = 513u;
const ROWS: u32 = 129u;
const HALF_PI: f32 = 1.57079633;
const STEEPEST: f32 = 1.57079033;

struct Beside {
    foot: f32,
    h: f32,
    a: f32,
    b: f32,
    sigma_t: f32,
    start: f32,
}

fn tail(theta: f32, tau: f32) -> vec2<f32> {
    let left = HALF_PI - theta;
    let rho = tau * left / max(1.0 - sin(theta), 1e-9);
    let x = clamp(theta / PI + 0.5, 0.0, 1.0) * f32(COLUMNS - 1u);
    let root = sqrt(rho);
    let y = root / (1.0 + root) * f32(ROWS - 1u);
    let column = min(u32(x), COLUMNS - 2u);
    let row = min(u32(y), ROWS - 2u);
    let first = row * COLUMNS + column;
    let across = x - f32(column);
    let upper = mix(tails[first], tails[first + 1u], across);
    let lower = mix(tails[first + COLUMNS], tails[first + COLUMNS + 1u], across);
    return mix(upper, lower, y - f32(row)) * (left / (1.0 + rho));
}

// What comes from behind an angle, per intensity and scattering: differences of it are airlight.
fn behind(beside: Beside, angle: f32) -> f32 {
    let theta = clamp(angle, -STEEPEST, STEEPEST);
    let sine = sin(theta);
    let cosine = max(cos(theta), 1e-6);
    let way = beside.foot + beside.h * (sine + 1.0) / cosine - beside.start;
    let ahead = tail(theta, beside.sigma_t * beside.h);
    return exp(-beside.sigma_t * way) * (beside.a * ahead.x + beside.b * ahead.y) / beside.h;
}
