//! Lookups for graphics cards: WGSL text, and the buffers that it reads.
//!
//! The shaders' functions are the twins of this crate's lookups, with the same names behind the prefix `antumbra_`; from
//! whole voxel coordinates on both give the same answers, bit for bit. All that a lookup reads is unsigned words in storage
//! buffers:
//!
//! | binding | buffer | contents |
//! |---|---|---|
//! | first | `array<u32>` | [`Tables::words`]: faces, top grids, beginnings of slices, enter depths |
//! | the next ones | `array<u32>` | the node pool ([`ShadowFile::pool`]) in [`pages`] |
//!
//! A light itself is a [`GpuLight`]: 144 bytes that a shader takes as the struct `AntumbraLight`, from whatever buffer you
//! put it in. It depends on a reference point (the camera, say), from which all positions count: single precision then
//! serves worlds of any size.
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! use antumbra::Encoding;
//! use antumbra::shaders::{Lookup, source};
//!
//! // Bindings 0 and 1 of group 1, a pool in one piece. Each encoding has a text of its own; that of a file is `file.encoding()`.
//! let lookups = source(&Lookup { encoding: Encoding::Silhouette, group: 1, binding: 0, ..Lookup::default() });
//! let shader = format!("{lookups}
//!     @group(0) @binding(0) var<storage, read> sun: AntumbraLight;
//!     fn shadow(position: vec3<f32>, normal: vec3<f32>) -> f32 {{
//!         return antumbra_filtered(sun, position, normal, AntumbraFilter(4u, ANTUMBRA_TENT));
//!     }}");
//! # let _ = shader; Ok(()) }
//! ```

use alloc::collections::BTreeMap;
use alloc::format;
use alloc::string::String;
use alloc::vec;
use alloc::vec::Vec;

use bytemuck::{Pod, Zeroable};
use glam::DVec3;

use crate::format::enter::EnterPyramid;
use crate::lookup::top_grid::TopGrid;
use crate::{Encoding, LightShadow, ShadowFile};

/// The modules that all encodings share; [`source`] puts the access to the buffers and [`encoding_module`] before them.
pub const MODULES: [(&str, &str); 8] = [
    ("lights", include_str!("../shaders/lights.wgsl")),
    ("point", include_str!("../shaders/point.wgsl")),
    ("pcf", include_str!("../shaders/pcf.wgsl")),
    ("project", include_str!("../shaders/project.wgsl")),
    ("prefilter", include_str!("../shaders/prefilter.wgsl")),
    ("blocker", include_str!("../shaders/blocker.wgsl")),
    ("penumbra", include_str!("../shaders/penumbra.wgsl")),
    ("segment", include_str!("../shaders/segment.wgsl")),
];

/// The module that knows an encoding's nodes.
#[must_use]
pub fn encoding_module(encoding: Encoding) -> &'static str {
    match encoding {
        Encoding::Dag8 => include_str!("../shaders/dag8.wgsl"),
        Encoding::Silhouette => {
            concat!(include_str!("../shaders/silhouette.wgsl"), include_str!("../shaders/silhouette_areas.wgsl"))
        }
    }
}

/// How a shader reaches the buffers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lookup {
    /// The file's ([`ShadowFile::encoding`]).
    pub encoding: Encoding,
    /// Bind group of the tables and the pool.
    pub group: u32,
    /// Binding of the tables; the pool's pages follow.
    pub binding: u32,
    /// Into how many pages the pool is divided: see [`pages`].
    pub pages: u32,
    /// log2 of the words of a page; of no consequence for a single one.
    pub log2_page_words: u32,
    /// Whether descents begin at the top grid rather than the root: the same answers, five steps sooner.
    pub top_grid: bool,
    /// Whether to count the words that lookups read, in the private variable `antumbra_words_read`: for measurements.
    pub counting: bool,
}

impl Default for Lookup {
    fn default() -> Self {
        Self {
            encoding: Encoding::default(),
            group: 0,
            binding: 0,
            pages: 1,
            log2_page_words: 31,
            top_grid: true,
            counting: false,
        }
    }
}

/// The lookups in WGSL: declarations only, to put before a shader that calls them.
#[must_use]
pub fn source(lookup: &Lookup) -> String {
    let mut text = access(lookup);
    for module in core::iter::once(encoding_module(lookup.encoding)).chain(MODULES.map(|(_, module)| module)) {
        text.push('\n');
        text.push_str(module);
    }
    text
}

/// The bindings, and the functions that read them.
fn access(lookup: &Lookup) -> String {
    let Lookup { group, binding, .. } = *lookup;
    let pages = lookup.pages.max(1);
    let (counter, count) = if lookup.counting {
        ("var<private> antumbra_words_read: u32;\n", "    antumbra_words_read += 1u;\n")
    } else {
        ("", "")
    };
    let mut text = format!(
        "const ANTUMBRA_TOP_GRID: bool = {};\n{counter}\
         @group({group}) @binding({binding}) var<storage, read> antumbra_tables: array<u32>;\n",
        lookup.top_grid
    );
    for page in 0..pages {
        let at = binding + 1 + page;
        text += &format!("@group({group}) @binding({at}) var<storage, read> antumbra_page_{page}: array<u32>;\n");
    }
    text += &format!("\nfn antumbra_table(i: u32) -> u32 {{\n{count}    return antumbra_tables[i];\n}}\n");
    let of_page = |page: u32, at: &str| format!("antumbra_page_{page}[{at}]");
    text += &reader(lookup, "antumbra_word(i: u32) -> u32", count, |page| of_page(page, "at"));
    if lookup.encoding == Encoding::Silhouette {
        // Four words that begin at a multiple of four lie on one page.
        let four = |page| {
            let words = ["at", "at + 1u", "at + 2u", "at + 3u"].map(|at| of_page(page, at));
            format!("vec4({})", words.join(", "))
        };
        text += &reader(lookup, "antumbra_four_words(i: u32) -> vec4<u32>", &count.repeat(4), four);
    }
    text
}

/// A function that reads the pool: `value` says how on a page.
fn reader(lookup: &Lookup, signature: &str, count: &str, value: impl Fn(u32) -> String) -> String {
    let log2 = lookup.log2_page_words;
    let mut text = format!("\nfn {signature} {{\n{count}");
    if lookup.pages <= 1 {
        text += &format!("    let at = i;\n    return {};\n}}\n", value(0));
        return text;
    }
    text += &format!("    let at = i & {}u;\n    switch i >> {log2}u {{\n", (1u32 << log2) - 1);
    for page in 1..lookup.pages {
        text += &format!("        case {page}u: {{ return {}; }}\n", value(page));
    }
    text += &format!("        default: {{ return {}; }}\n    }}\n}}\n", value(0));
    text
}

/// Divides a pool into pages for bindings of at most `most_bytes`: log2 of the words of a page, and the pages. All but the
/// last have that many words. `None` if a page would hold less than 1024 words.
#[must_use]
pub fn pages(pool: &[u32], most_bytes: u64) -> Option<(u32, Vec<&[u32]>)> {
    let most_words = most_bytes / 4;
    if pool.len() as u64 <= most_words {
        return Some((31, vec![pool]));
    }
    let log2 = most_words.checked_ilog2().filter(|log2| *log2 >= 10)?.min(31);
    Some((log2, pool.chunks(1 << log2).collect()))
}

/// What lookups read beside the node pool, and where each light's part of it is.
#[derive(Clone, Debug)]
pub struct Tables {
    words: Vec<u32>,
    lights: Vec<At>,
}

/// Where a light's tables begin.
#[derive(Clone, Copy, Debug)]
struct At {
    first_face: u32,
    enters: u32,
    slices: u32,
}

impl Tables {
    /// The tables of all lights of a file: 16 bytes for each face and coarse level, its top grid (128 KiB for a sun, 16 KiB for a lamp's face; of
    /// silhouettes 600 and 10 KiB, or a seventh of the pool; each once), where the slices of lamps in silhouettes begin (4 N bytes, once for each ratio of far to near distance), and the enter depths of those lights that want them for blockers and penumbrae (up to 1.4
    /// MB for each face).
    #[must_use]
    pub fn new(file: &ShadowFile, wants_enters: impl Fn(LightShadow<'_>) -> bool) -> Self {
        let mut tables = Self::none();
        let (mut grids_made, mut tables_made) = (BTreeMap::new(), BTreeMap::new());
        for light in file.lights() {
            let first_face = tables.words.len() as u32;
            let record = light.record();
            let count = (1 + light.levels() as usize) * light.faces();
            tables.words.resize(tables.words.len() + 4 * count, 0);
            let mut faces = Vec::with_capacity(4 * count);
            // The light's own faces, then those of its coarse levels: roots of their own, or the light's at wider strides.
            let log2 = record.log2_resolution;
            for level in 0..=light.levels() {
                let (roots, grids, stride) = match level {
                    0 => (&record.roots[..], &file.top_grids[light.index], 0),
                    _ if light.is_silhouette() => (&record.roots[..], &file.top_grids[light.index], level),
                    _ => {
                        let coarser = level as usize - 1;
                        (&file.level_roots[light.index][coarser][..], &file.level_grids[light.index][coarser], 0)
                    }
                };
                for (root, grid) in roots.iter().zip(grids) {
                    let log2_cells = log2 - (level - stride) - grid.level;
                    faces.extend([
                        *root,
                        log2 - level,
                        tables.grid(&mut grids_made, grid),
                        log2_cells | (stride << 16),
                    ]);
                }
            }
            let at = first_face as usize;
            tables.words[at..at + faces.len()].copy_from_slice(&faces);
            let enters = match &file.enters {
                Some(enters) if wants_enters(light) => tables.enters(&enters[light.index].faces),
                _ => 0,
            };
            let slices = tables.slices(&mut tables_made, &file.slices[light.index]);
            tables.lights.push(At { first_face, enters, slices });
        }
        tables
    }

    /// Tables without lights, for shaders that must have some.
    #[must_use]
    pub fn none() -> Self {
        Self { words: vec![0; 4], lights: Vec::new() }
    }

    /// The words to upload.
    #[must_use]
    pub fn words(&self) -> &[u32] {
        &self.words
    }

    fn grid(&mut self, made: &mut BTreeMap<*const TopGrid, u32>, grid: &TopGrid) -> u32 {
        *made.entry(core::ptr::from_ref(grid)).or_insert_with(|| {
            let at = self.words.len() as u32;
            self.words.extend_from_slice(grid.words());
            at
        })
    }

    /// The beginnings of a light's slices, each table once; 0 where there are none.
    fn slices(&mut self, made: &mut BTreeMap<*const u32, u32>, begins: &[u32]) -> u32 {
        if begins.is_empty() {
            return 0;
        }
        *made.entry(begins.as_ptr()).or_insert_with(|| {
            let at = self.words.len() as u32;
            self.words.extend_from_slice(begins);
            at
        })
    }

    /// Face by face, the levels of its pyramid, finest first: a cell is a word, the least depth in its low half.
    fn enters(&mut self, faces: &[EnterPyramid]) -> u32 {
        let at = self.words.len() as u32;
        let cells = faces.iter().flat_map(|face| face.levels.iter().flatten());
        self.words.extend(cells.map(|cell| u32::from(cell.least) | (u32::from(cell.greatest) << 16)));
        at
    }
}

/// A light as shaders take it: the struct `AntumbraLight`, 144 bytes.
///
/// Positions that its lookups are given count from the reference point that it was made for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct GpuLight {
    /// First row of the map to the light's axes: voxels per metre (directional), or a unit axis; the last number is 0.
    pub row_x: [f32; 4],
    /// Second row.
    pub row_y: [f32; 4],
    /// Third row.
    pub row_z: [f32; 4],
    /// Directional: whole part of the reference point's voxel coordinates. Local: in the last word, where the beginnings of its slices are in
    /// the tables; 0 for none.
    pub whole: [i32; 4],
    /// Directional: their fraction. Local: the reference point in the light's axes, metres.
    pub fraction: [f32; 4],
    /// 0 directional, 1 spot, 2 point.
    pub kind: u32,
    /// log2 of the texels per side.
    pub log2_resolution: u32,
    /// 1 or 6.
    pub faces: u32,
    /// Where its faces begin in the tables.
    pub first_face: u32,
    /// Coarse levels.
    pub levels: u32,
    /// Where its enter depths begin in the tables; 0 for none.
    pub enters: u32,
    /// log2 of the cells per side of the finest enter depths.
    pub enter_log2: u32,
    /// Enter depths count in units of two to this many slices.
    pub enter_shift: u32,
    /// Texel size, metres; local lights: per metre of depth.
    pub texel: f32,
    /// Slice size, metres; local lights: per metre of depth (or per square metre, in normalized device coordinates).
    pub slice: f32,
    /// Texels per unit of tangent.
    pub texels_per_tangent: f32,
    /// Near distance, metres.
    pub near_m: f32,
    /// log2 of the near distance.
    pub log2_near: f32,
    /// Slices by which a depth's double lies deeper.
    pub slices_per_octave: f32,
    /// Near over far distance where slices are even in normalized device coordinates, else 0.
    pub ndc_near_share: f32,
    /// Cosine of the cone's half angle; -1 without a cone.
    pub cone_cosine: f32,
}

impl GpuLight {
    /// A light as seen from a reference point (world, metres).
    ///
    /// # Panics
    /// When the tables are of another file, with fewer lights.
    #[must_use]
    pub fn new(light: LightShadow<'_>, tables: &Tables, reference_world: DVec3) -> Self {
        let record = light.record();
        let at = tables.lights[light.index];
        let enters = light.file.enters.as_ref().map(|enters| &enters[light.index]);
        let rows = record.linear.map(|[x, y, z]| [x as f32, y as f32, z as f32, 0.0]);
        let reference = light.projection().in_axes(reference_world);
        let common = Self {
            row_x: rows[0],
            row_y: rows[1],
            row_z: rows[2],
            kind: record.kind,
            log2_resolution: record.log2_resolution,
            faces: record.faces,
            first_face: at.first_face,
            levels: light.levels(),
            enters: at.enters,
            enter_log2: enters.map_or(0, |e| e.faces[0].log2_cells),
            enter_shift: enters.map_or(0, |e| e.shift),
            cone_cosine: -1.0,
            ..Self::default()
        };
        if light.is_local() {
            let fraction = [reference.x as f32, reference.y as f32, reference.z as f32, 0.0];
            return Self { fraction, whole: [0, 0, 0, at.slices as i32], ..common }.with_depths(light);
        }
        // Whole parts far from any grid saturate: nothing there is inside.
        let whole = reference.to_array().map(|c| libm::floor(c).clamp(-1e9, 1e9));
        let fraction = [0, 1, 2].map(|axis| (reference[axis] - whole[axis]) as f32);
        Self {
            whole: [whole[0] as i32, whole[1] as i32, whole[2] as i32, 0],
            fraction: [fraction[0], fraction[1], fraction[2], 0.0],
            texel: record.texel_size_m as f32,
            slice: record.slice_size_m as f32,
            ..common
        }
    }

    /// What a local light has beside its axes.
    fn with_depths(self, light: LightShadow<'_>) -> Self {
        let record = light.record();
        let is_ndc = record.depth_distribution() == Some(crate::DepthDistribution::Ndc);
        let side = f64::from(record.resolution());
        let share = record.near_m / record.far_m;
        let octaves = -libm::log2(share);
        let slice =
            if is_ndc { (1.0 - share) / (record.near_m * side) } else { octaves * core::f64::consts::LN_2 / side };
        Self {
            texel: (1.0 / record.texels_per_tangent) as f32,
            slice: slice as f32,
            texels_per_tangent: record.texels_per_tangent as f32,
            near_m: record.near_m as f32,
            log2_near: libm::log2(record.near_m) as f32,
            slices_per_octave: (side / octaves) as f32,
            ndc_near_share: if is_ndc { share as f32 } else { 0.0 },
            cone_cosine: if record.kind == 1 { record.cone_cosine as f32 } else { -1.0 },
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pools_divide_into_pages() {
        let pool: Vec<u32> = (0..5000).collect();
        assert_eq!(pages(&pool, 20_000), Some((31, vec![&pool[..]])));
        let (log2, parts) = pages(&pool, 10_000).expect("pages of 2048 words");
        assert_eq!((log2, parts.len()), (11, 3));
        assert_eq!(parts.concat(), pool);
        assert_eq!(pages(&pool, 4000), None);
    }
}
