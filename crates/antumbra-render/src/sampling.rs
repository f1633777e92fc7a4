//! Deterministic sample points: the same picture on every run and for every number of threads.

use glam::{DVec2, Vec2, Vec3};

/// Reciprocals of the plastic number and its square: the additive recurrence of Roberts (2018), "The Unreasonable
/// Effectiveness of Quasirandom Sequences". Any run of its points covers the unit square evenly.
const R2: DVec2 = DVec2::new(0.754_877_666_246_692_7, 0.569_840_290_998_053_2);

/// Point `index` of the sequence, in the unit square.
pub(crate) fn r2(index: u32) -> DVec2 {
    (DVec2::splat(0.5) + R2 * f64::from(index)).fract()
}

/// Two numbers in 0..1 for a pixel: neighbours get numbers far apart, so that a small blur averages well.
pub(crate) fn pixel_offset(x: u32, y: u32) -> Vec2 {
    let h = hash(x.wrapping_mul(0x9E37_79B1) ^ hash(y));
    Vec2::new((h >> 16) as f32, (h & 0xFFFF) as f32) / 65536.0
}

/// A number in 0..1 from three indices.
pub(crate) fn unit(x: u32, y: u32, sample: u32) -> f32 {
    (hash(x ^ hash(y ^ hash(sample))) >> 8) as f32 / 16_777_216.0
}

/// A direction about the normal, with a density of cosine over pi, from a point of the unit square.
pub(crate) fn cosine_direction(normal: Vec3, point: Vec2) -> Vec3 {
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    let (sin, cos) = (std::f32::consts::TAU * point.x).sin_cos();
    let radius = point.y.sqrt();
    let height = (1.0 - point.y).max(0.0).sqrt();
    tangent * (cos * radius) + bitangent * (sin * radius) + normal * height
}

/// Wellons (2018), "Prospecting for Hash Functions": `lowbias32`.
pub(crate) fn hash(mut x: u32) -> u32 {
    x = (x ^ (x >> 16)).wrapping_mul(0x7FEB_352D);
    x = (x ^ (x >> 15)).wrapping_mul(0x846C_A68B);
    x ^ (x >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cosine_directions_average_to_two_thirds_of_the_normal() {
        let normal = Vec3::new(1.0, 2.0, -2.0) / 3.0;
        let sum: Vec3 = (0..4096).map(|i| cosine_direction(normal, r2(i).as_vec2())).sum();
        // The mean of cosine over its own density is 2/3.
        assert!((sum / 4096.0 - normal * (2.0 / 3.0)).length() < 2e-3);
    }

    #[test]
    fn points_cover_the_square_evenly() {
        let in_corner = (0..1000).filter(|&i| r2(i).max_element() < 0.5).count();
        assert!((240..=260).contains(&in_corner), "{in_corner}");
    }
}
