//! From a shadow map to epipolar space: for each light ray, the column of alpha where its shadow begins.

use super::epipolar::Epipolar;
use super::splat::{Map, Paraboloid};
use crate::area::Vpl;

/// Thresholds by theta, then phi: a light ray is lit in columns less than its own.
pub(crate) fn thresholds(vpl: &Vpl, space: &Epipolar, map: &Map) -> Vec<u32> {
    let paraboloid = Paraboloid::new(vpl, map.side);
    let size = space.size;
    let light_rays = (0..size.theta).flat_map(|theta| (0..size.phi).map(move |phi| (theta, phi)));
    light_rays.map(|(theta, phi)| threshold(space, map, &paraboloid, theta, phi)).collect()
}

fn threshold(space: &Epipolar, map: &Map, paraboloid: &Paraboloid, theta: u32, phi: u32) -> u32 {
    let angle = space.phi_at(phi);
    let seen = paraboloid.texel(space.light_ray(space.theta_at(theta), angle));
    let blocked = seen.and_then(|(at, _)| map.between(at));
    let Some(r) = blocked else { return space.size.alpha };
    let column = (space.alpha_on_light_ray(angle, r) - space.alpha_min) * space.alpha_scale;
    (column.max(0.0) as u32).min(space.size.alpha)
}
