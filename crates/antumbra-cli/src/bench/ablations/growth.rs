//! Bytes over resolution, beside a 16-bit shadow map's (Sintorn et al. 2014).

use antumbra::Interior;
use antumbra_scene::Light;
use anyhow::Result;
use serde_json::json;

use super::{INTERIORS, Subject, Wish, baked};
use crate::bench::plot::{Axis, BLUE, Curve, GREY, ORANGE, Panel, Plot, file_name};
use crate::bench::ratio;
use crate::bench::section::{Column, Row, Section, Shown, row};

const COLUMNS: &[Column<'_>] = &[
    ("scene", "scene", Shown::Plain),
    ("interior", "policy", Shown::Plain),
    ("resolution", "N", Shown::Plain),
    ("pool_bytes", "nodes", Shown::Bytes),
    ("file_bytes", "file", Shown::Bytes),
    ("shadow_map_bytes", "16-bit shadow map", Shown::Bytes),
    ("shadow_map_ratio", "shadow map / nodes", Shown::Decimal),
    ("growth", "growth", Shown::Decimal),
];

const ABOUT: &str = "What `antumbra bake` makes, and 2 N^2 bytes. Growth: bytes at N over bytes at N / 2; a shadow map's is 4, the \
surfaces' of a scene too, and 2 stands for silhouettes. Sintorn et al. 2014, their main scene: open a tenth of the shadow map at 4K, \
1.5 GB against 137 GB at 256K; closed a hundredth at 16K, 100 MB (less than a thousandth) at 256K, where growth is near 2.";

const LARGEST: u32 = 1 << 20;

pub fn section() -> Section {
    Section::new("Bytes over resolution", ABOUT, COLUMNS)
}

pub fn rows(subject: &Subject, sun: &Light, wish: &Wish) -> Result<Vec<Row>> {
    let mut rows = Vec::new();
    for interior in INTERIORS {
        let mut before = None;
        for resolution in wish.resolutions(256, LARGEST) {
            let baked = baked(&subject.scene, std::slice::from_ref(sun), interior, resolution)?;
            let pool = baked.lights[0].bytes;
            let n = u64::from(resolution.texels());
            rows.push(row(json!({
                "scene": subject.name,
                "ablation": "growth",
                "light": sun.name,
                "interior": interior.name(),
                "resolution": n,
                "pool_bytes": pool,
                "file_bytes": baked.bytes.len(),
                "shadow_map_bytes": 2 * n * n,
                "shadow_map_ratio": ratio(2 * n * n, pool),
                "growth": before.map(|before| ratio(pool, before)),
            })));
            before = Some(pool);
        }
    }
    Ok(rows)
}

/// Bytes and growth of one scene's rows.
pub fn plots(scene: &str, rows: &[Row]) -> Result<Vec<Plot>> {
    let curve = |name, color, key: &str, interior: Interior| {
        let of_interior = rows.iter().filter(|row| row["interior"] == interior.name());
        let point = |row: &Row| Some((row["resolution"].as_f64()?, row[key].as_f64()?));
        Curve { name, color, points: of_interior.filter_map(point).collect() }
    };
    let shadow_map = curve("16-bit shadow map", GREY, "shadow_map_bytes", Interior::Open);
    let bytes = vec![
        shadow_map,
        curve("open", ORANGE, "pool_bytes", Interior::Open),
        curve("auto", BLUE, "pool_bytes", Interior::Auto),
    ];
    let open = curve("open", ORANGE, "growth", Interior::Open);
    let constant = open.points.iter().map(|(n, _)| (*n, 4.0)).collect();
    let shadow_map = Curve { name: "16-bit shadow map", color: GREY, points: constant };
    let growth = vec![shadow_map, open, curve("auto", BLUE, "growth", Interior::Auto)];
    let mut plots = vec![plot(scene, "bytes", "bytes over resolution", bytes, |curves| Axis::bytes("bytes", curves))?];
    // A growth needs two resolutions.
    if growth[1].points.len() > 1 {
        plots.push(plot(scene, "growth", "growth per doubling of the resolution", growth, Axis::growth)?);
    }
    Ok(plots)
}

fn plot(scene: &str, what: &str, title: &str, curves: Vec<Curve>, y: impl Fn(&[&Curve]) -> Axis) -> Result<Plot> {
    let all: Vec<&Curve> = curves.iter().collect();
    let (x, y) = (Axis::resolutions(&all), y(&all));
    Plot::new(file_name("ablations", scene, what), &[Panel { title: format!("{scene}: {title}"), curves, x, y }])
}
