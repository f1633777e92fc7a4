//! Tables of made-up figures.

use super::super::measure::tests::figures;
use super::super::plan::plan;
use super::super::plan::tests::{subject, wish};
use super::*;

/// Bytes and seconds differ by technique, and grow with the resolution; 2014 runs out of memory at 8192.
fn measured<'a>(subjects: &'a [super::super::Subject], wish: &Wish) -> Vec<Measurement<'a>> {
    let measure = |combination: Combination<'a>| {
        let factor = match combination.technique {
            Technique::Columns => 1,
            Technique::Kampe2015 | Technique::Kampe2015WithoutCulling => 2,
            Technique::Sintorn2014 if combination.resolution.texels() == 8192 => {
                return Measurement { combination, figures: Err("too much".to_owned()) };
            }
            Technique::Sintorn2014 => 3,
        };
        let mut figures = figures(factor * u64::from(combination.resolution.texels()));
        figures.seconds *= factor as f64 / combination.threads as f64;
        Measurement { combination, figures: Ok(figures) }
    };
    plan(subjects, wish).into_iter().map(measure).collect()
}

fn tables(wish: &Wish) -> String {
    let subjects = [subject()];
    let measured = measured(&subjects, wish);
    sections(&measured, wish).iter().map(Section::markdown).collect()
}

#[track_caller]
fn has(text: &str, line: &str) {
    assert!(text.lines().any(|l| l == line), "no `{line}` in:\n{text}");
}

#[test]
fn tables_have_our_figures_beside_the_papers() {
    let text = tables(&wish("4096", "16384", "8192"));
    has(&text, "| city | auto | 4096 | 7.75 s | 3.00 s | 7.75 s | 3.00 s | 1.00 | 3.88 s | 4.00 s |");
    has(&text, "| Closed City (2015) | closed | 16384 | 2.5 s | 2.3 s | 377 ms | 151 ms | 6.63 |  |  |");
    has(&text, "| city | open | 4096 | 0.01 MB | 0.01 MB | 0.00 MB | 1.50 | 2.00 | 3.00 |");
    has(&text, "| city | open | 8192 | out of memory | 0.02 MB | 0.01 MB |  | 2.00 |  |");
    has(&text, "| Fractal Landscape (2015) | closed | 262144 | 60.99 MB | 20.35 MB |  | 3.00 |  |  |");
    has(&text, "| city | open | columns | building columns | 4.00 s | 4.00 s | 4.00 s |  |  |");
    has(&text, "| Closed City (2015) | closed | 2015 | exit depth map | 78 ms |  | 176 ms | 1.8 s | 23.0 s |");
    has(&text, "| city | auto | 2014 | 11.6 s | out of memory |  |  |  |  |  |");
    has(
        &text,
        "| Sintorn et al. 2014, as cited | closed | 2014 | 2.0 s | 18.0 s |  | 68.0 s | 256.0 s | 1055.0 s | 5520.0 s |",
    );
    has(&text, "| city | auto | 8192 | 2015, no culling | 2.00 |  | 1.00 | 2.00 |");
    has(&text, "| city | auto | 16384 | 1 | 7.75 s | 1.00 | 1000 bytes |");
    has(&text, "| city | auto | 16384 | 2 | 3.88 s | 2.00 | 1000 bytes |");
    assert_eq!(text.matches("\n## ").count() + 1, 7);
}

#[test]
fn tables_without_anything_of_ours_are_left_out() {
    let mut wish = wish("512", "1024", "512");
    wish.techniques = vec![Technique::Columns];
    wish.threads_list = vec![2];
    let text = tables(&wish);
    assert!(!text.contains("Table 1") && !text.contains("Table 2") && !text.contains("Threads"), "{text}");
    has(&text, "| city | open | columns | 1024 | 3.88 s | 1.00 | 1.00 KiB | 2.00 | 1000 bytes | 1.00 |  | 8.10 s |");
}
