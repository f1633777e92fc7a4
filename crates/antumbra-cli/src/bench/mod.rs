//! `antumbra bench`: tables and plots of the papers, and of our own.
//!
//! A table is a module that measures and hands over a [`report::Report`]: rows for JSON, sections for Markdown and plots.
//! [`ablations`], [`culling`] and [`encodings`] run inside this process; [`construction`] and [`lamps`] run every bake as a child process
//! ([`child`]), so that its peak memory is its own; [`csm`] and [`fly`] draw frames on the graphics card along a way ([`path`]), [`ivsv`] one
//! frame again and again.

pub mod ablations;
pub mod child;
pub mod construction;
pub mod csm;
pub mod culling;
pub mod encodings;
pub mod fly;
pub mod ivsv;
pub mod lamps;
pub mod path;
pub mod plot;
pub mod report;
pub mod section;

use antumbra_bake::light_space::Resolution;

/// How many times `b` `a` is.
fn ratio(a: u64, b: u64) -> f64 {
    a as f64 / b.max(1) as f64
}

/// Powers of two from `first` to `last`; `last` alone if `first` is greater.
pub fn resolutions(first: u32, last: u32) -> impl Iterator<Item = Resolution> {
    Resolution::all().filter(move |r| (first.min(last)..=last).contains(&r.texels()))
}
