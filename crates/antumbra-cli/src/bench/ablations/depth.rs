//! Logarithmic slices against slices that are even in normalized device coordinates, for local lights (Kämpe et al. 2015,
//! eq. 1).

use antumbra::{DepthDistribution, Filter, Interior, LightShadow};
use antumbra_bake::light_space::Resolution;
use antumbra_bake::{BakeOptions, Baked, Encoding, ResolutionRequest, Silent, bake};
use antumbra_render::{Hit, Ray, Tracer};
use antumbra_scene::AlphaMode;
use anyhow::{Context, Result};
use glam::DVec3;
use rayon::prelude::*;
use serde_json::json;

use super::{Subject, Wish, shadows, tracer};
use crate::bench::ratio;
use crate::bench::section::{Column, Row, Section, Shown, row};
use crate::compare::Kind;
use crate::compare::sampling::Random;

const HEIGHT_COLUMNS: &[Column<'_>] = &[
    ("scene", "scene", Shown::Plain),
    ("resolution", "N", Shown::Plain),
    ("nears", "distance / near", Shown::Plain),
    ("distance_m", "distance, m", Shown::Metres),
    ("log_slice_m", "slice, log, m", Shown::Metres),
    ("ndc_slice_m", "slice, NDC, m", Shown::Metres),
];

const HEIGHT_ABOUT: &str = "Height of a slice along the axis of the first lamp's face. Heights go as 1 / N. Logarithmic slices keep the ratio \
of height to distance; even ones in normalized device coordinates grow with its square.";

const COLUMNS: &[Column<'_>] = &[
    ("scene", "scene", Shown::Plain),
    ("lights", "lights", Shown::Plain),
    ("resolution", "N", Shown::Plain),
    ("distribution", "slices", Shown::Plain),
    ("open_bytes", "open", Shown::Bytes),
    ("auto_bytes", "auto", Shown::Bytes),
    ("wrong_near", "wrong, near", Shown::Percent),
    ("wrong_middle", "middle", Shown::Percent),
    ("wrong_far", "far", Shown::Percent),
];

const ABOUT: &str = "Bytes of the lamps' bakes, and how often an open bake is wrong about a surface. Rays go out from a lamp at random; every \
surface with its front to the lamp that a ray meets is a point: the first is lit, the others are not. Wrong is a lookup (one tap, moved off the \
surface along its normal as filtered lookups are) that says otherwise. Near is up to a thirty-second of the range, middle up to a quarter, far the rest. \
Kämpe et al. 2015, section 4, give no figures, but the reason: even slices in normalized device coordinates have \"poor depth precision close to the far \
plane\".";

const LARGEST: u32 = 4096;
/// Rays per lamp.
const RAYS: u64 = 20_000;
/// Where bands end, in parts of the range.
const BAND_ENDS: [f64; 2] = [1.0 / 32.0, 1.0 / 4.0];

pub fn heights_section() -> Section {
    Section::new("Slices of local lights: heights", HEIGHT_ABOUT, HEIGHT_COLUMNS)
}

pub fn section() -> Section {
    Section::new("Slices of local lights: bytes and errors", ABOUT, COLUMNS)
}

const DISTRIBUTIONS: [DepthDistribution; 2] = [DepthDistribution::Logarithmic, DepthDistribution::Ndc];

fn name(distribution: DepthDistribution) -> &'static str {
    if distribution == DepthDistribution::Ndc { "ndc" } else { "log" }
}

/// Rows of heights, then of bytes and errors.
pub fn rows(subject: &Subject, wish: &Wish) -> Result<[Vec<Row>; 2]> {
    let rays = Rays::new(subject);
    let (mut heights, mut rows) = (Vec::new(), Vec::new());
    let mut points: Option<Vec<Vec<SurfacePoint>>> = None;
    for resolution in wish.resolutions(512, LARGEST) {
        let mut files = Vec::new();
        for distribution in DISTRIBUTIONS {
            let [open, auto] =
                [Interior::Open, Interior::Auto].map(|i| lamps_baked(subject, i, distribution, resolution));
            let (open, auto) = (open?, auto?);
            let file = shadows(&open)?;
            // Where near and far are does not depend on the resolution: the first bake's word will do for all.
            let points = points.get_or_insert_with(|| file.lights().map(|light| rays.points(light)).collect());
            let wrong = wrong_shares(file.lights().zip(points.iter()))?;
            rows.push(row(json!({
                "scene": subject.name,
                "ablation": "depth",
                "lights": subject.lamps.len(),
                "resolution": resolution.texels(),
                "distribution": name(distribution),
                "open_bytes": bytes(&open),
                "auto_bytes": bytes(&auto),
                "points_near": wrong[0].1,
                "points_middle": wrong[1].1,
                "points_far": wrong[2].1,
                "wrong_near": wrong[0].0,
                "wrong_middle": wrong[1].0,
                "wrong_far": wrong[2].0,
            })));
            files.push(file);
        }
        let first = |i: usize| files[i].lights().next().context("the bake has no light");
        heights = height_rows(&subject.name, [first(0)?, first(1)?]);
    }
    Ok([heights, rows])
}

fn lamps_baked(
    subject: &Subject,
    interior: Interior,
    local_depth: DepthDistribution,
    resolution: Resolution,
) -> Result<Baked> {
    let resolution = ResolutionRequest::Texels(resolution);
    let options =
        BakeOptions { interior, resolution, local_depth, encoding: Some(Encoding::Dag8), ..BakeOptions::default() };
    Ok(bake(&subject.scene, &subject.lamps, &options, &Silent)?)
}

fn bytes(baked: &Baked) -> u64 {
    baked.lights.iter().map(|light| light.bytes).sum()
}

/// Slices' heights at the near distance and each doubling of it.
fn height_rows(scene: &str, lights: [LightShadow<'_>; 2]) -> Vec<Row> {
    let record = lights[0].record();
    // Any face's axis will do.
    let axis = DVec3::from_array(record.linear[2]);
    let doublings = (record.far_m / record.near_m).log2().floor() as u32;
    let heights = (0..=doublings).map(|k| {
        let distance_m = record.near_m * f64::from(1u32 << k);
        let slice_m = lights.map(|light| light.frame(light.origin_world() + axis * distance_m).slice_m);
        row(json!({
            "scene": scene,
            "ablation": "depth_heights",
            "light": lights[0].name(),
            "resolution": record.resolution(),
            "nears": 1u32 << k,
            "distance_m": distance_m,
            "log_slice_m": slice_m[0],
            "ndc_slice_m": slice_m[1],
        }))
    });
    heights.collect()
}

/// A point of a surface that a lamp's ray meets.
struct SurfacePoint {
    point_world: DVec3,
    normal_world: DVec3,
    /// 0 near, 1 middle, 2 far.
    band: usize,
    lit: bool,
}

/// Rays of lamps.
struct Rays<'a> {
    subject: &'a Subject,
    tracer: Tracer,
}

impl<'a> Rays<'a> {
    fn new(subject: &'a Subject) -> Self {
        Self { subject, tracer: tracer(&subject.scene) }
    }

    /// Where the rays of a lamp meet surfaces that show it their front.
    fn points(&self, light: LightShadow<'_>) -> Vec<SurfacePoint> {
        let points = (0..RAYS).into_par_iter().flat_map_iter(|index| self.points_on_ray(light, index));
        points.collect()
    }

    fn points_on_ray(&self, light: LightShadow<'_>, index: u64) -> Vec<SurfacePoint> {
        let ray = Ray::new(
            light.origin_world(),
            direction(&mut Random::new(light.record().name_offset.into(), Kind::Air, index)),
        );
        let side = f64::from(light.record().resolution());
        let mut hits: Vec<Hit> = Vec::new();
        if light.is_outside_cone(ray.at(1.0)) {
            return Vec::new();
        }
        // What lies before the near distance casts nothing; behind the far one nothing is asked.
        let counts = |hit: &Hit| (0.0..side).contains(&light.project(ray.at(hit.t)).voxel.z);
        self.tracer.for_each_hit(&ray, |hit| hits.extend(counts(&hit).then_some(hit)));
        // The bake looks into an alpha mask's texture, these rays do not.
        if hits.iter().any(|hit| self.is_masked(hit)) {
            return Vec::new();
        }
        hits.sort_by(|a, b| a.t.total_cmp(&b.t));
        let far_m = light.record().far_m;
        let point = |(i, hit): (usize, &Hit)| SurfacePoint {
            point_world: ray.at(hit.t),
            normal_world: self.tracer.normal(hit.triangle),
            band: BAND_ENDS.iter().filter(|end| hit.t > far_m * **end).count(),
            lit: i == 0,
        };
        hits.iter().enumerate().filter(|(_, hit)| hit.front).map(point).collect()
    }

    fn is_masked(&self, hit: &Hit) -> bool {
        let source = self.tracer.source(hit.triangle);
        let mesh = self.subject.scene.nodes[source.node].mesh;
        let primitive = &self.subject.scene.meshes[mesh].primitives[source.primitive];
        self.subject.scene.material(primitive).alpha_mode == AlphaMode::Mask
    }
}

/// A unit vector, all equally likely.
fn direction(random: &mut Random) -> DVec3 {
    let (y, angle) = (2.0 * random.unit() - 1.0, std::f64::consts::TAU * random.unit());
    let across = (1.0 - y * y).max(0.0).sqrt();
    DVec3::new(across * angle.cos(), y, across * angle.sin())
}

/// For each band the share of wrong answers, and the points.
fn wrong_shares<'a>(lights: impl Iterator<Item = (LightShadow<'a>, &'a Vec<SurfacePoint>)>) -> Result<[(f64, u64); 3]> {
    let tap = Filter::new_box(1)?;
    let mut counts = [(0u64, 0u64); 3];
    for (light, points) in lights {
        for point in points {
            let answer = light.filtered(point.point_world, Some(point.normal_world), tap) > 0.5;
            let (wrong, all) = &mut counts[point.band];
            *wrong += u64::from(answer != point.lit);
            *all += 1;
        }
    }
    Ok(counts.map(|(wrong, all)| (ratio(wrong, all), all)))
}
