//! Sorts the triangles of a file into usable ones, seams and dropped ones. Every loader and generator goes through here,
//! so that whatever follows may rely on [`Primitive`]'s promises.

use crate::error::SceneError;
use crate::model::{Dropped, Primitive, Scene};

/// The triangles of one primitive after sorting.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Sorted {
    /// See [`Primitive::triangles`].
    pub triangles: Vec<[u32; 3]>,
    /// See [`Primitive::seams`].
    pub seams: Vec<[u32; 3]>,
}

/// Sorts triangles over `positions` into usable ones and seams and counts the rest in `dropped`.
///
/// Seams count as dropped too, under `zero_area`.
pub fn sort_triangles(
    positions: &[[f32; 3]],
    candidates: impl IntoIterator<Item = [u32; 3]>,
    dropped: &mut Dropped,
) -> Sorted {
    let candidates = candidates.into_iter();
    let mut sorted = Sorted { triangles: Vec::with_capacity(candidates.size_hint().0), seams: Vec::new() };
    for triangle in candidates {
        match judge(positions, triangle) {
            Verdict::Usable => sorted.triangles.push(triangle),
            Verdict::Seam => {
                sorted.seams.push(triangle);
                dropped.zero_area += 1;
            }
            Verdict::ZeroArea => dropped.zero_area += 1,
            Verdict::NotFinite => dropped.not_finite += 1,
            Verdict::BadIndex => dropped.bad_index += 1,
        }
    }
    sorted
}

enum Verdict {
    Usable,
    Seam,
    ZeroArea,
    NotFinite,
    BadIndex,
}

fn judge(positions: &[[f32; 3]], triangle: [u32; 3]) -> Verdict {
    let [Some(&a), Some(&b), Some(&c)] = triangle.map(|i| positions.get(i as usize)) else {
        return Verdict::BadIndex;
    };
    if ![a, b, c].iter().flatten().all(|v| v.is_finite()) {
        Verdict::NotFinite
    } else if !has_zero_area([a, b, c]) {
        Verdict::Usable
    } else if a == b || b == c || c == a {
        Verdict::ZeroArea
    } else {
        Verdict::Seam
    }
}

/// Whether the corners lie on one line, or coincide.
///
/// The differences of `f32` corners and their products fit an `f64` unless the corners' magnitudes are far apart, so
/// that "exactly zero" neither loses slivers nor keeps collapsed triangles.
#[must_use]
pub fn has_zero_area(corners: [[f32; 3]; 3]) -> bool {
    let [a, b, c] = corners.map(|p| glam::DVec3::from_array(p.map(f64::from)));
    (b - a).cross(c - a) == glam::DVec3::ZERO
}

impl Primitive {
    /// Sets [`Primitive::triangles`] and [`Primitive::seams`] from unchecked triangles over the positions already set.
    pub fn set_triangles(&mut self, candidates: impl IntoIterator<Item = [u32; 3]>, dropped: &mut Dropped) {
        let sorted = sort_triangles(&self.positions, candidates, dropped);
        self.triangles = sorted.triangles;
        self.seams = sorted.seams;
    }
}

impl Scene {
    /// Passes the scene on if any placed mesh has a triangle.
    ///
    /// # Errors
    /// [`SceneError::NothingLeft`] otherwise.
    pub fn with_something_left(self) -> Result<Self, SceneError> {
        if self.nodes.iter().any(|n| self.meshes[n.mesh].triangle_count() > 0) {
            Ok(self)
        } else {
            Err(SceneError::NothingLeft { file: self.name, dropped: self.dropped })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NAN: f32 = f32::NAN;

    #[test]
    fn each_triangle_goes_where_it_belongs() {
        let positions = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [2.0, 0.0, 0.0],
            [-0.0, 0.0, 0.0],
            [NAN, 0.0, 0.0],
            [0.0, f32::INFINITY, 0.0],
        ];
        let mut dropped = Dropped::default();
        let candidates =
            [[0, 1, 2], [0, 1, 3], [0, 1, 1], [0, 4, 2], [0, 1, 5], [0, 1, 6], [0, 1, 7], [0, 1, u32::MAX]];
        let sorted = sort_triangles(&positions, candidates, &mut dropped);
        assert_eq!(sorted, Sorted { triangles: vec![[0, 1, 2]], seams: vec![[0, 1, 3]] });
        assert_eq!(dropped, Dropped { not_finite: 2, zero_area: 3, bad_index: 2 });
    }

    #[test]
    fn slivers_and_tiny_triangles_have_area() {
        let tiny = f32::from_bits(1);
        assert!(!has_zero_area([[0.0; 3], [tiny, 0.0, 0.0], [0.0, tiny, 0.0]]));
        assert!(!has_zero_area([[1e6, 0.0, 0.0], [1e6 + 1.0, 0.0, 0.0], [1e6, f32::MIN_POSITIVE, 0.0]]));
        assert!(!has_zero_area([[-3e38, 0.0, 0.0], [3e38, 0.0, 0.0], [0.0, 1e-30, 0.0]]));
        assert!(has_zero_area([[0.1, 0.1, 0.1], [0.2, 0.2, 0.2], [0.4, 0.4, 0.4]]));
    }
}
