//! `antumbra bench ablations`: what the papers' choices buy, measured at small resolutions.
//!
//! Each ablation is a file that makes rows for one scene and one light. The builders compared are the baker's
//! ([`antumbra_bake::ablation`]).

mod depth;
mod growth;
mod lamps;
mod leaves;
mod space;
mod undefined;

use antumbra::{Interior, ShadowFile};
use antumbra_bake::light_space::Resolution;
use antumbra_bake::{BakeOptions, Baked, Encoding, ResolutionRequest, Silent, bake};
use antumbra_render::Tracer;
use antumbra_scene::{AlphaMode, Light, LightKind, Scene};
use anyhow::{Context, Result, bail};
use clap::ValueEnum;

use crate::bench::report::Report;
use crate::bench::resolutions;
use crate::bench::section::{Row, Section};
use crate::inputs::listed;
use crate::progress::Progress;
use crate::table::printable;

/// The ablations.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ablation {
    /// Octrees in world space and in light space
    Space,
    /// Flat 8 x 8 x 1 and cubic 4 x 4 x 4 leaves
    Leaves,
    /// Bytes over resolution, beside a 16-bit shadow map's
    Growth,
    /// Undefined regions resolved by the rules of 2014 and 2015
    Undefined,
    /// Logarithmic slices and slices even in normalized device coordinates
    Depth,
}

impl Ablation {
    /// Those of one directional light.
    const OF_SUNS: [Self; 4] = [Self::Space, Self::Leaves, Self::Growth, Self::Undefined];
}

/// The policies that the ablations compare: with nothing undefined, and with the insides of solids.
const INTERIORS: [Interior; 2] = [Interior::Open, Interior::Auto];

/// What is measured on.
pub struct Subject {
    /// The scene's name in tables.
    pub name: String,
    pub scene: Scene,
    /// The directional light, if there is one to measure.
    pub sun: Option<Light>,
    /// Spot and point lights to measure.
    pub lamps: Vec<Light>,
}

/// What to measure.
pub struct Wish {
    pub ablations: Vec<Ablation>,
    /// No resolution is greater.
    pub largest: Resolution,
}

impl Wish {
    /// Powers of two from `first` to `last`, or to the largest wished for; at least one.
    fn resolutions(&self, first: u32, last: u32) -> impl Iterator<Item = Resolution> + use<> {
        resolutions(first, last.min(self.largest.texels()))
    }
}

impl Subject {
    /// A scene from elsewhere, with the light of that name alone or with a directional light and all others.
    pub fn given(name: String, scene: Scene, light: Option<&str>) -> Result<Self> {
        let is_sun = |light: &&Light| light.kind == LightKind::Directional;
        let chosen: Vec<Light> = match light {
            None => scene.lights.clone(),
            Some(wanted) => scene.lights.iter().filter(|light| light.name == wanted).cloned().collect(),
        };
        if chosen.is_empty() {
            let names = listed(scene.lights.iter().map(|light| light.name.as_str()));
            match light {
                Some(wanted) => bail!("the scene has no light \"{}\"; it has: {names}", printable(wanted)),
                None => bail!("the scene has no light to measure; choose another scene"),
            }
        }
        let lamps = lamps::chosen(chosen.iter().filter(|light| !is_sun(light)));
        Ok(Self { name, sun: chosen.iter().find(is_sun).cloned(), lamps, scene })
    }

    /// A procedural scene; a city gets lamps.
    pub fn procedural(name: &str, scene: Scene) -> Result<Self> {
        let mut subject = Self::given(name.to_owned(), scene, None)?;
        if name == "city" && subject.lamps.is_empty() {
            subject.lamps = lamps::on_walls(&tracer(&subject.scene));
        }
        Ok(subject)
    }
}

/// Runs the ablations on all subjects; of several subjects, those that lack what an ablation needs are left out of it.
pub fn run(subjects: &[Subject], wish: &Wish, progress: &Progress) -> Result<Report> {
    let (mut sections, mut plots) = (Vec::new(), Vec::new());
    for &ablation in &wish.ablations {
        let of_suns = Ablation::OF_SUNS.contains(&ablation);
        let fitting = |s: &&Subject| if of_suns { s.sun.is_some() } else { !s.lamps.is_empty() };
        let fitting: Vec<&Subject> = subjects.iter().filter(fitting).collect();
        if fitting.is_empty() && wish.ablations.len() == 1 {
            let kind = if of_suns { "directional" } else { "spot or point" };
            bail!("there is no {kind} light to measure; choose another scene or --light");
        }
        let mut made = sections_of(ablation);
        for subject in fitting {
            progress.stage(&format!("{}: {ablation:?}", subject.name));
            let rows = rows_of(ablation, subject, wish).with_context(|| format!("cannot measure {}", subject.name))?;
            if ablation == Ablation::Growth {
                plots.extend(growth::plots(&subject.name, &rows[0])?);
            }
            for (section, rows) in made.iter_mut().zip(rows) {
                section.rows.extend(rows);
            }
        }
        made.retain(|section| !section.rows.is_empty());
        sections.append(&mut made);
    }
    let rows = sections.iter().flat_map(|section| section.rows.iter().cloned()).collect();
    Ok(Report {
        table: "ablations",
        title: "Ablations of the papers",
        sections,
        rows,
        summary: Row::new(),
        plots,
        images: Vec::new(),
        gpu: None,
    })
}

fn sections_of(ablation: Ablation) -> Vec<Section> {
    match ablation {
        Ablation::Space => vec![space::section()],
        Ablation::Leaves => vec![leaves::section()],
        Ablation::Growth => vec![growth::section()],
        Ablation::Undefined => vec![undefined::section()],
        Ablation::Depth => vec![depth::heights_section(), depth::section()],
    }
}

/// Rows for each of an ablation's sections.
fn rows_of(ablation: Ablation, subject: &Subject, wish: &Wish) -> Result<Vec<Vec<Row>>> {
    if ablation == Ablation::Depth {
        return depth::rows(subject, wish).map(Vec::from);
    }
    let sun = subject.sun.as_ref().context("there is no directional light")?;
    let rows = match ablation {
        Ablation::Space => space::rows(subject, sun, wish),
        Ablation::Leaves => leaves::rows(subject, sun, wish),
        Ablation::Undefined => undefined::rows(subject, sun, wish),
        _ => growth::rows(subject, sun, wish),
    };
    rows.map(|rows| vec![rows])
}

/// Bakes a light as `antumbra bake` does.
fn baked(scene: &Scene, lights: &[Light], interior: Interior, resolution: Resolution) -> Result<Baked> {
    let resolution = ResolutionRequest::Texels(resolution);
    let options = BakeOptions { interior, resolution, encoding: Some(Encoding::Dag8), ..BakeOptions::default() };
    Ok(bake(scene, lights, &options, &Silent)?)
}

fn shadows(baked: &Baked) -> Result<ShadowFile> {
    Ok(ShadowFile::from_bytes(&baked.bytes)?)
}

/// Traces what casts in a bake.
fn tracer(scene: &Scene) -> Tracer {
    Tracer::new(scene, |node, material| !node.dynamic && material.alpha_mode != AlphaMode::Blend)
}
