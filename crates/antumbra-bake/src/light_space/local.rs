//! The perspective grids of a spot or point light.
//!
//! A spot light whose cone is narrow has one face about its axis; a wide one and a point light have six, the sides of a
//! cube. See [`antumbra::lookup::project`] for the faces' axes. On the lattice x/z and y/z take the place of x and y, and
//! depth is 1 - near/z: linear over a triangle, so that everything exact works as it does for a directional light.

use antumbra::lookup::project::face_axes;
use antumbra::{DepthDistribution, FACE_BORDER, LightKind, LightRecord};
use antumbra_scene::Bounds;
use glam::DVec3;

use super::clip::Polygon;
use super::{DEPTH_BITS, DirectionalSpace, LATERAL_BITS, Resolution};

/// Cones with a greater half angle get the six faces of a cube: the tangent of this one is 1.73.
const WIDEST_CONE: f64 = std::f64::consts::FRAC_PI_3;
/// The one face of a narrow spot light.
const SPOT_FACE: usize = 4;
/// Lattice coordinates reach this many sides from the grid's middle.
const GUARD_SIDES: f64 = 1.5;

/// Where a local light's rays start, and how its grids lie about it.
#[derive(Clone, Copy, Debug)]
pub struct LocalSpace {
    resolution: Resolution,
    kind: LightKind,
    distribution: DepthDistribution,
    position_world: DVec3,
    /// The light's own unit axes, world: right, down, along for a spot light; the world's for a point light.
    axes: [DVec3; 3],
    is_cube: bool,
    near_m: f64,
    far_m: f64,
    cone_cosine: f64,
    texels_per_tangent: f64,
}

/// What a local light is, apart from its resolution.
#[derive(Clone, Copy, Debug)]
pub struct LocalLight {
    /// Spot or point.
    pub kind: antumbra_scene::LightKind,
    /// World position.
    pub position_world: DVec3,
    /// Unit vector along which a spot light shines.
    pub direction_world: DVec3,
    /// Casters nearer than this along a face's axis are ignored, metres.
    pub near_m: f64,
    /// Where the light ends, metres.
    pub far_m: f64,
    /// How slices are spread.
    pub distribution: DepthDistribution,
}

impl LocalSpace {
    /// Tangent of the widest angle that a face must show, to either side of its axis.
    #[must_use]
    pub fn reach(kind: antumbra_scene::LightKind) -> f64 {
        match kind {
            antumbra_scene::LightKind::Spot { outer_angle, .. } if outer_angle <= WIDEST_CONE => libm::tan(outer_angle),
            _ => 1.0,
        }
    }

    /// Texels per unit of tangent: the reach ends [`FACE_BORDER`] texels before the grid does.
    #[must_use]
    pub fn texels_per_tangent(kind: antumbra_scene::LightKind, resolution: Resolution) -> f64 {
        f64::from(resolution.texels() / 2 - FACE_BORDER) / Self::reach(kind)
    }

    /// Lays a light's grids.
    #[must_use]
    pub fn new(light: &LocalLight, resolution: Resolution) -> Self {
        let (kind, axes, is_cube, cone_cosine) = match light.kind {
            antumbra_scene::LightKind::Spot { outer_angle, .. } => {
                let axes = DirectionalSpace::axes(light.direction_world);
                (LightKind::Spot, axes, outer_angle > WIDEST_CONE, libm::cos(outer_angle))
            }
            _ => (LightKind::Point, [DVec3::X, DVec3::Y, DVec3::Z], true, 0.0),
        };
        Self {
            resolution,
            kind,
            distribution: light.distribution,
            position_world: light.position_world,
            axes,
            is_cube,
            near_m: light.near_m,
            far_m: light.far_m,
            cone_cosine,
            texels_per_tangent: Self::texels_per_tangent(light.kind, resolution),
        }
    }

    /// The grids' resolution.
    #[must_use]
    pub fn resolution(&self) -> Resolution {
        self.resolution
    }

    /// Grids: 1 or 6.
    #[must_use]
    pub fn faces(&self) -> usize {
        if self.is_cube { 6 } else { 1 }
    }

    /// Where the light stands.
    #[must_use]
    pub fn position_world(&self) -> DVec3 {
        self.position_world
    }

    /// The light's own unit axes, world.
    #[must_use]
    pub fn axes(&self) -> [DVec3; 3] {
        self.axes
    }

    /// Distance along a face's axis before which casters are ignored, metres.
    #[must_use]
    pub fn near_m(&self) -> f64 {
        self.near_m
    }

    /// Distance along a face's axis at which the light ends, metres.
    #[must_use]
    pub fn far_m(&self) -> f64 {
        self.far_m
    }

    /// How slices are spread.
    #[must_use]
    pub fn distribution(&self) -> DepthDistribution {
        self.distribution
    }

    /// World box outside which no caster matters.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        let [right, down, along] = self.axes;
        // A cube's faces reach a little beyond its edges; one face's pyramid ends in a square.
        let half_m = self.far_m * self.tangent_of_grid() * (1.0 + 1e-9);
        let ends = if self.is_cube { [-half_m, half_m] } else { [0.0, self.far_m * (1.0 + 1e-9)] };
        let mut bounds = Bounds::EMPTY;
        for end in ends {
            let half_m = if end == 0.0 { 0.0 } else { half_m };
            for (x, y) in [(-half_m, -half_m), (half_m, -half_m), (-half_m, half_m), (half_m, half_m)] {
                bounds.insert(self.position_world + right * x + down * y + along * end);
            }
        }
        bounds
    }

    /// Tangent at the grid's edge.
    #[must_use]
    pub fn tangent_of_grid(&self) -> f64 {
        0.5 * f64::from(self.resolution.texels()) / self.texels_per_tangent
    }

    /// Metres about the light to a face's axes: right, down, along.
    #[must_use]
    pub fn on_face(&self, world: DVec3, face: usize) -> DVec3 {
        let offset = world - self.position_world;
        let [right, down, along] = face_axes(self.axes, if self.is_cube { face } else { SPOT_FACE });
        DVec3::new(right.dot(offset), down.dot(offset), along.dot(offset))
    }

    /// Calls `each` with the triangles, on a face's lattice, of what a world triangle shows there: x, y and depth of
    /// their corners, in the triangle's order of turning. Usually one or none; more where it must be clipped.
    pub fn place(&self, corners: [DVec3; 3], face: usize, mut each: impl FnMut([([i32; 2], u32); 3])) {
        let corners = corners.map(|c| self.on_face(c, face));
        let outside = |side: &dyn Fn(DVec3) -> f64| corners.iter().all(|c| side(*c) < 0.0);
        let (near, grid, guard) = (self.near_m, self.tangent_of_grid(), self.guard_tangent());
        if outside(&|p| p.z - near)
            || outside(&|p| self.far_m - p.z)
            || [-grid, grid].iter().any(|g| outside(&|p| g.abs() * p.z - g.signum() * p.x))
            || [-grid, grid].iter().any(|g| outside(&|p| g.abs() * p.z - g.signum() * p.y))
        {
            return;
        }
        let mut polygon = Polygon::new(corners);
        polygon.clip(|p| p.z - near);
        // Only what would leave the lattice is cut at its sides.
        polygon.clip(|p| guard * p.z - p.x);
        polygon.clip(|p| guard * p.z + p.x);
        polygon.clip(|p| guard * p.z - p.y);
        polygon.clip(|p| guard * p.z + p.y);
        let placed = |p: &DVec3| self.snap(*p);
        if let [first, rest @ ..] = polygon.corners() {
            rest.windows(2).for_each(|pair| each([placed(first), placed(&pair[0]), placed(&pair[1])]));
        }
    }

    /// Tangent at the lattice's end.
    fn guard_tangent(&self) -> f64 {
        2.0 * GUARD_SIDES * self.tangent_of_grid()
    }

    /// Lattice steps per unit of tangent.
    #[must_use]
    pub fn steps_per_tangent(&self) -> f64 {
        self.texels_per_tangent * self.resolution.texel_steps() as f64
    }

    /// Rounds a point in a face's axes to the lattice.
    fn snap(&self, p: DVec3) -> ([i32; 2], u32) {
        let side = (1u64 << LATERAL_BITS) as f64;
        let across = |v: f64| {
            let steps = v / p.z * self.steps_per_tangent() + 0.5 * side;
            (steps + 0.5).floor().clamp(-side, 2.0 * side) as i32
        };
        let steps = (1u64 << DEPTH_BITS) as f64;
        let along = ((1.0 - self.near_m / p.z) * steps + 0.5).floor().clamp(0.0, steps - 1.0) as u32;
        ([across(p.x), across(p.y)], along)
    }

    /// The light's record but for its name, policy and roots.
    #[must_use]
    pub fn record(&self) -> LightRecord {
        LightRecord {
            kind: self.kind as u32,
            log2_resolution: self.resolution.log2(),
            texel_size_m: self.far_m / self.texels_per_tangent,
            near_m: self.near_m,
            far_m: self.far_m,
            cone_cosine: self.cone_cosine,
            origin_world: self.position_world.to_array(),
            linear: self.axes.map(|a| a.to_array()),
            direction_world: if self.kind == LightKind::Spot { self.axes[2].to_array() } else { [0.0; 3] },
            faces: self.faces() as u32,
            depth: self.distribution as u32,
            texels_per_tangent: self.texels_per_tangent,
            ..bytemuck::Zeroable::zeroed()
        }
    }
}
