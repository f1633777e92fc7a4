//! The standard that voxel culling is held against: cells outside of the camera's and of the light's frusta.

use antumbra_scene::Bounds;
use glam::DVec3;

/// The convex hull of a few points, as planes.
#[derive(Clone, Debug, PartialEq)]
pub struct Hull {
    /// Normal outward, and its dot product with the plane's points.
    planes: Vec<(DVec3, f64)>,
}

impl Hull {
    /// Of what casts shadows into a view that is seen up to a distance, from a light: the camera's frustum and the light.
    #[must_use]
    pub fn of_view(corners_of_far_plane: [DVec3; 4], eye: DVec3, light: DVec3) -> Self {
        let [a, b, c, d] = corners_of_far_plane;
        Self::new(&[a, b, c, d, eye, light])
    }

    /// Of points: every plane through three of them that has all others on one side.
    #[must_use]
    pub fn new(points: &[DVec3]) -> Self {
        let mut planes = Vec::new();
        let size = points.iter().map(|p| (*p - points[0]).length()).fold(0.0, f64::max);
        for (i, &a) in points.iter().enumerate() {
            for (j, &b) in points.iter().enumerate().skip(i + 1) {
                for &c in &points[j + 1..] {
                    let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
                    for normal in [normal, -normal] {
                        if points.iter().all(|p| normal.dot(*p - a) <= 1e-9 * size) {
                            planes.push((normal, normal.dot(a)));
                        }
                    }
                }
            }
        }
        Self { planes }
    }

    /// Its planes: normals outward, and their dot products with the planes' points.
    pub fn planes(&self) -> impl Iterator<Item = (DVec3, f64)> + '_ {
        self.planes.iter().copied()
    }

    /// Whether a box may touch the hull: false only where one of its planes parts them.
    #[must_use]
    pub fn touches(&self, bounds: &Bounds) -> bool {
        let nearest = |normal: DVec3| DVec3::select(normal.cmpge(DVec3::ZERO), bounds.min, bounds.max);
        self.planes.iter().all(|(normal, at)| normal.dot(nearest(*normal)) <= *at)
    }
}

/// Which of the six faces of a light's cube map a box may appear in: a bit each, +x, -x, +y, -y, +z, -z.
#[must_use]
pub fn faces_of(bounds: &Bounds, light: DVec3) -> u32 {
    let (low, high) = (bounds.min - light, bounds.max - light);
    let mut faces = 0;
    for axis in 0..3 {
        // The greatest extent along the face's axis, and the least of what must not exceed it.
        for (bit, along) in [(2 * axis, high[axis]), (2 * axis + 1, -low[axis])] {
            let aside = |other: usize| low[other].max(-high[other]).max(0.0);
            let (u, v) = (aside((axis + 1) % 3), aside((axis + 2) % 3));
            faces |= u32::from(along >= u.max(v)) << bit;
        }
    }
    faces
}
