//! How many bytes a lookup reads, counted on a graphics card: `words FILE.antumbra`. Voxels lie near transitions, where descents
//! go all the way.

use antumbra::ShadowFile;
use antumbra::shaders::Lookup;
use antumbra_testbed::query::{Card, Op, Query};
use antumbra_testbed::{Random, gpu, voxel};
use glam::DVec3;

/// Lookups of each kind.
const COUNT: usize = 20_000;

/// Name, op and arguments.
const KINDS: [(&str, Op, [u32; 4]); 9] = [
    ("point", Op::IsLit, [0; 4]),
    ("3 x 3 box", Op::Weights, [1, 0, 0, 0]),
    ("9 x 9 box", Op::Weights, [4, 0, 0, 0]),
    ("9 x 9 tent", Op::Weights, [4, 1, 0, 0]),
    ("17 x 17 box", Op::Weights, [8, 0, 0, 0]),
    ("mean over 8 texels", Op::Mean, [3, 0, 0, 0]),
    ("mean over 64 texels", Op::Mean, [6, 0, 0, 0]),
    ("box of a walk", Op::Cell, [0; 4]),
    ("blocker, 16 texels", Op::EnterWindow, [0; 4]),
];

fn main() {
    let Some(path) = std::env::args().nth(1) else {
        eprintln!("name a file: words city.antumbra");
        std::process::exit(2);
    };
    let file = std::fs::read(&path).map_err(|e| e.to_string());
    let file = file.and_then(|bytes| ShadowFile::from_bytes(&bytes).map_err(|e| e.to_string()));
    let file = file.unwrap_or_else(|error| {
        eprintln!("{path}: {error}");
        std::process::exit(1);
    });
    let gpu = gpu();
    println!("Bytes read per lookup, mean over {COUNT} of the first light of {path}\n");
    println!("| lookup | with top grid | without |\n|---|---:|---:|");
    let Some(light) = file.lights().next() else { return };
    let cards = [true, false].map(|top_grid| {
        let lookup = Lookup { top_grid, counting: true, ..Lookup::default() };
        Card::new(&gpu, &file, lookup, DVec3::ZERO)
    });
    for (name, op, arguments) in KINDS {
        let means = cards.each_ref().map(|card| {
            let mut random = Random(5);
            let queries = (0..COUNT).map(|_| {
                let voxel = voxel(&mut random, light, 0);
                let last = light.record().resolution() - 1;
                let window = [voxel.x.saturating_sub(16), voxel.y.saturating_sub(16)];
                let window = [window[0], window[1], (voxel.x + 16).min(last), (voxel.y + 16).min(last)];
                let arguments = if op == Op::EnterWindow { window } else { arguments };
                Query { voxel: voxel.as_ivec3(), arguments, ..card.query(op, light, 0) }
            });
            let words: f64 = card.ask(queries).iter().map(|answer| f64::from(answer.words[7])).sum();
            4.0 * words / COUNT as f64
        });
        println!("| {name} | {:.1} | {:.1} |", means[0], means[1]);
    }
}
