//! Flat leaves against cubic ones (Sintorn et al. 2014).

use antumbra::{Filter, LightShadow};
use antumbra_bake::ablation::cubic::{LeafPool, Reads};
use antumbra_render::Tracer;
use antumbra_scene::Light;
use anyhow::{Context, Result, ensure};
use glam::DVec3;
use serde_json::json;

use super::{INTERIORS, Subject, Wish, baked, shadows, tracer};
use crate::bench::ratio;
use crate::bench::section::{Column, Row, Section, Shown, row};
use crate::compare::Kind;
use crate::compare::sampling::{Random, Sampler};

const COLUMNS: &[Column<'_>] = &[
    ("scene", "scene", Shown::Plain),
    ("interior", "policy", Shown::Plain),
    ("resolution", "N", Shown::Plain),
    ("flat_bytes", "flat", Shown::Bytes),
    ("cubic_bytes", "cubic", Shown::Bytes),
    ("bytes_ratio", "cubic / flat", Shown::Decimal),
    ("flat_leaves", "leaves, flat", Shown::Count),
    ("cubic_leaves", "cubic", Shown::Count),
    ("pcf9_flat_reads", "9 x 9 reads, flat", Shown::Decimal),
    ("pcf9_cubic_reads", "cubic", Shown::Decimal),
    ("pcf9_flat_sectors", "9 x 9 sectors, flat", Shown::Decimal),
    ("pcf9_cubic_sectors", "cubic", Shown::Decimal),
    ("pcf17_flat_reads", "17 x 17 reads, flat", Shown::Decimal),
    ("pcf17_cubic_reads", "cubic", Shown::Decimal),
    ("pcf17_flat_sectors", "17 x 17 sectors, flat", Shown::Decimal),
    ("pcf17_cubic_sectors", "cubic", Shown::Decimal),
];

const ABOUT: &str = "A finished bake's pool, and the same volume with 64-bit leaves of 4 x 4 x 4 voxels, eight below each block of \
8 x 8 x 8, hash-consed. Reads: distinct leaves that a filter's window touches, mean over random points of surfaces that face the \
light, moved off as a filtered lookup moves them, whose window touches a leaf in either layout. Sectors: aligned 32 bytes that hold \
what is read of those leaves and of the blocks above them (what lies above the blocks is the same in both). A 9 x 9 window \
lies over the places of 4 flat or 9 cubic leaves on average, a 17 x 17 one over 9 or 25; homogeneous ones take no read. Every pair was checked to \
hold the same bits at random voxels. Sintorn et al. 2014 chose flat leaves because a filter's taps share their depth.";

const LARGEST: u32 = 4096;
/// Random points on surfaces.
const POINTS: u64 = 20_000;
/// Random voxels at which both layouts are compared.
const CHECKED_VOXELS: u64 = 100_000;

pub fn section() -> Section {
    Section::new("Flat and cubic leaves", ABOUT, COLUMNS)
}

pub fn rows(subject: &Subject, sun: &Light, wish: &Wish) -> Result<Vec<Row>> {
    let tracer = tracer(&subject.scene);
    let sampler = Sampler::everywhere(&tracer);
    let points: Vec<(DVec3, DVec3)> = (0..POINTS).filter_map(|i| facing_point(&tracer, &sampler, sun, i)).collect();
    let mut rows = Vec::new();
    for interior in INTERIORS {
        for resolution in wish.resolutions(256, LARGEST) {
            let baked = baked(&subject.scene, std::slice::from_ref(sun), interior, resolution)?;
            let file = shadows(&baked)?;
            let light = file.lights().next().context("the bake has no light")?;
            let pools = Pools { flat: LeafPool::flat(file.pool())?, cubic: LeafPool::cubic(file.pool())?, light };
            pools.check()?;
            rows.push(pools.row(subject, &points)?);
        }
    }
    Ok(rows)
}

/// A random point of a surface with its normal, if it faces the light.
fn facing_point(tracer: &Tracer, sampler: &Sampler<'_>, sun: &Light, index: u64) -> Option<(DVec3, DVec3)> {
    let sample = sampler.sample(1, Kind::Surface, index);
    let normal = tracer.normal(sample.triangle?);
    (normal.dot(sun.direction_world) < 0.0).then_some((sample.point_world, normal))
}

/// One bake in both layouts.
struct Pools<'a> {
    flat: LeafPool,
    cubic: LeafPool,
    light: LightShadow<'a>,
}

/// What windows that touch a leaf read, flat and cubic, and how many of all windows do.
struct MeanReads {
    windows_share: f64,
    leaves: [f64; 2],
    sectors: [f64; 2],
}

impl Pools<'_> {
    fn log2(&self) -> u32 {
        self.light.record().log2_resolution
    }

    fn row(&self, subject: &Subject, points: &[(DVec3, DVec3)]) -> Result<Row> {
        let (nine, seventeen) = (self.mean_reads(points, 9)?, self.mean_reads(points, 17)?);
        Ok(row(json!({
            "scene": subject.name,
            "ablation": "leaves",
            "light": self.light.name(),
            "interior": self.light.interior().name(),
            "resolution": self.light.record().resolution(),
            "flat_bytes": self.flat.bytes(),
            "cubic_bytes": self.cubic.bytes(),
            "bytes_ratio": ratio(self.cubic.bytes(), self.flat.bytes()),
            "flat_leaves": self.flat.leaf_count(),
            "cubic_leaves": self.cubic.leaf_count(),
            "pcf9_windows_share": nine.windows_share,
            "pcf9_flat_reads": nine.leaves[0],
            "pcf9_cubic_reads": nine.leaves[1],
            "pcf9_flat_sectors": nine.sectors[0],
            "pcf9_cubic_sectors": nine.sectors[1],
            "pcf17_windows_share": seventeen.windows_share,
            "pcf17_flat_reads": seventeen.leaves[0],
            "pcf17_cubic_reads": seventeen.leaves[1],
            "pcf17_flat_sectors": seventeen.sectors[0],
            "pcf17_cubic_sectors": seventeen.sectors[1],
        })))
    }

    fn check(&self) -> Result<()> {
        let n = f64::from(self.light.record().resolution());
        for index in 0..CHECKED_VOXELS {
            let mut random = Random::new(2, Kind::Air, index);
            let voxel = [(); 3].map(|()| (random.unit() * n) as u32);
            let lit = self.light.is_lit(0, voxel);
            let agree = self.cubic.is_lit(self.cubic.last_node(), self.log2(), voxel) == lit
                && self.flat.is_lit(self.flat.last_node(), self.log2(), voxel) == lit;
            ensure!(agree, "the layouts differ at voxel {voxel:?}: please report it");
        }
        Ok(())
    }

    fn mean_reads(&self, points: &[(DVec3, DVec3)], taps: u32) -> Result<MeanReads> {
        let filter = Filter::new_box(taps)?;
        let (mut windows, mut sums) = (0u64, [Reads::default(); 2]);
        for &(point, normal) in points {
            let at = self.light.project(point + normal * self.light.bias_m(point, normal, filter)).voxel;
            let reads = [&self.flat, &self.cubic].map(|pool| self.reads(pool, at, filter.radius()));
            if reads.iter().all(|reads| reads.leaves == 0) {
                continue;
            }
            windows += 1;
            for (sum, reads) in sums.iter_mut().zip(reads) {
                sum.leaves += reads.leaves;
                sum.sectors += reads.sectors;
            }
        }
        Ok(MeanReads {
            windows_share: ratio(windows, points.len() as u64),
            leaves: sums.map(|sum| ratio(sum.leaves, windows)),
            sectors: sums.map(|sum| ratio(sum.sectors, windows)),
        })
    }

    fn reads(&self, pool: &LeafPool, at: DVec3, radius: u32) -> Reads {
        let last = (1u32 << self.log2()) - 1;
        // A cast of what is negative gives 0.
        let index = |v: f64| (v as u32).min(last);
        let end = |shift: f64| [at.x, at.y].map(|c| index(c + shift));
        let radius = f64::from(radius);
        pool.reads(pool.last_node(), self.log2(), [end(-radius), end(radius)], index(at.z))
    }
}
