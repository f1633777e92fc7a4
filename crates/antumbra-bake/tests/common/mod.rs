//! Scenes for tests, and the check of a bake against the oracle.
#![allow(dead_code, reason = "each test program uses its own share")]

use std::path::PathBuf;

use antumbra::{Interior, LightShadow, ShadowFile};
use antumbra_bake::casters::{Blend, CasterOptions, Casters, Inverted};
use antumbra_bake::light_space::{LatticeTriangle, Resolution};
use antumbra_bake::oracle::{Interval, Oracle};
use antumbra_bake::place::{fit_directional, for_each_placed};
use antumbra_bake::{BakeOptions, ResolutionRequest, Silent, bake};
use antumbra_scene::{Light, LightKind, Mesh, Node, Primitive, Scene};
use glam::{DAffine3, DMat3, DQuat, DVec3};
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

/// A bake with what is needed to check it.
pub struct Checked {
    pub file: ShadowFile,
    pub bytes: Vec<u8>,
    pub triangles: Vec<LatticeTriangle>,
    pub resolution: Resolution,
}

pub fn options(interior: Interior, resolution: u32, threads: usize) -> BakeOptions {
    let resolution = ResolutionRequest::Texels(Resolution::new(resolution).unwrap());
    BakeOptions { interior, resolution, threads, ..BakeOptions::default() }
}

/// Bakes, and puts the casters on the lattice once more for the oracle.
pub fn bake_for_check(scene: &Scene, light: &Light, options: &BakeOptions) -> Checked {
    let baked = bake(scene, std::slice::from_ref(light), options, &Silent).unwrap();
    let file = ShadowFile::from_bytes(&baked.bytes).unwrap();
    antumbra::format::canonical::check(&file).unwrap();
    let find_solids = options.interior != Interior::Open;
    let caster_options =
        CasterOptions { find_solids, inverted: Inverted::Open, blend: Blend::Skip, memory_limit: u64::MAX };
    let casters = Casters::new(scene, caster_options).unwrap();
    let space = fit_directional(&casters, light.direction_world, options.resolution).unwrap();
    let mut triangles = Vec::new();
    for_each_placed(&casters, &space, |t, _| triangles.push(*t));
    Checked { file, bytes: baked.bytes, triangles, resolution: space.resolution() }
}

/// Holds a texel's ray against its exact interval: all slices of small lights, else those about the interval's ends.
pub fn check_texel(light: LightShadow<'_>, oracle: &Oracle<'_>, [x, y]: [u32; 2], slices: u32) -> Result<(), String> {
    let Interval { enter, exit } = oracle.interval(x, y);
    let check = |z: u32| {
        let lit = light.is_lit(0, [x, y, z]);
        let wrong = if lit { z >= exit } else { z < enter };
        if wrong { Err(format!("texel ({x}, {y}) slice {z}: lit {lit}, interval {enter}..={exit}")) } else { Ok(()) }
    };
    if slices <= 64 {
        (0..slices).try_for_each(check)?;
    } else {
        let about = |z: u32| [z.wrapping_sub(2), z.wrapping_sub(1), z, z.saturating_add(1)];
        let ends = about(enter).into_iter().chain(about(exit)).chain([0, slices - 1, slices / 2, slices / 3]);
        ends.filter(|z| *z < slices).try_for_each(check)?;
    }
    // Between the ends any one transition will do, but there must be one only.
    let free = enter..exit.min(slices).min(enter.saturating_add(300));
    let turns_back =
        free.clone().zip(free.skip(1)).find(|(a, b)| !light.is_lit(0, [x, y, *a]) && light.is_lit(0, [x, y, *b]));
    turns_back.map_or(Ok(()), |(a, _)| Err(format!("texel ({x}, {y}) is shadowed at slice {a} and lit behind it")))
}

/// Checks every texel.
pub fn check_all(checked: &Checked) -> Result<(), String> {
    let n = checked.resolution.texels();
    check_texels(
        checked,
        (0..u64::from(n) * u64::from(n)).map(|i| [(i % u64::from(n)) as u32, (i / u64::from(n)) as u32]),
    )
}

/// Checks the given texels.
pub fn check_texels(checked: &Checked, texels: impl Iterator<Item = [u32; 2]> + Send) -> Result<(), String> {
    let oracle = Oracle::new(&checked.triangles, checked.resolution);
    let light = checked.file.light("sun").unwrap();
    let n = checked.resolution.texels();
    texels.par_bridge().try_for_each(|texel| check_texel(light, &oracle, texel, n))
}
