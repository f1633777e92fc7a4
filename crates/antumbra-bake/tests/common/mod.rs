//! Scenes for tests, and the check of a bake against the oracle.
#![allow(dead_code, reason = "each test program uses its own share")]

use std::path::PathBuf;

use antumbra::lookup::project::face_axes;
use antumbra::{DepthDistribution, Interior, LightKind as Kind, LightRecord, LightShadow, ShadowFile};
use antumbra_bake::casters::{Blend, CasterOptions, Casters, Inverted, MaskedTriangle};
use antumbra_bake::light_space::{LATERAL_BITS, LatticeTriangle, Resolution};
use antumbra_bake::oracle::{Free, Interval, Oracle, View};
use antumbra_bake::place::{LightSpace, SpaceRequest, for_each_placed};
use antumbra_bake::{BakeOptions, Encoding, ResolutionRequest, Silent, bake};
use antumbra_scene::{Light, LightKind, Mesh, Node, Primitive, Scene};
use glam::{DAffine3, DMat3, DQuat, DVec3};
use proptest::prelude::*;
use rayon::prelude::*;

/// Folder of real scenes, where there is one.
pub fn shared_scenes() -> Vec<PathBuf> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/scenes");
    let files = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|e| e.path());
    let mut scenes: Vec<PathBuf> = files.filter(|p| p.extension().is_some_and(|e| e == "glb")).collect();
    scenes.sort();
    scenes
}

pub fn sun(direction: [f64; 3]) -> Light {
    Light {
        name: "sun".into(),
        kind: LightKind::Directional,
        position_world: DVec3::ZERO,
        direction_world: DVec3::from_array(direction).normalize(),
        color: [1.0; 3],
        intensity: 1.0,
        range_m: None,
        dynamic: false,
    }
}

/// A light all round.
pub fn lamp(position: [f64; 3], range: f64) -> Light {
    Light {
        kind: LightKind::Point,
        position_world: DVec3::from_array(position),
        range_m: Some(range),
        ..sun([0.0, -1.0, 0.0])
    }
}

/// A cone with a half angle in degrees.
pub fn spot(position: [f64; 3], direction: [f64; 3], degrees: f64, range: f64) -> Light {
    let outer_angle = f64::to_radians(degrees);
    Light {
        kind: LightKind::Spot { inner_angle: 0.0, outer_angle },
        direction_world: DVec3::from_array(direction).normalize(),
        ..lamp(position, range)
    }
}

/// Corners and triangles.
pub type TestMesh = (Vec<[f32; 3]>, Vec<[u32; 3]>);

/// A scene with one node per mesh.
pub fn scene(meshes: Vec<TestMesh>, place: DAffine3) -> Scene {
    let mut scene = Scene { name: "test".into(), ..Scene::default() };
    for (index, (positions, triangles)) in meshes.into_iter().enumerate() {
        let primitive = Primitive { positions, triangles, ..Primitive::default() };
        scene.meshes.push(Mesh { name: format!("mesh{index}"), primitives: vec![primitive] });
        scene.nodes.push(Node { name: format!("node{index}"), mesh: index, world_from_mesh: place, dynamic: false });
    }
    scene
}

/// A box with outward triangles, turned about y.
pub fn cuboid(center: [f64; 3], half: [f64; 3], turn: f64) -> TestMesh {
    let rotation = DMat3::from_quat(DQuat::from_rotation_y(turn));
    let corner = |i: usize| {
        let sign = |bit: usize| if i & bit == 0 { -1.0 } else { 1.0 };
        let local = DVec3::new(sign(1) * half[0], sign(2) * half[1], sign(4) * half[2]);
        (DVec3::from_array(center) + rotation * local).to_array().map(|c| c as f32)
    };
    let faces: [[u32; 4]; 6] = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    ((0..8).map(corner).collect(), triangles)
}

/// The same mesh turned inside out.
pub fn turned((positions, triangles): TestMesh) -> TestMesh {
    (positions, triangles.into_iter().map(|[a, b, c]| [a, c, b]).collect())
}

/// Triangles anywhere, fewer than `most`, some with corners that coincide with others'.
pub fn soup(most: usize) -> impl Strategy<Value = TestMesh> {
    let corner = prop_oneof![
        3 => prop::array::uniform3(-1.0f32..1.0),
        1 => prop::array::uniform3((-4i32..=4).prop_map(|c| c as f32 * 0.25)),
    ];
    prop::collection::vec(prop::array::uniform3(corner), 1..most).prop_map(loose)
}

/// Triangles that share no vertices.
pub fn loose(triangles: Vec<[[f32; 3]; 3]>) -> TestMesh {
    let indices = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    (triangles.into_iter().flatten().collect(), indices)
}

/// Boxes on a coarse grid, so that many touch, coincide, nest or share faces; some free; some inside out.
pub fn solid() -> impl Strategy<Value = TestMesh> {
    let on_grid = (prop::array::uniform3(-4i32..=4), prop::array::uniform3(1i32..=4))
        .prop_map(|(c, h)| cuboid(c.map(|c| f64::from(c) * 0.25), h.map(|h| f64::from(h) * 0.125), 0.0));
    let free = (prop::array::uniform3(-1.0f64..1.0), prop::array::uniform3(0.01f64..0.7), 0.0f64..3.2)
        .prop_map(|(c, h, turn)| cuboid(c, h, turn));
    (prop_oneof![on_grid, free], prop::bool::weighted(0.2))
        .prop_map(|(mesh, turn)| if turn { turned(mesh) } else { mesh })
}

/// A bake with what is needed to check it.
pub struct Checked<'s> {
    pub file: ShadowFile,
    pub bytes: Vec<u8>,
    pub space: LightSpace,
    pub interior: Interior,
    /// By face.
    pub faces: Vec<Face<'s>>,
}

/// What one face of a light sees.
#[derive(Default)]
pub struct Face<'s> {
    pub triangles: Vec<LatticeTriangle>,
    /// For each triangle, what its alpha mask needs.
    pub masks: Vec<Option<Mask<'s>>>,
}

/// A masked triangle in the world.
pub struct Mask<'s> {
    corners: [DVec3; 3],
    masked: MaskedTriangle<'s>,
}

impl Checked<'_> {
    pub fn resolution(&self) -> Resolution {
        self.space.resolution()
    }

    pub fn light(&self) -> LightShadow<'_> {
        self.file.light("sun").unwrap()
    }
}

pub fn options(interior: Interior, resolution: u32, threads: usize) -> BakeOptions {
    let resolution = ResolutionRequest::Texels(Resolution::new(resolution).unwrap());
    BakeOptions { interior, resolution, threads, encoding: Some(Encoding::Dag8), ..BakeOptions::default() }
}

/// Bakes, and puts the casters on the lattice once more for the oracle.
pub fn bake_for_check<'s>(scene: &'s Scene, light: &Light, options: &BakeOptions) -> Checked<'s> {
    let light = Light { name: "sun".into(), ..light.clone() };
    let baked = bake(scene, std::slice::from_ref(&light), options, &Silent).unwrap();
    let file = ShadowFile::from_bytes(&baked.bytes).unwrap();
    antumbra::format::canonical::check(&file).unwrap();
    let find_solids = options.interior != Interior::Open;
    let caster_options =
        CasterOptions { find_solids, inverted: Inverted::Open, blend: Blend::Skip, memory_limit: u64::MAX };
    let casters = Casters::new(scene, caster_options).unwrap();
    let request =
        SpaceRequest { resolution: options.resolution, near_m: options.near_m, distribution: options.local_depth };
    let space = LightSpace::new(&casters, &light, request, &antumbra_bake::never_pause).unwrap();
    let opened = space.opened_parts(&casters);
    let mut faces: Vec<Face<'s>> = (0..space.faces()).map(|_| Face::default()).collect();
    for_each_placed(&casters, &space, &opened, |face, triangle, caster| {
        faces[face].triangles.push(*triangle);
        faces[face].masks.push(caster.masked.map(|masked| Mask { corners: caster.corners, masked }));
    });
    Checked { file, bytes: baked.bytes, space, interior: options.interior, faces }
}

impl Mask<'_> {
    /// Whether the triangle is there on a texel's ray: from the ray in the world, with nothing of the bake's.
    fn keeps(&self, record: &LightRecord, face: usize, at: [i64; 2]) -> bool {
        let side = f64::from(record.resolution());
        let texels = at.map(|c| c as f64 / (1u64 << LATERAL_BITS) as f64 * side);
        let origin = DVec3::from_array(record.origin_world);
        let rows = record.linear.map(DVec3::from_array);
        let (start, direction) = if record.light_kind() == Some(Kind::Directional) {
            let offset = DVec3::from_array(record.voxel_of_origin);
            let to_world = |row: DVec3| row / row.length_squared();
            let aside = to_world(rows[0]) * (texels[0] - offset.x) + to_world(rows[1]) * (texels[1] - offset.y);
            (origin + aside, DVec3::from_array(record.direction_world))
        } else {
            let [right, down, along] = face_axes(rows, if record.faces == 1 { 4 } else { face });
            let tangent = texels.map(|t| (t - 0.5 * side) / record.texels_per_tangent);
            (origin, along + right * tangent[0] + down * tangent[1])
        };
        let [a, b, c] = self.corners;
        let (ab, ac, normal) = (b - a, c - a, (b - a).cross(c - a));
        let t = (a - start).dot(normal) / direction.dot(normal);
        let p = start + direction * t - a;
        let (v, w) = (p.cross(ac).dot(normal), ab.cross(p).dot(normal));
        let area = normal.length_squared();
        let weights = [1.0 - (v + w) / area, v / area, w / area];
        let sum = |values: [f64; 3]| values.iter().zip(weights).map(|(value, weight)| value * weight).sum::<f64>();
        let uv = [sum(self.masked.texcoords.map(|t| t[0])), sum(self.masked.texcoords.map(|t| t[1]))];
        self.masked.test.keeps(uv, sum(self.masked.alpha))
    }
}

/// Depth along a face's axis of a local light's slice, and the slice of a depth.
fn depth_maps(record: &LightRecord) -> (impl Fn(f64) -> f64 + Sync, impl Fn(f64) -> f64 + Sync) {
    let (near, far, n) = (record.near_m, record.far_m, f64::from(record.resolution()));
    let ndc = record.depth_distribution() == Some(DepthDistribution::Ndc);
    let depth = move |slice: f64| {
        if ndc { near / (1.0 - slice / n * (1.0 - near / far)) } else { near * (far / near).powf(slice / n) }
    };
    let slice = move |z: f64| {
        if ndc { n * (1.0 - near / z) / (1.0 - near / far) } else { n * (z / near).ln() / (far / near).ln() }
    };
    (depth, slice)
}

/// Calls `with` with the oracle of a face.
pub fn with_oracle<R>(checked: &Checked<'_>, face: usize, with: impl FnOnce(&Oracle<'_>) -> R) -> R {
    let record = *checked.light().record();
    let slices = checked.space.slices();
    let slice = |step: u32| slices.of_step(step);
    let masks = &checked.faces[face].masks;
    let keeps = |t: usize, at: [i64; 2]| masks[t].as_ref().is_none_or(|mask| mask.keeps(&record, face, at));
    let (depth, slice_of) = depth_maps(&record);
    let local = record.light_kind() != Some(Kind::Directional);
    let parameter = record.interior_parameter_m;
    let tangent = 0.5 * f64::from(record.resolution()) / record.texels_per_tangent;
    let moved = |slice: u32, metres: f64| {
        if local { slice_of(depth(f64::from(slice)) + metres) } else { f64::from(slice) + metres / record.slice_size_m }
    };
    let behind = |enter: u32| {
        // Along a face's axis, on the ray into its corner.
        let metres = if local { parameter / (1.0 + 2.0 * tangent * tangent).sqrt() } else { parameter };
        (moved(enter, metres) + 1e-9).floor() as u32
    };
    let before = |second: u32| {
        let last = if local { second.min(record.resolution()) } else { second };
        let to = moved(last, -parameter);
        // A logarithm of less than the near distance is no number.
        if to > 0.0 { (to + 1e-9).floor() as u32 } else { 0 }
    };
    let free = match checked.interior {
        Interior::Thickness(_) => Free::Behind(&behind),
        Interior::Static(_) => Free::BeforeSecond(&before),
        _ => Free::Nothing,
    };
    let view = View { resolution: checked.resolution(), slice: &slice, keeps: &keeps, free };
    with(&Oracle::new(&checked.faces[face].triangles, view))
}

/// Holds a texel's ray against its exact interval: all slices of small lights, else those about the interval's ends.
pub fn check_texel(
    light: LightShadow<'_>,
    oracle: &Oracle<'_>,
    face: usize,
    [x, y]: [u32; 2],
    slices: u32,
) -> Result<(), String> {
    let Interval { enter, exit } = oracle.interval(x, y);
    let check = |z: u32| {
        let lit = light.is_lit(face, [x, y, z]);
        let wrong = if lit { z >= exit } else { z < enter };
        let what = format!("face {face} texel ({x}, {y}) slice {z}: lit {lit}, interval {enter}..={exit}");
        if wrong { Err(what) } else { Ok(()) }
    };
    if slices <= 64 {
        (0..slices).try_for_each(check)?;
    } else {
        let about = |z: u32| [z.wrapping_sub(2), z.wrapping_sub(1), z, z.saturating_add(1)];
        let ends = about(enter).into_iter().chain(about(exit)).chain([0, slices - 1, slices / 2, slices / 3]);
        // What lies in shadow stays there: a few slices, others in each texel.
        let stride = (slices.saturating_sub(exit) / 4).max(1);
        let behind = (exit.min(slices) + (7 * x + 13 * y) % stride..slices).step_by(stride as usize);
        ends.filter(|z| *z < slices).chain(behind).try_for_each(check)?;
    }
    // Between the ends any one transition will do, but there must be one only.
    let free = enter..exit.min(slices).min(enter.saturating_add(300));
    let is_lit = |z: u32| light.is_lit(face, [x, y, z]);
    let turns_back = free.clone().zip(free.skip(1)).find(|(a, b)| !is_lit(*a) && is_lit(*b));
    turns_back.map_or(Ok(()), |(a, _)| Err(format!("texel ({x}, {y}) is shadowed at slice {a} and lit behind it")))
}

/// Checks every texel of every face.
pub fn check_all(checked: &Checked<'_>) -> Result<(), String> {
    let n = u64::from(checked.resolution().texels());
    check_texels(checked, move || (0..n * n).map(move |i| [(i % n) as u32, (i / n) as u32]))
}

/// Checks the given texels on every face.
pub fn check_texels<I: Iterator<Item = [u32; 2]> + Send>(
    checked: &Checked<'_>,
    texels: impl Fn() -> I,
) -> Result<(), String> {
    let (light, n) = (checked.light(), checked.resolution().texels());
    (0..checked.faces.len()).try_for_each(|face| {
        with_oracle(checked, face, |oracle| {
            texels().par_bridge().try_for_each(|texel| check_texel(light, oracle, face, texel, n))
        })
    })
}
