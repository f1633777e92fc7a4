//! `antumbra bench culling`: how many triangles are left to draw into each light's cube map. Selgrad, Müller, Reintges,
//! Stamminger 2016, *Fast shadow map rendering for many-lights settings*: the orange lines of its figure 5, and its ablations of the
//! grid's size and of how beams are marked. On the processor: what is counted is the same on every machine.

use std::time::Instant;

use antumbra_render::culling::{Binning, Bins, Footprint, Grid, Hull, Marks, Receivers, faces_of, mark_by_steps};
use antumbra_render::{Ray, Tracer, TriangleId};
use antumbra_scene::{AlphaMode, Camera, LightKind, Scene};
use anyhow::{Result, ensure};
use glam::DVec3;
use rayon::prelude::*;
use serde_json::json;

use super::report::Report;
use super::section::{Column, Row, Section, Shown, row};
use crate::progress::Progress;

/// What to measure.
pub struct Study {
    /// The scene's name in tables.
    pub name: String,
    pub scene: Scene,
    pub camera: Camera,
    /// Pixels whose surfaces make the source cells; alpha masks count as whole surfaces.
    pub size: [u32; 2],
    /// Texels per side of a cube map's face.
    pub map: u32,
    /// Cells along each axis.
    pub grids: Vec<u32>,
}

/// Taps per axis of a lookup.
const TAPS: u32 = 3;
/// The paper's: triangles of more cells are culled by nothing.
const MOST_CELLS: u32 = 2;

/// Pixels seen at most.
const MOST_PIXELS: u64 = 1 << 26;

/// Ways to cull.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Way {
    None,
    Frustum,
    Steps,
    Cells,
    Boxes,
}

const WAYS: [(Way, &str); 5] = [
    (Way::None, "none"),
    (Way::Frustum, "light and camera frusta"),
    (Way::Steps, "voxels, steps with a ring"),
    (Way::Cells, "voxels, beams between cells"),
    (Way::Boxes, "voxels, beams between boxes"),
];

const COLUMNS: &[Column<'_>] = &[
    ("grid", "cells per axis", Shown::Count),
    ("binning", "triangles of many cells", Shown::Plain),
    ("way", "culling", Shown::Plain),
    ("cells", "cells left", Shown::Count),
    ("triangles", "triangles drawn per light", Shown::Count),
    ("share", "of all six faces", Shown::Percent),
    ("seconds", "marking per light", Shown::Seconds),
];

/// The scene as culling sees it.
struct Setup {
    tracer: Tracer,
    corners: Vec<[DVec3; 3]>,
    /// What is seen.
    points: Vec<DVec3>,
    lights: Vec<DVec3>,
    far_corners: [DVec3; 4],
    eye: DVec3,
}

/// Measures everything.
pub fn run(study: &Study, progress: &Progress) -> Result<Report> {
    let setup = Setup::new(study)?;
    let about = format!(
        "{}: {} triangles, {} lights, {} pixels seen; cube maps of {} texels per face's side, {TAPS} x {TAPS} taps. Averages over all \
lights. A triangle is drawn once in each face that its cell may appear in; triangles of more than {MOST_CELLS} cells are \
cut at the cells' sides, or kept whole and drawn always. Every spot and point light counts as a point light without an end, frusta by \
their planes alone; steps do not know how wide lookups are. Marking is timed on one thread while the others mark for other lights.",
        study.name,
        setup.corners.len(),
        setup.lights.len(),
        setup.points.len(),
        study.map,
    );
    let mut section = Section::new("Triangles left to draw", about, COLUMNS);
    let binnings = [("cut", Binning::Clip), ("whole", Binning::NoCull { most_cells: MOST_CELLS })];
    progress.count("culling", (study.grids.len() * binnings.len()) as u64, "grids");
    for side in &study.grids {
        for (name, binning) in binnings {
            section.rows.extend(setup.rows(study, *side, name, binning));
            progress.set((section.rows.len() / WAYS.len()) as u64, (study.grids.len() * binnings.len()) as u64);
        }
    }
    Ok(Report {
        table: "culling",
        title: "Voxel culling for many lights",
        rows: section.rows.clone(),
        sections: vec![section],
        summary: Row::new(),
        plots: Vec::new(),
        images: Vec::new(),
        gpu: None,
    })
}

impl Setup {
    fn new(study: &Study) -> Result<Self> {
        let pixels = study.size.map(u64::from).iter().product::<u64>();
        ensure!(pixels <= MOST_PIXELS, "{pixels} pixels are too many to look at; choose a smaller --size");
        let of_lamps = study.scene.lights.iter().filter(|light| light.kind != LightKind::Directional);
        let lights: Vec<DVec3> = of_lamps.map(|light| light.position_world).collect();
        ensure!(!lights.is_empty(), "{} has no spot or point lights, whose shadow maps could be culled", study.name);
        // What lets light through casts no shadow.
        let tracer = Tracer::new(&study.scene, |_, material| material.alpha_mode != AlphaMode::Blend);
        let corners = (0..tracer.triangle_count()).map(|i| tracer.corners(TriangleId(i as u32))).collect();
        let camera = &study.camera;
        let [width, height] = study.size.map(f64::from);
        let right = camera.forward_world.cross(camera.up_world).normalize();
        let half_y = (0.5 * camera.fov_y).tan();
        let through = |x: f64, y: f64| {
            let (x, y) = (2.0 * x / width - 1.0, 1.0 - 2.0 * y / height);
            camera.forward_world
                + right * (x * half_y * width / height)
                + right.cross(camera.forward_world) * (y * half_y)
        };
        let pixel = |i: u32| {
            let (x, y) = (i % study.size[0], i / study.size[0]);
            let ray = Ray::new(camera.eye_world, through(f64::from(x) + 0.5, f64::from(y) + 0.5));
            tracer.closest(&ray).map(|hit| ray.at(hit.t))
        };
        let points: Vec<DVec3> = (0..study.size[0] * study.size[1]).into_par_iter().filter_map(pixel).collect();
        ensure!(!points.is_empty(), "the camera sees nothing of {}", study.name);
        let deepest = points.iter().map(|p| (*p - camera.eye_world).dot(camera.forward_world)).fold(0.0, f64::max);
        let corner = |x, y| camera.eye_world + through(x, y) * deepest;
        let far_corners = [corner(0.0, 0.0), corner(width, 0.0), corner(width, height), corner(0.0, height)];
        Ok(Self { tracer, corners, points, lights, far_corners, eye: camera.eye_world })
    }

    fn rows(&self, study: &Study, side: u32, binning_name: &str, binning: Binning) -> Vec<Row> {
        let grid = Grid::new(&self.tracer.bounds(), side);
        let bins = Bins::new(&grid, &self.corners, binning);
        let receivers = Receivers::new(&grid, self.points.iter().copied());
        let footprint = Footprint::of_cube(study.map, TAPS);
        let all = 6 * self.corners.len();
        let of_way = |(way, name): (Way, &str)| {
            let measure = |light: &DVec3| {
                let start = Instant::now();
                let marks = self.marks(way, &grid, &bins, &receivers, footprint, *light);
                let seconds = start.elapsed().as_secs_f64();
                let drawn = match way {
                    Way::None => all,
                    _ => drawn(&grid, &bins, &marks, *light),
                };
                let cells = bins.occupied().filter(|cell| marks.has(*cell)).count();
                (cells, drawn, seconds)
            };
            let measured: Vec<(usize, usize, f64)> = self.lights.par_iter().map(measure).collect();
            let lights = self.lights.len();
            let triangles = measured.iter().map(|(_, drawn, _)| drawn).sum::<usize>() / lights;
            row(json!({
                "scene": study.name, "grid": side, "binning": binning_name, "way": name,
                "cells": measured.iter().map(|(cells, ..)| cells).sum::<usize>() / lights,
                "triangles": triangles,
                "share": triangles as f64 / all as f64,
                "seconds": measured.iter().map(|(.., seconds)| seconds).sum::<f64>() / lights as f64,
            }))
        };
        WAYS.map(of_way).into()
    }

    fn marks(&self, way: Way, grid: &Grid, bins: &Bins, seen: &Receivers, footprint: Footprint, light: DVec3) -> Marks {
        let mut marks = Marks::none(grid);
        match way {
            Way::None => bins.occupied().for_each(|cell| marks.set(cell)),
            Way::Frustum => {
                let hull = Hull::of_view(self.far_corners, self.eye, light);
                let kept = bins.occupied().filter(|cell| hull.touches(&grid.bounds(grid.cell(*cell))));
                kept.for_each(|cell| marks.set(cell));
            }
            Way::Steps => {
                let of_light = grid.at(light).floor().as_ivec3();
                seen.cells.iter().for_each(|source| mark_by_steps(grid, source.cell, of_light, &mut marks));
            }
            Way::Cells => seen.mark_cells(grid, light, footprint, &mut marks),
            Way::Boxes => seen.mark(grid, [light, light], footprint, &mut marks),
        }
        marks
    }
}

/// Triangles drawn into the six faces of a light's map.
fn drawn(grid: &Grid, bins: &Bins, marks: &Marks, light: DVec3) -> usize {
    let of_cell = |cell: usize| {
        let faces = faces_of(&grid.bounds(grid.cell(cell)), light).count_ones() as usize;
        faces * bins.of_cell(cell).len()
    };
    bins.occupied().filter(|cell| marks.has(*cell)).map(of_cell).sum::<usize>() + 6 * bins.unculled().len()
}
