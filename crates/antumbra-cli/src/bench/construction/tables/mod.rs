//! What was measured, as the paper's tables and as our own: one file each.

mod against;
mod culling;
mod growth;
mod sizes;
mod stages;
mod threads;
mod whole;

use serde_json::Value;

use super::Wish;
use super::measure::{Figures, Measurement};
use super::plan::{Combination, Technique};
use crate::args::interior_argument;
use crate::bench::section::{Row, Section};

/// What is shown of a bake that ran out of memory.
const OUT_OF_MEMORY: &str = "out of memory";

/// The tables that there is something to show in.
pub fn sections(measured: &[Measurement<'_>], wish: &Wish) -> Vec<Section> {
    let view = View { measured, threads: wish.threads };
    let mut sections = vec![
        culling::section(&view),
        sizes::section(&view),
        stages::section(&view),
        whole::section(&view),
        against::section(&view),
        growth::section(&view),
        threads::section(measured, &wish.threads_list),
    ];
    sections.retain(|section| !section.rows.is_empty());
    sections
}

/// What was measured, but for the comparison of numbers of threads.
pub struct View<'a> {
    pub measured: &'a [Measurement<'a>],
    pub threads: usize,
}

impl<'a> View<'a> {
    /// In their order.
    pub fn all(&self) -> impl Iterator<Item = &'a Measurement<'a>> + use<'_, 'a> {
        self.measured.iter().filter(|m| m.combination.threads == self.threads)
    }

    /// One of each scene, policy and resolution.
    pub fn points(&self) -> Vec<Combination<'a>> {
        self.distinct(|a, b| is_same_place(a, b) && a.resolution == b.resolution)
    }

    /// One of each scene, policy and technique.
    pub fn series(&self) -> Vec<Combination<'a>> {
        self.distinct(Combination::is_series_of)
    }

    fn distinct(&self, same: impl Fn(&Combination<'a>, &Combination<'a>) -> bool) -> Vec<Combination<'a>> {
        let mut distinct: Vec<Combination<'a>> = Vec::new();
        for measurement in self.all() {
            if !distinct.iter().any(|known| same(known, &measurement.combination)) {
                distinct.push(measurement.combination);
            }
        }
        distinct
    }

    /// What a technique makes of a point.
    pub fn at(&self, point: &Combination<'_>, technique: Technique) -> Option<&'a Measurement<'a>> {
        let is_it = |m: &&Measurement<'_>| {
            let c = &m.combination;
            is_same_place(c, point) && c.resolution == point.resolution && c.technique == technique
        };
        self.all().find(is_it)
    }

    /// All resolutions of a series.
    pub fn of_series(&self, series: &Combination<'a>) -> impl Iterator<Item = &'a Measurement<'a>> {
        self.all().filter(|m| m.combination.is_series_of(series))
    }
}

fn is_same_place(a: &Combination<'_>, b: &Combination<'_>) -> bool {
    std::ptr::eq(a.subject, b.subject) && a.interior == b.interior
}

/// A figure; a word where there was no memory for it, nothing where it was not measured.
fn cell(measurement: Option<&Measurement<'_>>, figure: impl Fn(&Figures) -> Option<f64>) -> Value {
    match measurement.map(|m| &m.figures) {
        None => Value::Null,
        Some(Err(_)) => OUT_OF_MEMORY.into(),
        Some(Ok(figures)) => figure(figures).into(),
    }
}

/// How many times the second's figure the first's is, where both were measured.
fn times(
    a: Option<&Measurement<'_>>,
    b: Option<&Measurement<'_>>,
    figure: impl Fn(&Figures) -> Option<f64>,
) -> Option<f64> {
    let value = |m: Option<&Measurement<'_>>| figure(m?.figures.as_ref().ok()?);
    Some(value(a)? / value(b).filter(|b| *b > 0.0)?)
}

/// A row that begins with a point's scene, policy and resolution.
fn row_at(point: &Combination<'_>, rest: Value) -> Row {
    let mut row = crate::bench::section::row(serde_json::json!({
        "scene": point.subject.name,
        "interior": interior_argument(point.interior),
        "resolution": point.resolution.texels(),
    }));
    row.append(&mut crate::bench::section::row(rest));
    row
}

/// Key and heading of a resolution's column.
fn resolution_key(n: u32) -> String {
    if n >= 1024 { format!("{}K", n / 1024) } else { n.to_string() }
}

fn bytes(figures: &Figures) -> Option<f64> {
    Some(figures.bytes as f64)
}

fn peak_bytes(figures: &Figures) -> Option<f64> {
    figures.peak_bytes.map(|bytes| bytes as f64)
}

fn seconds(figures: &Figures) -> Option<f64> {
    Some(figures.seconds)
}

#[cfg(test)]
mod tests;
