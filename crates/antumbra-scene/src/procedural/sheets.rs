//! Open surfaces: sheets cut out of a pattern, tubes without ends, cards for leaves. The counterpart of
//! [`super::solids`], for scenes in which nothing is closed.
//!
//! A sheet is cut along the zero of a field by marching squares (the plane's form of Lorensen and Cline 1987,
//! "Marching Cubes"): so that an arch, a broken top and a hole are all one formula, and their edges come out as a list
//! of segments from which the stone's thickness can be raised.

use glam::{DVec2, DVec3};

use crate::model::{Mesh, Primitive};

/// A corner of a triangle with all that a look needs.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Vertex {
    pub(crate) at: DVec3,
    pub(crate) normal: DVec3,
    pub(crate) texcoord: DVec2,
    /// Linear RGB that multiplies the material's.
    pub(crate) color: DVec3,
}

/// Gathers open surfaces into one mesh.
#[derive(Default)]
pub(crate) struct Sheets {
    parts: Vec<Primitive>,
}

/// Where a point of a sheet's plane lies in space.
pub(crate) type Place<'a> = dyn Fn(DVec2) -> DVec3 + 'a;
/// The colour of a point in space.
pub(crate) type Tint<'a> = dyn Fn(DVec3) -> DVec3 + 'a;

impl Sheets {
    /// The finished mesh.
    pub(crate) fn finish(self, name: &str) -> Mesh {
        Mesh { name: name.to_owned(), primitives: self.parts }
    }

    /// Triangles of any kind. Those that rounding leaves without an area are left out: nothing can tell.
    pub(crate) fn add(&mut self, material: usize, vertices: &[Vertex], triangles: &[[u32; 3]]) {
        let primitive = self.part(material);
        let first = primitive.positions.len() as u32;
        for v in vertices {
            primitive.positions.push(rounded(v.at));
            primitive.normals.push(rounded(v.normal));
            primitive.texcoords.push([v.texcoord.x as f32, v.texcoord.y as f32]);
            primitive.colors.push([v.color.x as f32, v.color.y as f32, v.color.z as f32, 1.0]);
        }
        for t in triangles.iter().map(|t| t.map(|i| first + i)) {
            if twice_area(t.map(|i| primitive.positions[i as usize])) > 1e-7 {
                primitive.triangles.push(t);
            }
        }
    }

    /// One side of a sheet: the side that has its pattern's plane counter-clockwise, or else the other one.
    pub(crate) fn side(&mut self, material: usize, pattern: &Pattern, place: &Place<'_>, front: bool, tint: &Tint<'_>) {
        let normal = |p: DVec2| {
            let across = |d: DVec2| place(p + d) - place(p - d);
            let n = across(DVec2::X * 1e-3).cross(across(DVec2::Y * 1e-3)).normalize_or(DVec3::Y);
            if front { n } else { -n }
        };
        let vertex = |&p: &DVec2| {
            let at = place(p);
            Vertex { at, normal: normal(p), texcoord: p, color: tint(at) }
        };
        let vertices: Vec<_> = pattern.points.iter().map(vertex).collect();
        if front {
            self.add(material, &vertices, &pattern.triangles);
        } else {
            let turned: Vec<_> = pattern.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect();
            self.add(material, &vertices, &turned);
        }
    }

    /// The cut edges between a front and a back: window reveals, soffits of arches, the tops of broken walls.
    pub(crate) fn rim(&mut self, material: usize, pattern: &Pattern, sides: [&Place<'_>; 2], tint: &Tint<'_>) {
        for ends in &pattern.rim {
            let [a, b] = ends.map(|i| pattern.points[i as usize]);
            let corners = [sides[0](a), sides[1](a), sides[1](b), sides[0](b)];
            let deep = (corners[1] - corners[0]).length();
            let uv = [a, a + DVec2::splat(deep), b + DVec2::splat(deep), b];
            self.quad(material, corners, uv, tint);
        }
    }

    /// A flat quad, counter-clockwise.
    pub(crate) fn quad(&mut self, material: usize, corners: [DVec3; 4], uv: [DVec2; 4], tint: &Tint<'_>) {
        let normal = (corners[2] - corners[0]).cross(corners[3] - corners[1]).normalize_or(DVec3::Y);
        let vertices: [Vertex; 4] =
            core::array::from_fn(|i| Vertex { at: corners[i], normal, texcoord: uv[i], color: tint(corners[i]) });
        self.add(material, &vertices, &[[0, 1, 2], [0, 2, 3]]);
    }

    /// A quad around a point with the whole of a texture on it, shaded as if it faced along `normal`.
    pub(crate) fn card(&mut self, material: usize, card: &Card) {
        let (across, up) = (card.across, card.up);
        let corners = [(-1.0, 0.0), (1.0, 0.0), (1.0, 1.0), (-1.0, 1.0)];
        let vertices = corners.map(|(x, y)| Vertex {
            at: card.foot + across * x + up * y,
            normal: card.normal,
            texcoord: DVec2::new(0.5 + 0.5 * x, 1.0 - y),
            color: card.color,
        });
        self.add(material, &vertices, &[[0, 1, 2], [0, 2, 3]]);
    }

    /// A round tube along a line of (centre, radius), open at both ends.
    pub(crate) fn tube(&mut self, material: usize, sides: usize, line: &[(DVec3, f64)], tint: &Tint<'_>) {
        let mut vertices = Vec::with_capacity(line.len() * (sides + 1));
        let mut along = 0.0;
        let overall = (line[line.len() - 1].0 - line[0].0).normalize_or(DVec3::Y);
        let aside = if overall.y.abs() > 0.9 { DVec3::X } else { DVec3::Y };
        for (k, &(center, radius)) in line.iter().enumerate() {
            let (before, after) = (line[k.saturating_sub(1)].0, line[(k + 1).min(line.len() - 1)].0);
            along += (center - before).length();
            // A profile may turn back, as at the rim of a basin; its rings do not.
            let axis = (after - before).normalize_or(overall);
            let axis = if axis.dot(overall) < 0.0 { -axis } else { axis };
            let across = aside.cross(axis).normalize_or(DVec3::Z);
            let up = axis.cross(across);
            let (widens, climbs) = (reach(line, k), (after - before).dot(axis));
            for i in 0..=sides {
                // The last point repeats the first to the bit, with a texture coordinate of its own.
                let angle = core::f64::consts::TAU * (i % sides) as f64 / sides as f64;
                let out = across * libm::cos(angle) + up * libm::sin(angle);
                let texcoord = DVec2::new(i as f64 / sides as f64 * core::f64::consts::TAU * radius, along);
                let at = center + out * radius;
                let normal = (out * climbs - axis * widens).normalize_or(out);
                vertices.push(Vertex { at, normal, texcoord, color: tint(at) });
            }
        }
        let row = sides as u32 + 1;
        let quads = (0..line.len() as u32 - 1).flat_map(|k| (0..row - 1).map(move |i| k * row + i));
        let triangles: Vec<_> = quads.flat_map(|i| [[i, i + 1, i + row + 1], [i, i + row + 1, i + row]]).collect();
        self.add(material, &vertices, &triangles);
    }

    fn part(&mut self, material: usize) -> &mut Primitive {
        let found = self.parts.iter().position(|p| p.material == Some(material));
        let index = found.unwrap_or_else(|| {
            self.parts.push(Primitive { material: Some(material), ..Primitive::default() });
            self.parts.len() - 1
        });
        &mut self.parts[index]
    }
}

/// A rectangle for leaves: it stands on `foot` (the middle of its lower edge).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Card {
    pub(crate) foot: DVec3,
    /// From the middle to the right edge.
    pub(crate) across: DVec3,
    /// From the lower edge to the upper.
    pub(crate) up: DVec3,
    /// For shading; leaves look softer when lit as the surface of the mass they make up.
    pub(crate) normal: DVec3,
    pub(crate) color: DVec3,
}

/// How much wider a tube is after one of its rings than before it.
fn reach(line: &[(DVec3, f64)], k: usize) -> f64 {
    line[(k + 1).min(line.len() - 1)].1 - line[k.saturating_sub(1)].1
}

fn rounded(p: DVec3) -> [f32; 3] {
    [p.x as f32 + 0.0, p.y as f32 + 0.0, p.z as f32 + 0.0]
}

fn twice_area(triangle: [[f32; 3]; 3]) -> f64 {
    let [a, b, c] = triangle.map(|p| DVec3::from_array(p.map(f64::from)));
    (b - a).cross(c - a).length()
}

/// What is left of a rectangle of a plane.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pattern {
    pub(crate) points: Vec<DVec2>,
    /// Counter-clockwise.
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Edges along which the pattern was cut, with what is left on their left. Where it ends with the rectangle it has
    /// no rim.
    pub(crate) rim: Vec<[u32; 2]>,
}

/// A corner of a cell's polygon.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Node,
    /// On an edge of the cell, where the cell's outline goes out of the pattern.
    Leaves,
    /// On an edge of the cell, where the outline comes back.
    Enters,
}

impl Pattern {
    /// Cuts the rectangle from 0 to `size` down to where the field is positive, in square cells about `cell` wide.
    pub(crate) fn cut(size: DVec2, cell: f64, field: impl Fn(DVec2) -> f64) -> Self {
        let cells = (size / cell).round().max(DVec2::ONE);
        let grid = Grid { columns: cells.x as usize, rows: cells.y as usize };
        let spot =
            |i: usize| DVec2::new((i % (grid.columns + 1)) as f64, (i / (grid.columns + 1)) as f64) * size / cells;
        let values: Vec<f64> = (0..(grid.columns + 1) * (grid.rows + 1)).map(|i| field(spot(i))).collect();
        let mut cutter = Cutter { values, spot: &spot, known: Vec::new(), out: Self::default() };
        cutter.known.resize(3 * cutter.values.len(), u32::MAX);
        for row in 0..grid.rows {
            for column in 0..grid.columns {
                cutter.cell(grid, column, row);
            }
        }
        cutter.out
    }
}

#[derive(Clone, Copy)]
struct Grid {
    columns: usize,
    rows: usize,
}

struct Cutter<'a> {
    values: Vec<f64>,
    spot: &'a dyn Fn(usize) -> DVec2,
    /// Points made so far: by node, then by the edge to its right, then by the edge above it.
    known: Vec<u32>,
    out: Pattern,
}

impl Cutter<'_> {
    fn cell(&mut self, grid: Grid, column: usize, row: usize) {
        let low = row * (grid.columns + 1) + column;
        let high = low + grid.columns + 1;
        let ring = [low, low + 1, high + 1, high];
        let mut corners: Vec<(u32, Kind)> = Vec::with_capacity(6);
        for k in 0..4 {
            let (a, b) = (ring[k], ring[(k + 1) % 4]);
            let (inside, next) = (self.values[a] > 0.0, self.values[b] > 0.0);
            if inside {
                corners.push((self.node(a), Kind::Node));
            }
            if inside != next {
                corners.push((self.crossing(a.min(b), a.max(b)), if inside { Kind::Leaves } else { Kind::Enters }));
            }
        }
        for i in 2..corners.len() {
            self.out.triangles.push([corners[0].0, corners[i - 1].0, corners[i].0]);
        }
        for (i, &(to, kind)) in corners.iter().enumerate() {
            let (from, before) = corners[(i + corners.len() - 1) % corners.len()];
            if kind == Kind::Enters && before == Kind::Leaves {
                self.out.rim.push([from, to]);
            }
        }
    }

    fn node(&mut self, i: usize) -> u32 {
        let at = (self.spot)(i);
        self.point(i, at)
    }

    /// Where the field crosses zero between two neighbouring nodes; not so near to either that slivers come of it.
    fn crossing(&mut self, a: usize, b: usize) -> u32 {
        let t = (self.values[a] / (self.values[a] - self.values[b])).clamp(0.06, 0.94);
        let slot = if b == a + 1 { 1 } else { 2 };
        let at = (self.spot)(a).lerp((self.spot)(b), t);
        self.point(slot * self.values.len() + a, at)
    }

    fn point(&mut self, slot: usize, at: DVec2) -> u32 {
        if self.known[slot] == u32::MAX {
            self.known[slot] = self.out.points.len() as u32;
            self.out.points.push(at);
        }
        self.known[slot]
    }
}
