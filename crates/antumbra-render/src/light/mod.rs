//! Where the light comes from: the suns, moons and lamps of a scene, and its sky.
//!
//! One scale serves day and night. Light is measured relative to the sun outside the atmosphere: a surface that faces it
//! there gets an irradiance of 1, which is 128,000 lux ([`LUX`]). Lamps are on that scale by their candela, and so a
//! street lamp of 1000 cd is lost in daylight. By day the first directional light is the sun itself, whatever the file
//! says: a file's lux then matter only between its directional lights. At night every light counts as the file says,
//! suns do not shine, and pictures are exposed for what the lamps show.

mod lamp;
mod lamps;
mod sky;
mod sun;
mod time;
mod virtual_lights;

pub use lamp::{Lamp, Lamplight};
pub(crate) use lamps::Lamps;
pub use sky::Sky;
pub use sun::Sun;
pub use time::Time;
pub use virtual_lights::{LightTracing, VirtualLight};

use glam::Vec3;

/// Irradiance of one lux, in the unit of pictures: the sun outside the atmosphere has 128,000.
pub const LUX: f32 = 1.0 / 128_000.0;

/// Brightness of linear RGB (Rec. 709).
pub(crate) fn luminance(color: Vec3) -> f32 {
    color.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}
