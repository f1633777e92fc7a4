//! `antumbra bench construction`: seconds, memory and bytes of the construction, as in tables 1 to 4 of Kämpe, Sintorn and
//! Assarsson 2015, "Fast, memory-efficient construction of voxelized shadows".
//!
//! [`plan`] lists the bakes, [`measure`] runs each as a child process, [`tables`] and [`plots`] show what came of it, beside the
//! paper's figures ([`paper`]).

mod measure;
mod paper;
mod plan;
mod plots;
mod tables;

use std::path::PathBuf;

use antumbra::Interior;
use antumbra_bake::light_space::Resolution;
use anyhow::{Context, Result};

use crate::bench::child::Workshop;
use crate::bench::report::Report;
use crate::bench::section::Row;
use crate::progress::Progress;
use crate::table::printable;

pub use plan::Technique;

/// A scene's file and the light to measure in it.
pub struct Subject {
    /// The scene's name in tables.
    pub name: String,
    pub path: PathBuf,
    pub light: String,
}

/// What to measure.
pub struct Wish {
    pub techniques: Vec<Technique>,
    pub interiors: Vec<Interior>,
    /// The first and the last resolution.
    pub smallest: Resolution,
    pub largest: Resolution,
    /// The papers' methods go no further.
    pub largest_baseline: Resolution,
    /// Of every bake but those that compare numbers of threads.
    pub threads: usize,
    /// Numbers of threads to compare.
    pub threads_list: Vec<usize>,
    /// The best of so many.
    pub repeat: u32,
    /// Of each bake.
    pub memory_limit: Option<u64>,
}

/// Measures what is wished for on all subjects.
pub fn run(workshop: &Workshop, subjects: &[Subject], wish: &Wish, progress: &Progress) -> Result<Report> {
    let plan = plan::plan(subjects, wish);
    let mut measured = Vec::new();
    for (i, combination) in plan.iter().enumerate() {
        progress.stage(&format!("{} ({} of {})", printable(&combination.text()), i + 1, plan.len()));
        let measurement = measure::measure(workshop, *combination, wish, &measured);
        measured.push(measurement.with_context(|| format!("cannot measure {}", printable(&combination.text())))?);
    }
    Ok(Report {
        table: "construction",
        title: "Construction",
        sections: tables::sections(&measured, wish),
        rows: measured.iter().map(measure::Measurement::row).collect(),
        summary: Row::new(),
        plots: plots::plots(&measured, wish)?,
        images: Vec::new(),
        gpu: None,
    })
}
