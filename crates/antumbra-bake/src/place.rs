//! Joins casters and light space: lays a light's grid and puts the casters on its lattice.

use antumbra::{DepthDistribution, Interior, LightRecord};
use antumbra_scene::{Light, LightKind};
use glam::DVec3;
use rayon::prelude::*;

use crate::Pause;
use crate::bake::{BakeError, ResolutionRequest};
use crate::casters::occluder::FirstHits;
use crate::casters::{CasterTriangle, Casters, OpenedParts, Piece};
use crate::columns::{BuildTriangle, Cutout, CutoutCorners, Freedom};
use crate::light_space::{DirectionalSpace, LATERAL_BITS, LatticeTriangle, LocalLight, LocalSpace, Resolution, Slices};

/// Corners farther out than this are taken for a mistake: squares of such lengths still fit an `f64`.
const FARTHEST_M: f64 = 1e100;
/// Near distance of a local light in parts of its range, unless told otherwise.
const NEAR_SHARE: f64 = 1.0 / 1024.0;
/// Least near distance in parts of the range: slices nearer than that would be finer than the depth lattice.
const LEAST_NEAR_SHARE: f64 = 1e-6;

/// A light's grid, or grids.
#[derive(Clone, Copy, Debug)]
pub enum LightSpace {
    /// Parallel rays.
    Directional(DirectionalSpace),
    /// Rays from a point.
    Local(LocalSpace),
}

/// Wishes about a light's grid.
#[derive(Clone, Copy, Debug)]
pub struct SpaceRequest {
    /// How fine.
    pub resolution: ResolutionRequest,
    /// Near distance of local lights, metres.
    pub near_m: Option<f64>,
    /// How local lights' slices are spread.
    pub distribution: DepthDistribution,
}

impl LightSpace {
    /// The grid of a light: about the casters, or about the light.
    ///
    /// # Errors
    /// [`BakeError::TexelSize`] if no resolution has such small texels, [`BakeError::Misplaced`] if a corner is not finite,
    /// [`BakeError::LightPlace`] and [`BakeError::Near`] if a local light's numbers make no sense.
    pub fn new(
        casters: &Casters<'_>,
        light: &Light,
        request: SpaceRequest,
        pause: Pause<'_>,
    ) -> Result<Self, BakeError> {
        match light.kind {
            LightKind::Directional => {
                fit_directional(casters, light.direction_world, request.resolution, pause).map(Self::Directional)
            }
            LightKind::Spot { .. } | LightKind::Point => lay_local(casters, light, request).map(Self::Local),
        }
    }

    /// Texels per side.
    #[must_use]
    pub fn resolution(&self) -> Resolution {
        match self {
            Self::Directional(space) => space.resolution(),
            Self::Local(space) => space.resolution(),
        }
    }

    /// Grids: 1 or 6.
    #[must_use]
    pub fn faces(&self) -> usize {
        match self {
            Self::Directional(_) => 1,
            Self::Local(space) => space.faces(),
        }
    }

    /// From depth on the lattice to slices.
    #[must_use]
    pub fn slices(&self) -> Slices {
        match self {
            Self::Directional(space) => Slices::even(space.resolution()),
            Self::Local(s) => Slices::local(s.resolution(), s.far_m() / s.near_m(), s.distribution()),
        }
    }

    /// What a policy leaves free behind open surfaces.
    #[must_use]
    pub fn freedom(&self, interior: Interior) -> Freedom {
        match self {
            Self::Directional(space) => Freedom::directional(interior, space.slice_size_m()),
            Self::Local(space) => Freedom::local(interior, space),
        }
    }

    /// The light's record but for its name, policy and roots.
    #[must_use]
    pub fn record(&self) -> LightRecord {
        match self {
            Self::Directional(space) => space.record(),
            Self::Local(space) => space.record(),
        }
    }

    /// Closed parts that the light's rays do not start outside of.
    #[must_use]
    pub fn opened_parts(&self, casters: &Casters<'_>) -> OpenedParts {
        match self {
            Self::Directional(_) => OpenedParts::default(),
            // The near planes of a spot light's one face reach as far aside as its grid does.
            Self::Local(space) => {
                let half_side_m = space.near_m() * space.tangent_of_grid().max(1.0);
                casters.opened_parts(space.position_world(), space.axes(), half_side_m)
            }
        }
    }

    /// A caster's alpha test on a face, if it has one.
    #[must_use]
    pub fn cutout<'a>(&self, caster: &CasterTriangle<'a>, face: usize) -> Option<Cutout<'a>> {
        let masked = caster.masked.as_ref()?;
        let homogeneous = self.homogeneous(caster.corners, face);
        let corners = CutoutCorners { homogeneous, texcoords: masked.texcoords, alpha: masked.alpha };
        Some(Cutout::new(masked.test, &corners))
    }

    /// The corners of a caster times their weights, in a face's lattice coordinates: see [`CutoutCorners`].
    fn homogeneous(&self, corners: [DVec3; 3], face: usize) -> [DVec3; 3] {
        let middle = 0.5 * (1u64 << LATERAL_BITS) as f64;
        corners.map(|corner| match self {
            Self::Directional(space) => space.lattice_point(corner).extend(1.0),
            Self::Local(space) => {
                let p = space.on_face(corner, face);
                let scale = space.steps_per_tangent();
                DVec3::new(p.x * scale + p.z * middle, p.y * scale + p.z * middle, p.z)
            }
        })
    }
}

fn fit_directional(
    casters: &Casters<'_>,
    direction_world: DVec3,
    request: ResolutionRequest,
    pause: Pause<'_>,
) -> Result<DirectionalSpace, BakeError> {
    let axes = DirectionalSpace::axes(direction_world);
    let pieces = casters.pieces();
    let first_of = |piece: &Piece<'_, '_>| {
        let mut first = None;
        piece.for_each(pause, |t| _ = first.get_or_insert(t.corners[0]));
        first
    };
    let origin = pieces.iter().find_map(first_of).unwrap_or_default();
    let extents = pieces.par_iter().map(|piece| extent_of(piece, &axes, origin, pause));
    let (extent, misplaced) = extents.reduce(
        || ([DVec3::INFINITY, DVec3::NEG_INFINITY], None),
        |(a, node), (b, later)| ([a[0].min(b[0]), a[1].max(b[1])], node.or(later)),
    );
    if let Some(node) = misplaced {
        return Err(BakeError::Misplaced(casters.scene().nodes[node].name.clone()));
    }
    let side_m = DirectionalSpace::side_m(extent);
    let resolution = choose(request, Resolution::DEFAULT_DIRECTIONAL, side_m, |r| side_m / f64::from(r.texels()))?;
    Ok(DirectionalSpace::fit(axes, origin, extent, resolution))
}

/// Extent of a piece in light space, and the node of its first misplaced triangle.
fn extent_of(piece: &Piece<'_, '_>, axes: &[DVec3; 3], origin: DVec3, pause: Pause<'_>) -> ([DVec3; 2], Option<usize>) {
    let mut extent = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let mut misplaced = None;
    piece.for_each(pause, |t| {
        if is_misplaced(&t) {
            misplaced.get_or_insert(t.node);
            return;
        }
        let [min, max] = DirectionalSpace::extent(axes, origin, t.corners.into_iter());
        extent = [extent[0].min(min), extent[1].max(max)];
    });
    (extent, misplaced)
}

fn is_misplaced(triangle: &CasterTriangle<'_>) -> bool {
    triangle.corners.iter().any(|c| c.abs().max_element() > FARTHEST_M || c.is_nan())
}

/// The resolution that was asked for; for a texel size the least that has it.
fn choose(
    request: ResolutionRequest,
    default: Resolution,
    extent_m: f64,
    texel_m: impl Fn(Resolution) -> f64,
) -> Result<Resolution, BakeError> {
    match request {
        ResolutionRequest::Default => Ok(default),
        ResolutionRequest::Texels(resolution) => Ok(resolution),
        ResolutionRequest::TexelSize(wanted_m) => Resolution::all()
            .find(|r| texel_m(*r) <= wanted_m)
            .ok_or_else(|| BakeError::TexelSize { texel_m: wanted_m, extent_m, least_m: texel_m(Resolution::MAX) }),
    }
}

fn lay_local(casters: &Casters<'_>, light: &Light, request: SpaceRequest) -> Result<LocalSpace, BakeError> {
    let far_m = light.range_m.unwrap_or_else(|| casters.scene().bounds(|_| true).diagonal());
    let near_m = request.near_m.unwrap_or(far_m * NEAR_SHARE);
    let is_sane = |m: f64| m > 0.0 && m < FARTHEST_M;
    if !is_sane(far_m) || !light.position_world.is_finite() || light.position_world.abs().max_element() > FARTHEST_M {
        return Err(BakeError::LightPlace(light.name.clone()));
    }
    if !is_sane(near_m) || near_m >= far_m || near_m < far_m * LEAST_NEAR_SHARE {
        let (name, least_m) = (light.name.clone(), far_m * LEAST_NEAR_SHARE);
        return Err(BakeError::Near { light: name, near_m, least_m, far_m });
    }
    let texel_m = |r: Resolution| far_m / LocalSpace::texels_per_tangent(light.kind, r);
    let extent_m = 2.0 * far_m * LocalSpace::reach(light.kind);
    let resolution = choose(request.resolution, Resolution::DEFAULT_LOCAL, extent_m, texel_m)?;
    let local = LocalLight {
        kind: light.kind,
        position_world: light.position_world,
        direction_world: light.direction_world,
        near_m,
        far_m,
        distribution: request.distribution,
    };
    Ok(LocalSpace::new(&local, resolution))
}

/// Calls `each` with every caster on the lattice of each face that may see it, and with the face and the caster itself:
/// in the scene's order, and face by face for each caster. A caster that is clipped comes in several triangles.
pub fn for_each_placed<'s>(
    casters: &Casters<'s>,
    space: &LightSpace,
    opened: &OpenedParts,
    mut each: impl FnMut(usize, &LatticeTriangle, &CasterTriangle<'s>),
) {
    match space {
        LightSpace::Directional(_) => casters.for_each(|caster| place(&caster, space, opened, &mut each)),
        LightSpace::Local(local) => {
            casters.for_each_near(&local.bounds(), |caster| place(&caster, space, opened, &mut each));
        }
    }
}

/// The same for one caster.
fn place<'s>(
    caster: &CasterTriangle<'s>,
    space: &LightSpace,
    opened: &OpenedParts,
    each: &mut impl FnMut(usize, &LatticeTriangle, &CasterTriangle<'s>),
) {
    let solid = caster.solid && !caster.part.is_some_and(|part| opened.contains(part));
    let mut place = |face: usize, corners: [([i32; 2], u32); 3]| {
        let triangle =
            LatticeTriangle { x: corners.map(|c| c.0[0]), y: corners.map(|c| c.0[1]), z: corners.map(|c| c.1), solid };
        each(face, &triangle, caster);
    };
    match space {
        LightSpace::Directional(space) => place(0, caster.corners.map(|c| space.snap(c))),
        LightSpace::Local(_) if is_misplaced(caster) => {}
        LightSpace::Local(local) => {
            for face in 0..local.faces() {
                local.place(caster.corners, face, |corners| place(face, corners));
            }
        }
    }
}

/// The casters of a directional light, placed by all threads.
pub(crate) fn place_all<'s>(
    casters: &Casters<'s>,
    space: &LightSpace,
    slices: &Slices,
    pause: Pause<'_>,
) -> (FaceCasters<'s>, FirstHits) {
    let opened = OpenedParts::default();
    let placed = |piece: &Piece<'_, 's>| {
        let (mut placed, mut first_hits) = (FaceCasters::default(), FirstHits::default());
        piece.for_each(pause, |caster| {
            place(&caster, space, &opened, &mut |face, triangle, caster: &CasterTriangle<'s>| {
                first_hits.insert(triangle, caster.node);
                placed.insert(triangle, caster, space, slices, face);
            });
        });
        (placed, first_hits)
    };
    let (mut all, mut first_hits) = (FaceCasters::default(), FirstHits::default());
    all.triangles.reserve_exact(casters.len());
    // Not all at once: pieces and their sum would take twice the memory.
    for pieces in casters.pieces().chunks(2 * rayon::current_num_threads()) {
        let placed: Vec<(FaceCasters<'s>, FirstHits)> = pieces.par_iter().map(placed).collect();
        for (piece, hits) in placed {
            all.append(piece);
            first_hits.append(&hits);
            pause();
        }
    }
    (all, first_hits)
}

/// What a face's construction starts from.
#[derive(Clone, Debug, Default)]
pub struct FaceCasters<'a> {
    /// The casters.
    pub triangles: Vec<BuildTriangle>,
    /// What those of them refer to that are masked.
    pub cutouts: Vec<Cutout<'a>>,
}

impl<'a> FaceCasters<'a> {
    /// Adds a caster that was placed on a face's lattice.
    pub fn insert(
        &mut self,
        triangle: &LatticeTriangle,
        caster: &CasterTriangle<'a>,
        space: &LightSpace,
        slices: &Slices,
        face: usize,
    ) {
        let Some(built) = BuildTriangle::new(triangle, slices) else { return };
        let Some(cutout) = space.cutout(caster, face) else { return self.triangles.push(built) };
        self.triangles.push(built.with_cutout(self.cutouts.len() as u32));
        self.cutouts.push(cutout);
    }

    /// Adds casters that come later in the scene.
    fn append(&mut self, later: Self) {
        let before = self.cutouts.len() as u32;
        let moved = |t: BuildTriangle| t.cutout().map_or(t, |cutout| t.with_cutout(before + cutout as u32));
        self.triangles.extend(later.triangles.into_iter().map(moved));
        self.cutouts.extend(later.cutouts);
    }
}
