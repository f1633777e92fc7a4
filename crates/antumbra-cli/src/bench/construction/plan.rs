//! Which bakes are measured.

use antumbra::Interior;
use antumbra_bake::light_space::Resolution;
use clap::ValueEnum;

use super::{Subject, Wish};
use crate::args::interior_argument;
use crate::bench::resolutions;

/// A way to construct.
#[derive(ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
pub enum Technique {
    /// This program's own
    Columns,
    /// Kämpe et al. 2015
    Kampe2015,
    /// The same, but identical nodes are made and merged away later
    Kampe2015WithoutCulling,
    /// Sintorn et al. 2014
    Sintorn2014,
}

impl Technique {
    /// In the order of tables.
    pub fn all() -> &'static [Self] {
        Self::value_variants()
    }

    /// As `bake --method` has it.
    pub fn method(self) -> &'static str {
        match self {
            Self::Columns => "columns",
            Self::Kampe2015 | Self::Kampe2015WithoutCulling => "kampe2015",
            Self::Sintorn2014 => "sintorn2014",
        }
    }

    /// Whether identical nodes are culled, where that is a choice.
    pub fn culling(self) -> Option<bool> {
        match self {
            Self::Kampe2015 => Some(true),
            Self::Kampe2015WithoutCulling => Some(false),
            Self::Columns | Self::Sintorn2014 => None,
        }
    }

    /// For people.
    pub fn name(self) -> &'static str {
        match self {
            Self::Columns => "columns",
            Self::Kampe2015 => "2015",
            Self::Kampe2015WithoutCulling => "2015, no culling",
            Self::Sintorn2014 => "2014",
        }
    }
}

/// One bake.
#[derive(Clone, Copy)]
pub struct Combination<'a> {
    pub subject: &'a Subject,
    pub technique: Technique,
    pub interior: Interior,
    pub resolution: Resolution,
    pub threads: usize,
}

impl Combination<'_> {
    /// For people.
    pub fn text(&self) -> String {
        let (interior, n) = (interior_argument(self.interior), self.resolution.texels());
        format!("{}, {interior}, {n}, {}, {} thread(s)", self.subject.name, self.technique.name(), self.threads)
    }

    /// Whether all but the resolution is the same.
    pub fn is_series_of(&self, other: &Self) -> bool {
        std::ptr::eq(self.subject, other.subject)
            && (self.technique, self.interior, self.threads) == (other.technique, other.interior, other.threads)
    }

    /// What `antumbra bake` is told.
    pub fn arguments(&self, memory_limit: Option<u64>) -> Vec<String> {
        let mut arguments = vec![
            format!("--light={}", self.subject.light),
            format!("--interior={}", interior_argument(self.interior)),
            format!("--resolution={}", self.resolution.texels()),
            format!("--threads={}", self.threads),
            format!("--method={}", self.technique.method()),
        ];
        arguments.extend((self.technique.culling() == Some(false)).then(|| "--no-culling".to_owned()));
        arguments.extend(memory_limit.map(|limit| format!("--memory-limit={limit}")));
        arguments
    }
}

/// Every bake once; of a series the least resolution first.
pub fn plan<'a>(subjects: &'a [Subject], wish: &Wish) -> Vec<Combination<'a>> {
    let mut plan: Vec<Combination<'a>> = Vec::new();
    for subject in subjects {
        for &interior in &wish.interiors {
            for resolution in resolutions(wish.smallest.texels(), wish.largest.texels()) {
                let wanted = wanted(wish, interior, resolution);
                let combination =
                    |(technique, threads)| Combination { subject, technique, interior, resolution, threads };
                plan.extend(wanted.into_iter().map(combination));
            }
        }
    }
    plan
}

/// Techniques and numbers of threads for a policy at a resolution. The papers' methods know open and closed geometry alone.
fn wanted(wish: &Wish, interior: Interior, resolution: Resolution) -> Vec<(Technique, usize)> {
    let baselines_know = matches!(interior, Interior::Open | Interior::Auto | Interior::Closed);
    let baselines_fit = baselines_know && resolution <= wish.largest_baseline;
    let fits = |technique: &Technique| *technique == Technique::Columns || baselines_fit;
    let techniques = wish.techniques.iter().copied().filter(fits);
    let mut wanted: Vec<(Technique, usize)> = techniques.map(|technique| (technique, wish.threads)).collect();
    if wish.techniques.contains(&Technique::Columns) {
        for &threads in &wish.threads_list {
            if !wanted.contains(&(Technique::Columns, threads)) {
                wanted.push((Technique::Columns, threads));
            }
        }
    }
    wanted
}

#[cfg(test)]
pub mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::args::parse_resolution;

    pub fn wish(smallest: &str, largest: &str, largest_baseline: &str) -> Wish {
        let resolution = |text| parse_resolution(text).expect("a resolution");
        Wish {
            techniques: Technique::value_variants().to_vec(),
            interiors: vec![Interior::Open, Interior::Auto],
            smallest: resolution(smallest),
            largest: resolution(largest),
            largest_baseline: resolution(largest_baseline),
            threads: 2,
            threads_list: vec![1, 2],
            repeat: 1,
            memory_limit: None,
        }
    }

    pub fn subject() -> Subject {
        Subject { name: "city".to_owned(), path: PathBuf::new(), light: "sun".to_owned() }
    }

    #[test]
    fn baselines_end_earlier_and_nothing_is_measured_twice() {
        let (subjects, wish) = ([subject()], wish("4096", "16384", "8192"));
        let plan = plan(&subjects, &wish);
        let texts: std::collections::BTreeSet<String> = plan.iter().map(Combination::text).collect();
        assert_eq!(texts.len(), plan.len());
        // Two policies; four techniques and one further thread at two resolutions, columns with two at the third.
        assert_eq!(plan.len(), 2 * (5 + 5 + 2));
        assert!(texts.contains("city, auto, 8192, 2015, no culling, 2 thread(s)"));
        assert!(texts.contains("city, open, 16384, columns, 1 thread(s)"));
    }

    #[test]
    fn a_largest_below_the_smallest_is_measured_alone() {
        let plan_subjects = [subject()];
        let wish = wish("4096", "512", "8192");
        assert!(plan(&plan_subjects, &wish).iter().all(|c| c.resolution.texels() == 512));
    }

    #[test]
    fn baselines_know_open_and_closed_alone() {
        let (subjects, mut wish) = ([subject()], wish("512", "512", "8192"));
        wish.interiors = vec![Interior::Thickness(0.5)];
        assert!(plan(&subjects, &wish).iter().all(|c| c.technique == Technique::Columns));
    }

    #[test]
    fn bakes_are_told_what_to_do() {
        let subject = subject();
        let combination = Combination {
            subject: &subject,
            technique: Technique::Kampe2015WithoutCulling,
            interior: Interior::Thickness(0.5),
            resolution: parse_resolution("512").expect("a resolution"),
            threads: 1,
        };
        let expected = "--light=sun --interior=thickness=0.5 --resolution=512 --threads=1 --method=kampe2015 --no-culling \
                        --memory-limit=7";
        assert_eq!(combination.arguments(Some(7)).join(" "), expected);
    }
}
