// The sky: twin of `light::Sky`, whose table this reads.

const SKY_COLUMNS: u32 = 64u;
const SKY_ROWS: u32 = 48u;
const PI: f32 = 3.14159265;

fn luminance(color: vec3<f32>) -> f32 {
    return dot(color, vec3(0.2126, 0.7152, 0.0722));
}

fn sky_at(column: u32, row: u32) -> vec3<f32> {
    return sky[row * SKY_COLUMNS + column].xyz;
}

fn sky_lookup(direction: vec3<f32>) -> vec3<f32> {
    let size = length(direction.xz);
    let toward = select(vec2(0.0), direction.xz / size, size > 0.0);
    let azimuth = acos(clamp(dot(toward, frame.sun_azimuth.xz), -1.0, 1.0));
    let height = asin(clamp(direction.y, 0.0, 1.0)) / (0.5 * PI);
    let x = azimuth / PI * f32(SKY_COLUMNS - 1u);
    let y = sqrt(height) * f32(SKY_ROWS - 1u);
    let column = min(u32(x), SKY_COLUMNS - 2u);
    let row = min(u32(y), SKY_ROWS - 2u);
    let f = vec2(x - f32(column), y - f32(row));
    return mix(
        mix(sky_at(column, row), sky_at(column + 1u, row), f.x),
        mix(sky_at(column, row + 1u), sky_at(column + 1u, row + 1u), f.x),
        f.y,
    );
}

// How fast the plain fades into the horizon, by the sine of the angle below it.
const PLAIN_HAZE: f32 = 0.2;

fn sky_radiance(direction: vec3<f32>) -> vec3<f32> {
    if direction.y >= 0.0 {
        return sky_lookup(direction);
    }
    let horizon = sky_lookup(vec3(direction.x, 0.0, direction.z));
    return mix(horizon, frame.plain.xyz, exp(-PLAIN_HAZE / -direction.y));
}

// Light of the stars in a direction.
fn stars(direction: vec3<f32>) -> f32 {
    let cell = floor(direction * 60.0);
    let c = bitcast<vec3<u32>>(vec3<i32>(cell));
    let salt = c.z * 8u;
    if unit(c.x, c.y, salt) >= 0.22 {
        return 0.0;
    }
    let random = vec3(unit(c.x, c.y, salt + 1u), unit(c.x, c.y, salt + 2u), unit(c.x, c.y, salt + 3u));
    let away = length(normalize(cell + random * 0.8 + 0.1) - direction) / 0.0011;
    let bright = pow(unit(c.x, c.y, salt + 4u), 6.0) + 0.06;
    return bright * max(1.0 - away * away, 0.0) * clamp(direction.y * 5.0, 0.0, 1.0);
}

// With the disc of the sun or moon and the stars.
fn sky_with_disc(direction: vec3<f32>) -> vec3<f32> {
    let light = sky_radiance(direction);
    if direction.y <= 0.0 {
        return light;
    }
    let away = degrees(acos(clamp(dot(direction, frame.towards_sun.xyz), -1.0, 1.0)));
    let disc = clamp((0.33 - away) / 0.12, 0.0, 1.0);
    var starlight = 0.0;
    if frame.stars > 0.0 {
        starlight = frame.stars * stars(direction);
    }
    return light + frame.disc.xyz * (disc * disc) + starlight;
}

// What a white surface reflects of the light from all sides, nothing in the way.
fn sky_ambient(normal: vec3<f32>) -> vec3<f32> {
    return mix(frame.plain.xyz, frame.overhead.xyz, 0.5 + 0.5 * normal.y);
}
