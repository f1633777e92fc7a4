//! The commands, one file each.

mod bake;
mod bench;
mod compare;
mod demo;
mod info;
mod query;
mod rebuild;
mod render;
mod scene;
mod validate;
mod view;

use anyhow::Result;
use clap::Subcommand;

/// What to do.
#[derive(Subcommand)]
pub enum Command {
    /// Show what Antumbra does: generate a city, bake its sun, check the bake and draw it
    Demo(demo::Args),
    /// Write a procedural scene
    Scene(scene::Args),
    /// Bake a scene's shadows into a file
    Bake(bake::Args),
    /// Show what a shadow file holds
    Info(info::Args),
    /// Check a shadow file in full
    Validate(validate::Args),
    /// Look up how much of a light reaches given points
    Query(query::Args),
    /// Compare a bake with ray tracing at random points
    Compare(compare::Args),
    /// Draw a picture of a scene
    Render(render::Args),
    /// The interactive window
    View(view::Args),
    /// Bake again after an edit (comes with a later version)
    Rebuild(rebuild::Args),
    /// Tables and plots of the papers, and ours: construction, lamps, ablations
    Bench(bench::Args),
}

impl Command {
    /// Runs the command to its end.
    pub fn run(self) -> Result<()> {
        match self {
            Self::Demo(args) => demo::run(&args),
            Self::Scene(args) => scene::run(&args),
            Self::Bake(args) => bake::run(&args),
            Self::Info(args) => info::run(&args),
            Self::Validate(args) => validate::run(&args),
            Self::Query(args) => query::run(&args),
            Self::Compare(args) => compare::run(&args),
            Self::Render(args) => render::run(&args),
            Self::View(args) => view::run(&args),
            Self::Rebuild(args) => rebuild::run(&args),
            Self::Bench(args) => bench::run(&args),
        }
    }
}
