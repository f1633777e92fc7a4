//! The epipolar space of an eye and a light.
//!
//! Positions are relative to the eye. Ranges of the angles are fitted to the picture: alpha and theta exactly, by the
//! frustum's corners and edges; phi by the farthest that is looked at.

use std::f32::consts::{PI, TAU};

use glam::{DVec2, Vec3};

use crate::area::{VoxelResolution, Vpl};
use crate::camera::View;

/// A point in epipolar space: angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Place {
    pub alpha: f32,
    pub theta: f32,
    pub phi: f32,
}

/// The space of one VPL, and how its angles become indices.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Epipolar {
    /// Unit vector from the eye to the light, and their distance.
    pub axis: Vec3,
    pub distance: f32,
    /// Where theta is 0 and a quarter turn.
    pub across: Vec3,
    pub along: Vec3,
    pub alpha_min: f32,
    pub theta_min: f32,
    /// Indices per radian.
    pub alpha_scale: f32,
    pub theta_scale: f32,
    pub phi_scale: f32,
    /// Planes go all the way round: the first is beside the last.
    pub wraps: bool,
    pub size: VoxelResolution,
}

/// Columns before the first that is seen, so that biased lookups find them.
const MARGIN: f32 = 4.0;

impl Epipolar {
    /// Of a VPL, for a view that looks as far as `far_m`.
    pub fn new(vpl: &Vpl, view: &View, far_m: f64, size: VoxelResolution) -> Self {
        let distance = vpl.position.length().max(1e-6);
        let axis = if vpl.position.length() > 1e-6 { vpl.position / distance } else { view.forward.as_vec3() };
        let corner = |x: f64, y: f64| view.ray(DVec2::new(x, y)).direction.as_vec3();
        let (width, height) = (f64::from(view.width), f64::from(view.height));
        let corners = [(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)].map(|(x, y)| corner(x, y));
        let (towards, away) = (contains(&corners, axis), contains(&corners, -axis));
        let forward = view.forward.as_vec3();
        let level = forward - axis * forward.dot(axis);
        let across = level.try_normalize().unwrap_or_else(|| axis.any_orthonormal_vector());
        let along = axis.cross(across);
        let wraps = towards || away;
        let turns = corners.map(|c| c.dot(along).atan2(c.dot(across)));
        let (theta_min, theta_max) = if wraps {
            (-PI, PI)
        } else {
            let least = turns.iter().copied().fold(PI, f32::min);
            let most = turns.iter().copied().fold(-PI, f32::max);
            let margin = (most - least) / size.theta as f32 + 1e-5;
            (least - margin, most + margin)
        };
        let alpha_least = if towards { 0.0 } else { nearest_angle(&corners, axis) };
        let alpha_most = if away { PI } else { PI - nearest_angle(&corners, -axis) };
        let columns = size.alpha as f32 - MARGIN - 1.0;
        let alpha_scale = columns / (alpha_most - alpha_least).max(1e-4);
        let mut out = Self {
            axis,
            distance,
            across,
            along,
            alpha_min: alpha_least - MARGIN / alpha_scale,
            theta_min,
            alpha_scale,
            theta_scale: size.theta as f32 / (theta_max - theta_min),
            phi_scale: 1.0,
            wraps,
            size,
        };
        // Of points as far as can be seen, phi rises with the angle from the axis up to that of a tangent from the light, and falls behind it.
        let tangent = (far_m as f32 / distance).min(1.0).acos().clamp(alpha_least, alpha_most);
        let phi_max = out.phi(tangent, far_m as f32).clamp(1e-4, PI);
        out.phi_scale = size.phi as f32 / (phi_max * 1.001);
        out
    }

    /// The angle at the light of a point at a distance along a ray, at an angle from the axis.
    fn phi(&self, alpha: f32, t: f32) -> f32 {
        let (sin, cos) = alpha.sin_cos();
        (t * sin).atan2(self.distance - t * cos)
    }

    /// Alpha and theta of a ray of unit length; phi of its point at a distance.
    pub fn place(&self, ray: Vec3, t: f32) -> Place {
        let aside = ray - self.axis * ray.dot(self.axis);
        let sin = aside.length();
        let cos = ray.dot(self.axis);
        Place {
            alpha: sin.atan2(cos),
            theta: aside.dot(self.along).atan2(aside.dot(self.across)),
            phi: (t * sin).atan2(self.distance - t * cos),
        }
    }

    /// The direction of a light ray.
    pub fn light_ray(&self, theta: f32, phi: f32) -> Vec3 {
        let (sin, cos) = phi.sin_cos();
        let (sin_theta, cos_theta) = theta.sin_cos();
        self.axis * -cos + (self.across * cos_theta + self.along * sin_theta) * sin
    }

    /// Alpha of a point on a light ray, at a distance from the light.
    pub fn alpha_on_light_ray(&self, phi: f32, r: f32) -> f32 {
        (r * phi.sin()).atan2(self.distance - r * phi.cos())
    }

    /// Planes' index, with a fraction: whole numbers are borders.
    pub fn theta_index(&self, theta: f32) -> f32 {
        (theta - self.theta_min) * self.theta_scale
    }

    /// The angle in the middle of a plane's wedge.
    pub fn theta_at(&self, index: u32) -> f32 {
        self.theta_min + (index as f32 + 0.5) / self.theta_scale
    }

    /// The angle in the middle of a bit.
    pub fn phi_at(&self, index: u32) -> f32 {
        (index as f32 + 0.5) / self.phi_scale
    }

    /// A plane's number, from one that may lie outside.
    pub fn row(&self, index: i32) -> u32 {
        let last = self.size.theta as i32;
        if self.wraps { index.rem_euclid(last) as u32 } else { index.clamp(0, last - 1) as u32 }
    }
}

/// Whether a direction lies in the cone of a picture's corners, clockwise as seen by the eye.
fn contains(corners: &[Vec3; 4], direction: Vec3) -> bool {
    let middle: Vec3 = corners.iter().sum();
    let inside = |i: usize| {
        let normal = corners[i].cross(corners[(i + 1) % 4]);
        normal.dot(direction) * normal.dot(middle) >= 0.0
    };
    (0..4).all(inside)
}

/// The least angle between a direction outside a picture's cone and the cone: at one of its edges.
fn nearest_angle(corners: &[Vec3; 4], direction: Vec3) -> f32 {
    let edge = |i: usize| {
        let (a, b) = (corners[i], corners[(i + 1) % 4]);
        let normal = a.cross(b).normalize_or_zero();
        let on = direction - normal * direction.dot(normal);
        let between = a.cross(on).dot(normal) >= 0.0 && on.cross(b).dot(normal) >= 0.0;
        let ends = a.angle_between(direction).min(b.angle_between(direction));
        if between { ends.min(direction.dot(normal).abs().min(1.0).asin()) } else { ends }
    };
    (0..4).map(edge).fold(TAU, f32::min)
}
