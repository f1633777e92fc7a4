//! How a light's rays run: parallel, or from its place. From the light's record, by arithmetic of its own.

use antumbra::{LightKind, LightRecord};
use antumbra_render::Ray;
use antumbra_scene::Bounds;
use glam::DVec3;

/// A light's rays.
pub enum Beam {
    /// Parallel, from so far away.
    Sun {
        /// Unit vector.
        towards_light: DVec3,
    },
    /// From a point.
    Lamp(Lamp),
}

/// Where a spot or point light stands, and what it reaches.
pub struct Lamp {
    pub position_world: DVec3,
    /// Unit axes, world; a spot light shines along the third.
    pub axes: [DVec3; 3],
    /// It looks along six axes instead of the third alone.
    pub is_cube: bool,
    pub near_m: f64,
    pub far_m: f64,
    /// Of a spot light.
    cone_cosine: Option<f64>,
    /// Tangent at the edges of its grids.
    pub grid_tangent: f64,
}

/// What lies between a point and a light, whose cone does not count.
pub enum Way {
    /// It lies before everything that casts.
    Bright,
    /// Whatever this path meets.
    Path(Path),
}

/// The way from a point to a light, as far as casters count on it.
#[derive(Clone, Copy)]
pub struct Path {
    /// Of unit direction. Starts farther than at 0 where the point lies beyond the light's range: the bake answers as at
    /// its end.
    pub ray: Ray,
    /// Metres along the ray for each metre of depth, which is measured along an axis of the light.
    pub stretch: f64,
    /// Metres from the ray's start away from the light to where its range ends.
    pub to_far_m: f64,
}

impl Beam {
    pub fn new(record: &LightRecord) -> Self {
        let kind = record.light_kind().unwrap_or(LightKind::Directional);
        if kind == LightKind::Directional {
            return Self::Sun { towards_light: -DVec3::from_array(record.direction_world) };
        }
        Self::Lamp(Lamp {
            position_world: DVec3::from_array(record.origin_world),
            axes: record.linear.map(DVec3::from_array),
            is_cube: record.faces == 6,
            near_m: record.near_m,
            far_m: record.far_m,
            cone_cosine: (kind == LightKind::Spot).then_some(record.cone_cosine),
            grid_tangent: 0.5 * f64::from(record.resolution()) / record.texels_per_tangent,
        })
    }

    /// A point, or the point on its ray where the light's range ends if it lies beyond that.
    pub fn within_range(&self, point_world: DVec3) -> DVec3 {
        let Self::Lamp(lamp) = self else { return point_world };
        let share = lamp.far_m / lamp.depth(point_world);
        let is_beyond = (0.0..1.0).contains(&share);
        if is_beyond { lamp.position_world + (point_world - lamp.position_world) * share } else { point_world }
    }

    /// Whether a point lies outside a spot light's cone.
    pub fn is_outside_cone(&self, point_world: DVec3) -> bool {
        matches!(self, Self::Lamp(lamp) if lamp.is_outside_cone(point_world))
    }

    /// The way from a point to the light.
    pub fn way(&self, point_world: DVec3) -> Way {
        match self {
            Self::Sun { towards_light } => {
                Way::Path(Path { ray: Ray::new(point_world, *towards_light), stretch: 1.0, to_far_m: f64::INFINITY })
            }
            Self::Lamp(lamp) => lamp.way(point_world),
        }
    }
}

impl Lamp {
    fn way(&self, point_world: DVec3) -> Way {
        let depth = self.depth(point_world);
        if depth < self.near_m {
            return Way::Bright;
        }
        let offset = point_world - self.position_world;
        let distance = offset.length();
        let stretch = distance / depth;
        // Where the ray is at a depth.
        let at = |m: f64| distance - m * stretch;
        let ray = Ray::new(point_world, -offset / distance).between(at(self.far_m).max(0.0), at(self.near_m));
        Way::Path(Path { ray, stretch, to_far_m: (-at(self.far_m)).max(0.0) })
    }

    /// Distance along the axis of the side of a cube about the light on which a point lies, or along a spot light's own.
    pub fn depth(&self, point_world: DVec3) -> f64 {
        let offset = point_world - self.position_world;
        let [x, y, z] = self.axes.map(|axis| axis.dot(offset));
        if self.is_cube { x.abs().max(y.abs()).max(z.abs()) } else { z }
    }

    pub fn is_outside_cone(&self, point_world: DVec3) -> bool {
        let offset = point_world - self.position_world;
        self.cone_cosine.is_some_and(|cosine| self.axes[2].dot(offset) < cosine * offset.length())
    }

    /// A box that holds all that the light reaches.
    pub fn bounds(&self) -> Bounds {
        let [a, b, c] = self.axes.map(|axis| axis * self.far_m);
        let mut bounds = Bounds::EMPTY;
        bounds.insert(self.position_world);
        let aside = if self.is_cube { 1.0 } else { self.grid_tangent };
        let nearest = if self.is_cube { -1.0 } else { 1.0 };
        for corner in 0..8 {
            let end = |bit: u32, low: f64, high: f64| if corner & bit == 0 { low } else { high };
            bounds.insert(
                self.position_world + a * end(1, -aside, aside) + b * end(2, -aside, aside) + c * end(4, nearest, 1.0),
            );
        }
        bounds
    }

    /// The point at which a ray's depth is the light's range: for numbers from 0 to 1, all over its grids.
    pub fn far_point(&self, [face, x, y]: [f64; 3]) -> DVec3 {
        let aside = if self.is_cube { 1.0 } else { self.grid_tangent };
        let across = [x, y].map(|share| (2.0 * share - 1.0) * aside);
        let face = if self.is_cube { (face * 6.0) as usize } else { 4 };
        let along = if face.is_multiple_of(2) { 1.0 } else { -1.0 };
        let [next, last] = [1, 2].map(|step| self.axes[(face / 2 + step) % 3]);
        self.position_world + (self.axes[face / 2] * along + next * across[0] + last * across[1]) * self.far_m
    }
}
